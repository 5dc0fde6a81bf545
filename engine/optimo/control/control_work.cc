#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/optimo/control/control.h"

// WORKDEF and WORK. A WORK may go on in the background: it waits for /START or dwells while the
// program goes on (/NEXT), or is switched off by /END (OPT-3.38).
namespace rmlcell::optimo {
namespace {

constexpr int kScheduleMin = 1;
constexpr int kScheduleMax = 63;

}  // namespace

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
  if (i.numbers[0] == 1) {
    definition = {
        .speed_percent = v[0], .power_percent = v[1], .delay_s = v[2], .peak_percent = v[3]};
    if (!(v[0] > 0.0 && v[0] <= 100.0)) return refuse("speed", v[0]);
    if (!(v[1] >= 0.0 && v[1] <= 100.0)) return refuse("power", v[1]);
    if (!(v[2] >= 0.0)) return refuse("delay", v[2]);
    if (!(v[3] >= 0.0 && v[3] <= 100.0)) return refuse("peak", v[3]);
  }
  if (i.numbers[0] == 2 || i.value_count == 5) {
    const double schedule = i.numbers[0] == 2 ? v[0] : v[4];
    const double number = std::trunc(schedule);
    if (!(number >= kScheduleMin && number <= kScheduleMax)) {
      return Raise(ErrorCode::kScheduleRange, "laser schedule is " + ShortestText(schedule));
    }
    definition.schedule = static_cast<int>(number);
  }
  program().processes.definitions[i.numbers[0]][i.numbers[1]] = definition;
}

void Control::Work(const Instruction& i) {
  WorkTask task{.place = s_.place,
                .kind = i.numbers[0],
                .process = i.numbers[1],
                .on = i.Has(kOn),
                .since = s_.instruction_since};
  if (!simulating()) {  // there conditions are ignored, OPT-6.20
    if (i.Has(kEnd)) task.end = ConditionOf(module().End(i));
    if (i.Has(kStart) && !s_.condition_met) {
      const ExprRange expression = RangeOf(module().Start(i));
      const std::optional<bool> met = Truth(expression);
      if (!met) return;
      if (!*met && !i.Has(kNext)) {
        return Wait({.kind = Pending::Kind::kCondition, .since = s_.now, .expression = expression});
      }
      if (!*met) {
        task.start = ConditionOf(module().Start(i));
        DropTasks(task.kind, task.process);
        program().work_tasks.push_back(std::move(task));
        return;
      }
    }
  }
  SwitchWork(std::move(task), i.Has(kNext), When::kPassage);
}

void Control::SwitchWork(WorkTask task, bool dwell_in_background, When when) {
  DropTasks(task.kind, task.process);
  if (!task.on) return WorkOff(task.kind, task.process, when);
  if (!WorkOn(task, dwell_in_background, when) || !task.end) return;
  task.stage = WorkTask::Stage::kEnd;
  task.stale = true;
  program().work_tasks.push_back(std::move(task));
}

// A WORK of the same n, p takes the place of one that still goes on. With kind 0 and 1 the beam has
// a new power, or none: a dwell of whatever process is over.
void Control::DropTasks(int kind, int process) {
  std::erase_if(program().work_tasks, [&](const WorkTask& task) {
    return (task.kind == kind && task.process == process) ||
           (kind != 2 && task.stage == WorkTask::Stage::kDwell);
  });
}

