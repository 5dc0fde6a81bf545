#include "engine/machine/hand_program.h"

#include <utility>

namespace rmlcell::machine {

// Up to its first motion no time passes: what cannot be is known before anything moves.
Result<std::unique_ptr<HandProgram>> HandProgram::Make(const MachineFamily& family, RunSetup setup,
                                                       HandRun what, SimTime now) {
  std::unique_ptr<HandProgram> made(new HandProgram(what, now));
  Result<std::unique_ptr<Run>> run = family.NewRun(std::move(setup), made->nobody_);
  if (!run) return run.error();
  made->run_ = *std::move(run);
  made->Advance(now);
  if (!made->rests()) return made;
  const Outcome& outcome = made->run_->outcome();
  if (outcome.code) return Error{*outcome.code, outcome.detail, {}};
  return made;
}

void HandProgram::Advance(SimTime until) {
  const SimTime of_run = until - begun_;
  while (run_->Advance(of_run) == RunPhase::kRunning && run_->state().time < of_run) {
  }
}

// At rest it is over: nothing lets it go on.
void HandProgram::Brake() {
  if (std::exchange(brakes_, true)) return;
  run_->Apply({.kind = InputKind::kStop});
}

void HandProgram::ChangeOverride(double percent) {
  run_->Apply({.kind = InputKind::kOverride, .value = percent});
}

}  // namespace rmlcell::machine
