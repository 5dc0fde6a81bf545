#include "engine/optimo/control/halts.h"

#include <utility>

namespace rmlcell::optimo {

bool Halts::due() const {
  const HaltRequests& requests = s_.requests;
  return (requests.hold && !waits_.condition_met()) || (requests.stop && !ride_.passing()) ||
         !requests.after_step.empty();
}

void Halts::Hold() {
  s_.requests.hold = true;
  if (situation_.running()) ride_.Hold();
}

void Halts::Stop() {
  if (!situation_.running() || !ride_.protocol().may_stop()) return;
  if (!ride_.busy() && !ride_.passing()) return Halt("STOP");
  const motion::MotionUnderWay* active = ride_.under_way();
  s_.requests.stop = active == nullptr || active->ended || !ride_.Stop();
  if (!s_.requests.stop && !ride_.busy()) HaltOnPath();
}

void Halts::EndStep(const machine::Place& place) {
  if (s_.requests.breaks_at(place)) {
    s_.requests.after_step = "BREAK";
  } else if (situation_.mode == machine::Mode::kSingle) {
    s_.requests.after_step = "SINGLE";
  }
}

void Halts::Halt(std::string_view why) {
  waits_.Tell();
  situation_.phase = machine::RunPhase::kHalted;
  s_.halted_at = situation_.now;
  s_.requests.hold = false;
  s_.requests.stop = false;
  actuators_.Hold();
  telling_.observer().OnHalt({.at = situation_.now, .place = situation_.place, .why = why});
}

void Halts::HaltOnPath() {
  const bool holds = ride_.protocol().intent() == motion::RideIntent::kHold;
  s_.place_ahead = std::exchange(situation_.place, ride_.Rest());
  Halt(holds ? "HOLD" : "STOP");
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
