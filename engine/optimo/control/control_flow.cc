#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/number_text.h"
#include "engine/optimo/control/control.h"

// Fetching, jumps, calls, errors.
namespace rmlcell::optimo {
namespace {

// Instructions that run ahead between two motions of a /FLY passage. A loop without motion would
// run ahead for ever; a passage that needs more than this becomes a stop.
constexpr int kRunAheadMax = 10'000;

// What a repeated timer missed meanwhile is not made up for.
void SkipMissed(ProgramTimer& timer, SimTime now) {
  if (timer.due <= now) timer.due += ((now - timer.due) / timer.period + 1) * timer.period;
}

}  // namespace

// Carries out the next instruction, or finds out that the machine must stand first.
void Control::Fetch() {
  const auto stand_first = [&] {
    if (s_.no_motion) {
      Wait({.kind = Pending::Kind::kNoMotion, .since = s_.now});
      return true;
    }
    if (!s_.passing && !Busy()) return false;
    StopMotions();
    s_.pending = {.kind = Pending::Kind::kStandstill};
    return true;
  };
  const auto slot = linked().slot;
  std::uint32_t at = index().SkipDeclares(frame().next);
  const bool at_end = at >= module().instructions.size();
  const bool stop_here = s_.stop_requested && !s_.passing;
  // An instruction whose condition is met is finished before a HOLD: OPT-4.17.
  const bool hold_here = s_.hold_requested && !s_.condition_met;
  if (hold_here || stop_here || s_.halt_after_step) {
    if (stand_first()) return;
    const bool over = at_end && s_.programs.size() == 1 && program().frames.size() == 1;
    const bool after_step = std::exchange(s_.halt_after_step, false);
    if (!(after_step && over)) {
      return Halt(after_step ? s_.halt_reason : stop_here ? "STOP" : "HOLD");
    }
  }
  if (!s_.passing && !s_.condition_met && MakeDueGosub()) return;
  if (at_end) {
    const bool function = program().frames.size() > 1;
    if (!function && s_.passing)
      Warn(ErrorCode::kFlyCancelled, "/FLY before the end of the program", "OPT-2.47");
    if (!function && stand_first()) return;
    return EndModule();
  }
  const Instruction& i = module().instructions[at];
  const machine::Place here{
      .program = slot, .step = static_cast<int>(i.step), .line = LineOf(slot, i.step)};
  if (simulating() && slot == s_.simulated.until.program &&
      i.step == static_cast<std::uint32_t>(s_.simulated.until.step)) {
    // The first time that control comes to the step: from here on all is real (OPT-6.13, 6.14).
    const int schedule = s_.simulated.schedule;
    s_.simulated = {};
    s_.place = here;  // where what the simulated steps asked for takes effect
    ConnectOutputs(kAllGroups);
    if (s_.phase != machine::RunPhase::kRunning) return;
    if (schedule > 0)
      Carry({.kind = PassageEffect::Kind::kSchedule, .place = s_.place, .index = schedule});
  }
  if (s_.steps >= setup_.budget.steps) {
    return Finish(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kStepBudget,
                  std::to_string(s_.steps) + " steps were executed");
  }
  s_.place = here;
  s_.op = i.op;
  if (s_.no_motion) {
    if (i.op == Op::kMove && !s_.condition_met) EndNoMotion();  // takes over at once: it stands
    if (s_.no_motion && WaitsForNext(i, program().frames.size() == 1)) {
      stand_first();
      return;
    }
  }
  if (s_.passing || Busy()) {
    if (s_.passing && i.op == Op::kCoord && static_cast<CoordType>(i.choice) != modal().coord) {
      // A failing instruction is an executed step like any other.
      observer_.OnStep(s_.now, s_.place, Describe(i.op).name);
      ++s_.steps;
      return Raise(ErrorCode::kFlyBeforeCoord,
                   "COORD changes the coordinate type after a /FLY move");
    }
    if (s_.background && i.op == Op::kMove && !s_.condition_met) {
      // The new motion takes over at the next tick (motion.md 6, /NEXT).
      s_.pending = {
          .kind = Pending::Kind::kTakeOver, .since = s_.now, .until = NextTick(SimTime(0))};
      return;
    }
    if (NeedsStandstill(i) || s_.run_ahead >= kRunAheadMax) {
      if (s_.passing) {
        Warn(
            ErrorCode::kFlyCancelled,
            "/FLY before " + std::string(Describe(i.op).name) + ": the machine stops at the target",
            "OPT-2.48");
      }
      stand_first();
      return;
    }
    ++s_.run_ahead;
  }
  if (i.reads_machine && LetPollingTakeTime(i, at)) return;
  if (!s_.condition_met) {
    s_.instruction_since = s_.now;
    observer_.OnStep(s_.now, s_.place, Describe(i.op).name);
  }
  frame().next = at + 1;
  Execute(i);
  if (s_.pending.kind == Pending::Kind::kCondition) {
    frame().next = at;  // carried out again when the condition is met
    return;
  }
  s_.condition_met = false;
  ++s_.steps;
  MarkTasks();
  if (s_.phase != machine::RunPhase::kRunning) return;
  const bool breakpoint = s_.breakpoint && s_.breakpoint->program == slot &&
                          static_cast<std::uint32_t>(s_.breakpoint->step) == i.step;
  if (breakpoint || s_.mode == machine::Mode::kSingle) {
    s_.halt_after_step = true;
    s_.halt_reason = breakpoint ? "BREAK" : "SINGLE";
  }
}

// A GOSUB of TIMER, or of the /TIME of a /NEXT motion: made between two instructions of the
// activation that asked for it, and dropped when that is over.
bool Control::MakeDueGosub() {
  ProgramContext& context = program();
  const std::size_t level = context.frames.size();
  if (context.due_gosub && level <= context.due_gosub->level) {
    const DueGosub due = *context.due_gosub;
    context.due_gosub.reset();
    if (level == due.level) {
      Gosub(due.label);
      return true;
    }
  }
  if (!context.timer || level > context.timer->level) return false;
  ProgramTimer& timer = *context.timer;
  if (level < timer.level) {
    context.timer.reset();
    return false;
  }
  if (s_.now < timer.due || timer.running > 0) return false;
  const int label = timer.label;
  if (timer.repeats) {
    SkipMissed(timer, s_.now);
    timer.running = frame().returns.size() + 1;
  } else {
    context.timer.reset();
  }
  Gosub(label);
  return true;
}

// An instruction that reads an input over and over in one instant waits for something to change
// outside: from its thousandth time on each further one takes a CYCLE, in which the control samples
// its inputs. True: it is fetched again then.
bool Control::LetPollingTakeTime(const Instruction& i, std::uint32_t at) {
  constexpr int kReadsAtOnce = 1000;  // loops that count to less are not slowed
  if (s_.condition_met || simulating() || i.op == Op::kMove) return false;
  Polling& polling = s_.polling;
  if (polling.program != linked().slot || polling.instruction != at) {
    if (polling.at != s_.now)
      polling = {.program = linked().slot, .instruction = at, .at = s_.now, .count = 1};
    return false;
  }
  if (polling.at != s_.now) {
    polling.at = s_.now;
    polling.count = 0;
  }
  if (++polling.count > kReadsAtOnce) polling.slow = true;
  if (!polling.slow || polling.count == 1) return false;
  Wait({.kind = Pending::Kind::kTime,
        .since = s_.now,
        .until = NextTick(SimTime(0)),
        .wait = machine::WaitKind::kCondition});
  return true;
}

// Whether a motion of /NEXT is finished before this instruction. `main`: it stands in the main
// module. OPT-B.89
bool Control::WaitsForNext(const Instruction& i, bool main) {
  switch (i.op) {
    case Op::kCall:
    case Op::kGo:
    case Op::kZero:
    case Op::kPause:
    case Op::kStop:
    case Op::kTcp:
    case Op::kCoord:
      return true;
    case Op::kEndtask:
      return main;
    default:
      return false;
  }
}

// Only asked while a /FLY passage is open or a /NEXT motion is under way. OPT-2.48, OPT-B.89
bool Control::NeedsStandstill(const Instruction& i) {
  if (s_.background) return WaitsForNext(i, program().frames.size() == 1);
  if (i.reads_machine) return true;
  const FlyClass fly = Describe(i.op).fly;
  if (fly != FlyClass::kDepends) return fly == FlyClass::kStandstill;
  switch (i.op) {
    case Op::kMove:
      return i.Has(kStart) || (i.Has(kTime) && NeverMoves()) || (!i.Has(kFly) && GoesNowhere(i));
    case Op::kEndtask:
      return program().frames.size() == 1;
    case Op::kWork: {
      if (i.Has(kStart) || i.Has(kEnd) || i.Has(kNext)) return true;
      if (!i.Has(kOn) || i.numbers[0] != 1) return false;
      const auto& definition = program().processes.definitions[1][i.numbers[1]];
      return !definition || definition->delay_s > 0.0;
    }
    case Op::kTcp: {
      // A TCP that leaves the tip where it is needs no stop; its values may be expressions, so they
      // are looked at without an error being raised here.
      motion::ToolOffset offset;
      int n = 0;
      for (double* of : {&offset.x_mm, &offset.y_mm, &offset.z_mm}) {
        const Result<Value> value = Evaluate(module().Value(i, n++), *this);
        if (!value) return true;
        *of = value->number;
      }
      return offset != s_.machine.tool.offset;
    }
    default:
      return true;
  }
}

void Control::Execute(const Instruction& i) {
  switch (i.op) {
    case Op::kMove:
      return Move(i);
    case Op::kCoord:
      return SetCoord(static_cast<CoordType>(i.choice));
    case Op::kPath:
      return SetPath(i);
    case Op::kSpeed:
    case Op::kAccel:
    case Op::kOversh:
      return SetPercent(i);
    case Op::kDelay: {
      const std::optional<double> seconds = Real(module().Value(i, 0));
      if (!seconds) return;
      if (*seconds < 0.0)
        return Raise(ErrorCode::kValueRange, "DELAY is " + ShortestText(*seconds));
      if (simulating()) return;
      return Wait({.kind = Pending::Kind::kTime,
                   .since = s_.now,
                   .until = After(*seconds),
                   .wait = machine::WaitKind::kDwell});
    }
    case Op::kSysdef:
      return SetWorkOffset(i);
    case Op::kTcp:
      return SetTool(i);
    case Op::kWorkdef:
      return DefineWork(i);
    case Op::kWork:
      return Work(i);
    case Op::kGo:
      return GoTo(i);
    case Op::kCall:
      return CallProgram(i);
    case Op::kFunction:
      return CallFunction(i);
    case Op::kGoto:
      return Jump(module().Targets(i)[0]);
    case Op::kGotoTable: {
      const std::optional<double> value = Real(module().Value(i, 0));
      if (!value) return;
      const double selected = std::trunc(*value);
      const auto targets = module().Targets(i);
      if (selected >= 1.0 && selected <= static_cast<double>(targets.size())) {
        Jump(targets[static_cast<std::size_t>(selected) - 1]);
      }
      return;
    }
    case Op::kGosub:
      return Gosub(module().Targets(i)[0]);
    case Op::kIf: {
      const std::optional<Value> condition = Eval(module().Value(i, 0));
      if (!condition) return;
      const auto targets = module().Targets(i);
      if (condition->truth()) return Jump(targets[0]);
      if (targets.size() > 1) Jump(targets[1]);
      return;
    }
    case Op::kWait: {
      if (s_.condition_met || simulating()) return;
      const ExprRange expression = RangeOf(module().Value(i, 0));
      const std::optional<bool> met = Truth(expression);
      if (met && !*met)
        Wait({.kind = Pending::Kind::kCondition, .since = s_.now, .expression = expression});
      return;
    }
    case Op::kReturn:
      return Return();
    case Op::kEndtask:
      return EndModule();
    case Op::kPause:
      return Pause("PAUSE");
    case Op::kStop:
      return Pause("STOP");
    case Op::kErr:
      frame().error_label = module().Targets(i)[0];
      return;
    case Op::kNoerr:
      frame().error_label.reset();
      return;
    case Op::kSeterr: {
      const std::optional<double> value = Real(module().Value(i, 0));
      if (!value) return;
      const double number = std::trunc(*value);
      if (!(number >= 1.0 && number <= 9999.0)) {
        return Raise(ErrorCode::kSeterrRange, "SETERR " + ShortestText(*value));
      }
      observer_.OnMessage(s_.now, s_.place, "ERROR " + std::to_string(static_cast<int>(number)));
      return;
    }
    case Op::kTimer:
      return SetTimer(i);
    case Op::kLet:
      return Let(i);
    case Op::kAssign:
      return Assign(i);
    case Op::kUpdate:
    case Op::kImage:
    case Op::kReal:
      return SetGroups(i);
    case Op::kBreak:
      s_.breakpoint = {.program = i.numbers[1] > 0 ? i.numbers[1] : linked().slot,
                       .step = i.numbers[0]};
      s_.machine.breakpoint = s_.breakpoint;  // stays when the program ends: OPT-6.08
      return;
    case Op::kSimul:  // of the next start, not of this run: OPT-6.16
      s_.machine.simul = {.program = i.numbers[1] > 0 ? i.numbers[1] : linked().slot,
                          .step = i.numbers[0]};
      return;
    case Op::kZero:
      return ZeroAxes();
    case Op::kTask:
    case Op::kDeclare:
    case Op::kDefine:
    case Op::kIgnored:
    case Op::kInvalid:
      return;
  }
}

void Control::Wait(Pending pending) {
  s_.pending = pending;
  s_.pending.told = s_.now;
  s_.pending.place = s_.place;
}

void Control::Jump(int label) {
  const std::optional<std::uint32_t> target = index().FindLabel(label);
  if (!target)
    return Raise(ErrorCode::kLabelNotFound, "no sequence number " + std::to_string(label));
  frame().next = *target;
}

void Control::Gosub(int label) {
  if (frame().returns.size() >= static_cast<std::size_t>(parameters_.gosub_depth)) {
    return Raise(ErrorCode::kGosubTooDeep,
                 "more than " + std::to_string(parameters_.gosub_depth) + " GOSUBs");
  }
  const std::uint32_t back = frame().next;
  const std::optional<std::uint32_t> target = index().FindLabel(label);
  if (!target)
    return Raise(ErrorCode::kLabelNotFound, "no sequence number " + std::to_string(label));
  frame().returns.push_back(back);
  frame().next = *target;
}

void Control::Return() {
  if (!frame().returns.empty()) {
    std::optional<ProgramTimer>& timer = program().timer;
    if (timer && timer->level == program().frames.size() &&
        timer->running >= frame().returns.size()) {
      timer->running = 0;
      SkipMissed(*timer, s_.now);  // else a handler longer than its period would be all that runs
    }
    frame().next = frame().returns.back();
    frame().returns.pop_back();
  } else if (program().frames.size() > 1) {
    EndModule();
  } else {
    Raise(ErrorCode::kReturnWithoutGosub, {});
  }
}

void Control::EndModule() {
  if (program().frames.size() > 1) {
    program().frames.pop_back();
    return;
  }
  EndProgram();
}

// OPT-3.49 to 3.52, OPT-B.66
void Control::Pause(std::string_view name) {
  if (s_.mode != machine::Mode::kRemote) return Halt(name);
  Warn(ErrorCode::kStopNotRestartable, std::string(name) + " in REMOTE", "OPT-3.50");
  Finish(machine::OutcomeKind::kStopped, ErrorCode::kStopNotRestartable, std::string(name));
}

void Control::SetTimer(const Instruction& i) {
  if (i.Has(kDis)) {
    program().timer.reset();
    return;
  }
  const std::optional<double> seconds = Real(module().Value(i, 0));
  if (!seconds) return;
  if (*seconds < 0.0) return Raise(ErrorCode::kValueRange, "TIMER is " + ShortestText(*seconds));
  if (simulating()) return;
  // A period below one cycle would never let the program go on.
  const SimTime period = After(std::max(*seconds, parameters_.cycle_s)) - s_.now;
  program().timer = ProgramTimer{.due = TickAfter(*seconds),
                                 .period = period,
                                 .label = module().Targets(i)[0],
                                 .repeats = i.Has(kAuto),
                                 .level = program().frames.size()};
}

}  // namespace rmlcell::optimo
