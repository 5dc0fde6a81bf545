#include "engine/optimo/language/fixes.h"

#include <algorithm>
#include <vector>

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
    return Fix{static_cast<std::int64_t>(begin + from), static_cast<int>(end - from), ""};
  }
  return std::nullopt;
}

std::string ApplyFixes(std::string_view text, std::span<const Diagnostic> diagnostics) {
  std::vector<Fix> fixes;
  for (const Diagnostic& diagnostic : diagnostics) {
    fixes.insert(fixes.end(), diagnostic.fixes.begin(), diagnostic.fixes.end());
  }
  std::ranges::stable_sort(fixes, {}, &Fix::byte_offset);
  std::string out;
  std::size_t at = 0;
  for (const Fix& fix : fixes) {
    const auto offset = static_cast<std::size_t>(fix.byte_offset);
    if (offset < at || offset > text.size()) continue;
    out += text.substr(at, offset - at);
    out += fix.text;
    at = std::min(text.size(), offset + static_cast<std::size_t>(fix.length));
  }
  out += text.substr(at);
  return out;
}

}  // namespace rmlcell::optimo
