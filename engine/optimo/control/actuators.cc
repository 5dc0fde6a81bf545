#include "engine/optimo/control/actuators.h"

#include <algorithm>
#include <utility>

namespace rmlcell::optimo {
namespace {

constexpr int kSensor = 11;  // OL number, OPT-5.39
constexpr double kFullPower = 100.0;
// What ZERO moves at a time, as its moves are told. OPT-4.49
constexpr std::string_view kZeroGroups[] = {"ZERO_Z", "ZERO_AB", "ZERO_XY"};

// Of which only one is on at a time. -1: the output is no gas.
int OtherGas(int index) { return index == kGas2 ? kGas3 : index == kGas3 ? kGas2 : -1; }

}  // namespace

void Actuators::Carry(const PassageEffect& effect) {
  const machine::Place in_execution = std::exchange(situation_.place, effect.place);
  Take(effect);
  situation_.place = in_execution;
}

void Actuators::Take(const PassageEffect& effect) {
  MachineState& machine = situation_.machine;
  switch (effect.kind) {
    case PassageEffect::Kind::kOutput:
      return SetOutput(effect.index, effect.value);
    case PassageEffect::Kind::kAnalogue: {
      float& output = machine.data.oa_physical[static_cast<std::size_t>(effect.index)];
      if (output == static_cast<float>(effect.value)) return;
      output = static_cast<float>(effect.value);
      return telling_.Signal(machine::Signal::kAnalogue, effect.index, effect.value);
    }
    case PassageEffect::Kind::kBeamOn:
      return BeamOn(effect.power);
    case PassageEffect::Kind::kBeamOff:
      Darken();
      situation_.beam.asked = effect.value != 0.0;
      return;
    case PassageEffect::Kind::kSchedule:
      if (machine.schedule == effect.index) return;
      machine.schedule = effect.index;
      return telling_.Signal(machine::Signal::kSchedule, 0, effect.index);
    case PassageEffect::Kind::kTable:
      machine.table_deg = effect.value;
      return telling_.Signal(machine::Signal::kRotaryTable, 0, effect.value);
    case PassageEffect::Kind::kZeroed:
      return TellZeroed(effect.index);
  }
}

void Actuators::SetOutput(int index, double value) {
  Bits& outputs = situation_.machine.data.ol_physical;
  const auto n = static_cast<std::size_t>(index);
  const bool on = value != 0.0;
  if (situation_.gas_refused == index) situation_.gas_refused = 0;
  if (outputs[n] == on) return;
  const int other = OtherGas(index);
  if (on && other >= 0 && outputs[static_cast<std::size_t>(other)]) {
    situation_.gas_refused = index;
    return telling_.Warn(ErrorCode::kGasConflict,
                         "OL[" + std::to_string(index) + "] while another assist gas is on",
                         "OPT-5.40");
  }
  outputs[n] = on;
  telling_.Signal(machine::Signal::kOutput, index, value);
  if (other >= 0) {
    telling_.Signal(machine::Signal::kGas, 0, !on ? 1 : index == kGas2 ? 2 : 3);  // OPT-5.42
  }
  if (index == kSensor) telling_.Signal(machine::Signal::kSensor, 0, value);
}

void Actuators::OpenShutter() {
  Beam& beam = situation_.beam;
  if (beam.shutter_open) return;
  beam.shutter_open = true;
  telling_.Signal(machine::Signal::kShutter, 0, 1.0);
}

void Actuators::CloseShutter() {
  Beam& beam = situation_.beam;
  if (!beam.shutter_open) return;
  beam.shutter_open = false;
  telling_.Signal(machine::Signal::kShutter, 0, 0.0);
}

void Actuators::BeamOn(const machine::PowerBySpeed& power) {
  ride_.TellUpToNow();
  OpenShutter();
  Beam& beam = situation_.beam;
  const bool was_on = std::exchange(beam.on, true);
  beam.asked = true;
  beam.power = power;
  if (!was_on) telling_.Signal(machine::Signal::kBeam, 0, 1.0, power.constant_percent);
}

void Actuators::BeamOff() {
  Darken();
  situation_.beam.asked = false;
}

void Actuators::Darken() {
  Beam& beam = situation_.beam;
  if (!beam.on) return;
  ride_.TellUpToNow();
  beam.on = false;
  telling_.Signal(machine::Signal::kBeam, 0, 0.0);
  if (parameters_.laser == Laser::kEfa51) CloseShutter();  // beam and shutter are one
}

void Actuators::Suspend() {
  if (!situation_.beam.on) return;
  situation_.beam.returns = true;
  Darken();
}

void Actuators::CloseForDoor() {
  const machine::Place in_execution = std::exchange(situation_.place, ride_.place());
  Suspend();
  if (situation_.beam.shutter_open) {
    situation_.beam.shutter_was_open = true;
    CloseShutter();
  }
  situation_.place = in_execution;
}

void Actuators::Restore() {
  Beam& beam = situation_.beam;
  if (std::exchange(beam.shutter_was_open, false)) OpenShutter();
  if (std::exchange(beam.returns, false)) BeamOn(beam.power);
}

void Actuators::AllOff() {
  BeamOff();
  CloseShutter();
  situation_.beam.returns = false;
}

double Actuators::SchedulePower() const {
  if (situation_.machine.schedule == 0 || !setup_.schedules) return kFullPower;
  for (const machine::LaserSchedule& schedule : *setup_.schedules) {
    if (schedule.number == situation_.machine.schedule) return schedule.power_percent;
  }
  return kFullPower;
}

bool Actuators::HasSchedule(int number) const {
  return !setup_.schedules || std::ranges::any_of(*setup_.schedules, [&](const auto& schedule) {
    return schedule.number == number;
  });
}

void Actuators::TellZeroed(int group) {
  const motion::AxisPose axes = ride_.axes();
  telling_.observer().OnMove({.at = situation_.now,
                              .place = situation_.place,
                              .tip = ride_.tip(),
                              .axes = axes,
                              .program_point = motion::ProgramPoint::AsMachine(axes.column),
                              .rotary_a = axes.a_rad,
                              .path = kZeroGroups[group],
                              .programmed = false});
}

}  // namespace rmlcell::optimo
