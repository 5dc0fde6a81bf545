#include "engine/motion/ride/interruption.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "engine/motion/kinematics/axis_demand.h"
#include "engine/motion/ride/trajectory.h"
#include "tests/engine/motion/plan_check.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

double Length(const std::vector<PlannedMotion>& motions) {
  double sum = 0.0;
  for (const PlannedMotion& motion : motions) sum += motion.path.length();
  return sum;
}

// Two lines with a right angle at 50 mm/s; STOP 1 mm before the bend, in which the machine brakes
// with 0.6 * 2000 at most: 50/1200 + 1200/40000 s at 25 mm/s on average, 1.7917 mm. motion.md
// section 6, OPT-B.31
TEST(StopAlong, BrakesIntoTheBend) {
  MoveCommand east, north;
  east.path = PathPiece::Line({}, {{100, 0, 0}});
  east.speed_fraction = north.speed_fraction = 0.1;
  east.fly = true;
  north.path = PathPiece::Line({{100, 0, 0}}, {{100, 100, 0}});
  north.tag = 1;
  const std::vector<PlannedMotion> plan = Plan({east, north});
  const double t = plan[0].speed.TimeAt(plan[0].path.length() - 1.0);
  const StopOnPath stop = StopAlong(plan, t, StandardMachine().axes);
  ASSERT_TRUE(stop.complete);
  ASSERT_EQ(stop.motions.size(), 2u);
  EXPECT_EQ(stop.index, 1u);
  const double time = 50.0 / 1200.0 + 1200.0 / 40000.0;
  const double way = 25.0 * time;
  EXPECT_NEAR(Length(stop.motions), way, 1e-9);
  EXPECT_NEAR(stop.s, way - 1.0, 1e-9);
  EXPECT_NEAR(stop.motions[0].duration_s() + stop.motions[1].duration_s(), time, 1e-9);
  EXPECT_EQ(stop.motions[1].speed.end().speed, 0.0);
}

// A STOP within a bend of the axes (motion.md 4.5), whose middle takes all that they have: braking
// begins at once if that is sooner, else behind the bend. So it takes no longer than to pass the
// bend and to brake behind it.
TEST(StopAlong, BendsOfTheAxesDoNotDelayTheRest) {
  MoveCommand east, north;
  east.kind = north.kind = MoveCommand::Kind::kPointToPointAxes;
  east.path = PathPiece::Joint({{0, 0, 0}}, {{500, 0, 0}, 1.0, 0.0});
  north.path = PathPiece::Joint({{500, 0, 0}, 1.0, 0.0}, {{500, 400, 0}, 1.0, 0.5});
  east.fly = true;
  const std::vector<PlannedMotion> plan = Plan({east, north});
  ASSERT_EQ(plan.size(), 4u);
  const std::span<const PlannedMotion> bend = std::span(plan).subspan(1);
  const double passing = plan[1].duration_s() + plan[2].duration_s();
  const StopOnPath behind = StopAlong(std::span(plan).subspan(3), 0.0, StandardMachine().axes);
  double braking = 0.0;
  for (const PlannedMotion& motion : behind.motions) braking += motion.duration_s();
  for (int k = 0; k <= 20; ++k) {
    const double t = plan[1].duration_s() * k / 20.0;
    const StopOnPath stop = StopAlong(bend, t, StandardMachine().axes);
    ASSERT_TRUE(stop.complete);
    double time = 0.0;
    for (const PlannedMotion& motion : stop.motions) {
      EXPECT_GT(motion.path.length(), 0.0) << k;
      EXPECT_EQ(motion.settling_s, 0.0) << k;
      time += motion.duration_s();
    }
    EXPECT_LE(time, passing - t + braking + 1e-9) << k;
  }
  // At the end of the move before it nothing of that move is left.
  const StopOnPath stop = StopAlong(plan, plan[0].speed.duration_s(), StandardMachine().axes);
  double time = 0.0;
  for (const PlannedMotion& motion : stop.motions) time += motion.duration_s();
  EXPECT_LE(time, passing + braking + 1e-9);
}

