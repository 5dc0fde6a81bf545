// Bends passed with changing speed: level 2 of motion.md 5.4 inside the bends of 4.3.
#include "engine/motion/corner/bend_speed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/core/units.h"
#include "engine/motion/corner/corner.h"
#include "engine/motion/ride/trajectory.h"
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
    const double bend = curve.SecondByLength(u).point.norm();
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

template <class At>
BendSpeeds Speeds(At at) {
  BendSpeeds speeds;
  for (std::size_t k = 0; k < speeds.most.size(); ++k) speeds.most[k] = at(k);
  return speeds;
}

// Six stretches of equal length over the whole bend, each with the least speed on it: those of the
// first half are eight of the 24 steps long, ends included, and the second half is its mirror
// image.
TEST(AbruptSpeeds, AreTheLeastOfEachStretch) {
  EXPECT_EQ(AbruptSpeeds(Speeds([](std::size_t k) { return 10.0 + static_cast<double>(k); })),
            (std::array{10.0, 18.0, 26.0, 26.0, 18.0, 10.0}));
  EXPECT_EQ(AbruptSpeeds(Speeds([](std::size_t k) { return 50.0 - static_cast<double>(k); })),
            (std::array{42.0, 34.0, 26.0, 26.0, 34.0, 42.0}));
  EXPECT_EQ(AbruptSpeeds(Speeds([](std::size_t k) { return k == 11 ? 3.0 : 9.0; })),
            (std::array{9.0, 3.0, 9.0, 9.0, 3.0, 9.0}));
}

// One speed, or less than 1 % to gain: one stretch at the least speed of the bend.
TEST(BendStretches, NothingToGain) {
  constexpr PathLimits kGentle{.acceleration = 100.0, .jerk = 1000.0};
  const auto expect_steady = [&](const BendSpeeds& speeds, double least) {
    const BendStretches bend = StretchesOf(speeds, 1.0, kGentle);
    EXPECT_EQ(bend.count, 1u);
    EXPECT_EQ(bend.start, least);
    EXPECT_EQ(bend.open, least);
    EXPECT_EQ(bend.middle, least);
  };
  expect_steady(Speeds([](std::size_t) { return 10.0; }), 10.0);
  expect_steady(Speeds([](std::size_t k) { return 10.0 + 0.004 * static_cast<double>(k); }), 10.0);
  expect_steady(Speeds([](std::size_t k) { return 10.0 - 0.1 * static_cast<double>(k); }), 7.6);
}

// Open in the middle, and a ramp too gentle to get anywhere near it on the way: 100 mm/s2 and 1000
// mm/s3 make 10.05 of 10 mm/s in the first tenth of 1 mm, where 11 are allowed. So ramps may be
// those to the speed of the middle. A ramp that is there at once is nearly none: 1/64 of the gain.
TEST(BendStretches, OpenInTheMiddle) {
  const BendSpeeds rising =
      Speeds([](std::size_t k) { return 10.0 + static_cast<double>(k) / 2.4; });
  const BendStretches gentle = StretchesOf(rising, 1.0, {.acceleration = 100.0, .jerk = 1000.0});
  EXPECT_EQ(gentle.count, 1u);
  EXPECT_EQ(gentle.start, 10.0);
  EXPECT_NEAR(gentle.open, 20.0, 1e-12);
  EXPECT_NEAR(gentle.middle, 20.0, 1e-12);
  const BendStretches abrupt = StretchesOf(rising, 1.0, {.acceleration = 1e9, .jerk = 1e15});
  EXPECT_LE(abrupt.open, 10.0 + 10.0 / 64.0 + 1e-9);
}

