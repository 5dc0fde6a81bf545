#include "engine/optimo/ride/ride.h"

#include <algorithm>

#include "engine/motion/ride/trajectory.h"

namespace rmlcell::optimo {
namespace {

// Instructions that run ahead between two motions of a /FLY passage. A loop without motion would
// run ahead for ever; a passage that needs more than this becomes a stop.
constexpr int kRunAheadMax = 10'000;

// Exactly the end once it has arrived: times are rounded to 1 ns, the profile may be a little
// longer.
double PlaceOf(const ActiveMotion& active, SimTime time) {
  return time >= active.arrival ? active.motion.path.length() : active.s_at(time);
}

template <class Notes>
auto* Find(Notes& notes, std::uint64_t tag) {
  const auto found =
      std::ranges::lower_bound(notes, tag, {}, [](const auto& row) { return row.first; });
  return found != notes.end() && found->first == tag ? &found->second : nullptr;
}

}  // namespace

std::string_view NameOfPath(PathType path) {
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

const MoveNote* Ride::NoteOf(std::uint64_t tag) const { return Find(s_.notes, tag); }
MoveNote* Ride::NoteOf(std::uint64_t tag) { return Find(s_.notes, tag); }

void Ride::Drain() {
  while (std::optional<motion::PlannedItem> item = s_.planner.Next())
    s_.timeline.push_back(std::move(*item));
}

Status Ride::Append(motion::MoveCommand command, const MoveNote& note) {
  command.tag = s_.next_tag++;
  if (Status appended = s_.planner.Append(command); !appended) return appended;
  s_.notes.emplace_back(command.tag, note);
  s_.planned_axes = motion::AxesOn(command.path, command.head, command.path.to());
  if (note.fly || s_.passing) s_.appended.push_back({.tag = command.tag, .move = command});
  s_.passing = note.fly;
  s_.run_ahead = 0;
  Drain();
  return {};
}

std::uint64_t Ride::AppendMark() {
  const std::uint64_t tag = s_.next_tag++;
  if (s_.passing) s_.appended.push_back({.tag = tag, .move = std::nullopt});
  s_.planner.Mark(tag);
  Drain();
  return tag;
}

void Ride::EndChain() {
  s_.planner.Stop();
  s_.passing = false;
  Drain();
}

void Ride::GoOnBeside(std::uint64_t tag, bool ran_ahead) {
  EndChain();
  if (ran_ahead) {
    s_.beside = Beside::kComes;
    s_.beside_from = tag;
  } else {
    s_.beside = busy() ? Beside::kNow : Beside::kNo;
  }
  Start();
}

bool Ride::RunsAhead() {
  if (s_.run_ahead >= kRunAheadMax) return false;
  ++s_.run_ahead;
  return true;
}

void Ride::Start() {
  while (waits_to_start()) {
    motion::PlannedItem& next = s_.timeline.front();
    if (const auto* mark = std::get_if<motion::PlannedMark>(&next)) {
      const std::uint64_t tag = mark->tag;
      s_.timeline.pop_front();
      listener_.OnMark(tag);
      continue;
    }
    s_.active.emplace();
    ActiveMotion& active = *s_.active;
    active.motion = std::get<motion::PlannedMotion>(next);
    s_.timeline.pop_front();
    const std::uint64_t tag = active.motion.tag;
    if (s_.beside == Beside::kComes && tag >= s_.beside_from) s_.beside = Beside::kNow;
    if (MoveNote* note = NoteOf(tag)) {
      const std::vector<BeyondTravel> beyond = std::move(note->beyond);
      note->beyond.clear();
      travel_.TellViolations(note->place, beyond);
      active.note = *note;
    }
    travel_.TellSpeedHeld(active.motion, active.note.place, active.note.feed_mm_s);
    while (!s_.notes.empty() && s_.notes.front().first < tag) s_.notes.pop_front();
    while (!s_.appended.empty() && s_.appended.front().tag < tag) s_.appended.pop_front();
    BeginProfile();
    listener_.OnMotionBegins(tag);
  }
}

SimTime Ride::NextEvent() const {
  if (s_.active) return s_.active->end;
  return s_.timeline.empty() ? kForever : situation_.now;
}

// The profile of the motion under way begins now.
void Ride::BeginProfile() {
  ActiveMotion& active = *s_.active;
  active.start = situation_.now;
  active.told = situation_.now;
  active.arrival = situation_.now + FromSeconds(active.motion.speed.duration_s());
  active.end = active.arrival + FromSeconds(active.motion.settling_s);
}

void Ride::TellUpToNow() {
  if (s_.active) TellMotion(situation_.now);
}

// Reports the part of the motion under way from what was told up to `until`.
void Ride::TellMotion(SimTime until) {
  ActiveMotion& active = *s_.active;
  if (until <= active.told && until < active.end) return;
  const Beam& beam = situation_.beam;
  const machine::MotionDone done{
      .start = active.told,
      .end = until,
      .place = active.note.place,
      .use = beam.on ? machine::MotionUse::kCut : machine::MotionUse::kTravel,
      .motion = &active.motion,
      .from = PlaceOf(active, active.told),
      .travelled = PlaceOf(active, until),
      .profile_start_s = ToSeconds(active.told - active.start),
      .programmed_mm_s = active.note.feed_mm_s,
      .beam_on = beam.on,
      .power = beam.power};
  listener_.OnMotionTold(done);
  telling_.observer().OnMotion(done);
  active.told = until;
}

std::optional<std::uint64_t> Ride::Arrive() {
  TellMotion(s_.active->end);
  const ActiveMotion done = std::move(*s_.active);
  s_.active.reset();
  const motion::PathPiece& path = done.motion.path;
  motion::AxisPose& axes = situation_.machine.axes;
  axes = motion::AxesOn(path, done.motion.head, path.At(done.s_at(done.arrival)));
  if (done.ended) {
    s_.timeline.clear();
    s_.planned_axes = axes;
  }
  if (!busy() && !s_.protocol.comes_to_rest()) s_.beside = Beside::kNo;
  if (!done.ended && !done.motion.ends_move) return std::nullopt;
  const motion::CornerReport& corner = done.motion.corner;
  if (corner.passage == motion::Passage::kStopReversal) {
    telling_.WarnAt(done.note.place, ErrorCode::kFlyReversal,
                    "the path turns back: the machine stops at the target", "OPT-B.25");
  }
  if (corner.passage == motion::Passage::kStopNeighbour) {
    telling_.WarnAt(
        done.note.place, ErrorCode::kFlyCancelled,
        "/FLY beside a motion that cannot be passed into: the machine stops at the target",
        "OPT-2.48");
  }
  if (!done.note.last && !done.ended) return std::nullopt;
  telling_.observer().OnMove({.at = situation_.now,
                              .place = done.note.place,
                              .tip = head().TipOf(axes),
                              .axes = axes,
                              .program_point = done.note.program_point,
                              .rotary_a = done.note.program_a,
                              .feed_mm_s = done.note.feed_mm_s,
                              .path = NameOfPath(done.note.path)});
  return done.motion.tag;
}

void Ride::EndHere() {
  ActiveMotion& active = *s_.active;
  if (situation_.now >= active.arrival) return;  // it stands already
  const motion::SpeedProfile ramp =
      active.motion.speed.StopFrom(ToSeconds(situation_.now - active.start), active.motion.limits);
  const double here = active.s_at(situation_.now);
  const double rest = std::min(ramp.end().s, active.motion.path.length());
  TellMotion(situation_.now);
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

bool Ride::TakeOver() {
  s_.beside = Beside::kNo;  // from here on it is a motion like any other that is waited for
  if (!busy()) return false;
  if (s_.active) EndHere();
  s_.timeline.clear();
  return true;
}

bool Ride::EndForError() {
  if (!passing() && !busy()) return false;
  if (beside() && s_.active) EndHere();
  EndChain();
  return true;
}

void Ride::Freeze() {
  s_.protocol.Finish();
  if (!s_.active) return;
  TellMotion(situation_.now);
  situation_.machine.axes = axes();
  s_.active.reset();
}

void Ride::TellViolationsToCome() {
  for (auto& [tag, note] : s_.notes) {
    travel_.TellViolations(note.place, std::exchange(note.beyond, {}));
  }
}

void Ride::DropAll() {
  s_.timeline.clear();
  s_.held.clear();
  s_.interrupted.clear();
}

machine::Place Ride::place() const {
  return s_.active && !beside() ? s_.active->note.place : situation_.place;
}

motion::PathState Ride::StateNow() const {
  return s_.active->motion.speed.At(ToSeconds(situation_.now - s_.active->start));
}

motion::TipPose Ride::tip() const {
  if (!s_.active) return head().TipOf(situation_.machine.axes);
  const motion::PlannedMotion& motion = s_.active->motion;
  return motion::TipOn(motion.path, motion.head, motion.path.At(StateNow().s));
}

motion::AxisPose Ride::axes() const {
  if (!s_.active) return situation_.machine.axes;
  const motion::PlannedMotion& motion = s_.active->motion;
  return motion::AxesOn(motion.path, motion.head, motion.path.At(StateNow().s));
}

double Ride::tip_speed_mm_s() const {
  if (!moves()) return 0.0;
  const motion::PathState here = StateNow();
  const motion::PathPiece& path = s_.active->motion.path;
  if (!path.by_sigma()) return here.speed;
  if (path.kind() == motion::PathPiece::Kind::kRotary) return 0.0;
  return motion::PointAt(path, s_.active->motion.head, here).tip_speed();
}

}  // namespace rmlcell::optimo
