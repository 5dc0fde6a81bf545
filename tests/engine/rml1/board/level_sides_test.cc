#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "engine/rml1/board/contours.h"
#include "engine/rml1/board/distance_field.h"
#include "engine/rml1/board/joined_traces.h"
#include "engine/rml1/board/nearest_order.h"
#include "engine/rml1/board/simplify.h"
#include "tests/engine/rml1/board/made_board.h"
#include "tests/engine/rml1/run_support.h"

// Places that lie exactly at the level of a line, and orders of places without a pattern.
namespace rmlcell::rml1 {
namespace {

// joined_traces.h: what lies at the level is not below it: a gap of one pixel has the distance 1 in
// its middle, and a corner between two of copper and two of 2 as well.
TEST(BoardLevels, WhatLiesAtTheLevelParts) {
  Bitmap gap{.width = 3, .height = 1, .copper = {1, 0, 1}};
  const DistanceField field = DistanceToCopper(gap, 3);
  EXPECT_EQ(CountJoined(field, 0.5, 1.0).traces, 2U);
  EXPECT_EQ(CountJoined(field, 0.5, 1.0).joined, 0U);
  EXPECT_EQ(CountJoined(field, 0.5, 1.01).joined, 2U);

  DistanceField corner{.width = 9, .height = 7, .values = {}};
  corner.values.assign(corner.width * corner.height, 9.0F);
  for (const auto& [x, y, value] : {std::tuple<std::size_t, std::size_t, float>{5, 2, 0.0F},
                                    {6, 3, 0.0F},
                                    {6, 2, 2.0F},
                                    {5, 3, 2.0F}})
    corner.values[y * corner.width + x] = value;
  EXPECT_EQ(CountJoined(corner, 0.5, 1.0).joined, 0U);
  EXPECT_EQ(ContoursAt(corner, 1.0).size(), 2U);
  EXPECT_EQ(CountJoined(corner, 0.5, 1.001).joined, 2U);
  EXPECT_EQ(ContoursAt(corner, 1.001).size(), 1U);
}

// distance_field.h: also in a picture of one column that has no margin.
TEST(BoardLevels, DistancesOfOneColumn) {
  EXPECT_EQ(DistanceToCopper({.width = 1, .height = 3, .copper = {1, 0, 0}}, 0).values,
            (std::vector<float>{0, 1, 2}));
  EXPECT_EQ(DistanceToCopper({.width = 1, .height = 3, .copper = {0, 0, 1}}, 0).values,
            (std::vector<float>{2, 1, 0}));
}

// nearest_order.h: each time the nearest one that is left, wherever they lie; some of them in one
// place, of which the first one comes first.
TEST(BoardLevels, TheNearestOfManyPlacesComesNext) {
  std::uint32_t state = 12345;
  const auto next = [&state] {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8U) / 16777216.0;
  };
  for (const PlanePoint scale : {PlanePoint{100, 100}, PlanePoint{300, 7}, PlanePoint{4, 90}}) {
    std::vector<PlanePoint> places;
    for (int n = 0; n < 700; ++n)
      places.push_back({-20.0 + scale.x * next(), 50.0 + scale.y * next()});
    for (std::size_t n = 0; n < 60; ++n) places.push_back(places[7 * n]);
    PlanePoint at{-20.0 + 0.5 * scale.x, 50.0 + 0.5 * scale.y};
    const std::vector<std::size_t> order = NearestOrder(places, at);
    ASSERT_EQ(order.size(), places.size());
    std::vector<bool> left(places.size(), true);
    for (const std::size_t found : order) {
      std::size_t best = places.size();
      double least = HUGE_VAL;
      for (std::size_t i = 0; i < places.size(); ++i) {
        const double distance = std::hypot(places[i].x - at.x, places[i].y - at.y);
        if (left[i] && distance < least) {
          least = distance;
          best = i;
        }
      }
      ASSERT_EQ(found, best);
      left[found] = false;
      at = places[found];
    }
  }
}

// simplify.h: long lines are looked at in parts of 4096 points; where a part comes back to the
// place where it began it is looked at as any other one.
TEST(BoardLevels, APartThatComesBackKeepsItsPoints) {
  Loop loop;
  for (int n = 0; n < 4096; ++n) {
    const double angle = 2.0 * M_PI * n / 4096.0;
    loop.push_back({10.0 * std::cos(angle) - 10.0, 10.0 * std::sin(angle)});
  }
  loop.push_back({0, 0});
  loop.push_back({1000, 0});
  loop.push_back({500, -5});
  double least = 0.0;
  double highest = 0.0;
  for (const PlanePoint& p : Simplified(loop, 0.1)) {
    least = std::min(least, p.x);
    highest = std::max(highest, p.y);
  }
  EXPECT_LT(least, -19.8);
  EXPECT_GT(highest, 9.8);
}

// docs/boards.md: the picture lies with its lower left corner at the place given: the line around
// one pixel of half a millimetre has its middle a quarter of a millimetre beside that.
TEST(BoardLevels, WhereAPictureLies) {
  const Bitmap one{.width = 2, .height = 1, .copper = {1, 0}};
  const BoardOptions options{.pixel_mm = 0.5, .tool_mm = 1.0, .at_x_mm = 30.0, .at_y_mm = 20.0};
  const auto made = StreamOfBoard(one, ParametersOf("srm-20"), options);
  ASSERT_TRUE(made);
  double least[2] = {1e9, 1e9}, most[2] = {-1e9, -1e9};
  const std::string& stream = made->stream;
  for (std::size_t at = 0; at < stream.size(); at = stream.find('\n', at) + 1) {
    const bool sets = stream[at] == 'Z' || stream[at] == 'P';
    if (!sets || stream.compare(at, 2, "PA") == 0) continue;
    const std::size_t x = stream.find_first_of("-0123456789", at);
    const std::size_t y = stream.find(',', x) + 1;
    const double values[2] = {std::stod(stream.substr(x)), std::stod(stream.substr(y))};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (values[0] == 0.0 && values[1] == 0.0) continue;  // where the tool begins
      least[axis] = std::min(least[axis], values[axis]);
      most[axis] = std::max(most[axis], values[axis]);
    }
  }
  EXPECT_NEAR(0.5 * (least[0] + most[0]), 3025.0, 1.01) << stream;
  EXPECT_NEAR(0.5 * (least[1] + most[1]), 2025.0, 1.01) << stream;
}

