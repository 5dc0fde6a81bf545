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

}  // namespace rmlcell::optimo
