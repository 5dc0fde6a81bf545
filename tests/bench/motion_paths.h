#pragma once

#include <cmath>
#include <vector>

#include "tests/engine/motion/random_chain.h"

// Paths that the benches of the planner share.
namespace rmlcell::motion {

// A closed wavy contour in short lines, as a CAD system writes it; with `head` the beam follows the
// normal. 600 lines go round once, 2.5 mm each in the mean.
inline std::vector<MoveCommand> Contour(int count, bool head, double speed_fraction = 0.06) {
  std::vector<MoveCommand> chain;
  const auto at = [&](int k) {
    const double t = kTurn * k / 600.0;
    const double r = 200.0 + 20.0 * std::sin(7 * t);
    TipPose pose{
        {1000.0 + r * std::cos(t), 900.0 + r * std::sin(t), -200.0 + 5.0 * std::sin(3 * t)}, 0, 0};
    if (head) {
      pose.a_rad = 0.3 * std::sin(2 * t);
      pose.b_rad = 0.5 + 0.2 * std::cos(3 * t);
    }
    return pose;
  };
  for (int k = 0; k < count; ++k) {
    MoveCommand move;
    move.path = PathPiece::Line(at(k), at(k + 1));
    move.speed_fraction = speed_fraction;
    move.fly = true;
    move.tag = static_cast<std::uint64_t>(k);
    chain.push_back(move);
  }
  return chain;
}

// The walk of the speed goals: lines of 0.05 to 2 mm whose heading changes by a normal of 0.35 rad,
// with a little Z, at 25 mm/s, 3,000 mm/s2 and 50,000 mm/s3. With `head` A and B step by up to a
// degree a line.
inline MachineLimits WalkMachine() {
  MachineLimits machine = StandardMachine();
  machine.tip_acceleration_mm_s2 = 3000.0;
  machine.tip_jerk_mm_s3 = 50000.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    machine.axes.acceleration[axis] = 3000.0;
    machine.axes.jerk[axis] = 50000.0;
  }
  return machine;
}
inline std::vector<MoveCommand> Walk(int count, bool head) {
  constexpr double kHeading_rad = 0.35;
  constexpr double kStep_rad = kPi / 180.0;
  constexpr double kSpeed_mm_s = 25.0;
  Dice dice(1);
  std::vector<MoveCommand> chain;
  TipPose at{{1000.0, 900.0, -200.0}, 0.0, 0.5};
  double heading = 0.0;
  for (int k = 0; k < count; ++k) {
    // Box and Muller's normal.
    heading += kHeading_rad * std::sqrt(-2.0 * std::log(1.0 - dice.Uniform(0.0, 1.0))) *
               std::cos(dice.Uniform(0.0, kTurn));
    const double step = dice.Uniform(0.05, 2.0);
    TipPose to = at;
    to.tip +=
        MachineVector{step * std::cos(heading), step * std::sin(heading), dice.Uniform(-0.1, 0.1)};
    if (head) {
      to.a_rad += dice.Uniform(-kStep_rad, kStep_rad);
      to.b_rad += dice.Uniform(-kStep_rad, kStep_rad);
    }
    MoveCommand move;
    move.path = PathPiece::Line(at, to);
    move.speed_fraction = kSpeed_mm_s / MachineLimits{}.tip_speed_mm_s;
    move.fly = true;
    move.tag = static_cast<std::uint64_t>(k);
    chain.push_back(move);
    at = to;
  }
  return chain;
}

// Through the points, /FLY at each, from rest to rest.
inline std::vector<MoveCommand> Polyline(const std::vector<MachinePoint>& points,
                                         double speed_fraction) {
  std::vector<MoveCommand> chain;
  for (std::size_t k = 1; k < points.size(); ++k) {
    MoveCommand move;
    move.path = PathPiece::Line({points[k - 1]}, {points[k]});
    move.speed_fraction = speed_fraction;
    move.fly = k + 1 < points.size();
    move.tag = k;
    chain.push_back(move);
  }
  return chain;
}

// `legs` of one length, each turned from the last by `turn_rad`, to the same side or in turns.
inline std::vector<MachinePoint> Legs(int legs, double length_mm, double turn_rad, bool zigzag,
                                      double rise_mm = 0.0) {
  std::vector<MachinePoint> points{{1000.0, 900.0, -200.0}};
  double direction = zigzag ? -0.5 * turn_rad : 0.0;
  for (int k = 0; k < legs; ++k) {
    points.push_back(points.back() + MachineVector{length_mm * std::cos(direction),
                                                   length_mm * std::sin(direction), rise_mm});
    direction += zigzag && k % 2 == 1 ? -turn_rad : turn_rad;
  }
  return points;
}

}  // namespace rmlcell::motion
