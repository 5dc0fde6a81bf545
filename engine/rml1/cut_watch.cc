#include "engine/rml1/cut_watch.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::rml1 {
namespace {

// Heights are sums of decimal steps in binary.
constexpr double kSameHeight = 1e-6;  // device units

// The share of a line that is not above a height.
double ShareNotAbove(const Point& from, const Point& to, double height) {
  const double low = std::min(from.z, to.z) - kSameHeight;
  const double high = std::max(from.z, to.z) - kSameHeight;
  if (high <= height) return 1.0;
  if (low > height) return 0.0;
  return (height - low) / (high - low);
}

}  // namespace

void CutWatch::OnRide(const Ride& ride, const Registers& registers, const CommandPlace& command) {
  if (ride.in_work) {
    const bool given = ride.by_xy_speed ? registers.xy_speed_given : registers.z_speed_given;
    if (ride.spindle_turns && given) return;
    // Along the surface nothing is cut: pens and drag knives go there with the spindle off.
    const double below = registers.z0 - 2.0 * kSameHeight;
    const double mm = ShareNotAbove(ride.from, ride.to, below) * ride.length_mm;
    if (!ride.spindle_turns) Add(spindle_stands_, mm, command);
    if (!given) Add(feed_not_given_, mm, command);
  } else if (ride.rapid && (ride.from.x != ride.to.x || ride.from.y != ride.to.y)) {
    const double share = ShareNotAbove(ride.from, ride.to, registers.z0);
    if (share > 0.0) Add(no_clearance_, share * ride.length_mm, command);
  }
}

void CutWatch::Add(Way& way, double mm, const CommandPlace& command) {
  if (!(mm > 0.0)) return;
  if (!(way.mm > 0.0)) way.first = command;
  way.mm += mm;
}

}  // namespace rmlcell::rml1
