#include "engine/rml1/cut_watch.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::rml1 {
namespace {

constexpr double kAsAsked = 0.01;  // a speed within 1 % is the one asked for

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
  if (fast_so_far_.mm > 0.0 && !ride.plunge) EndFastPlunge(ride);
  if (ride.in_work) {
    if (!ride.plunge) cut_mm_s_ = std::max(cut_mm_s_, ride.speed_mm_s);
    OnCut(ride, registers, command);
    cutting_ = !ride.plunge || cutting_;
    return;
  }
  cutting_ = false;
  if (ride.from.x != ride.to.x || ride.from.y != ride.to.y) {
    OnTravel(ride, registers, command);
  }
}

void CutWatch::OnCut(const Ride& ride, const Registers& registers, const CommandPlace& command) {
  has_cut_ = true;
  from_work_ = {};
  const bool given = ride.by_xy_speed ? registers.xy_speed_given : registers.z_speed_given;
  const SpeedLimit& limit = ride.by_xy_speed ? registers.xy_limit : registers.z_limit;
  const bool limited = limit.off() > kAsAsked || registers.rpm_limit.off() > kAsAsked;
  if (ride.spindle_turns && given && !limited && !ride.plunge) return;
  // Along the surface nothing is cut: pens and drag knives go there with the spindle off.
  const double below = registers.z0 - 2.0 * kSameHeight;
  const double mm = ShareNotAbove(ride.from, ride.to, below) * ride.length_mm;
  if (!ride.spindle_turns) Add(spindle_stands_, mm, command);
  if (!given) Add(feed_not_given_, mm, command);
  if (ride.plunge) OnPlunge(ride, mm, command);
  const bool slower_down = ride.plunge && limit.used < limit.asked;
  if (!slower_down) AddLimited(feed_limited_, limit, mm, command);
  if (ride.spindle_turns) AddLimited(rpm_limited_, registers.rpm_limit, mm, command);
}

void CutWatch::OnPlunge(const Ride& ride, double mm, const CommandPlace& command) {
  if (ride.as_fast_as_z && !cutting_) {
    Add(fast_so_far_, mm, command);
    fast_mm_s_ = ride.speed_mm_s;
  } else if (mm > 0.0) {
    fast_so_far_ = {};
  }
}

// `next` is a cut, or leads up and away.
void CutWatch::EndFastPlunge(const Ride& next) {
  if (!next.in_work) {
    Add(fast_hole_, fast_so_far_.mm, fast_so_far_.first);
  } else if (next.speed_mm_s < fast_mm_s_) {
    Add(fast_plunge_, fast_so_far_.mm, fast_so_far_.first);
  }
  fast_so_far_ = {};
}

CutWatch::Way CutWatch::fast_plunge() const {
  if (cut_mm_s_ >= fast_mm_s_) return fast_plunge_;
  const bool hole_first =
      fast_hole_.mm > 0.0 &&
      (!(fast_plunge_.mm > 0.0) || fast_hole_.first.number < fast_plunge_.first.number);
  return {.mm = fast_plunge_.mm + fast_hole_.mm,
          .first = hole_first ? fast_hole_.first : fast_plunge_.first};
}

void CutWatch::OnTravel(const Ride& ride, const Registers& registers, const CommandPlace& command) {
  if (ride.rapid) {
    const double share = ShareNotAbove(ride.from, ride.to, registers.z0);
    Add(no_clearance_, share * ride.length_mm, command);
  }
  if (ride.clamps_height > 0.0) {
    const double below = registers.z0 + ride.clamps_height - 2.0 * kSameHeight;
    const double share = ShareNotAbove(ride.from, ride.to, below);
    Add(has_cut_ ? from_work_ : to_work_, share * ride.length_mm, command);
  }
}

CutWatch::Way CutWatch::below_clamps() const {
  return {.mm = to_work_.mm + from_work_.mm,
          .first = to_work_.mm > 0.0 ? to_work_.first : from_work_.first};
}

void CutWatch::Add(Way& way, double mm, const CommandPlace& command) {
  if (!(mm > 0.0)) return;
  if (!(way.mm > 0.0)) way.first = command;
  way.mm += mm;
}

void CutWatch::AddLimited(LimitedWay& way, const SpeedLimit& limit, double mm,
                          const CommandPlace& command) {
  if (!(mm > 0.0) || !(limit.off() > kAsAsked)) return;
  if (limit.off() > way.worst.off()) way.worst = limit;
  Add(way, mm, command);
}

}  // namespace rmlcell::rml1
