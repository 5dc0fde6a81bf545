#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/rml1/board/contours.h"
#include "engine/rml1/board/distance_field.h"
#include "engine/rml1/board/joined_traces.h"
#include "engine/rml1/board/nearest_order.h"
#include "engine/rml1/board/simplify.h"
#include "tests/engine/rml1/board/made_board.h"
#include "tests/engine/rml1/run_support.h"

// Shapes that lie off the middle and off the diagonal of their picture, and lines of each length.
namespace rmlcell::rml1 {
namespace {

// A field of nines with two pixels of copper that have a corner in common, right of and above
// (x, y), and between them two of 2: the middle of the four is 1.
DistanceField CornerAt(std::size_t x, std::size_t y, bool rising) {
  DistanceField field{.width = 12, .height = 9};
  field.values.assign(field.width * field.height, 9.0F);
  const auto set = [&](std::size_t column, std::size_t row, float value) {
    field.values[row * field.width + column] = value;
  };
  set(x, y, rising ? 0.0F : 2.0F);
  set(x + 1, y, rising ? 2.0F : 0.0F);
  set(x, y + 1, rising ? 2.0F : 0.0F);
  set(x + 1, y + 1, rising ? 0.0F : 2.0F);
  return field;
}

TEST(BoardShapes, ACornerJoinsWhereverItLies) {
  struct Corner {
    std::size_t x;
    std::size_t y;
  };
  for (const Corner at : {Corner{7, 2}, Corner{2, 6}, Corner{5, 1}, Corner{9, 4}}) {
    for (const bool rising : {false, true}) {
      SCOPED_TRACE(std::to_string(at.x) + " " + std::to_string(at.y));
      const DistanceField field = CornerAt(at.x, at.y, rising);
      EXPECT_EQ(CountJoined(field, 0.5, 0.9).joined, 0U);
      EXPECT_EQ(CountJoined(field, 0.5, 0.9).traces, 2U);
      EXPECT_EQ(CountJoined(field, 0.5, 1.1).joined, 2U);
      EXPECT_EQ(CountJoined(field, 0.5, 1.1).traces, 2U);
      EXPECT_EQ(ContoursAt(field, 0.9).size(), 2U);
      EXPECT_EQ(ContoursAt(field, 1.1).size(), 1U);
    }
  }
}

// All of it is copper, or one pixel at either end: every column keeps its own distance.
TEST(BoardShapes, DistancesInRowsOfEachWidth) {
  for (std::size_t width = 1; width <= 40; ++width) {
    const Bitmap all{
        .width = width, .height = 2, .copper = std::vector<std::uint8_t>(2 * width, 1)};
    const DistanceField none = DistanceToCopper(all, 0);
    ASSERT_EQ(none.values, std::vector<float>(2 * width, 0.0F)) << width;
    Bitmap one{.width = width, .height = 1, .copper = std::vector<std::uint8_t>(width, 0)};
    one.copper.back() = 1;
    const DistanceField far = DistanceToCopper(one, 0);
    for (std::size_t x = 0; x < width; ++x)
      ASSERT_EQ(far.at(x, 0), static_cast<float>(width - 1 - x)) << width;
  }
}

// Out along a line and back: of each loop the first point is left and the one furthest from it.
TEST(BoardShapes, LoopsOfEachLengthLeaveTheirEnds) {
  for (std::size_t furthest = 2; furthest <= 200; ++furthest) {
    const auto out = static_cast<double>(furthest);
    Loop loop;
    for (double x = 0; x <= out; ++x) loop.push_back({3 + x, 7});
    for (double x = out - 1; x > 0; --x) loop.push_back({3 + x, 7});
    ASSERT_EQ(Simplified(loop, 0.5), (Loop{{3, 7}, {3 + out, 7}})) << furthest;
    loop.push_back({3.25, 7});
    ASSERT_EQ(Simplified(loop, 0.5), (Loop{{3, 7}, {3 + out, 7}})) << furthest;
  }
}

// What is furthest is so from the first point, wherever that lies: the point beside it goes. The
// same upright and lying.
TEST(BoardShapes, TheFurthestIsSoFromTheFirst) {
  const auto simple = [](Loop loop, double tolerance) {
    const Loop upright = Simplified(loop, tolerance);
    for (PlanePoint& p : loop) std::swap(p.x, p.y);
    Loop lying = Simplified(loop, tolerance);
    for (PlanePoint& p : lying) std::swap(p.x, p.y);
    EXPECT_EQ(lying, upright);
    return upright;
  };
  EXPECT_EQ(simple({{0, 10}, {0, 10.5}, {0, -20}, {5, -5}}, 1.0),
            (Loop{{0, 10}, {0, -20}, {5, -5}}));
  EXPECT_EQ(simple({{0, 10}, {0, -30}, {5, -5}, {0, 10.5}}, 1.0),
            (Loop{{0, 10}, {0, -30}, {5, -5}}));
  // Of two that are as far away, 5 each, the first.
  EXPECT_EQ(simple({{0, 0}, {5, 0}, {4, 3}, {-1, 1}}, 3.2), (Loop{{0, 0}, {5, 0}}));
  EXPECT_EQ(simple({{0, 0}, {4, 3}, {5, 0}, {-1, 1}}, 3.2), (Loop{{0, 0}, {4, 3}}));
}

// A point that was taken off again is none of it, though it still lies behind the last one.
TEST(BoardShapes, APointTakenOffIsNoneOfALoop) {
  Loop loop = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {90, 90}};
  loop.pop_back();
  EXPECT_EQ(Simplified(loop, 5.0), (Loop{{0, 0}, {1, 1}}));
}

// Places in the third quadrant, beginning in each: the way is one line from end to end.
TEST(BoardShapes, TheNearestBelowTheOrigin) {
  const std::vector<PlanePoint> row = {{-9, -40}, {-3, -40}, {-7, -40}, {-1, -40}, {-5, -40}};
  EXPECT_EQ(NearestOrder(row, {-100, -40}), (std::vector<std::size_t>{0, 2, 4, 1, 3}));
  EXPECT_EQ(NearestOrder(row, {100, 3}), (std::vector<std::size_t>{3, 1, 4, 2, 0}));
  const std::vector<PlanePoint> column = {{-40, -9}, {-40, -3}, {-40, -7}, {-40, -1}, {-40, -5}};
  EXPECT_EQ(NearestOrder(column, {-40, -100}), (std::vector<std::size_t>{0, 2, 4, 1, 3}));
  EXPECT_EQ(NearestOrder(column, {3, 100}), (std::vector<std::size_t>{3, 1, 4, 2, 0}));
}

// 0 rpm leaves the speed to the machine; whatever is above is asked for, and the least is set.
TEST(BoardShapes, TheLeastSpindleSpeed) {
  const Bitmap pad{.width = 3, .height = 3, .copper = {0, 0, 0, 0, 1, 0, 0, 0, 0}};
  const auto made = [&](double rpm) {
    return *StreamOfBoard(pad, ParametersOf("t1"), {.pixel_mm = 1.0, .rpm = rpm, .at_x_mm = 20});
  };
  EXPECT_EQ(made(0.0).stream.find("!RC"), std::string::npos);
  for (const char* rpm : {"0.5", "1"}) {
    const BoardStream slow = made(std::stod(rpm));
    EXPECT_NE(slow.stream.find("!RC4500;\n"), std::string::npos) << slow.stream;
    ASSERT_FALSE(slow.findings.empty());
    EXPECT_EQ(slow.findings[0].detail, std::string(rpm) + " rpm becomes 4500");
  }
}

}  // namespace
}  // namespace rmlcell::rml1
