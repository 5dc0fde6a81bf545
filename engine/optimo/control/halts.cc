#include "engine/optimo/control/halts.h"

#include <algorithm>
#include <utility>

namespace rmlcell::optimo {

bool Halts::due() const {
  return (s_.hold && !waits_.condition_met()) || (s_.stop && !ride_.passing()) ||
         s_.after_step != AfterStep::kNone;
}

bool Halts::idle() const {
  return !s_.hold && !s_.stop && s_.after_step == AfterStep::kNone && !s_.breakpoint &&
         s_.watched.empty() && !s_.watched_halts && situation_.mode != machine::Mode::kSingle;
}

bool Halts::breaks_at(const machine::Place& place) const {
  return s_.breakpoint && s_.breakpoint->program == place.program &&
         s_.breakpoint->step == place.step;
}

bool Halts::Counts(const WatchedStep& step) const {
  return !step.condition || data_.HoldsNow(*step.condition);
}

// An instruction that waits for its condition: its EndStep is to come.
bool Halts::IsBegun() const { return waits_.pending().kind == Pending::Kind::kCondition; }

// Something of an instruction is not over, whether its EndStep was or not.
bool Halts::IsUnderWay() const {
  const bool interrupted = ride_.protocol().intent() == motion::RideIntent::kStop;
  return ride_.busy() || ride_.passing() || interrupted || waits_.waits();
}

// From where the machine is to where the program is: a chain of /FLY moves.
bool Halts::IsReadAhead(const machine::ProgramStep& step) const {
  const machine::Place from = ride_.motion_place();
  const machine::Place to = s_.place_ahead.value_or(situation_.place);
  return step.program == to.program && step.step <= to.step &&
         step.step >= (from.program == to.program ? std::min(from.step, to.step) : to.step);
}

void Halts::Watch(std::vector<WatchedStep> steps) {
  const bool under_way = IsUnderWay();
  const bool was_due = s_.watched_halts || s_.after_step == AfterStep::kWatched;
  bool due = false;
  for (WatchedStep& step : steps) {
    const bool here = under_way && IsReadAhead(step.breakpoint.at);
    const auto before = std::ranges::find(s_.watched, step.breakpoint, &WatchedStep::breakpoint);
    if (before != s_.watched.end()) {
      step.passes = before->passes;
      due = due || (here && was_due && step.due());
    } else if (here && Counts(step)) {  // it was begun before anybody asked
      ++step.passes;
      due = due || step.due();
    }
  }
  s_.watched = std::move(steps);
  s_.watched_halts = due && IsBegun();
  if (IsBegun()) return;
  if (due && s_.after_step != AfterStep::kBreak) s_.after_step = AfterStep::kWatched;
  if (!due && s_.after_step == AfterStep::kWatched) {
    s_.after_step = AfterStep::kNone;
    SetMode(situation_.mode);
  }
}

void Halts::BeginStep(const machine::Place& place) {
  s_.watched_halts = false;
  for (WatchedStep& step : s_.watched) {
    const machine::ProgramStep& at = step.breakpoint.at;
    if (at.program != place.program || at.step != place.step || !Counts(step)) continue;
    ++step.passes;
    s_.watched_halts = s_.watched_halts || step.due();
  }
}

void Halts::SetMode(machine::Mode mode) {
  situation_.mode = mode;
  if (mode == machine::Mode::kSingle) {
    if (s_.after_step == AfterStep::kNone && IsUnderWay() && !IsBegun())
      s_.after_step = AfterStep::kSingle;
  } else if (s_.after_step == AfterStep::kSingle) {
    s_.after_step = AfterStep::kNone;
  }
}

bool Halts::will_halt_behind(const machine::Place& place) const {
  return situation_.mode == machine::Mode::kSingle || s_.hold || s_.watched_halts ||
         breaks_at(place);
}

void Halts::Hold() {
  s_.hold = true;
  if (situation_.running()) ride_.Hold();
}

void Halts::Stop() {
  if (!situation_.running() || !ride_.protocol().may_stop()) return;
  if (!ride_.busy() && !ride_.passing()) return Halt(machine::HaltReason::kStop, "STOP");
  const motion::MotionUnderWay* active = ride_.under_way();
  s_.stop = active == nullptr || active->ended || !ride_.Stop();
  if (!s_.stop && !ride_.busy()) HaltOnPath();
}

bool Halts::StopNow() {
  const motion::MotionUnderWay* active = ride_.under_way();
  // What /END or /TIME brings to rest comes to rest first, and what follows begins from there.
  if (!s_.stop || active == nullptr || active->ended || !ride_.Stop()) return false;
  s_.stop = false;
  if (ride_.busy()) return false;
  HaltOnPath();
  return true;
}

void Halts::EndStep(const machine::Place& place) {
  if (breaks_at(place)) {
    s_.after_step = AfterStep::kBreak;
  } else if (s_.watched_halts) {
    s_.after_step = AfterStep::kWatched;
  } else if (situation_.mode == machine::Mode::kSingle) {
    s_.after_step = AfterStep::kSingle;
  }
}

bool Halts::HaltHere(bool program_over) {
  const AfterStep after_step = std::exchange(s_.after_step, AfterStep::kNone);
  if (after_step == AfterStep::kNone) {
    HaltByKey(s_.stop);
    return true;
  }
  if (program_over) return false;
  const bool at_break = after_step != AfterStep::kSingle;
  Halt(at_break ? machine::HaltReason::kBreakpoint : machine::HaltReason::kSingle,
       at_break ? "BREAK" : "SINGLE");
  return true;
}

void Halts::HaltByKey(bool stop) {
  Halt(stop ? machine::HaltReason::kStop : machine::HaltReason::kHold, stop ? "STOP" : "HOLD");
}

void Halts::Halt(machine::HaltReason reason, std::string_view why) {
  waits_.Tell();
  situation_.phase = machine::RunPhase::kHalted;
  s_.halted_by = reason;
  s_.halted_at = situation_.now;
  s_.hold = false;
  s_.stop = false;
  actuators_.Hold();
  telling_.observer().OnHalt(
      {.at = situation_.now, .place = situation_.place, .reason = reason, .why = why});
}

void Halts::HaltOnPath() {
  const bool holds = ride_.protocol().intent() == motion::RideIntent::kHold;
  s_.place_ahead = std::exchange(situation_.place, ride_.Rest());
  HaltByKey(!holds);
}

void Halts::Tell() const {
  if (situation_.now <= s_.halted_at) return;
  telling_.observer().OnWait({.start = s_.halted_at,
                              .end = situation_.now,
                              .place = situation_.place,
                              .kind = machine::WaitKind::kOperator});
}

Status Halts::Resume() {
  Tell();
  // Whatever was under way lasts as long as before: time stood still for it.
  const SimTime stood = situation_.now - s_.halted_at;
  counter_.Shift(stood);
  waits_.Shift(stood);
  watch_.Shift(stood);
  works_.Shift(stood);
  situation_.phase = machine::RunPhase::kRunning;
  telling_.observer().OnResume(situation_.now, situation_.place);
  actuators_.Return();
  const Status rides = ride_.Resume();
  const std::optional<machine::Place> ahead = std::exchange(s_.place_ahead, std::nullopt);
  if (ahead && rides) situation_.place = *ahead;
  return rides;
}

}  // namespace rmlcell::optimo
