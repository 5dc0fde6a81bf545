#include "engine/optimo/control/actuators.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace rmlcell::optimo {
namespace {

constexpr int kSensor = 11;  // OL number, OPT-5.39
constexpr double kFullPower = 100.0;
// What ZERO moves at a time, as its moves are told. OPT-4.49
constexpr std::string_view kZeroGroups[] = {"ZERO_Z", "ZERO_AB", "ZERO_XY"};

// Of which only one is on at a time. Nothing: the output is no gas.
std::optional<std::size_t> OtherGas(int index) {
  if (index == kGas2) return kGas3;
  if (index == kGas3) return kGas2;
  return std::nullopt;
}

constexpr int kLastZeroGroup = 2;  // X and Y: Moves::ZeroAxes

}  // namespace

void Actuators::Carry(const PassageEffect& effect) {
  const machine::Place in_execution = std::exchange(situation_.place, effect.place);
  Take(effect);
  situation_.place = in_execution;
}

void Actuators::Take(const PassageEffect& effect) {
  switch (effect.kind) {
    case PassageEffect::Kind::kOutput:
      return SetOutput(effect.index, effect.value);
    case PassageEffect::Kind::kAnalogue: {
      float& output = s_.outputs.analogue[static_cast<std::size_t>(effect.index)];
      if (output == static_cast<float>(effect.value)) return;
      output = static_cast<float>(effect.value);
      return telling_.Signal(machine::Signal::kAnalogue, effect.index, effect.value);
    }
    case PassageEffect::Kind::kBeamOn:
      return BeamOn(effect.power);
    case PassageEffect::Kind::kBeamOff:
      return Become(effect.value != 0.0 ? s_.beam.Taken() : s_.beam.Off());
    case PassageEffect::Kind::kSchedule:
      if (s_.outputs.schedule == effect.index) return;
      s_.outputs.schedule = effect.index;
      return telling_.Signal(machine::Signal::kSchedule, 0, effect.index);
    case PassageEffect::Kind::kTable:
      s_.outputs.table_deg = effect.value;
      return telling_.Signal(machine::Signal::kRotaryTable, 0, effect.value);
    case PassageEffect::Kind::kZeroed:
      if (effect.index == kLastZeroGroup) s_.zeroed = true;
      return TellZeroed(effect.index);
  }
}

void Actuators::SetOutput(int index, double value) {
  Bits& outputs = s_.outputs.logical;
  const auto n = static_cast<std::size_t>(index);
  const bool on = value != 0.0;
  if (s_.gas_refused == index) s_.gas_refused = 0;
  if (outputs[n] == on) return;
  const std::optional<std::size_t> other = OtherGas(index);
  if (on && other && outputs[*other]) {
    s_.gas_refused = index;
    return telling_.Warn(ErrorCode::kGasConflict,
                         "OL[" + Told("output", index) + "] while another assist gas is on",
                         "OPT-5.40");
  }
  outputs[n] = on;
  telling_.Signal(machine::Signal::kOutput, index, value);
  if (other) {
    telling_.Signal(machine::Signal::kGas, 0, !on ? 1 : index == kGas2 ? 2 : 3);  // OPT-5.42
  }
  if (index == kSensor) telling_.Signal(machine::Signal::kSensor, 0, value);
}

// A motion is told with the beam that it had. The shutter opens before the beam, and closes behind
// it.
void Actuators::Become(const Beam& next) {
  if (s_.beam.on() || next.on()) ride_.TellUpToNow();
  const Beam before = std::exchange(s_.beam, next);
  const bool opens = !before.shutter_open() && next.shutter_open();
  const bool closes = before.shutter_open() && !next.shutter_open();
  if (opens) telling_.Signal(machine::Signal::kShutter, 0, 1.0);
  if (!before.on() && next.on()) {
    telling_.Signal(machine::Signal::kBeam, 0, 1.0, next.power().constant_percent);
  }
  if (before.on() && !next.on()) telling_.Signal(machine::Signal::kBeam, 0, 0.0);
  if (closes) telling_.Signal(machine::Signal::kShutter, 0, 0.0);
}

void Actuators::BeamOn(const machine::PowerBySpeed& power) { Become(s_.beam.On(power)); }
void Actuators::BeamOff() { Become(s_.beam.Off()); }
void Actuators::Hold() { Become(s_.beam.Held()); }
void Actuators::Return() { Become(s_.beam.Returned()); }
void Actuators::ShutDown() { Become(s_.beam.ShutDown()); }

void Actuators::ChangePower(const machine::PowerBySpeed& power) {
  s_.beam = s_.beam.WithPower(power);
}

void Actuators::MoveDoor(bool open) {
  if (!open) {
    s_.beam = s_.beam.DoorClosed();
    return;
  }
  const machine::Place in_execution = std::exchange(situation_.place, ride_.place());
  Become(s_.beam.DoorOpened());
  situation_.place = in_execution;
}

double Actuators::SchedulePower() const {
  for (const machine::LaserSchedule& schedule : setup_.schedules) {
    if (schedule.number == s_.outputs.schedule) return schedule.power_percent;
  }
  return kFullPower;
}

bool Actuators::HasSchedule(int number) const {
  return optimo::HasSchedule(parameters_, setup_.schedules, number);
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
