#include "engine/optimo/control/halts.h"

#include <utility>

namespace rmlcell::optimo {

bool Halts::due() const {
  return (s_.hold && !waits_.condition_met()) || (s_.stop && !ride_.passing()) ||
         s_.after_step != AfterStep::kNone;
}

bool Halts::breaks_at(const machine::Place& place) const {
  return s_.watched_halts || (s_.breakpoint && s_.breakpoint->program == place.program &&
                              s_.breakpoint->step == place.step);
}

void Halts::Watch(std::vector<WatchedStep> steps) {
  s_.watched = std::move(steps);
  s_.watched_halts = false;
}

void Halts::BeginStep(const machine::Place& place) {
  s_.watched_halts = false;
  for (WatchedStep& step : s_.watched) {
    if (step.at.program != place.program || step.at.step != place.step) continue;
    if (step.condition && !data_.HoldsNow(*step.condition)) continue;
    if (++step.passes >= step.from_pass) s_.watched_halts = true;
  }
}

// What is under way has had its EndStep, but for an instruction that waits for its condition.
void Halts::SetMode(machine::Mode mode) {
  situation_.mode = mode;
  const bool begun = waits_.waits() && waits_.pending().kind == Pending::Kind::kCondition;
  if (mode == machine::Mode::kSingle && situation_.running() && !begun &&
      (ride_.busy() || ride_.passing() || waits_.waits())) {
    s_.after_step = AfterStep::kSingle;
  }
}

bool Halts::will_halt_behind(const machine::Place& place) const {
  return situation_.mode == machine::Mode::kSingle || s_.hold || breaks_at(place);
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
  const bool at_break = after_step == AfterStep::kBreak;
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

void Halts::Resume() {
  Tell();
  // A wait that was under way lasts as long as before: time stood still for it.
  const SimTime stood = situation_.now - s_.halted_at;
  waits_.Shift(stood);
  works_.Shift(stood);
  situation_.phase = machine::RunPhase::kRunning;
  telling_.observer().OnResume(situation_.now, situation_.place);
  actuators_.Return();
  ride_.Resume();
  if (s_.place_ahead) situation_.place = *std::exchange(s_.place_ahead, std::nullopt);
}

}  // namespace rmlcell::optimo
