// The planner's stages one figure at a time: what is forgotten at a stop, what
// the window counts, how parts of one profile are given out, and passages of a
// mill. motion.md 3.1, 5.3, 5.5, 7
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/core/units.h"
#include "engine/motion/planner/feed_steps.h"
#include "engine/motion/planner/motion_chain.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::planner_values {
namespace {

MoveCommand Straight(const TipPose& from, const TipPose& to, bool fly, double speed = 0.1) {
  MoveCommand move;
  move.path = PathPiece::Line(from, to);
  move.speed_fraction = speed;
  move.fly = fly;
  return move;
}

std::vector<PlannedMotion> Rest(Planner& planner) {
  std::vector<PlannedMotion> motions;
  while (const auto item = planner.Next()) motions.push_back(std::get<PlannedMotion>(*item));
  return motions;
}

// A move that goes nowhere without /FLY is a stop of the move before it, which
// a stop by the program ends: the corners behind that are blended again.
// OPT-2.47
TEST(PlannerValues, AStopIsForgottenBehindIt) {
  for (const bool nothing : {true, false}) {
    Planner planner(StandardMachine());
    ASSERT_TRUE(planner.Append(Straight({}, {{50, 0, 0}}, true)));
    if (nothing) {
      ASSERT_TRUE(planner.Append(Straight({{50, 0, 0}}, {{50, 0, 0}}, false)));
    }
    planner.Stop();
    ASSERT_TRUE(planner.Append(Straight({{50, 0, 0}}, {{100, 0, 0}}, true)));
    ASSERT_TRUE(planner.Append(Straight({{100, 0, 0}}, {{100, 50, 0}}, false)));
    int bends = 0;
    for (const PlannedMotion& motion : Rest(planner))
      bends += motion.path.kind() == PathPiece::Kind::kBlend ? 1 : 0;
    EXPECT_EQ(bends, 2) << nothing;
  }
}

// Of 200 long lines each is decided soon: a window of 64 is never full, however
// many came before.
TEST(PlannerValues, TheWindowHoldsWhatIsOpen) {
  Planner planner(StandardMachine(), 64);
  MachinePoint at{0.0, 0.0, 0.0};
  for (int k = 0; k < 200; ++k) {
    const MachinePoint to =
        at + MachineVector{k % 2 == 0 ? 100.0 : 0.0, k % 2 == 0 ? 0.0 : 100.0, 0.0};
    ASSERT_TRUE(planner.Append(Straight({at}, {to}, true)));
    at = to;
    Rest(planner);
  }
  EXPECT_EQ(planner.lookahead_starved(), 0U);
}

// One profile given out in parts: a first one of exactly 1 mm is none of the
// rest.
TEST(PlannerValues, PartsOfOneProfileAreItsParts) {
  for (const double first : {0.5, 1.0, 2.0}) {
    Planner planner(StandardMachine());
    ASSERT_TRUE(planner.Append(Straight({}, {{first, 0, 0}}, true)));
    ASSERT_TRUE(planner.Append(Straight({{first, 0, 0}}, {{6, 0, 0}}, false)));
    const std::vector<PlannedMotion> motions = Rest(planner);
    ASSERT_EQ(motions.size(), 2U);
    const SpeedProfile whole = SpeedProfile::Span(6.0, 0.0, 0.0, {50.0, 2000.0, 40000.0});
    EXPECT_NEAR(motions[0].speed.duration_s(), whole.TimeAt(first), 1e-9);
    EXPECT_NEAR(motions[1].speed.duration_s(), whole.duration_s() - whole.TimeAt(first), 1e-9);
    EXPECT_NEAR(motions[1].speed.end().s, 6.0 - first, 1e-12);
  }
}

// At 40 mm/s a right angle of trapezoids takes d = K w^2 / a_n = 2.7490 mm of
// both sides, for which twice that must be known behind it: 5.498 mm.
// motion.md 4.2
TEST(PlannerValues, ACornerWaitsForTwiceItsCut) {
  MachineLimits machine;
  machine.tip_speed_mm_s = 100.0;
  machine.tip_acceleration_mm_s2 = 1000.0;
  machine.tip_jerk_mm_s3 = HUGE_VAL;
  machine.axes.speed.fill(1e6);
  machine.axes.acceleration.fill(1e6);
  machine.axes.jerk.fill(HUGE_VAL);
  for (const double behind : {5.49, 5.51}) {
    SpanStage spans(machine, Planner::kWindow);
    LegStage& legs = spans.leg_stage();
    for (const MoveCommand& move :
         {Straight({}, {{10, 0, 0}}, true, 0.4), Straight({{10, 0, 0}}, {{10, 5, 0}}, true, 0.4),
          Straight({{10, 5, 0}}, {{10, behind, 0}}, true, 0.5)})
      legs.Add(move, legs.LimitsFor(move), true);
    legs.Settle();
    ASSERT_TRUE(legs.knows_speed_of(0));
    EXPECT_EQ(spans.Resolve(false), behind > 5.498);
    if (behind < 5.498) continue;
    EXPECT_THAT(spans.Dump(), testing::HasSubstr("cut 2.749, curve 4.524"));
  }
}

// The text of a bend that takes 1 mm of both sides: 1.6457 mm in six stretches. The axes follow
// what is just all that they have, too.
TEST(PlannerValues, ABendIsToldInFull) {
  for (const double across : {0.8, 1.0}) {
    MachineLimits machine = StandardMachine();
    machine.tip_jerk_mm_s3 = HUGE_VAL;
    machine.curve_normal = across;
    MotionChain chain(machine, Planner::kWindow);
    for (const MoveCommand& move :
         {Straight({}, {{10, 0, 0}}, true, 1.0), Straight({{10, 0, 0}}, {{10, 2, 0}}, false, 1.0)})
      chain.Append(move, chain.LimitsFor(move), true);
    EXPECT_THAT(chain.Dump(),
                testing::HasSubstr(", cut 1.000, curve 1.646 in 6 stretches, passed at "))
        << across;
  }
}

// What goes nowhere stands where it says, be it half a micrometre beside the end of the move
// before: the way there is made, in COORD ROBOT, too. OPT-2.02
TEST(PlannerValues, WhatGoesNowhereStandsWhereItSays) {
  Planner planner(StandardMachine());
  const AxisPose at{{10, 0, 0}, 0.0, 0.0}, beside{{10.0005, 0, 0}, 0.0, 0.0};
  for (const PathPiece& path : {PathPiece::Joint({}, at), PathPiece::Joint(beside, beside)}) {
    MoveCommand move;
    move.kind = MoveCommand::Kind::kPointToPointAxes;
    move.path = path;
    ASSERT_TRUE(planner.Append(move));
  }
  planner.Stop();
  const std::vector<PlannedMotion> motions = Rest(planner);
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_EQ(motions[1].path.from().point.x(), 10.0);
  EXPECT_EQ(motions[1].path.to().point.x(), 10.0005);
}

// Where steps are wider than 1 mm/s they are counted by their width.
TEST(PlannerValues, FeedsHaveStepsOfAnyWidth) {
  const FeedSteps steps{.minimum_mm_s = 0.5, .maximum_mm_s = 40.0, .coarse_step_mm_s = 1.5};
  EXPECT_EQ(steps.Nearest(7.0), 6.0);
  EXPECT_EQ(steps.Nearest(7.5), 7.5);
  const FeedSteps wide{.minimum_mm_s = 0.5, .maximum_mm_s = 40.0, .coarse_step_mm_s = 4.0};
  EXPECT_EQ(wide.Nearest(7.9), 4.0);
  EXPECT_EQ(wide.Nearest(13.0), 12.0);
}

MachineLimits MillOfTest() {
  MachineLimits mill;
  mill.tip_speed_mm_s = 60.0;
  mill.tip_acceleration_mm_s2 = 200.0;
  mill.tip_jerk_mm_s3 = HUGE_VAL;
  mill.settling_s = 0.0;
  mill.corners = MachineLimits::Corners::kThrough;
  mill.junction_jump_mm_s = 3.0;
  mill.junction_jump_a_rad_s = 0.5;
  return mill;
}

double SpeedBetween(const PathPiece& first, const PathPiece& second) {
  Planner planner(MillOfTest());
  for (const PathPiece& path : {first, second}) {
    MoveCommand move;
    move.path = path;
    move.head = MillHead{};
    move.limits = PathLimits{.speed = 20.0, .acceleration = 200.0};
    move.fly = true;
    EXPECT_TRUE(planner.Append(move));
  }
  planner.Stop();
  return Rest(planner).front().speed.end().speed;
}

// A rotary axis that goes on as it does is no bound; one that turns back jumps
// by twice its rate.
TEST(PlannerValues, AMillLooksAtTheChangeOfTheTurn) {
  const PathPiece in = PathPiece::Line({{0, 0, 0}, 0.0, 0.0}, {{10, 0, 0}, 0.5, 0.0});
  EXPECT_EQ(SpeedBetween(in, PathPiece::Line({{10, 0, 0}, 0.5, 0.0}, {{20, 0, 0}, 1.0, 0.0})),
            20.0);
  EXPECT_NEAR(SpeedBetween(in, PathPiece::Line({{10, 0, 0}, 0.5, 0.0}, {{20, 0, 0}, 0.0, 0.0})),
              5.0, 1e-9);
}

// Into an arc and out of one the passage is as fast as their directions there
// allow.
TEST(PlannerValues, AMillLooksAtTheDirectionsWhereTheyMeet) {
  const PathPiece line = PathPiece::Line({{0, 0, 0}}, {{10, 0, 0}});
  const PathPiece arc = PathPiece::Circle({{10, 0, 0}}, {10, 8, 0}, {0, 0, 1}, kPi / 2.0, 0.0, 0.0);
  EXPECT_EQ(SpeedBetween(line, arc), 20.0);
  EXPECT_EQ(SpeedBetween(arc, PathPiece::Line(arc.tip_to(), {{18, 20, 0}})), 20.0);
  // X takes up the whole speed there: 3 mm/s.
  EXPECT_NEAR(SpeedBetween(arc, PathPiece::Line(arc.tip_to(), {{30, 8, 0}})), 3.0, 1e-9);
}

// A bend of a turning head that varies for want of room leaves the axes a tenth
// for its ramps: of each at most 1 - 0.95^2 of its acceleration, by as much as
// it moves for a mm of the way.
TEST(PlannerValues, BendsThatVaryLeaveATenthToTheirRamps) {
  for (std::size_t weak = 0; weak < kAxisCount; ++weak) {
    MachineLimits machine = StandardMachine();
    machine.axes.acceleration[weak] *= 0.2;
    int varied = 0;
    Dice dice(7 + weak);
    std::vector<MoveCommand> chain;
    TipPose at{{1000.0, 900.0, -200.0}, 0.3, 0.4};
    MachineVector heading{1.0, 0.0, 0.0};
    for (int k = 0; k < 60; ++k) {
      heading = heading + dice.Direction() * 0.7;
      heading = heading * (1.0 / heading.norm());
      const TipPose to{at.tip + heading * dice.Uniform(1.0, 12.0),
                       at.a_rad + dice.Uniform(-0.25, 0.25), at.b_rad + dice.Uniform(-0.25, 0.25)};
      chain.push_back(Straight(at, to, true, 1.0));
      at = to;
    }
    for (const PlannedMotion& motion : Plan(chain, machine, 8)) {
      const bool bend = motion.path.kind() == PathPiece::Kind::kBlend;
      if (!bend || motion.speed.end().speed == motion.speed.At(0.0).speed) continue;
      ++varied;
      for (std::size_t i = 0; i < kAxisCount; ++i) {
        const double per_mm = 0.95 * machine.axes.speed[i] / motion.limits.speed;
        EXPECT_LE(motion.limits.acceleration * per_mm,
                  (1.0 - 0.95 * 0.95) * machine.axes.acceleration[i] * (1.0 + 1e-9));
      }
    }
    EXPECT_GT(varied, 5) << weak;
  }
}

std::vector<MoveCommand> JointChain(int count, double acceleration, double longest_mm) {
  Dice dice(19);
  std::vector<MoveCommand> chain;
  AxisPose at{{1000.0, 900.0, -200.0}, 0.1, 0.2};
  for (int k = 0; k < count; ++k) {
    AxisPose to = at;
    to.column += dice.Direction() * dice.Uniform(0.5 * longest_mm, longest_mm);
    to.b_rad = dice.Uniform(-0.5, 0.5);
    MoveCommand move;
    move.kind = MoveCommand::Kind::kPointToPointAxes;
    move.path = PathPiece::Joint(at, to);
    move.acceleration_fraction = acceleration;
    move.fly = k + 1 < count;
    move.tag = static_cast<std::uint64_t>(k);
    chain.push_back(move);
    at = to;
  }
  return chain;
}

// Bends of the axes are passed steadily, however short the ways between them are, and no ACCEL is
// more than all. motion.md 4.5
TEST(PlannerValues, BendsOfTheAxesAreSteady) {
  const std::vector<PlannedMotion> motions = Plan(JointChain(12, 1.0, 5.0));
  const std::vector<PlannedMotion> eager = Plan(JointChain(12, 1.5, 5.0));
  ASSERT_EQ(motions.size(), eager.size());
  int bends = 0;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    EXPECT_NEAR(eager[k].duration_s(), motions[k].duration_s(), 1e-12) << k;
    if (motions[k].path.kind() != PathPiece::Kind::kBlend) continue;
    ++bends;
    EXPECT_EQ(motions[k].speed.phase_count(), 1) << k;
    EXPECT_EQ(motions[k].speed.peak_speed(), motions[k].speed.end().speed) << k;
    EXPECT_EQ(motions[k].restart_speed, kLargest) << k;
  }
  EXPECT_GT(bends, 10);
}

