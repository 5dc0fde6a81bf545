#include "engine/simulation/path/path_extent.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/units.h"
#include "tests/engine/motion/standard_machine.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

using motion::GantryHead;
using motion::Head;
using motion::MachineVector;
using motion::PathPiece;

constexpr double kHalfRoot2 = std::numbers::sqrt2 / 2.0;

PathPiece CircleXY(double sweep) {
  return PathPiece::Circle({{10, 0, 0}}, {0, 0, 0}, {0, 0, 1}, sweep, 0.0, 0.0);
}

// motion.md 8.2: the box of an arc reaches its true extremes. Three quarters from (10,0)
// counter-clockwise end at (0,-10): X reaches -10 and Y reaches 10 on the way.
TEST(PathExtent, ArcReachesItsQuadrants) {
  const PathPiece arc = CircleXY(1.5 * kPi);
  const PointSweep sweep = TipSweepOf({arc, Head{}, 0.0, arc.length()});
  EXPECT_NEAR(sweep[0].minimum, -10.0, 1e-12);
  EXPECT_NEAR(sweep[0].maximum, 10.0, 1e-12);
  EXPECT_NEAR(sweep[1].minimum, -10.0, 1e-12);
  EXPECT_NEAR(sweep[1].maximum, 10.0, 1e-12);
  // X goes 10 -> -10 -> 0, Y goes 0 -> 10 -> -10.
  EXPECT_NEAR(sweep[0].travel, 30.0, 1e-12);
  EXPECT_NEAR(sweep[1].travel, 30.0, 1e-12);
  EXPECT_EQ(sweep[0].turns, 1);
  EXPECT_EQ(sweep[1].turns, 1);
  EXPECT_EQ(sweep[0].first_sign, -1);
  EXPECT_EQ(sweep[0].last_sign, 1);
  EXPECT_EQ(sweep[2].travel, 0.0);
}

// Only the part that was travelled counts: from 45 to 135 degrees Y turns at the top, X does not.
TEST(PathExtent, PartOfAnArc) {
  const PathPiece arc = CircleXY(kTurn);
  const double eighth = 10.0 * kPi / 4.0;
  const PointSweep sweep = TipSweepOf({arc, Head{}, eighth, 3.0 * eighth});
  EXPECT_NEAR(sweep[0].minimum, -10.0 * kHalfRoot2, 1e-12);
  EXPECT_NEAR(sweep[0].maximum, 10.0 * kHalfRoot2, 1e-12);
  EXPECT_EQ(sweep[0].turns, 0);
  EXPECT_NEAR(sweep[1].maximum, 10.0, 1e-12);
  EXPECT_NEAR(sweep[1].minimum, 10.0 * kHalfRoot2, 1e-12);
  EXPECT_NEAR(sweep[1].travel, 20.0 * (1.0 - kHalfRoot2), 1e-12);
  EXPECT_EQ(sweep[1].turns, 1);
}

// A circle about (1,1,1)/sqrt(3): in every coordinate it reaches R sqrt(1 - 1/3) from its centre.
TEST(PathExtent, TiltedCircle) {
  const double third = 1.0 / std::sqrt(3.0);
  const motion::MachinePoint start{20.0 + 3.0 / std::sqrt(2.0), 30.0 - 3.0 / std::sqrt(2.0), 40.0};
  const PathPiece circle =
      PathPiece::Circle({start}, {20, 30, 40}, {third, third, third}, kTurn, 0.0, 0.0);
  const PointSweep sweep = TipSweepOf({circle, Head{}, 0.0, circle.length()});
  const double reach = 3.0 * std::sqrt(2.0 / 3.0);
  const double centre[3] = {20, 30, 40};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(sweep[i].minimum, centre[i] - reach, 1e-12) << i;
    EXPECT_NEAR(sweep[i].maximum, centre[i] + reach, 1e-12) << i;
    EXPECT_NEAR(sweep[i].travel, 4.0 * reach, 1e-11) << i;
  }
}

