// What a plan says of its bends, against the bends themselves. motion.md 4.1, 4.3, 5.4.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/motion/ride/trajectory.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// Right angles in X and Y, 2 mm each.
std::vector<MoveCommand> RightAngles(int legs) {
  std::vector<MoveCommand> chain;
  TipPose at{{1000, 900, -200}};
  for (int k = 0; k < legs; ++k) {
    MoveCommand move;
    TipPose to = at;
    (k % 2 == 0 ? to.tip.x() : to.tip.y()) += 2.0;
    move.path = PathPiece::Line(at, to);
    move.speed_fraction = 0.3;
    move.fly = k + 1 < legs;
    move.tag = static_cast<std::uint64_t>(k);
    chain.push_back(move);
    at = to;
  }
  return chain;
}

// The speed of a passage is that in the middle of its curve, where its first half ends, whether it
// is passed steadily, on a ramp or in stretches; the distance is that of the curve. OPT-B.24
TEST(BendReport, TellsSpeedAndDistanceInTheMiddle) {
  int bends = 0, varying = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const std::vector<MoveCommand> chain = RandomChain(
        seed, 30,
        {.head = seed % 3 == 0, .shortest_mm = 0.1, .longest_mm = seed % 2 == 0 ? 3.0 : 60.0});
    const std::vector<PlannedMotion> motions = Plan(chain);
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const PlannedMotion& motion = motions[k];
      if (!motion.ends_move) continue;
      const double end = motion.speed.end().speed;
      ASSERT_NEAR(motion.corner.speed, end, 1e-6 * (1.0 + end)) << seed << " " << motion.tag;
      if (!IsBlend(motion.corner.passage)) continue;
      ++bends;
      if (motion.speed.peak_speed() > motion.speed.At(0.0).speed * (1 + 1e-9)) ++varying;
      const MachinePoint& corner = chain[motion.tag].path.to().point;
      double nearest = HUGE_VAL;
      double step = 0.0;
      for (std::size_t half = k; half <= k + 1; ++half) {
        const PathPiece& path = motions[half].path;
        step = std::max(step, path.length() / 200);
        for (int n = 0; n <= 200; ++n) {
          nearest = std::min(nearest, (path.At(path.length() * n / 200).point - corner).norm());
        }
      }
      // Half a step beside the nearest place the distance is greater by step^2 / (8 nearest), some
      // times more where the curve bends away.
      const double room = std::min(step, step * step / nearest);
      ASSERT_NEAR(motion.corner.deviation_mm, nearest, room + 1e-4 * nearest + 1e-8) << seed;
    }
  }
  EXPECT_GT(bends, 100);
  EXPECT_GT(varying, 20);
}

CornerReport FirstReport(const std::vector<PlannedMotion>& motions) {
  for (const PlannedMotion& motion : motions) {
    if (motion.ends_move) return motion.corner;
  }
  return {};
}

// The wanted speed is OVERSH of the lower of both limits, where it can be reached: cases C01, C02
// and C08; with /FLY to a stop there is none. OPT-2.15, OPT-B.24
TEST(BendReport, WantedSpeeds) {
  const auto wanted = [](double first, double second, double overshoot, double turn_y) {
    std::vector<MoveCommand> chain(2);
    chain[0].path = PathPiece::Line({}, {{100, 0, 0}});
    chain[1].path = PathPiece::Line({{100, 0, 0}}, {{turn_y == 0.0 ? 200.0 : 100.0, turn_y, 0}});
    chain[0].fly = true;
    chain[0].overshoot_fraction = overshoot;
    chain[0].speed_fraction = first;
    chain[1].speed_fraction = second;
    return FirstReport(Plan(chain));
  };
  EXPECT_DOUBLE_EQ(wanted(0.1, 0.1, 1.0, 100.0).wanted_speed, 50.0);
  EXPECT_DOUBLE_EQ(wanted(0.1, 0.1, 0.5, 100.0).wanted_speed, 25.0);
  EXPECT_DOUBLE_EQ(wanted(0.2, 0.08, 1.0, 100.0).wanted_speed, 40.0);
  EXPECT_DOUBLE_EQ(wanted(0.08, 0.2, 1.0, 100.0).wanted_speed, 40.0);
  EXPECT_EQ(wanted(0.1, 0.1, 0.0, 100.0).wanted_speed, 0.0);
  EXPECT_EQ(wanted(0.1, 0.1, 0.0, 100.0).cut_mm, 0.0);
  EXPECT_DOUBLE_EQ(wanted(0.1, 0.1, 1.0, 100.0).speed, 50.0);
  // Straight on to another speed: passed at the lower one, without a curve.
  const CornerReport through = wanted(0.2, 0.08, 1.0, 0.0);
  EXPECT_EQ(through.passage, Passage::kThrough);
  EXPECT_DOUBLE_EQ(through.speed, 40.0);
  EXPECT_EQ(through.cut_mm, 0.0);
  EXPECT_EQ(through.deviation_mm, 0.0);
}

