#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/motion/kinematics/axis_demand.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

MoveCommand Contour(const TipPose& from, const TipPose& to, double speed) {
  MoveCommand move;
  move.path = PathPiece::Line(from, to);
  move.speed_fraction = speed;
  return move;
}

// OPT-B.21: SPEED and ACCEL scale the tip's figures; the axes may lower them. A diagonal in XY asks
// each axis for 1/sqrt(2), so nothing lowers it.
TEST(LimitsOf, StraightLine) {
  MoveCommand move = Contour({}, {{100, 100, 0}}, 0.5);
  move.acceleration_fraction = 0.25;
  const PathLimits limits = LimitsOf(move, StandardMachine());
  EXPECT_DOUBLE_EQ(limits.speed, 250.0);
  EXPECT_DOUBLE_EQ(limits.acceleration, 500.0);
  EXPECT_DOUBLE_EQ(limits.jerk, 10000.0);
}

// OPT-2.16: 1 mm with A turning 3.14 rad about the upright head lasts at least 3.14 / (2 pi).
TEST(LimitsOf, RotaryAxisSlowsTheTip) {
  const PathLimits limits = LimitsOf(Contour({}, {{1, 0, 0}, 3.14, 0}, 1.0), StandardMachine());
  EXPECT_NEAR(limits.speed, kTurn / 3.14, 1e-9);
  EXPECT_NEAR(limits.acceleration, 20.0 / 3.14, 1e-9);
  EXPECT_NEAR(limits.jerk, 400.0 / 3.14, 1e-9);
}

