// What a motion keeps of the move that it belongs to, and what it does not keep
// of the one before it: speeds at the begin, angles in the middle of a bend,
// settling, peaks. motion.md 4, 5, 6
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/motion/profile/speed_passes.h"
#include "engine/motion/ride/interruption.h"
#include "engine/motion/ride/path_ride.h"
#include "engine/motion/ride/trajectory.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::kept_values {
namespace {

constexpr PathLimits kUsual{350.0, 2000.0, 40000.0};

MoveCommand LineMove(const TipPose& from, const TipPose& to, double speed = 0.1) {
  MoveCommand move;
  move.path = PathPiece::Line(from, to);
  move.speed_fraction = speed;
  move.fly = true;
  return move;
}

std::vector<MoveCommand> Square(double a_rad, double b_rad, double speed = 0.1) {
  return {LineMove({{0, 0, 0}, a_rad, b_rad}, {{50, 0, 0}, a_rad, b_rad}, speed),
          LineMove({{50, 0, 0}, a_rad, b_rad}, {{50, 50, 0}, a_rad, b_rad}, speed)};
}

bool Bends(const PlannedMotion& motion) { return motion.path.kind() == PathPiece::Kind::kBlend; }

// The halves of a bend meet where the curve is half way, with the angles that
// the head has there.
TEST(KeptValues, AHalfOfABendEndsOnItsCurve) {
  std::vector<std::vector<MoveCommand>> chains{Square(0.7, -0.4)};
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    chains.push_back(RandomChain(seed, 8, {.all_fly = true, .shortest_mm = 1.0}));
  int bends = 0;
  for (const std::vector<MoveCommand>& chain : chains) {
    for (const PlannedMotion& motion : Plan(chain)) {
      if (!Bends(motion)) continue;
      ++bends;
      const PathPiece& path = motion.path;
      const PathPose before = path.At(path.length() * (1.0 - 1e-9));
      const PathPose behind = path.At(path.length() * 1e-9);
      ASSERT_NEAR((before.point - path.to().point).norm(), 0.0, 1e-6);
      ASSERT_NEAR(before.a_rad, path.to().a_rad, 1e-6);
      ASSERT_NEAR(before.b_rad, path.to().b_rad, 1e-6);
      ASSERT_NEAR((behind.point - path.from().point).norm(), 0.0, 1e-6);
      ASSERT_NEAR(behind.a_rad, path.from().a_rad, 1e-6);
      ASSERT_NEAR(behind.b_rad, path.from().b_rad, 1e-6);
    }
  }
  EXPECT_GT(bends, 100);
}

// One stop settles, and nothing behind it does before the next one.
TEST(KeptValues, OnlyAStopSettles) {
  std::vector<MoveCommand> chain;
  for (int k = 0; k < 12; ++k) {
    const double x = 50.0 * (k / 2 + k % 2), y = 50.0 * (k / 2);
    chain.push_back(
        LineMove({{x, y, 0}}, {{x + (k % 2 == 0 ? 50.0 : 0.0), y + 50.0 * (k % 2), 0}}));
    chain.back().fly = k % 3 != 0;
  }
  for (const PlannedMotion& motion : Plan(chain)) {
    const bool stands = motion.ends_move && motion.corner.passage == Passage::kStop;
    EXPECT_EQ(motion.settling_s, stands ? 0.048 : 0.0) << motion.tag;
  }
}

// A chain that begins on the way is as fast at its first knot as at its begin.
TEST(KeptValues, TheBeginOfAChainOnTheWayIsNoRest) {
  std::vector<MoveCommand> chain{LineMove({{0, 0, 0}}, {{0.5, 0, 0}}),
                                 LineMove({{0.5, 0, 0}}, {{100, 0, 0}})};
  chain[1].acceleration_fraction = 0.9;  // else they are one
  for (const bool across : {true, false}) {
    MachineLimits machine = StandardMachine();
    machine.ramps_across_passages = across;
    Planner planner(machine);
    planner.BeginMoving(50.0);
    for (const MoveCommand& move : chain) ASSERT_TRUE(planner.Append(move));
    planner.Stop();
    const auto first = std::get<PlannedMotion>(*planner.Next());
    EXPECT_NEAR(first.speed.end().speed, 50.0, 1e-9) << across;
    EXPECT_NEAR(first.speed.duration_s(), 0.5 / 50.0, 1e-12) << across;
  }
}

// What is wanted at a passage is what can be reached there: (1 sqrt(j))^(2/3)
// after 1 mm.
TEST(KeptValues, WantedIsWhatCanBeReached) {
  std::vector<MoveCommand> chain{LineMove({{0, 0, 0}}, {{1, 0, 0}}, 0.5),
                                 LineMove({{1, 0, 0}}, {{200, 0, 0}}, 0.5)};
  chain[1].acceleration_fraction = 0.9;
  const std::vector<PlannedMotion> plan = Plan(chain);
  ASSERT_EQ(plan[0].corner.passage, Passage::kThrough);
  EXPECT_NEAR(plan[0].corner.wanted_speed, std::pow(std::sqrt(40000.0), 2.0 / 3.0), 1e-9);
}

// Level 1 brings the acceleration to zero at each knot. motion.md 5.3
TEST(KeptValues, LevelOneHasNoRampsAcrossKnots) {
  std::vector<MoveCommand> chain{LineMove({{0, 0, 0}}, {{100, 0, 0}}),
                                 LineMove({{100, 0, 0}}, {{100.5, 0, 0}})};
  chain[1].acceleration_fraction = 0.9;
  MachineLimits machine = StandardMachine();
  ASSERT_NE(Plan(chain, machine)[0].speed.end().acceleration, 0.0);
  machine.ramps_across_passages = false;
  const std::vector<PlannedMotion> plan = Plan(chain, machine);
  ASSERT_EQ(plan.size(), 2U);
  EXPECT_EQ(plan[0].speed.end().acceleration, 0.0);
  EXPECT_NEAR(plan[0].speed.end().speed, Reach(0.0, 0.5, plan[1].limits), 1e-9);
}

// A START within a bend that is passed steadily is no faster than that.
TEST(KeptValues, AStartWithinABendKeepsItsSpeed) {
  std::vector<MoveCommand> chain = Square(0.0, 0.0);
  chain[0].overshoot_fraction = 0.5;
  for (const bool across : {true, false}) {
    MachineLimits machine = StandardMachine();
    machine.ramps_across_passages = across;
    const std::vector<PlannedMotion> plan = Plan(chain, machine);
    ASSERT_EQ(plan.size(), 4U);
    ASSERT_TRUE(Bends(plan[1]));
    const double steady = plan[1].speed.peak_speed();
    ASSERT_NEAR(steady, 25.0, 1e-6);
    EXPECT_NEAR(plan[1].limits.speed, steady, 1e-6);
    const auto rest = RestartAlong(std::span(plan).subspan(1), 0.01, machine.axes);
    EXPECT_LE(rest[0].speed.peak_speed(), steady * (1.0 + 1e-9));
  }
}

// A move that goes nowhere says where the machine is, as long as no other did.
TEST(KeptValues, AMoveToNowhereIsWhereTheNextBegins) {
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineMove({{5, 0, 0}}, {{5, 0, 0}})));
  ASSERT_TRUE(planner.Append(LineMove({{5.0005, 0, 0}}, {{10, 0, 0}})));
  planner.Stop();
  EXPECT_EQ(std::get<PlannedMotion>(*planner.Next()).path.from().point.x(), 5.0);
}

