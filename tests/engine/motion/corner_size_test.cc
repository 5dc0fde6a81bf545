// How large a bend is: motion.md 4.3, each of its terms by itself, and what OVERSH makes of it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "engine/motion/corner/axes_corner.h"
#include "tests/engine/motion/random_chain.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

MachineLimits Trapezoids() {
  MachineLimits machine = StandardMachine();
  machine.tip_jerk_mm_s3 = kNoLimit;
  return machine;
}

// Two lines of 100 mm with a turn between them.
std::vector<PathPiece> Lines(double degrees) {
  const double turn = degrees * kRadPerDegree;
  return {PathPiece::Line({{-100, 0, 0}}, {}),
          PathPiece::Line({}, {{100 * std::cos(turn), 100 * std::sin(turn), 0}})};
}

// Straight on, and A or B begins to turn by 0.01 rad/mm.
std::vector<PathPiece> HeadStarts(bool a) {
  return {PathPiece::Line({{-80, 0, 0}, 0, 1}, {{0, 0, 0}, 0, 1}),
          PathPiece::Line({{0, 0, 0}, 0, 1}, {{80, 0, 0}, a ? 0.8 : 0.0, a ? 1.0 : 1.8})};
}

Corner Of(const std::vector<PathPiece>& pair) { return Corner::Between(pair[0], pair[1]); }

// The report of the passage between two pieces in a plan, at SPEED 10.
CornerReport Passed(const std::vector<PathPiece>& pair, double overshoot,
                    const MachineLimits& machine) {
  std::vector<MoveCommand> chain(2);
  for (std::size_t k = 0; k < 2; ++k) {
    chain[k].path = pair[k];
    chain[k].head = MillHead{};  // the axes have no say: the column goes with the tip
    chain[k].speed_fraction = 0.1;
    chain[k].tag = k;
  }
  chain[0].fly = true;
  chain[0].overshoot_fraction = overshoot;
  for (const PlannedMotion& motion : Plan(chain, machine)) {
    if (motion.ends_move) return motion.corner;
  }
  return {};
}

// A right angle at 50 mm/s: K = 0.75 rho sin 45 / (cos 45 (15/8 - 7 rho/16))^2 with
// rho = 2 sqrt(cos 45) is 1.374466, so K 2500/1600 = 2.147603. J = 3 + 1.2 = 4.2 asks for
// sqrt(4.2 * 50^3 / 32000) = 4.050463, which no jerk leaves out. OPT-B.24
TEST(CornerSize, ByNormalAccelerationOrByJerk) {
  const double c = std::sqrt(0.5), rho = 2.0 * std::sqrt(c);
  const double k = 0.75 * rho * c / std::pow(c * (1.875 - 0.4375 * rho), 2);
  EXPECT_NEAR(Of(Lines(90)).CutFor(50.0, Trapezoids()), k * 2500.0 / 1600.0, 1e-12);
  EXPECT_NEAR(Of(Lines(90)).CutFor(50.0, StandardMachine()), std::sqrt(4.2 * 125000.0 / 32000.0),
              1e-12);
  MachineLimits machine = StandardMachine();
  machine.curve_normal = 0.2;  // 400 mm/s2
  EXPECT_NEAR(Of(Lines(90)).CutFor(50.0, machine), k * 2500.0 / 400.0, 1e-12);
  machine = StandardMachine();
  machine.curve_jerk = 0.1;  // 4000 mm/s3
  EXPECT_NEAR(Of(Lines(90)).CutFor(50.0, machine), std::sqrt(4.2 * 125000.0 / 4000.0), 1e-12);
}

// J(theta) = max(t min(3 + 1.2 t, 4.75), 1.04 K^2), t = tan(theta/2): the first up to 111 degrees,
// the second up to where K^2 takes over.
TEST(CornerSize, TurnsInJerk) {
  for (const double degrees : {0.01, 5.0, 60.0, 111.0, 112.0, 125.0, 150.0, 174.0}) {
    const double half = 0.5 * degrees * kRadPerDegree;
    const double t = std::tan(half), c = std::cos(half), rho = 2.0 * std::sqrt(c);
    const double k = 0.75 * rho * std::sin(half) / std::pow(c * (1.875 - 0.4375 * rho), 2);
    double j = t * (degrees < 111.5 ? 3.0 + 1.2 * t : 4.75);
    if (degrees > 140.0) j = 1.04 * k * k;
    MachineLimits machine = StandardMachine();
    machine.curve_normal = 1e6;
    const double cut = std::sqrt(j * 27000.0 / 32000.0);
    EXPECT_NEAR(Of(Lines(degrees)).CutFor(30.0, machine), cut, 1e-9 * cut) << degrees;
  }
}

