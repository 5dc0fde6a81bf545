#include "engine/simulation/toolpath/toolpath_recorder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "tests/engine/motion/standard_machine.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/polyline_distance.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachineVector;
using motion::PathPiece;

struct Recorded {
  std::vector<ToolpathBlock> blocks;
  std::uint64_t bytes = 0;
  bool complete = true;
};

Recorded Record(const Script& script, ToolpathOptions options = {}) {
  machine::MachineShape shape;
  shape.limits = motion::StandardMachine();
  Recorded recorded;
  ToolpathRecorder recorder(shape, options, [&](std::string_view bytes) {
    Result<ToolpathBlock> block = DecodeToolpathBlock(bytes);
    EXPECT_TRUE(block);
    if (block) recorded.blocks.push_back(*std::move(block));
    return true;
  });
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.Finish();
  recorded.bytes = recorder.bytes();
  recorded.complete = recorder.complete();
  return recorded;
}

MachineVector Millimetres(const ToolpathPoint& p) {
  return {p.x_um / 1000.0, p.y_um / 1000.0, p.z_um / 1000.0};
}

std::vector<motion::MachinePoint> PointsOf(const ToolpathBlock& block) {
  std::vector<motion::MachinePoint> points;
  for (const ToolpathPoint& point : block.points) points.push_back(Millimetres(point));
  return points;
}

// The farthest that any point of the path is from the polyline of the first block.
double WorstDistance(const PathPiece& path, const motion::Head& head, const ToolpathBlock& block) {
  const std::vector<motion::MachinePoint> points = PointsOf(block);
  double worst = 0.0;
  for (int k = 0; k <= 2000; ++k) {
    const double s = path.length() * k / 2000;
    const motion::MachinePoint tip = motion::TipOn(path, head, path.At(s)).tip;
    worst = std::max(worst, DistanceToPolyline(tip, points));
  }
  return worst;
}

