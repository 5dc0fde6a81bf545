#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/result.h"

// Pictures as PNG, by libpng, from and into memory. Nothing in them depends on when they are made.
namespace rmlcell::simulation {

struct PngHeading {
  enum class Form { kGrey16, kColour8 };  // 2 bytes a pixel, the high one first; 3 bytes: R, G, B

  std::size_t width = 0;
  std::size_t height = 0;
  Form form = Form::kGrey16;
  double pixel_mm = 0.0;                                     // its edge; 0: not told
  std::vector<std::pair<std::string, std::string>> texts{};  // key and value, both Latin-1
};

// `row` fills the bytes of one row, the uppermost first. The bytes are valid during the call of
// `sink`; it returns false when it wants no more, and so does this. Before each row it is asked
// with no bytes: what packs well is long in the making. Precondition: the picture has a width and a
// height; no key is longer than 79 bytes.
bool WritePng(const PngHeading& heading,
              const std::function<void(std::size_t, std::span<std::uint8_t>)>& row,
              const std::function<bool(std::string_view)>& sink);

struct GreyPicture {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint16_t> grey{};  // row by row, the uppermost first
  std::vector<std::pair<std::string, std::string>> texts{};
};

// Reads a grey picture of 16 bits. Errors: CellBadText for what is no PNG, is damaged, has another
// form, or more than HeightField::kCellsMax pixels.
Result<GreyPicture> ReadGreyPng(std::string_view bytes);

}  // namespace rmlcell::simulation
