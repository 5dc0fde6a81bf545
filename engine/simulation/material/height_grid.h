#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/simulation/material/height_field.h"

namespace rmlcell::simulation {

// The heights of a block as numbers that a browser reads as they are, of which a picture has 8 bits
// only (docs/material.md). 64 bytes, then 2 a cell, least significant byte first:
//   0   "RMLCELLH"
//   8   version, 1; columns; rows; 0: 4 bytes each
//   24  least X, least Y, edge of a cell, height of 0 and height of 65535, all mm: 8 bytes each
//   64  the heights, linear between those two, row by row from the least Y on
// The bytes are valid during the call of `sink`; it returns false when it wants no more, and so
// does this.
bool WriteHeightGrid(const HeightField& field, const std::function<bool(std::string_view)>& sink);

// One height more, and the one at an index.
void AddHeight(std::uint16_t number, std::string& bytes);
std::uint16_t HeightAt(std::string_view bytes, std::size_t index);

struct HeightGridHead {
  HeightField::Size size{};  // in cells
  double left = 0.0;         // least X and Y, edge of a cell, heights of 0 and 65535: mm
  double front = 0.0;
  double cell = 0.0;
  double bottom = 0.0;
  double top = 0.0;

  bool operator==(const HeightGridHead&) const = default;
};
inline constexpr std::size_t kHeightGridHeadBytes = 64;
HeightGridHead HeadOf(const HeightField& field);
// Of the bytes that a grid begins with. CellBadText: it is none.
Result<HeightGridHead> ReadHeightGridHead(std::string_view bytes);

// The height as a number of 16 bits: 0 at the bottom of the block, 65535 at its top.
std::uint16_t HeightNumber(const Stock& stock, float height);

}  // namespace rmlcell::simulation
