// What an axis has left for ramps is least somewhere along a line, at one of
// its ends only where that is proven: on very many lines no axis is ever asked
// for more. motion.md 5.1
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/motion/kinematics/axes.h"
#include "engine/motion/kinematics/axis_demand.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion::axis_room {
namespace {

constexpr int kPlaces = 48;

// A line on which the head turns, far from what the tip itself is allowed.
PathPiece TurningLine(Dice& dice, double turn_min, double turn_max) {
  const double turn = dice.Magnitude(turn_min, turn_max);
  const TipPose from{{0, 0, 0}, dice.Uniform(-3.0, 3.0), dice.Uniform(-2.0, 2.0)};
  return PathPiece::Line(from,
                         {dice.Direction() * dice.Magnitude(1.0, 400.0),
                          from.a_rad + (dice.Chance(0.2) ? 0.0 : dice.Uniform(-1.0, 1.0) * turn),
                          from.b_rad + (dice.Chance(0.2) ? 0.0 : dice.Uniform(-1.0, 1.0) * turn)});
}

// The least of the places along it; what lies between them is a little less.
PathLimits LeastOfPlaces(const PathPiece& line, const Head& head, const AxisLimits& axes,
                         PathLimits least, double speed) {
  for (int k = 0; k <= kPlaces; ++k) {
    const AxisDerivatives q = DerivativesAt(line, head, line.length() * k / kPlaces);
    for (const std::size_t i : kAxes) {
      const double first = std::abs(q.first[i]), second = std::abs(q.second[i]);
      if (first > 0.0) {
        const double room = axes.acceleration[i] - second * speed * speed;
        least.speed = std::min(least.speed, axes.speed[i] / first);
        least.acceleration = std::min(least.acceleration, room / first);
        least.jerk = std::min(least.jerk, axes.jerk[i] / first);
      }
      if (second > 0.0)
        least.speed = std::min(least.speed, std::sqrt(0.5 * axes.acceleration[i] / second));
    }
  }
  return least;
}

void ExpectWithin(int lines, std::uint64_t seed, double turn_min, double turn_max) {
  Dice dice(seed);
  for (int k = 0; k < lines; ++k) {
    MoveCommand move;
    move.path = TurningLine(dice, turn_min, turn_max);
    move.head = GantryHead{
        .tool = {dice.Uniform(-90.0, 90.0), dice.Uniform(-90.0, 90.0), dice.Uniform(0.0, 250.0)}};
    move.speed_fraction = dice.Magnitude(0.01, 1.0);
    MachineLimits machine = StandardMachine();
    for (const std::size_t i : kLinearAxes) {
      machine.axes.acceleration[i] = dice.Magnitude(50.0, 4000.0);
      machine.axes.jerk[i] = dice.Magnitude(1000.0, 80000.0);
    }
    machine.axes.speed[3] = machine.axes.speed[4] = 60.0;
    machine.axes.acceleration[3] = machine.axes.acceleration[4] = 2000.0;
    machine.axes.jerk[3] = machine.axes.jerk[4] = 1e6;
    const PathLimits limits = LimitsOf(move, machine);
    const PathLimits least =
        LeastOfPlaces(move.path, move.head, machine.axes, TipLimits(move, machine), limits.speed);
    ASSERT_LE(limits.speed, least.speed * (1.0 + 1e-9)) << k;
    ASSERT_LE(limits.acceleration, least.acceleration * (1.0 + 1e-4)) << k;
    ASSERT_LE(limits.jerk, least.jerk * (1.0 + 1e-9)) << k;
    ASSERT_GE(limits.speed, least.speed * 0.985) << k;
    ASSERT_GE(limits.jerk, least.jerk * 0.985) << k;
  }
}

TEST(AxisRoom, IsNeverTakenTwiceWhereTheHeadTurnsFar) { ExpectWithin(6000, 71, 0.4, 4.0); }

TEST(AxisRoom, IsNeverTakenTwiceWhereTheHeadTurnsLittle) { ExpectWithin(6000, 72, 0.01, 0.4); }

}  // namespace
}  // namespace rmlcell::motion::axis_room