// In the middle of a bend between two slants X alone goes on: at 30 mm/s where that is all it can.
// Speeds that differ by more than 1e-9 of them are not the same, and the bend is told as capped,
// though it has its full size. motion.md 1, 4.3
TEST(BendReport, ABendThatMissesItsSpeedByLittleIsCapped) {
  MachineLimits machine = StandardMachine();
  machine.axes.speed[0] = 30.0;
  const auto told = [&machine](double speed_mm_s) {
    std::vector<MoveCommand> chain(2);
    chain[0].path = PathPiece::Line({}, {{50, 50, 0}});
    chain[1].path = PathPiece::Line({{50, 50, 0}}, {{100, 0, 0}});
    chain[0].speed_fraction = chain[1].speed_fraction = speed_mm_s / 500.0;
    chain[0].fly = true;
    return FirstReport(Plan(chain, machine));
  };
  const CornerReport slower = told(30.0 * (1.0 + 1e-7));
  EXPECT_EQ(slower.passage, Passage::kBlendCapped);
  EXPECT_NEAR(slower.wanted_speed, 30.0 * (1.0 + 1e-7), 1e-9);
  EXPECT_NEAR(slower.speed, 30.0, 1e-7);
  EXPECT_EQ(told(29.9).passage, Passage::kBlend);
}

// A STOP and START in a bend with changing speed goes on at what the whole of it allows: 19.79 mm/s
// (case C16, to the 3 thousandths that places between the steps are rounded down). One passed
// steadily, and all that is no bend, has no such limit.
TEST(BendReport, SpeedsToRestartWith) {
  std::vector<MoveCommand> chain = RightAngles(3);
  const double steady =
      Corner::Between(chain[0].path, chain[1].path).PlainSpeed(1.0, StandardMachine());
  EXPECT_NEAR(steady, 19.79, 0.01);
  int bends = 0;
  for (const PlannedMotion& motion : Plan(chain)) {
    if (motion.path.kind() != PathPiece::Kind::kBlend) {
      EXPECT_EQ(motion.restart_speed, kLargest);
      continue;
    }
    ++bends;
    EXPECT_LE(motion.restart_speed, steady * (1 + 1e-9));
    EXPECT_GE(motion.restart_speed, steady * (1 - 4e-3));
    EXPECT_DOUBLE_EQ(motion.limits.acceleration, 1200.0);
    EXPECT_DOUBLE_EQ(motion.limits.jerk, 40000.0);
    EXPECT_GE(motion.limits.speed * (1 + 1e-9), motion.speed.peak_speed());
  }
  EXPECT_GE(bends, 4);
  for (MoveCommand& move : chain) move.speed_fraction = 0.01;  // 5 mm/s: steadily
  for (const PlannedMotion& motion : Plan(chain)) EXPECT_EQ(motion.restart_speed, kLargest);
}

}  // namespace
}  // namespace rmlcell::motion