// A head that jumps in A or in B alone is no passage: the machine stands.
TEST(KeptValues, AJumpOfOneAngleIsAStop) {
  for (const bool of_a : {true, false}) {
    const double a = of_a ? 0.2 : 0.0, b = of_a ? 0.0 : 0.2;
    const std::vector<PlannedMotion> plan = Plan(
        {LineMove({{0, 0, 0}}, {{50, 0, 0}}), LineMove({{50, 0, 0}, a, b}, {{50, 50, 0}, a, b})});
    ASSERT_EQ(plan.size(), 2U) << of_a;
    EXPECT_EQ(plan[0].speed.end().speed, 0.0) << of_a;
  }
}

// On the bend between two slants X alone moves, or is pushed: no faster and no
// harder than it can. motion.md 4.3
TEST(KeptValues, ABendKeepsTheWeakAxis) {
  const std::vector<MoveCommand> chain{LineMove({{0, 0, 0}}, {{50, 50, 0}}, 0.2),
                                       LineMove({{50, 50, 0}}, {{100, 0, 0}}, 0.2)};
  MachineLimits slow = StandardMachine(), weak = StandardMachine();
  slow.axes.speed[0] = 30.0;
  weak.axes.acceleration[1] = 300.0;
  for (const MachineLimits& machine : {slow, weak}) {
    double fastest = 0.0, hardest = 0.0;
    for (const PlannedMotion& motion : Plan(chain, machine)) {
      const MotionView view(motion);
      for (int k = 0; k <= 200; ++k) {
        const TrajectoryPoint at = view.At(motion.speed.duration_s() * k / 200.0);
        fastest = std::max(fastest, std::abs(at.axis_velocity[0]));
        hardest = std::max(hardest, std::abs(at.axis_acceleration[1]));
      }
    }
    EXPECT_LE(fastest, machine.axes.speed[0] * (1.0 + 1e-6));
    EXPECT_LE(hardest, machine.axes.acceleration[1] * (1.0 + 1e-3));
  }
}

