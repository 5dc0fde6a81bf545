#include "engine/optimo/offline/segment_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

namespace rmlcell::optimo {
namespace {

using motion::MachineVector;

motion::MachinePoint PointAt(const PathSegment& s, double share) {
  return s.from + (s.to - s.from) * share;
}

struct Row {
  PathSegment a, b;
  double distance, on_a, on_b;
};

// Worked out by hand: crossing, beside each other, behind the ends, points.
TEST(SegmentGrid, TheNearestPointsOfTwoSegments) {
  const std::vector<Row> rows = {
      {{{0, 0, 0}, {10, 0, 0}}, {{4, -5, 0}, {4, 15, 0}}, 0.0, 0.4, 0.25},
      {{{0, 0, 0}, {10, 0, 0}}, {{4, -5, 3}, {4, 15, 3}}, 3.0, 0.4, 0.25},
      {{{0, 0, 0}, {10, 0, 0}}, {{4, 2, 0}, {4, 15, 0}}, 2.0, 0.4, 0.0},
      {{{0, 0, 0}, {10, 0, 0}}, {{4, 15, 0}, {4, 2, 0}}, 2.0, 0.4, 1.0},
      {{{0, 0, 0}, {10, 0, 0}}, {{13, 4, 0}, {13, 40, 0}}, 5.0, 1.0, 0.0},
      {{{0, 0, 0}, {10, 0, 0}}, {{-3, -36, 0}, {-3, -4, 0}}, 5.0, 0.0, 1.0},
      {{{0, 0, 0}, {10, 0, 0}}, {{12, -6, 0}, {12, 6, 0}}, 2.0, 1.0, 0.5},
      {{{0, 0, 0}, {0, 0, 0}}, {{-2, 3, 0}, {6, 3, 0}}, 3.0, 0.0, 0.25},
      {{{-2, 3, 0}, {6, 3, 0}}, {{0, 0, 0}, {0, 0, 0}}, 3.0, 0.25, 0.0},
      {{{9, 9, 9}, {9, 9, 9}}, {{-2, 3, 0}, {6, 3, 0}}, std::sqrt(126.0), 0.0, 1.0},
      {{{1, 2, 3}, {1, 2, 3}}, {{1, 2, 8}, {1, 2, 8}}, 5.0, 0.0, 0.0},
      {{{0, 0, 0}, {1e-8, 0, 0}}, {{5, -1, 0}, {5, 1, 0}}, 5.0 - 1e-8, 1.0, 0.5},
      {{{5, -1, 0}, {5, 1, 0}}, {{0, 0, 0}, {1e-8, 0, 0}}, 5.0 - 1e-8, 0.5, 1.0},
  };
  for (const Row& row : rows) {
    const NearestPoints nearest = NearestPointsOf(row.a, row.b);
    EXPECT_NEAR(nearest.distance, row.distance, 1e-12);
    EXPECT_NEAR(nearest.on_a, row.on_a, 1e-12);
    EXPECT_NEAR(nearest.on_b, row.on_b, 1e-12);
  }
}

// Parallel ones, also where they lie apart: the distance is what counts. Two that cross at a
// hundred-thousandth are not parallel.
TEST(SegmentGrid, TheDistanceOfParallelSegments) {
  const PathSegment a{{0, 0, 0}, {10, 0, 0}};
  EXPECT_NEAR(NearestPointsOf(a, {{3, 4, 0}, {8, 4, 0}}).distance, 4.0, 1e-12);
  EXPECT_NEAR(NearestPointsOf(a, {{8, 4, 0}, {3, 4, 0}}).distance, 4.0, 1e-12);
  EXPECT_NEAR(NearestPointsOf(a, {{13, 4, 0}, {20, 4, 0}}).distance, 5.0, 1e-12);
  EXPECT_NEAR(NearestPointsOf(a, {{20, 4, 0}, {13, 4, 0}}).distance, 5.0, 1e-12);
  EXPECT_NEAR(NearestPointsOf(a, {{-20, 0, 4}, {-3, 0, 4}}).distance, 5.0, 1e-12);
  const PathSegment along{{0, 0, 0}, {1000, 0, 0}}, across{{0, -0.005, 0}, {1000, 0.005, 0}};
  EXPECT_NEAR(NearestPointsOf(along, across).distance, 0.0, 1e-6);
}

// Another way to the same: no two points of a fine division are nearer, and the points told are
// that far apart.
TEST(SegmentGrid, NoOtherPointsAreNearer) {
  std::mt19937 random(3);
  const auto dice = [&] { return static_cast<double>(random() % 2001) / 100.0 - 10.0; };
  for (int round = 0; round < 200; ++round) {
    const PathSegment a{{dice(), dice(), dice()}, {dice(), dice(), dice()}},
        b{{dice(), dice(), dice()}, {dice(), dice(), dice()}};
    const NearestPoints nearest = NearestPointsOf(a, b);
    EXPECT_NEAR((PointAt(a, nearest.on_a) - PointAt(b, nearest.on_b)).norm(), nearest.distance,
                1e-9);
    EXPECT_GE(std::min(nearest.on_a, nearest.on_b), 0.0);
    EXPECT_LE(std::max(nearest.on_a, nearest.on_b), 1.0);
    for (int i = 0; i <= 40; ++i) {
      for (int j = 0; j <= 40; ++j) {
        EXPECT_GE((PointAt(a, i / 40.0) - PointAt(b, j / 40.0)).norm(), nearest.distance - 1e-9);
      }
    }
  }
}

// Whatever lies within reach is visited, in each pair of axes, for segments inside and far outside.
TEST(SegmentGrid, AllWithinReachAreVisited) {
  std::mt19937 random(9);
  for (int round = 0; round < 120; ++round) {
    // One axis has no spread: the grid lies in the other two.
    const int flat = round % 3;
    const auto point = [&](double size) {
      double c[3];
      for (int axis = 0; axis < 3; ++axis) {
        c[axis] = axis == flat ? static_cast<double>(random() % 3)
                               : (static_cast<double>(random() % 2001) / 1000.0 - 1.0) * size;
      }
      return MachineVector{c[0], c[1], c[2]};
    };
    std::vector<PathSegment> segments;
    for (int s = 0; s < 40; ++s) {
      const motion::MachinePoint from = point(50.0);
      segments.push_back({from, round % 2 == 0 ? from + point(3.0) : point(50.0), 0});
    }
    const double reach = 0.5 + static_cast<double>(random() % 60) / 10.0;
    const SegmentGrid grid(segments, reach);
    for (int q = 0; q < 20; ++q) {
      const PathSegment query = {point(q % 4 == 0 ? 500.0 : 60.0), point(q % 5 == 0 ? 500.0 : 60.0),
                                 0};
      std::set<std::uint32_t> visited;
      std::size_t budget = 1'000'000;
      EXPECT_TRUE(
          grid.ForEachNear(query, budget, [&](std::uint32_t index) { visited.insert(index); }));
      for (std::uint32_t s = 0; s < segments.size(); ++s) {
        if (NearestPointsOf(query, segments[s]).distance <= reach) {
          EXPECT_TRUE(visited.contains(s)) << round << " " << q << " " << s;
        }
      }
    }
  }
}

// A query costs what is nearby: of 10,000 short segments in a row it meets a few.
TEST(SegmentGrid, AQueryMeetsFew) {
  std::vector<PathSegment> segments;
  for (int s = 0; s < 10'000; ++s) {
    const double x = s;
    segments.push_back({{x, 0, 0}, {x + 1.0, 0, 0}, 0});
  }
  const SegmentGrid grid(segments, 1.0);
  std::size_t met = 0, budget = 1'000;
  const PathSegment query{{5000, 0.5, 0}, {5001, 0.5, 0}, 0};
  EXPECT_TRUE(grid.ForEachNear(query, budget, [&](std::uint32_t) { ++met; }));
  EXPECT_GE(met, 3U);
  EXPECT_LE(met, 60U);
  EXPECT_LT(budget, 1'000U - met);  // a cell takes 1, too
  // Far away there is nothing, and it takes next to nothing to know, however long the query is.
  budget = 100;
  met = 0;
  const PathSegment far{{-1e7, 5e6, 0}, {1e7, 5e6, 0}, 0};
  EXPECT_TRUE(grid.ForEachNear(far, budget, [&](std::uint32_t) { ++met; }));
  EXPECT_EQ(met, 0U);
}

// The grid lies in the two axes in which the segments spread most, wherever they are: of a field of
// them a query meets a few, too.
TEST(SegmentGrid, AQueryMeetsFewOfAField) {
  for (int flat = 0; flat < 3; ++flat) {
    const auto point = [&](double u, double v) {
      motion::ProgramVector p(0.0, 0.0, 0.0);
      p[flat] = 7e5;
      p[(flat + 1) % 3] = u;
      p[(flat + 2) % 3] = v;
      return p;
    };
    std::vector<PathSegment> segments;
    for (int u = 0; u < 100; ++u) {
      for (int v = 0; v < 100; ++v) segments.push_back({point(u, v), point(u + 0.5, v), 0});
    }
    const SegmentGrid grid(segments, 0.5);
    std::size_t met = 0, budget = 1'000;
    const PathSegment query{point(50.0, 50.0), point(50.5, 50.0), 0};
    EXPECT_TRUE(grid.ForEachNear(query, budget, [&](std::uint32_t) { ++met; })) << flat;
    EXPECT_GE(met, 1U) << flat;
    EXPECT_LE(met, 60U) << flat;
  }
}

TEST(SegmentGrid, TheBudgetEndsAQuery) {
  const std::vector<PathSegment> segments(20, {{0, 0, 0}, {1, 0, 0}, 0});
  const SegmentGrid grid(segments, 1.0);
  for (const std::size_t given : {0U, 1U, 5U}) {
    std::size_t budget = given, met = 0;
    EXPECT_FALSE(grid.ForEachNear(segments[0], budget, [&](std::uint32_t) { ++met; }));
    EXPECT_EQ(budget, 0U);
    EXPECT_LE(met, given);
  }
  const std::vector<PathSegment> none;
  std::size_t budget = 0;
  EXPECT_TRUE(SegmentGrid(none, 1.0).ForEachNear(segments[0], budget, [](std::uint32_t) {}));
}

}  // namespace
}  // namespace rmlcell::optimo
