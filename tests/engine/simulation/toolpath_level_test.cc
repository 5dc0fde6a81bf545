#include "engine/simulation/toolpath/toolpath_level.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/engine/simulation/polyline_distance.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachineVector;

ToolpathRun RunOf(int step, std::int64_t start_us, std::int64_t end_us, std::uint32_t points) {
  return {.program = 1,
          .step = step,
          .use = MotionUse::kCut,
          .beam_on = true,
          .speed_class = 2,
          .start_us = start_us,
          .end_us = end_us,
          .first_point = 0,
          .point_count = points};
}

ToolpathBlock OneRun(std::vector<ToolpathPoint> points, int step = 1, std::int64_t start_us = 0,
                     std::int64_t end_us = 1000) {
  ToolpathBlock block;
  block.runs.push_back(RunOf(step, start_us, end_us, static_cast<std::uint32_t>(points.size())));
  // At one speed all the way.
  std::vector<double> way{0.0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double x = static_cast<double>(points[i].x_um) - points[i - 1].x_um;
    const double y = static_cast<double>(points[i].y_um) - points[i - 1].y_um;
    const double z = static_cast<double>(points[i].z_um) - points[i - 1].z_um;
    way.push_back(way.back() + std::hypot(x, y, z));
  }
  for (const double done : way) {
    block.reached_us.push_back(
        start_us + std::llround(done / way.back() * static_cast<double>(end_us - start_us)));
  }
  block.points = std::move(points);
  return block;
}

std::vector<ToolpathBlock> Coarser(const std::vector<ToolpathBlock>& blocks, double tolerance_mm) {
  std::vector<ToolpathBlock> coarse;
  ToolpathLevel level(tolerance_mm, [&](std::string_view bytes) {
    Result<ToolpathBlock> block = DecodeToolpathBlock(bytes);
    EXPECT_TRUE(block);
    if (block) coarse.push_back(*std::move(block));
    return true;
  });
  for (const ToolpathBlock& block : blocks) level.Take(block);
  level.Finish();
  return coarse;
}

motion::MachinePoint Place(const ToolpathPoint& p) {
  return {static_cast<double>(p.x_um), static_cast<double>(p.y_um), static_cast<double>(p.z_um)};
}

std::vector<motion::MachinePoint> PlacesOf(const std::vector<ToolpathPoint>& points) {
  std::vector<motion::MachinePoint> places;
  for (const ToolpathPoint& point : points) places.push_back(Place(point));
  return places;
}

// The farthest that any place of one polyline lies from the other, um.
double Farthest(const std::vector<ToolpathPoint>& of, const std::vector<ToolpathPoint>& from) {
  const std::vector<motion::MachinePoint> places = PlacesOf(of);
  const std::vector<motion::MachinePoint> line = PlacesOf(from);
  double worst = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    for (int k = 0; k < 4; ++k) {
      const MachineVector way = places[i] - places[i - 1];
      worst = std::max(worst, DistanceToPolyline(places[i - 1] + way * (k / 4.0), line));
    }
  }
  return worst;
}

std::vector<ToolpathPoint> AllPoints(const std::vector<ToolpathBlock>& blocks) {
  std::vector<ToolpathPoint> points;
  for (const ToolpathBlock& block : blocks)
    points.insert(points.end(), block.points.begin(), block.points.end());
  return points;
}

// motion.md 9: tolerance times 8 a level.
TEST(ToolpathLevel, EachLevelHasEightTimesTheTolerance) {
  EXPECT_DOUBLE_EQ(LevelTolerance(0.01, 0), 0.01);
  EXPECT_DOUBLE_EQ(LevelTolerance(0.01, 1), 0.08);
  EXPECT_DOUBLE_EQ(LevelTolerance(0.01, 3), 5.12);
}

TEST(ToolpathLevel, LeavesOutWhatLiesWithinTheTolerance) {
  // 50 um beside the line of 10 mm: left out at 0.08 mm, kept at 0.04 mm.
  const ToolpathBlock bent = OneRun({{0, 0, 0}, {5000, 50, 0}, {10000, 0, 0}});
  EXPECT_EQ(AllPoints(Coarser({bent}, 0.08)),
            (std::vector<ToolpathPoint>{{0, 0, 0}, {10000, 0, 0}}));
  EXPECT_EQ(AllPoints(Coarser({bent}, 0.04)), bent.points);
}

TEST(ToolpathLevel, KeepsTheTurningPointOfAWayBack) {
  const ToolpathBlock back = OneRun({{0, 0, 0}, {10000, 0, 0}, {3000, 0, 0}});
  EXPECT_EQ(AllPoints(Coarser({back}, 1.0)), back.points);
}

