#include <algorithm>
#include <cmath>
#include <span>

#include "engine/motion/ride/interruption.h"
#include "engine/motion/ride/trajectory.h"
#include "engine/optimo/control/control.h"

// Motions as time passes: from the planner to the observer.
namespace rmlcell::optimo {
namespace {

template <class Queue>
auto* FindTag(Queue& queue, std::uint64_t tag) {
  const auto found =
      std::ranges::lower_bound(queue, tag, {}, [](const auto& row) { return row.first; });
  return found != queue.end() && found->first == tag ? &found->second : nullptr;
}

std::string_view PathName(PathType path) {
  switch (path) {
    case PathType::kPtp:
      return "PTP";
    case PathType::kLin:
      return "LIN";
    case PathType::kCir:
      return "CIR";
    case PathType::kHole:
      return "HOLE";
  }
  return "";
}

// Exactly the end once it has arrived: times are rounded to 1 ns, the profile may be a little
// longer.
double PlaceOf(const ActiveMotion& active, SimTime time) {
  return time >= active.arrival ? active.motion.path.length() : active.s_at(time);
}

motion::TipPose PoseOn(const motion::PlannedMotion& motion, double s) { return motion.path.At(s); }

}  // namespace

void Control::DrainPlanner() {
  while (std::optional<motion::PlannedItem> item = s_.planner.Next())
    s_.timeline.push_back(std::move(*item));
}

const MoveNote* Control::NoteOf(std::uint64_t tag) const { return FindTag(s_.notes, tag); }
MoveNote* Control::NoteOf(std::uint64_t tag) { return FindTag(s_.notes, tag); }

// Marks take effect at once, motions begin.
void Control::StartNextItem() {
  while (!s_.active && !s_.timeline.empty()) {
    motion::PlannedItem& next = s_.timeline.front();
    if (const auto* mark = std::get_if<motion::PlannedMark>(&next)) {
      const std::uint64_t tag = mark->tag;
      s_.timeline.pop_front();
      if (const PassageEffect* effect = FindTag(s_.effects, tag)) Carry(*effect);
      while (!s_.effects.empty() && s_.effects.front().first <= tag) s_.effects.pop_front();
      continue;
    }
    s_.active.emplace();
    ActiveMotion& active = *s_.active;
    active.motion = std::get<motion::PlannedMotion>(next);
    s_.timeline.pop_front();
    if (s_.background_from && active.motion.tag >= *s_.background_from) GoesOnInBackground(true);
    if (MoveNote* note = NoteOf(active.motion.tag)) {
      const std::vector<BeyondTravel> beyond = std::move(note->beyond);
      note->beyond.clear();
      TellViolations(note->place, beyond);
      active.note = *note;
    }
    TellSpeedHeld(active.motion, active.note);
    while (!s_.notes.empty() && s_.notes.front().first < active.motion.tag) s_.notes.pop_front();
    while (!s_.appended.empty() && s_.appended.front().tag < active.motion.tag) {
      s_.appended.pop_front();
    }
    BeginProfile();
  }
}

// Whether the program goes on beside the motion that is under way from now on. A halt on the path
// leaves it as it is: the motion goes on at START as it did before.
void Control::GoesOnInBackground(bool background) {
  s_.background = background;
  s_.background_from.reset();
}

// The profile of the motion under way begins now.
void Control::BeginProfile() {
  ActiveMotion& active = *s_.active;
  active.start = s_.now;
  active.told = s_.now;
  active.arrival = s_.now + FromSeconds(active.motion.speed.duration_s());
  active.end = active.arrival + FromSeconds(active.motion.settling_s);
  if (s_.watch_begins && Watching()) {
    s_.watch_begins = false;
    s_.watched_since = s_.now;
    s_.time_due = TickAfter(s_.time_limit_s);
  }
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
                      .from = PlaceOf(active, active.told),
                      .travelled = PlaceOf(active, until),
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
  s_.pending.told = s_.now;  // a wait during a /NEXT motion is told from here on
  MarkTasks();
  const bool joint = active.motion.path.in_axes();
  const motion::TipPose pose = PoseOn(active.motion, active.s_at(active.arrival));
  s_.machine.axes = joint ? motion::AxisPose{pose.tip, pose.a_rad, pose.b_rad}
                          : active.motion.head.ColumnOf(pose);
  if (active.ended) {
    s_.timeline.clear();
    s_.planned_axes = s_.machine.axes;
  }
  if (!Busy() && !s_.halting) GoesOnInBackground(false);
  if (!active.ended && !active.motion.ends_move) return;
  const motion::CornerReport& corner = active.motion.corner;
  if (corner.passage == motion::Passage::kStopReversal) {
    WarnAt(active.note.place, ErrorCode::kFlyReversal,
           "the path turns back: the machine stops at the target", "OPT-B.25");
  }
  if (corner.passage == motion::Passage::kStopNeighbour) {
    WarnAt(active.note.place, ErrorCode::kFlyCancelled,
           "/FLY beside a motion that cannot be passed into: the machine stops at the target",
           "OPT-2.48");
  }
  if (active.note.last || active.ended) {
    observer_.OnMove({.at = s_.now,
                      .place = active.note.place,
                      .tip = HeadNow().TipOf(s_.machine.axes),
                      .axes = s_.machine.axes,
                      .program_point = active.note.program_point,
                      .rotary_a = active.note.program_a,
                      .feed_mm_s = active.note.feed_mm_s,
                      .path = PathName(active.note.path)});
    if (s_.watched && active.motion.tag >= s_.watched->first) {
      if (s_.time_ran_out) program().due_gosub = s_.time_gosub;
      Unwatch();
    }
  }
}

// The motion under way comes to rest on its path, at once, and its move is over where it stands:
// /END, /TIME, a MOVE that takes over. Such moves end in a stop, so the ramp never leaves their
// path.
void Control::EndMotionHere() {
  ActiveMotion& active = *s_.active;
  if (s_.now >= active.arrival) return;  // it stands already
  const motion::SpeedProfile ramp =
      active.motion.speed.StopFrom(ToSeconds(s_.now - active.start), active.motion.limits);
  const double here = active.s_at(s_.now);
  const double rest = std::min(ramp.end().s, active.motion.path.length());
  TellMotion(s_.now);
  active.ended = true;
  active.motion.settling_s = 0.0;
  if (rest > here) {
    active.motion.path = active.motion.path.Part(here, rest);
    active.motion.speed = ramp.Part(here, rest);
  } else {
    active.motion.path = active.motion.path.Standing(here);
    active.motion.speed = motion::SpeedProfile();
  }
  BeginProfile();
}

// STOP: the machine comes to rest along the planned path, over as many motions as that takes, and
// START goes on from there over the same path (OPT-4.18, motion.md 6). False: not enough is planned
// yet to come to rest on; the program runs ahead a little more.
bool Control::BringToHalt() {
  std::vector<motion::PlannedMotion> ahead{s_.active->motion};
  std::vector<std::pair<std::size_t, motion::PlannedMark>> marks;  // each behind a motion
  for (const motion::PlannedItem& item : s_.timeline) {
    if (const auto* planned = std::get_if<motion::PlannedMotion>(&item)) {
      ahead.push_back(*planned);
    } else {
      marks.emplace_back(ahead.size() - 1, std::get<motion::PlannedMark>(item));
    }
  }
  const motion::StopOnPath stop =
      motion::StopAlong(ahead, ToSeconds(s_.now - s_.active->start), parameters_.limits.axes);
  if (!stop.complete) return false;
  TellMotion(s_.now);
  s_.machine.axes = AxesNow();
  s_.active.reset();
  s_.timeline.clear();
  const auto add_marks = [&](std::size_t behind, std::deque<motion::PlannedItem>& items) {
    for (const auto& [place, mark] : marks) {
      if (place == behind) items.emplace_back(mark);
    }
  };
  const std::size_t first = stop.index + 1 - std::min(stop.motions.size(), stop.index + 1);
  for (std::size_t n = 0; n < stop.motions.size(); ++n) {
    s_.timeline.emplace_back(stop.motions[n]);
    if (first + n < stop.index) add_marks(first + n, s_.timeline);
  }
  const std::span<const motion::PlannedMotion> left = std::span(ahead).subspan(stop.index);
  std::vector<motion::PlannedMotion> restart =
      motion::RestartAlong(left, stop.s, parameters_.limits.axes);
  if (!stop.motions.empty() && stop.motions.back().ends_move && !restart.empty()) {
    motion::PlannedMotion& settling = restart.front();  // all that is left of that move
    if (!(settling.path.length() > 0.0)) settling.ends_move = false;
  }
  s_.interrupted.clear();
  // RestartAlong leaves out the first motion when the machine stands at its end.
  const std::size_t dropped = left.size() - restart.size();
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (k >= dropped) s_.interrupted.emplace_back(restart[k - dropped]);
    add_marks(stop.index + k, s_.interrupted);
  }
  s_.halted_behind = s_.place;  // beside a motion of /NEXT
  if (const MoveNote* note = NoteOf(left.front().tag); note != nullptr && !s_.background) {
    s_.halted_behind = note->place;
  }
  s_.halting = true;
  s_.stop_requested = false;
  StartNextItem();
  return true;
}

