#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rmlcell::rml1 {

// A picture of a board: 1 where copper stays, 0 where it goes. Rows from the bottom up, as Y
// counts.
struct Bitmap {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint8_t> copper;  // width * height

  bool at(std::size_t x, std::size_t y) const { return copper[y * width + x] != 0; }
};

// 200 mm by 150 mm at 1000 dots an inch are 47 million. A board of that many takes some 500 MB.
inline constexpr std::size_t kPixelsMax = 50'000'000;

}  // namespace rmlcell::rml1