// motion.md 3.2: near-straight arcs (case A04) keep their digits: the chord is 100 mm long, the bow
// 0.01 mm high.
TEST(PathExtent, NearlyStraightArc) {
  const auto arc = PathPiece::ArcThrough({{0, 0, 0}}, {50, 0.01, 0}, {{100, 0, 0}});
  ASSERT_TRUE(arc);
  const PointSweep sweep = TipSweepOf({arc->path, Head{}, 0.0, arc->path.length()});
  EXPECT_NEAR(sweep[1].maximum, 0.01, 1e-9);
  EXPECT_NEAR(sweep[1].minimum, 0.0, 1e-9);
  EXPECT_NEAR(sweep[0].maximum, 100.0, 1e-9);
}

// motion.md 2.2: with A = 0 and B from -pi/2 to pi/2 about a standing tip the column swings along
// -sin B in Y and cos B in Z, 300 mm long: Y from 300 to -300, Z up to 300 and down again.
TEST(PathExtent, ColumnSwingsAboutAStandingTip) {
  const PathPiece turn = PathPiece::Line({{0, 0, 0}, 0.0, -kPi / 2}, {{0, 0, 0}, 0.0, kPi / 2});
  const Head head = GantryHead{.length_mm = 300.0};
  const PathPart part{turn, head, 0.0, 1.0};
  const PointSweep column = ColumnSweepOf(part);
  EXPECT_NEAR(column[1].maximum, 300.0, 1e-9);
  EXPECT_NEAR(column[1].minimum, -300.0, 1e-9);
  EXPECT_NEAR(column[1].travel, 600.0, 1e-9);
  EXPECT_EQ(column[1].turns, 0);
  EXPECT_NEAR(column[2].maximum, 300.0, 1e-9);
  EXPECT_NEAR(column[2].minimum, 0.0, 1e-9);
  EXPECT_NEAR(column[2].travel, 600.0, 1e-9);
  EXPECT_EQ(column[2].turns, 1);
  const PointSweep tip = TipSweepOf(part);
  EXPECT_EQ(tip[0].travel + tip[1].travel + tip[2].travel, 0.0);
  EXPECT_EQ(TipLengthOf(part), 0.0);
}

// Without a turn of the head the column goes as the tip does, 300 mm above.
TEST(PathExtent, ColumnFollowsAnArcOfTheTip) {
  const PathPiece arc = CircleXY(1.5 * kPi);
  const PointSweep column = ColumnSweepOf({arc, GantryHead{.length_mm = 300.0}, 0.0, arc.length()});
  EXPECT_NEAR(column[0].minimum, -10.0, 1e-9);
  EXPECT_NEAR(column[1].maximum, 10.0, 1e-9);
  EXPECT_NEAR(column[2].minimum, 300.0, 1e-9);
  EXPECT_NEAR(column[2].maximum, 300.0, 1e-9);
}

// COORD ROBOT: the column stands while B turns a quarter, so the tip goes a quarter circle of 300
// mm radius: 471.2389 mm, from below the column to beside it.
TEST(PathExtent, TipBowsWhenTheHeadTurnsInRobotCoordinates) {
  const PathPiece joint = PathPiece::Joint({{0, 0, 0}, 0.0, 0.0}, {{0, 0, 0}, 0.0, kPi / 2});
  const PathPart part{joint, GantryHead{.length_mm = 300.0}, 0.0, 1.0};
  EXPECT_NEAR(TipLengthOf(part), 300.0 * kPi / 2, 1e-9);
  const PointSweep tip = TipSweepOf(part);
  EXPECT_NEAR(tip[2].minimum, -300.0, 1e-9);
  EXPECT_NEAR(tip[2].maximum, 0.0, 1e-9);
  EXPECT_NEAR(tip[1].maximum, 300.0, 1e-9);  // u = (0, -1, 0): the tip is on the other side
  EXPECT_EQ(ColumnSweepOf(part)[1].travel, 0.0);
}

