#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/optimo/control/control.h"

// Laser, shutter, assist gas and outputs.
namespace rmlcell::optimo {
namespace {

constexpr int kGas2 = 8;  // OL numbers, OPT-5.39
constexpr int kGas3 = 9;
constexpr int kSensor = 11;
constexpr double kFullPower = 100.0;

// Of which only one is on at a time. -1: the output is no gas.
int OtherGas(int index) { return index == kGas2 ? kGas3 : index == kGas3 ? kGas2 : -1; }

}  // namespace

void Control::TellSignal(machine::Signal signal, int index, double value, double detail) {
  observer_.OnSignal({.at = s_.now,
                      .place = s_.place,
                      .signal = signal,
                      .index = index,
                      .value = value,
                      .detail = detail});
}

// Carried out now, or when the tip passes the corner that the planner still has to decide about.
void Control::Show(PassageEffect effect, When when) {
  if (!s_.passing || when == When::kNow) return Carry(effect);
  const std::uint64_t tag = s_.next_tag++;
  s_.effects.emplace_back(tag, effect);
  s_.appended.push_back({.tag = tag, .move = std::nullopt});
  s_.planner.Mark(tag);
  DrainPlanner();
}

// Told at the step that asked for it: the program may have run ahead of the passage.
void Control::Carry(const PassageEffect& effect) {
  const machine::Place in_execution = std::exchange(s_.place, effect.place);
  TakeEffect(effect);
  s_.place = in_execution;
}

void Control::TakeEffect(const PassageEffect& effect) {
  DataArea& data = s_.machine.data;
  const auto n = static_cast<std::size_t>(effect.index);
  switch (effect.kind) {
    case PassageEffect::Kind::kOutput: {
      const bool on = effect.value != 0.0;
      if (data.ol_physical[n] == on) return;
      const int other = OtherGas(effect.index);
      if (on && other >= 0 && data.ol_physical[static_cast<std::size_t>(other)]) {
        return Warn(ErrorCode::kGasConflict,
                    "OL[" + std::to_string(effect.index) + "] while another assist gas is on",
                    "OPT-5.40");
      }
      data.ol_physical[n] = on;
      TellSignal(machine::Signal::kOutput, effect.index, effect.value);
      if (other >= 0) {
        TellSignal(machine::Signal::kGas, 0, !on ? 1 : effect.index == kGas2 ? 2 : 3);  // OPT-5.42
      }
      if (effect.index == kSensor) TellSignal(machine::Signal::kSensor, 0, effect.value);
      return;
    }
    case PassageEffect::Kind::kAnalogue:
      if (data.oa_physical[n] == static_cast<float>(effect.value)) return;
      data.oa_physical[n] = static_cast<float>(effect.value);
      TellSignal(machine::Signal::kAnalogue, effect.index, effect.value);
      return;
    case PassageEffect::Kind::kBeamOn:
      return BeamOn(effect.power);
    case PassageEffect::Kind::kBeamOff:
      return BeamOff();
    case PassageEffect::Kind::kSchedule:
      if (s_.machine.schedule == effect.index) return;
      s_.machine.schedule = effect.index;
      return TellSignal(machine::Signal::kSchedule, 0, effect.index);
    case PassageEffect::Kind::kTable:
      s_.machine.table_deg = effect.value;
      return TellSignal(machine::Signal::kRotaryTable, 0, effect.value);
    case PassageEffect::Kind::kZeroed:
      return TellZeroed(effect.index);
  }
}

void Control::OpenShutter() {
  if (s_.beam.shutter_open) return;
  s_.beam.shutter_open = true;
  TellSignal(machine::Signal::kShutter, 0, 1.0);
}

void Control::CloseShutter() {
  if (!s_.beam.shutter_open) return;
  s_.beam.shutter_open = false;
  TellSignal(machine::Signal::kShutter, 0, 0.0);
}

void Control::BeamOn(const machine::PowerBySpeed& power) {
  if (s_.active) TellMotion(s_.now);
  OpenShutter();
  const bool was_on = s_.beam.on;
  s_.beam.on = true;
  s_.beam.power = power;
  if (!was_on) TellSignal(machine::Signal::kBeam, 0, 1.0, power.constant_percent);
}

void Control::BeamOff() {
  if (!s_.beam.on) return;
  if (s_.active) TellMotion(s_.now);
  s_.beam.on = false;
  TellSignal(machine::Signal::kBeam, 0, 0.0);
  if (parameters_.laser == Laser::kEfa51) CloseShutter();  // beam and shutter are one, OPT-3.15
}

// While motion is held the beam is off; START brings it back (OPT-B.34, OPT-3.52).
void Control::SuspendBeam() {
  if (!s_.beam.on) return;
  s_.beam_returns = true;
  BeamOff();
}

double Control::SchedulePower() const {
  if (s_.machine.schedule == 0 || !setup_.schedules) return kFullPower;
  for (const machine::LaserSchedule& schedule : *setup_.schedules) {
    if (schedule.number == s_.machine.schedule) return schedule.power_percent;
  }
  return kFullPower;
}

// False: an error was raised.
bool Control::SelectSchedule(int number, When when) {
  const bool stored =
      !setup_.schedules || std::ranges::any_of(*setup_.schedules, [&](const auto& schedule) {
        return schedule.number == number;
      });
  if (!stored) {
    Raise(ErrorCode::kScheduleMissing, "laser schedule " + std::to_string(number));
    return false;
  }
  if (simulating()) {
    s_.simulated.schedule = number;
    return true;
  }
  Show({.kind = PassageEffect::Kind::kSchedule, .place = s_.place, .index = number}, when);
  return true;
}

// The image takes the value in any case; the machine follows unless the output is refused
// (OPT-5.38): a second gas when its turn comes, for the first may go off at the same passage.
// False: an alarm was raised.
bool Control::SetOutput(int index, bool on) {
  DataArea& data = s_.machine.data;
  data.ol[static_cast<std::size_t>(index)] = on;
  if (!Connected(kGroupOl)) return true;
  if (on && index == kGas3 && parameters_.gas_channels < 3) {
    Raise(ErrorCode::kGas3NotFitted, {});
    return false;
  }
  Show({.kind = PassageEffect::Kind::kOutput,
        .place = s_.place,
        .index = index,
        .value = on ? 1.0 : 0.0});
  return true;
}

// Physical outputs of these groups follow their images again: UPDATE ON, REAL, the end of a
// simulation.
void Control::ConnectOutputs(std::uint8_t groups) {
  const DataArea& data = s_.machine.data;
  const bool logical = (groups & kGroupOl) != 0;
  const bool analogue = (groups & kGroupOa) != 0 && Connected(kGroupOa);
  // Gas 3 makes way for gas 2, whose output comes first below.
  if (logical && !data.ol[kGas3]) SetOutput(kGas3, false);
  for (int n = 0; n < kVariableCount; ++n) {
    const auto at = static_cast<std::size_t>(n);
    if (logical && !SetOutput(n, data.ol[at])) return;
    if (!analogue) continue;
    Carry({.kind = PassageEffect::Kind::kAnalogue,
           .place = s_.place,
           .index = n,
           .value = data.oa[at]});
  }
}

}  // namespace rmlcell::optimo
