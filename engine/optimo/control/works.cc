#include "engine/optimo/control/works.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/number_text.h"

namespace rmlcell::optimo {
namespace {

constexpr int kScheduleMin = 1;
constexpr int kScheduleMax = 63;

}  // namespace

Status Works::Define(const Instruction& i) {
  const auto values =
      data_.Reals<5>(i.value_count, [&](int n) { return counter_.module().Value(i, n); });
  if (!values) return values.error();
  const std::array<double, 5>& v = *values;
  const auto refuse = [&](const std::string& what, double value, std::string_view unit) {
    return Error{ErrorCode::kValueRange,
                 what + " of WORKDEF is " + Told(what, value, unit, ShortestText(value)),
                 {}};
  };
  WorkDefinition definition;
  if (i.numbers[0] == 1) {
    definition = {
        .speed_percent = v[0], .power_percent = v[1], .delay_s = v[2], .peak_percent = v[3]};
    if (!(v[0] > 0.0 && v[0] <= 100.0)) return refuse("speed", v[0], "%");
    if (!(v[1] >= 0.0 && v[1] <= 100.0)) return refuse("power", v[1], "%");
    if (!(v[2] >= 0.0)) return refuse("delay", v[2], "s");
    if (!(v[3] >= 0.0 && v[3] <= 100.0)) return refuse("peak", v[3], "%");
  }
  if (i.numbers[0] == 2 || i.value_count == 5) {
    const double schedule = i.numbers[0] == 2 ? v[0] : v[4];
    const double number = std::trunc(schedule);
    if (!(number >= kScheduleMin && number <= kScheduleMax)) {
      return Error{ErrorCode::kScheduleRange,
                   "laser schedule is " + Told("schedule", schedule, "", ShortestText(schedule)),
                   {}};
    }
    definition.schedule = static_cast<int>(number);
  }
  counter_.program().processes.definitions[i.numbers[0]][i.numbers[1]] = definition;
  return {};
}

Status Works::Work(const Instruction& i) {
  WorkTask task{.call_level = counter_.call_level(),
                .place = situation_.place,
                .kind = i.numbers[0],
                .process = i.numbers[1],
                .on = i.Has(kOn),
                .since = waits_.instruction_since()};
  if (!situation_.simulating()) {  // there conditions are ignored, OPT-6.20
    const Module& module = counter_.module();
    if (i.Has(kEnd)) task.end = data_.ConditionOf(module.End(i));
    if (i.Has(kStart) && !waits_.condition_met()) {
      const ExprRange expression = data_.RangeOf(module.Start(i));
      const Result<bool> met = data_.Truth(expression);
      if (!met) return met.error();
      if (!*met && !i.Has(kNext)) {
        waits_.BeginCondition(expression);
        return {};
      }
      if (!*met) {
        task.start = data_.ConditionOf(module.Start(i));
        Drop(task.kind, task.process);
        s_.tasks.push_back(std::move(task));
        return {};
      }
    }
  }
  return Switch(std::move(task), i.Has(kNext), When::kPassage);
}

bool Works::NeedsStandstill(const Instruction& i) const {
  if (i.Has(kStart) || i.Has(kEnd) || i.Has(kNext)) return true;
  if (!i.Has(kOn) || i.numbers[0] != 1) return false;
  const auto& definition = counter_.program().processes.definitions[1][i.numbers[1]];
  return !definition || definition->delay_s > 0.0;
}

Status Works::Switch(WorkTask task, bool dwell_in_background, When when) {
  Drop(task.kind, task.process);
  if (!task.on) {
    SwitchOff(task.kind, task.process, when);
    return {};
  }
  const Status on = SwitchOn(task, dwell_in_background, when);
  if (!on || !task.end) return on;
  task.stage = WorkStage::kEnd;
  task.start.reset();
  task.stale = true;
  s_.tasks.push_back(std::move(task));
  return {};
}

// A WORK of the same n, p takes the place of one that still goes on. With kind 0 and 1 the beam has
// a new power, or none: a dwell of whatever process is over.
void Works::Drop(int kind, int process) {
  std::erase_if(s_.tasks, [&](const WorkTask& task) {
    return IsOfProgram(task) && ((task.kind == kind && task.process == process) ||
                                 (kind != 2 && task.stage == WorkStage::kDwell));
  });
}

Status Works::MaySwitchOn(const WorkTask& task,
                          const std::optional<WorkDefinition>& definition) const {
  const int kind = task.kind;
  const bool efa = parameters_.laser == Laser::kEfa51;
  // Before the WORKDEF is asked for: no WORKDEF would help (OPT-3.43).
  if (efa && (kind == 2 || (definition && definition->schedule > 0))) {
    return Error{ErrorCode::kSchedulesUnavailable, "the EFA-51 has no laser schedules", {}};
  }
  if (!definition && !(kind == 0 && task.process == 0)) {
    return Error{
        ErrorCode::kWorkdefMissing,
        "WORK " + Told("kind", kind) + "," + Told("process", task.process) + " has no WORKDEF",
        {}};
  }
  if (efa && kind == 1) {
    for (const int blocking : {2, 12, 13, 14, 15}) {
      if (!data_.output(blocking)) continue;
      return Error{ErrorCode::kRampBlocked, "OL[" + Told("output", blocking) + "] is on", {}};
    }
  }
  if (kind != 2 && actuators_.door_open() && !situation_.simulating()) {
    return Error{ErrorCode::kShutterInterlock, "the operator door is open", {}};
  }
  return {};
}

Status Works::SelectSchedule(int number, When when) {
  if (!actuators_.HasSchedule(number)) {
    return Error{ErrorCode::kScheduleMissing, "laser schedule " + Told("schedule", number), {}};
  }
  if (situation_.simulating()) {
    s_.simulated_schedule = number;
  } else {
    effects_.Show(
        {.kind = PassageEffect::Kind::kSchedule, .place = situation_.place, .index = number}, when);
  }
  return {};
}

Status Works::SwitchOn(const WorkTask& task, bool dwell_in_background, When when) {
  Processes& processes = counter_.program().processes;
  const auto kind = static_cast<std::size_t>(task.kind);
  const auto process = static_cast<std::size_t>(task.process);
  const std::optional<WorkDefinition>& definition = processes.definitions[kind][process];
  if (const Status may = MaySwitchOn(task, definition); !may) return may.error();
  if (definition && definition->schedule > 0) {
    if (const Status selected = SelectSchedule(definition->schedule, when); !selected)
      return selected.error();
  }
  processes.on[kind][process] = true;
  if (kind == 2 || situation_.simulating()) return {};
  const bool pierces = kind == 1 && definition->delay_s > 0.0;
  if (pierces) {
    Pierce(task, *definition, dwell_in_background || when == When::kNow);
    return {};
  }
  effects_.Show(
      {.kind = PassageEffect::Kind::kBeamOn,
       .place = situation_.place,
       .power = kind == 0 ? machine::PowerBySpeed{.constant_percent = actuators_.SchedulePower()}
                          : RampedPower(*definition, parameters_.limits.tip_speed_mm_s)},
      when);
  return {};
}

// Standing still, as NeedsStandstill saw to: at peak power for the delay, then the ramp (OPT-3.21).
void Works::Pierce(const WorkTask& task, const WorkDefinition& definition, bool in_background) {
  const machine::PowerBySpeed ramp = RampedPower(definition, parameters_.limits.tip_speed_mm_s);
  actuators_.BeamOn({.constant_percent = definition.peak_percent});
  const SimTime until = After(situation_.now, definition.delay_s);
  if (!in_background) {
    return waits_.Begin({.kind = Pending::Kind::kTime,
                         .until = until,
                         .wait = machine::WaitKind::kPierce,
                         .after = ramp});
  }
  s_.tasks.push_back({.stage = WorkStage::kDwell,
                      .call_level = task.call_level,
                      .place = task.place,
                      .kind = task.kind,
                      .process = task.process,
                      .until = until,
                      .after = ramp});
}

void Works::SwitchOff(int kind, int process, When when) {
  Processes& processes = counter_.program().processes;
  processes.on[static_cast<std::size_t>(kind)][static_cast<std::size_t>(process)] = false;
  if (situation_.simulating()) return;
  if (kind == 2) {
    if (processes.beam_on() && actuators_.beam_on()) {
      telling_.Warn(ErrorCode::kBeamOffBySchedule,
                    "WORK 2," + Told("process", process) + " /OFF switches the beam off",
                    "OPT-3.24");
    }
    std::erase_if(s_.tasks, [&](const WorkTask& task) {
      return IsOfProgram(task) && task.stage == WorkStage::kDwell;
    });
  }
  effects_.Show({.kind = PassageEffect::Kind::kBeamOff,
                 .place = situation_.place,
                 .value = processes.beam_on() ? 1.0 : 0.0},
                when);
}

SimTime Works::NextEvent(bool stops) const {
  SimTime next = kForever;
  for (const WorkTask& task : s_.tasks) {
    if (!IsOfProgram(task)) continue;
    if (task.stage == WorkStage::kDwell) {
      next = std::min(next, std::max(situation_.now, task.until));
    } else {
      if (stops && task.stage == WorkStage::kStart) continue;
      if (task.stage == WorkStage::kStart && s_.input_changed) return situation_.now;
      if (task.stale || ride_.busy()) {
        next = std::min(next, cycle_.NextTick(situation_.now, task.since));
      }
    }
  }
  return next;
}

void Works::MarkStale() {
  for (WorkTask& task : s_.tasks) {
    if (IsOfProgram(task)) task.stale = true;
  }
}

void Works::Shift(SimTime stood) {
  for (WorkTask& task : s_.tasks) {
    if (!IsOfProgram(task)) continue;
    task.since += stood;
    task.until += stood;
  }
}

void Works::EndProgram() {
  std::erase_if(s_.tasks, [&](const WorkTask& task) { return IsOfProgram(task); });
  counter_.program().processes.AllOff();
}

std::optional<Works::Failure> Works::Run(bool stops) {
  for (std::size_t n = 0; n < s_.tasks.size();) {
    if (!IsOfProgram(s_.tasks[n])) {
      ++n;
      continue;
    }
    const machine::Place place = s_.tasks[n].place;
    const machine::Place in_execution = situation_.place;
    const Result<bool> taken = TestTask(n, stops);
    situation_.place = in_execution;
    if (!taken) return Failure{taken.error(), place};
    if (!*taken) ++n;
  }
  return std::nullopt;
}

WorkTask Works::Take(std::size_t n) {
  WorkTask taken = std::move(s_.tasks[n]);
  s_.tasks.erase(s_.tasks.begin() + static_cast<std::ptrdiff_t>(n));
  return taken;
}

bool Works::EndDwell(std::size_t n) {
  if (situation_.now < s_.tasks[n].until) return false;
  const WorkTask dwell = Take(n);
  waits_.Tell();
  ride_.TellUpToNow();
  actuators_.ChangePower(dwell.after);
  return true;
}

// True: the task was taken from the list. The place is left to be that of the task.
Result<bool> Works::TestTask(std::size_t n, bool stops) {
  WorkTask& task = s_.tasks[n];
  if (task.stage == WorkStage::kDwell) return EndDwell(n);
  const bool waits = task.stage == WorkStage::kStart;
  const bool tick = situation_.now > task.since && cycle_.IsTick(situation_.now, task.since);
  if (waits && stops) return false;
  if (!tick && !(waits && s_.input_changed)) return false;
  situation_.place = task.place;
  task.stale = false;
  const Condition condition = waits ? *task.start : *task.end;
  const Result<bool> met = data_.Truth(condition);
  if (!met) return met.error();
  if (!*met) return false;
  waits_.Tell();  // the power of the beam is another one from here
  WorkTask taken = Take(n);
  if (waits) {
    const Status switched = Switch(std::move(taken), true, When::kNow);
    MarkStale();
    if (!switched) return switched.error();
  } else {
    SwitchOff(taken.kind, taken.process, When::kNow);
    MarkStale();
  }
  return true;
}

}  // namespace rmlcell::optimo
