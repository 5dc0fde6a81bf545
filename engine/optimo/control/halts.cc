#include "engine/optimo/control/halts.h"

#include <utility>

namespace rmlcell::optimo {

bool Halts::due() const {
  const HaltRequests& requests = s_.requests;
  return (requests.hold && !waits_.condition_met()) || (requests.stop && !ride_.passing()) ||
         !requests.after_step.empty();
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
