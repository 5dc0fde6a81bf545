#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/rml1/board/contours.h"
#include "engine/rml1/board/distance_field.h"
#include "engine/rml1/board/png_bitmap.h"
#include "engine/rml1/board/simplify.h"

// Lines and pictures that are smaller than others. docs/boards.md
namespace rmlcell::rml1 {
namespace {

// The first point and the one furthest from it stay, also where that is nearer than 1.
TEST(LeastBoard, ASmallLineIsTwoOpenOnes) {
  EXPECT_EQ(Simplified({{0, 0}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}}, 0.8), (Loop{{0, 0}, {0.5, 0.5}}));
  // 0.05 beside the chord from (0,0) to (0.9,0), and 0.45 from its ends.
  EXPECT_EQ(Simplified({{0, 0}, {0.45, 0.05}, {0.9, 0}, {0.45, -0.3}}, 0.1),
            (Loop{{0, 0}, {0.9, 0}, {0.45, -0.3}}));
}

// A point behind the end of a chord is as far off as that end: 1.0 from (3,5), though 0.86 from
// the line on.
TEST(LeastBoard, APointBehindTheEndOfAChord) {
  const Loop loop = {{0, 0}, {4, 4.99}, {3, 5}, {10, 0}};
  EXPECT_EQ(Simplified(loop, 0.9), loop);
}

// distance_field.h: so many pixels without copper on each side.
TEST(LeastBoard, TheMarginIsOnEachSide) {
  const DistanceField field = DistanceToCopper({.width = 2, .height = 1, .copper = {1, 0}}, 3);
  EXPECT_EQ(field.width, 8U);
  EXPECT_EQ(field.height, 7U);
  ASSERT_EQ(field.values.size(), 56U);
  EXPECT_EQ(field.at(3, 3), 0.0F);
  EXPECT_EQ(field.at(4, 3), 1.0F);
  EXPECT_EQ(field.at(0, 3), 3.0F);
  EXPECT_EQ(field.at(7, 3), 4.0F);
  EXPECT_EQ(field.at(3, 0), 3.0F);
  EXPECT_EQ(field.at(3, 6), 3.0F);
}

// A picture of no pixels has no distances and no lines.
TEST(LeastBoard, APictureOfNothing) {
  for (const Bitmap& nothing : {Bitmap{.width = 0, .height = 0, .copper = {}},
                                Bitmap{.width = 3, .height = 0, .copper = {}},
                                Bitmap{.width = 0, .height = 3, .copper = {}}}) {
    const DistanceField field = DistanceToCopper(nothing, 0);
    EXPECT_EQ(field.width, nothing.width);
    EXPECT_EQ(field.height, nothing.height);
    EXPECT_TRUE(field.values.empty());
    EXPECT_TRUE(ContoursAt(field, 1.0).empty());
  }
}

}  // namespace
}  // namespace rmlcell::rml1