// Case C15: sqrt(1.5 * 0.01 * 50^3 / 400) = 2.165064 by the jerk of the axis,
// 0.75 * 0.01 * 2500 / 20 = 0.9375 by its acceleration. A and B each by their own figures.
TEST(CornerSize, WhereTheHeadStartsToTurn) {
  for (const bool a : {true, false}) {
    const Corner corner = Of(HeadStarts(a));
    EXPECT_EQ(corner.passage(), Passage::kBlend);
    EXPECT_FALSE(corner.plain());
    MachineLimits machine = StandardMachine();
    EXPECT_NEAR(corner.CutFor(50.0, machine), 2.165063509, 1e-9);
    const std::size_t axis = a ? 3 : 4;
    machine.axes.jerk[axis] = 1600.0;
    EXPECT_NEAR(corner.CutFor(50.0, machine), 0.5 * 2.165063509, 1e-9);
    machine.axes.jerk[axis] = 1e6;
    EXPECT_NEAR(corner.CutFor(50.0, machine), 0.9375, 1e-12);
    machine.axes.acceleration[axis] = 5.0;
    EXPECT_NEAR(corner.CutFor(50.0, machine), 3.75, 1e-12);
    machine = StandardMachine();
    machine.axes.jerk[7 - axis] = machine.axes.acceleration[7 - axis] = 1e-3;  // of the other
    EXPECT_NEAR(corner.CutFor(50.0, machine), 2.165063509, 1e-9);
  }
}

// 1.2 |dk| w^3 / j_n, dk between an arc of R 20 and one of R 50 that bends the other way: 0.07.
// Half of the smaller radius is all that it may take.
TEST(CornerSize, WhereTheCurvatureJumps) {
  const PathPiece left = PathPiece::Circle({{50, 0, 0}}, {50, 20, 0}, {0, 0, 1}, 1.0, 0, 0);
  const MachinePoint end = left.to().point;
  const MachineVector out = (end - left.centre()) * (1.0 / 20.0);
  const PathPiece right = PathPiece::Circle({end}, end + out * 50.0, {0, 0, -1}, 1.0, 0, 0);
  for (const bool turned : {false, true}) {
    const Corner corner =
        turned ? Corner::Between(
                     PathPiece::Circle(right.tip_to(), right.centre(), {0, 0, 1}, 1.0, 0, 0),
                     PathPiece::Circle(left.tip_to(), left.centre(), {0, 0, -1}, 1.0, 0, 0))
               : Corner::Between(left, right);
    EXPECT_EQ(corner.passage(), Passage::kBlend);
    EXPECT_TRUE(corner.straight());
    EXPECT_FALSE(corner.lines());
    EXPECT_NEAR(corner.CutFor(60.0, StandardMachine()), 1.2 * 0.07 * 216000.0 / 32000.0, 1e-6);
    EXPECT_NEAR(corner.CutFor(60.0, Trapezoids()), 0.0, 1e-9);
    EXPECT_NEAR(corner.cut_max_mm(), 10.0, 1e-12);
  }
}

// docs/decisions/0015: without a limit on jerk a bend is as large as the acceleration asks, that of
// the tip or that of the head's axes, and goes with the square of OVERSH; the jerk of the axes does
// not count, either. So the manual's sentence holds that a lower OVERSH brings the path closer, and
// a bend that kept its size would break it. OPT-2.38, OPT-2.41
TEST(CornerSize, OvershAndNoLimitOnJerk) {
  const double c = std::sqrt(0.5), rho = 2.0 * std::sqrt(c);
  const double k = 0.75 * rho * c / std::pow(c * (1.875 - 0.4375 * rho), 2);
  for (const double overshoot : {1.0, 0.5, 0.1, 0.01}) {
    const double w = 50.0 * overshoot;
    const CornerReport angle = Passed(Lines(90), overshoot, Trapezoids());
    EXPECT_EQ(angle.passage, Passage::kBlend);
    EXPECT_NEAR(angle.wanted_speed, w, 1e-12);
    EXPECT_NEAR(angle.speed, w, 1e-9);
    EXPECT_NEAR(angle.cut_mm, k * w * w / 1600.0, 1e-12);
    EXPECT_NEAR(angle.deviation_mm, k * w * w / 1600.0 * c * (1.0 - 5.0 * rho / 16.0), 1e-12);
    for (const bool a : {true, false}) {
      const CornerReport head = Passed(HeadStarts(a), overshoot, Trapezoids());
      EXPECT_NEAR(head.cut_mm, w > 1.0 ? 0.75 * 0.01 * w * w / 20.0 : 0.0, 1e-12);
      // At 0.5 mm/s the curve would be 9.4e-5 mm: too small to be one.
      EXPECT_EQ(head.passage, w > 1.0 ? Passage::kBlend : Passage::kStopShort);
      EXPECT_NEAR(head.speed, w > 1.0 ? w : 0.0, 1e-9);
    }
  }
}