// False: an error was raised.
bool Control::WorkOn(const WorkTask& task, bool dwell_in_background, When when) {
  const auto refuse = [this](ErrorCode code, std::string detail) {
    Raise(code, std::move(detail));
    return false;
  };
  Processes& processes = program().processes;
  const int kind = task.kind;
  const auto n = static_cast<std::size_t>(kind);
  const auto p = static_cast<std::size_t>(task.process);
  const std::optional<WorkDefinition>& definition = processes.definitions[n][p];
  const bool efa = parameters_.laser == Laser::kEfa51;
  const int schedule = definition ? definition->schedule : 0;
  // Before the WORKDEF is asked for: no WORKDEF would help (OPT-3.43).
  if (efa && (kind == 2 || schedule > 0)) {
    return refuse(ErrorCode::kSchedulesUnavailable, "the EFA-51 has no laser schedules");
  }
  if (!definition && !(kind == 0 && task.process == 0)) {
    return refuse(ErrorCode::kWorkdefMissing, "WORK " + std::to_string(kind) + "," +
                                                  std::to_string(task.process) + " has no WORKDEF");
  }
  if (efa && kind == 1) {
    const Bits& ol = s_.machine.data.ol;
    for (const std::size_t blocking : {2U, 12U, 13U, 14U, 15U}) {
      if (ol[blocking])
        return refuse(ErrorCode::kRampBlocked, "OL[" + std::to_string(blocking) + "] is on");
    }
  }
  if (kind != 2 && s_.machine.door_open && !simulating()) {
    return refuse(ErrorCode::kShutterInterlock, "the operator door is open");
  }
  if (schedule > 0 && !SelectSchedule(schedule, when)) return false;
  processes.on[n][p] = true;
  if (kind == 2 || simulating()) return true;
  if (kind == 0) {
    Show({.kind = PassageEffect::Kind::kBeamOn,
          .place = s_.place,
          .power = {.constant_percent = SchedulePower()}},
         when);
    return true;
  }
  const machine::PowerBySpeed ramp = RampedPower(*definition, parameters_.limits.tip_speed_mm_s);
  if (definition->delay_s <= 0.0) {
    Show({.kind = PassageEffect::Kind::kBeamOn, .place = s_.place, .power = ramp}, when);
    return true;
  }
  // Standing still, as NeedsStandstill saw to: at peak power for the delay, then the ramp
  // (OPT-3.21).
  BeamOn({.constant_percent = definition->peak_percent});
  if (dwell_in_background || when == When::kNow) {
    WorkTask dwell{.stage = WorkTask::Stage::kDwell,
                   .place = task.place,
                   .kind = kind,
                   .process = task.process,
                   .until = After(definition->delay_s),
                   .after = ramp};
    program().work_tasks.push_back(std::move(dwell));
    return true;
  }
  s_.power_before_pierce = ramp;
  Wait({.kind = Pending::Kind::kTime,
        .since = s_.now,
        .until = After(definition->delay_s),
        .wait = machine::WaitKind::kPierce});
  return true;
}

void Control::WorkOff(int kind, int process, When when) {
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
    std::erase_if(program().work_tasks,
                  [](const WorkTask& task) { return task.stage == WorkTask::Stage::kDwell; });
  }
  Show({.kind = PassageEffect::Kind::kBeamOff, .place = s_.place}, when);
}

// When a WORK in the background has to be looked at next. A condition that nothing can have changed
// since it was tested last is not tested again.
SimTime Control::NextTask() const {
  SimTime next = kForever;
  if (s_.deferred) return next;
  for (const WorkTask& task : program().work_tasks) {
    if (task.stage == WorkTask::Stage::kDwell) {
      next = std::min(next, std::max(s_.now, task.until));
    } else {
      if (task.stage == WorkTask::Stage::kStart && s_.tasks_input) return s_.now;
      if (task.stale || Busy()) next = std::min(next, NextTick(task.since));
    }
  }
  return next;
}

void Control::MarkTasks() {
  for (WorkTask& task : program().work_tasks) task.stale = true;
}

void Control::RunTasks() {
  for (std::size_t n = 0; s_.phase == machine::RunPhase::kRunning && !s_.deferred &&
                          n < program().work_tasks.size();) {
    if (!RunTask(n)) ++n;
  }
  s_.tasks_input = false;
}

// True: the task was taken from the list.
bool Control::RunTask(std::size_t n) {
  std::vector<WorkTask>& tasks = program().work_tasks;
  const auto take = [&] {
    WorkTask taken = std::move(tasks[n]);
    tasks.erase(tasks.begin() + static_cast<std::ptrdiff_t>(n));
    return taken;
  };
  if (tasks[n].stage == WorkTask::Stage::kDwell) {
    if (s_.now < tasks[n].until) return false;
    const WorkTask dwell = take();
    TellWait();
    if (s_.active) TellMotion(s_.now);
    s_.beam.power = dwell.after;
    return true;
  }
  const bool waits = tasks[n].stage == WorkTask::Stage::kStart;
  const bool tick = s_.now > tasks[n].since &&
                    (s_.now - tasks[n].since) % FromSeconds(parameters_.cycle_s) == SimTime(0);
  if (!tick && !(waits && s_.tasks_input)) return false;
  // Errors and signals are told at the step of the WORK, not of the instruction in execution.
  const machine::Place in_execution = s_.place;
  s_.place = tasks[n].place;
  tasks[n].stale = false;
  const Condition condition = waits ? *tasks[n].start : *tasks[n].end;
  const std::optional<bool> met = Truth(condition);
  const bool carried_out = met && *met;
  if (carried_out) {
    TellWait();  // the power of the beam is another one from here
    WorkTask task = take();
    if (waits) {
      SwitchWork(std::move(task), true, When::kNow);
    } else {
      WorkOff(task.kind, task.process, When::kNow);
    }
    MarkTasks();
  }
  if (s_.phase == machine::RunPhase::kRunning) s_.place = in_execution;
  return carried_out;
}

}  // namespace rmlcell::optimo