// ACCEL 100 before a right angle passed steadily, 20 behind it: each half of the bend brakes as its
// own move does, but not harder than curve_tangential allows. OPT-2.16, OPT-B.31
TEST(StopAlong, EachHalfOfABendBrakesAsItsOwnMoveDoes) {
  for (const bool strong_first : {true, false}) {
    MoveCommand east, north;
    east.path = PathPiece::Line({}, {{100, 0, 0}});
    east.speed_fraction = north.speed_fraction = 0.1;
    east.acceleration_fraction = strong_first ? 1.0 : 0.2;
    north.acceleration_fraction = strong_first ? 0.2 : 1.0;
    east.fly = true;
    north.path = PathPiece::Line({{100, 0, 0}}, {{100, 100, 0}});
    north.tag = 1;
    const std::vector<PlannedMotion> plan = Plan({east, north});
    ASSERT_EQ(plan.size(), 4u);
    for (std::size_t half = 1; half <= 2; ++half) {
      const bool strong = (half == 1) == strong_first;
      EXPECT_EQ(plan[half].limits.acceleration, strong ? 1200.0 : 400.0);
      EXPECT_EQ(plan[half].limits.jerk, strong ? 40000.0 : 8000.0);
    }
    // A STOP that begins behind the corner touches nothing but the second move: 50 mm/s to rest.
    const double a = strong_first ? 400.0 : 1200.0;
    const double j = strong_first ? 8000.0 : 40000.0;
    const StopOnPath stop = StopAlong(std::span(plan).subspan(2), 0.0, StandardMachine().axes);
    EXPECT_NEAR(Length(stop.motions), 25.0 * (50.0 / a + a / j), 1e-9);
  }
}

// Straight on over moves of ever less ACCEL, 100, 20 and 10, at 50 mm/s: the weakest move on the
// way sets acceleration and jerk of the whole ramp, and where that is too long for the moves it was
// looked for, the next move counts too. 50/a + a/j s at 25 mm/s on average. OPT-2.16, OPT-B.31
TEST(StopAlong, TheWeakestMoveOnTheWaySetsTheRamp) {
  constexpr double kStrong = 50.0 / 2000.0, kWeak = 50.0 / 400.0 + 400.0 / 8000.0,
                   kWeakest = 50.0 / 200.0 + 200.0 / 4000.0;
  for (const auto& [second_mm, left_mm, time] :
       {std::tuple{40.0, 8.0, kStrong}, {40.0, 1.0, kWeak}, {2.0, 1.0, kWeakest}}) {
    std::vector<MoveCommand> chain(3);
    const double ends[4] = {0.0, 100.0, 100.0 + second_mm, 200.0 + second_mm};
    for (std::size_t k = 0; k < 3; ++k) {
      chain[k].path = PathPiece::Line({{ends[k], 0, 0}}, {{ends[k + 1], 0, 0}});
      chain[k].speed_fraction = 0.1;
      chain[k].acceleration_fraction = k == 0 ? 1.0 : k == 1 ? 0.2 : 0.1;
      chain[k].fly = k < 2;
    }
    const std::vector<PlannedMotion> plan = Plan(chain);
    const double t = plan[0].speed.TimeAt(100.0 - left_mm);
    const StopOnPath stop = StopAlong(plan, t, StandardMachine().axes);
    // With ACCEL 100 the speed never gets to 2000 mm/s2: 2 sqrt(50/40000).
    const double ramp_s = time == kStrong ? 2.0 * std::sqrt(50.0 / 40000.0) : time;
    EXPECT_NEAR(Length(stop.motions), 25.0 * ramp_s, 1e-9) << second_mm << " " << left_mm;
    EXPECT_NEAR(stop.motions[0].path.from().point.x(), 100.0 - left_mm, 1e-9);
  }
}

// A STOP and START in a bend where the head turns: what is told of the limits does not shrink each
// time that the axes ask for a gentler ramp. OPT-B.31
TEST(RestartAlong, LimitsStayThoseOfThePlan) {
  const MachineLimits machine = StandardMachine();
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::vector<PlannedMotion> plan =
        Plan(RandomChain(seed, 6, {.all_fly = true, .shortest_mm = 0.5, .longest_mm = 5.0}));
    const double s = 0.5 * plan[1].path.length();
    const std::vector<PlannedMotion> rest =
        RestartAlong(std::span(plan).subspan(1), s, machine.axes);
    ASSERT_EQ(rest.size(), plan.size() - 1);
    for (std::size_t k = 0; k < rest.size(); ++k) {
      EXPECT_EQ(rest[k].limits.acceleration, plan[k + 1].limits.acceleration) << seed;
      EXPECT_EQ(rest[k].limits.jerk, plan[k + 1].limits.jerk) << seed;
    }
  }
}

