#include "engine/simulation/run/drive.h"

#include <algorithm>

namespace rmlcell::simulation {
namespace {

SimTime Later(SimTime time, SimTime by) { return time > kForever - by ? kForever : time + by; }

}  // namespace

machine::RunPhase Drive::Step(SimTime slice) {
  if (finished()) return phase_;
  // Also for a slice of zero: a caller that does not advance must not loop for ever.
  const SimTime now = run_.state().time;
  phase_ = run_.Advance(Later(now, std::max(slice, SimTime(1))));
  while (phase_ == machine::RunPhase::kHalted) {
    // Scripted inputs end a halt when their time comes, however long that is.
    const SimTime before = run_.state().time;
    const auto next = std::ranges::upper_bound(input_times_, before);
    if (next == input_times_.end()) break;
    phase_ = run_.Advance(*next);
    if (phase_ == machine::RunPhase::kHalted && run_.state().time == before) break;
  }
  return phase_;
}

bool Drive::Start() {
  const std::pair here{run_.state().time, run_.steps_executed()};
  if (started_ == here) return false;
  started_ = here;
  run_.Apply({here.first, machine::InputKind::kStart, 0, 1.0});
  return true;
}

bool Drive::StartOrEnd() {
  if (Start()) return true;
  End(machine::OutcomeKind::kStopped, ErrorCode::kCellWaitsForever);
  return false;
}

void Drive::End(machine::OutcomeKind kind, ErrorCode code) {
  if (finished()) return;
  run_.End(kind, code);
  phase_ = machine::RunPhase::kFinished;
}

}  // namespace rmlcell::simulation