// A ramp that fits where it lies must also leave a speed that the bend keeps behind its end. Of
// jerk 250 mm/s3 the one from 10 to 20 mm/s takes 6 mm, here the first six of 24 steps, and keeps
// below speeds that reach 20 after two. A dip to 15 at any step behind it lets no more than 15 be
// the speed on the way: to that there is a ramp of 3.5 mm.
TEST(BendStretches, KeepTheirSpeedBehindTheRamp) {
  constexpr PathLimits kRamp{.acceleration = 1e9, .jerk = 250.0};
  ASSERT_NEAR(RampLength(10.0, 20.0, kRamp), 6.0, 1e-12);
  // Just short of 24 mm: the ramp ends a little behind the sixth step.
  constexpr double kHalf_mm = 24.0 * (1.0 - 1e-11);
  BendSpeeds speeds =
      Speeds([](std::size_t k) { return std::min(10.0 + 5.0 * static_cast<double>(k), 20.0); });
  EXPECT_NEAR(StretchesOf(speeds, kHalf_mm, kRamp).open, 20.0, 1e-12);
  for (std::size_t dip = 7; dip < BendSpeeds::kSteps; ++dip) {
    BendSpeeds dipped = speeds;
    dipped.most[dip] = 15.0;
    const BendStretches bend = StretchesOf(dipped, kHalf_mm, kRamp);
    EXPECT_EQ(bend.count, 1u);
    EXPECT_EQ(bend.start, 10.0);
    EXPECT_NEAR(bend.open, 15.0, 1e-8) << dip;
  }
}

// A dip right behind the start lets no ramp be above the speed of the dip, however open the middle
// is: then that is the speed all along, and not the one of the start.
TEST(BendStretches, ADipBehindTheStartIsTheSpeedAllAlong) {
  constexpr PathLimits kGentle{.acceleration = 100.0, .jerk = 1000.0};
  for (std::size_t dip = 1; dip < BendSpeeds::kSteps; ++dip) {
    BendSpeeds speeds = Speeds([](std::size_t k) { return k < BendSpeeds::kSteps ? 10.0 : 20.0; });
    speeds.most[dip] = 9.0;
    const BendStretches bend = StretchesOf(speeds, 1.0, kGentle);
    EXPECT_EQ(bend.count, 1u);
    EXPECT_EQ(bend.start, 9.0) << dip;
    EXPECT_EQ(bend.open, 9.0) << dip;
    EXPECT_EQ(bend.middle, 9.0) << dip;
  }
}

// Who begins slower may be at its speed sooner: of jerk J a ramp to w from w/3 takes a way of
// (4/3) sqrt(2/3) w sqrt(w/J), 1.089 of it, that from rest 1. A bend that opens just as the ramp
// from its start does is too tight for the one from rest, so the speed on the way is less.
TEST(BendStretches, RampsFromLowerSpeedsKeepTheSpeedsToo) {
  constexpr PathLimits kRamp{.speed = 20.0, .acceleration = 1e9, .jerk = 250.0};
  constexpr double kStart = 20.0 / 3.0;
  const double half_mm = RampLength(kStart, 20.0, kRamp);
  ASSERT_NEAR(half_mm / RampLength(0.0, 20.0, kRamp), 4.0 / 3.0 * std::sqrt(2.0 / 3.0), 1e-9);
  const SpeedProfile ramp = SpeedProfile::Span(half_mm, kStart, 20.0, kRamp);
  const BendSpeeds opens = Speeds([&](std::size_t k) {
    const double x = half_mm * static_cast<double>(k) / BendSpeeds::kSteps;
    const double room = k == 0 ? 1.0 : k < BendSpeeds::kSteps / 2 ? 1.03 : 1.001;
    return std::min(room * ramp.At(ramp.TimeAt(x)).speed, 20.0);
  });
  const BendStretches bend = StretchesOf(opens, half_mm, kRamp);
  EXPECT_EQ(bend.count, 1u);
  EXPECT_NEAR(bend.start, kStart, 1e-9);
  EXPECT_GT(bend.open, 1.5 * kStart);
  EXPECT_LT(bend.open, 20.0);
  const double way = RampLength(0.0, bend.open, kRamp);
  const SpeedProfile from_rest = SpeedProfile::Span(way, 0.0, bend.open, kRamp);
  for (std::size_t k = 0; k <= BendSpeeds::kSteps; ++k) {
    const double x = std::min(half_mm * static_cast<double>(k) / BendSpeeds::kSteps, way);
    EXPECT_LE(from_rest.At(from_rest.TimeAt(x)).speed, opens.most[k] * 1.001) << k;
  }
}