// A point as far from the anchor as the tolerance is left out, whatever comes; one farther binds.
TEST(ToolpathLevel, WhatIsNearTheAnchorBindsNothing) {
  const ToolpathBlock near = OneRun({{0, 0, 0}, {80, 0, 0}, {-10000, 0, 0}});
  EXPECT_EQ(AllPoints(Coarser({near}, 0.08)),
            (std::vector<ToolpathPoint>{{0, 0, 0}, {-10000, 0, 0}}));
  const ToolpathBlock far = OneRun({{0, 0, 0}, {81, 0, 0}, {-10000, 0, 0}});
  EXPECT_EQ(AllPoints(Coarser({far}, 0.08)), far.points);
}

// The first point binds the direction by asin(80 / 1000) = 0.0801 rad: one that goes off by 0.07
// rad passes it, one by 0.09 rad does not. Both ways, since the cone has two sides.
TEST(ToolpathLevel, TheConeIsAsWideAsTheTolerance) {
  for (const double side : {1.0, -1.0}) {
    const auto kept = [&](double angle) {
      const auto x = static_cast<std::int32_t>(std::lround(20000.0 * std::cos(angle)));
      const auto y = static_cast<std::int32_t>(std::lround(side * 20000.0 * std::sin(angle)));
      return AllPoints(Coarser({OneRun({{0, 0, 0}, {1000, 0, 0}, {x, y, 0}})}, 0.08)).size();
    };
    EXPECT_EQ(kept(0.07), 2u);
    EXPECT_EQ(kept(0.09), 3u);
  }
}

// A line that is as long as the farthest point left out does not end short of it.
TEST(ToolpathLevel, ALineAsLongAsTheFarthestPointIsLongEnough) {
  const ToolpathBlock same = OneRun({{0, 0, 0}, {1000, 30, 0}, {1000, -30, 0}});
  EXPECT_EQ(AllPoints(Coarser({same}, 0.08)),
            (std::vector<ToolpathPoint>{{0, 0, 0}, {1000, -30, 0}}));
  const ToolpathBlock shorter = OneRun({{0, 0, 0}, {1000, 30, 0}, {999, -30, 0}});
  EXPECT_EQ(AllPoints(Coarser({shorter}, 0.08)), shorter.points);
}

// A way that ends where its last point that was kept is ends with that.
TEST(ToolpathLevel, TheEndIsNotToldTwice) {
  const ToolpathBlock back = OneRun({{0, 0, 0}, {10000, 0, 0}, {9990, 0, 0}, {10000, 0, 0}});
  const std::vector<ToolpathBlock> coarse = Coarser({back}, 0.08);
  EXPECT_EQ(AllPoints(coarse), (std::vector<ToolpathPoint>{{0, 0, 0}, {10000, 0, 0}}));
  EXPECT_EQ(coarse.at(0).runs.at(0).end_us, 1000);
}

// Two cones share what both allow: 0.0801 rad about 0 and asin(80 / 2000) = 0.0400 about 0.06 leave
// 0.02 to 0.0801; of a cone that lies in another one all is left, of the outer one nothing more.
TEST(ToolpathLevel, ConesShareWhatBothAllow) {
  const auto kept = [&](double second, double third) {
    const auto at = [](double radius, double angle) {
      return ToolpathPoint{static_cast<std::int32_t>(std::lround(radius * std::cos(angle))),
                           static_cast<std::int32_t>(std::lround(radius * std::sin(angle))), 0};
    };
    return AllPoints(
               Coarser({OneRun({{0, 0, 0}, {1000, 0, 0}, at(2000, second), at(20000, third)})},
                       0.08))
        .size();
  };
  EXPECT_EQ(kept(0.06, 0.024), 2u);
  EXPECT_EQ(kept(0.06, 0.076), 2u);
  EXPECT_EQ(kept(0.06, 0.016), 3u);
  EXPECT_EQ(kept(0.06, 0.084), 3u);
  EXPECT_EQ(kept(-0.06, -0.076), 2u);
  EXPECT_EQ(kept(-0.06, -0.016), 3u);
  EXPECT_EQ(kept(0.02, 0.056), 2u);  // the inner one alone: -0.02 to 0.06
  EXPECT_EQ(kept(0.02, -0.016), 2u);
  EXPECT_EQ(kept(0.02, 0.064), 3u);
  EXPECT_EQ(kept(0.02, -0.024), 3u);
}

