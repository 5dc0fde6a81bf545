#include "engine/simulation/material/png.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "tests/engine/simulation/png_chunks.h"

namespace rmlcell::simulation {
namespace {

// The pixels in a metre that a picture of one pixel says it has; nothing: it does not say so.
std::optional<std::uint32_t> PixelsToldOf(double pixel_mm) {
  std::string bytes;
  EXPECT_TRUE(WritePng(
      {.width = 1, .height = 1, .pixel_mm = pixel_mm},
      [](std::size_t, std::span<std::uint8_t> row) { std::ranges::fill(row, 0); },
      [&](std::string_view part) {
        bytes += part;
        return true;
      }));
  for (const PngChunk& chunk : ChunksOf(bytes)) {
    if (chunk.type != "pHYs") continue;
    EXPECT_EQ(chunk.data.size(), 9u);
    EXPECT_EQ(BigEndian(std::string_view(chunk.data).substr(4)), BigEndian(chunk.data));
    EXPECT_EQ(chunk.data[8], 1);  // metres
    return BigEndian(chunk.data);
  }
  return std::nullopt;
}

// PNG 11.3.4.3: whole pixels in a metre, from 1 to what 31 bits hold.
TEST(Png, TellsItsPixelsInAMetreWhereItCan) {
  EXPECT_EQ(PixelsToldOf(0.1), 10000u);
  EXPECT_EQ(PixelsToldOf(0.3), 3333u);
  EXPECT_EQ(PixelsToldOf(1000.0), 1u);
  EXPECT_EQ(PixelsToldOf(1999.0), 1u);
  EXPECT_EQ(PixelsToldOf(2001.0), std::nullopt);
  EXPECT_EQ(PixelsToldOf(1000.0 / 2147483647.0), 2147483647u);
  EXPECT_EQ(PixelsToldOf(1000.0 / 2147483648.0), std::nullopt);
  EXPECT_EQ(PixelsToldOf(0.0), std::nullopt);
  EXPECT_EQ(PixelsToldOf(-0.1), std::nullopt);
}

// Whoever takes no byte of a picture is offered the first ones alone, and no row is made.
TEST(Png, WhatNobodyTakesIsNotMade) {
  int offered = 0;
  int rows = 0;
  const bool written = WritePng(
      {.width = 2, .height = 3},
      [&](std::size_t, std::span<std::uint8_t> row) {
        std::ranges::fill(row, std::uint8_t{0});
        ++rows;
      },
      [&](std::string_view part) {
        if (!part.empty()) ++offered;
        return part.empty();
      });
  EXPECT_FALSE(written);
  EXPECT_EQ(offered, 1);
  EXPECT_EQ(rows, 0);
}

}  // namespace
}  // namespace rmlcell::simulation
