#include "engine/core/diagnostic.h"

#include <algorithm>

#include "engine/core/number_text.h"

namespace rmlcell {
namespace {

// Wider lines are shown around the caret only: a generated file may be one line of megabytes.
constexpr std::size_t kShownBytes = 100;

std::string_view LineAt(std::string_view source, int line) {
  std::size_t begin = 0;
  for (int i = 1; i < line; ++i) {
    const std::size_t end = source.find('\n', begin);
    if (end == std::string_view::npos) return {};
    begin = end + 1;
  }
  std::string_view text = source.substr(begin, source.find('\n', begin) - begin);
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  return text;
}

// The line and a caret line below it. Bytes that a terminal would act on are shown as '?'.
std::string CaretLines(std::string_view line, const SourceSpan& where) {
  const auto column = static_cast<std::size_t>(std::max(where.column, 1) - 1);
  const std::size_t from = std::max(column, kShownBytes / 2) - kShownBytes / 2;
  std::string shown(line.substr(std::min(from, line.size()), kShownBytes));
  if (shown.empty()) return {};
  for (char& c : shown) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte != '\t' && (byte < 0x20 || byte == 0x7F)) c = '?';
  }
  std::string caret = shown.substr(0, column - from);
  for (char& c : caret) {
    if (c != '\t') c = ' ';
  }
  caret += '^';
  const std::size_t end = column + static_cast<std::size_t>(std::max(where.length, 0));
  for (std::size_t i = column + 1; i < std::min(end, from + shown.size()); ++i) caret += '~';
  return "\n  " + shown + "\n  " + caret;
}

}  // namespace

bool IsError(Severity severity) {
  return severity != Severity::kAdvice && severity != Severity::kWarning &&
         severity != Severity::kMessage && severity != Severity::kDevice;
}

bool HasErrors(std::span<const Diagnostic> findings) {
  return std::ranges::any_of(findings,
                             [](const Diagnostic& finding) { return IsError(finding.severity); });
}

std::string_view FindingWord(const Diagnostic& finding) {
  if (IsError(finding.severity)) return "error";
  switch (finding.judged) {
    case Judged::kBad:
      return "BAD";
    case Judged::kDoubtful:
      return "DOUBTFUL";
    case Judged::kNo:
      break;
  }
  return SeverityName(finding.severity);
}

Detail Said(ErrorCode code, const Detail& detail) {
  return detail.empty() ? Detail(std::string(Lookup(code).when)) : detail;
}

std::string FormatDiagnostic(const Diagnostic& diagnostic, std::string_view source) {
  const CatalogueEntry& entry = Lookup(diagnostic.code);
  std::string text = diagnostic.file.empty() && diagnostic.program > 0
                         ? "program " + std::to_string(diagnostic.program)
                         : diagnostic.file;
  if (diagnostic.where.line > 0) {
    if (!text.empty()) text += ':';
    text += std::to_string(diagnostic.where.line);
    if (diagnostic.where.column > 0) text += ':' + std::to_string(diagnostic.where.column);
  }
  if (!text.empty()) text += ": ";
  text += FindingWord(diagnostic);
  text += ' ' + CodeText(diagnostic.code) + ": ";
  text += Said(diagnostic.code, diagnostic.detail);
  if (diagnostic.step > 0) {
    text += " (step " + std::to_string(diagnostic.step);
    if (diagnostic.at) text += ", at " + FixedText(ToSeconds(*diagnostic.at), 3) + " s";
    text += ')';
  }
  if (!diagnostic.rule.empty()) text += " [" + diagnostic.rule + ']';
  if (IsError(diagnostic.severity) || diagnostic.severity == Severity::kDevice)
    text += "; " + std::string(entry.advice);
  if (diagnostic.where.line > 0 && !source.empty()) {
    const std::string_view line = LineAt(source, diagnostic.where.line);
    if (!line.empty()) text += CaretLines(line, diagnostic.where);
  }
  return text;
}

}  // namespace rmlcell
