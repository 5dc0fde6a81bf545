#include "engine/motion/kinematics/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "engine/core/units.h"
#include "engine/motion/geometry/frames.h"
#include "tests/engine/motion/expect_near.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

// Along the outward radial of sample 2's cylinder. OPT-B.03
TEST(ToolAxes, PointAlongTheRadial) {
  ExpectNear(ToolDirection(0.528, 1.5708), {0.503807, -0.863816, -0.000004}, 1e-6);
  ExpectNear(ToolDirection(0.0, kPi / 2), {0, -1, 0});
  ExpectNear(ToolDirection(kPi / 2, kPi / 2), {1, 0, 0});
  ExpectNear(ToolDirection(1.0, 0.0), {0, 0, 1});
}

// OPT-2.06, OPT-2.07, OPT-B.04, OPT-B.05
TEST(Head, PutsTheColumnBehindTheTip) {
  GantryHead tool;
  Head head = tool;
  ExpectNear(head.ColumnOf({{100, 100, -400}, 0, kPi / 2}).column, {100, -200, -400});
  ExpectNear(head.TipOf({{100, 100, -400}, 0, 0}).tip, {100, 100, -700});
  tool.tool.z_mm = 3.0;
  head = tool;
  ExpectNear(head.TipOf({{100, -200, -400}, 0, kPi / 2}).tip, {100, 97, -400});
}

// motion.md section 10, property 13.
TEST(Head, ForwardAndInverseCancel) {
  const Head head = GantryHead{.length_mm = 287.0, .tool = {1.5, -2.5, 4.0}};
  for (double a = -12.0; a < 12.0; a += 1.37) {
    for (double b = -2.4; b < 2.4; b += 0.31) {
      const TipPose pose{{120.0, -77.0, 310.0}, a, b};
      ExpectNear(head.TipOf(head.ColumnOf(pose)).tip, pose.tip);
    }
  }
}

// motion.md 2.4 against differences of positions.
TEST(Head, RatesAreDerivatives) {
  const Head head = GantryHead{.length_mm = 287.0, .tool = {1.5, -2.5, 4.0}};
  const auto at = [&](double t) {
    return head.ColumnOf({{3.0 * t, t * t, -t}, 0.4 + 0.5 * t, -0.8 + 0.3 * t * t}).column;
  };
  const double t = 0.7, h = 1e-4;
  const TipRates first{{3.0, 2.0 * t, -1.0}, 0.5, 0.6 * t};
  const TipRates second{{0.0, 2.0, 0.0}, 0.0, 0.6};
  const double a = 0.4 + 0.5 * t, b = -0.8 + 0.3 * t * t;
  const auto [v, w] = head.RatesOfBoth(a, b, first, second);
  EXPECT_EQ(head.Rates(a, b, first), v);
  ExpectNear({v[0], v[1], v[2]}, (at(t + h) - at(t - h)) * (0.5 / h), 1e-5);
  ExpectNear({w[0], w[1], w[2]}, (at(t + h) - at(t) * 2.0 + at(t - h)) * (1.0 / (h * h)), 1e-4);
  EXPECT_EQ(v[3], 0.5);
  EXPECT_EQ(w[4], 0.6);
}

// motion.md 2.4 with one axis that turns at 1 rad by the unit, the other standing.
TEST(Head, RatesOfOneAxisAlone) {
  const Head head = GantryHead{.length_mm = 287.0, .tool = {1.5, -2.5, 4.0}};
  const double a = 0.4, b = -0.8, h = 1e-4;
  for (const bool turns_a : {true, false}) {
    const auto at = [&](double t) {
      return head.ColumnOf({{3.0 * t, 0, 0}, turns_a ? a + t : a, turns_a ? b : b + t}).column;
    };
    const AxisValues v = head.Rates(a, b, {{3.0, 0, 0}, turns_a ? 1.0 : 0.0, turns_a ? 0.0 : 1.0});
    ExpectNear({v[0], v[1], v[2]}, (at(h) - at(-h)) * (0.5 / h), 1e-5);
    EXPECT_EQ(v[3], turns_a ? 1.0 : 0.0);
    EXPECT_EQ(v[4], turns_a ? 0.0 : 1.0);
  }
}

// motion.md 7: a mill's axes are where the tip is, whatever its rotary axis does.
TEST(Head, MillStandsAtTheTip) {
  const Head head = MillHead{};
  const TipPose pose{{10, 20, -3}, 1.2, 0.0};
  EXPECT_EQ(head.ColumnOf(pose).column, pose.tip);
  EXPECT_EQ(head.TipOf(head.ColumnOf(pose)), pose);
  const auto [v, w] = head.RatesOfBoth(1.2, 0.0, {{1, 2, 3}, 0.5, 0.0}, {{4, 5, 6}, 0.7, 0.0});
  EXPECT_EQ(v, (AxisValues{1, 2, 3, 0.5, 0.0}));
  EXPECT_EQ(w, (AxisValues{4, 5, 6, 0.7, 0.0}));
  EXPECT_EQ(head.reach_mm(), 0.0);
}

// The bound that the planner goes by: column rates never exceed the tip's by more than
// reach (|A'| + |B'|), second ones by reach ((|A'| + |B'|)^2 + |A''| + |B''|).
TEST(Head, ReachBoundsTheSwing) {
  const GantryHead head{.length_mm = 287.0, .tool = {1.5, -2.5, 4.0}};
  for (double a = -6.0; a < 6.0; a += 0.37) {
    for (double b = -2.4; b < 2.4; b += 0.31) {
      const Swing swing = head.SwingOf(a, b, {{}, 0.4, -0.9}, {{}, -2.0, 0.3});
      EXPECT_LE(swing.first.norm(), head.reach_mm() * 1.3 * (1 + 1e-12));
      EXPECT_LE(swing.second.norm(), head.reach_mm() * (1.3 * 1.3 + 2.3) * (1 + 1e-12));
    }
  }
}

