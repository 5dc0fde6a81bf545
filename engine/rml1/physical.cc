#include "engine/rml1/physical.h"

#include <algorithm>

namespace rmlcell::rml1 {

using machine::MotionUse;

void Physical::OnRide(const Ride& ride, const Registers& registers, const CommandPlace& command) {
  const bool first_ever = !totals_.x.known;
  const auto add_point = [&](const Point& p) {
    totals_.x.Add(p.x - profile_->origin_x);
    totals_.y.Add(p.y - profile_->origin_y);
    totals_.z.Add(p.z - registers.surface_z);
    totals_.a.Add(p.a);
  };
  if (first_ever) add_point(ride.from);
  add_point(ride.to);
  if (ride.first) ++totals_.motions;
  const bool in_work = ride.in_work;
  const bool plunges = ride.use == MotionUse::kPlunge;
  if (plunges && in_work && !plunging_) ++totals_.plunges;
  plunging_ = plunges && in_work;
  (in_work ? totals_.cut_mm : totals_.travel_mm) += ride.length_mm;
  const bool tool_in = plunges || ride.use == MotionUse::kCut;
  if (tool_in && !in_work && !plunges && !ride.spindle_turns) totals_.drawn_mm += ride.length_mm;
  if (tool_in) {
    for (const Point& p : {ride.from, ride.to}) {
      totals_.work.x.Add(p.x - profile_->origin_x);
      totals_.work.y.Add(p.y - profile_->origin_y);
      totals_.work.z.Add(p.z - registers.surface_z);
    }
  }
  totals_.motion_s += ride.time_s;
  const bool by_xy_speed = ride.chain == Chain::kToolDown;
  watch_.OnRide(
      {.from = ride.from,
       .to = ride.to,
       .length_mm = ride.length_mm,
       .in_work = tool_in,
       .along_surface = tool_in && !plunges && !in_work,
       .rapid = ride.rapid,
       .by_xy_speed = by_xy_speed,
       .spindle_turns = ride.spindle_turns,
       .plunge = plunges,
       .speed_mm_s = by_xy_speed ? registers.xy_speed : registers.z_speed,
       .fastest_z_mm_s = std::min(profile_->travel_speed, profile_->z_speeds.maximum_mm_s),
       .clamps_height = profile_->clamps_height},
      registers, command);
  AddToState(ride.time_s, in_work || registers.tool_down);
  depth_ = registers.surface_z - ride.to.z;
}

void Physical::OnDwell(double time_s, const Registers& registers) {
  totals_.dwell_s += time_s;
  AddToState(time_s, registers.tool_down || depth_ > 0.0);
}

void Physical::OnSpindleWait(double time_s, const Registers& registers) {
  totals_.spindle_s += time_s;
  AddToState(time_s, registers.tool_down || depth_ > 0.0);
}

void Physical::AddToState(double time_s, bool down) {
  (down ? totals_.down_s : totals_.up_s) += time_s;
}

}  // namespace rmlcell::rml1
