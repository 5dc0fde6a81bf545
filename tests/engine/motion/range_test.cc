// Head and travel: which of two solutions, jog along each axis, and where a path is looked at.
// motion.md 2.2, 2.3, 2.5, 2.6, 6.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/geometry/frames.h"
#include "engine/motion/kinematics/kinematics.h"
#include "tests/engine/motion/expect_near.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

// R(A,B) = Rz(A) Rx(B), all three axes. motion.md 2.1
TEST(ToolAxes, AreThoseOfTheMatrix) {
  const double a = 0.7, b = -0.4;
  const Rotation axes = ToolRotation(a, b);
  ExpectNear(axes.col(0), {std::cos(a), std::sin(a), 0}, 1e-15);
  ExpectNear(axes.col(1), {-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)},
             1e-15);
  ExpectNear(axes.col(2), {std::sin(a) * std::sin(b), -std::cos(a) * std::sin(b), std::cos(b)},
             1e-15);
  ExpectNear(axes.col(0).cross(axes.col(1)), axes.col(2), 1e-15);
}

// With a tool offset in all directions: r = (-X0, -Y0, L - Z0) along the tool axes. motion.md 2.2
TEST(Head, OffsetOfTheTool) {
  const GantryHead head{.length_mm = 200.0, .tool = {5.0, -7.0, 11.0}};
  for (const auto& [a, b] : {std::pair{0.0, 0.0}, {0.9, 0.5}, {-2.0, -1.3}}) {
    const Rotation axes = ToolRotation(a, b);
    ExpectNear(head.Offset(a, b), axes * MachineVector(-5.0, 7.0, 189.0), 1e-12);
  }
  EXPECT_NEAR(head.reach_mm(), std::sqrt(25.0 + 49.0 + 189.0 * 189.0), 1e-12);
}

// Both solutions equally near: the first, A = atan2(ux, -uy) with B above 0. Here from A = 0 the
// solutions for u = +-X are A = pi/2, B and A = -pi/2, -B. motion.md 2.5
TEST(AnglesOf, FirstSolutionOnATie) {
  for (const double sign : {1.0, -1.0}) {
    const HeadAngles angles = AnglesOf({sign * 0.6, 0, 0.8}, {0.0, 0.0});
    EXPECT_NEAR(angles.a_rad, sign * kPi / 2, 1e-15);
    EXPECT_NEAR(angles.b_rad, std::atan2(0.6, 0.8), 1e-15);
    // The least bit to one side decides. B counts like A.
    EXPECT_GT(AnglesOf({sign * 0.6, 0, 0.8}, {sign * 1e-9, 0.0}).b_rad, 0.0);
    EXPECT_LT(AnglesOf({sign * 0.6, 0, 0.8}, {sign * -1e-9, 0.0}).b_rad, 0.0);
    EXPECT_GT(AnglesOf({sign * 0.6, 0, 0.8}, {0.0, 1e-9}).b_rad, 0.0);
    EXPECT_LT(AnglesOf({sign * 0.6, 0, 0.8}, {0.0, -1e-9}).b_rad, 0.0);
  }
  // Some turns away, too: A is never reduced.
  const HeadAngles far = AnglesOf({0.6, 0, 0.8}, {2 * kTurn, 0.0});
  EXPECT_NEAR(far.a_rad, 2 * kTurn + kPi / 2, 1e-12);
  EXPECT_NEAR(AnglesOf({0, -0.6, 0.8}, {2 * kTurn + 0.1, 0.5}).a_rad, 2 * kTurn, 1e-12);
  // Between |dA| and |dB|: near A = pi the twin is pi away in A less, 2 B away in B.
  EXPECT_LT(AnglesOf({0, -0.6, 0.8}, {3.0, 0.1}).b_rad, 0.0);
  EXPECT_NEAR(AnglesOf({0, -0.6, 0.8}, {3.0, 0.1}).a_rad, kPi, 1e-12);
}

