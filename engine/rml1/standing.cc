#include "engine/rml1/standing.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/rml1/machine_state.h"
#include "engine/rml1/state_items.h"
#include "engine/rml1/timing.h"
#include "engine/rml1/variables.h"

namespace rmlcell::rml1 {
namespace {

// No manual says how fast the keys of a panel are, nor how far a tap goes: LIVE-8.03. Of the rotary
// axis likewise, in degrees.
constexpr double kJogSlow = 1.0;
constexpr double kJogStep = 0.01;

}  // namespace

Result<std::unique_ptr<machine::Standing>> MillStanding::Make(Profile profile,
                                                              std::string_view machine_state) {
  std::unique_ptr<MillStanding> made(new MillStanding(std::move(profile)));
  if (!machine_state.empty()) {
    const Result<MachineState> kept = ReadMachineState(machine_state, *made->profile_);
    if (!kept) return kept.error();
    made->device_.Restore(kept->registers, kept->at);
  }
  return std::unique_ptr<machine::Standing>(std::move(made));
}

MillStanding::MillStanding(Profile profile)
    : profile_(std::make_unique<const Profile>(std::move(profile))), device_(*profile_) {}

ToolNow MillStanding::tool() const {
  return {.at = device_.carriage().physical(), .spindle_turns = device_.spindle_turns()};
}

machine::RunState MillStanding::state() const {
  machine::RunState state;
  state.phase = machine::RunPhase::kFinished;
  state.tip = PoseOf(*profile_, tool().at);
  state.axes = {.column = state.tip.tip, .a_rad = state.tip.a_rad, .b_rad = 0.0};
  state.spindle_on = tool().spindle_turns;
  state.work_origin =
      motion::MachinePoint(profile_->origin_x, profile_->origin_y, device_.registers().z0) /
      profile_->units_per_mm;
  return state;
}

std::optional<machine::VariableValue> MillStanding::ReadVariable(std::string_view name) const {
  return ReadRegister(device_, *profile_, tool(), name);
}

std::vector<machine::ModalValue> MillStanding::modal_values() const {
  return ModalRegisters(device_, *profile_, tool());
}

std::optional<machine::HandMotion> MillStanding::ByHand(double /*override_percent*/,
                                                        bool fast) const {
  constexpr double kNoEnd = std::numeric_limits<double>::infinity();
  const motion::MachineLimits limits = MillLimits(*profile_);
  const double mm = 1.0 / profile_->units_per_mm;
  machine::HandMotion how;
  how.machine = {.head = motion::MillHead(),
                 .axes = limits.axes,
                 .tip_acceleration_mm_s2 = limits.tip_acceleration_mm_s2,
                 .tip_jerk_mm_s3 = limits.tip_jerk_mm_s3};
  motion::AxisLimits& axes = how.machine.axes;
  axes.jerk.setConstant(kNoEnd);
  axes.travel_min = {profile_->x.low * mm, profile_->y.low * mm, profile_->z.low * mm, -kNoEnd,
                     0.0};
  axes.travel_max = {profile_->x.high * mm, profile_->y.high * mm, profile_->z.high * mm, kNoEnd,
                     0.0};
  // The highest of Z is that of V and !VZ, which the way down is limited to in programs, too.
  how.plus = axes.speed;
  const motion::AxisValues slow = {kJogSlow, kJogSlow, kJogSlow, kJogSlow * kRadPerDegree, 0.0};
  if (!fast) how.plus = how.plus.cwiseMin(slow);
  if (!profile_->has_y) how.plus[1] = 0.0;
  if (!profile_->has_rotary) how.plus[3] = 0.0;
  how.minus = how.plus;
  how.least = {kJogStep, kJogStep, kJogStep, kJogStep * kRadPerDegree, 0.0};
  return how;
}

void MillStanding::MoveTo(const motion::AxisPose& axes) {
  const double units = profile_->units_per_mm;
  const double sense = profile_->rotary_reversed ? -1.0 : 1.0;
  device_.Restore(device_.registers(), {.x = axes.column.x() * units,
                                        .y = axes.column.y() * units,
                                        .z = axes.column.z() * units,
                                        .a = sense * axes.a_rad / kRadPerDegree});
}

void MillStanding::Rest() {
  Registers registers = device_.registers();
  registers.spindle_on = false;
  device_.Restore(registers, device_.carriage().physical());
}

void MillStanding::CyclePower() { device_ = Device(*profile_); }

std::vector<machine::StateItem> MillStanding::items() const {
  return ItemsOf(device_, *profile_, tool(), "not known");
}

std::string MillStanding::Save() const {
  return WriteMachineState({.registers = device_.registers(), .at = device_.carriage().physical()});
}

}  // namespace rmlcell::rml1