// What is told as deviation is how near the tip comes to the target on the curve, and no nearer.
TEST(PlannerValues, BendsOfTheAxesTellHowNearTheyCome) {
  int bends = 0;
  const std::vector<PlannedMotion> motions = Plan(JointChain(12, 1.0, 300.0));
  for (std::size_t k = 0; k + 1 < motions.size(); ++k) {
    const PlannedMotion& motion = motions[k];
    if (!motion.ends_move || motion.path.kind() != PathPiece::Kind::kBlend) continue;
    const MoveCommand move = JointChain(12, 1.0, 300.0)[motion.tag];
    const MachinePoint target = move.head.TipOf(move.path.axes_to()).tip;
    double nearest = HUGE_VAL;
    for (const PathPiece& half : {motion.path, motions[k + 1].path}) {
      for (int place = 0; place <= 400; ++place) {
        const PathPose pose = half.At(half.length() * place / 400.0);
        nearest = std::min(nearest, (move.head.TipOf(half.AxesOf(pose)).tip - target).norm());
      }
    }
    ++bends;
    EXPECT_LE(motion.corner.deviation_mm, nearest + 1e-9) << k;
    EXPECT_GE(motion.corner.deviation_mm, nearest - 0.01 * nearest) << k;
  }
  EXPECT_GT(bends, 5);
}