// Where a ramp in a bend asks too much of an axis a gentler one goes on: with a half, a quarter ...
// of the limit on jerk as of that on acceleration. OPT-B.31
TEST(RestartAlong, GentlerRampsAreGentlerInTheirJerk) {
  MachineLimits machine = StandardMachine();
  int gentler = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const std::vector<PlannedMotion> plan =
        Plan(RandomChain(seed, 6, {.all_fly = true, .shortest_mm = 0.5, .longest_mm = 5.0}));
    for (std::size_t k = 0; k < plan.size(); ++k) {
      if (plan[k].path.kind() != PathPiece::Kind::kBlend) continue;
      const std::vector<PlannedMotion> rest =
          RestartAlong(std::span(plan).subspan(k), 0.5 * plan[k].path.length(), machine.axes);
      ASSERT_FALSE(rest.empty());
      ASSERT_GT(rest[0].speed.phase_count(), 0);
      const double share = rest[0].speed.phase(0).jerk / plan[k].limits.jerk;
      EXPECT_NEAR(std::exp2(std::round(std::log2(share))), share, 1e-9) << seed;
      gentler += share < 0.75 ? 1 : 0;
    }
  }
  EXPECT_GT(gentler, 0);
}

// Where the head turns in a bend, too, no axis is asked there for more than it can, be it by a STOP
// or by the START behind it: for 0.1 % more, which is no harm. OPT-2.16, OPT-B.31
TEST(StopAlong, KeepsTheAxesInBends) {
  const AxisLimits axes = StandardMachine().axes;
  double worst = 0.0;
  const auto look = [&](const std::vector<PlannedMotion>& motions) {
    for (const PlannedMotion& motion : motions) {
      if (motion.path.kind() != PathPiece::Kind::kBlend) continue;
      for (int k = 0; k <= 32; ++k) {
        const PathState state = motion.speed.At(motion.speed.duration_s() * k / 32);
        const AxisDerivatives q = DerivativesAt(motion.path, motion.head, state.s);
        for (std::size_t i = 0; i < kAxisCount; ++i) {
          const double asked =
              q.first[i] * state.acceleration + q.second[i] * state.speed * state.speed;
          worst = std::max(worst, std::abs(asked) / axes.acceleration[i]);
        }
      }
    }
  };
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const std::vector<PlannedMotion> plan =
        Plan(RandomChain(seed, 6, {.all_fly = true, .shortest_mm = 0.5, .longest_mm = 5.0}));
    for (std::size_t k = 0; k < plan.size(); ++k) {
      const std::span<const PlannedMotion> ahead = std::span(plan).subspan(k);
      for (const double share : {0.0, 0.5, 1.0}) {
        const StopOnPath stop = StopAlong(ahead, share * plan[k].speed.duration_s(), axes);
        ASSERT_TRUE(stop.complete);
        for (const PlannedMotion& motion : stop.motions) EXPECT_GT(motion.path.length(), 0.0);
        look(stop.motions);
        look(RestartAlong(ahead.subspan(stop.index), stop.s, axes));
      }
    }
  }
  EXPECT_LE(worst, 1.001 + 1e-9);
  EXPECT_GT(worst, 0.9);
}

// Stopped anywhere and started again: the same path, every limit kept, the end at rest at the
// target. motion.md section 10, property 12
TEST(RestartAlong, GoesOnOverTheSamePath) {
  const MachineLimits machine = StandardMachine();
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const std::vector<MoveCommand> chain =
        RandomChain(seed, 8, {.head = false, .all_fly = true, .shortest_mm = 0.1});
    const std::vector<PlannedMotion> plan = Plan(chain);
    Dice dice(seed);
    const auto at = static_cast<std::size_t>(dice.Uniform(0.0, static_cast<double>(plan.size())));
    const double t = dice.Uniform(0.0, plan[at].speed.duration_s());
    const std::span<const PlannedMotion> ahead = std::span(plan).subspan(at);
    const StopOnPath stop = StopAlong(ahead, t, machine.axes);
    ASSERT_TRUE(stop.complete) << seed;
    const std::vector<PlannedMotion> rest =
        RestartAlong(ahead.subspan(stop.index), stop.s, machine.axes);

    const double before = plan[at].speed.At(t).s;
    double whole = -before;
    for (const PlannedMotion& motion : ahead) whole += motion.path.length();
    EXPECT_NEAR(Length(stop.motions) + Length(rest), whole, 1e-8) << seed;
    if (rest.empty()) continue;
    const PlanCheck check{chain, rest, machine};
    for (const std::string& violation : check.Violations()) {
      ADD_FAILURE() << "seed " << seed << ": " << violation;
    }
    EXPECT_EQ(rest.back().path.to(), plan.back().path.to());
    EXPECT_EQ(rest.back().speed.end().speed, 0.0);
    if (!stop.motions.empty()) {
      const MotionView last(stop.motions.back());
      const MotionView next(rest.front());
      EXPECT_LE((last.PoseAt(last.duration_s()).tip - next.PoseAt(0.0).tip).norm(), 1e-9) << seed;
    }
  }
}

