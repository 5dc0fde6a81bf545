#include "engine/simulation/material/target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "engine/simulation/material/milling_recorder.h"
#include "tests/engine/simulation/png_picture.h"

namespace rmlcell::simulation {
namespace {

// 10 x 8 cells of 0.5 mm, 2 mm thick.
constexpr Stock kTargetBlock{.x_min = 1.0,
                             .x_max = 6.0,
                             .y_min = -2.0,
                             .y_max = 2.0,
                             .bottom = -2.0,
                             .top = 0.0,
                             .cell = 0.5};

HeightField TargetBlock() { return HeightField::Of(kTargetBlock).value(); }

Target AllAt(float height, double tolerance_mm = 0.1) {
  return {.heights = std::make_shared<const std::vector<float>>(80, height),
          .tolerance_mm = tolerance_mm};
}

Target With(const Target& target, std::size_t cell, float height) {
  std::vector<float> heights = *target.heights;
  heights[cell] = height;
  return {.heights = std::make_shared<const std::vector<float>>(std::move(heights)),
          .tolerance_mm = target.tolerance_mm};
}

// An untouched block of 5 x 4 mm whose target is 0.75 mm lower: all of it is left.
TEST(Target, WhatStandsAboveItIsLeft) {
  const TargetFigures figures = CompareWithTarget(TargetBlock(), AllAt(-0.75f));
  EXPECT_EQ(figures.left_mm, 0.75);
  EXPECT_NEAR(figures.left_mm3, 5.0 * 4.0 * 0.75, 1e-9);
  EXPECT_EQ(figures.left_at, (PlanePlace{1.25, -1.75}));  // the first cell of those equal
  EXPECT_EQ(figures.deep_mm, 0.0);
  EXPECT_EQ(figures.good_percent, 0.0);
  EXPECT_NEAR(figures.compared_mm2, 20.0, 1e-9);
  EXPECT_EQ(figures.tolerance_mm, 0.1);
}

// Two by two cells 0.5 mm deeper than a target of 1 mm: 4 of 80 are bad. The wall is none: the
// cells beside it have the target of one side or the other.
TEST(Target, WhatIsBelowItIsTooDeep) {
  HeightField field = TargetBlock();
  field.Cut({.radius_mm = 50.0}, {3, 0, -1}, {3, 0, -1});
  field.Cut({.radius_mm = 0.4}, {4, 1, -1.5}, {4, 1, -1.5});
  const TargetFigures figures = CompareWithTarget(field, AllAt(-1.0f));
  EXPECT_EQ(figures.deep_mm, 0.5);
  EXPECT_NEAR(figures.deep_mm3, 4 * 0.25 * 0.5, 1e-9);
  EXPECT_EQ(figures.deep_at, (PlanePlace{3.75, 0.75}));
  EXPECT_EQ(figures.left_mm, 0.0);
  EXPECT_NEAR(figures.good_percent, 95.0, 1e-9);
}

// A wall may stand off by one cell, in each direction, and not by two.
TEST(Target, AWallMayStandOffByACell) {
  const auto stands_off = [](int cells) {
    HeightField field = TargetBlock();
    std::vector<float> heights(80, 0.0f);
    for (std::size_t row = 0; row < 8; ++row) {
      for (std::size_t column = 0; column < 4; ++column) heights[row * 10 + column] = -1.0f;
    }
    const double edge = 1.0 + 0.5 * (4 + cells);
    for (double y = -2.0; y <= 2.0; y += 0.5)
      field.Cut({.radius_mm = 1.0}, {-9, y, -1}, {edge - 1.0, y, -1});
    return CompareWithTarget(
        field, {.heights = std::make_shared<const std::vector<float>>(std::move(heights))});
  };
  for (const int cells : {-1, 0, 1}) EXPECT_EQ(stands_off(cells).good_percent, 100.0) << cells;
  EXPECT_EQ(stands_off(2).deep_mm, 1.0);
  EXPECT_EQ(stands_off(-2).left_mm, 1.0);
}

// So may one along X: rows are neighbours as columns are.
TEST(Target, AWallAlongXMayStandOffByACell) {
  const auto stands_off = [](int cells) {
    HeightField field = TargetBlock();
    std::vector<float> heights(80, 0.0f);
    for (std::size_t cell = 0; cell < 40; ++cell) heights[cell] = -1.0f;  // four of eight rows
    const double edge = -2.0 + 0.5 * (4 + cells);
    for (double x = 1.0; x <= 6.0; x += 0.5)
      field.Cut({.radius_mm = 1.0}, {x, -9, -1}, {x, edge - 1.0, -1});
    return CompareWithTarget(
        field, {.heights = std::make_shared<const std::vector<float>>(std::move(heights))});
  };
  for (const int cells : {-1, 0, 1}) EXPECT_EQ(stands_off(cells).good_percent, 100.0) << cells;
  EXPECT_EQ(stands_off(2).deep_mm, 1.0);
  EXPECT_EQ(stands_off(-2).left_mm, 1.0);
}

// Just the tolerance is good; a cell of which the target says nothing is not compared, and is no
// neighbour either. Nothing is asked for below the block.
TEST(Target, HasATolerance) {
  EXPECT_EQ(CompareWithTarget(TargetBlock(), AllAt(-0.5f, 0.5)).good_percent, 100.0);
  EXPECT_EQ(CompareWithTarget(TargetBlock(), AllAt(-0.5f, 0.499)).good_percent, 0.0);
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  const TargetFigures figures = CompareWithTarget(TargetBlock(), With(AllAt(-0.5f), 11, nothing));
  EXPECT_NEAR(figures.compared_mm2, 79 * 0.25, 1e-9);
  EXPECT_NEAR(figures.left_mm3, 79 * 0.25 * 0.5, 1e-9);
  EXPECT_EQ(CompareWithTarget(TargetBlock(), AllAt(nothing)).good_percent, 0.0);
  HeightField through = TargetBlock();
  through.Cut({.radius_mm = 50.0}, {3, 0, -3}, {3, 0, -3});
  EXPECT_EQ(CompareWithTarget(through, AllAt(-9.0f)).good_percent, 100.0);
  EXPECT_EQ(CompareWithTarget(TargetBlock(), AllAt(-9.0f)).left_mm, 2.0);
}

// Less than half a micrometre is rounding, either way; and 0.1 mm in single precision, a little
// more than in double, is within 0.1 mm.
TEST(Target, RoundingIsNoDifference) {
  const auto compared = [](float height, double tolerance_mm) {
    HeightField field = TargetBlock();
    field.Cut({.radius_mm = 50.0}, {3, 0, -1}, {3, 0, -1});
    return CompareWithTarget(field, AllAt(height, tolerance_mm));
  };
  for (const float rounded : {-1.0004f, -0.9996f}) {
    const TargetFigures figures = compared(rounded, 0.0);
    EXPECT_EQ(figures.good_percent, 100.0) << rounded;
    EXPECT_EQ(figures.left_mm + figures.deep_mm + figures.left_mm3 + figures.deep_mm3, 0.0);
  }
  EXPECT_NEAR(compared(-0.9994f, 0.0).deep_mm, 0.0006, 1e-6);
  EXPECT_NEAR(compared(-1.0006f, 0.0).left_mm, 0.0006, 1e-6);
  EXPECT_EQ(compared(-0.89999998f, 0.1).good_percent, 100.0);
  EXPECT_EQ(compared(-0.8999f, 0.1).good_percent, 0.0);
}

TEST(Target, BelongsToTheCellsOfItsBlock) {
  Milling milling{.stock = kTargetBlock, .tool = {.radius_mm = 1.0}, .target = AllAt(0.0f)};
  EXPECT_TRUE(CheckMilling(milling));
  milling.target->tolerance_mm = 0.0;
  EXPECT_TRUE(CheckMilling(milling));
  milling.target->tolerance_mm = -0.1;
  EXPECT_FALSE(CheckMilling(milling));
  milling.target = AllAt(0.0f);
  milling.stock.cell = 1.0;
  EXPECT_FALSE(CheckMilling(milling));
}

// Of a target 1 mm below the top: a pit of 1.5 mm is half a millimetre too deep, ground at -1 good,
// the rest left untouched. From grey (214) by 0.3 to the full colour at ten times the tolerance, 1
// mm: red by 0.3 + 0.7 / 2, blue by all of it.
TEST(Target, IsDrawnWhereItDiffers) {
  HeightField field = TargetBlock();
  field.Cut({.radius_mm = 1.1}, {2, -1, -1}, {2, 1, -1});
  field.Cut({.radius_mm = 0.4}, {2, 0, -1.5}, {2, 0, -1.5});
  const Target target = With(AllAt(-1.0f), 79, std::numeric_limits<float>::quiet_NaN());
  std::string bytes;
  EXPECT_TRUE(WriteDifference(field, target, [&](std::string_view part) {
    bytes += part;
    return true;
  }));
  const PngPicture picture(bytes);
  EXPECT_EQ(picture.width, 10u);
  EXPECT_EQ(picture.height, 8u);
  EXPECT_EQ(picture.At(1, 3), (Rgb{198, 75, 75}));    // 214 - 0.65 * 24, 214 - 0.65 * 214
  EXPECT_EQ(picture.At(2, 6), (Rgb{214, 214, 214}));  // milled as it should be
  EXPECT_EQ(picture.At(8, 7), (Rgb{0, 60, 200}));     // 1 mm left
  EXPECT_EQ(picture.At(9, 0), (Rgb{255, 255, 255}));  // the target says nothing of the last cell
  EXPECT_FALSE(WriteDifference(field, target, [](std::string_view) { return false; }));
}

}  // namespace
}  // namespace rmlcell::simulation