// Where the bounds say that all ramps fit, they do, from any speed and at any place (brute force,
// 400 places of each of 21 ramps), straight between the steps. Bends that open in any way; half of
// them much as a ramp from the start does, where those from rest are a tenth faster.
TEST(RampsFitByBounds, OnlyWhereEveryRampDoes) {
  Dice dice(46);
  int yes = 0, near = 0;
  for (int round = 0; round < 4000; ++round) {
    const double start = dice.Magnitude(2.0, 60.0), half_mm = dice.Magnitude(0.02, 20.0);
    const double share = dice.Magnitude(0.3, 6.0), power = dice.Magnitude(0.6, 2.5);
    // What jerk makes of the start on the whole way, by the bound f + j x^2 / (2 f^2).
    const double jerk = 2.0 * share * start * start * start / (half_mm * half_mm);
    const bool as_the_ramp = dice.Chance(0.5);
    const double more = dice.Uniform(1.0, 1.6);
    const BendSpeeds opens = Speeds([&](std::size_t k) {
      const double x = static_cast<double>(k) / BendSpeeds::kSteps;
      const double from_rest = std::cbrt(9.0 * share * x * x);
      return start * (as_the_ramp ? more * std::max(1.0 + share * x * x, 0.9 * from_rest)
                                  : 1.0 + share * more * std::pow(x, power));
    });
    const double step_mm = half_mm / BendSpeeds::kSteps;
    const double fastest = std::min(start, opens.most.front());
    const double to = start + (opens.most.back() - start) * dice.Uniform(0.2, 1.0);
    if (!RampsFitByBounds(opens.most, step_mm, jerk, fastest, to)) continue;
    ++yes;
    const PathLimits limits{.speed = 1e9, .acceleration = 1e12, .jerk = jerk};
    for (int from = 0; from <= 20; ++from) {
      const double slow = fastest * from / 20.0;
      const SpeedProfile up = SpeedProfile::OneRamp(slow, to, limits);
      for (int k = 0; k <= 400; ++k) {
        const PathState state = up.At(up.duration_s() * k / 400.0);
        const double x = state.s / step_mm;
        if (x >= BendSpeeds::kSteps) break;
        const auto step = static_cast<std::size_t>(x);
        const double here = opens.most[step] + (opens.most[step + 1] - opens.most[step]) *
                                                   (x - static_cast<double>(step));
        ASSERT_LE(state.speed, here * (1 + 1e-9)) << round << " from " << slow << " at " << x;
        if (k > 0 && state.speed > 0.97 * here) ++near;
      }
    }
  }
  EXPECT_GT(yes, 500);
  EXPECT_GT(near, 500);
}

// Figures for which all bounds are exact: with x the step, the speed is at most f + x^2 growth, and
// from rest the cube root of 4.5 j x^2.
TEST(RampsFitByBounds, UpToTheBoundsThemselves) {
  const auto fit = [](std::vector<double> most, double jerk, double fastest, double to) {
    return RampsFitByBounds(most, 1.0, jerk, fastest, to);
  };
  // From rest 6 after one step: the limit begins flat, and behind it none is faster than 6.
  EXPECT_TRUE(fit({6, 6, 6}, 48.0, 4.0, 6.0));
  EXPECT_FALSE(fit({5.99, 6, 6}, 48.0, 4.0, 6.0));
  EXPECT_FALSE(fit({6, 5.99, 6}, 48.0, 4.0, 5.0));
  EXPECT_FALSE(fit({6, 6, 5.99}, 48.0, 4.0, 6.0));
  // From 2 mm/s at most 8 after one step.
  EXPECT_TRUE(fit({6, 8, 8}, 48.0, 2.0, 8.0));
  EXPECT_FALSE(fit({6, 7.99, 8}, 48.0, 2.0, 7.0));
  // At most 2 + 4 after two.
  EXPECT_TRUE(fit({10, 10, 6}, 8.0, 2.0, 7.0));
  EXPECT_FALSE(fit({10, 10, 5.99}, 8.0, 2.0, 7.0));
  // From rest 6 after two.
  EXPECT_TRUE(fit({10, 10, 6}, 12.0, 4.0, 7.0));
  EXPECT_FALSE(fit({10, 10, 5.99}, 12.0, 4.0, 7.0));
}

