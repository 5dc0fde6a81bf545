#include "proto/bridge/findings.h"

#include <google/protobuf/any.pb.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/run/rehearsal.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/start_blocker.h"
#include "rmlcell/v1/common.pb.h"
#include "rmlcell/v1/program.pb.h"
#include "rmlcell/v1/report.pb.h"
#include "tests/engine/core/untold.h"
#include "tests/proto/bridge/message_text.h"

namespace rmlcell::bridge {
namespace {

// RFC 3629: every form at the ends of its range; what is not UTF-8 becomes one "?" a byte.
TEST(Utf8, KeepsWhatIsAndMarksWhatIsNot) {
  const std::vector<std::string> good = {"",
                                         "plain",
                                         "\x7F",
                                         "\xC2\x80",
                                         "\xDF\xBF",
                                         "\xE0\xA0\x80",
                                         "\xEC\xBF\xBF",
                                         "\xED\x9F\xBF",
                                         "\xEE\x80\x80",
                                         "\xEF\xBF\xBF",
                                         "\xF0\x90\x80\x80",
                                         "\xF3\xBF\xBF\xBF",
                                         "\xF4\x8F\xBF\xBF"};
  for (const std::string& text : good) {
    EXPECT_EQ(Utf8(text), text);
    EXPECT_EQ(Utf8("a" + text + "b"), "a" + text + "b");
  }
  const std::map<std::string, std::string> bad = {{"\x80", "?"},
                                                  {"\xBF", "?"},
                                                  {"\xC0\x80", "??"},
                                                  {"\xC1\xBF", "??"},
                                                  {"\xC2", "?"},
                                                  {"\xC2\x7F", "?\x7F"},
                                                  {"\xC2\xC0", "??"},
                                                  {"\xE0\x9F\xBF", "???"},
                                                  {"\xED\xA0\x80", "???"},
                                                  {"\xE1\x80", "??"},
                                                  {"\xF0\x8F\xBF\xBF", "????"},
                                                  {"\xF4\x90\x80\x80", "????"},
                                                  {"\xF5\x80\x80\x80", "????"},
                                                  {"\xF1\x80\x80", "???"},
                                                  {"\xE1\x80"
                                                   "c",
                                                   "??c"},
                                                  {"\xFF", "?"}};
  for (const auto& [text, marked] : bad) {
    EXPECT_EQ(Utf8(text), marked) << marked;
    EXPECT_EQ(Utf8("a" + text), "a" + marked);
  }
}

constexpr std::pair<Severity, v1::Severity> kSeverities[] = {
    {Severity::kAdvice, v1::SEVERITY_ADVICE},   {Severity::kWarning, v1::SEVERITY_WARNING},
    {Severity::kCompile, v1::SEVERITY_COMPILE}, {Severity::kProgram, v1::SEVERITY_PROGRAM},
    {Severity::kFatal, v1::SEVERITY_FATAL},     {Severity::kAlarm, v1::SEVERITY_ALARM},
    {Severity::kMessage, v1::SEVERITY_MESSAGE}, {Severity::kTool, v1::SEVERITY_TOOL},
    {Severity::kBudget, v1::SEVERITY_BUDGET},   {Severity::kDevice, v1::SEVERITY_DEVICE},
    {Severity::kRequest, v1::SEVERITY_REQUEST}};

Diagnostic Whole() {
  return {.code = ErrorCode::kHoleRadiusZero,
          .severity = Severity::kProgram,
          .detail = "radius is 0",
          .rule = "OPT-2.27",
          .file = "part.S",
          .where = {.line = 1, .column = 2, .length = 3, .byte_offset = 4},
          .program = 5,
          .step = 6,
          .fixes = {{.byte_offset = 7, .length = 8, .text = "1."}},
          .at = std::chrono::seconds(9)};
}

// What the text is made of goes with it, wherever it goes: a finding, there and back, an error, an
// outcome, a reason of a verdict.
TEST(DiagnosticMessage, NumbersAndWordsGoWithTheText) {
  const Detail detail = "speed of " + Told("word", "!MC") + " is " +
                        Told("speed", 0.25, "mm/s", "0.25 mm/s") + ", not " + Told("limit", 3);
  ASSERT_EQ(detail, "speed of !MC is 0.25 mm/s, not 3");
  const auto expect = [](const auto& message) {
    ASSERT_EQ(message.arguments_size(), 3);
    ExpectMessage(message.arguments(0), "name: 'word' text: '!MC'");
    ExpectMessage(message.arguments(1), "name: 'speed' number: 0.25 unit: 'mm/s'");
    ExpectMessage(message.arguments(2), "name: 'limit' number: 3");
  };
  Diagnostic finding = Whole();
  finding.detail = detail;
  expect(ToProto(finding));
  EXPECT_EQ(FromProto(ToProto(finding)).detail.arguments(), detail.arguments());
  const google::rpc::Status status = ToRpcStatus({ErrorCode::kHoleRadiusZero, detail, {}});
  v1::ErrorDetail error;
  ASSERT_TRUE(status.details(1).UnpackTo(&error));
  expect(error);
  const machine::Outcome outcome{
      .kind = machine::OutcomeKind::kFailed, .code = ErrorCode::kHoleRadiusZero, .detail = detail};
  machine::Judgement judgement{.verdict = machine::Verdict::kBad};
  judgement.reasons.push_back({.verdict = machine::Verdict::kBad, .said = detail});
  const v1::Outcome judged = ToProto(outcome, judgement);
  expect(judged);
  expect(judged.reasons(0));
}

TEST(DiagnosticMessage, EveryFieldThereAndBack) {
  const CatalogueEntry& entry = Lookup(ErrorCode::kHoleRadiusZero);
  const v1::Diagnostic message = ToProto(Whole());
  ExpectMessage(message,
                "code: 'OPT-E348' symbol: '" + std::string(ConstantName(entry.code)) +
                    "' severity: SEVERITY_PROGRAM message: 'radius is 0' advice: '" +
                    std::string(entry.advice) +
                    "' rule: 'OPT-2.27' place { file: 'part.S' line: 1 column: 2 length: 3 "
                    "byte_offset: 4 program: 5 step: 6 } fixes { byte_offset: 7 length: 8 "
                    "text: '1.' } count: 1 virtual_time_ns: 9000000000");
  EXPECT_EQ(FromProto(message), Whole());
  for (const auto& [severity, wire] : kSeverities) {
    Diagnostic one = Whole();
    one.severity = severity;
    EXPECT_EQ(ToProto(one).severity(), wire);
    EXPECT_EQ(FromProto(ToProto(one)).severity, severity);
  }
}

// Without a detail the catalogue says it; without a place in bytes there is none; a code that is
// not known stands in the text.
TEST(DiagnosticMessage, WhatIsMissing) {
  Diagnostic bare{.code = ErrorCode::kHoleRadiusZero, .severity = Severity::kProgram};
  bare.where.byte_offset = -1;
  const v1::Diagnostic message = ToProto(bare);
  EXPECT_EQ(message.message(), Lookup(ErrorCode::kHoleRadiusZero).when);
  EXPECT_FALSE(message.place().has_byte_offset());
  EXPECT_FALSE(message.has_virtual_time_ns());
  EXPECT_EQ(FromProto(message).where.byte_offset, -1);
  EXPECT_FALSE(FromProto(message).at);
  bare.where.byte_offset = 0;
  EXPECT_TRUE(ToProto(bare).place().has_byte_offset());
  v1::Diagnostic newer = message;
  newer.set_code("OPT-E9");
  newer.set_message("of tomorrow");
  EXPECT_EQ(FromProto(newer).code, ErrorCode::kCellInternal);
  EXPECT_EQ(FromProto(newer).detail, "OPT-E9: of tomorrow");
  newer.set_severity(v1::SEVERITY_UNSPECIFIED);
  EXPECT_EQ(FromProto(newer).severity, Severity::kRequest);
}

TEST(DiagnosticMessage, WhatItMakesOfTheVerdict) {
  for (const auto& [judged, verdict] : {std::pair(Judged::kNo, v1::VERDICT_UNSPECIFIED),
                                        std::pair(Judged::kDoubtful, v1::VERDICT_DOUBTFUL),
                                        std::pair(Judged::kBad, v1::VERDICT_BAD)}) {
    Diagnostic one = Whole();
    one.judged = judged;
    EXPECT_EQ(ToProto(one).verdict(), verdict);
    EXPECT_EQ(FromProto(ToProto(one)).judged, judged);
  }
}

// A reason has a place where it has a step or a line.
TEST(OutcomeMessage, WhereAReasonIs) {
  const auto has_place = [](const machine::Place& first) {
    machine::Judgement judgement{.verdict = machine::Verdict::kBad};
    judgement.reasons.push_back({.verdict = machine::Verdict::kBad, .first = first});
    return ToProto(machine::Outcome{}, judgement).reasons(0).has_first();
  };
  EXPECT_FALSE(has_place({.program = 1}));
  EXPECT_TRUE(has_place({.step = 1}));
  EXPECT_TRUE(has_place({.line = 1}));
}

TEST(OutcomeMessage, EveryKind) {
  using machine::OutcomeKind;
  for (const auto& [kind, wire] :
       {std::pair{OutcomeKind::kCompleted, v1::Outcome::KIND_COMPLETED},
        {OutcomeKind::kStopped, v1::Outcome::KIND_STOPPED},
        {OutcomeKind::kFailed, v1::Outcome::KIND_FAILED},
        {OutcomeKind::kCancelled, v1::Outcome::KIND_CANCELLED},
        {OutcomeKind::kBudgetExceeded, v1::Outcome::KIND_BUDGET_EXCEEDED}}) {
    EXPECT_EQ(ToProto(machine::Outcome{.kind = kind}).kind(), wire);
  }
  machine::Outcome failed{.kind = OutcomeKind::kFailed, .code = ErrorCode::kHoleRadiusZero};
  failed.place.byte_offset = -1;
  EXPECT_EQ(ToProto(failed).message(), Lookup(ErrorCode::kHoleRadiusZero).when);
  EXPECT_FALSE(ToProto(failed).place().has_byte_offset());
  failed.detail = "radius is 0";
  EXPECT_EQ(ToProto(failed).message(), "radius is 0");
}

TEST(ExplanationMessage, SaysAllOfARow) {
  const CatalogueEntry& entry = Lookup(ErrorCode::kHoleRadiusZero);
  const v1::ErrorExplanation message = Explain(entry);
  EXPECT_EQ(message.code(), "OPT-E348");
  EXPECT_EQ(message.symbol(), ConstantName(entry.code));
  EXPECT_EQ(FromProto([&] {
              v1::Diagnostic d;
              d.set_severity(message.severity());
              return d;
            }())
                .severity,
            entry.severity);
  EXPECT_EQ(message.when(), entry.when);
  EXPECT_EQ(message.effect(), SeverityEffect(entry.severity));
  EXPECT_EQ(message.advice(), entry.advice);
}

TEST(FindingsMessage, OfATranslationAndItsMotion) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  auto parameters = *machine::MakeParameters(family, "", {{"LASER", "EFA51"}});
  parameters.SetChangedBy("mine.toml");
  simulation::CheckedProgram check{
      .family = &family, .machine = parameters.Used(), .slot = 45, .translation = {.ok = true}};
  check.translation.diagnostics = {Whole()};
  check.translation.diagnostics_dropped = Untold(3, ErrorCode::kNameUndeclared, 20);
  check.translation.figures = {{.name = "steps", .unit = "", .value = 7.0}};
  check.motion.findings_dropped = Untold(4, ErrorCode::kNameUndeclared, 30);
  check.motion.cut_short = {{45, {.text = "only up to step 2"}}};
  const auto found = [&] {
    const machine::Judgement judgement = simulation::JudgeCheck(check);
    return FindingsOf(check, judgement);
  };
  const v1::Findings good = found();
  EXPECT_TRUE(good.ok());
  EXPECT_EQ(good.diagnostics_size(), 1);
  EXPECT_EQ(good.diagnostics_dropped(), 7);
  ASSERT_EQ(good.gathered_size(), 1);
  EXPECT_EQ(good.gathered(0).code(), "OPT-E7011");
  EXPECT_EQ(good.gathered(0).count(), 7);
  EXPECT_EQ(good.gathered(0).first().line(), 20);
  EXPECT_EQ(good.gathered(0).last().line(), 33);
  EXPECT_EQ(good.motion_check(), "only up to step 2");
  // Not followed to its end: what comes behind is not known.
  EXPECT_EQ(good.verdict(), v1::VERDICT_DOUBTFUL);
  ASSERT_EQ(good.reasons_size(), 1);
  EXPECT_EQ(good.reasons(0).message(), "motion checked only up to step 2");
  ASSERT_EQ(good.figures_size(), 1);
  EXPECT_EQ(good.figures(0).name(), "steps");
  EXPECT_EQ(good.figures(0).value(), 7.0);
  check.slot = 44;
  EXPECT_EQ(found().motion_check(), "");
  check.slot = 45;
  check.motion.findings = {{.code = ErrorCode::kTargetOutOfTravel, .severity = Severity::kProgram}};
  const v1::Findings bad = found();
  EXPECT_FALSE(bad.ok());
  ASSERT_EQ(bad.diagnostics_size(), 2);
  EXPECT_EQ(bad.diagnostics(1).code(), CodeText(ErrorCode::kTargetOutOfTravel));
  EXPECT_EQ(bad.diagnostics(1).verdict(), v1::VERDICT_BAD);
  EXPECT_EQ(bad.diagnostics(0).verdict(), v1::VERDICT_UNSPECIFIED);  // it is not what makes it so
  EXPECT_EQ(FindingWord(FromProto(bad.diagnostics(0))), FindingWord(Whole()));
  // As in a report.
  EXPECT_EQ(bad.family(), "optimo");
  EXPECT_EQ(bad.profile(), "standard");
  EXPECT_FALSE(bad.profile_named());
  ASSERT_EQ(bad.profile_changes_size(), 1);
  EXPECT_EQ(bad.profile_changes(0).name(), "LASER");
  EXPECT_EQ(bad.profile_changes(0).value(), "EFA51");
  EXPECT_EQ(bad.profile_changes(0).of_profile(), "ARROW");
  EXPECT_EQ(bad.profile_changed_by(), "mine.toml");
  EXPECT_EQ(bad.verdict(), v1::VERDICT_BAD);
  ASSERT_EQ(bad.reasons_size(), 1);
  EXPECT_EQ(bad.reasons(0).code(), CodeText(ErrorCode::kTargetOutOfTravel));
  check.translation.ok = false;
  check.motion = {};
  EXPECT_FALSE(found().ok());
}

// What is filled a second time has what stands now, once.
TEST(FindingsMessage, WhatIsSetAgainStandsOnce) {
  UntoldFindings untold = Untold(3);
  untold.Mark([](ErrorCode) { return Judged::kDoubtful; });
  const machine::Judgement judgement{.verdict = machine::Verdict::kDoubtful,
                                     .reasons = {{.code = ErrorCode::kFlyReversal}}};
  v1::Findings findings;
  v1::RunReport report;
  for (int times = 0; times < 2; ++times) {
    SetUntold(untold, findings);
    SetUntold(untold, report);
    SetJudgement(judgement, findings);
  }
  ASSERT_EQ(findings.gathered_size(), 1);
  EXPECT_EQ(findings.gathered(0).verdict(), v1::VERDICT_DOUBTFUL);
  ASSERT_EQ(findings.reasons_size(), 1);
  EXPECT_EQ(findings.reasons(0).code(), CodeText(ErrorCode::kFlyReversal));
  ASSERT_EQ(report.gathered_size(), 1);
  EXPECT_EQ(report.gathered(0).count(), 3);
}

// The codes of gRPC, as docs/api.md tells what to do on each.
TEST(RpcCodes, OfEveryErrorThatIsNoWrongArgument) {
  const std::map<ErrorCode, int> others = {{ErrorCode::kCellInternal, 13},
                                           {ErrorCode::kCellStoreFailed, 13},
                                           {ErrorCode::kCellStoreCorrupt, 15},
                                           {ErrorCode::kCellUnavailable, 14},
                                           {ErrorCode::kCellStoreBusy, 14},
                                           {ErrorCode::kCellNotFound, 5},
                                           {ErrorCode::kCellUnknownMachine, 5},
                                           {ErrorCode::kProgramMissing, 5},
                                           {ErrorCode::kCellAlreadyExists, 6},
                                           {ErrorCode::kCellRequestIdReused, 6},
                                           {ErrorCode::kCellEtagMismatch, 10},
                                           {ErrorCode::kCellLeaseLost, 10},
                                           {ErrorCode::kCellPermission, 7},
                                           {ErrorCode::kCellUnauthenticated, 16},
                                           {ErrorCode::kCellJoinRefused, 16},
                                           {ErrorCode::kCellUnimplemented, 12},
                                           {ErrorCode::kCellPrecondition, 9},
                                           {ErrorCode::kCellVersionMismatch, 9},
                                           {ErrorCode::kProgramInUse, 9},
                                           // Of a START: the state of the machine, x1 and x5.
                                           {ErrorCode::kNotZeroed, 9},
                                           {ErrorCode::kEmergencyStop, 9},
                                           {ErrorCode::kShutterInterlock, 9},
                                           {ErrorCode::kTargetOutOfTravel, 9},
                                           {ErrorCode::kGas3NotFitted, 9},
                                           {ErrorCode::kKeyNotEnabled, 9},
                                           {ErrorCode::kNoProgramSelected, 9},
                                           {ErrorCode::kCellResourceExhausted, 8},
                                           {ErrorCode::kCellTooLarge, 8},
                                           {ErrorCode::kCmosFull, 8},
                                           {ErrorCode::kCellEventsGone, 11},
                                           {ErrorCode::kCellStoreUnavailable, 14},
                                           // live.md, section 9.
                                           {ErrorCode::kCellLeaseHeld, 10},
                                           {ErrorCode::kCellMachineTaken, 10},
                                           {ErrorCode::kCellPreviewStale, 10},
                                           {ErrorCode::kCellNotLive, 14},
                                           {ErrorCode::kCellJournal, 14},
                                           {ErrorCode::kCellControlNeeded, 7},
                                           {ErrorCode::kCellInspect, 9},
                                           {ErrorCode::kCellMachineState, 9},
                                           {ErrorCode::kCellMode, 9},
                                           {ErrorCode::kCellDisplaced, 9},
                                           {ErrorCode::kCellNotArmed, 9},
                                           {ErrorCode::kCellTicket, 9},
                                           {ErrorCode::kCellStepUnreachable, 9},
                                           {ErrorCode::kCellApproach, 9},
                                           {ErrorCode::kCellDoorOpen, 9},
                                           {ErrorCode::kCellKeySequence, 9},
                                           {ErrorCode::kCellReplayDiffers, 9},
                                           {ErrorCode::kCellHostStopped, 9},
                                           {ErrorCode::kCellEmergencyStop, 9},
                                           {ErrorCode::kCellPowerOff, 9}};
  for (const CatalogueEntry& entry : Catalogue()) {
    const auto other = others.find(entry.code);
    EXPECT_EQ(RpcCode(entry.code), other == others.end() ? 3 : other->second)
        << CodeText(entry.code);
  }
}

// LIVE-9.03, OPT-E7310, LIVE-2.10 x1 and x5: what the state of a machine refuses can be asked for
// again in another one; what a program has wrong cannot.
TEST(RpcCodes, WhatTheStateRefusesIsNoWrongArgument) {
  for (const CatalogueEntry& entry : Catalogue()) {
    const bool alarm = entry.severity == Severity::kAlarm;
    if (!alarm && entry.severity != Severity::kCompile) continue;
    EXPECT_EQ(RpcCode(entry.code), alarm ? 9 : 3) << entry.symbol;
  }
  EXPECT_EQ(ToRpcStatus({ErrorCode::kNotZeroed, "START", {}}).code(), 9);
}

// An error travels in a header: 24 kinds of what was not told, without their texts and files.
TEST(RpcStatus, HasTheKindsOfWhatWasNotTold) {
  for (const std::size_t count : {std::size_t{24}, std::size_t{25}, std::size_t{30}}) {
    UntoldFindings untold;
    for (const CatalogueEntry& entry : Catalogue().first(count)) {
      untold.Add(
          {.code = entry.code, .severity = entry.severity, .file = "part.S", .where = {.line = 7}});
    }
    v1::ErrorDetail detail;
    SetUntold(untold, detail);
    EXPECT_EQ(detail.diagnostics_dropped(), static_cast<std::int64_t>(count));
    ASSERT_EQ(detail.gathered_size(), 24);
    for (const v1::GatheredFindings& kind : detail.gathered()) {
      EXPECT_EQ(kind.count(), 1);
      EXPECT_EQ(kind.message() + kind.advice() + kind.first().file() + kind.last().file(), "");
      EXPECT_EQ(kind.first().line(), 7);
    }
  }
}

TEST(StartBlocker, SaysWhatItsErrorSays) {
  const CatalogueEntry& entry = Lookup(ErrorCode::kCellDoorOpen);
  const v1::StartBlocker blocker = ToStartBlocker({entry.code, "door 1", {}});
  EXPECT_EQ(blocker.code(), CodeText(entry.code));
  EXPECT_EQ(blocker.symbol(), ConstantName(entry.code));
  EXPECT_EQ(blocker.message(), "door 1");
  EXPECT_EQ(blocker.advice(), entry.advice);
}

TEST(RpcStatus, CarriesCodeTextPlaceAndFindings) {
  const Error error{ErrorCode::kCellNotFound, "slot 12", SourceSpan{.line = 1, .column = 2}};
  Diagnostic warning{.code = ErrorCode::kFlyReversal, .severity = Severity::kWarning};
  const google::rpc::Status plain = ToRpcStatus(error);
  const CatalogueEntry& entry = Lookup(ErrorCode::kCellNotFound);
  EXPECT_EQ(plain.code(), 5);
  EXPECT_EQ(plain.message(),
            "CELL-E9004: " + std::string(entry.when) + ": slot 12; " + std::string(entry.advice));
  ASSERT_EQ(plain.details_size(), 3);
  google::rpc::ErrorInfo info;
  ASSERT_TRUE(plain.details(0).UnpackTo(&info));
  EXPECT_EQ(info.reason(), ConstantName(ErrorCode::kCellNotFound));
  EXPECT_EQ(info.domain(), "rmlcell");
  EXPECT_EQ(info.metadata().at("code"), "CELL-E9004");
  v1::ErrorDetail detail;
  google::rpc::LocalizedMessage localized;
  ASSERT_TRUE(plain.details(2).UnpackTo(&localized));
  EXPECT_EQ(localized.locale(), "en");
  EXPECT_EQ(localized.message(), plain.message());
  ASSERT_TRUE(plain.details(1).UnpackTo(&detail));
  ExpectMessage(detail, "code: 'CELL-E9004' symbol: '" + std::string(ConstantName(entry.code)) +
                            "' number: 9004 message: 'slot 12' advice: '" +
                            std::string(entry.advice) + "' place { line: 1 column: 2 }");
  // The place of the first error stands for all.
  Diagnostic second = Whole();
  second.where.line = 99;
  ASSERT_TRUE(
      ToRpcStatus(error, {warning, Whole(), second}, Untold(3)).details(1).UnpackTo(&detail));
  EXPECT_EQ(detail.diagnostics_size(), 3);
  EXPECT_EQ(detail.diagnostics_dropped(), 3);
  EXPECT_EQ(detail.place().line(), 1);
  EXPECT_EQ(detail.place().program(), 5);
  ASSERT_TRUE(ToRpcStatus({ErrorCode::kCellNotFound, {}, {}}).details(1).UnpackTo(&detail));
  EXPECT_EQ(detail.message(), entry.when);
  EXPECT_FALSE(detail.has_place());
  EXPECT_EQ(ErrorText({ErrorCode::kCellNotFound, {}, {}}),
            "CELL-E9004: " + std::string(entry.when) + "; " + std::string(entry.advice));
}

}  // namespace
}  // namespace rmlcell::bridge