// From B = -1 to B = 1 the tip passes the lowest point of its circle, which no end of the move is.
TEST(PathExtent, TipTurnsRoundInTheMiddleOfABow) {
  const PathPiece joint = PathPiece::Joint({{0, 0, 0}, 0.0, -1.0}, {{0, 0, 0}, 0.0, 1.0});
  const PathPart part{joint, GantryHead{.length_mm = 300.0}, 0.0, 1.0};
  const PointSweep tip = TipSweepOf(part);
  EXPECT_NEAR(tip[2].minimum, -300.0, 1e-9);
  EXPECT_NEAR(tip[2].maximum, -300.0 * std::cos(1.0), 1e-9);
  EXPECT_EQ(tip[2].turns, 1);
  EXPECT_NEAR(TipLengthOf(part), 600.0, 1e-9);
}

// A curve that bulges: at a corner of 135 degrees between lines along +X and (-1,1)/sqrt(2) the tip
// goes beyond neither line, and X turns round once, on the curve.
TEST(PathExtent, CurveTurnsRound) {
  double farthest = 0.0;
  int turns = 0;
  for (const motion::PlannedMotion& planned :
       PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{0, 100, 0}})) {
    const PointSweep sweep = TipSweepOf({planned.path, Head{}, 0.0, planned.path.length()});
    double sampled = -1e9;
    for (int k = 0; k <= 5000; ++k) {
      sampled = std::max(sampled, planned.path.At(planned.path.length() * k / 5000).point.x());
    }
    EXPECT_GE(sweep[0].maximum, sampled - 1e-12);
    EXPECT_NEAR(sweep[0].maximum, sampled, 1e-6);
    farthest = std::max(farthest, sweep[0].maximum);
    turns += sweep[0].turns;
    EXPECT_EQ(sweep[1].turns, 0);
    EXPECT_GE(sweep[1].minimum, 0.0);
  }
  EXPECT_EQ(turns, 1);
  EXPECT_LT(farthest, 100.0);
}

void ExpectSweep(const CoordinateSweep& sweep, const CoordinateSweep& expected, const char* what) {
  EXPECT_NEAR(sweep.minimum, expected.minimum, 1e-9) << what;
  EXPECT_NEAR(sweep.maximum, expected.maximum, 1e-9) << what;
  EXPECT_NEAR(sweep.travel, expected.travel, 1e-9) << what;
  EXPECT_EQ(sweep.turns, expected.turns) << what;
  EXPECT_EQ(sweep.first_sign, expected.first_sign) << what;
  EXPECT_EQ(sweep.last_sign, expected.last_sign) << what;
}

// All of a sweep: where it goes up, down, or stands.
TEST(PathExtent, SweepsOfALine) {
  const PathPiece line = PathPiece::Line({{1, 2, 3}, 0.5, 0.1}, {{4, -2, 3}, 0.25, 0.2});
  const PathPart part{line, Head{}, 0.0, line.length()};
  const PointSweep sweep = TipSweepOf(part);
  ExpectSweep(sweep[0], {1, 4, 3, 0, 1, 1}, "x");
  ExpectSweep(sweep[1], {-2, 2, 4, 0, -1, -1}, "y");
  ExpectSweep(sweep[2], {3, 3, 0, 0, 0, 0}, "z");
  PartShape shape(part);
  const auto rotary = RotarySweep(shape);
  ExpectSweep(rotary[0], {0.25, 0.5, 0.25, 0, -1, -1}, "a");
  ExpectSweep(rotary[1], {0.1, 0.2, 0.1, 0, 1, 1}, "b");
}

// A coordinate across the plane of an arc stands; one that comes back to where it was has both
// directions.
TEST(PathExtent, SweepsOfACircle) {
  const PathPiece circle = CircleXY(kTurn);
  const PointSweep sweep = TipSweepOf({circle, Head{}, 0.0, circle.length()});
  ExpectSweep(sweep[0], {-10, 10, 40, 1, -1, 1}, "x");
  ExpectSweep(sweep[1], {-10, 10, 40, 2, 1, 1}, "y");
  ExpectSweep(sweep[2], {0, 0, 0, 0, 0, 0}, "z");
}

