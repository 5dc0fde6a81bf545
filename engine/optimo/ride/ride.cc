#include "engine/optimo/ride/ride.h"

#include <algorithm>
#include <utility>

#include "engine/optimo/machine/motion_errors.h"

namespace rmlcell::optimo {
namespace {

// Instructions that run ahead between two motions of a /FLY passage. A loop without motion would
// run ahead for ever; a passage that needs more than this becomes a stop.
constexpr int kRunAheadMax = 10'000;

template <class Notes>
auto* Find(Notes& notes, std::uint64_t tag) {
  if (!notes.empty() && notes.front().first == tag) return &notes.front().second;  // mostly
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
    s_.path.Plan(std::move(*item));
}

Status Ride::Append(motion::MoveCommand&& command, const MoveNote& note) {
  RMLCELL_CHECK(s_.program == GoesOn::kNo || passing());
  command.tag = s_.next_tag++;
  if (const Status appended = s_.planner.Append(command); !appended)
    return OnOptimo(appended.error());
  s_.notes.emplace_back(command.tag, note);
  s_.planned_axes = motion::AxesOn(command.path, command.head, command.path.to());
  if (note.fly || passing()) {
    s_.path.Append({.tag = command.tag, .move = command});
  } else {
    s_.alone.push_back({.tag = command.tag, .move = command});
  }
  s_.program = note.fly ? GoesOn::kAhead : GoesOn::kNo;
  s_.run_ahead = 0;
  Drain();
  return {};
}

std::uint64_t Ride::AppendMark() {
  const std::uint64_t tag = s_.next_tag++;
  if (passing()) s_.path.Append({.tag = tag, .move = std::nullopt});
  s_.planner.Mark(tag);
  Drain();
  return tag;
}

void Ride::EndChain() {
  s_.planner.Stop();
  if (passing()) s_.program = GoesOn::kNo;
  Drain();
}

void Ride::GoOnBeside(std::uint64_t tag, bool ran_ahead) {
  EndChain();
  if (ran_ahead) {
    s_.program = GoesOn::kComes;
    s_.beside_from = tag;
  } else {
    s_.program = busy() ? GoesOn::kBeside : GoesOn::kNo;
  }
  Start();
}

bool Ride::RunsAhead() {
  if (may_run_ahead() == 0) return false;
  RanAhead(1);
  return true;
}

int Ride::may_run_ahead() const { return std::max(0, kRunAheadMax - s_.run_ahead); }

void Ride::Start() {
  while (waits_to_start()) {
    if (const std::optional<std::uint64_t> mark = s_.path.PassMark()) {
      listener_.OnMark(*mark);
      continue;
    }
    const motion::PlannedMotion& motion = s_.path.Begin(situation_.now).motion;
    const std::uint64_t tag = motion.tag;
    s_.note = {};
    while (!s_.notes.empty() && s_.notes.front().first < tag) s_.notes.pop_front();
    if (s_.program == GoesOn::kComes && tag >= s_.beside_from) s_.program = GoesOn::kBeside;
    if (MoveNote* note = NoteOf(tag)) {
      travel_.TellViolations(note->place, std::exchange(note->beyond, {}));
      s_.note = *note;
    }
    travel_.TellSpeedHeld(motion, s_.note.place, s_.note.feed_mm_s);
    std::erase_if(s_.alone, [tag](const auto& command) { return command.tag < tag; });
    s_.path.ForgetBefore(tag);
    listener_.OnMotionBegins(tag);
    if (s_.override_owed && protocol().Override()) AdaptMotions();
  }
}

SimTime Ride::NextEvent() const {
  if (under_way() != nullptr) return under_way()->end;
  return more_to_come() ? situation_.now : kForever;
}

void Ride::TellUpToNow() {
  if (under_way() != nullptr) TellMotion(situation_.now);
}

// Reports the part of the motion under way from what was told up to `until`.
void Ride::TellMotion(SimTime until) {
  motion::MotionUnderWay& active = *s_.path.under_way();
  if (until <= active.told && until < active.end) return;
  const machine::MotionDone done{
      .start = active.told,
      .end = until,
      .place = s_.note.place,
      .use = beam_.on() ? machine::MotionUse::kCut : machine::MotionUse::kTravel,
      .motion = &active.motion,
      .from = active.PlaceAt(active.told),
      .travelled = active.PlaceAt(until),
      .profile_start_s = ToSeconds(active.told - active.start),
      .programmed_mm_s = s_.note.feed_mm_s,
      .in_work = !s_.note.approach,
      .beam_on = beam_.on(),
      .power = beam_.power(),
      .approach = s_.note.approach};
  listener_.OnMotionTold(done);
  telling_.observer().OnMotion(done);
  active.told = until;
}

void Ride::Arrive() {
  TellMotion(under_way()->end);
  s_.path.Leave();
  const motion::MotionUnderWay& done = s_.path.place();
  s_.axes = done.AxesAt(done.arrival);
  const bool ends_here = done.ended && !more_to_come();
  if (ends_here) {
    s_.path.DropRest();
    s_.planned_axes = s_.axes;
  }
  if (!busy() && !protocol().comes_to_rest()) EndBeside();
  if (ends_here || done.motion.ends_move) TellEnd(done.motion, ends_here);
}

// `here`: wherever that is.
void Ride::TellEnd(const motion::PlannedMotion& motion, bool here) {
  const motion::CornerReport& corner = motion.corner;
  if (corner.passage == motion::Passage::kStopReversal) {
    telling_.WarnAt(s_.note.place, ErrorCode::kFlyReversal,
                    "the path turns back: the machine stops at the target", "OPT-B.25");
  }
  if (corner.passage == motion::Passage::kStopNeighbour) {
    telling_.WarnAt(
        s_.note.place, ErrorCode::kFlyCancelled,
        "/FLY beside a motion that cannot be passed into: the machine stops at the target",
        "OPT-2.48");
  }
  if (!s_.note.last && !here) return;
  telling_.observer().OnMove({.at = situation_.now,
                              .place = s_.note.place,
                              .tip = head().TipOf(s_.axes),
                              .axes = s_.axes,
                              .program_point = s_.note.program_point,
                              .rotary_a = s_.note.program_a,
                              .feed_mm_s = s_.note.feed_mm_s,
                              .path = NameOfPath(s_.note.path),
                              .programmed = !s_.note.approach,
                              .approach = s_.note.approach});
  listener_.OnMoveOver(motion.tag);
}

bool Ride::EndHere() {
  if (settles()) return false;
  const auto plan = s_.path.PlanStop(situation_.now, parameters_.limits.axes);
  if (!plan) return false;
  TellMotion(situation_.now);
  s_.axes = axes();
  s_.path.EndBy(*plan);
  Start();
  return true;
}

bool Ride::settles() const {
  const motion::MotionUnderWay& active = *under_way();
  return active.motion.speed.end().speed == 0.0 &&
         active.PlaceAt(situation_.now) >= active.motion.path.length();
}

// What the program goes on beside is over; a passage stays open.
void Ride::EndBeside() {
  if (!passing()) s_.program = GoesOn::kNo;
}

bool Ride::TakeOver() {
  EndBeside();  // from here on it is a motion like any other that is waited for
  if (!busy()) return false;
  if (under_way() == nullptr || !EndHere()) s_.path.DropRest();
  return true;
}

bool Ride::EndForError(bool at_once) {
  if (!passing() && !busy()) return false;
  EndChain();
  if (at_once && (under_way() == nullptr || !EndHere())) s_.path.DropRest();
  return busy();
}

void Ride::Freeze() {
  if (under_way() != nullptr) {
    TellMotion(situation_.now);
    s_.axes = axes();
  }
  s_.path.Finish();
}

void Ride::TellViolationsToCome() {
  for (auto& [tag, note] : s_.notes) {
    travel_.TellViolations(note.place, std::exchange(note.beyond, {}));
  }
}

machine::Place Ride::place() const {
  return under_way() != nullptr && !beside() ? s_.note.place : situation_.place;
}

motion::TipPose Ride::tip() const {
  if (under_way() == nullptr) return head().TipOf(s_.axes);
  return under_way()->TipAt(situation_.now);
}

motion::AxisPose Ride::axes() const {
  if (under_way() == nullptr) return s_.axes;
  return under_way()->AxesAt(situation_.now);
}

double Ride::tip_speed_mm_s() const {
  return moves() ? under_way()->TipSpeedAt(situation_.now) : 0.0;
}

}  // namespace rmlcell::optimo