// Curves of the axes take long, and are worked out on the way, too.
TEST(PlannerValues, CurvesOfTheAxesAreWorkedOutOnTheWay) {
  MotionChain chain(StandardMachine(), Planner::kWindow);
  for (MoveCommand move : JointChain(12, 1.0, 300.0)) {
    move.fly = true;
    chain.Append(move, chain.LimitsFor(move), true);
    const std::string text = chain.Dump();
    std::size_t waiting = 0;
    for (std::size_t at = text.find("leg "); at != std::string::npos;
         at = text.find("leg ", at + 1))
      ++waiting;
    EXPECT_LE(waiting, 2U) << text;
  }
}

// Short steps behind a hundred stops are as fast as those of a planner that knows nothing else,
// also where a section holds but half of a small window.
TEST(PlannerValues, WhatWasBeforeAStopIsForgotten) {
  const auto time_of_steps = [](Planner& planner, const MachinePoint& begin) {
    MachinePoint at = begin;
    for (int k = 0; k < 30; ++k) {
      const MachinePoint to = at + MachineVector{0.3, 0.0, 0.0};
      EXPECT_TRUE(planner.Append(Straight({at}, {to}, k < 29, k % 2 == 0 ? 0.9 : 1.0)));
      at = to;
    }
    double time = 0.0;
    for (const PlannedMotion& motion : Rest(planner)) time += motion.duration_s();
    return time;
  };
  Planner fresh(StandardMachine(), 64), used(StandardMachine(), 64);
  const double time = time_of_steps(fresh, {100.0, 0.0, 0.0});
  for (int k = 0; k < 100; ++k)
    ASSERT_TRUE(used.Append(Straight({{1.0 * k, 0, 0}}, {{k + 1.0, 0, 0}}, false)));
  Rest(used);
  EXPECT_NEAR(time_of_steps(used, {100.0, 0.0, 0.0}), time, 1e-12);
}

