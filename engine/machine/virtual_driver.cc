#include "engine/machine/virtual_driver.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/machine/machine_states.h"

namespace rmlcell::machine {

VirtualDriver::VirtualDriver(std::unique_ptr<Machine> machine, SimTime clock)
    : machine_(std::move(machine)), clock_(clock), time_(machine_->time()), last_(clock) {}

DriverCapabilities VirtualDriver::capabilities() const {
  return {.inputs = machine_->has_inputs(),
          .variables = machine_->has_inputs(),
          .breakpoints = machine_->family().info().has_breakpoints};
}

SimTime VirtualDriver::DueAt(SimTime clock) const {
  const double since_ns = static_cast<double>((clock - clock_).count());
  return std::max(machine_->time(), time_ + SimTime(std::llround(factor_ * since_ns)));
}

void VirtualDriver::Anchor(SimTime clock) {
  clock_ = clock;
  time_ = machine_->time();
}

// That time of the clock never was one of the machine.
void VirtualDriver::GiveUp(SimTime late, SimTime clock) {
  lost_ += late;
  Anchor(clock);
}

SimTime VirtualDriver::LateAt(SimTime clock) const {
  const SimTime behind = DueAt(clock) - machine_->time();
  return SimTime(std::llround(static_cast<double>(behind.count()) / factor_));
}

bool VirtualDriver::Moves() const {
  const MachineStatus now = machine_->status();
  return now.open || MovesAxes(now.state);
}

Progress VirtualDriver::Pump(SimTime clock) {
  const SimTime slept = clock - std::exchange(last_, clock);
  if (waits_) {
    Anchor(clock);
    return Progress::kReached;
  }
  if (slept > kTurn + kMadeUp && Moves()) {
    GiveUp(LateAt(clock), clock);
    return Progress::kReached;
  }
  if (machine_->Advance(DueAt(clock)) == Progress::kReached) return Progress::kReached;
  if (LateAt(clock) > kMadeUp) GiveUp(LateAt(clock), clock);
  return Progress::kMoreWork;
}

void VirtualDriver::Wait(bool waits, SimTime clock) {
  if (waits == waits_) return;
  Anchor(last_ = clock);
  waits_ = waits;
}

// It acts where the machine is: never at a time before.
Status VirtualDriver::Order(SimTime clock, const MachineInput& input) {
  Pump(clock);
  return machine_->Apply(input);
}

Status VirtualDriver::SetFactor(SimTime clock, double factor) {
  if (!(factor >= kFactorMin && factor <= kFactorMax)) {
    return Error{ErrorCode::kCellInvalidArgument,
                 "a factor of " + Told("factor", factor, "", ShortestText(factor)) + ": it is " +
                     Told("least", kFactorMin, "", ShortestText(kFactorMin)) + " to " +
                     Told("most", kFactorMax, "", ShortestText(kFactorMax)),
                 {}};
  }
  Pump(clock);
  GiveUp(LateAt(clock), clock);  // with another factor it means another time
  factor_ = factor;
  return {};
}

}  // namespace rmlcell::machine