// What is not handed out yet can be looked at, as often as one likes, and changes nothing.
TEST(ToolpathRecorder, TheOpenBlockHasWhatIsNotHandedOut) {
  machine::MachineShape shape;
  shape.limits = motion::StandardMachine();
  std::vector<std::string> blocks;
  ToolpathRecorder recorder(shape, {}, [&](std::string_view bytes) {
    blocks.emplace_back(bytes);
    return true;
  });
  EXPECT_EQ(recorder.OpenBlock(), "");
  const motion::PathLimits limits{.speed = 10.0, .acceleration = 10.0};
  Script script;
  script.Step(45, 7);
  script.Motion(Planned(LineFrom({0, 0, 0}, {10, 0, 0}), limits), {});  // 2 s
  script.Motion(Planned(LineFrom({10, 0, 0}, {10, 10, 0}), limits), {});
  FakeRun run(script, recorder);
  run.Advance(SimTime(std::chrono::milliseconds(2500)));
  const Result<ToolpathBlock> half = DecodeToolpathBlock(recorder.OpenBlock());
  ASSERT_TRUE(half);
  EXPECT_EQ(half->points.front(), (ToolpathPoint{0, 0, 0}));
  EXPECT_EQ(half->points.at(1), (ToolpathPoint{10'000, 0, 0}));
  run.Advance(kForever);
  const std::string whole = recorder.OpenBlock();
  EXPECT_EQ(recorder.OpenBlock(), whole);
  EXPECT_TRUE(blocks.empty());
  recorder.Finish();
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_EQ(blocks[0], whole);
  EXPECT_EQ(recorder.OpenBlock(), "");
}

// A sink that wants no more is not asked again, and no more points are counted than it was offered.
TEST(ToolpathRecorder, ASinkThatWantsNoMoreGetsNoMore) {
  machine::MachineShape shape;
  shape.limits = motion::StandardMachine();
  int offered = 0;
  ToolpathRecorder recorder(shape, {}, [&](std::string_view) {
    ++offered;
    return false;
  });
  const motion::PathLimits limits{.speed = 10.0, .acceleration = 10.0};
  Script script;
  script.Step(45, 7);
  double x = 0.0;
  const auto zigzag = [&](int legs) {
    for (int leg = 0; leg < legs; ++leg, x += 1.0) {
      const double y = leg % 2;
      script.Motion(Planned(LineFrom({x, y, 0}, {x + 1.0, 1.0 - y, 0}), limits), {});
    }
  };
  zigzag(3 * 4096);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  EXPECT_EQ(offered, 1);
  EXPECT_FALSE(recorder.complete());
  EXPECT_EQ(recorder.points(), 4096U);
  EXPECT_EQ(recorder.OpenBlock(), "");
  recorder.Finish();
  EXPECT_EQ(offered, 1);
}

// motion.md 9: a line is two points; step, use, beam, speed class and times of a run. SPEED 10 of
// 500 mm/s is class 2. 10 mm with 10 mm/s2 to 10 mm/s take 2 s.
TEST(ToolpathRecorder, LineIsTwoPoints) {
  const motion::PathLimits limits{.speed = 10.0, .acceleration = 10.0};
  Script script;
  script.Step(45, 7).Nothing(0.5);
  script.Motion(Planned(LineFrom({1, 2, 3}, {11, 2, 3}), limits),
                {.use = MotionUse::kCut, .beam_on = true, .programmed_mm_s = 50.0});
  const Recorded recorded = Record(script);
  ASSERT_EQ(recorded.blocks.size(), 1u);
  const ToolpathBlock& block = recorded.blocks[0];
  ASSERT_EQ(block.runs.size(), 1u);
  EXPECT_EQ(block.points, (std::vector<ToolpathPoint>{{1000, 2000, 3000}, {11000, 2000, 3000}}));
  const ToolpathRun& run = block.runs[0];
  EXPECT_EQ(run.program, 45);
  EXPECT_EQ(run.step, 7);
  EXPECT_EQ(run.use, MotionUse::kCut);
  EXPECT_TRUE(run.beam_on);
  EXPECT_EQ(run.speed_class, 2);
  EXPECT_EQ(run.start_us, 500'000);
  EXPECT_EQ(run.end_us, 2'500'000);
}

// motion.md 9: collinear neighbours of the same step, use, beam and speed class are one; any
// difference keeps the vertex.
TEST(ToolpathRecorder, MergesWhatGoesStraightOnInOneStep) {
  Script script;
  script.Step(1, 1);
  for (int k = 0; k < 10; ++k) script.Line({1.0 * k, 0, 0}, {1.0 * (k + 1), 0, 0});
  script.Line({10, 0, 0}, {10, 5, 0});  // a corner
  script.Line({10, 5, 0}, {10, 4, 0});  // straight back
  script.Line({10, 4, 0}, {10, 3, 0}, {.use = MotionUse::kCut});
  script.Step(1, 2).Line({10, 3, 0}, {10, 2, 0}, {.use = MotionUse::kCut});
  script.Line({10, 2, 0}, {10, 1, 0}, {.use = MotionUse::kCut, .beam_on = true});
  const Recorded recorded = Record(script);
  ASSERT_EQ(recorded.blocks.size(), 1u);
  const ToolpathBlock& block = recorded.blocks[0];
  const std::vector<ToolpathPoint> expected = {{0, 0, 0},        {10000, 0, 0},    {10000, 5000, 0},
                                               {10000, 4000, 0}, {10000, 3000, 0}, {10000, 2000, 0},
                                               {10000, 1000, 0}};
  EXPECT_EQ(block.points, expected);
  EXPECT_EQ(block.runs.size(), 4u);
  EXPECT_EQ(block.runs[0].point_count, 4u);
  EXPECT_EQ(block.runs[1].first_point, 3u);  // shares the vertex
  EXPECT_EQ(block.runs[0].end_us, block.runs[1].start_us);
}

// 100 mm at up to 50 mm/s with 100 mm/s2 from rest to rest: an arc is a quarter of its way behind
// at 0.25 s + 12.5 mm / 50 mm/s ..., which the time by the way misses by tenths of a second.
TEST(ToolpathRecorder, PointsHaveTheTimeAtWhichTheyAreReached) {
  const motion::PathLimits limits{.speed = 50.0, .acceleration = 100.0};
  const double radius = 100.0 / kTurn;
  const PathPiece circle =
      PathPiece::Circle({{radius, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.0, 0.0);
  const Recorded recorded = Record(Script().Step(1, 1).Motion(Planned(circle, limits)));
  ASSERT_EQ(recorded.blocks.size(), 1U);
  const ToolpathBlock& block = recorded.blocks[0];
  const ToolpathRun& run = block.runs.at(0);
  EXPECT_EQ(run.end_us, 2'500'000);  // 100 / 50 + 50 / 100
  double way = 0.0;
  for (std::uint32_t k = 1; k < run.point_count; ++k) {
    way += 100.0 / (run.point_count - 1);
    // Half a second of ramp, 12.5 mm long, at either end.
    const double reached = way <= 12.5 ? std::sqrt(2.0 * way / 100.0)
                           : way <= 87.5
                               ? 0.5 + (way - 12.5) / 50.0
                               : 2.5 - std::sqrt(2.0 * std::max(0.0, 100.0 - way) / 100.0);
    EXPECT_NEAR(static_cast<double>(TimeOf(block, run, k)) * 1e-6, reached, 2e-6) << k;
  }
}

// Angles of the head at each point; while it turns, what goes straight on is not merged.
TEST(ToolpathRecorder, PointsHaveTheAnglesOfTheHead) {
  Script script;
  script.Step(1, 1);
  script.Motion(Planned(PathPiece::Line({{0, 0, 0}, 0.0, 1.0}, {{10, 0, 0}, 0.5, 1.0})));
  script.Motion(Planned(PathPiece::Line({{10, 0, 0}, 0.5, 1.0}, {{20, 0, 0}, 0.5, -0.25})));
  script.Motion(Planned(PathPiece::Line({{20, 0, 0}, 0.5, -0.25}, {{20, 0, 0}, 0.25, -0.25})));
  script.Motion(Planned(PathPiece::Line({{20, 0, 0}, 0.25, -0.25}, {{30, 0, 0}, 0.25, -0.25})));
  script.Motion(Planned(PathPiece::Line({{30, 0, 0}, 0.25, -0.25}, {{40, 0, 0}, 0.25, -0.25})));
  const Recorded recorded = Record(script);
  ASSERT_EQ(recorded.blocks.size(), 1U);
  EXPECT_EQ(recorded.blocks[0].points,
            (std::vector<ToolpathPoint>{{0, 0, 0, 0, 1'000'000},
                                        {10'000, 0, 0, 500'000, 1'000'000},
                                        {20'000, 0, 0, 500'000, -250'000},
                                        {20'000, 0, 0, 250'000, -250'000},
                                        {40'000, 0, 0, 250'000, -250'000}}));
}

// One axis that turns is enough: both ends of the way on which it does are kept.
TEST(ToolpathRecorder, OneAxisThatTurnsKeepsItsVertices) {
  for (const bool of_b : {false, true}) {
    const auto at = [&](double x, double angle) {
      return motion::TipPose{{x, 0, 0}, of_b ? 0.0 : angle, of_b ? angle : 0.0};
    };
    Script script;
    script.Step(1, 1);
    script.Motion(Planned(PathPiece::Line(at(0, 0.0), at(10, 0.0))));
    script.Motion(Planned(PathPiece::Line(at(10, 0.0), at(20, 0.5))));
    script.Motion(Planned(PathPiece::Line(at(20, 0.5), at(30, 0.5))));
    script.Motion(Planned(PathPiece::Line(at(30, 0.5), at(40, 0.5))));
    const Recorded recorded = Record(script);
    ASSERT_EQ(recorded.blocks.size(), 1U);
    const std::int32_t a = of_b ? 0 : 500'000, b = of_b ? 500'000 : 0;
    EXPECT_EQ(recorded.blocks[0].points,
              (std::vector<ToolpathPoint>{
                  {0, 0, 0}, {10'000, 0, 0}, {20'000, 0, 0, a, b}, {40'000, 0, 0, a, b}}));
  }
}

// Of 500 mm/s, and of the rated power. 10 mm with 10 mm/s2 reach 10 mm/s: the first class.
TEST(ToolpathRecorder, RunsSayWhatSpeedAndPowerTheyReach) {
  const motion::PathLimits slow{.speed = 500.0, .acceleration = 10.0};
  const motion::PathLimits fast{.speed = 300.0, .acceleration = 1e6};
  Script script;
  const machine::PowerBySpeed power{.constant_percent = 70.0, .percent_per_mm_s = 0.2};
  script.Step(1, 1).Motion(Planned(LineFrom({0, 0, 0}, {10, 0, 0}), slow),
                           {.beam_on = true, .power = power, .programmed_mm_s = 500.0});
  script.Step(1, 2).Motion(Planned(LineFrom({10, 0, 0}, {20, 0, 0}), fast),
                           {.power = power, .programmed_mm_s = 500.0});
  const Recorded recorded = Record(script);
  ASSERT_EQ(recorded.blocks[0].runs.size(), 2U);
  const ToolpathRun& first = recorded.blocks[0].runs[0];
  EXPECT_EQ(first.speed_class, 20);
  EXPECT_EQ(first.reached_class, 1);  // 10 of 500 mm/s
  EXPECT_EQ(first.power_class, 15);   // 70 + 0.2 * 10 = 72 %
  const ToolpathRun& second = recorded.blocks[0].runs[1];
  EXPECT_EQ(second.reached_class, 12);  // 300 of 500 mm/s
  EXPECT_EQ(second.power_class, 0);     // the beam is off
}

// A pause keeps runs apart: their times differ.
TEST(ToolpathRecorder, PauseBeginsANewRun) {
  Script script;
  script.Step(1, 1).Line({0, 0, 0}, {1, 0, 0}).Nothing(1.0).Line({1, 0, 0}, {2, 0, 0});
  const Recorded recorded = Record(script);
  ASSERT_EQ(recorded.blocks[0].runs.size(), 2u);
  EXPECT_EQ(recorded.blocks[0].runs[1].start_us - recorded.blocks[0].runs[0].end_us, 1'000'000);
}

// motion.md 9: an arc is ceil(sweep / (2 acos(1 - tol/R))) chords. For a full turn of R = 10 and
// the chord share of the tolerance, 0.0095 mm: 2 pi / (2 * 0.04359...) = 72.07 -> 73.
TEST(ToolpathRecorder, ArcIsAsManyChordsAsTheToleranceNeeds) {
  const PathPiece circle = PathPiece::Circle({{10, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.0, 0.0);
  const Recorded recorded = Record(Script().Motion(Planned(circle)), {.tolerance_mm = 0.01});
  ASSERT_EQ(recorded.blocks.size(), 1u);
  const double chord = 2.0 * std::acos(1.0 - 0.0095 / 10.0);
  EXPECT_EQ(recorded.blocks[0].points.size(),
            static_cast<std::size_t>(std::ceil(kTurn / chord)) + 1);
  EXPECT_LE(WorstDistance(circle, {}, recorded.blocks[0]), 0.01 + 0.001);
}

// motion.md 9, the property: distance between polyline and path at most tolerance + 1 um, for every
// kind of piece and any tolerance.
TEST(ToolpathRecorder, KeepsWithinTheTolerance) {
  const motion::Head head = motion::GantryHead{.length_mm = 300.0};
  const std::vector<PathPiece> paths = {
      PathPiece::Circle({{3, 0, 0}}, {0, 0, 0}, {0, 0.6, 0.8}, 5.0, 0.0, 0.0),
      PathPiece::ArcThrough({{0, 0, 0}}, {50, 0.01, 0}, {{100, 0, 0}}).value().path,
      PathPiece::Joint({{100, 0, 0}, 0.0, -1.0}, {{160, 30, 10}, 2.0, 1.5}),
      PathPiece::Line({{0, 0, 0}}, {{1.23456789, 9.87654321, -5.55555555}})};
  for (const double tolerance : {0.001, 0.01, 0.3, 5.0}) {
    for (const PathPiece& path : paths) {
      const Recorded recorded =
          Record(Script().Motion(Planned(path, {.speed = 1.0, .acceleration = 10.0}, 0.0, head)),
                 {.tolerance_mm = tolerance});
      ASSERT_EQ(recorded.blocks.size(), 1u);
      EXPECT_LE(WorstDistance(path, head, recorded.blocks[0]), tolerance + 0.001)
          << tolerance << ' ' << static_cast<int>(path.kind());
    }
  }
}

// The same on the curves of a /FLY corner, also one where the head turns.
TEST(ToolpathRecorder, KeepsWithinTheToleranceOnCurves) {
  const motion::TipPose corner{{100, 0, 0}, 0.3, 0.2};
  for (const double tolerance : {0.001, 0.01, 0.3}) {
    for (const motion::PlannedMotion& planned :
         PlannedCorner({{0, 0, 0}}, corner, {{100, 80, 30}, 0.5, 0.1})) {
      const Recorded recorded =
          Record(Script().Step(1, 1).Motion(planned), {.tolerance_mm = tolerance});
      ASSERT_EQ(recorded.blocks.size(), 1u);
      EXPECT_LE(WorstDistance(planned.path, {}, recorded.blocks[0]), tolerance + 0.001);
    }
  }
}

// Merging must not add up: a slow bend of 1000 short moves within one step, each almost straight
// on.
TEST(ToolpathRecorder, MergingStaysWithinTheTolerance) {
  const double tolerance = 0.05;
  std::vector<motion::MachinePoint> vertices;
  Script script;
  script.Step(1, 1);
  for (int k = 0; k <= 1000; ++k) {
    const double a = 0.0005 * k;
    vertices.push_back({200.0 * std::sin(a), 200.0 * (1.0 - std::cos(a)), 0.0});
    if (k > 0) script.Line(vertices[vertices.size() - 2], vertices.back());
  }
  const Recorded recorded = Record(script, {.tolerance_mm = tolerance});
  const ToolpathBlock& block = recorded.blocks[0];
  EXPECT_LT(block.points.size(), 200u);
  double worst = 0.0;
  for (const motion::MachinePoint& vertex : vertices)
    worst = std::max(worst, DistanceToPolyline(vertex, PointsOf(block)));
  EXPECT_LE(worst, tolerance + 0.001);
}

// Blocks of at most 4096 points each, without a gap in place or time between them.
TEST(ToolpathRecorder, BlocksFollowEachOther) {
  Script script;
  constexpr int kMoves = 20'000;
  for (int k = 0; k < kMoves; ++k) {
    script.Step(1, k + 1);
    script.Line({0.1 * k, k % 2 * 1.0, 0}, {0.1 * (k + 1), (k + 1) % 2 * 1.0, 0});
  }
  const Recorded recorded = Record(script);
  ASSERT_EQ(recorded.blocks.size(), 5u);  // 20001 points, 4095 of each block are new
  int step = 0;
  for (std::size_t b = 0; b < recorded.blocks.size(); ++b) {
    const ToolpathBlock& block = recorded.blocks[b];
    EXPECT_LE(block.points.size(), kToolpathBlockPoints);
    for (const ToolpathRun& run : block.runs) EXPECT_EQ(run.step, ++step);
    if (b == 0) continue;
    EXPECT_EQ(block.points.front(), recorded.blocks[b - 1].points.back());
    EXPECT_EQ(block.runs.front().start_us, recorded.blocks[b - 1].runs.back().end_us);
  }
  EXPECT_EQ(step, kMoves);
  // Each move: two bytes of flags, step, three of duration, five of point: eleven, and a header a
  // block.
  EXPECT_LT(recorded.bytes, 12u * kMoves);
}

// motion.md 9: what goes straight on is one line also behind the end of a block, and behind a jump:
// from the last point there, not from where the path was before.
TEST(ToolpathRecorder, StraightOnIsOneLineBehindABreak) {
  Script full;
  full.Step(1, 1);
  motion::MachinePoint at;
  for (int k = 1; k < static_cast<int>(kToolpathBlockPoints); ++k) {
    const motion::MachinePoint next{1.0 * k, k % 2 * 1.0, 0};
    full.Line(at, next);
    at = next;
  }
  full.Line(at, at + MachineVector{5, 0, 0})
      .Line(at + MachineVector{5, 0, 0}, at + MachineVector{9, 0, 0});
  const Recorded two_blocks = Record(full);
  ASSERT_EQ(two_blocks.blocks.size(), 2u);
  EXPECT_EQ(two_blocks.blocks[0].points.size(), kToolpathBlockPoints);
  EXPECT_EQ(two_blocks.blocks[1].points,
            (std::vector<ToolpathPoint>{{4'095'000, 1000, 0}, {4'104'000, 1000, 0}}));

  Script jump;
  jump.Step(1, 1).Line({0, 0, 0}, {10, 0, 0});
  jump.Line({0, 5, 0}, {10, 5, 0}).Line({10, 5, 0}, {20, 5, 0});
  const Recorded two_runs = Record(jump);
  ASSERT_EQ(two_runs.blocks.size(), 1u);
  EXPECT_EQ(
      two_runs.blocks[0].points,
      (std::vector<ToolpathPoint>{{0, 0, 0}, {10'000, 0, 0}, {0, 5000, 0}, {20'000, 5000, 0}}));
  ASSERT_EQ(two_runs.blocks[0].runs.size(), 2u);
  EXPECT_EQ(two_runs.blocks[0].runs[1].first_point, 2u);
  EXPECT_EQ(two_runs.blocks[0].runs[1].point_count, 2u);
}

// The class of a speed is the share of the highest tip speed, 500 mm/s here, rounded up: 50 mm/s is
// the second of twenty, 25 the first, 500 and more the last; as fast as the axes can is none.
TEST(ToolpathRecorder, ClassesOfSpeed) {
  const auto class_of = [](double mm_s) {
    Script script;
    script.Step(1, 1).Line({}, {1, 0, 0}, {.programmed_mm_s = mm_s});
    return Record(script).blocks.at(0).runs.at(0).speed_class;
  };
  EXPECT_EQ(class_of(0.0), 0);
  EXPECT_EQ(class_of(1.0), 1);
  EXPECT_EQ(class_of(500.0 / kSpeedClasses), 1);
  EXPECT_EQ(class_of(500.0 / kSpeedClasses + 0.1), 2);
  EXPECT_EQ(class_of(500.0), kSpeedClasses);
  EXPECT_EQ(class_of(900.0), kSpeedClasses);
  // Rounding begins no class: a share is told to 1e-9 of one.
  EXPECT_EQ(class_of(500.0 / kSpeedClasses * (1.0 + 1e-10)), 1);
  EXPECT_EQ(class_of(500.0 / kSpeedClasses * (1.0 + 1e-8)), 2);
}

// Of a machine whose highest speed is not known every speed is of the last class.
TEST(ToolpathRecorder, WithoutAHighestSpeedAllAreOfTheLastClass) {
  std::vector<ToolpathBlock> blocks;
  ToolpathRecorder recorder({}, {}, [&](std::string_view bytes) {
    blocks.push_back(DecodeToolpathBlock(bytes).value());
    return true;
  });
  FakeRun run(Script()
                  .Step(1, 1)
                  .Line({}, {1, 0, 0}, {.programmed_mm_s = 0.5})
                  .Step(1, 2)
                  .Line({1, 0, 0}, {2, 0, 0}),
              recorder);
  run.Advance(kForever);
  recorder.Finish();
  ASSERT_EQ(blocks.at(0).runs.size(), 2u);
  EXPECT_EQ(blocks[0].runs[0].speed_class, kSpeedClasses);
  EXPECT_EQ(blocks[0].runs[0].reached_class, kSpeedClasses);
  EXPECT_EQ(blocks[0].runs[1].speed_class, 0);
}

// Times are rounded to microseconds, half of one up.
TEST(ToolpathRecorder, TimesAreWholeMicroseconds) {
  for (const auto& [pause, us] :
       {std::pair{SimTime(499), 0}, {SimTime(500), 1}, {SimTime(1499), 1}, {SimTime(1500), 2}}) {
    const Recorded recorded =
        Record(Script().Step(1, 1).Nothing(ToSeconds(pause)).Line({}, {1, 0, 0}));
    EXPECT_EQ(recorded.blocks.at(0).runs.at(0).start_us, us) << pause.count();
  }
}

// A run lasts to the end of its motion, its settling included, also where that fills a block.
TEST(ToolpathRecorder, ARunThatFillsABlockHasAllOfItsTime) {
  Script script;
  script.Step(1, 1);
  motion::MachinePoint at;
  for (int k = 1; k < static_cast<int>(kToolpathBlockPoints); ++k) {
    const motion::MachinePoint next{1.0 * k, k % 2 * 1.0, 0};
    script.Motion(Planned(LineFrom(at, next), kSlowLimits, 0.5));
    at = next;
  }
  script.Step(1, 2).Line(at, {});
  const Recorded recorded = Record(script);
  ASSERT_EQ(recorded.blocks.size(), 2u);
  EXPECT_EQ(recorded.blocks[0].points.size(), kToolpathBlockPoints);
  EXPECT_EQ(recorded.blocks[0].runs.back().end_us, recorded.blocks[1].runs.front().start_us);
}

// One arc with more points than a block: the run goes on in the next block, and times grow with the
// way: at half of the way of a motion from rest to rest half of the time is over.
TEST(ToolpathRecorder, LongArcGoesOnInTheNextBlock) {
  const PathPiece circle =
      PathPiece::Circle({{20000, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.0, 0.0);
  const Recorded recorded =
      Record(Script().Step(1, 1).Motion(Planned(circle)), {.tolerance_mm = 0.001});
  ASSERT_GE(recorded.blocks.size(), 2u);
  const double whole_s = ToSeconds(FromSeconds(Planned(circle).duration_s()));
  const auto seconds = [](std::int64_t us) { return static_cast<double>(us) * 1e-6; };
  double way = 0.0;
  std::int64_t last_us = 0;
  for (const ToolpathBlock& block : recorded.blocks) {
    ASSERT_EQ(block.runs.size(), 1u);
    EXPECT_EQ(block.runs[0].start_us, last_us);
    last_us = block.runs[0].end_us;
    for (std::size_t i = 1; i < block.points.size(); ++i) {
      way += (Millimetres(block.points[i - 1]) - Millimetres(block.points[i])).norm();
    }
    if (&block == &recorded.blocks.back()) break;
    // All of the way is at 50 mm/s but the first ramp, which costs half its time: 0.0354 s.
    EXPECT_NEAR(seconds(last_us), way / 50.0 + 0.0354, 0.01);
  }
  EXPECT_NEAR(seconds(last_us), whole_s, 1e-6);
}

// A million moves of a nanometre in one step come to two points; positions do not drift.
TEST(ToolpathRecorder, TinyMovesMerge) {
  Script script;
  script.Step(1, 1);
  constexpr int kMoves = 100'000;
  for (int k = 0; k < kMoves; ++k) script.Line({1e-5 * k, 0, 0}, {1e-5 * (k + 1), 0, 0});
  const Recorded recorded = Record(script);
  ASSERT_EQ(recorded.blocks.size(), 1u);
  EXPECT_LE(recorded.blocks[0].points.size(), 3u);
  EXPECT_EQ(recorded.blocks[0].points.back(), (ToolpathPoint{1000, 0, 0}));
}

// What no machine reaches does not overflow; what is no number does not hang.
TEST(ToolpathRecorder, NonsensePositionsAreHarmless) {
  const Recorded far = Record(Script().Step(1, 1).Line({-1e30, 0, 0}, {1e30, 1e30, 0}));
  ASSERT_EQ(far.blocks.size(), 1u);
  EXPECT_EQ(far.blocks[0].points[0].x_um, -2'000'000'000);
  EXPECT_EQ(far.blocks[0].points[1].x_um, 2'000'000'000);
  motion::PlannedMotion broken = Planned(LineFrom({}, {1, 0, 0}));
  broken.path = PathPiece::Joint({{0, 0, 0}, 0, 0}, {{std::nan(""), 0, 0}, 1.0, 1.0});
  const Recorded none = Record(Script().Step(1, 2).Motion(broken));
  EXPECT_LE(none.blocks.size(), 20u);
}

// The budget of bytes: blocks that fit are handed out, then no more.
TEST(ToolpathRecorder, IsCutOffAtItsBudget) {
  Script script;
  for (int k = 0; k < 20'000; ++k) {
    script.Step(1, k + 1).Line({0.1 * k, k % 2 * 1.0, 0}, {0.1 * (k + 1), (k + 1) % 2 * 1.0, 0});
  }
  const Recorded recorded = Record(script, {.bytes_max = 100'000});
  EXPECT_FALSE(recorded.complete);
  EXPECT_LE(recorded.bytes, 100'000u);
  EXPECT_GE(recorded.blocks.size(), 1u);
}

}  // namespace
}  // namespace rmlcell::simulation
