#include "tests/engine/optimo/control/measured.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/motion/kinematics/axes.h"
#include "engine/motion/kinematics/kinematics.h"
#include "engine/motion/kinematics/machine_limits.h"
#include "engine/motion/ride/trajectory.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::optimo::testing {
namespace {

// Numbers, not vectors: tests are not optimised, and expressions of vectors take ten times as long.
struct Where {
  std::array<double, 3> tip{};
  std::array<double, 5> axes{};
};

Where WhereIn(const Ran::Part& part, double time_s) {
  const double within = time_s - ToSeconds(part.done.start) + part.done.profile_start_s;
  const motion::PathPiece& path = part.motion.path;
  const motion::PathPose place = path.At(part.motion.speed.At(within).s);
  const motion::AxisPose axes = motion::AxesOn(path, part.motion.head, place);
  const motion::MachinePoint tip = motion::TipOn(path, part.motion.head, place).tip;
  return {{tip.x(), tip.y(), tip.z()},
          {axes.column.x(), axes.column.y(), axes.column.z(), axes.a_rad, axes.b_rad}};
}

// The motion under way then, or the last one before: places are walked through in order.
Where WhereAt(const Ran& ran, std::size_t& part, double time_s) {
  while (part + 1 < ran.parts.size() && ToSeconds(ran.parts[part + 1].done.start) <= time_s) ++part;
  return WhereIn(ran.parts[part], std::min(time_s, ToSeconds(ran.parts[part].done.end)));
}

}  // namespace

Measured MeasuredFrom(const Ran& ran, double step_s) {
  Measured found;
  if (ran.parts.empty()) return found;
  const motion::MachineLimits machine = motion::StandardMachine();
  std::size_t part = 0;
  const double first = ToSeconds(ran.parts.front().done.start);
  Where older = WhereAt(ran, part, first);
  Where old = older;
  for (double t = first; t <= ran.time_s + 2.0 * step_s; t += step_s) {
    const Where here = WhereAt(ran, part, t);
    const double square = step_s * step_s;
    double squared = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double bend = here.tip[i] - old.tip[i] * 2.0 + older.tip[i];
      squared += bend * bend;
    }
    const double tip = std::sqrt(squared) / square;
    if (tip > found.tip_mm_s2) {
      found.tip_mm_s2 = tip;
      found.tip_at_s = t;
    }
    for (const std::size_t i : motion::kAxes) {
      const double share = std::abs(here.axes[i] - 2.0 * old.axes[i] + older.axes[i]) / square /
                           machine.axes.acceleration[i];
      if (share > found.axes) {
        found.axes = share;
        found.axes_at_s = t;
      }
    }
    older = old;
    old = here;
  }
  return found;
}

void ExpectWithinLimits(const Ran& ran, bool tip, const std::string& what) {
  constexpr double kRoom = 1.01;  // times are rounded to 1 ns
  const Measured found = MeasuredFrom(ran);
  if (tip) {
    EXPECT_LE(found.tip_mm_s2, kRoom * motion::StandardMachine().tip_acceleration_mm_s2)
        << "at " << found.tip_at_s << " s\n"
        << what;
  }
  EXPECT_LE(found.axes, kRoom) << "at " << found.axes_at_s << " s\n" << what;
}

}  // namespace rmlcell::optimo::testing
