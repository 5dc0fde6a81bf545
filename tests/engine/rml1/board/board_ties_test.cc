// Lines without a width, places as near as others, and pictures that cannot be
// read.
#include <gtest/gtest.h>
#include <png.h>

#include <string>
#include <vector>

#include "engine/rml1/board/contours.h"
#include "engine/rml1/board/distance_field.h"
#include "engine/rml1/board/nearest_order.h"
#include "engine/rml1/board/png_bitmap.h"
#include "engine/rml1/board/simplify.h"
#include "tests/engine/rml1/board/made_board.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// Of an area is what lies between its corners: a point that was taken off again
// is none of them.
TEST(BoardTies, AnAreaHasTheCornersThatAreLeft) {
  Loop loop = {{1, 1}, {5, 1}, {5, 4}, {-20, 30}};
  loop.pop_back();
  EXPECT_NEAR(SignedArea(loop), 6.0, 1e-12);
}

// board_stream.h: holes come first. The middle of a hole of three pixels is two
// pixels from the copper, which is how far the line of the thinnest tool is: a
// line without a width, in a hole all the same, although the edge of the board
// begins nearer to where the tool stands.
TEST(BoardTies, AHoleWithoutAWidthIsCutFirst) {
  Bitmap board{.width = 9, .height = 30, .copper = std::vector<std::uint8_t>(9 * 30, 1)};
  for (std::size_t y = 24; y < 27; ++y) {
    for (std::size_t x = 3; x < 6; ++x) board.copper[y * 9 + x] = 0;
  }
  const auto made = StreamOfBoard(
      board, ParametersOf("srm-20"),
      {.pixel_mm = 1.0, .tool_mm = 0.01, .outline = true, .at_x_mm = 20, .at_y_mm = 20});
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->loops, 2U);
  // The pixel in the middle of it is 4.5 and 25.5 mm from the corner, the
  // edge 1.5 mm below it.
  const std::size_t hole = made->stream.find("2450,4550");
  const std::size_t edge = made->stream.find(",1850");
  ASSERT_NE(hole, std::string::npos) << made->stream;
  ASSERT_NE(edge, std::string::npos) << made->stream;
  EXPECT_LT(hole, edge);
}

// Of places that are as near the first one is taken, on whichever side it lies.
TEST(BoardTies, TheFirstOfTwoThatAreAsNear) {
  const std::vector<std::size_t> in_order = {0, 1};
  for (const PlanePoint side : {PlanePoint{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
    const PlanePoint other{-side.x, -side.y};
    EXPECT_EQ(NearestOrder(std::vector<PlanePoint>{side, other}, {0, 0}), in_order);
    EXPECT_EQ(NearestOrder(std::vector<PlanePoint>{other, side}, {0, 0}), in_order);
  }
}

// simplify.h: lines of less than a pixel are simplified as any other one; a
// point behind the end of one is as far off as that end.
TEST(BoardTies, ShortLinesAndWhatLiesBehindTheirEnds) {
  const Loop small = {{0, 0}, {0.5, 0.02}, {0.9, 0}, {0.45, -0.3}};
  EXPECT_EQ(Simplified(small, 0.1), (Loop{{0, 0}, {0.9, 0}, {0.45, -0.3}}));
  EXPECT_EQ(Simplified(small, 0.95), (Loop{{0, 0}, {0.9, 0}}));
  const Loop behind = {{0, 0}, {10, 0}, {5, -3}, {-2, 0}};
  EXPECT_EQ(Simplified(behind, 1.9), behind);
  EXPECT_EQ(Simplified(behind, 2.1), (Loop{{0, 0}, {10, 0}, {5, -3}}));
}

std::string GrayRowsPng(std::uint32_t width, std::uint32_t height) {
  const std::vector<std::uint8_t> pixels(std::size_t{width} * height, 255);
  png_image image{
      .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_GRAY};
  png_alloc_size_t size = 0;
  EXPECT_NE(png_image_write_get_memory_size(image, size, 0, pixels.data(), 0, nullptr), 0);
  std::string bytes(size, '\0');
  EXPECT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr),
            0);
  bytes.resize(size);
  return bytes;
}

// png_bitmap.h: what is wrong with it is told as it was found first, and a
// picture of which a part is damaged is none.
TEST(BoardTies, WhatIsWrongWithAPicture) {
  const auto none = ReadPng("GIF89a, and more than a signature has", false);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kRml1BadPicture);
  EXPECT_NE(static_cast<std::string>(none.error().detail).find("PNG"), std::string::npos)
      << none.error().detail;
  std::string damaged = GrayRowsPng(40, 30);
  const std::size_t data = damaged.find("IDAT") + 4;
  damaged[data + 4] = static_cast<char>(damaged[data + 4] ^ 0x55);
  const auto half = ReadPng(damaged, false);
  ASSERT_FALSE(half);
  EXPECT_EQ(half.error().code, ErrorCode::kRml1BadPicture);
}

}  // namespace
}  // namespace rmlcell::rml1