// motion.md 5.4: what gains one part in a hundred is passed at changing speed, at the start as in
// the middle.
TEST(BendStretches, OnePartInAHundredIsWorthwhile) {
  constexpr PathLimits kGentle{.acceleration = 100.0, .jerk = 1000.0};
  const auto rising = [](double top) {
    return Speeds([top](std::size_t k) {
      return 100.0 + (top - 100.0) * static_cast<double>(k) / BendSpeeds::kSteps;
    });
  };
  EXPECT_EQ(StretchesOf(rising(101.0), 1.0, kGentle).open, 101.0);
  EXPECT_EQ(StretchesOf(rising(100.99), 1.0, kGentle).open, 100.0);
  const auto falling_to = [](double middle) {
    return Speeds([middle](std::size_t k) {
      return k <= 12 ? 50.0 + 51.0 / 12.0 * static_cast<double>(k)
                     : 101.0 - (101.0 - middle) / 12.0 * static_cast<double>(k - 12);
    });
  };
  EXPECT_EQ(StretchesOf(falling_to(100.0), 1.0, kGentle).count, 2U);
  EXPECT_EQ(StretchesOf(falling_to(100.01), 1.0, kGentle).count, 1U);
}

// Open between the start and the middle: two stretches, each up and down again, both as far as the
// side that is the shorter way allows.
TEST(BendStretches, OpenBetween) {
  const BendSpeeds hump = Speeds([](std::size_t k) {
    const double from_top = k < 12 ? 12.0 - static_cast<double>(k) : static_cast<double>(k) - 12.0;
    return 20.0 - from_top / (k < 12 ? 1.2 : 2.0);
  });
  const BendStretches bend = StretchesOf(hump, 1.0, {.acceleration = 100.0, .jerk = 1000.0});
  EXPECT_EQ(bend.count, 2u);
  EXPECT_NEAR(bend.start, 10.0, 1e-12);
  EXPECT_NEAR(bend.middle, 14.0, 1e-12);
  EXPECT_NEAR(bend.open, 20.0, 1e-12);
  const BendStretches abrupt = StretchesOf(hump, 1.0, {.acceleration = 1e9, .jerk = 1e15});
  EXPECT_LE(abrupt.open, 14.0);  // from 10 it is nearly 10, which the middle has
  EXPECT_GE(abrupt.open, 10.0);
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
    (k % 2 == 0 ? to.tip.x() : to.tip.y()) += leg_mm;
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

// A curve may touch several moves in line with each other: along it ACCEL is the least of them all.
// Here it reaches 2 mm to both sides, half of the way to a stop.
TEST(BendStretches, ACurveKeepsTheAccelerationOfAllItTouches) {
  for (const auto& [weak, touched] :
       {std::pair{3, false}, {4, true}, {7, true}, {8, true}, {11, true}, {12, false}}) {
    std::vector<MoveCommand> chain;
    TipPose at{{1000, 900, -200}};
    for (int k = 0; k < 16; ++k) {  // 8 x 0.5 mm along X, as many along Y
      MoveCommand move;
      TipPose to = at;
      (k < 8 ? to.tip.x() : to.tip.y()) += 0.5;
      move.path = PathPiece::Line(at, to);
      move.speed_fraction = 0.3;
      move.acceleration_fraction = k == weak ? 0.05 : 1.0;
      move.fly = k < 15;
      move.tag = static_cast<std::uint64_t>(k);
      chain.push_back(move);
      at = to;
    }
    const std::vector<PlannedMotion> motions = Plan(chain);
    double most = 0.0;
    for (const PlannedMotion& motion : motions) {
      if (motion.path.kind() != PathPiece::Kind::kBlend) continue;
      for (int n = 0; n < motion.speed.phase_count(); ++n) {
        const SpeedProfile::Phase& phase = motion.speed.phase(n);
        most = std::max({most, std::abs(phase.start.acceleration),
                         std::abs(phase.start.acceleration + phase.duration_s * phase.jerk)});
      }
    }
    const double allowed = 0.05 * StandardMachine().tip_acceleration_mm_s2;
    EXPECT_EQ(most <= allowed * (1 + 1e-9), touched) << weak << ": " << most;
  }
}

}  // namespace
}  // namespace rmlcell::motion
