#include "clients/cli/findings_text.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "clients/cli/terminal.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/program.pb.h"
#include "rmlcell/v1/report.pb.h"

namespace rmlcell::cli {
namespace {

std::string Text(const std::vector<Diagnostic>& findings, const UntoldFindings& dropped,
                 std::string_view source, bool colour) {
  std::string all;
  KindsShown kinds;
  for (const Diagnostic& finding : findings) {
    if (!kinds.Show(CodeText(finding.code), finding.where.line)) continue;
    // Bytes that are no text would upset a terminal, and whoever reads this in a pipe.
    const std::string text = bridge::Utf8(FormatDiagnostic(finding, source));
    const std::size_t line_end = std::min(text.find('\n'), text.size());
    all += Paint(Visible(text.substr(0, line_end)),
                 IsError(finding.severity) || finding.judged == Judged::kBad ? Colour::kRed
                                                                             : Colour::kYellow,
                 colour) +
           text.substr(line_end) + "\n";
  }
  v1::Findings untold;
  bridge::SetUntold(dropped, untold);
  kinds.AddUntold(untold.gathered(), untold.diagnostics_dropped());
  return all + kinds.Rest();
}

template <class Message>
std::string TextOfMessage(const Message& message) {
  std::string all;
  KindsShown kinds;
  for (const v1::Diagnostic& finding : message.diagnostics()) {
    if (kinds.Show(finding.code(), finding.place().line())) all += FindingLine(finding) + "\n";
  }
  kinds.AddUntold(message.gathered(), message.diagnostics_dropped());
  return all + kinds.Rest();
}

}  // namespace

bool KindsShown::Show(const std::string& code, int line) {
  Kind& kind = kinds_[code];
  if (kind.shown < kToldOfKindMax) {
    ++kind.shown;
    return true;
  }
  LeaveOut(kind, 1, line, line);
  return false;
}

void KindsShown::LeaveOut(Kind& kind, std::uint64_t count, int first_line, int last_line) {
  kind.left_out += count;
  if (first_line > 0)
    kind.first_line = kind.first_line == 0 ? first_line : std::min(first_line, kind.first_line);
  kind.last_line = std::max(kind.last_line, last_line);
}

void KindsShown::AddUntold(const google::protobuf::RepeatedPtrField<v1::GatheredFindings>& gathered,
                           std::int64_t dropped) {
  of_no_kind_ += dropped;
  for (const v1::GatheredFindings& one : gathered) {
    Kind& kind = kinds_[one.code()];
    LeaveOut(kind, static_cast<std::uint64_t>(one.count()), one.first().line(), one.last().line());
    of_no_kind_ -= one.count();
    v1::Diagnostic plain;
    plain.set_code(one.code());
    plain.set_severity(one.severity());
    plain.set_verdict(one.verdict());
    plain.set_message(one.message());
    kind.said = FindingLine(plain);
  }
}

std::string KindsShown::Rest() const {
  std::string text;
  for (const auto& [code, kind] : kinds_) {
    if (kind.left_out == 0) continue;
    const std::string extent = ExtentText(kind.first_line, kind.last_line);
    if (kind.shown > 0) {
      text += "and " + std::to_string(kind.left_out) + " more " + code + extent + "\n";
    } else {
      text += kind.said + " (" + std::to_string(kind.left_out) + " times" + extent + ")\n";
    }
  }
  if (of_no_kind_ > 0) {
    text += "and " + std::to_string(of_no_kind_) +
            (of_no_kind_ == 1 ? " more finding\n" : " more findings\n");
  }
  return text;
}

std::string ExtentText(int first_line, int last_line) {
  if (first_line <= 0) return {};
  if (first_line == last_line) return ", line " + std::to_string(first_line);
  return ", lines " + std::to_string(first_line) + " to " + std::to_string(last_line);
}

std::string FindingsText(const v1::Findings& findings) { return TextOfMessage(findings); }

std::string FindingsText(const v1::RunReport& report) { return TextOfMessage(report); }

std::string FindingLine(const v1::Diagnostic& diagnostic) {
  std::string text = Visible(FormatDiagnostic(bridge::FromProto(diagnostic), {}));
  if (diagnostic.count() > 1) text += " (" + std::to_string(diagnostic.count()) + " times)";
  return text;
}

void PrintFindings(const std::vector<Diagnostic>& findings, const UntoldFindings& dropped,
                   std::string_view source) {
  PrintRaw(Text(findings, dropped, source, ColourOnOutput()));
}

void ComplainOf(const std::vector<Diagnostic>& findings, const UntoldFindings& dropped,
                std::string_view source) {
  const std::string text = Text(findings, dropped, source, ColourOnErrors());
  std::fwrite(text.data(), 1, text.size(), stderr);
}

int Refuse(const Error& error) {
  Complain(bridge::ErrorText(error));
  return kUsage;
}

}  // namespace rmlcell::cli
