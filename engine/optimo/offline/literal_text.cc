#include "engine/optimo/offline/literal_text.h"

#include <string>

#include "engine/core/number_text.h"

namespace rmlcell::optimo {

std::optional<double> LiteralValue(std::string_view text) {
  std::string packed;
  bool negative = false;
  for (const char c : text) {
    if (c == ' ' || c == '\t' || c == '\r' || c == '\n') continue;
    if (packed.empty() && (c == '+' || c == '-')) {
      negative = negative != (c == '-');
      continue;
    }
    if (c == '+') continue;  // of the exponent
    packed += c;
  }
  const std::optional<double> value = ParseDouble(packed);
  if (!value) return std::nullopt;
  return negative ? -*value : *value;
}

std::optional<double> PlainNumber(const ParsedProgram& program, std::uint32_t expression) {
  const ExprRange range = program.module.Range(expression);
  const ExprNode& node = program.module.nodes[range.first];
  if (range.count != 1 || node.name != kNoName ||
      (node.op != Node::kInteger && node.op != Node::kReal)) {
    return std::nullopt;
  }
  const NodePlace& place = program.node_places[range.first];
  return LiteralValue(program.text.substr(place.offset, place.length));
}

}  // namespace rmlcell::optimo
