#include <algorithm>
#include <cmath>

#include "engine/optimo/control/control.h"

// Motions as time passes: from the planner to the observer.
namespace rmlcell::optimo {
namespace {

template <class Queue>
const typename Queue::value_type::second_type* FindTag(const Queue& queue, std::uint64_t tag) {
  const auto found = std::ranges::lower_bound(queue, tag, {}, [](const auto& row) { return row.first; });
  return found != queue.end() && found->first == tag ? &found->second : nullptr;
}

std::string_view PathName(PathType path) {
  switch (path) {
    case PathType::kPtp: return "PTP";
    case PathType::kLin: return "LIN";
    case PathType::kCir: return "CIR";
    case PathType::kHole: return "HOLE";
  }
  return "";
}

motion::TipPose PoseOn(const motion::PlannedMotion& motion, double s) { return motion.path.At(s); }

}  // namespace

void Control::DrainPlanner() {
  while (std::optional<motion::PlannedItem> item = s_.planner.Next()) s_.timeline.push_back(std::move(*item));
}

// Marks take effect at once, motions begin.
void Control::StartNextItem() {
  while (!s_.active && !s_.timeline.empty()) {
    motion::PlannedItem item = std::move(s_.timeline.front());
    s_.timeline.pop_front();
    if (const auto* mark = std::get_if<motion::PlannedMark>(&item)) {
      if (const PassageEffect* effect = FindTag(s_.effects, mark->tag)) Carry(*effect);
      while (!s_.effects.empty() && s_.effects.front().first <= mark->tag) s_.effects.pop_front();
      continue;
    }
    auto& planned = std::get<motion::PlannedMotion>(item);
    ActiveMotion active;
    if (const MoveNote* note = FindTag(s_.notes, planned.tag)) active.note = *note;
    while (!s_.notes.empty() && s_.notes.front().first < planned.tag) s_.notes.pop_front();
    active.motion = std::move(planned);
    active.start = s_.now;
    active.told = s_.now;
    active.arrival = s_.now + FromSeconds(active.motion.speed.duration_s());
    active.end = active.arrival + FromSeconds(active.motion.settling_s);
    s_.active = std::move(active);
  }
  if (!Busy()) s_.background = false;
}

// Reports the part of the motion under way from what was told up to `until`.
void Control::TellMotion(SimTime until) {
  ActiveMotion& active = *s_.active;
  if (until <= active.told && until < active.end) return;
  observer_.OnMotion({.start = active.told,
                      .end = until,
                      .place = active.note.place,
                      .use = s_.beam.on ? machine::MotionUse::kCut : machine::MotionUse::kTravel,
                      .motion = &active.motion,
                      .from = active.s_at(std::min(active.told, active.arrival)),
                      .travelled = active.s_at(std::min(until, active.arrival)),
                      .profile_start_s = ToSeconds(active.told - active.start),
                      .programmed_mm_s = active.note.feed_mm_s,
                      .beam_on = s_.beam.on,
                      .power = s_.beam.power});
  active.told = until;
}

void Control::ArriveAtEnd() {
  TellMotion(s_.active->end);
  const ActiveMotion active = std::move(*s_.active);
  s_.active.reset();
  const bool joint = active.motion.path.kind() == motion::PathPiece::Kind::kJoint;
  const motion::TipPose pose = PoseOn(active.motion, active.s_at(active.arrival));
  s_.machine.axes = joint ? motion::AxisPose{pose.tip, pose.a_rad, pose.b_rad} : active.motion.head.ColumnOf(pose);
  if (active.rest == ActiveMotion::Rest::kHalt) {
    s_.interrupted = active;
    s_.interrupted->offset = active.s_at(active.arrival);
    Halt("STOP");
    return;
  }
  if (active.rest == ActiveMotion::Rest::kEnded) {
    s_.timeline.clear();
    s_.planned_axes = s_.machine.axes;
  } else if (!active.motion.ends_move) {
    return;
  }
  const motion::CornerReport& corner = active.motion.corner;
  if (corner.passage == motion::Passage::kStopReversal) {
    Warn(ErrorCode::kFlyReversal, "the path turns back: the machine stops at the target", "OPT-B.25");
  }
  if (active.note.last || active.rest == ActiveMotion::Rest::kEnded) {
    observer_.OnMove({.at = s_.now,
                      .place = active.note.place,
                      .tip = HeadNow().TipOf(s_.machine.axes),
                      .axes = s_.machine.axes,
                      .program_point = active.note.program_point,
                      .rotary_a = active.note.program_a,
                      .feed_mm_s = active.note.feed_mm_s,
                      .path = PathName(active.note.path)});
    if (s_.watched_move == active.motion.tag) {
      s_.watched_move.reset();
      s_.end_condition.reset();
      const std::optional<int> label = s_.time_label;
      s_.time_label.reset();
      if (s_.time_ran_out && label) {
        s_.time_ran_out = false;
        Gosub(*label);
      }
    }
  }
}

// The motion under way leaves its profile and comes to rest on its path, at once.
void Control::BringToRest(ActiveMotion::Rest rest) {
  ActiveMotion& active = *s_.active;
  if (s_.now >= active.arrival) return;  // it stands already
  const double t_s = ToSeconds(s_.now - active.start);
  const motion::SpeedProfile ramp = active.motion.speed.StopFrom(t_s, active.motion.limits);
  TellMotion(s_.now);
  active.motion.speed = ramp;
  active.motion.settling_s = 0.0;
  active.rest = rest;
  active.start = s_.now;
  active.told = s_.now;
  active.arrival = s_.now + FromSeconds(ramp.duration_s());
  active.end = active.arrival;
}

// True when the motion under way can come to rest on its piece of path and get up to its end speed again
// from there. On a blend, or close before one, a STOP waits for the next piece that can.
bool Control::CanHaltHere() const {
  const ActiveMotion& active = *s_.active;
  if (active.rest != ActiveMotion::Rest::kNo || s_.now >= active.arrival) return false;
  const double t_s = ToSeconds(s_.now - active.start);
  const double rest_at = active.offset + active.motion.speed.StopFrom(t_s, active.motion.limits).end().s;
  const double left = active.motion.path.length() - rest_at;
  if (left < 0.0) return false;
  const double end_speed = active.motion.speed.end().speed;
  return motion::Reach(0.0, left, active.motion.limits) >= end_speed;
}

// START after STOP: from rest to the end of the same piece of path (OPT-4.18).
void Control::GoOnAfterHalt() {
  ActiveMotion active = std::move(*s_.interrupted);
  s_.interrupted.reset();
  const double left = std::max(0.0, active.motion.path.length() - active.offset);
  // The profile that was left knew the speed at the end of the piece; a piece that ends in a blend has one
  // above zero, which CanHaltHere has seen to be in reach.
  const double end_speed = s_.timeline.empty() ? 0.0 : [&] {
    for (const motion::PlannedItem& item : s_.timeline) {
      if (const auto* next = std::get_if<motion::PlannedMotion>(&item)) return next->speed.At(0.0).speed;
    }
    return 0.0;
  }();
  active.motion.speed = motion::SpeedProfile::Span(left, 0.0, end_speed, active.motion.limits);
  active.motion.settling_s = end_speed > 0.0 || active.note.fly ? 0.0 : parameters_.limits.settling_s;
  active.rest = ActiveMotion::Rest::kNo;
  active.start = s_.now;
  active.told = s_.now;
  active.arrival = s_.now + FromSeconds(active.motion.speed.duration_s());
  active.end = active.arrival + FromSeconds(active.motion.settling_s);
  s_.active = std::move(active);
}

// Acts on motions that are not planned yet, and on the one under way when it cruises and ends in a stop.
void Control::ChangeOverride(double percent) {
  if (!(percent > 0.0)) percent = 1.0;
  const double before = s_.override_percent;
  s_.override_percent = percent;
  if (!s_.active || s_.active->rest != ActiveMotion::Rest::kNo || before == percent) return;
  ActiveMotion& active = *s_.active;
  if (s_.now >= active.arrival || active.motion.speed.end().speed > 0.0) return;
  const motion::PathState here = active.motion.speed.At(ToSeconds(s_.now - active.start));
  if (here.acceleration != 0.0 || here.speed <= 0.0) return;
  motion::PathLimits limits = active.motion.limits;
  const double left = active.motion.path.length() - active.offset - here.s;
  const double wanted = std::min(limits.speed * percent / before,
                                 active.motion.path.by_sigma() ? limits.speed * 1.45
                                                               : parameters_.limits.tip_speed_mm_s);
  limits.speed = std::max(wanted, here.speed);
  if (motion::RampLength(here.speed, 0.0, limits) > left) return;
  TellMotion(s_.now);
  if (wanted < here.speed) {
    // Down to the new speed first; what remains follows as a motion of its own.
    const double ramp = motion::RampLength(here.speed, wanted, limits);
    if (ramp + motion::RampLength(wanted, 0.0, limits) > left) return;
    motion::PlannedMotion rest = active.motion;
    const double s_rest = active.offset + here.s + ramp;
    active.motion.speed = motion::SpeedProfile::Span(ramp, here.speed, wanted, limits);
    active.motion.settling_s = 0.0;
    active.motion.ends_move = false;
    if (!rest.path.by_sigma()) {
      active.motion.path = rest.path.Part(0.0, s_rest);
      rest.path = rest.path.Part(s_rest, rest.path.length());
      limits.speed = wanted;
      rest.limits = limits;
      rest.speed = motion::SpeedProfile::Span(rest.path.length(), wanted, 0.0, limits);
      s_.timeline.emplace_front(std::move(rest));
    }
  } else {
    active.motion.limits = limits;
    active.motion.speed = motion::SpeedProfile::Span(left, here.speed, 0.0, limits);
  }
  active.offset += here.s;
  active.start = s_.now;
  active.told = s_.now;
  active.arrival = s_.now + FromSeconds(active.motion.speed.duration_s());
  active.end = active.arrival + FromSeconds(active.motion.settling_s);
}

// /END and /TIME of the move under way: at its start, at each tick, when time runs out. OPT-2.54 to 2.58
void Control::WatchMove() {
  if (s_.time_label && s_.now >= s_.time_due && !s_.time_ran_out) {
    if (s_.pending.kind == Pending::Kind::kCondition) {
      // Time ran out while /START was waited for: no motion is made.
      const int label = *s_.time_label;
      s_.pending = {};
      s_.time_label.reset();
      s_.end_condition.reset();
      s_.watched_move.reset();
      ++frame().next;
      Gosub(label);
      return;
    }
    if (s_.active && s_.watched_move == s_.active->motion.tag) {
      s_.time_ran_out = true;
      BringToRest(ActiveMotion::Rest::kEnded);
      return;
    }
  }
  if (!s_.end_condition || !s_.active || s_.watched_move != s_.active->motion.tag ||
      s_.active->rest != ActiveMotion::Rest::kNo) {
    return;
  }
  if ((s_.now - s_.watched_since) % FromSeconds(parameters_.cycle_s) != SimTime(0)) return;
  const std::optional<bool> met = Truth(*s_.end_condition);
  if (met && *met) BringToRest(ActiveMotion::Rest::kEnded);
}

// An error or the end of the run: whatever moves comes to rest, nothing more begins.
void Control::StopMotions() {
  s_.planner.Stop();
  s_.passing = false;
  DrainPlanner();
}

bool Control::Moving() const { return s_.active && s_.now < s_.active->arrival; }

motion::TipPose Control::TipNow() const {
  if (!s_.active) return HeadNow().TipOf(s_.machine.axes);
  const motion::TipPose pose = PoseOn(s_.active->motion, s_.active->s_at(s_.now));
  if (s_.active->motion.path.kind() != motion::PathPiece::Kind::kJoint) return pose;
  return s_.active->motion.head.TipOf({pose.tip, pose.a_rad, pose.b_rad});
}

motion::AxisPose Control::AxesNow() const {
  if (!s_.active) return s_.machine.axes;
  const motion::TipPose pose = PoseOn(s_.active->motion, s_.active->s_at(s_.now));
  if (s_.active->motion.path.kind() == motion::PathPiece::Kind::kJoint) {
    return {pose.tip, pose.a_rad, pose.b_rad};
  }
  return s_.active->motion.head.ColumnOf(pose);
}

double Control::TipSpeedNow() const {
  if (!Moving()) return 0.0;
  const motion::PathState here = s_.active->motion.speed.At(ToSeconds(s_.now - s_.active->start));
  const motion::PathPiece& path = s_.active->motion.path;
  if (!path.by_sigma()) return here.speed;
  if (path.kind() == motion::PathPiece::Kind::kRotary) return 0.0;
  return here.speed * motion::Norm(path.Tangent(s_.active->s_at(s_.now)));
}

}  // namespace rmlcell::optimo