// What X is slower by than the bend wants is told, and what differs by last digits alone is not:
// both slants are at 100 mm/s, of which X has all in the middle of the bend.
TEST(KeptValues, ABendOfLastDigitsIsNotCapped) {
  const std::vector<MoveCommand> chain{LineMove({{0, 0, 0}}, {{50, 50, 0}}, 0.2),
                                       LineMove({{50, 50, 0}}, {{100, 0, 0}}, 0.2)};
  for (const double less : {0.0, 1e-7}) {
    MachineLimits machine = StandardMachine();
    machine.axes.speed[0] = 100.0 * (1.0 - less);
    const std::vector<PlannedMotion> plan = Plan(chain, machine);
    const auto first =
        std::ranges::find_if(plan, [](const PlannedMotion& motion) { return motion.ends_move; });
    ASSERT_TRUE(first != plan.end());
    ASSERT_TRUE(Bends(*first)) << less;
    EXPECT_EQ(first->corner.passage, less == 0.0 ? Passage::kBlend : Passage::kBlendCapped) << less;
  }
}

// A corner of the axes that had to be lowered is still passed steadily, the
// head turning or not. motion.md 4.5
TEST(KeptValues, ACornerOfTheAxesIsPassedSteadily) {
  for (const double turn : {0.0, 0.3}) {
    std::vector<MoveCommand> chain(3);
    const std::vector<AxisPose> at{{{0, 0, 0}}, {{8, 0, 0}, turn, 0.0}, {{8, 8, 0}}, {{16, 8, 0}}};
    for (std::size_t k = 0; k < 3; ++k) {
      chain[k].kind = MoveCommand::Kind::kPointToPointAxes;
      chain[k].path = PathPiece::Joint(at[k], at[k + 1]);
      chain[k].fly = true;
    }
    int bends = 0;
    for (const PlannedMotion& motion : Plan(chain)) {
      if (!Bends(motion)) continue;
      ++bends;
      EXPECT_EQ(motion.speed.phase_count(), 1) << turn;
      EXPECT_EQ(motion.speed.phase(0).jerk, 0.0) << turn;
    }
    EXPECT_GE(bends, 2) << turn;
  }
}

