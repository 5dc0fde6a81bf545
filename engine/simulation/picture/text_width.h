#pragma once

#include <string>
#include <string_view>

#include "engine/simulation/picture/svg_shapes.h"

// How wide text comes out on a picture. Who draws it has one of several fonts: what is told is that
// of the widest of them, so that what fits here fits.
namespace rmlcell::simulation {

inline constexpr double kTextGap = 24.0;  // px, between texts of one line

// In pixels, of UTF-8 text. What no table has counts as wide as it is high.
double TextWidth(std::string_view text, const TextStyle& style);

// The text, or as much of its beginning as fits with an ellipsis behind it. No character is cut in
// two; where not even the ellipsis fits, that alone.
std::string Fitted(std::string_view text, double width_px, const TextStyle& style);

}  // namespace rmlcell::simulation