// Each point of a joined run is at the time that its share of the way says.
TEST(ToolpathLevel, TimeGoesOnWithTheWay) {
  const ToolpathBlock corner = OneRun({{0, 0, 0}, {1000, 0, 0}, {1000, 3000, 0}}, 1, 500, 900);
  ToolpathBlock after = OneRun({{1000, 3000, 0}, {1000, 3000, 8000}}, 2, 900, 1000);
  after.runs[0].speed_class = 3;  // not joined
  const std::vector<ToolpathBlock> coarse = Coarser({corner, after}, 0.08);
  ASSERT_EQ(coarse.size(), 1u);
  ASSERT_EQ(coarse[0].runs.size(), 2u);
  EXPECT_EQ(coarse[0].runs[0].start_us, 500);
  EXPECT_EQ(coarse[0].runs[0].end_us, 900);
  EXPECT_EQ(coarse[0].runs[1].start_us, 900);
  EXPECT_EQ(coarse[0].runs[1].end_us, 1000);
}

TEST(ToolpathLevel, JoinsStepsAndNothingElse) {
  const ToolpathBlock first = OneRun({{0, 0, 0}, {1000, 0, 0}}, 7, 0, 100);
  ToolpathBlock second = OneRun({{1000, 0, 0}, {2000, 0, 0}}, 8, 100, 300);
  const std::vector<ToolpathBlock> joined = Coarser({first, second}, 0.08);
  ASSERT_EQ(joined.size(), 1u);
  ASSERT_EQ(joined[0].runs.size(), 1u);
  EXPECT_EQ(joined[0].runs[0].step, 7);
  EXPECT_EQ(joined[0].runs[0].start_us, 0);
  EXPECT_EQ(joined[0].runs[0].end_us, 300);
  EXPECT_EQ(joined[0].points, (std::vector<ToolpathPoint>{{0, 0, 0}, {2000, 0, 0}}));

  const auto runs_after = [&](auto change) {
    ToolpathBlock other = second;
    change(other.runs[0]);
    return Coarser({first, other}, 0.08).at(0).runs.size();
  };
  EXPECT_EQ(runs_after([](ToolpathRun& run) { run.beam_on = false; }), 2u);
  EXPECT_EQ(runs_after([](ToolpathRun& run) { run.use = MotionUse::kTravel; }), 2u);
  EXPECT_EQ(runs_after([](ToolpathRun& run) { run.speed_class = 3; }), 2u);
  EXPECT_EQ(runs_after([](ToolpathRun& run) { run.program = 2; }), 2u);
  EXPECT_EQ(runs_after([](ToolpathRun& run) { run.start_us = 150; }), 2u) << "a pause between";
}

TEST(ToolpathLevel, ShowsASmallHoleAsAPoint) {
  const ToolpathBlock hole =
      OneRun({{100, 0, 0}, {0, 100, 0}, {-100, 0, 0}, {0, -100, 0}, {100, 0, 0}});
  const std::vector<ToolpathBlock> coarse = Coarser({hole}, 1.0);
  ASSERT_EQ(coarse.size(), 1u);
  EXPECT_EQ(coarse[0].runs.size(), 1u);
  EXPECT_EQ(coarse[0].points, (std::vector<ToolpathPoint>{{100, 0, 0}, {100, 0, 0}}));
}

// Both ways, for ways of every kind and every tolerance; motion.md 9.
TEST(ToolpathLevel, StaysWithinTheToleranceBothWays) {
  std::mt19937 random(11);  // NOLINT: the same every time
  std::uniform_int_distribution<int> step(-400, 400);
  for (int round = 0; round < 15; ++round) {
    std::vector<ToolpathPoint> way{{0, 0, 0}};
    for (int k = 1; k < 200; ++k) {
      ToolpathPoint p = way.back();
      if (round % 3 == 0) {  // wandering
        p = {p.x_um + step(random), p.y_um + step(random), p.z_um + step(random)};
      } else if (round % 3 == 1) {  // forward with noise
        p = {p.x_um + 500, step(random) / 8, step(random) / 8};
      } else {  // a circle of 20 mm
        const double angle = k * 2.0 * std::numbers::pi / 200.0;
        p = {static_cast<int>(20000.0 * std::cos(angle)),
             static_cast<int>(20000.0 * std::sin(angle)), k * 10};
      }
      way.push_back(p);
    }
    for (const double tolerance_mm : {0.02, 0.08, 0.64, 5.12}) {
      const std::vector<ToolpathPoint> coarse = AllPoints(Coarser({OneRun(way)}, tolerance_mm));
      const double allowed = tolerance_mm * 1000.0 + 1e-6;
      EXPECT_LE(Farthest(way, coarse), allowed) << round << " at " << tolerance_mm;
      EXPECT_LE(Farthest(coarse, way), allowed) << round << " at " << tolerance_mm;
      EXPECT_EQ(coarse.front(), way.front());
      EXPECT_EQ(coarse.back(), way.back());
    }
  }
}