// hypot(ux, uy) < 1e-9: A is free and kept. From there on the direction tells it.
TEST(AnglesOf, AlongZ) {
  EXPECT_EQ(AnglesOf({0.9e-9, 0, 1}, {0.3, 0.0}).a_rad, 0.3);
  EXPECT_NEAR(AnglesOf({1e-9, 0, 1}, {0.3, 0.0}).a_rad, kPi / 2, 1e-12);
  EXPECT_NEAR(AnglesOf({1.1e-9, 0, 1}, {0.3, 0.0}).a_rad, kPi / 2, 1e-12);
  EXPECT_NEAR(AnglesOf({0, 0.9e-9, 1}, {0.3, 0.0}).b_rad, 0.9e-9, 1e-20);
  // The length of the direction does not count for B.
  EXPECT_NEAR(AnglesOf({0, -3, 4}, {0, 0.5}).b_rad, std::atan2(3, 4), 1e-15);
}

// Jog of one axis: ROB and ABS move the column along the machine axes, TCP along the tool axes. Z
// turned round takes Y with it. A and B: ROB and TCP alone, ABS with the tip held.
TEST(Jog, EachAxisInEachMode) {
  const Head head = GantryHead{.tool = {3.0, -4.0, 20.0}};
  const AxisPose from{{1000, 900, -300}, 0.4, 0.9};
  const Rotation tool = ToolRotation(0.4, 0.9);
  const MachinePoint machine[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const MachineVector along_tool[3] = {tool.col(0), tool.col(1), tool.col(2)};
  for (int axis = 0; axis < 3; ++axis) {
    for (const JogMode mode : {JogMode::kRobot, JogMode::kAbsolute}) {
      for (const bool down : {false, true}) {
        const AxisPose to = Jogged(from, head, {mode, axis, -2.5, down});
        ExpectNear(to.column, from.column - machine[axis] * 2.5, 1e-12);
        EXPECT_EQ(to.a_rad, 0.4);
        EXPECT_EQ(to.b_rad, 0.9);
      }
    }
    const AxisPose up = Jogged(from, head, {JogMode::kTool, axis, 2.5, false});
    const AxisPose down = Jogged(from, head, {JogMode::kTool, axis, 2.5, true});
    ExpectNear(up.column, from.column + along_tool[axis] * 2.5, 1e-12);
    ExpectNear(down.column, from.column + along_tool[axis] * (axis == 0 ? 2.5 : -2.5), 1e-12);
    EXPECT_EQ(up.a_rad, 0.4);
    EXPECT_EQ(down.b_rad, 0.9);
  }
  for (const int axis : {3, 4}) {
    const double a = axis == 3 ? 0.65 : 0.4, b = axis == 4 ? 1.15 : 0.9;
    for (const JogMode mode : {JogMode::kRobot, JogMode::kTool}) {
      const AxisPose to = Jogged(from, head, {mode, axis, 0.25, true});
      EXPECT_EQ(to.column, from.column);
      EXPECT_DOUBLE_EQ(to.a_rad, a);
      EXPECT_DOUBLE_EQ(to.b_rad, b);
    }
    const AxisPose held = Jogged(from, head, {JogMode::kAbsolute, axis, 0.25});
    ExpectNear(head.TipOf(held).tip, head.TipOf(from).tip, 1e-10);
    EXPECT_DOUBLE_EQ(held.a_rad, a);
    EXPECT_DOUBLE_EQ(held.b_rad, b);
    EXPECT_GT((held.column - from.column).norm(), 10.0);
  }
}

// T Rz(c) Ry(b) Rx(a), each turn by itself and all together, against turning one after the other.
TEST(WorkOffset, IsOneTurnAfterTheOther) {
  const auto about_x = [](const MachinePoint& p, double t) {
    return MachineVector{p.x(), p.y() * std::cos(t) - p.z() * std::sin(t),
                         p.y() * std::sin(t) + p.z() * std::cos(t)};
  };
  const auto about_y = [](const MachinePoint& p, double t) {
    return MachineVector{p.x() * std::cos(t) + p.z() * std::sin(t), p.y(),
                         p.z() * std::cos(t) - p.x() * std::sin(t)};
  };
  const auto about_z = [](const MachinePoint& p, double t) {
    return MachineVector{p.x() * std::cos(t) - p.y() * std::sin(t),
                         p.x() * std::sin(t) + p.y() * std::cos(t), p.z()};
  };
  for (const auto& [c, b, a] : {std::array{0.5, 0.0, 0.0},
                                {0.0, 0.5, 0.0},
                                {0.0, 0.0, 0.5},
                                {0.3, -0.8, 1.9},
                                {-2.5, 1.1, -0.4}}) {
    const MachineFromProgram offset(RigidMotionOf({10, -20, 30}, c, b, a));
    for (const ProgramVector& p : {ProgramVector{1, 0, 0}, ProgramVector{0, 1, 0},
                                   ProgramVector{0, 0, 1}, ProgramVector{4, 5, 6}}) {
      const MachineVector turned = about_z(about_y(about_x(p, a), b), c);
      ExpectNear(offset.axes() * p, turned, 1e-14);
      ExpectNear(offset * ProgramPoint::FromOrigin(p), turned + MachineVector{10, -20, 30}, 1e-13);
      ExpectNear(offset.ToProgram(offset * ProgramPoint::FromOrigin(p)).from_origin(), p, 1e-13);
    }
  }
}

// Both ends of each axis' travel belong to it; beyond them the excess is told. OPT-B.08
TEST(Travel, BothEndsOfEveryAxis) {
  const AxisLimits limits = StandardMachine().axes;
  for (int axis = 0; axis < kAxisCount; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const auto at = [axis](double value) {
      AxisPose pose;
      (axis == 0   ? pose.column.x()
       : axis == 1 ? pose.column.y()
       : axis == 2 ? pose.column.z()
       : axis == 3 ? pose.a_rad
                   : pose.b_rad) = value;
      return pose;
    };
    for (const double end : {limits.travel_min[i], limits.travel_max[i]}) {
      const double out = end < 0.0 ? -0.5 : 0.5;
      EXPECT_EQ(WorstExcess(at(end), limits).axis, -1);
      EXPECT_EQ(WorstExcess(at(end), limits).excess, 0.0);
      EXPECT_EQ(WorstExcess(at(end + out), limits).axis, axis);
      EXPECT_NEAR(WorstExcess(at(end + out), limits).excess, 0.5, 1e-12);
      EXPECT_NEAR(ExcessOfAxis(axis, at(end + out), limits), 0.5, 1e-12);
      EXPECT_EQ(ExcessOfAxis((axis + 1) % kAxisCount, at(end + out), limits), 0.0);
    }
  }
  // The worst of two, whichever axis comes first.
  EXPECT_EQ(WorstExcess(AxisPose{{3601, 3102, 0}, 0, 0}, limits).axis, 1);
  EXPECT_EQ(WorstExcess(AxisPose{{3602, 3101, 0}, 0, 0}, limits).axis, 0);
}

// 17 points of a line: the column goes round the tip, 300 sin A, and A at k/16 of its way; nothing
// between them is seen.
TEST(Travel, SeventeenPointsOfALine) {
  AxisLimits limits = StandardMachine().axes;
  limits.travel_max[0] = 200.0;
  for (const double to : {2.9, 5.0, -4.0}) {
    const PathPiece line = PathPiece::Line({{0, 0, 0}, 0.05, kPi / 2}, {{80, 0, 0}, to, kPi / 2});
    double worst = 0.0, place = 0.0;
    for (int k = 0; k <= 16; ++k) {
      const double x = 80.0 * k / 16.0 + 300.0 * std::sin(0.05 + (to - 0.05) * k / 16.0);
      if (x - 200.0 > worst) place = k / 16.0;
      worst = std::max(worst, x - 200.0);
    }
    EXPECT_NEAR(WorstExcess(line, Head{}, limits).excess, worst, 1e-9) << to;
    const PlacedExcess placed = ExcessOfEach(line, Head{}, limits)[0];
    EXPECT_NEAR(placed.excess, worst, 1e-9) << to;
    EXPECT_NEAR(placed.s, place * line.length(), 1e-9) << to;
  }
}

// 32 points for a turn of arc, but no fewer than 16 parts; and where X, Y and Z turn back. Here the
// circle is small and the head does the moving.
TEST(Travel, PointsOfAnArc) {
  AxisLimits limits = StandardMachine().axes;
  limits.travel_max[0] = 200.0;
  for (const double sweep : {kTurn, 0.9 * kTurn, 0.6 * kTurn, 0.2}) {
    for (const double to : {2.9, 1.4, -5.3}) {
      const PathPiece arc =
          PathPiece::Circle({{1e-3, 0, 0}, 0.05, kPi / 2}, {}, {0, 0, 1}, sweep, to, kPi / 2);
      const int parts = std::max(16, static_cast<int>(std::ceil(sweep / kTurn * 32.0)));
      double worst = 0.0;
      const auto look = [&](double share) {
        worst = std::max(worst, 1e-3 * std::cos(sweep * share) +
                                    300.0 * std::sin(0.05 + (to - 0.05) * share) - 200.0);
      };
      for (int k = 0; k <= parts; ++k) look(static_cast<double>(k) / parts);
      for (const double quadrant : {0.25, 0.5, 0.75, 1.0}) {
        if (quadrant * kTurn < sweep) look(quadrant * kTurn / sweep);
      }
      EXPECT_NEAR(WorstExcess(arc, Head{}, limits).excess, worst, 1e-9) << sweep << " " << to;
    }
  }
}

// Every quadrant of a circle in space, X Y Z up and down, inside an arc that leaves it out or not.
TEST(Travel, QuadrantsInAllDirections) {
  const MachineVector n{0.48, 0.6, 0.64};  // unit
  for (int axis = 0; axis < 3; ++axis) {
    const double across = axis == 0 ? n.x() : axis == 1 ? n.y() : n.z();
    const double amplitude = 70.0 * std::sqrt(1.0 - across * across);
    for (const bool high : {true, false}) {
      AxisLimits limits;
      limits.travel_min.fill(-1e6);
      limits.travel_max.fill(1e6);
      const auto i = static_cast<std::size_t>(axis);
      (high ? limits.travel_max : limits.travel_min)[i] = (high ? 1.0 : -1.0) * (amplitude - 1.0);
      const MachineVector side =
          n.cross(MachineVector::UnitX()) * (70.0 / std::sqrt(1.0 - n.x() * n.x()));
      const PathPiece circle = PathPiece::Circle({side}, {}, n, kTurn, 0, 0);
      const TravelExcess worst = WorstExcess(circle, MillHead{}, limits);
      EXPECT_EQ(worst.axis, axis);
      EXPECT_NEAR(worst.excess, 1.0, 1e-9);
    }
  }
}

// In COORD ROBOT poses are those of the column, whatever the head. OPT-2.03
TEST(Travel, JointsAreTheColumn) {
  const AxisLimits limits = StandardMachine().axes;
  const PathPiece joint = PathPiece::Joint({{0, 0, 1090}, 0, 0}, {{0, 0, 1110}, 0, 0});
  EXPECT_NEAR(WorstExcess(joint, Head{}, limits).excess, 10.0, 1e-9);
  EXPECT_EQ(WorstExcess(joint, Head{}, limits).axis, 2);
}

}  // namespace
}  // namespace rmlcell::motion
