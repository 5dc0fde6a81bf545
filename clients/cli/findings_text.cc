#include "clients/cli/findings_text.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "clients/cli/terminal.h"
#include "proto/bridge/findings.h"

namespace rmlcell::cli {
namespace {

std::string Text(const std::vector<Diagnostic>& findings, std::uint64_t dropped,
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
  all += kinds.Rest();
  if (dropped > 0) all += "and " + std::to_string(dropped) + " more findings\n";
  return all;
}

}  // namespace

bool KindsShown::Show(const std::string& code, int line) {
  Kind& kind = kinds_[code];
  if (kind.shown < kToldOfKindMax) {
    ++kind.shown;
    return true;
  }
  ++kind.left_out;
  if (line > 0 && (kind.first_line == 0 || line < kind.first_line)) kind.first_line = line;
  kind.last_line = std::max(kind.last_line, line);
  return false;
}

std::string KindsShown::Rest() const {
  std::string text;
  for (const auto& [code, kind] : kinds_) {
    if (kind.left_out == 0) continue;
    text += "and " + std::to_string(kind.left_out) + " more " + code +
            ExtentText(kind.first_line, kind.last_line) + "\n";
  }
  return text;
}

std::string ExtentText(int first_line, int last_line) {
  if (first_line <= 0) return {};
  if (first_line == last_line) return ", line " + std::to_string(first_line);
  return ", lines " + std::to_string(first_line) + " to " + std::to_string(last_line);
}

void PrintFindings(const std::vector<Diagnostic>& findings, std::uint64_t dropped,
                   std::string_view source) {
  PrintRaw(Text(findings, dropped, source, ColourOnOutput()));
}

void ComplainOf(const std::vector<Diagnostic>& findings, std::uint64_t dropped,
                std::string_view source) {
  const std::string text = Text(findings, dropped, source, ColourOnErrors());
  std::fwrite(text.data(), 1, text.size(), stderr);
}

int Refuse(const Error& error) {
  Complain(bridge::ErrorText(error));
  return kUsage;
}

}  // namespace rmlcell::cli