// Stopped and started again and again, with a turning head and in bends that use up their lines:
// the tip and the head come through the same places, and the end is the same. motion.md section 10,
// property 12
TEST(RestartAlong, ManyHaltsKeepThePath) {
  const MachineLimits machine = StandardMachine();
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const std::vector<PlannedMotion> plan =
        Plan(RandomChain(seed, 8,
                         {.arcs = seed % 2 == 0,
                          .all_fly = true,
                          .shortest_mm = 0.1,
                          .longest_mm = seed % 3 == 0 ? 2.0 : 50.0}));
    std::vector<PlannedMotion> driven;
    std::vector<PlannedMotion> ahead = plan;
    Dice dice(seed);
    for (int halts = 0; halts < 5 && !ahead.empty(); ++halts) {
      const auto at = static_cast<std::size_t>(
          dice.Uniform(0.0, std::min(3.0, static_cast<double>(ahead.size()))));
      const double t = dice.Uniform(0.0, ahead[at].speed.duration_s());
      for (std::size_t k = 0; k < at; ++k) driven.push_back(ahead[k]);
      const double s = ahead[at].speed.At(t).s;
      if (s > 0.0) {
        PlannedMotion part = ahead[at];
        if (s < part.path.length()) part.path = part.path.Part(0.0, s);
        driven.push_back(part);
      }
      const StopOnPath stop = StopAlong(std::span(ahead).subspan(at), t, machine.axes);
      ASSERT_TRUE(stop.complete) << seed;
      driven.insert(driven.end(), stop.motions.begin(), stop.motions.end());
      ahead = RestartAlong(std::span(ahead).subspan(at + stop.index), stop.s, machine.axes);
    }
    driven.insert(driven.end(), ahead.begin(), ahead.end());
    ASSERT_NEAR(Length(driven), Length(plan), 1e-7) << seed;
    // Each piece driven lies on the piece of the plan that is as far along.
    std::size_t piece = 0;
    double begin = 0.0;  // of that piece
    double way = 0.0;
    for (const PlannedMotion& motion : driven) {
      for (const double share : {0.0, 0.5, 1.0}) {
        const double x = way + motion.path.length() * share;
        while (piece + 1 < plan.size() && x > begin + plan[piece].path.length()) {
          begin += plan[piece++].path.length();
        }
        const PathPose here = motion.path.At(motion.path.length() * share);
        const PathPose wanted = plan[piece].path.At(x - begin);
        ASSERT_LE((here.point - wanted.point).norm(), 1e-6) << seed;
        ASSERT_NEAR(here.a_rad, wanted.a_rad, 1e-6) << seed;
        ASSERT_NEAR(here.b_rad, wanted.b_rad, 1e-6) << seed;
      }
      way += motion.path.length();
    }
  }
}

// One line of 100 mm at 50 mm/s, with 0.048 s of settling behind it. Its ramps of jerk 40,000 take
// 2 sqrt(50/40000) = 0.0707 s and 1.768 mm. motion.md 5.2
MoveCommand LineOf100() {
  MoveCommand move;
  move.path = PathPiece::Line({}, {{100, 0, 0}});
  move.speed_fraction = 0.1;
  move.tag = 7;
  return move;
}
const double kRamp_s = 2.0 * std::sqrt(50.0 / 40000.0);
const double kRamp_mm = 25.0 * kRamp_s;

