// Bends passed with changing speed: level 2 of motion.md 5.4 inside the bends of 4.3.
#include "engine/motion/bend_speed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "engine/core/units.h"
#include "engine/motion/corner.h"
#include "engine/motion/trajectory.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// A turn of `degrees`, its curve cut at `cut`, and what 4.3 allows at a place of it.
struct Turn {
  Turn(double degrees, double cut) {
    const double turn = degrees * kPi / 180.0;
    const PathPiece in = PathPiece::Line({{-50, 0, 0}}, {});
    const PathPiece out = PathPiece::Line({}, {{50 * std::cos(turn), 50 * std::sin(turn), 0}});
    corner = Corner::Between(in, out);
    curve = CornerCurve(EndAt(in, 50.0 - cut), EndAt(out, cut), cut);
    length.emplace(curve);
  }
  double Allowed(double s) const {
    const double u = length->ParameterAt(curve, s);
    const double bend = Norm(curve.SecondByLength(u).tip);
    return std::min(std::sqrt(1600.0 / bend), std::cbrt(32000.0 / curve.JerkPerCube(u)));
  }
  Corner corner;
  CornerCurve curve;
  std::optional<CornerLength> length;
};

// The speeds at the steps are those that v^2 kappa <= a_n and v^3 sqrt(kappa'^2 + kappa^4) <= j_n
// leave: never more, at most half a percent less. OPT-B.24
TEST(BendSpeeds, AreThoseOfTheCurve) {
  const MachineLimits machine = StandardMachine();
  for (const double degrees : {0.1, 5.0, 60.0, 90.0, 124.3, 145.0, 160.0, 174.5}) {
    for (const double cut : {0.01, 1.0, 30.0}) {
      const Turn turn(degrees, cut);
      const BendSpeeds speeds = turn.corner.PlainSpeeds(cut, 1e9, machine);
      for (std::size_t k = 0; k <= BendSpeeds::kSteps; ++k) {
        const double s = 0.5 * turn.length->total() * static_cast<double>(k) / BendSpeeds::kSteps;
        const double allowed = turn.Allowed(s);
        if (allowed > 100.0 * speeds.most[0]) continue;  // nearly straight there
        EXPECT_LE(speeds.most[k], allowed * (1 + 1e-6)) << degrees << " step " << k;
        EXPECT_GE(speeds.most[k], allowed * 0.995) << degrees << " step " << k;
      }
      EXPECT_EQ(turn.corner.PlainSpeeds(cut, 0.5 * speeds.most[0], machine).most[3],
                0.5 * speeds.most[0]);
    }
  }
}

// Whatever ramp a stretch is passed with, from any speed allowed at its start to any allowed at its
// end, it is nowhere faster than the bend allows. OPT-B.24
TEST(BendStretches, EveryRampKeepsTheSpeedsOfTheBend) {
  const MachineLimits machine = StandardMachine();
  Dice dice(11);
  int stretched = 0, halves = 0;
  for (int round = 0; round < 400; ++round) {
    const double cut = dice.Magnitude(1e-3, 20.0);
    const Turn turn(dice.Uniform(1.0, 174.0), cut);
    const double share = dice.Chance(0.5) ? 1.0 : dice.Magnitude(0.05, 1.0);
    PathLimits limits{.acceleration = std::min(1200.0, 2000.0 * share), .jerk = 40000.0 * share};
    const double total = turn.length->total();
    const BendSpeeds speeds =
        turn.corner.PlainSpeeds(cut, dice.Chance(0.7) ? 1e9 : dice.Magnitude(1, 300), machine);
    const BendStretches bend = StretchesOf(speeds, 0.5 * total, limits);
    limits.speed = bend.open;
    if (bend.open > bend.start) ++stretched;
    if (bend.count == 2) ++halves;
    for (int ramps = 0; ramps < 20; ++ramps) {
      const double length = total / static_cast<double>(bend.count);
      const double far = bend.count == 2 ? bend.middle : bend.start;
      const double from = bend.start * (dice.Chance(0.3) ? 1.0 : dice.Uniform(0.0, 1.0));
      const double to = far * (dice.Chance(0.3) ? 1.0 : dice.Uniform(0.0, 1.0));
      if (RampLength(from, to, limits) > length) continue;
      const SpeedProfile ramp = SpeedProfile::Span(length, from, to, limits);
      for (int k = 0; k <= 100; ++k) {
        const PathState state = ramp.At(ramp.duration_s() * k / 100.0);
        ASSERT_LE(state.speed, turn.Allowed(state.s) * (1 + 1e-6))
            << round << " at " << state.s / total << " from " << from / bend.start << " to "
            << to / far << " of " << far << ", open " << bend.open << ", " << bend.count;
      }
    }
  }
  EXPECT_GT(stretched, 100);
  EXPECT_GT(halves, 20);
}