// With a limit on jerk the bend follows OVERSH by w^1.5 where jerk decides (4.3): OVERSH 25 makes
// an eighth.
TEST(CornerSize, OvershAndALimitOnJerk) {
  for (const double overshoot : {1.0, 0.25}) {
    const double w = 50.0 * overshoot;
    EXPECT_NEAR(Passed(Lines(90), overshoot, StandardMachine()).cut_mm,
                std::sqrt(4.2 * w * w * w / 32000.0), 1e-9);
    EXPECT_NEAR(Passed(HeadStarts(true), overshoot, StandardMachine()).cut_mm,
                std::sqrt(1.5 * 0.01 * w * w * w / 400.0), 1e-9);
  }
}

// The ends of OVERSH: 0 is a stop at the point, and so is less; 100 and more are Vb. Whatever the
// jerk. OPT-2.39, OPT-2.40
TEST(CornerSize, EndsOfOversh) {
  for (const MachineLimits& machine : {StandardMachine(), Trapezoids()}) {
    for (const double overshoot : {0.0, -0.0, -0.5}) {
      const CornerReport stop = Passed(Lines(90), overshoot, machine);
      EXPECT_EQ(stop.passage, Passage::kStopNoSpeed);
      EXPECT_EQ(stop.cut_mm, 0.0);
      EXPECT_EQ(stop.speed, 0.0);
      EXPECT_EQ(stop.deviation_mm, 0.0);
    }
    for (const double overshoot : {1.0, 1.5}) {
      EXPECT_EQ(Passed(Lines(90), overshoot, machine).wanted_speed, 50.0);
      EXPECT_EQ(Passed(Lines(0), overshoot, machine).speed, 50.0);
    }
    // The smallest share still passes, straight on too; but a bend of less than 1e-4 mm is a stop.
    EXPECT_NEAR(Passed(Lines(0), 1e-3, machine).speed, 0.05, 1e-12);
    EXPECT_EQ(Passed(Lines(0), 1e-3, machine).passage, Passage::kThrough);
    EXPECT_EQ(Passed(Lines(90), 5e-4, machine).passage, Passage::kStopShort);
  }
}

// A line into an arc, straight on. Without a limit on jerk there is nothing to size: no curve and
// no stop, the point is passed at OVERSH x Vb. OPT-B.23
TEST(CornerSize, CurvatureMayJumpWithoutALimitOnJerk) {
  const std::vector<PathPiece> pair = {
      PathPiece::Line({{0, 0, 0}}, {{50, 0, 0}}),
      PathPiece::Circle({{50, 0, 0}}, {50, 20, 0}, {0, 0, 1}, 1.5, 0, 0)};
  for (const double overshoot : {1.0, 0.4}) {
    const CornerReport passed = Passed(pair, overshoot, Trapezoids());
    EXPECT_EQ(passed.passage, Passage::kThrough);
    EXPECT_EQ(passed.cut_mm, 0.0);
    EXPECT_NEAR(passed.speed, 50.0 * overshoot, 1e-12);
    const CornerReport curve = Passed(pair, overshoot, StandardMachine());
    EXPECT_EQ(curve.passage, Passage::kBlend);
    EXPECT_NEAR(curve.cut_mm, 1.2 / 20.0 * 125000.0 * std::pow(overshoot, 3) / 32000.0, 1e-9);
  }
}