TEST(ToolpathLevel, ACircleNeedsFewPoints) {
  std::vector<ToolpathPoint> way;
  for (int k = 0; k <= 3000; ++k) {
    const double angle = k * 2.0 * std::numbers::pi / 3000.0;
    way.push_back({static_cast<int>(50000.0 * std::cos(angle)),
                   static_cast<int>(50000.0 * std::sin(angle)), 0});
  }
  // Chords with the tolerance as their height: pi / acos(1 - tol/R). A line from point to point may
  // lie off by the tolerance, on both sides of the curve, so fewer may do; twice as many are poor.
  const double chords = std::numbers::pi / std::acos(1.0 - 0.08 / 50.0);
  const std::size_t points = AllPoints(Coarser({OneRun(way)}, 0.08)).size();
  EXPECT_LT(static_cast<double>(points), 2.0 * chords);
}

// Blocks of the result are full, and time goes on through them.
TEST(ToolpathLevel, LongWaysFillSeveralBlocks) {
  std::vector<ToolpathBlock> blocks;
  for (int b = 0; b < 10; ++b) {
    std::vector<ToolpathPoint> zigzag;
    for (int k = 0; k < 2000; ++k) {
      const int n = b * 1999 + k;
      zigzag.push_back({n * 1000, n % 2 * 1000, 0});
    }
    blocks.push_back(OneRun(zigzag, b + 1, b * 2000, b * 2000 + 2000));
  }
  const std::vector<ToolpathBlock> coarse = Coarser(blocks, 0.08);
  std::size_t ways = 0;
  std::int64_t time = 0;
  for (const ToolpathBlock& block : coarse) {
    for (const ToolpathRun& run : block.runs) {
      EXPECT_EQ(run.start_us, time);
      time = run.end_us;
      ways += run.point_count - 1;
    }
  }
  EXPECT_EQ(coarse.size(), 5u);  // 19,991 points, of which 4 appear twice
  EXPECT_EQ(ways, 19990u);
  EXPECT_EQ(time, 20000);
}

// A joined run is as fast as the fastest of its parts; another power of the beam ends it.
TEST(ToolpathLevel, JoinedRunsKeepWhatTheyReach) {
  ToolpathBlock first = OneRun({{0, 0, 0}, {1000, 0, 0}}, 7, 0, 100);
  first.runs[0].reached_class = 3;
  ToolpathBlock second = OneRun({{1000, 0, 0}, {2000, 0, 0}}, 8, 100, 300);
  second.runs[0].reached_class = 5;
  const std::vector<ToolpathBlock> joined = Coarser({first, second}, 0.08);
  ASSERT_EQ(joined[0].runs.size(), 1U);
  EXPECT_EQ(joined[0].runs[0].reached_class, 5);
  second.runs[0].power_class = 9;
  EXPECT_EQ(Coarser({first, second}, 0.08)[0].runs.size(), 2U);
}

// The points that are left are reached when they were, and the head stands there as it did.
TEST(ToolpathLevel, PointsThatAreLeftKeepTimeAndAngles) {
  ToolpathBlock way =
      OneRun({{0, 0, 0, 0, 1}, {1000, 0, 0, 5, 1}, {1000, 3000, 0, 9, 2}}, 1, 0, 40'000);
  way.reached_us[1] = 35'000;  // it began slowly
  const std::vector<ToolpathBlock> coarse = Coarser({way}, 0.08);
  ASSERT_EQ(coarse.size(), 1U);
  EXPECT_EQ(coarse[0].points, way.points);
  EXPECT_EQ(coarse[0].reached_us, way.reached_us);
}

// Who wants no more is asked no more, wherever in a run that is said.
TEST(ToolpathLevel, WhoWantsNoMoreIsNotAskedAgain) {
  int offered = 0;
  ToolpathLevel level(0.08, [&](std::string_view) {
    ++offered;
    return false;
  });
  for (int b = 0; b < 4; ++b) {
    std::vector<ToolpathPoint> zigzag;
    for (int k = 0; k < 3000; ++k) {
      const int n = b * 2999 + k;
      zigzag.push_back({n * 1000, n % 2 * 1000, 0});
    }
    level.Take(OneRun(zigzag, b + 1, b * 3000, b * 3000 + 3000));
  }
  level.Finish();
  EXPECT_EQ(offered, 1);
}

}  // namespace
}  // namespace rmlcell::simulation