double TimeOf(const std::vector<PlannedMotion>& motions) {
  LongSum sum;
  for (const PlannedMotion& motion : motions) sum.Add(motion.duration_s());
  return sum.value();
}

std::vector<MoveCommand> Zigzag(int legs, double leg_mm, double speed) {
  std::vector<MoveCommand> chain;
  TipPose at{{1000, 900, -200}};
  for (int k = 0; k < legs; ++k) {
    MoveCommand move;
    TipPose to = at;
    (k % 2 == 0 ? to.tip.x : to.tip.y) += leg_mm;
    move.path = PathPiece::Line(at, to);
    move.speed_fraction = speed;
    move.fly = k + 1 < legs;
    move.tag = static_cast<std::uint64_t>(k);
    chain.push_back(move);
    at = to;
  }
  return chain;
}

// motion.md 5.6: three 2 mm legs at 90 degrees. No plan under the limits is faster than 0.3160 s:
// each end takes 0.06615 s (from rest over 1 mm to the 19.79 mm/s at which the bend may be entered,
// jerk 40,000 up, then down), each bend the integral of ds over the local limit, 0.06784 s, and the
// settling 0.048 s. Level 1, at 19.79 mm/s all through the bends, takes 0.3507 s (case C16).
// OPT-2.46, OPT-B.24
TEST(BendStretches, ZigzagOfThreeComesNearWhatTheJerkAllows) {
  const double time = TimeOf(Plan(Zigzag(3, 2.0, 0.3)));
  EXPECT_GT(time, 0.3160);
  EXPECT_LT(time, 1.03 * 0.3160);
  MachineLimits level_one = StandardMachine();
  level_one.ramps_across_passages = false;
  EXPECT_NEAR(TimeOf(Plan(Zigzag(3, 2.0, 0.3), level_one)), 0.350726035, 1e-6);
}

// The same without a limit on jerk. With bends at one speed the plan takes 1.086 times as long as
// the bound of 5.6 (the bench's table); below the bound nothing can be.
TEST(BendStretches, TrapezoidsVaryTheirSpeedInBendsToo) {
  MachineLimits trapezoid = StandardMachine();
  trapezoid.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  MachineLimits level_one = trapezoid;
  level_one.ramps_across_passages = false;
  const double time = TimeOf(Plan(Zigzag(3, 2.0, 0.3), trapezoid));
  const double steady = TimeOf(Plan(Zigzag(3, 2.0, 0.3), level_one));
  EXPECT_GT(time, steady / 1.087);
  EXPECT_LT(time, 0.97 * steady);
}

// Bends that use up their lines, without end: what comes later is known soon enough, so a long
// chain takes as long for each leg as a short one, and nothing waits for its end. Steady bends
// (level 1, trapezoids, weak axes) have one speed for all of them: there the window fills, and the
// bends must become slower, not stop. OPT-2.46, motion.md 5.5
TEST(BendStretches, ChainsThatUseUpTheirLinesGoOn) {
  MachineLimits level_one = StandardMachine();
  level_one.ramps_across_passages = false;
  MachineLimits trapezoid = StandardMachine();
  trapezoid.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  MachineLimits weak = StandardMachine();
  weak.axes.acceleration[1] = 500.0;
  for (const MachineLimits& machine : {StandardMachine(), level_one, trapezoid, weak}) {
    const double each = TimeOf(Plan(Zigzag(200, 0.8, 0.3), machine)) / 200;
    const std::vector<MoveCommand> chain = Zigzag(6000, 0.8, 0.3);
    Planner planner(machine, 1024);
    double time = 0.0;
    std::size_t waiting = 0, most_waiting = 0;
    for (const MoveCommand& move : chain) {
      ASSERT_TRUE(planner.Append(move));
      ++waiting;
      most_waiting = std::max(most_waiting, waiting);
      while (const PlannedItem* item = planner.NextInPlace()) {
        const auto& motion = std::get<PlannedMotion>(*item);
        if (motion.ends_move) --waiting;
        time += motion.duration_s();
      }
    }
    planner.Stop();
    while (const PlannedItem* item = planner.NextInPlace()) {
      time += std::get<PlannedMotion>(*item).duration_s();
    }
    EXPECT_LT(time / 6000, 1.1 * each);
    EXPECT_LE(most_waiting, 1030u);
    if (machine.ramps_across_passages && std::isfinite(machine.tip_jerk_mm_s3) &&
        machine.axes.acceleration[1] == 2000.0) {
      EXPECT_EQ(planner.lookahead_starved(), 0u);
      EXPECT_NEAR(time / 6000, each, 0.02 * each);
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion
