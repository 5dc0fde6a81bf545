#include "engine/optimo/language/fixes.h"

#include "engine/optimo/language/lexer.h"

namespace rmlcell::optimo {

std::optional<Fix> AttributeRemoval(const ParsedProgram& program, const Instruction& instruction,
                                    Word word) {
  const Place place = program.At(instruction);
  const auto begin = static_cast<std::size_t>(place.offset);
  std::vector<Comment> comments;
  const std::string_view text = program.text.substr(begin, static_cast<std::size_t>(place.length));
  Lexer lexer(text, comments);
  lexer.NextStatement();
  // The first attribute can stand behind the word of the instruction and its '/'.
  for (std::size_t t = 2; lexer.At(t).kind != TokenKind::kEnd; ++t) {
    if (lexer.At(t).kind != TokenKind::kWord || lexer.At(t).word != word) continue;
    const Token slash = lexer.At(t - 1);
    if (slash.kind != TokenKind::kSlash) continue;
    const std::size_t from = text.substr(0, slash.offset).find_last_not_of(" \t") + 1;
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

}  // namespace rmlcell::optimo
