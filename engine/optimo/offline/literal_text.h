#pragma once

#include <optional>
#include <string_view>

namespace rmlcell::optimo {

// The value of a literal as it stands in a source, in double precision: signs, digits, exponent
// with blanks (".256 E -3"). Nothing when the text is no literal.
std::optional<double> LiteralValue(std::string_view text);

}  // namespace rmlcell::optimo
