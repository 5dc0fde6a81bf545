#include "engine/optimo/language/fixes.h"

#include <algorithm>
#include <iterator>
#include <map>

#include "engine/optimo/language/lexer.h"

namespace rmlcell::optimo {

std::optional<Fix> AttributeRemoval(const ParsedProgram& program, const Instruction& instruction,
                                    Word word) {
  const Place place = program.At(instruction);
  const auto begin = static_cast<std::size_t>(place.offset);
  std::vector<Comment> comments;
  const std::string_view text = program.text.substr(begin, static_cast<std::size_t>(place.length));
  Lexer lexer(text, comments);
  if (!lexer.NextStatement()) return std::nullopt;
  for (std::size_t t = 1; lexer.At(t).kind != TokenKind::kEnd; ++t) {
    if (lexer.At(t).kind != TokenKind::kWord || lexer.At(t).word != word) continue;
    const Token slash = lexer.At(t - 1);
    if (slash.kind != TokenKind::kSlash) continue;
    std::size_t from = slash.offset;
    while (from > 0 && (text[from - 1] == ' ' || text[from - 1] == '\t')) --from;
    const std::size_t end = lexer.At(t).offset + lexer.At(t).length;
    // A statement goes on behind a '/' at the end of a line: comments in between stay.
    const std::size_t behind = slash.offset + slash.length;
    std::string_view between = text.substr(behind, lexer.At(t).offset - behind);
    if (between.find_first_not_of(" \t") == std::string_view::npos) between = {};
    return Fix{static_cast<std::int64_t>(begin + from), static_cast<int>(end - from),
               std::string(between)};
  }
  return std::nullopt;
}

std::vector<std::size_t> RepairableFindings(std::string_view text,
                                            std::span<const Diagnostic> diagnostics) {
  std::map<std::int64_t, std::int64_t> taken;  // begin and end of what changes
  const auto is_free = [&](const Fix& fix) {
    const std::int64_t end = fix.byte_offset + fix.length;
    if (fix.byte_offset < 0 || fix.length < 0 || end > static_cast<std::int64_t>(text.size()))
      return false;
    const auto next = taken.lower_bound(fix.byte_offset);
    if (next != taken.end() && (next->first < end || next->first == fix.byte_offset)) return false;
    return next == taken.begin() || std::prev(next)->second <= fix.byte_offset;
  };
  std::vector<std::size_t> chosen;
  for (std::size_t d = 0; d < diagnostics.size(); ++d) {
    const std::vector<Fix>& fixes = diagnostics[d].fixes;
    if (fixes.empty() || !std::ranges::all_of(fixes, is_free)) continue;
    for (const Fix& fix : fixes) taken[fix.byte_offset] = fix.byte_offset + fix.length;
    chosen.push_back(d);
  }
  return chosen;
}

std::string ApplyFixes(std::string_view text, std::span<const Diagnostic> diagnostics) {
  std::vector<const Fix*> fixes;
  for (const std::size_t d : RepairableFindings(text, diagnostics)) {
    for (const Fix& fix : diagnostics[d].fixes) fixes.push_back(&fix);
  }
  std::ranges::sort(fixes, {}, [](const Fix* fix) { return fix->byte_offset; });
  std::string out;
  std::size_t at = 0;
  for (const Fix* fix : fixes) {
    const auto offset = static_cast<std::size_t>(fix->byte_offset);
    if (offset < at) continue;  // two fixes of one finding
    out += text.substr(at, offset - at);
    out += fix->text;
    at = offset + static_cast<std::size_t>(fix->length);
  }
  out += text.substr(at);
  return out;
}

}  // namespace rmlcell::optimo
