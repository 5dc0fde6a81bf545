#include "engine/optimo/offline/literal_text.h"

#include <string>

#include "engine/core/number_text.h"

namespace rmlcell::optimo {
namespace {

bool IsDigitOrPoint(char c) { return (c >= '0' && c <= '9') || c == '.'; }

}  // namespace

std::optional<double> LiteralValue(std::string_view text) {
  std::string packed;
  bool negative = false;
  for (const char c : text) {
    if (c == ' ' || c == '\t' || c == '\r' || c == '\n') continue;
    if (packed.empty() && (c == '+' || c == '-')) {
      negative = negative != (c == '-');
      continue;
    }
    packed += c;
  }
  const std::optional<double> value = ParseDouble(packed);
  if (!value) return std::nullopt;
  return negative ? -*value : *value;
}

NumberPlace PlaceOfNumber(const ParsedProgram& program, std::uint32_t node) {
  const NodePlace& place = program.node_places[node];
  const std::string_view text = program.text.substr(place.offset, place.length);
  // A sign apart from its digits, by a parenthesis, a comment or a line, stays where it is.
  if (text.find_first_of("(;\r\n") == std::string_view::npos) return {place.offset, place.length};
  bool negated = false;
  std::size_t begin = 0;
  for (; !IsDigitOrPoint(text[begin]); ++begin) {
    if (text[begin] == '-') negated = !negated;
    if (text[begin] == ';') begin = text.find('\n', begin);  // statements go on over comments
  }
  const std::size_t behind = text.find_first_of(");\r\n", begin);
  const std::size_t end = text.find_last_of("0123456789.", behind) + 1;
  return {place.offset + static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin),
          negated};
}

std::optional<double> PlainNumber(const ParsedProgram& program, std::uint32_t expression) {
  const ExprRange range = program.module.Range(expression);
  const ExprNode& node = program.module.nodes[range.first];
  if (range.count != 1 || !IsLiteral(node)) return std::nullopt;
  const NumberPlace place = PlaceOfNumber(program, range.first);
  const std::optional<double> value = LiteralValue(program.text.substr(place.offset, place.length));
  if (!value) return std::nullopt;
  return place.Written(*value);
}

}  // namespace rmlcell::optimo