// motion.md 5.1 on an arc of radius 5 in the XY plane: V = sqrt(0.5 * 2000 * 5) by the axes, below
// sqrt(1600 * 5) and cbrt(32000 * 25) = 92.8. Along it a = 0.6 * 2000, since the axes allow
// sqrt(2000^2 - 1000^2) where their share is worst.
TEST(LimitsOf, ArcByItsRadius) {
  MoveCommand move;
  move.path = PathPiece::Circle({{5, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0, 0);
  const PathLimits limits = LimitsOf(move, StandardMachine());
  EXPECT_NEAR(limits.speed, std::sqrt(5000.0), 1e-9);
  EXPECT_DOUBLE_EQ(limits.acceleration, 1200.0);
  EXPECT_DOUBLE_EQ(limits.jerk, 40000.0);
  MachineLimits weak = StandardMachine();
  weak.axes.acceleration = {1000, 2000, 2000, 20, 20};  // sqrt(1000^2 - 500^2) where cos = 0.5
  EXPECT_NEAR(LimitsOf(move, weak).acceleration, std::sqrt(750000.0), 1e-6);
  EXPECT_NEAR(LimitsOf(move, weak).speed, std::sqrt(2500.0), 1e-9);
}

// A small circle is limited by jerk: cbrt(32000 * 0.01^2) at R = 0.01.
TEST(LimitsOf, TinyArcByJerk) {
  MoveCommand move;
  move.path = PathPiece::Circle({{0.01, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0, 0);
  EXPECT_NEAR(LimitsOf(move, StandardMachine()).speed, std::cbrt(3.2), 1e-12);
}

// The extremes found along a move where both angles turn are those of a dense search.
// motion.md 5.1.
TEST(LimitsOf, ExtremesAlongTheMoveAreExact) {
  const MachineLimits machine = StandardMachine();
  for (const double turn : {0.3, 2.0, 9.0}) {
    const MoveCommand move = Contour({{0, 0, 0}, 0.1, -0.7}, {{40, -25, 10}, 0.1 + turn, 0.9}, 1.0);
    const PathLimits limits = LimitsOf(move, machine);
    double speed = 500.0;
    double acceleration = 2000.0;
    for (int pass = 0; pass < 2; ++pass) {
      for (int k = 0; k <= 200000; ++k) {
        const AxisDerivatives q =
            DerivativesAt(move.path, move.head, move.path.length() * k / 200000);
        for (std::size_t i = 0; i < kAxisCount; ++i) {
          const double q1 = std::abs(q.first[i]), q2 = std::abs(q.second[i]);
          if (pass == 0) {
            speed = std::min({speed, machine.axes.speed[i] / q1,
                              std::sqrt(0.5 * machine.axes.acceleration[i] / q2)});
          } else {
            acceleration =
                std::min(acceleration, (machine.axes.acceleration[i] - q2 * speed * speed) / q1);
          }
        }
      }
    }
    EXPECT_NEAR(limits.speed, speed, 1e-8 * speed);
    EXPECT_NEAR(limits.acceleration, acceleration, 1e-7 * acceleration);
  }
}

// The same on arcs on which the head turns, some of them for several rounds: 16 to 800 places are
// looked at, and most axes not searched.
TEST(LimitsOf, ExtremesAlongArcsAreExact) {
  const MachineLimits machine = StandardMachine();
  MachineLimits tip_alone = machine;
  tip_alone.axes.speed.fill(1e12);
  tip_alone.axes.acceleration.fill(1e12);
  tip_alone.axes.jerk.fill(1e12);
  const TipPose from{{1000.0, 900.0, -200.0}, -0.4, 0.3};
  const MachineVector normal = MachineVector{0.3, -0.5, 0.8} * (1.0 / std::sqrt(0.98));
  const MachineVector out = MachineVector{0.8, 0.0, -0.3} * (1.0 / std::sqrt(0.73));
  for (const double radius : {2.0, 60.0, 400.0}) {
    for (const double sweep : {0.2, 2.0, 6.0, 36.0}) {
      for (const double turn : {0.05, 1.2, 3.0}) {
        MoveCommand move;
        move.path = PathPiece::Circle(from, from.tip + out * radius, normal, sweep,
                                      from.a_rad + turn, from.b_rad - 0.4 * turn);
        const PathLimits limits = LimitsOf(move, machine);
        const PathLimits most = LimitsOf(move, tip_alone);
        double asked = 1.0 / most.speed;
        double jerk = most.jerk;
        double acceleration = most.acceleration;
        constexpr int kPlaces = 20000;
        for (int k = 0; k <= kPlaces; ++k) {
          const AxisDerivatives q =
              DerivativesAt(move.path, move.head, move.path.length() * k / kPlaces);
          for (std::size_t i = 0; i < kAxisCount; ++i) {
            const double q1 = std::abs(q.first[i]), q2 = std::abs(q.second[i]);
            asked = std::max({asked, q1 / machine.axes.speed[i],
                              std::sqrt(q2 / (0.5 * machine.axes.acceleration[i]))});
            jerk = std::min(jerk, machine.axes.jerk[i] / q1);
            const double taken = q2 * limits.speed * limits.speed;
            acceleration = std::min(acceleration, (machine.axes.acceleration[i] - taken) / q1);
          }
        }
        constexpr double kBetweenPlaces = 2e-6;  // what a peak is above the places beside it
        EXPECT_NEAR(limits.speed * asked, 1.0, kBetweenPlaces);
        EXPECT_NEAR(limits.jerk / jerk, 1.0, kBetweenPlaces);
        EXPECT_NEAR(limits.acceleration / acceleration, 1.0, kBetweenPlaces);
        EXPECT_LE(limits.speed * asked, 1.0 + 1e-9);
        EXPECT_LE(limits.jerk / jerk, 1.0 + 1e-9);
        EXPECT_LE(limits.acceleration / acceleration, 1.0 + 1e-9);
      }
    }
  }
}

// OPT-2.14: positioning in ABSOL asks only the axes: on a diagonal the tip is faster than SPEED of
// VMAX.
TEST(LimitsOf, PositioningByTheAxesAlone) {
  MoveCommand move = Contour({}, {{300, 300, 0}}, 0.4);
  move.kind = MoveCommand::Kind::kPointToPointTip;
  move.acceleration_fraction = 0.5;
  const PathLimits limits = LimitsOf(move, StandardMachine());
  EXPECT_NEAR(limits.speed, 0.4 * 500.0 * std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(limits.acceleration, 0.5 * 2000.0 * std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(limits.jerk, 0.5 * 40000.0 * std::sqrt(2.0), 1e-9);
}

// A rotary-only move uses the rule of positioning. OPT-2.17. B over 1.5708 rad swings the column by
// 300 mm times that: 471.24 mm, so Z and Y ask for 500 / 471.24 per sigma where they run fastest.
TEST(LimitsOf, RotaryOnly) {
  const PathLimits limits =
      LimitsOf(Contour({{1, 2, 3}, 0, 0}, {{1, 2, 3}, 0, kPi / 2}, 1.0), StandardMachine());
  const double swing = 300.0 * kPi / 2;
  const double whirl = 300.0 * kPi * kPi / 4;
  EXPECT_NEAR(limits.speed, std::min(500.0 / swing, std::sqrt(1000.0 / whirl)), 1e-9);
}

TEST(LimitsOf, WithoutJerkLimit) {
  MachineLimits machine = StandardMachine();
  machine.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isinf(LimitsOf(Contour({}, {{9, 0, 0}}, 1.0), machine).jerk));
  EXPECT_TRUE(std::isinf(LimitsOf(Contour({}, {{9, 0, 0}, 1, 1}, 1.0), machine).jerk));
  EXPECT_TRUE(std::isinf(LimitsOf(Contour({}, {{0, 0, 0}, 1, 1}, 1.0), machine).jerk));
  // A short turn, and slow axes: limits from a few places.
  const MoveCommand turn = Contour({}, {{9, 0, 0}, 0.001, 0.001}, 1.0);
  machine.axes.speed.fill(1.0);
  EXPECT_LT(LimitsOf(turn, machine).speed, 1.0);
  EXPECT_TRUE(std::isinf(LimitsOf(turn, machine).jerk));
  // A whole search.
  EXPECT_TRUE(std::isinf(LimitsOf(Contour({}, {{9, 0, 0}, 1, 1}, 1.0), machine).jerk));
}

// The fractions are those of the tip, and no more than all of it.
TEST(TipLimits, AreSharesOfTheMachine) {
  MoveCommand move;
  move.speed_fraction = 0.25;
  move.acceleration_fraction = 0.5;
  const PathLimits some = TipLimits(move, StandardMachine());
  EXPECT_EQ(some.speed, 125.0);
  EXPECT_EQ(some.acceleration, 1000.0);
  EXPECT_EQ(some.jerk, 20000.0);
  move.speed_fraction = move.acceleration_fraction = 1.5;
  const PathLimits all = TipLimits(move, StandardMachine());
  EXPECT_EQ(all.speed, 500.0);
  EXPECT_EQ(all.acceleration, 2000.0);
  EXPECT_EQ(all.jerk, 40000.0);
}

// The same on lines, short and long, on which either angle or both turn, through the upright head:
// what the ends alone tell is what there is. motion.md 5.1
TEST(LimitsOf, ExtremesAlongLinesAreExact) {
  const MachineLimits machine = StandardMachine();
  constexpr int kPlaces = 4000;
  constexpr double kBetweenPlaces = 2e-6;  // what a peak is above the places beside it
  for (const double length : {3.0, 40.0, 700.0}) {
    for (const double a_turn : {-2.5, 0.0, 0.7, 3.0}) {
      for (const double b_turn : {-1.1, 0.4, 1.6}) {
        SCOPED_TRACE(testing::Message() << length << " mm, " << a_turn << ", " << b_turn);
        const MachinePoint to{1000.0 + 0.48 * length, 900.0 - 0.6 * length, -200.0 + 0.64 * length};
        const MoveCommand move =
            Contour({{1000.0, 900.0, -200.0}, 0.2, -0.6}, {to, 0.2 + a_turn, -0.6 + b_turn}, 1.0);
        const PathLimits limits = LimitsOf(move, machine);
        double speed = 500.0;
        double acceleration = 2000.0;
        double jerk = 40000.0;
        for (int k = 0; k <= kPlaces; ++k) {
          const AxisDerivatives q =
              DerivativesAt(move.path, move.head, move.path.length() * k / kPlaces);
          for (std::size_t i = 0; i < kAxisCount; ++i) {
            const double q1 = std::abs(q.first[i]), q2 = std::abs(q.second[i]);
            speed = std::min({speed, machine.axes.speed[i] / q1,
                              std::sqrt(0.5 * machine.axes.acceleration[i] / q2)});
            jerk = std::min(jerk, machine.axes.jerk[i] / q1);
            const double taken = q2 * limits.speed * limits.speed;
            acceleration = std::min(acceleration, (machine.axes.acceleration[i] - taken) / q1);
          }
        }
        EXPECT_NEAR(limits.speed / speed, 1.0, kBetweenPlaces);
        EXPECT_NEAR(limits.acceleration / acceleration, 1.0, kBetweenPlaces);
        EXPECT_NEAR(limits.jerk / jerk, 1.0, kBetweenPlaces);
      }
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion
