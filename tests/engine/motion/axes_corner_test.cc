// Passages between moves in COORD ROBOT: motion.md 4.5.
#include "engine/motion/corner/axes_corner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/motion/ride/trajectory.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

MoveCommand InAxes(const AxisPose& from, const AxisPose& to, double speed, bool fly = true) {
  MoveCommand move;
  move.kind = MoveCommand::Kind::kPointToPointAxes;
  move.path = PathPiece::Joint(from, to);
  move.speed_fraction = speed;
  move.fly = fly;
  return move;
}

std::vector<PlannedMotion> PlanOf(const std::vector<MoveCommand>& chain,
                                  const MachineLimits& machine = StandardMachine()) {
  Planner planner(machine);
  for (const MoveCommand& move : chain) EXPECT_TRUE(planner.Append(move));
  planner.Stop();
  std::vector<PlannedMotion> motions;
  while (const auto item = planner.Next()) motions.push_back(std::get<PlannedMotion>(*item));
  return motions;
}

double CycleTime(const std::vector<PlannedMotion>& motions) {
  LongSum sum;
  for (const PlannedMotion& motion : motions) sum.Add(motion.duration_s());
  return sum.value();
}

CornerReport FirstCorner(const std::vector<PlannedMotion>& motions) {
  for (const PlannedMotion& motion : motions) {
    if (motion.ends_move) return motion.corner;
  }
  return {};
}

const AxisPose kHere{{0, 0, 0}};
const AxisPose kEast{{1000, 0, 0}};
const AxisPose kNorthEast{{1000, 1000, 0}};

// X at 250 mm/s, then Y: the speeds of both axes change by 250, T_b = max(1.5 x 250 / 2000,
// sqrt(6 x 250 / 40000)) = 0.193649 s, the deviation of each axis 3/32 T_b 250 = 4.538655 mm. Each
// move takes 4 s at full speed and its ramp from or to rest half of 250/2000 + 2000/40000 more.
TEST(AxesCorner, RightAngle) {
  const auto motions = PlanOf({InAxes(kHere, kEast, 0.5), InAxes(kEast, kNorthEast, 0.5, false)});
  ASSERT_EQ(motions.size(), 4u);
  const double bend_s = std::sqrt(6.0 * 250.0 / 40000.0);
  EXPECT_EQ(motions[1].corner.passage, Passage::kBlend);
  EXPECT_NEAR(motions[1].duration_s() + motions[2].duration_s(), bend_s, 1e-12);
  EXPECT_NEAR(motions[0].path.to().point.x(), 1000.0 - 250.0 * 0.5 * bend_s, 1e-9);
  EXPECT_NEAR(motions[3].path.from().point.y(), 250.0 * 0.5 * bend_s, 1e-9);
  const double deviation = 3.0 / 32.0 * bend_s * 250.0;
  EXPECT_NEAR(motions[1].path.to().point.x(), 1000.0 - deviation, 1e-9);
  EXPECT_NEAR(motions[1].path.to().point.y(), deviation, 1e-9);
  EXPECT_NEAR(motions[1].corner.deviation_mm, std::sqrt(2.0) * deviation, 1e-9);
  EXPECT_NEAR(CycleTime(motions), 8.0 + (250.0 / 2000.0 + 2000.0 / 40000.0) + 0.048, 1e-9);
}

// By time the speeds go over by 3u^2 - 2u^3: at a quarter of T_b X has lost 5/32 of its speed.
TEST(AxesCorner, SpeedsGoOverSmoothly) {
  const auto motions = PlanOf({InAxes(kHere, kEast, 0.5), InAxes(kEast, kNorthEast, 0.5, false)});
  const MotionView first_half(motions[1]);
  const TrajectoryPoint at = first_half.At(0.5 * motions[1].duration_s());
  EXPECT_NEAR(at.axis_velocity[0], 250.0 * 27.0 / 32.0, 1e-9);
  EXPECT_NEAR(at.axis_velocity[1], 250.0 * 5.0 / 32.0, 1e-9);
  const TrajectoryPoint middle = first_half.At(motions[1].duration_s());
  EXPECT_NEAR(middle.axis_acceleration[1], 1.5 * 250.0 / std::sqrt(0.0375), 1e-7);
}

// OVERSH 50 halves both speeds: T_b = sqrt(6 x 125 / 40000). OVERSH 0 stops without settling.
TEST(AxesCorner, OvershSetsTheShare) {
  MoveCommand east = InAxes(kHere, kEast, 0.5);
  east.overshoot_fraction = 0.5;
  auto motions = PlanOf({east, InAxes(kEast, kNorthEast, 0.5, false)});
  const double bend_s = std::sqrt(6.0 * 125.0 / 40000.0);
  EXPECT_NEAR(FirstCorner(motions).deviation_mm, std::sqrt(2.0) * 3.0 / 32.0 * bend_s * 125.0,
              1e-9);
  EXPECT_NEAR(FirstCorner(motions).speed, 0.5, 1e-12);
  east.overshoot_fraction = 0.0;
  motions = PlanOf({east, InAxes(kEast, kNorthEast, 0.5, false)});
  EXPECT_EQ(FirstCorner(motions).passage, Passage::kStopNoSpeed);
  EXPECT_NEAR(CycleTime(motions), 8.0 + 2.0 * (250.0 / 2000.0 + 2000.0 / 40000.0) + 0.048, 1e-9);
}

// ACCEL counts here, unlike in bends of the tip: T_b = max(1.5 x 250/200, sqrt(6 x 250/4000)).
TEST(AxesCorner, LowAccelerationOpensTheCorner) {
  MoveCommand north = InAxes(kEast, kNorthEast, 0.5, false);
  north.acceleration_fraction = 0.1;
  const auto motions = PlanOf({InAxes(kHere, kEast, 0.5), north});
  EXPECT_NEAR(FirstCorner(motions).deviation_mm,
              std::sqrt(2.0) * 3.0 / 32.0 * (1.5 * 250.0 / 200.0) * 250.0, 1e-9);
}

// More than all of it is all of it.
TEST(AxesCorner, NoAccelerationAboveAll) {
  const auto deviation = [](double accel) {
    std::vector<MoveCommand> chain{InAxes(kHere, kEast, 0.5),
                                   InAxes(kEast, kNorthEast, 0.5, false)};
    for (MoveCommand& move : chain) move.acceleration_fraction = accel;
    return FirstCorner(PlanOf(chain)).deviation_mm;
  };
  EXPECT_NEAR(deviation(1.0),
              std::sqrt(2.0) * 3.0 / 32.0 * std::sqrt(6.0 * 250.0 / 40000.0) * 250.0, 1e-9);
  EXPECT_NEAR(deviation(1.5), deviation(1.0), 1e-9);
}

// Rotary axes take part alike. A turns at its highest speed: T_b by its jerk, sqrt(6 x 2 pi / 400).
TEST(AxesCorner, RotaryAxesTakePart) {
  const auto motions = PlanOf({InAxes(kHere, {{0, 0, 0}, 6.0, 0.0}, 1.0),
                               InAxes({{0, 0, 0}, 6.0, 0.0}, {{0, 0, 0}, 6.0, 2.0}, 1.0, false)});
  ASSERT_EQ(FirstCorner(motions).passage, Passage::kBlendCapped);
  // B has a way of 2 rad, 1/pi s at full speed: reach and half of the way lower the share.
  const double share = FirstCorner(motions).speed;
  const double bend_s =
      std::max(1.5 * share * kTurn / 20.0, std::sqrt(6.0 * share * kTurn / 400.0));
  EXPECT_NEAR(share * bend_s, 0.5 / kPi, 1e-9);
  EXPECT_NEAR(motions[1].path.to().a_rad, 6.0 - 3.0 / 32.0 * bend_s * share * kTurn, 1e-9);
}

// Y goes 20 mm, 0.08 s at full speed. The bend may last as long as half of that takes: its share w
// of full speed follows from w T_b = 0.04, w = cbrt(4 x 0.02^2 / (6 x 250/40000)).
TEST(AxesCorner, ShortNeighbourLowersBothSpeeds) {
  const auto motions =
      PlanOf({InAxes(kHere, kEast, 0.5), InAxes(kEast, {{1000, 20, 0}}, 0.5, false)});
  const CornerReport corner = FirstCorner(motions);
  EXPECT_EQ(corner.passage, Passage::kBlendCapped);
  EXPECT_NEAR(corner.speed, std::cbrt(4.0 * 0.02 * 0.02 / 0.0375), 1e-9);
  EXPECT_NEAR(motions[1].path.from().point.x(), 1000.0 - 250.0 * 0.02, 1e-9);
  EXPECT_NEAR(motions[2].path.to().point.y(), 5.0, 1e-9);
}

// From 500 to 100 mm/s on one line: speeds change, and yet the target lies on the way.
TEST(AxesCorner, OnALineNothingDeviates) {
  const auto motions =
      PlanOf({InAxes(kHere, kEast, 1.0), InAxes(kEast, {{2000, 0, 0}}, 0.2, false)});
  EXPECT_EQ(FirstCorner(motions).passage, Passage::kBlend);
  EXPECT_NEAR(FirstCorner(motions).deviation_mm, 0.0, 1e-6);
}

// A move cut in two goes through as one; where its axes turn back it stops, motion.md 4.4.
TEST(AxesCorner, StraightOnAndBack) {
  const AxisPose to{{900, 300, -60}, 0.9, 0.3};
  const AxisPose third{{300, 100, -20}, 0.3, 0.1};
  const auto whole = PlanOf({InAxes(kHere, to, 0.4, false)});
  const auto parts = PlanOf({InAxes(kHere, third, 0.4), InAxes(third, to, 0.4, false)});
  EXPECT_EQ(FirstCorner(parts).passage, Passage::kThrough);
  EXPECT_NEAR(CycleTime(parts), CycleTime(whole), 1e-9);
  const auto back = PlanOf({InAxes(kHere, to, 0.4), InAxes(to, third, 0.4, false)});
  EXPECT_EQ(FirstCorner(back).passage, Passage::kStopReversal);
  const auto mixed = PlanOf({InAxes(kHere, kEast, 0.4), [] {
                               MoveCommand line;
                               line.path = PathPiece::Line({{1000, 0, 0}}, {{1000, 1000, 0}});
                               return line;
                             }()});
  EXPECT_EQ(FirstCorner(mixed).passage, Passage::kStopNeighbour);
}

// motion.md 1 and 4.5: a change of up to 1e-6 of the speed of an axis is none, of any of them.
TEST(AxesCorner, TheLeastChangeOfSpeed) {
  MachineLimits machine = StandardMachine();
  machine.axes.speed.fill(1e6);
  for (int axis = 0; axis < kAxisCount; ++axis) {
    const auto passage = [&](double speed) {  // 3 of every axis, then 3 of all but this one
      const AxisPose to{{3, 3, 3}, 3, 3};
      AxisPose beyond{{6, 6, 6}, 6, 6};
      (axis == 0   ? beyond.column.x()
       : axis == 1 ? beyond.column.y()
       : axis == 2 ? beyond.column.z()
       : axis == 3 ? beyond.a_rad
                   : beyond.b_rad) = 3 + speed;
      return AxesCorner(PathPiece::Joint({}, to), PathPiece::Joint(to, beyond), 1.0, machine)
          .passage();
    };
    EXPECT_EQ(passage(4.0), Passage::kThrough) << axis;
    EXPECT_EQ(passage(2.0), Passage::kThrough) << axis;
    EXPECT_EQ(passage(4.0625), Passage::kBlend) << axis;
    EXPECT_EQ(passage(1.9375), Passage::kBlend) << axis;
  }
  const auto along_x = [&](double speed) {
    return AxesCorner(PathPiece::Joint({}, {{2, 0, 0}}),
                      PathPiece::Joint({{2, 0, 0}}, {{2 + speed, 0, 0}}), 1.0, machine)
        .passage();
  };
  EXPECT_EQ(along_x(-1.0), Passage::kStopReversal);
}

// motion.md 4.5: T_b = max(1.5 w dq/(alpha A), sqrt(6 w dq/(alpha J))), a cut of w T_b / 2, and
// back.
TEST(AxesCorner, CutAndShareBelongTogether) {
  MachineLimits machine = StandardMachine();
  machine.axes.acceleration.fill(2000.0);
  machine.axes.jerk.fill(40000.0);
  const PathPiece before = PathPiece::Joint({}, {{250, 0, 0}});
  const PathPiece after = PathPiece::Joint({{250, 0, 0}}, {{250, 250, 0}});
  for (const double alpha : {1.0, 0.1}) {
    const AxesCorner corner(before, after, alpha, machine);
    EXPECT_EQ(corner.passage(), Passage::kBlend);
    for (const double w : {0.01, 0.5, 1.0}) {
      const double bend_s = std::max(1.5 * w * 250.0 / (alpha * 2000.0),
                                     std::sqrt(6.0 * w * 250.0 / (alpha * 40000.0)));
      EXPECT_NEAR(corner.CutFor(w), 0.5 * w * bend_s, 1e-15);
      EXPECT_NEAR(corner.SpeedFor(corner.CutFor(w)), w, 1e-12);
    }
  }
  machine.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  const AxesCorner abrupt(before, after, 1.0, machine);
  EXPECT_NEAR(abrupt.CutFor(0.5), 0.25 * 1.5 * 0.5 * 250.0 / 2000.0, 1e-15);
  EXPECT_NEAR(abrupt.SpeedFor(abrupt.CutFor(0.5)), 0.5, 1e-12);
  EXPECT_EQ(abrupt.SpeedFor(0.0), 0.0);
}

std::vector<MoveCommand> RandomAxesChain(Dice& dice) {
  std::vector<MoveCommand> chain;
  const int count = static_cast<int>(dice.Uniform(1.0, 12.0));
  const auto pose = [&] {
    return AxisPose{{dice.Uniform(-500, 3500), dice.Uniform(-500, 3000), dice.Uniform(-1200, 1000)},
                    dice.Uniform(-6, 6),
                    dice.Uniform(-2, 2)};
  };
  AxisPose at = pose();
  double share = 0.5, acceleration = 1.0, overshoot = 1.0;
  for (int k = 0; k < count; ++k) {
    const AxisPose far = pose();
    const double part = dice.Magnitude(1e-3, 1.0);  // of the way there
    const AxisPose to{at.column + (far.column - at.column) * part,
                      at.a_rad + (far.a_rad - at.a_rad) * part,
                      at.b_rad + (far.b_rad - at.b_rad) * part};
    if (dice.Chance(0.3)) share = dice.Magnitude(0.01, 1.0);
    if (dice.Chance(0.2)) acceleration = dice.Magnitude(0.05, 1.0);
    if (dice.Chance(0.2)) overshoot = dice.Uniform(0.0, 1.0);
    MoveCommand move = InAxes(at, to, share, dice.Chance(0.9));
    move.acceleration_fraction = acceleration;
    move.overshoot_fraction = overshoot;
    chain.push_back(move);
    at = to;
  }
  return chain;
}

// motion.md section 10, properties 1, 2, 3 and 5 for chains of the axes, from where they are at
// times close to each other.
TEST(AxesCorner, RandomChainsKeepTheLimitsOfEveryAxis) {
  for (int seed = 1; seed <= 400; ++seed) {
    Dice dice(static_cast<std::uint64_t>(seed));
    MachineLimits machine = StandardMachine();
    if (dice.Chance(0.25)) machine.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
    const std::vector<MoveCommand> chain = RandomAxesChain(dice);
    const auto motions = PlanOf(chain, machine);
    AxisPose last{};
    bool first = true;
    for (const PlannedMotion& motion : motions) {
      ASSERT_TRUE(motion.path.in_axes());
      const MotionView view(motion);
      const TrajectoryPoint begin = view.At(0.0);
      if (!first) {
        EXPECT_NEAR((begin.axes.head<3>() - last.column).norm(), 0, 1e-9);
        EXPECT_NEAR(begin.axes[3], last.a_rad, 1e-12) << seed;
      }
      first = false;
      const double moving = motion.speed.duration_s();
      const double h = std::min(1e-4, moving / 8);
      for (int k = 0; h > 1e-6 && k <= 60; ++k) {
        const double t = std::clamp(moving * k / 60.0, h, moving - h);
        const AxisValues p0 = view.At(t - h).axes, p1 = view.At(t).axes, p2 = view.At(t + h).axes;
        for (std::size_t i = 0; i < kAxisCount; ++i) {
          const double speed = std::abs(p2[i] - p0[i]) / (2 * h);
          const double acceleration = std::abs(p2[i] - 2 * p1[i] + p0[i]) / (h * h);
          EXPECT_LE(speed, machine.axes.speed[i] * (1 + 1e-9) + 1e-12 / h) << seed;
          EXPECT_LE(acceleration, machine.axes.acceleration[i] * (1 + 1e-6) + 8e-12 / (h * h))
              << seed;
        }
      }
      const TrajectoryPoint end = view.At(motion.duration_s());
      last = {{end.axes[0], end.axes[1], end.axes[2]}, end.axes[3], end.axes[4]};
    }
    const AxisPose target = chain.back().path.axes_to();
    EXPECT_NEAR((last.column - target.column).norm(), 0.0, 1e-9) << seed;
    EXPECT_NEAR(last.b_rad, target.b_rad, 1e-12) << seed;

    std::vector<MoveCommand> flown = chain;
    for (MoveCommand& move : flown) {
      move.fly = true;
      move.overshoot_fraction = 1.0;
    }
    std::vector<MoveCommand> back(flown.rbegin(), flown.rend());
    for (MoveCommand& move : back)
      move.path = PathPiece::Joint(move.path.axes_to(), move.path.axes_from());
    const double forth = CycleTime(PlanOf(flown, machine));
    EXPECT_NEAR(CycleTime(PlanOf(back, machine)), forth, 1e-9 * forth) << seed;
  }
}

}  // namespace
}  // namespace rmlcell::motion
