#pragma once

#include <memory>

#include "engine/machine/driver.h"

namespace rmlcell::machine {

// Drives a virtual machine along a clock: its time is `factor` times as fast, in every state
// (LIVE-3.11). What it is late by is made up for, up to kMadeUp of the clock; beyond that its time
// goes on from where it stands: it never jumps, and nothing is left out (LIVE-3.14). So whoever has
// a run open, or moves the machine by hand, calls more often than that; one that stands may sleep.
class VirtualDriver final : public MachineDriver {
 public:
  static constexpr double kFactorMin = 0.1;
  static constexpr double kFactorMax = 100.0;
  static constexpr SimTime kMadeUp = std::chrono::milliseconds(100);
  // Whoever drives what moves may sleep so long between two calls: that is not late.
  static constexpr SimTime kTurn = std::chrono::microseconds(25'500);

  // The time of the machine goes on from here.
  VirtualDriver(std::unique_ptr<Machine> machine, SimTime clock);

  DriverCapabilities capabilities() const override;
  Status Start(SimTime clock, const StartRun& run) override { return Order(clock, run); }
  Status Order(SimTime clock, const MachineInput& input) override;
  Progress Pump(SimTime clock) override;
  MachineStatus status() const override { return machine_->status(); }

  // Errors: CellInvalidArgument outside kFactorMin to kFactorMax.
  Status SetFactor(SimTime clock, double factor);
  double factor() const { return factor_; }
  // The time of the machine stands, and nothing of it is made up for, as long as it waits.
  void Wait(bool waits, SimTime clock);
  // Time of the clock that was given up since the last call, because it was late.
  SimTime TakeLost() { return std::exchange(lost_, SimTime(0)); }

  const Machine& machine() const { return *machine_; }
  Machine& machine() { return *machine_; }

 private:
  SimTime DueAt(SimTime clock) const;
  SimTime LateAt(SimTime clock) const;  // of the clock
  bool Moves() const;                   // a run is open, or it is moved by hand
  void Anchor(SimTime clock);
  void GiveUp(SimTime late, SimTime clock);

  std::unique_ptr<Machine> machine_;
  double factor_ = 1.0;
  SimTime clock_;  // at the anchor
  SimTime time_;   // of the machine there
  SimTime last_;   // call
  SimTime lost_{0};
  bool waits_ = false;
};

}  // namespace rmlcell::machine
