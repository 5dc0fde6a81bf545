// Bends of lines that are passed with changing speed: at every place of them
// what motion.md 4.3 allows there, and what is told of them. motion.md 5.4
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/motion/geometry/blend_curve.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::bend_places {
namespace {

// The highest of v^2 kappa over a_n and v^3 sqrt(kappa'^2 + kappa^4) over j_n
// in all bends.
double MostOfBends(const std::vector<PlannedMotion>& motions, const MachineLimits& machine) {
  double most = 0.0;
  for (const PlannedMotion& motion : motions) {
    if (motion.path.kind() != PathPiece::Kind::kBlend) continue;
    const BlendCurve bend(motion.path);
    constexpr int kPlaces = 64;
    for (int k = 0; k <= kPlaces; ++k) {
      const PathState state = motion.speed.At(motion.speed.duration_s() * k / kPlaces);
      const double u = bend.ParameterAt(state.s);
      const double square = state.speed * state.speed;
      const double across = square * bend.curve().SecondByLength(u).point.norm();
      most = std::max(most, across / machine.normal_acceleration());
      if (std::isinf(machine.tip_jerk_mm_s3)) continue;
      most = std::max(most,
                      square * state.speed * bend.curve().JerkPerCube(u) / machine.normal_jerk());
    }
  }
  return most;
}

// Turns of 125 to 175 degrees between short lines: the bends are tight in the
// middle.
std::vector<MoveCommand> SharpTurns(std::uint64_t seed) {
  Dice dice(seed);
  std::vector<MoveCommand> chain(16);
  MachinePoint at{1000.0, 900.0, -200.0};
  double heading = 0.0;
  for (std::size_t k = 0; k < chain.size(); ++k) {
    heading += (dice.Chance(0.5) ? 1.0 : -1.0) * dice.Uniform(2.2, 3.05);
    const MachineVector along{std::cos(heading), std::sin(heading), 0.0};
    const MachinePoint to = at + along * dice.Magnitude(0.3, 8.0);
    chain[k].path = PathPiece::Line({at}, {to});
    chain[k].speed_fraction = dice.Magnitude(0.1, 1.0);
    chain[k].fly = k + 1 < chain.size();
    chain[k].tag = k;
    at = to;
  }
  return chain;
}

constexpr ChainOptions kShortLines{
    .arcs = false, .head = false, .all_fly = true, .shortest_mm = 0.05, .longest_mm = 10.0};

// Ramps that run through bends keep them everywhere, where level 1 would have
// kept them anyway.
TEST(BendPlaces, NoPlaceIsPassedTooFast) {
  const MachineLimits machine = StandardMachine();
  for (std::uint64_t seed = 95; seed < 150; ++seed)
    EXPECT_LE(MostOfBends(Plan(RandomChain(seed, 20, kShortLines)), machine), 1.0 + 1e-4) << seed;
  for (std::uint64_t seed = 0; seed < 60; ++seed)
    EXPECT_LE(MostOfBends(Plan(SharpTurns(seed)), machine), 1.0 + 1e-4) << seed;
}

// Without a limit on jerk, too, where each sixth of a bend has a speed of its
// own.
TEST(BendPlaces, NorWithoutALimitOnJerk) {
  MachineLimits machine = StandardMachine();
  machine.tip_jerk_mm_s3 = kNoLimit;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    EXPECT_LE(MostOfBends(Plan(RandomChain(seed, 20, kShortLines), machine), machine), 1.0 + 1e-4);
    EXPECT_LE(MostOfBends(Plan(SharpTurns(seed), machine), machine), 1.0 + 1e-4) << seed;
  }
}

// What is told of a bend is the speed in its middle, where the first half ends,
// in however many stretches it is passed.
TEST(BendPlaces, TheSpeedToldIsThatOfTheMiddle) {
  int told = 0, varied = 0;
  for (const double jerk : {40000.0, kNoLimit}) {
    MachineLimits machine = StandardMachine();
    machine.tip_jerk_mm_s3 = jerk;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      for (const PlannedMotion& motion : Plan(SharpTurns(seed), machine)) {
        if (!motion.ends_move || !IsBlend(motion.corner.passage)) continue;
        const double middle = motion.speed.end().speed;
        EXPECT_NEAR(motion.corner.speed, middle, 1e-6 * middle + 1e-9) << seed;
        ++told;
        varied += std::abs(motion.speed.At(0.0).speed - middle) > 0.01 * middle ? 1 : 0;
      }
    }
  }
  EXPECT_GT(told, 500);
  EXPECT_GT(varied, 100);
}

// Motions follow one another without a seam, whatever room there is to look
// ahead.
TEST(BendPlaces, MotionsHaveNoSeams) {
  for (const std::size_t window : {32, 48, 1024}) {
    for (const double share : {1.0, 0.02}) {
      for (std::uint64_t seed = 0; seed < 12; ++seed) {
        MachineLimits machine = StandardMachine();
        machine.tip_acceleration_mm_s2 *= share;
        machine.tip_jerk_mm_s3 *= share;
        const std::vector<PlannedMotion> motions = Plan(RandomChain(seed, 90,
                                                                    {.arcs = seed % 3 == 0,
                                                                     .head = seed % 4 == 1,
                                                                     .all_fly = true,
                                                                     .shortest_mm = 0.2,
                                                                     .longest_mm = 3.0}),
                                                        machine, window);
        double speed = 0.0;
        for (const PlannedMotion& motion : motions) {
          ASSERT_GT(motion.path.length(), 0.0) << seed;
          ASSERT_NEAR(motion.speed.end().s, motion.path.length(), 1e-9) << seed;
          ASSERT_NEAR(motion.speed.At(0.0).speed, speed, 1e-5) << seed << " " << motion.tag;
          speed = motion.speed.end().speed;
          if (motion.ends_move) continue;
          ASSERT_EQ(motion.corner.cut_mm, 0.0) << seed;  // what is told is told at the end
          ASSERT_EQ(motion.corner.speed, 0.0) << seed;
        }
        EXPECT_EQ(speed, 0.0);
      }
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion::bend_places
