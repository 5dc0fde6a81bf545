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
  for (const Diagnostic& finding : findings) {
    const std::string text = FormatDiagnostic(finding, source);
    const std::size_t line_end = std::min(text.find('\n'), text.size());
    all += Paint(text.substr(0, line_end),
                 IsError(finding.severity) ? Colour::kRed : Colour::kYellow, colour) +
           text.substr(line_end) + "\n";
  }
  if (dropped > 0) all += "and " + std::to_string(dropped) + " more findings\n";
  return all;
}

}  // namespace

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
