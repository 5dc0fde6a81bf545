#pragma once

#include <optional>
#include <span>
#include <utility>

#include "engine/machine/run.h"

namespace rmlcell::simulation {

// Takes a run through virtual time, past halts that scripted inputs end.
class Drive {
 public:
  // `input_times`: of the script, in order. Both must outlive this.
  Drive(machine::Run& run, std::span<const SimTime> input_times)
      : run_(run), input_times_(input_times) {}

  // Goes on by `slice` of virtual time, at most. While halted with scripted inputs to come, up to
  // the next of them. kHalted: nothing scripted will make it go on.
  machine::RunPhase Step(SimTime slice);

  // START, where it is halted. False: the START before changed nothing, and none ever will.
  bool Start();
  // Where it is halted: START, or its end where that changes nothing (CellWaitsForever). True: it
  // was started.
  bool StartOrEnd();

  void End(machine::OutcomeKind kind, ErrorCode code);

  machine::Run& run() { return run_; }
  const machine::Run& run() const { return run_; }
  machine::RunPhase phase() const { return phase_; }
  bool finished() const { return phase_ == machine::RunPhase::kFinished; }

 private:
  machine::Run& run_;
  std::span<const SimTime> input_times_;
  machine::RunPhase phase_ = machine::RunPhase::kRunning;
  std::optional<std::pair<SimTime, std::uint64_t>> started_;  // where START was last given
};

}  // namespace rmlcell::simulation
