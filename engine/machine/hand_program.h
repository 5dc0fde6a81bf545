#pragma once

#include <memory>
#include <optional>

#include "engine/core/result.h"
#include "engine/machine/family.h"
#include "engine/machine/hand_way.h"
#include "engine/machine/observer.h"
#include "engine/machine/run.h"
#include "engine/machine/run_setup.h"

namespace rmlcell::machine {

// HOME and ZERO beside a run that is held: what they do as runs of their own where none is open. A
// machine has one run: this one has no number, nobody is told of it, and of what it leaves counts
// where the axes are.
class HandProgram final : public HandWay {
 public:
  // Errors: those of MachineFamily::NewRun, and of a motion that cannot be: nothing has moved then.
  static Result<std::unique_ptr<HandProgram>> Make(const MachineFamily& family, RunSetup setup,
                                                   HandRun what, SimTime now);

  void Advance(SimTime until) override;
  void Brake() override;

  bool rests() const override { return run_->state().phase != RunPhase::kRunning; }
  bool brakes() const override { return brakes_; }
  motion::AxisPose axes() const override { return run_->state().axes; }
  double tip_speed_mm_s() const override { return run_->state().tip_speed_mm_s; }

  std::optional<HandRun> what() const override { return what_; }
  void ChangeOverride(double percent) override;
  bool zeroed() const override { return run_->state().zeroed; }

 private:
  HandProgram(HandRun what, SimTime now) : what_(what), begun_(now) {}

  const HandRun what_;
  const SimTime begun_;
  bool brakes_ = false;
  RunObserver nobody_;
  std::unique_ptr<Run> run_;
};

}  // namespace rmlcell::machine