// A STOP in the middle rests on the path and settles nothing; the START behind it does the rest of
// the move, whose end and settling are its own. OPT-B.31
TEST(StopAlong, RestsOnALineAndGoesOn) {
  const std::vector<PlannedMotion> plan = Plan({LineOf100()});
  ASSERT_EQ(plan.size(), 1u);
  const double t = kRamp_s + (50.0 - kRamp_mm) / 50.0;  // at 50 mm
  const StopOnPath stop = StopAlong(plan, t, StandardMachine().axes);
  EXPECT_TRUE(stop.complete);
  EXPECT_EQ(stop.index, 0u);
  EXPECT_NEAR(stop.s, 50.0 + kRamp_mm, 1e-9);
  ASSERT_EQ(stop.motions.size(), 1u);
  const PlannedMotion& braking = stop.motions[0];
  EXPECT_FALSE(braking.ends_move);
  EXPECT_EQ(braking.settling_s, 0.0);
  EXPECT_EQ(braking.tag, 7u);
  EXPECT_NEAR(braking.path.from().point.x(), 50.0, 1e-9);
  EXPECT_NEAR(braking.path.to().point.x(), stop.s, 1e-9);
  EXPECT_NEAR(braking.speed.duration_s(), kRamp_s, 1e-9);

  const std::vector<PlannedMotion> rest = RestartAlong(plan, stop.s, StandardMachine().axes);
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_TRUE(rest[0].ends_move);
  EXPECT_EQ(rest[0].settling_s, 0.048);
  EXPECT_EQ(rest[0].corner.speed, 0.0);
  EXPECT_NEAR(rest[0].path.length(), 50.0 - kRamp_mm, 1e-9);
  EXPECT_NEAR(rest[0].speed.duration_s(), 2 * kRamp_s + (50.0 - 3 * kRamp_mm) / 50.0, 1e-9);
}

// In its last ramp a STOP leads to the end of the move and no further; all that is left is to
// settle. While it settles, or stands, a STOP is nothing. OPT-B.31
TEST(StopAlong, AtTheEndNothingIsLeftButToSettle) {
  const std::vector<PlannedMotion> plan = Plan({LineOf100()});
  const double moving = plan[0].speed.duration_s();
  const StopOnPath stop = StopAlong(plan, moving - 0.25 * kRamp_s, StandardMachine().axes);
  EXPECT_TRUE(stop.complete);
  EXPECT_NEAR(stop.s, 100.0, 1e-9);
  ASSERT_EQ(stop.motions.size(), 1u);
  EXPECT_NEAR(stop.motions[0].speed.duration_s(), 0.25 * kRamp_s, 1e-9);
  EXPECT_EQ(stop.motions[0].settling_s, 0.0);

  for (const double t : {moving, moving + 0.01, moving + 0.048}) {
    const StopOnPath none = StopAlong(plan, t, StandardMachine().axes);
    EXPECT_TRUE(none.complete);
    EXPECT_TRUE(none.motions.empty());
    EXPECT_EQ(none.index, 0u);
    EXPECT_EQ(none.s, 100.0);
  }
  const std::vector<PlannedMotion> rest = RestartAlong(plan, 100.0, StandardMachine().axes);
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].speed.duration_s(), 0.0);
  EXPECT_EQ(rest[0].duration_s(), 0.048);
  EXPECT_EQ(rest[0].path.length(), 0.0);
  EXPECT_EQ(rest[0].path.from().point, (MachineVector{100, 0, 0}));
  EXPECT_TRUE(rest[0].ends_move);
}

// A stop between two moves that costs no settling (OVERSH 0): who rests there goes on with the next
// move alone, and a STOP in the last ramp before it does not reach into it. OPT-2.15, OPT-B.31
TEST(StopAlong, StopsBetweenMovesStayWhereTheyAre) {
  MoveCommand first = LineOf100(), second = LineOf100();
  first.fly = true;
  first.overshoot_fraction = 0.0;
  second.path = PathPiece::Line({{100, 0, 0}}, {{100, 40, 0}});
  second.tag = 8;
  const std::vector<PlannedMotion> plan = Plan({first, second});
  ASSERT_EQ(plan.size(), 2u);
  ASSERT_EQ(plan[0].settling_s, 0.0);
  const double moving = plan[0].speed.duration_s();
  const StopOnPath stop = StopAlong(plan, moving - 0.25 * kRamp_s, StandardMachine().axes);
  EXPECT_EQ(stop.index, 0u);
  EXPECT_NEAR(stop.s, 100.0, 1e-9);
  EXPECT_EQ(stop.motions.size(), 1u);
  const std::vector<PlannedMotion> rest = RestartAlong(plan, 100.0, StandardMachine().axes);
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].tag, 8u);
  EXPECT_NEAR(rest[0].duration_s(), plan[1].duration_s(), 1e-12);
  // From 20 mm before its end: both moves, the first as far as it is left.
  const std::vector<PlannedMotion> both = RestartAlong(plan, 80.0, StandardMachine().axes);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_NEAR(both[0].path.length(), 20.0, 1e-9);
  EXPECT_NEAR(both[0].duration_s(), 2 * kRamp_s + (20.0 - 2 * kRamp_mm) / 50.0, 1e-9);
  EXPECT_EQ(both[1].path.length(), 40.0);
}

