#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace rmlcell::simulation {

using Rgb = std::array<int, 3>;

// By the simple half of libpng, which shares nothing with ours.
struct PngPicture {
  explicit PngPicture(const std::string& bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
    image.format = PNG_FORMAT_RGB;
    width = image.width;
    height = image.height;
    pixels.resize(PNG_IMAGE_SIZE(image));
    EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
  }
  Rgb At(std::size_t column, std::size_t row_from_above) const {
    const std::size_t at = 3 * (row_from_above * width + column);
    return {pixels[at], pixels[at + 1], pixels[at + 2]};
  }
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint8_t> pixels;
};

}  // namespace rmlcell::simulation