// A motion with /END or /TIME is under way, and nothing has ended it yet.
bool Control::Watching() const {
  return s_.watched && s_.active && !s_.active->ended &&
         s_.active->motion.tag >= s_.watched->first && s_.active->motion.tag <= s_.watched->last;
}

void Control::Unwatch() {
  s_.watched.reset();
  s_.end_condition.reset();
  s_.time_gosub.reset();
  s_.no_motion = false;
}

void Control::EndNoMotion() {
  if (s_.pending.kind == Pending::Kind::kNoMotion) {
    TellWait();
    s_.pending = {};
  }
  Unwatch();
}

// /END and /TIME of the move under way: at its start, at each tick, when time runs out. OPT-2.54
// to 2.58
void Control::WatchMove() {
  if (s_.deferred) return;
  if (s_.time_gosub && s_.now >= s_.time_due && !s_.time_ran_out) {
    if (s_.pending.kind == Pending::Kind::kCondition && s_.pending.of_move) {
      // Time ran out while /START was waited for: no motion is made.
      TellWait();
      program().due_gosub = s_.time_gosub;
      s_.pending = {};
      Unwatch();
      ++frame().next;
      return;
    }
    if (s_.no_motion) {
      program().due_gosub = s_.time_gosub;
      return EndNoMotion();
    }
    if (Watching()) {
      s_.time_ran_out = true;
      EndMotionHere();
      return;
    }
  }
  const bool stands = s_.no_motion;
  if (!s_.end_condition || !(stands || Watching())) return;
  if ((s_.now - s_.watched_since) % FromSeconds(parameters_.cycle_s) != SimTime(0)) return;
  if (stands) s_.input_changed = false;
  const std::optional<bool> met = Truth(*s_.end_condition);
  if (stands) {
    if (met && *met) EndNoMotion();
  } else if (!met || *met) {
    EndMotionHere();
  }
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
  if (!s_.active->motion.path.in_axes()) return pose;
  return s_.active->motion.head.TipOf({pose.tip, pose.a_rad, pose.b_rad});
}

motion::AxisPose Control::AxesNow() const {
  if (!s_.active) return s_.machine.axes;
  const motion::TipPose pose = PoseOn(s_.active->motion, s_.active->s_at(s_.now));
  if (s_.active->motion.path.in_axes()) {
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
  return motion::PointAt(path, s_.active->motion.head, here).tip_speed();
}

}  // namespace rmlcell::optimo
