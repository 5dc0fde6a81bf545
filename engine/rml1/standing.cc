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

// No manual says how fast the keys of a panel are, nor how far a tap turns: LIVE-8.03. Of the
// rotary axis likewise, in degrees.
constexpr double kJogSlow = 1.0;
constexpr double kRotaryStep = 0.01;

}  // namespace

Result<std::unique_ptr<machine::Standing>> MillStanding::Make(Profile profile,
                                                              std::string_view machine_state) {
  std::unique_ptr<MillStanding> made(new MillStanding(std::move(profile)));
  if (!machine_state.empty()) {
    const Result<MachineState> kept = ReadMachineState(machine_state, *made->profile_);
    if (!kept) return kept.error();
    if (kept->origin) {
      Profile as_set = made->as_delivered_;
      UseOrigin(kept->origin, as_set);
      made->UseProfile(std::move(as_set));
    }
    made->device_.Restore(kept->registers, kept->at);
  }
  return std::unique_ptr<machine::Standing>(std::move(made));
}

MillStanding::MillStanding(Profile profile)
    : as_delivered_(std::move(profile)),
      profile_(std::make_unique<const Profile>(as_delivered_)),
      device_(*profile_) {}

// What the device holds goes over to that of the other one.
void MillStanding::UseProfile(Profile profile) {
  auto next = std::make_unique<const Profile>(std::move(profile));
  Device device(*next);
  device.Restore(device_.registers(), device_.carriage().physical());
  device_ = device;
  profile_ = std::move(next);
}

void MillStanding::PressPanel(machine::PanelKey key) {
  const Point at = device_.carriage().physical();
  Registers registers = device_.registers();
  switch (key) {
    case machine::PanelKey::kZ0:
      registers.z0 = at.z;
      break;
    case machine::PanelKey::kOrigin: {
      Profile as_set = *profile_;
      UseOrigin(at, as_set);
      UseProfile(std::move(as_set));
      break;
    }
    case machine::PanelKey::kView:
    case machine::PanelKey::kHome:
    case machine::PanelKey::kSpindle:
      break;
  }
  device_.Restore(registers, at);
}

// Up, and across: HOME to the origin as H does (RML1-3A.40); VIEW to the corner where the table is
// farthest out, which no manual tells.
std::vector<motion::AxisPose> MillStanding::WayOf(machine::PanelKey key) const {
  const bool home = key == machine::PanelKey::kHome;
  const double mm = 1.0 / profile_->units_per_mm;
  motion::AxisPose up = state().axes;
  up.column.z() = profile_->z.high * mm;
  motion::AxisPose there = up;
  there.column.x() = (home ? profile_->origin_x : profile_->x.low) * mm;
  there.column.y() = (home ? profile_->origin_y : profile_->y.high) * mm;
  return {up, there};
}

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
  const double step = profile_->jog_step_mm;
  how.least = {step, step, step, kRotaryStep * kRadPerDegree, 0.0};
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

void MillStanding::CyclePower() {
  UseProfile(as_delivered_);
  device_ = Device(*profile_);
}

std::vector<machine::StateItem> MillStanding::items() const {
  return ItemsOf(device_, *profile_, tool(), "not known");
}

std::string MillStanding::Save() const {
  return WriteMachineState({.registers = device_.registers(),
                            .at = device_.carriage().physical(),
                            .origin = OriginOf(*profile_)});
}

}  // namespace rmlcell::rml1