// A place of the program is never taken for one of the machine, nor the other way round.
static_assert(!std::is_convertible_v<ProgramPoint, MachinePoint>);
static_assert(!std::is_convertible_v<MachinePoint, ProgramPoint>);
static_assert(!std::is_convertible_v<TipPose, AxisPose>);

// OPT-B.09: the manual's order of the rotations.
TEST(WorkOffset, TurnsAboutZThenYThenX) {
  const MachineFromProgram offset(RigidMotionOf({100, 200, -500}, 1.570796, 0.0, 1.570796));
  ExpectNear(offset * ProgramPoint(0, 10, 0), {100, 200, -490}, 1e-4);
  ExpectNear(offset.ToProgram(offset * ProgramPoint(1, 2, 3)).from_origin(), {1, 2, 3});
  EXPECT_EQ(MachineFromProgram() * ProgramPoint(1, 2, 3), MachinePoint(1, 2, 3));
}

// motion.md 2.5: the nearer of both solutions and of their turns; A is kept along Z.
TEST(AnglesOf, TakesTheNearestSolution) {
  for (const double a : {-7.0, -3.0, 0.2, 3.3, 9.0}) {
    for (const double b : {-1.2, -0.3, 0.4, 2.0}) {
      const HeadAngles found = AnglesOf(ToolDirection(a, b), {a + 0.1, b - 0.05});
      EXPECT_NEAR(found.a_rad, a, 1e-12);
      EXPECT_NEAR(found.b_rad, b, 1e-12);
    }
  }
  EXPECT_EQ(AnglesOf({0, 0, 1}, {2.5, 0.3}).a_rad, 2.5);
  EXPECT_EQ(AnglesOf({0, 0, -1}, {2.5, 0.3}).b_rad, kPi);
}

// motion.md section 6, decision 15: A and B of tool jog turn without compensation.
TEST(Jog, MovesOneAxisOrHoldsTheTip) {
  const Head head;
  const AxisPose from{{1000, 900, -300}, 0.4, 0.9};
  EXPECT_EQ(Jogged(from, head, {JogMode::kRobot, 2, 5.0}).column.z(), -295.0);
  EXPECT_EQ(Jogged(from, head, {JogMode::kTool, 4, 0.1}).column, from.column);
  const AxisPose held = Jogged(from, head, {JogMode::kAbsolute, 3, 0.2});
  EXPECT_DOUBLE_EQ(held.a_rad, 0.6);
  ExpectNear(head.TipOf(held).tip, head.TipOf(from).tip);
  const MachineVector up =
      Jogged(from, head, {JogMode::kTool, 2, 10.0, false}).column - from.column;
  const MachineVector down =
      Jogged(from, head, {JogMode::kTool, 2, 10.0, true}).column - from.column;
  ExpectNear(up, ToolDirection(0.4, 0.9) * 10.0);
  ExpectNear(down, -up);
}

// OPT-B.08
TEST(Travel, NamesTheAxisThatLeaves) {
  const AxisLimits limits = StandardMachine().axes;
  EXPECT_EQ(WorstExcess(AxisPose{{0, 0, 0}, 0, 0}, limits).axis, -1);
  const TravelExcess far = WorstExcess(AxisPose{{9000, 0, 0}, 0, 0}, limits);
  EXPECT_EQ(far.axis, 0);
  EXPECT_DOUBLE_EQ(far.excess, 5400.0);
  EXPECT_EQ(WorstExcess(AxisPose{{0, 0, 0}, 0, 2.5}, limits).axis, 4);
  const double bad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(WorstExcess(AxisPose{{0, bad, 0}, 0, 0}, limits).axis, 1);
}

// An arc whose ends are inside bulges out at its quadrant point: motion.md 2.6. The quadrant is at
// 135 degrees of a turn of 251: none of the equal steps meets it.
TEST(Travel, FindsTheQuadrantPointOfAnArc) {
  AxisLimits limits = StandardMachine().axes;
  const PathPiece arc = PathPiece::Circle({{0, 0, 0}}, {100, 100, 0}, {0, 0, 1}, 4.3807, 0, 0);
  limits.travel_max[0] = 100.0 + 100.0 * std::sqrt(2.0) - 1e-6;
  const TravelExcess worst = WorstExcess(arc, MillHead{}, limits);
  EXPECT_EQ(worst.axis, 0);
  EXPECT_NEAR(worst.excess, 1e-6, 1e-10);
  limits.travel_max[0] += 2e-6;
  EXPECT_EQ(WorstExcess(arc, MillHead{}, limits).axis, -1);
}

// The column swings out between two ends that are both inside.
TEST(Travel, LooksAtTheColumnBetweenTheEnds) {
  AxisLimits limits = StandardMachine().axes;
  limits.travel_max[0] = 250.0;
  const PathPiece turn = PathPiece::Line({{0, 0, 0}, 0, kPi / 2}, {{0, 0, 0}, kPi, kPi / 2});
  const TravelExcess worst = WorstExcess(turn, Head{}, limits);
  EXPECT_EQ(worst.axis, 0);
  EXPECT_NEAR(worst.excess, 50.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::motion