// A swing turns round wherever on its way that is: near its begin, near its end, or at both. The
// tip hangs 300 mm below the column; it passes the lowest place at B = 0, and the ends of Y at a
// quarter turn.
TEST(PathExtent, SwingsTurnRoundAnywhere) {
  const auto swing = [](double from, double to) {
    const PathPiece joint = PathPiece::Joint({{0, 0, 0}, 0.0, from}, {{0, 0, 0}, 0.0, to});
    return TipSweepOf({joint, GantryHead{.length_mm = 300.0}, 0.0, 1.0});
  };
  const auto z = [](double b) { return -300.0 * std::cos(b); };
  for (const double angle : {0.01, 0.1, 0.3}) {
    for (const double far : {0.7, 1.5}) {
      const double travel = 600.0 + z(angle) + z(far);
      ExpectSweep(swing(-angle, far)[2], {-300, z(far), travel, 1, -1, 1}, "z late");
      ExpectSweep(swing(-far, angle)[2], {-300, z(far), travel, 1, -1, 1}, "z early");
    }
  }
  const PointSweep wide = swing(-2.0, 1.8);
  ExpectSweep(wide[2], {-300, z(2.0), 600.0 + z(2.0) + z(1.8), 1, -1, 1}, "z");
  EXPECT_EQ(wide[1].turns, 2);
  EXPECT_NEAR(wide[1].travel, 600.0 + 600.0 - 300.0 * (std::sin(2.0) + std::sin(1.8)), 1e-9);
  EXPECT_NEAR(wide[1].maximum - wide[1].minimum, 600.0, 1e-9);
  ExpectSweep(wide[0], {0, 0, 0, 0, 0, 0}, "x");
}

// The head of the widest rotary axis: 4 turns of A swing the column in X and Y eight times each.
TEST(PathExtent, ColumnSwingsAsOftenAsAGoesRound) {
  const PathPiece turn =
      PathPiece::Line({{0, 0, 0}, 0.1, 0.5 * kPi}, {{0, 0, 0}, 0.1 + 4.0 * kTurn, 0.5 * kPi});
  const PointSweep column =
      ColumnSweepOf({turn, GantryHead{.length_mm = 300.0}, 0.0, turn.length()});
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_NEAR(column[i].minimum, -300.0, 1e-9);
    EXPECT_NEAR(column[i].maximum, 300.0, 1e-9);
    EXPECT_NEAR(column[i].travel, 4.0 * 1200.0, 1e-8);
    EXPECT_EQ(column[i].turns, 8);
  }
}

// A and B on a corner where A turns back and B goes on: against ten thousand places of it.
TEST(PathExtent, RotaryAxesOfACorner) {
  const auto motions =
      PlannedCorner({{0, 0, 0}, 0.0, 0.1}, {{100, 0, 0}, 0.4, 0.3}, {{100, 100, 0}, 0.0, 0.7});
  ASSERT_EQ(motions.size(), 4u);
  PathPiece whole = motions[1].path;
  whole.AssignCorner(motions[1].path.curve(), 0.0,
                     motions[1].path.length() + motions[2].path.length(), motions[1].path.from(),
                     motions[2].path.to());
  PartShape shape({whole, GantryHead{.length_mm = 300.0}, 0.0, whole.length()});
  const auto rotary = RotarySweep(shape);
  double a_most = -1e9, b_least = 1e9, b_most = -1e9;
  for (int k = 0; k <= 10000; ++k) {
    const motion::PathPose pose = whole.At(whole.length() * k / 10000.0);
    a_most = std::max(a_most, pose.a_rad);
    b_least = std::min(b_least, pose.b_rad);
    b_most = std::max(b_most, pose.b_rad);
  }
  EXPECT_EQ(rotary[0].turns, 1);
  EXPECT_EQ(rotary[0].first_sign, 1);
  EXPECT_EQ(rotary[0].last_sign, -1);
  EXPECT_NEAR(rotary[0].maximum, a_most, 1e-7);
  EXPECT_NEAR(rotary[0].travel, 2.0 * rotary[0].maximum - whole.from().a_rad - whole.to().a_rad,
              1e-12);
  EXPECT_EQ(rotary[1].turns, 0);
  EXPECT_EQ(rotary[1].first_sign, 1);
  EXPECT_NEAR(rotary[1].minimum, b_least, 1e-12);
  EXPECT_NEAR(rotary[1].maximum, b_most, 1e-12);
}