// A machine that would need more way than the plan has left brakes as the plan
// does, and settles no more than after any STOP.
TEST(KeptValues, APlanThatComesToRestByItselfDoesNotSettle) {
  std::vector<PlannedMotion> plan = Plan({LineMove({{0, 0, 0}}, {{100, 0, 0}})});
  ASSERT_EQ(plan.size(), 1U);
  ASSERT_EQ(plan[0].settling_s, 0.048);
  plan[0].limits.acceleration = 20.0;
  plan[0].limits.jerk = 400.0;
  const StopOnPath stop = StopAlong(plan, plan[0].speed.TimeAt(95.0), StandardMachine().axes);
  ASSERT_TRUE(stop.complete);
  EXPECT_EQ(stop.s, 100.0);
  ASSERT_EQ(stop.motions.size(), 1U);
  EXPECT_EQ(stop.motions[0].settling_s, 0.0);
  EXPECT_NEAR(stop.motions[0].path.length(), 5.0, 1e-9);
}

// Where the head turns about it the tip stands, though its ends differ by half
// of what is a length; positioned it moves.
TEST(KeptValues, ATurnAboutTheTipDoesNotMoveIt) {
  MotionUnderWay under_way;
  under_way.motion = Plan({LineMove({{5e-7, 0, 0}, 0.0, 0.0}, {{0, 0, 0}, 1.0, 0.5})})[0];
  ASSERT_EQ(under_way.motion.path.kind(), PathPiece::Kind::kRotary);
  under_way.Begin(SimTime{0});
  EXPECT_EQ(under_way.TipSpeedAt(under_way.arrival / 2), 0.0);
  MoveCommand there = LineMove({{0, 0, 0}, 0.1, 0.2}, {{90, 0, 0}, 0.2, 0.1});
  there.kind = MoveCommand::Kind::kPointToPointAxes;
  there.path = PathPiece::Joint({{0, 0, 0}, 0.1, 0.2}, {{90, 0, 0}, 0.1, 0.2});
  under_way.motion = Plan({there})[0];
  under_way.Begin(SimTime{0});
  EXPECT_GT(under_way.TipSpeedAt(under_way.arrival / 2), 40.0);
}

// Only what is planned in the axes is measured by them.
TEST(KeptValues, ATipUnderWayIsNotMeasuredInAxes) {
  PathRide ride(HoldRamp::kStays);
  ride.Plan(Plan({LineMove({{0, 0, 0}}, {{100, 0, 0}})})[0]);
  const double length = ride.Begin(SimTime{0}).motion.path.length();
  ride.MeasureInAxesBy(2.0);
  EXPECT_EQ(ride.under_way()->motion.path.length(), length);
  EXPECT_EQ(ride.under_way()->motion.speed.end().s, length);
}

// Part of an arc sweeps its part of the angle.
TEST(KeptValues, APartOfAnArcSweepsItsPart) {
  const PathPiece arc = PathPiece::Circle({{20, 0, 0}}, {0, 0, 0}, {0, 0, 1}, 3.0, 0.0, 0.0);
  EXPECT_NEAR(arc.Part(10.0, 40.0).sweep_rad(), 1.5, 1e-12);
  EXPECT_NEAR(arc.Part(0.0, 5.0).sweep_rad(), 0.25, 1e-12);
}

// What slows down is fastest where it begins.
TEST(KeptValues, APeakAtTheBeginIsThePeak) {
  EXPECT_EQ(
      SpeedProfile::From({0.0, 50.0, -500.0}, 200.0, 0.0, {20.0, 2000.0, 40000.0}).peak_speed(),
      50.0);
  const SpeedProfile whole = SpeedProfile::Span(100.0, 0.0, 0.0, kUsual);
  for (const double from : {70.0, 90.0, 99.0}) {
    const double there = whole.At(whole.TimeAt(from)).speed;
    EXPECT_NEAR(whole.Part(from, 100.0).peak_speed(), there, 1e-9) << from;
  }
}

// A knot that is accepted at rest ends the chain at rest.
TEST(KeptValues, WhatIsAcceptedIsTheEnd) {
  SpeedPasses passes;
  passes.Push(10.0, kUsual, 50.0);
  passes.Settle();
  ASSERT_FALSE(passes.ends_at_rest());
  passes.Accept(1);
  EXPECT_EQ(passes.speed(), 0.0);
  EXPECT_TRUE(passes.ends_at_rest());
}

}  // namespace
}  // namespace rmlcell::motion::kept_values
