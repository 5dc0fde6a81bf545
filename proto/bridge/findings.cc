#include "proto/bridge/findings.h"

#include <google/protobuf/any.pb.h>

#include "engine/simulation/run/rehearsal.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "rmlcell/v1/common.pb.h"
#include "rmlcell/v1/program.pb.h"
#include "rmlcell/v1/report.pb.h"

namespace rmlcell::bridge {
namespace {

v1::Verdict ToProto(machine::Verdict verdict) {
  switch (verdict) {
    case machine::Verdict::kGood:
      return v1::VERDICT_GOOD;
    case machine::Verdict::kDoubtful:
      return v1::VERDICT_DOUBTFUL;
    case machine::Verdict::kBad:
      return v1::VERDICT_BAD;
  }
  return v1::VERDICT_UNSPECIFIED;
}

// What a text says in numbers and words; the message has arguments.
template <class Message>
void SetArguments(const Detail& detail, Message& message) {
  for (const Argument& argument : detail.arguments()) {
    v1::Argument& made = *message.add_arguments();
    made.set_name(argument.name);
    if (const double* const number = std::get_if<double>(&argument.value))
      made.set_number(*number);
    else
      made.set_text(Utf8(std::get<std::string>(argument.value)));
    made.set_unit(argument.unit);
  }
}

template <class Message>
void AddJudgement(const machine::Judgement& judgement, Message& message) {
  message.set_verdict(ToProto(judgement.verdict));
  message.clear_reasons();
  for (const machine::Reason& reason : judgement.reasons) {
    v1::VerdictReason& made = *message.add_reasons();
    made.set_verdict(ToProto(reason.verdict));
    made.set_code(CodeText(reason.code));
    made.set_symbol(ConstantName(reason.code));
    made.set_message(Utf8(reason.said));
    SetArguments(reason.said, made);
    made.set_advice(std::string(Lookup(reason.code).advice));
    made.set_amount(reason.amount);
    made.set_limit(reason.limit);
    made.set_unit(reason.unit);
    if (reason.first.step > 0 || reason.first.line > 0)
      *made.mutable_first() = bridge::ToProto(reason.first);
  }
}

Detail DetailFromProto(const v1::Diagnostic& message) {
  Detail detail = message.message();
  for (const v1::Argument& argument : message.arguments()) {
    std::variant<double, std::string> value = argument.number();
    if (argument.value_case() == v1::Argument::kText) value = argument.text();
    detail += Detail("", {argument.name(), std::move(value), argument.unit()});
  }
  return detail;
}

v1::Verdict ToProto(Judged judged) {
  switch (judged) {
    case Judged::kDoubtful:
      return v1::VERDICT_DOUBTFUL;
    case Judged::kBad:
      return v1::VERDICT_BAD;
    case Judged::kNo:
      break;
  }
  return v1::VERDICT_UNSPECIFIED;
}

Judged JudgedFromProto(v1::Verdict verdict) {
  return verdict == v1::VERDICT_BAD        ? Judged::kBad
         : verdict == v1::VERDICT_DOUBTFUL ? Judged::kDoubtful
                                           : Judged::kNo;
}

template <class Message>
void AddMachine(const machine::MachineUsed& machine, Message& message) {
  message.set_profile(machine.profile);
  message.set_profile_named(machine.named);
  message.clear_profile_changes();
  for (const machine::ChangedParameter& change : machine.changes) {
    v1::ParameterChange& made = *message.add_profile_changes();
    made.set_name(change.name);
    made.set_value(change.value);
    made.set_of_profile(change.of_profile);
    made.set_source(Utf8(change.source));
  }
  message.set_profile_changed_by(Utf8(machine.changed_by));
  message.set_machine_name(Utf8(machine.own_name));
}

v1::Severity SeverityToProto(Severity severity) {
  switch (severity) {
    case Severity::kAdvice:
      return v1::SEVERITY_ADVICE;
    case Severity::kWarning:
      return v1::SEVERITY_WARNING;
    case Severity::kCompile:
      return v1::SEVERITY_COMPILE;
    case Severity::kProgram:
      return v1::SEVERITY_PROGRAM;
    case Severity::kFatal:
      return v1::SEVERITY_FATAL;
    case Severity::kAlarm:
      return v1::SEVERITY_ALARM;
    case Severity::kMessage:
      return v1::SEVERITY_MESSAGE;
    case Severity::kTool:
      return v1::SEVERITY_TOOL;
    case Severity::kBudget:
      return v1::SEVERITY_BUDGET;
    case Severity::kDevice:
      return v1::SEVERITY_DEVICE;
    case Severity::kRequest:
      return v1::SEVERITY_REQUEST;
  }
  return v1::SEVERITY_UNSPECIFIED;
}

Severity SeverityFromProto(v1::Severity severity) {
  switch (severity) {
    case v1::SEVERITY_ADVICE:
      return Severity::kAdvice;
    case v1::SEVERITY_WARNING:
      return Severity::kWarning;
    case v1::SEVERITY_COMPILE:
      return Severity::kCompile;
    case v1::SEVERITY_PROGRAM:
      return Severity::kProgram;
    case v1::SEVERITY_FATAL:
      return Severity::kFatal;
    case v1::SEVERITY_ALARM:
      return Severity::kAlarm;
    case v1::SEVERITY_MESSAGE:
      return Severity::kMessage;
    case v1::SEVERITY_TOOL:
      return Severity::kTool;
    case v1::SEVERITY_BUDGET:
      return Severity::kBudget;
    case v1::SEVERITY_DEVICE:
      return Severity::kDevice;
    default:
      return Severity::kRequest;
  }
}

void SetSpan(const SourceSpan& where, v1::SourcePlace& place) {
  place.set_line(where.line);
  place.set_column(where.column);
  place.set_length(where.length);
  if (where.byte_offset >= 0) place.set_byte_offset(where.byte_offset);
}

v1::SourcePlace PlaceOf(const Diagnostic& diagnostic) {
  v1::SourcePlace place;
  place.set_file(Utf8(diagnostic.file));
  place.set_program(diagnostic.program);
  place.set_step(diagnostic.step);
  SetSpan(diagnostic.where, place);
  return place;
}

template <class Message>
void AddUntold(const UntoldFindings& untold, Message& message) {
  message.set_diagnostics_dropped(static_cast<std::int64_t>(untold.count()));
  message.clear_gathered();
  for (const auto& [code, kind] : untold.kinds()) *message.add_gathered() = bridge::ToProto(kind);
}

// An error travels in a header of a few kilobytes.
constexpr int kGatheredInErrorMax = 24;

}  // namespace

std::string Utf8(const std::string& text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    std::size_t size = lead < 0x80                   ? 1
                       : lead >= 0xC2 && lead < 0xE0 ? 2
                       : lead >= 0xE0 && lead < 0xF0 ? 3
                       : lead >= 0xF0 && lead < 0xF5 ? 4
                                                     : 0;
    bool good = size > 0 && i + size <= text.size();
    for (std::size_t k = 1; good && k < size; ++k) {
      good = (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
    }
    if (good) {  // overlong forms, surrogates, beyond U+10FFFF
      const auto second = static_cast<unsigned char>(text[i + 1]);
      good = !(lead == 0xE0 && second < 0xA0) && !(lead == 0xED && second > 0x9F) &&
             !(lead == 0xF0 && second < 0x90) && !(lead == 0xF4 && second > 0x8F);
    }
    if (good) {
      out.append(text, i, size);
      i += size;
    } else {
      out += '?';
      ++i;
    }
  }
  return out;
}

v1::Diagnostic ToProto(const Diagnostic& diagnostic) {
  const CatalogueEntry& entry = Lookup(diagnostic.code);
  v1::Diagnostic message;
  message.set_code(CodeText(diagnostic.code));
  message.set_symbol(ConstantName(diagnostic.code));
  message.set_severity(SeverityToProto(diagnostic.severity));
  message.set_message(Utf8(Said(diagnostic.code, diagnostic.detail)));
  SetArguments(diagnostic.detail, message);
  message.set_advice(std::string(entry.advice));
  message.set_rule(diagnostic.rule);
  message.set_count(1);
  message.set_verdict(ToProto(diagnostic.judged));
  if (diagnostic.at) message.set_virtual_time_ns(diagnostic.at->count());
  *message.mutable_place() = PlaceOf(diagnostic);
  for (const Fix& fix : diagnostic.fixes) {
    v1::TextFix& made = *message.add_fixes();
    made.set_byte_offset(fix.byte_offset);
    made.set_length(fix.length);
    made.set_text(Utf8(fix.text));
  }
  return message;
}

v1::GatheredFindings ToProto(const GatheredFindings& gathered) {
  const CatalogueEntry& entry = Lookup(gathered.code);
  v1::GatheredFindings message;
  message.set_code(CodeText(gathered.code));
  message.set_symbol(ConstantName(gathered.code));
  message.set_severity(SeverityToProto(gathered.severity));
  message.set_message(std::string(entry.when));
  message.set_advice(std::string(entry.advice));
  message.set_count(static_cast<std::int64_t>(gathered.count));
  *message.mutable_first() = PlaceOf(gathered.first);
  *message.mutable_last() = PlaceOf(gathered.last);
  message.set_verdict(ToProto(gathered.judged));
  return message;
}

void SetUntold(const UntoldFindings& untold, v1::Findings& message) { AddUntold(untold, message); }

void SetUntold(const UntoldFindings& untold, v1::RunReport& message) { AddUntold(untold, message); }

void SetUntold(const UntoldFindings& untold, v1::ErrorDetail& message) {
  AddUntold(untold, message);
  while (message.gathered_size() > kGatheredInErrorMax) message.mutable_gathered()->RemoveLast();
  for (v1::GatheredFindings& kind : *message.mutable_gathered()) {
    kind.clear_message();
    kind.clear_advice();
    kind.mutable_first()->clear_file();
    kind.mutable_last()->clear_file();
  }
}

v1::Figure ToProto(const machine::Figure& figure) {
  v1::Figure message;
  message.set_name(figure.name);
  message.set_unit(figure.unit);
  message.set_value(figure.value);
  return message;
}

v1::SourcePlace ToProto(const machine::Place& place) {
  v1::SourcePlace message;
  message.set_program(place.program);
  message.set_step(place.step);
  message.set_line(place.line);
  if (place.byte_offset >= 0) message.set_byte_offset(place.byte_offset);
  return message;
}

v1::Outcome ToProto(const machine::Outcome& outcome) {
  v1::Outcome message;
  switch (outcome.kind) {
    case machine::OutcomeKind::kCompleted:
      message.set_kind(v1::Outcome::KIND_COMPLETED);
      break;
    case machine::OutcomeKind::kStopped:
      message.set_kind(v1::Outcome::KIND_STOPPED);
      break;
    case machine::OutcomeKind::kFailed:
      message.set_kind(v1::Outcome::KIND_FAILED);
      break;
    case machine::OutcomeKind::kCancelled:
      message.set_kind(v1::Outcome::KIND_CANCELLED);
      break;
    case machine::OutcomeKind::kBudgetExceeded:
      message.set_kind(v1::Outcome::KIND_BUDGET_EXCEEDED);
      break;
  }
  message.set_message(Utf8(outcome.detail));
  SetArguments(outcome.detail, message);
  if (outcome.code) {
    const CatalogueEntry& entry = Lookup(*outcome.code);
    message.set_code(CodeText(*outcome.code));
    message.set_symbol(ConstantName(*outcome.code));
    message.set_advice(std::string(entry.advice));
    if (outcome.detail.empty()) message.set_message(std::string(entry.when));
  }
  *message.mutable_place() = ToProto(outcome.place);
  return message;
}

v1::Outcome ToProto(const machine::Outcome& outcome, const machine::Judgement& judgement) {
  v1::Outcome message = ToProto(outcome);
  SetJudgement(judgement, message);
  return message;
}

void SetJudgement(const machine::Judgement& judgement, v1::Outcome& message) {
  AddJudgement(judgement, message);
}

void SetJudgement(const machine::Judgement& judgement, v1::Findings& message) {
  AddJudgement(judgement, message);
}

void SetMachine(const machine::MachineUsed& machine, v1::RunReport& message) {
  AddMachine(machine, message);
}

void SetMachine(const machine::MachineUsed& machine, v1::Findings& message) {
  AddMachine(machine, message);
}

void SetMachine(const machine::MachineUsed& machine, v1::DiffProgramsResponse& message) {
  AddMachine(machine, message);
}

v1::ErrorExplanation Explain(const CatalogueEntry& entry) {
  v1::ErrorExplanation message;
  message.set_code(CodeText(entry.code));
  message.set_symbol(ConstantName(entry.code));
  message.set_severity(SeverityToProto(entry.severity));
  message.set_when(std::string(entry.when));
  message.set_effect(std::string(SeverityEffect(entry.severity)));
  message.set_advice(std::string(entry.advice));
  return message;
}

v1::Findings FindingsOf(bool ok, const std::vector<Diagnostic>& diagnostics,
                        const UntoldFindings& dropped,
                        const std::vector<machine::Figure>& figures) {
  v1::Findings message;
  message.set_ok(ok);
  for (const Diagnostic& diagnostic : diagnostics) *message.add_diagnostics() = ToProto(diagnostic);
  SetUntold(dropped, message);
  for (const machine::Figure& figure : figures) *message.add_figures() = ToProto(figure);
  return message;
}

v1::Findings FindingsOf(const simulation::CheckedProgram& check,
                        const machine::Judgement& judgement) {
  UntoldFindings dropped = check.translation.diagnostics_dropped;
  dropped.Add(check.motion.findings_dropped);
  v1::Findings message =
      FindingsOf(check.ok(), check.translation.diagnostics, dropped, check.translation.figures);
  for (const Diagnostic& diagnostic : check.motion.findings)
    *message.add_diagnostics() = ToProto(diagnostic);
  const auto cut_short = check.motion.cut_short.find(check.slot);
  if (cut_short != check.motion.cut_short.end())
    message.set_motion_check(Utf8(cut_short->second.text));
  SetJudgement(judgement, message);
  message.set_family(std::string(check.family->info().id));
  SetMachine(check.machine, message);
  return message;
}

Diagnostic FromProto(const v1::Diagnostic& message) {
  Diagnostic diagnostic{
      .code = ErrorCode::kCellInternal,
      .severity = SeverityFromProto(message.severity()),
      .detail = DetailFromProto(message),
      .rule = message.rule(),
      .file = message.place().file(),
      .where = {.line = message.place().line(),
                .column = message.place().column(),
                .length = message.place().length(),
                .byte_offset =
                    message.place().has_byte_offset() ? message.place().byte_offset() : -1},
      .program = message.place().program(),
      .step = message.place().step(),
      .fixes = {}};
  diagnostic.judged = JudgedFromProto(message.verdict());
  if (message.has_virtual_time_ns()) diagnostic.at = SimTime(message.virtual_time_ns());
  const auto found = FindByText(message.code());
  if (found.empty()) {
    diagnostic.detail = message.code() + ": " + diagnostic.detail;
  } else {
    diagnostic.code = found.front()->code;
  }
  for (const v1::TextFix& fix : message.fixes()) {
    diagnostic.fixes.push_back(
        {.byte_offset = fix.byte_offset(), .length = fix.length(), .text = fix.text()});
  }
  return diagnostic;
}

int RpcCode(ErrorCode code) {
  switch (Lookup(code).refusal) {
    case Refusal::kInvalid:
      return 3;  // INVALID_ARGUMENT
    case Refusal::kNotFound:
      return 5;
    case Refusal::kAlreadyExists:
      return 6;
    case Refusal::kPermission:
      return 7;
    case Refusal::kExhausted:
      return 8;  // RESOURCE_EXHAUSTED
    case Refusal::kPrecondition:
      return 9;  // FAILED_PRECONDITION
    case Refusal::kConflict:
      return 10;  // ABORTED
    case Refusal::kGone:
      return 11;  // OUT_OF_RANGE
    case Refusal::kUnimplemented:
      return 12;
    case Refusal::kInternal:
      return 13;
    case Refusal::kUnavailable:
      return 14;
    case Refusal::kDataLoss:
      return 15;
    case Refusal::kUnauthenticated:
      return 16;
  }
  return 3;
}

std::string ErrorText(const Error& error) {
  const CatalogueEntry& entry = Lookup(error.code);
  // What is wrong with a request is what its detail says; the rest would only be in the way.
  const bool of_request =
      error.code == ErrorCode::kCellInvalidArgument || error.code == ErrorCode::kCellUsage;
  std::string text = CodeText(error.code) + ": ";
  if (error.detail.empty() || !of_request) text += entry.when;
  if (!error.detail.empty()) text += (of_request ? "" : ": ") + Utf8(error.detail);
  if (error.detail.empty() || error.code != ErrorCode::kCellInvalidArgument)
    text += "; " + std::string(entry.advice);
  return text;
}

v1::ErrorDetail ToErrorDetail(const Error& error) {
  const CatalogueEntry& entry = Lookup(error.code);
  v1::ErrorDetail detail;
  detail.set_code(CodeText(error.code));
  detail.set_symbol(ConstantName(error.code));
  detail.set_number(entry.number);
  detail.set_message(Utf8(Said(error.code, error.detail)));
  SetArguments(error.detail, detail);
  detail.set_advice(std::string(entry.advice));
  if (error.where) SetSpan(*error.where, *detail.mutable_place());
  return detail;
}

google::rpc::Status ToRpcStatus(const Error& error, const std::vector<Diagnostic>& diagnostics,
                                const UntoldFindings& dropped) {
  google::rpc::Status status;
  status.set_code(RpcCode(error.code));
  status.set_message(ErrorText(error));

  google::rpc::ErrorInfo info;
  info.set_reason(ConstantName(error.code));
  info.set_domain("rmlcell");
  (*info.mutable_metadata())["code"] = CodeText(error.code);
  status.add_details()->PackFrom(info);
  v1::ErrorDetail detail = ToErrorDetail(error);
  // The place of the first error stands for all, for clients that look no further.
  bool placed = false;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (!placed && IsError(diagnostic.severity)) {
      *detail.mutable_place() = ToProto(diagnostic).place();
      placed = true;
    }
    *detail.add_diagnostics() = ToProto(diagnostic);
  }
  SetUntold(dropped, detail);
  status.add_details()->PackFrom(detail);

  google::rpc::LocalizedMessage localized;
  localized.set_locale(std::string(kLanguage));
  localized.set_message(status.message());
  status.add_details()->PackFrom(localized);
  return status;
}

}  // namespace rmlcell::bridge
