#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "engine/core/result.h"

namespace rmlcell::simulation {

struct StlTriangle {
  std::array<std::array<float, 3>, 3> corners{};  // X, Y, Z of each; mm
};

inline constexpr std::size_t kStlTrianglesMax = 1u << 24;  // 800 MB of binary STL

// Reads binary STL (little-endian) and that of text; normals are not looked at. Errors: CellBadText
// for what is neither, is cut short, has a number that is none, or no triangle; CellTooLarge for
// more than kStlTrianglesMax.
Result<std::vector<StlTriangle>> ReadStl(std::string_view bytes);

// What can be said of an STL by its first bytes and its length. Error: CellBadText.
Status CheckStlBeginning(std::string_view bytes);

}  // namespace rmlcell::simulation