// d >= 1e-4 mm is a bend, less a stop at the point, at either side of 0.0001 by a thousandth: the
// trapezoid's K w^2 / 1600. motion.md 4.4
TEST(CornerSize, SmallestBend) {
  const double c = std::sqrt(0.5), rho = 2.0 * std::sqrt(c);
  const double k = 0.75 * rho * c / std::pow(c * (1.875 - 0.4375 * rho), 2);
  const double w = std::sqrt(1e-4 * 1600.0 / k);
  EXPECT_EQ(Passed(Lines(90), w * 1.001 / 50.0, Trapezoids()).passage, Passage::kBlend);
  EXPECT_EQ(Passed(Lines(90), w * 0.999 / 50.0, Trapezoids()).passage, Passage::kStopShort);
}

// motion.md 4.4: d < 1e-4 mm stops, so a run of 2e-4 mm, half of which is 1e-4 mm, has a bend.
TEST(CornerSize, SmallestBendIsItself) {
  const auto passage_behind = [](double length) {
    return Passed({PathPiece::Line({{0, 0, 0}}, {{length, 0, 0}}),
                   PathPiece::Line({{length, 0, 0}}, {{length, 100, 0}})},
                  1.0, Trapezoids())
        .passage;
  };
  EXPECT_EQ(passage_behind(1.999e-4), Passage::kStopShort);
  EXPECT_EQ(passage_behind(2e-4), Passage::kBlendCapped);
}

// d <= half of each adjacent run, exactly: 3 and 40 mm, either way round. Speed by 4.3's bounds.
TEST(CornerSize, HalfOfTheShorterNeighbour) {
  for (const bool short_first : {true, false}) {
    const double in = short_first ? 3.0 : 40.0, out = short_first ? 40.0 : 3.0;
    const std::vector<PathPiece> pair = {PathPiece::Line({{-in, 0, 0}}, {}),
                                         PathPiece::Line({}, {{0, out, 0}})};
    MachineLimits weak = Trapezoids();
    weak.tip_acceleration_mm_s2 = 600.0;  // K 2500 / 480 = 7.2 wanted
    weak.ramps_across_passages = false;
    const CornerReport report = Passed(pair, 1.0, weak);
    EXPECT_EQ(report.passage, Passage::kBlendCapped);
    EXPECT_NEAR(report.cut_mm, 1.5, 1e-12);
    const double c = std::sqrt(0.5), rho = 2.0 * std::sqrt(c);
    const double k = 0.75 * rho * c / std::pow(c * (1.875 - 0.4375 * rho), 2);
    EXPECT_NEAR(report.speed, std::sqrt(480.0 * 1.5 / k), 1e-9);
  }
}

// One direction is another from 1e-6 rad on. motion.md 1
TEST(CornerSize, StraightOnToAMillionth) {
  const auto at = [](double turn) {
    return Corner::Between(PathPiece::Line({{-1, 0, 0}}, {}),
                           PathPiece::Line({}, {{std::cos(turn), std::sin(turn), 0}}));
  };
  EXPECT_TRUE(at(0.99e-6).straight());
  EXPECT_EQ(at(0.99e-6).passage(), Passage::kThrough);
  EXPECT_FALSE(at(1.01e-6).straight());
  EXPECT_EQ(at(1.01e-6).passage(), Passage::kBlend);
}

// Every axis has to change its speed by less than the jump. motion.md section 7
TEST(JunctionSpeed, TheWorstAxisSetsIt) {
  const MachineVector in{0.6, 0.0, 0.8};
  for (const MachineVector& change : {MachineVector{0.5, 0.1, -0.2}, MachineVector{0.2, -0.5, 0.1},
                                      MachineVector{0.1, 0.2, -0.5}}) {
    EXPECT_NEAR(JunctionSpeed(in, in + change, 3.0), 6.0, 1e-12);
    EXPECT_NEAR(JunctionSpeed(in + change, in, 3.0), 6.0, 1e-12);
  }
  EXPECT_EQ(JunctionSpeed(in, in, 3.0), kNoLimit);
}

// Moves of COORD ROBOT, measured by the time that they take: 100 mm of X in 0.4 s, then of Y.
AxesCorner Robot(double acceleration_share, const MachineLimits& machine) {
  PathPiece in = PathPiece::Joint({{0, 0, 0}}, {{100, 0, 0}});
  PathPiece out = PathPiece::Joint({{100, 0, 0}}, {{100, 100, 0}});
  in.MeasureBy(0.4);
  out.MeasureBy(0.4);
  return AxesCorner(in, out, acceleration_share, machine);
}