TEST(PathExtent, BoxHasAllCorners) {
  const machine::Box box = BoxOf(
      {{{.minimum = 1, .maximum = 2}, {.minimum = 3, .maximum = 4}, {.minimum = 5, .maximum = 6}}});
  EXPECT_EQ(box.min, (MachineVector{1, 3, 5}));
  EXPECT_EQ(box.max, (MachineVector{2, 4, 6}));
}

// A straight move in COORD ROBOT without a turn: the tip goes as the column does.
TEST(PathExtent, StraightJointMove) {
  const PathPiece joint = PathPiece::Joint({{0, 0, 0}, 1.0, 0.5}, {{30, 40, 0}, 1.0, 0.5});
  EXPECT_NEAR(TipLengthOf({joint, Head{}, 0.0, 1.0}), 50.0, 1e-12);
  EXPECT_NEAR(TipLengthOf({joint, Head{}, 0.25, 0.75}), 25.0, 1e-12);
}

// What is left of a move that was stopped on its target.
TEST(PathExtent, StandingHasNoLength) {
  const PathPiece joint = PathPiece::Joint({{0, 0, 0}, 0.0, 0.2}, {{30, 40, 0}, 1.0, 0.5});
  const PathPiece here = joint.Standing(1.0);
  EXPECT_TRUE(here.in_axes());
  EXPECT_EQ(TipLengthOf({here, Head{}, 0.0, 0.0}), 0.0);
}

// A passage in COORD ROBOT (motion.md 4.5) in which the head turns: extent and length of the tip's
// way against ten thousand chords of it.
TEST(PathExtent, PassageInAxes) {
  motion::Planner planner(motion::StandardMachine());
  motion::MoveCommand move;
  move.kind = motion::MoveCommand::Kind::kPointToPointAxes;
  move.fly = true;
  move.path = PathPiece::Joint({{0, 0, 0}, 0.0, 0.2}, {{400, 50, 0}, 0.8, 0.9});
  ASSERT_TRUE(planner.Append(move));
  move.path = PathPiece::Joint({{400, 50, 0}, 0.8, 0.9}, {{300, 500, -80}, 0.1, 0.3});
  ASSERT_TRUE(planner.Append(move));
  planner.Stop();
  int bends = 0;
  while (const auto item = planner.Next()) {
    const auto& planned = std::get<motion::PlannedMotion>(*item);
    if (planned.path.kind() != PathPiece::Kind::kBlend) continue;
    ++bends;
    const PathPart part{planned.path, planned.head, 0.0, planned.path.length()};
    const PointSweep tip = TipSweepOf(part), column = ColumnSweepOf(part);
    double length = 0.0, highest = -1e9, column_highest = -1e9;
    motion::MachinePoint last = TipAt(planned.path, planned.head, 0.0);
    for (int k = 0; k <= 10000; ++k) {
      const double s = planned.path.length() * k / 10000.0;
      const motion::MachinePoint here = TipAt(planned.path, planned.head, s);
      length += (here - last).norm();
      last = here;
      highest = std::max(highest, here.x());
      column_highest = std::max(column_highest, planned.path.At(s).point.x());
    }
    EXPECT_NEAR(TipLengthOf(part), length, 1e-6);
    EXPECT_NEAR(tip[0].maximum, highest, 1e-6);
    EXPECT_NEAR(column[0].maximum, column_highest, 1e-6);
    int vertices = 0;
    double drawn = 0.0;
    motion::MachinePoint vertex = TipAt(planned.path, planned.head, 0.0);
    PartShape shape(part);
    ForEachVertex(shape, 0.01, [&](double, const motion::MachinePoint& next) {
      ++vertices;
      drawn += (next - vertex).norm();
      vertex = next;
    });
    EXPECT_GT(vertices, 2);
    EXPECT_LE(drawn, length + 1e-9);
    EXPECT_NEAR(drawn, length, 0.01);
    EXPECT_EQ(vertex, last);
  }
  EXPECT_EQ(bends, 2);
}

}  // namespace
}  // namespace rmlcell::simulation