// contours.h: above 0 counterclockwise; each of its corners counts, the last one too.
TEST(BoardLevels, AreasHaveASide) {
  const Loop loop = {{2, 3}, {12, 3}, {12, 8}, {7, 15}, {2, 8}};
  EXPECT_NEAR(SignedArea(loop), 50.0 + 35.0, 1e-12);
  EXPECT_NEAR(SignedArea({loop.rbegin(), loop.rend()}), -85.0, 1e-12);
}

// contours.h: what lies at the value is not below it: two pixels of copper with one between them
// have a line each, a square around their four neighbours, which meet in the middle.
TEST(BoardLevels, LinesAtTheLevelOfAPixel) {
  const DistanceField field = DistanceToCopper({.width = 3, .height = 1, .copper = {1, 0, 1}}, 3);
  const std::vector<Loop> loops = ContoursAt(field, 1.0);
  ASSERT_EQ(loops.size(), 2U);
  for (const Loop& loop : loops) {
    EXPECT_NEAR(SignedArea(loop), 2.0, 1e-9);
    for (const PlanePoint& p : loop) {
      const double nearest = std::min(std::hypot(p.x - 3, p.y - 3), std::hypot(p.x - 5, p.y - 3));
      EXPECT_NEAR(nearest, 1.0, 1e-9);
    }
  }
}

}  // namespace
}  // namespace rmlcell::rml1
