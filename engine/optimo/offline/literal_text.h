#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// The value of a literal as it stands in a source, in double precision: signs, digits, exponent
// with blanks (".256 E -3"). Nothing when the text is no literal.
std::optional<double> LiteralValue(std::string_view text);

// The value of an expression that is a plain number in the text; nothing for names (declared
// constants included, also when they are resolved), variables and what is computed.
// Precondition: the program has its node places.
std::optional<double> PlainNumber(const ParsedProgram& program, std::uint32_t expression);

}  // namespace rmlcell::optimo
