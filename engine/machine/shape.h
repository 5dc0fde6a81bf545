#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "engine/motion/planner/planner.h"

namespace rmlcell::machine {

// An axis-parallel box in a frame, mm. A new one is empty: it holds no point.
template <class Point>
struct BoxOf {
  Point min{kNone, kNone, kNone};
  Point max{-kNone, -kNone, -kNone};

  bool empty() const { return min.x() > max.x(); }
  double diagonal_mm() const { return empty() ? 0.0 : (min - max).norm(); }
  void Add(const Point& p) {
    min = Point(std::min(min.x(), p.x()), std::min(min.y(), p.y()), std::min(min.z(), p.z()));
    max = Point(std::max(max.x(), p.x()), std::max(max.y(), p.y()), std::max(max.z(), p.z()));
  }
  void Add(const BoxOf& other) {
    if (other.empty()) return;
    Add(other.min);
    Add(other.max);
  }
  bool operator==(const BoxOf&) const = default;

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
};
using Box = BoxOf<motion::MachinePoint>;
using ProgramBox = BoxOf<motion::ProgramPoint>;  // as the program wrote its points

// The greatest speed of Z is for travel: a way down at this share of it or more is no feed
// (docs/verdict.md).
inline constexpr double kTravelShareOfZ = 0.8;

// What report and pictures need to know of a machine beyond what its runs tell.
struct MachineShape {
  // The head of the gantry turns about A and B, and its column is not where the tip is. Otherwise
  // the tip is what X, Y and Z move, and the `a_rad` of a pose is the rotary axis, if there is one.
  bool five_axis = false;

  // Where X, Y and Z can go, machine frame: the column of a gantry, the tip of a mill. Empty: not
  // known.
  Box travel;

  // Program zero in the machine frame, when it is one for the whole run (a mill's work origin).
  bool has_work_origin = false;
  motion::MachinePoint work_origin;

  // What the machine can do: the 100 % of shares and speed classes. Nothing: not known.
  std::optional<motion::MachineLimits> limits;

  double laser_watts = 0.0;  // rated power; 0: the machine has no laser
};

}  // namespace rmlcell::machine
