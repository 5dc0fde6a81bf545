#include "engine/simulation/material/relief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/core/units.h"
#include "tests/engine/simulation/png_picture.h"

namespace rmlcell::simulation {
namespace {

constexpr Rgb kWood = {222, 184, 135};

std::string ReliefOf(const HeightField& field) {
  std::string bytes;
  EXPECT_TRUE(WriteRelief(field, [&](std::string_view part) {
    bytes += part;
    return true;
  }));
  return bytes;
}

HeightField Ten() {
  return HeightField::Of({.x_max = 10.0, .y_max = 8.0, .bottom = -2.0, .top = 0.0, .cell = 0.5})
      .value();
}

// What no tool touched is the colour of wood all over; the picture is as wide as the block has
// cells.
TEST(Relief, UntouchedGroundIsTheColourOfWood) {
  const PngPicture picture(ReliefOf(Ten()));
  EXPECT_EQ(picture.width, 20u);
  EXPECT_EQ(picture.height, 16u);
  for (std::size_t row = 0; row < 16; ++row) {
    for (std::size_t column = 0; column < 20; ++column) EXPECT_EQ(picture.At(column, row), kWood);
  }
}

// Level ground 1 mm deep in a block of 2: grey (190, 200, 210), half of the way to 0.55 of it, that
// is 0.775; what was cut through is dark blue. The greatest Y is above.
TEST(Relief, GroundIsTheDarkerTheDeeper) {
  HeightField field = Ten();
  field.Cut({.radius_mm = 1.6}, {2, 2, -1}, {2, 2, -1});
  field.Cut({.radius_mm = 1.6}, {8, 6, -2}, {8, 6, -2});
  const PngPicture picture(ReliefOf(field));
  EXPECT_EQ(picture.At(4, 16 - 1 - 4), (Rgb{147, 155, 163}));
  EXPECT_EQ(picture.At(16, 16 - 1 - 12), (Rgb{24, 48, 104}));
  EXPECT_EQ(picture.At(16, 16 - 1 - 4), kWood);
}

// Lit from the upper left: in a round pit the wall at the lower right, which faces the light, is
// brighter than the floor, the one at the upper left darker, by the cosine of the angle.
TEST(Relief, LightComesFromTheUpperLeft) {
  HeightField field =
      HeightField::Of({.x_max = 40.0, .y_max = 40.0, .bottom = -30.0, .top = 0.0, .cell = 0.25})
          .value();
  field.Cut({.shape = MillTool::Shape::kVee, .radius_mm = 16.0, .half_angle_rad = kPi / 4},
            {20, 20, -15}, {20, 20, -15});
  const PngPicture picture(ReliefOf(field));
  // 7.5 mm deep on both sides: 0.8875 of the grey. The wall of 45 degrees to the upper left faces
  // away: 0.25 remains; the one to the lower right has the light straight on: sqrt(2) times it.
  const double away = 0.25;
  const double facing = 0.25 + 0.75 * std::sqrt(2.0);
  const double by_axis = 7.5 / std::sqrt(2.0);
  const auto pixel = [&](double x, double y) {
    return picture.At(static_cast<std::size_t>(x / 0.25),
                      static_cast<std::size_t>((40 - y) / 0.25));
  };
  EXPECT_NEAR(pixel(20 - by_axis, 20 + by_axis)[1], 200 * 0.8875 * away, 3.0);
  EXPECT_NEAR(pixel(20 + by_axis, 20 - by_axis)[1], 200 * 0.8875 * facing, 5.0);
}

// Of 2049 columns a pixel is two by two cells, the last one the rest; the mean of a touched cell
// and three of wood lies between.
TEST(Relief, WideBlocksAreDrawnSmaller) {
  HeightField field =
      HeightField::Of({.x_max = 2049.0, .y_max = 3.0, .bottom = -1.0, .top = 0.0, .cell = 1.0})
          .value();
  field.Cut({.radius_mm = 0.3}, {0.5, 2.5, -9}, {0.5, 2.5, -9});
  const PngPicture picture(ReliefOf(field));
  EXPECT_EQ(picture.width, 1025u);
  EXPECT_EQ(picture.height, 2u);
  EXPECT_EQ(picture.At(1000, 0), kWood);
  EXPECT_EQ(picture.At(1024, 1), kWood);
  EXPECT_LT(picture.At(0, 0)[0], 200);
  EXPECT_GT(picture.At(0, 0)[0], 100);
}

TEST(Relief, TheSameBytesEachTimeAndNoneTooMany) {
  EXPECT_EQ(ReliefOf(Ten()), ReliefOf(Ten()));
  EXPECT_EQ(ReliefOf(Ten()).find("tIME"), std::string::npos);
  EXPECT_FALSE(WriteRelief(Ten(), [](std::string_view) { return false; }));
}

// One cell is level, and so is each of a block that is one cell wide: it is its own neighbour.
TEST(Relief, ACellWithoutNeighboursIsLevel) {
  const PngPicture one(
      ReliefOf(HeightField::Of({.x_max = 1.0, .y_max = 1.0, .bottom = -2.0, .cell = 1.0}).value()));
  ASSERT_EQ(one.width * one.height, 1u);
  EXPECT_EQ(one.At(0, 0), kWood);
  const PngPicture row(
      ReliefOf(HeightField::Of({.x_max = 3.0, .y_max = 1.0, .bottom = -2.0, .cell = 1.0}).value()));
  ASSERT_EQ(row.width, 3u);
  for (std::size_t column = 0; column < 3; ++column) EXPECT_EQ(row.At(column, 0), kWood);
}

}  // namespace
}  // namespace rmlcell::simulation
