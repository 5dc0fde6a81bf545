#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/optimo/control/control.h"

// Laser, shutter, assist gas and outputs.
namespace rmlcell::optimo {
namespace {

constexpr int kGas2 = 8;     // OL numbers, OPT-5.39
constexpr int kGas3 = 9;
constexpr int kSensor = 11;
constexpr int kScheduleMin = 1;
constexpr int kScheduleMax = 63;
constexpr double kFullPower = 100.0;

}  // namespace

void Control::TellSignal(machine::Signal signal, int index, double value, double detail) {
  observer_.OnSignal({.at = s_.now, .place = s_.place, .signal = signal, .index = index, .value = value,
                      .detail = detail});
}

// Carried out now, or when the tip passes the corner that the planner still has to decide about.
void Control::Show(PassageEffect effect) {
  if (!s_.passing) return Carry(effect);
  const std::uint64_t tag = s_.next_tag++;
  s_.effects.emplace_back(tag, effect);
  s_.planner.Mark(tag);
  DrainPlanner();
}

void Control::Carry(const PassageEffect& effect) {
  DataArea& data = s_.machine.data;
  const auto n = static_cast<std::size_t>(effect.index);
  switch (effect.kind) {
    case PassageEffect::Kind::kOutput: {
      const bool on = effect.value != 0.0;
      if (data.ol_physical[n] == on) return;
      data.ol_physical[n] = on;
      TellSignal(machine::Signal::kOutput, effect.index, effect.value);
      if (effect.index == kGas2 || effect.index == kGas3) {
        const int gas = data.ol_physical[kGas2] ? 2 : data.ol_physical[kGas3] ? 3 : 1;  // OPT-5.42
        if (gas != s_.gas) TellSignal(machine::Signal::kGas, 0, gas);
        s_.gas = gas;
      }
      if (effect.index == kSensor) TellSignal(machine::Signal::kSensor, 0, effect.value);
      return;
    }
    case PassageEffect::Kind::kAnalogue:
      if (data.oa_physical[n] == static_cast<float>(effect.value)) return;
      data.oa_physical[n] = static_cast<float>(effect.value);
      TellSignal(machine::Signal::kAnalogue, effect.index, effect.value);
      return;
    case PassageEffect::Kind::kBeamOn: return BeamOn(effect.power);
    case PassageEffect::Kind::kBeamOff: return BeamOff();
    case PassageEffect::Kind::kSchedule:
      if (s_.machine.schedule == effect.index) return;
      s_.machine.schedule = effect.index;
      return TellSignal(machine::Signal::kSchedule, 0, effect.index);
    case PassageEffect::Kind::kTable:
      s_.machine.table_deg = effect.value;
      return TellSignal(machine::Signal::kRotaryTable, 0, effect.value);
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
bool Control::SelectSchedule(int number) {
  const bool stored = !setup_.schedules || std::ranges::any_of(*setup_.schedules, [&](const auto& schedule) {
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
  Show({.kind = PassageEffect::Kind::kSchedule, .place = s_.place, .index = number});
  return true;
}

void Control::DefineWork(const Instruction& i) {
  std::array<double, 5> v{};
  for (int n = 0; n < i.value_count; ++n) {
    const std::optional<double> value = Real(module().Value(i, n));
    if (!value) return;
    v[static_cast<std::size_t>(n)] = *value;
  }
  const auto refuse = [&](std::string_view what, double value) {
    Raise(ErrorCode::kValueRange, std::string(what) + " of WORKDEF is " + ShortestText(value));
  };
  WorkDefinition definition;
  double schedule = 0.0;
  if (i.numbers[0] == 1) {
    definition = {.speed_percent = v[0], .power_percent = v[1], .delay_s = v[2], .peak_percent = v[3]};
    if (!(v[0] > 0.0 && v[0] <= 100.0)) return refuse("speed", v[0]);
    if (!(v[1] >= 0.0 && v[1] <= 100.0)) return refuse("power", v[1]);
    if (!(v[2] >= 0.0)) return refuse("delay", v[2]);
    if (!(v[3] >= 0.0 && v[3] <= 100.0)) return refuse("peak", v[3]);
    schedule = i.value_count == 5 ? v[4] : 0.0;
  } else if (i.numbers[0] == 2) {
    schedule = v[0];
  }
  if (i.numbers[0] == 2 || i.value_count == 5) {
    definition.schedule = static_cast<int>(std::trunc(std::clamp(schedule, -1.0, 1000.0)));
    if (definition.schedule < kScheduleMin || definition.schedule > kScheduleMax) {
      return Raise(ErrorCode::kScheduleRange, "laser schedule is " + ShortestText(schedule));
    }
  }
  program().processes.definitions[i.numbers[0]][i.numbers[1]] = definition;
}

void Control::Work(const Instruction& i) {
  if (i.Has(kStart) && !s_.condition_met && !simulating()) {
    const auto expression = static_cast<std::uint32_t>(module().Start(i).data() - module().nodes.data());
    const std::optional<bool> met = Truth(expression);
    if (!met) return;
    if (!*met) return Wait({.kind = Pending::Kind::kCondition, .since = s_.now, .expression = expression});
  }
  if (i.Has(kOn)) {
    WorkOn(i.numbers[0], i.numbers[1]);
  } else {
    WorkOff(i.numbers[0], i.numbers[1]);
  }
}

void Control::WorkOn(int kind, int process) {
  Processes& processes = program().processes;
  const auto n = static_cast<std::size_t>(kind);
  const auto p = static_cast<std::size_t>(process);
  const std::optional<WorkDefinition>& definition = processes.definitions[n][p];
  if (!definition && !(kind == 0 && process == 0)) {
    return Raise(ErrorCode::kWorkdefMissing,
                 "WORK " + std::to_string(kind) + "," + std::to_string(process) + " has no WORKDEF");
  }
  const bool efa = parameters_.laser == Laser::kEfa51;
  const int schedule = definition ? definition->schedule : 0;
  if (efa && (kind == 2 || schedule > 0)) return Raise(ErrorCode::kSchedulesUnavailable, {});
  if (efa && kind == 1) {
    const Bits& ol = s_.machine.data.ol;
    if (ol[2] || ol[12] || ol[13] || ol[14] || ol[15]) return Raise(ErrorCode::kRampBlocked, {});
  }
  if (kind != 2 && s_.machine.door_open && !simulating()) {
    return Raise(ErrorCode::kShutterInterlock, "the operator door is open");
  }
  if (schedule > 0 && !SelectSchedule(schedule)) return;
  processes.on[n][p] = true;
  if (kind == 2 || simulating()) return;
  if (kind == 0) {
    return Show({.kind = PassageEffect::Kind::kBeamOn,
                 .place = s_.place,
                 .power = {.constant_percent = SchedulePower(), .percent_per_mm_s = 0.0}});
  }
  const machine::PowerBySpeed ramp = RampedPower(*definition, parameters_.limits.tip_speed_mm_s);
  if (definition->delay_s <= 0.0) {
    return Show({.kind = PassageEffect::Kind::kBeamOn, .place = s_.place, .power = ramp});
  }
  // Standing still, as NeedsStandstill saw to: at peak power for the delay, then the ramp (OPT-3.21).
  BeamOn({.constant_percent = definition->peak_percent, .percent_per_mm_s = 0.0});
  s_.power_before_pierce = ramp;
  Wait({.kind = Pending::Kind::kTime,
        .since = s_.now,
        .until = s_.now + FromSeconds(definition->delay_s),
        .wait = machine::WaitKind::kPierce,
        .power_percent = definition->peak_percent});
}

void Control::WorkOff(int kind, int process) {
  Processes& processes = program().processes;
  processes.on[static_cast<std::size_t>(kind)][static_cast<std::size_t>(process)] = false;
  if (simulating()) return;
  if (kind == 2) {
    const bool beam_wanted = std::ranges::any_of(processes.on[0], [](bool b) { return b; }) ||
                             std::ranges::any_of(processes.on[1], [](bool b) { return b; });
    if (beam_wanted && s_.beam.on) {
      Warn(ErrorCode::kBeamOffBySchedule,
           "WORK 2," + std::to_string(process) + " /OFF switches the beam off", "OPT-3.24");
    }
  }
  Show({.kind = PassageEffect::Kind::kBeamOff, .place = s_.place});
}

// The image takes the value in any case; the machine follows unless the output is refused (OPT-5.38).
// False: an alarm was raised.
bool Control::SetOutput(int index, bool on) {
  DataArea& data = s_.machine.data;
  data.ol[static_cast<std::size_t>(index)] = on;
  if (!Connected(kGroupOl)) {
    if (simulating()) s_.simulated.ol_changed[static_cast<std::size_t>(index)] = true;
    return true;
  }
  if (on && index == kGas3 && parameters_.gas_channels < 3) {
    Raise(ErrorCode::kGas3NotFitted, {});
    return false;
  }
  const int other = index == kGas2 ? kGas3 : index == kGas3 ? kGas2 : -1;
  if (on && other >= 0 && data.ol[static_cast<std::size_t>(other)]) {
    Warn(ErrorCode::kGasConflict, "OL[" + std::to_string(index) + "] while another assist gas is on", "OPT-5.40");
    return true;
  }
  Show({.kind = PassageEffect::Kind::kOutput, .place = s_.place, .index = index, .value = on ? 1.0 : 0.0});
  return true;
}

// Physical outputs follow their images again: UPDATE ON, REAL, the end of a simulation.
void Control::ConnectOutputs() {
  for (int n = 0; n < kVariableCount; ++n) {
    const auto at = static_cast<std::size_t>(n);
    if (Connected(kGroupOl) && s_.machine.data.ol[at] != s_.machine.data.ol_physical[at]) {
      SetOutput(n, s_.machine.data.ol[at]);
    }
    if (Connected(kGroupOa) && n > 0 && s_.machine.data.oa[at] != s_.machine.data.oa_physical[at]) {
      Carry({.kind = PassageEffect::Kind::kAnalogue, .place = s_.place, .index = n, .value = s_.machine.data.oa[at]});
    }
  }
}

}  // namespace rmlcell::optimo