// motion.md 4.5: T_b = max(1.5 w 250/(a 2000), sqrt(6 w 250/(a 40000))), half of it on each side,
// of which w is gone through; and the same turned round. Without a limit on jerk the second is
// none.
TEST(AxesCorner, TimeOfTheBend) {
  EXPECT_NEAR(Robot(1.0, StandardMachine()).CutFor(1.0), 0.5 * std::sqrt(0.0375), 1e-12);
  EXPECT_NEAR(Robot(0.5, StandardMachine()).CutFor(1.0), 0.5 * 0.375, 1e-12);
  EXPECT_NEAR(Robot(0.5, StandardMachine()).CutFor(0.4), 0.2 * std::sqrt(0.4 * 0.075), 1e-12);
  EXPECT_NEAR(Robot(1.0, Trapezoids()).CutFor(0.5), 0.25 * 1.5 * 0.5 * 0.125, 1e-12);
  EXPECT_NEAR(Robot(1.0, StandardMachine()).SpeedFor(0.02), std::cbrt(0.0016 / 0.0375), 1e-12);
  EXPECT_NEAR(Robot(0.5, StandardMachine()).SpeedFor(0.2), std::sqrt(0.4 / 0.375), 1e-12);
  EXPECT_NEAR(Robot(1.0, Trapezoids()).SpeedFor(0.02), std::sqrt(0.04 / 0.1875), 1e-12);
}

// Each axis by its own acceleration and jerk; the weakest decides.
TEST(AxesCorner, EveryAxisByItsOwnFigures) {
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    const auto along = [axis](double way) {
      AxisPose pose;
      (axis == 0   ? pose.column.x()
       : axis == 1 ? pose.column.y()
       : axis == 2 ? pose.column.z()
       : axis == 3 ? pose.a_rad
                   : pose.b_rad) = way;
      return pose;
    };
    MachineLimits machine = StandardMachine();
    machine.axes.acceleration[axis] = 3.0;
    machine.axes.jerk[axis] = 1e6;
    // From 2 to 5 units a second.
    PathPiece in = PathPiece::Joint(along(0), along(2)), out = PathPiece::Joint(along(2), along(7));
    EXPECT_NEAR(AxesCorner(in, out, 1.0, machine).CutFor(1.0), 0.5 * 1.5 * 3.0 / 3.0, 1e-12);
    machine.axes.acceleration[axis] = 1e6;
    machine.axes.jerk[axis] = 18.0;
    EXPECT_NEAR(AxesCorner(in, out, 1.0, machine).CutFor(1.0), 0.5, 1e-12);
  }
}

// A change of speed below 1e-6 of an axis' highest is none. A turn back is one of more than 175
// degrees between speeds as shares of the highest: X has 500 mm/s, A 2 pi rad/s.
// docs/decisions/0014
TEST(AxesCorner, StraightOnAndBackBothSides) {
  const auto passage = [](const AxisPose& first, const AxisPose& second) {
    const AxisPose start{{10, 10, 10}, 1, 1};
    const auto sum = [](const AxisPose& p, const AxisPose& q) {
      return AxisPose{p.column + q.column, p.a_rad + q.a_rad, p.b_rad + q.b_rad};
    };
    const AxisPose middle = sum(start, first);
    return AxesCorner(PathPiece::Joint(start, middle),
                      PathPiece::Joint(middle, sum(middle, second)), 1.0, StandardMachine())
        .passage();
  };
  EXPECT_EQ(passage({{100, 0, 0}}, {{100, 0.9 * 5e-4, 0}}), Passage::kThrough);
  EXPECT_EQ(passage({{100, 0, 0}}, {{100, 1.1 * 5e-4, 0}}), Passage::kBlend);
  EXPECT_EQ(passage({{100, 0, 0}}, {{100, 0, 0}, 0.9e-6 * kTurn, 0}), Passage::kThrough);
  EXPECT_EQ(passage({{100, 0, 0}}, {{100, 0, 0}, 0, 1.1e-6 * kTurn}), Passage::kBlend);
  for (const double degrees : {174.9, 175.1}) {
    const double turn = degrees * kRadPerDegree;
    const Passage expected = degrees > 175.0 ? Passage::kStopReversal : Passage::kBlend;
    EXPECT_EQ(passage({{300, 0, 0}}, {{50 * std::cos(turn), 0, 50 * std::sin(turn)}}), expected);
    EXPECT_EQ(
        passage({{0, 300, 0}}, {{0, 50 * std::cos(turn), 0}, 0.1 * kTurn * std::sin(turn), 0}),
        expected);
  }
}

}  // namespace
}  // namespace rmlcell::motion