// An arc of half a millimetre that begins half a micrometre beside the end before it stays an arc.
TEST(PlannerValues, AShortArcStaysAnArc) {
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(Straight({}, {{10, 0, 0}}, false)));
  MoveCommand arc;
  arc.path = PathPiece::Circle({{10.0005, 0, 0}}, {10.0005, 0.5, 0}, {0, 0, 1}, 1.0, 0.0, 0.0);
  ASSERT_TRUE(planner.Append(arc));
  planner.Stop();
  const std::vector<PlannedMotion> motions = Rest(planner);
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_EQ(motions[1].path.kind(), PathPiece::Kind::kArc);
}

// Each mark that waits is told.
TEST(PlannerValues, MarksThatWaitAreTold) {
  MotionChain chain(StandardMachine(), Planner::kWindow);
  for (const std::uint64_t tag : {21U, 22U, 23U}) {
    const double x = 10.0 * static_cast<double>(tag);
    const MoveCommand move = Straight({{x, 0, 0}}, {{x + 10.0, 0, 0}}, true);
    chain.Append(move, chain.LimitsFor(move), true);
    chain.Mark(tag);
  }
  EXPECT_THAT(chain.Dump(), testing::HasSubstr("mark 21: waits for move 0\n"
                                               "mark 22: waits for move 1\n"
                                               "mark 23: waits for move 2\n"));
}

// A planner that takes over another one goes on as that would have.
TEST(PlannerValues, APlannerIsAssigned) {
  Planner from(StandardMachine()), to(StandardMachine());
  ASSERT_TRUE(from.Append(Straight({}, {{50, 0, 0}}, true)));
  ASSERT_TRUE(to.Append(Straight({}, {{7, 0, 0}}, true)));
  to = from;
  ASSERT_TRUE(to.Append(Straight({{50, 0, 0}}, {{50, 30, 0}}, false)));
  const std::vector<PlannedMotion> motions = Rest(to);
  ASSERT_EQ(motions.size(), 4U);
  EXPECT_EQ(motions.back().path.to().point, MachinePoint(50, 30, 0));
  from.Stop();
  EXPECT_EQ(Rest(from).size(), 1U);
}

}  // namespace
}  // namespace rmlcell::motion::planner_values