// What is not planned yet may lie on the way: a STOP says that it needs more. motion.md section 6
TEST(StopAlong, SaysWhenMoreIsToBePlanned) {
  MoveCommand first = LineOf100(), second = LineOf100();
  first.fly = true;
  second.path = PathPiece::Line({{100, 0, 0}}, {{200, 0, 0}});
  second.tag = 8;
  const std::vector<PlannedMotion> plan = Plan({first, second});
  ASSERT_EQ(plan.size(), 2u);                          // straight on
  const double near_end = plan[0].speed.TimeAt(99.0);  // 1 mm before, 1.768 are needed
  EXPECT_FALSE(StopAlong(std::span(plan).first(1), near_end, StandardMachine().axes).complete);
  const StopOnPath stop = StopAlong(plan, near_end, StandardMachine().axes);
  EXPECT_TRUE(stop.complete);
  EXPECT_EQ(stop.index, 1u);
  EXPECT_NEAR(stop.s, kRamp_mm - 1.0, 1e-9);
  ASSERT_EQ(stop.motions.size(), 2u);
  EXPECT_TRUE(stop.motions[0].ends_move);
  EXPECT_FALSE(stop.motions[1].ends_move);
  EXPECT_EQ(stop.motions[0].tag, 7u);
  EXPECT_EQ(stop.motions[1].tag, 8u);
  // At the very end of the first move nothing of it is left.
  const StopOnPath behind = StopAlong(plan, plan[0].speed.duration_s(), StandardMachine().axes);
  EXPECT_EQ(behind.index, 1u);
  ASSERT_EQ(behind.motions.size(), 1u);
  EXPECT_EQ(behind.motions[0].tag, 8u);
  EXPECT_NEAR(behind.s, kRamp_mm, 1e-9);
  const double far = plan[0].speed.TimeAt(100.0 - kRamp_mm - 0.1);
  EXPECT_TRUE(StopAlong(std::span(plan).first(1), far, StandardMachine().axes).complete);
}

// From 125 mm/s with 1000 mm/s2 it is 7.8125 mm to rest, and so long is the move: the one behind
// it, which would brake more gently, is not touched.
TEST(StopAlong, RestsAtTheVeryEndOfAMove) {
  MachineLimits machine = StandardMachine();
  machine.tip_jerk_mm_s3 = kNoLimit;
  machine.axes.jerk.setConstant(kNoLimit);
  std::vector<MoveCommand> chain(3);
  const double ends[4] = {0.0, 100.0, 107.8125, 300.0};
  for (std::size_t k = 0; k < 3; ++k) {
    chain[k].path = PathPiece::Line({{ends[k], 0, 0}}, {{ends[k + 1], 0, 0}});
    chain[k].speed_fraction = 0.25;
    chain[k].acceleration_fraction = k < 2 ? 0.5 : 0.25;
    chain[k].fly = k < 2;
    chain[k].tag = k;
  }
  const std::vector<PlannedMotion> plan = Plan(chain, machine);
  ASSERT_EQ(plan.size(), 3u);
  for (const std::size_t known : {1u, 2u}) {  // as far as it is planned
    const StopOnPath stop = StopAlong(std::span(plan).subspan(1, known), 0.0, machine.axes);
    EXPECT_TRUE(stop.complete);
    EXPECT_EQ(stop.index, 0u);
    EXPECT_EQ(stop.s, 7.8125);
    ASSERT_EQ(stop.motions.size(), 1u);
    EXPECT_EQ(stop.motions[0].tag, 1u);
    EXPECT_EQ(stop.motions[0].path.length(), 7.8125);
    EXPECT_TRUE(stop.motions[0].ends_move);
    EXPECT_EQ(stop.motions[0].speed.end().speed, 0.0);
    EXPECT_NEAR(stop.motions[0].duration_s(), 0.125, 1e-12);
  }
}

}  // namespace
}  // namespace rmlcell::motion
