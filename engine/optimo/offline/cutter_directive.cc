#include "engine/optimo/offline/cutter_directive.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "engine/core/letters.h"
#include "engine/optimo/offline/literal_text.h"

namespace rmlcell::optimo {
namespace {

constexpr std::string_view kBlanks = " \t\r";

// Nothing before it on its line but a sequence number.
bool IsCommentLine(std::string_view text, std::size_t begin) {
  while (begin > 0 && text[begin - 1] != '\n') {
    const char c = text[--begin];
    if (kBlanks.find(c) == std::string_view::npos &&
        std::isdigit(static_cast<unsigned char>(c)) == 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::optional<CutterDirective> ReadCutterDirective(const ParsedProgram& program,
                                                   const Comment& comment) {
  const std::string_view text = program.text.substr(comment.begin, comment.end - comment.begin);
  if (text.size() < 2 || text[1] != '$' || !IsCommentLine(program.text, comment.begin))
    return std::nullopt;
  std::string word;
  std::size_t at = 2;
  for (; at < text.size() && std::isalpha(static_cast<unsigned char>(text[at])) != 0; ++at)
    word += LowerCase(text[at]);
  at = std::min(text.find_first_not_of(kBlanks, at), text.size());
  const std::size_t end = text.find_last_not_of(kBlanks) + 1;
  CutterDirective directive;
  if ((word == "dia" || word == "rad") && at < end && text[at] == '=') {
    directive.kind =
        word == "dia" ? CutterDirective::Kind::kDiameter : CutterDirective::Kind::kRadius;
    at = std::min(text.find_first_not_of(kBlanks, at + 1), end);
    const std::string_view amount = text.substr(at, end - at);
    directive.amount_begin = comment.begin + static_cast<std::uint32_t>(at);
    directive.amount_end = comment.begin + static_cast<std::uint32_t>(end);
    // One number and nothing else; a literal of the language may have blanks in it, this may not.
    if (amount.find_first_of(kBlanks) == std::string_view::npos)
      directive.amount = LiteralValue(amount);
    return directive;
  }
  if (at < end) return directive;
  if (word.size() > 1 && (word[0] == 'c' || word[0] == 's')) word.erase(0, 1);  // cleft, sright
  const bool none = word == "none", left = word == "left", right = word == "right";
  if (none || left || right) directive.kind = CutterDirective::Kind::kSide;
  if (left) directive.side = CutSide::kLeft;
  if (right) directive.side = CutSide::kRight;
  return directive;
}

}  // namespace rmlcell::optimo
