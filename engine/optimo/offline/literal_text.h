#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// The value of a literal as it stands in a source, in double precision: signs, digits, exponent
// with blanks (".256 E -3"). Nothing when the text is no literal.
std::optional<double> LiteralValue(std::string_view text);

// What to replace to give a plain number another value: all of it, or of "-(4.)" the "4." within.
struct NumberPlace {
  std::uint32_t offset = 0;
  std::uint32_t length = 0;
  bool negated = false;  // the new text is the number with its sign turned

  double Written(double value) const { return negated ? 0.0 - value : value; }
};
// Precondition: the node is a literal, and the program has its node places.
NumberPlace PlaceOfNumber(const ParsedProgram& program, std::uint32_t node);

// The value of an expression that is a plain number in the text; nothing for names (declared
// constants included, also when they are resolved), variables and what is computed.
// Precondition: the program has its node places.
std::optional<double> PlainNumber(const ParsedProgram& program, std::uint32_t expression);

}  // namespace rmlcell::optimo
