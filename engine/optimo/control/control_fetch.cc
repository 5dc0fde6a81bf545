#include <algorithm>

#include "engine/optimo/control/control.h"

// One instruction after the other.
namespace rmlcell::optimo {
namespace {

// Whether a motion of /NEXT is finished before this instruction. `main`: it stands in the main
// module. OPT-B.89
bool WaitsForNext(const Instruction& i, bool main) {
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

bool IsAt(const std::optional<machine::ProgramStep>& step, const machine::Place& place) {
  return step && step->program == place.program && step->step == place.step;
}

}  // namespace

// Nothing that Fetch looks at between two instructions is there, and no plain step brings any of it
// about. Between two /FLY moves none of them needs a standstill.
bool Control::OnlyProgram() const {
  return !s_.entry.arrival && !s_.entry.target && step_watcher_ == nullptr && !now().simulating() &&
         !waits_.condition_met() && !ride_.busy() && halts_.idle() &&
         !counter_.may_be_interrupted();
}

// Plain steps, as many as come one behind the other and are allowed: how many that were. What comes
// next is left to Fetch.
int Control::FetchPlain(int most) {
  if (!plain_.come() || !OnlyProgram()) return 0;
  NoteInstant();
  const bool ahead = ride_.passing();
  if (ahead) most = std::min(most, ride_.may_run_ahead());
  const std::uint64_t allowed = std::min(static_cast<std::uint64_t>(most), StepsToGo());
  const PlainSteps::Done done = plain_.CarryOut(allowed);
  if (done.steps == 0) return 0;
  if (ahead) ride_.RanAhead(static_cast<int>(done.steps));
  s_.op = done.last;
  s_.steps += done.steps;
  waits_.BeginInstruction();
  works_.MarkStale();
  return static_cast<int>(done.steps);
}

// Carries out the next instruction, or finds out that the machine must stand first.
void Control::Fetch() {
  if (s_.entry.arrival) return GoOnApproaching();
  const std::uint32_t at = counter_.index().SkipDeclares(counter_.frame().next);
  const bool at_end = at >= counter_.module().instructions.size();
  if (halts_.due()) {
    if (StandFirst()) return;
    const bool over = at_end && counter_.call_level() == 1 && !counter_.in_function();
    if (halts_.HaltHere(over)) return;
  }
  if (!ride_.passing() && !waits_.condition_met() && !s_.entry.reached) {
    if (const std::optional<int> label = counter_.TakeDueGosub()) {
      if (const Status made = counter_.Gosub(*label); made) {
        NoteTimedGosub();
      } else {
        Raise(made.error());
      }
      return;
    }
  }
  if (at_end) {
    const bool function = counter_.in_function();
    if (!function && ride_.passing()) {
      telling_.Warn(ErrorCode::kFlyCancelled, "/FLY before the end of the program", "OPT-2.47");
    }
    if (function || !StandFirst()) EndModule();
    return;
  }
  const Instruction& i = counter_.module().instructions[at];
  const machine::Place here = telling_.PlaceOf(counter_.linked().slot, i.step);
  if (IsAt(now().simulated_until, here)) {
    EndSimulation(here);
    if (!now().running()) return;
  }
  NoteInstant();
  if (s_.steps >= setup_.budget.steps) {
    return Finish(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kStepBudget,
                  Told("steps", s_.steps) + " steps were executed");
  }
  if (StepsToGo() == 0) {
    return Raise({ErrorCode::kStepBudget,
                  Told("steps", s_.steps - s_.steps_before) + " steps were executed at one instant",
                  {}});
  }
  now().place = here;
  s_.op = i.op;
  if (HaltsBefore(i, here)) return;
  if (!MayCarryOut(i)) return;
  const bool polls =
      i.reads_machine && i.op != Op::kMove && !waits_.condition_met() && !now().simulating();
  if (polls && waits_.PollingTakesTime(here.program, at)) return;
  if (!waits_.condition_met()) {
    waits_.BeginInstruction();
    NoteStep(here);
    telling_.observer().OnStep(now().now, now().place, Describe(i.op).name);
    halts_.BeginStep(here);
  }
  counter_.frame().next = at + 1;
  if (const Status executed = Execute(i); !executed) Raise(executed.error());
  if (waits_.pending().kind == Pending::Kind::kCondition) {
    counter_.frame().next = at;  // carried out again when the condition is met
    return;
  }
  waits_.EndInstruction();
  ++s_.steps;
  works_.MarkStale();
  if (now().running()) halts_.EndStep(here);
}

void Control::NoteInstant() {
  if (s_.instant == now().now) return;
  s_.instant = now().now;
  s_.steps_before = s_.steps;
}

// Up to the budget. LIVE-3.01: a program that lets no time pass, repetitions of one included, goes
// on for ever.
std::uint64_t Control::StepsToGo() const {
  const std::uint64_t to_go = setup_.budget.steps - s_.steps;
  const std::uint64_t at_once = setup_.budget.steps_at_one_instant;
  if (at_once == 0) return to_go;
  return std::min(to_go, at_once - std::min(at_once, s_.steps - s_.steps_before));
}

// True: something moves, and the instruction is fetched again when it is over.
bool Control::StandFirst() {
  if (watch_.stands()) {
    waits_.BeginNoMotion();
    return true;
  }
  if (!ride_.passing() && !ride_.busy()) return false;
  ride_.EndChain();
  waits_.BeginStandstill();
  return true;
}

// False: the motion that goes on must be over before, or the instruction may not stand here.
bool Control::MayCarryOut(const Instruction& i) {
  const bool anew = !waits_.condition_met();
  if (watch_.stands()) {
    if (i.op == Op::kMove && anew) watch_.EndStanding();  // takes over at once: it stands
    if (watch_.stands() && WaitsForNext(i, !counter_.in_function())) return !StandFirst();
  }
  const bool passing = ride_.passing();
  if (!passing && !ride_.busy()) return true;
  if (passing && i.op == Op::kCoord && static_cast<CoordType>(i.choice) != counter_.modal().coord) {
    // A failing instruction is an executed step like any other.
    NoteStep(now().place);
    telling_.observer().OnStep(now().now, now().place, Describe(i.op).name);
    ++s_.steps;
    Raise({ErrorCode::kFlyBeforeCoord, "COORD changes the coordinate type after a /FLY move", {}});
    return false;
  }
  if (ride_.beside() && i.op == Op::kMove && anew) {
    // The new motion takes over at the next tick (motion.md 6, /NEXT).
    waits_.Begin(
        {.kind = Pending::Kind::kTakeOver, .until = cycle_.NextTick(now().now, SimTime(0))});
    return false;
  }
  if (!NeedsStandstill(i) && ride_.RunsAhead()) return true;
  if (passing) {
    telling_.Warn(ErrorCode::kFlyCancelled,
                  "/FLY before " + Told("instruction", Describe(i.op).name) +
                      ": the machine stops at the target",
                  "OPT-2.48");
  }
  StandFirst();
  return false;
}

// Only asked while a /FLY passage is open or a /NEXT motion is under way. OPT-2.48, OPT-B.89
bool Control::NeedsStandstill(const Instruction& i) {
  const bool main = !counter_.in_function();
  if (ride_.beside()) return WaitsForNext(i, main);
  if (i.reads_machine) return true;
  const FlyClass fly = Describe(i.op).fly;
  if (fly != FlyClass::kDepends) return fly == FlyClass::kStandstill;
  switch (i.op) {
    case Op::kMove:
    case Op::kTcp:
      return moves_.NeedsStandstill(i);
    case Op::kWork:
      return works_.NeedsStandstill(i);
    case Op::kEndtask:
      return main;
    default:
      return true;
  }
}

// The first time that control comes to the step: from here on all is real (OPT-6.13, 6.14). What
// the simulated steps asked for takes effect here.
void Control::EndSimulation(const machine::Place& here) {
  const int schedule = works_.TakeSimulatedSchedule();
  now().simulated_until.reset();
  now().place = here;
  if (const Status connected = data_.ConnectOutputs(kAllGroups); !connected) {
    Raise(connected.error());
  }
  if (!now().running() || schedule == 0) return;
  actuators_.Carry({.kind = PassageEffect::Kind::kSchedule, .place = here, .index = schedule});
}

Status Control::Execute(const Instruction& i) {
  const auto step_of = [&] {
    const int program = i.numbers[1] > 0 ? i.numbers[1] : counter_.linked().slot;
    return machine::ProgramStep{.program = program, .step = i.numbers[0]};
  };
  switch (i.op) {
    case Op::kMove:
    case Op::kCoord:
    case Op::kPath:
    case Op::kSpeed:
    case Op::kAccel:
    case Op::kOversh:
    case Op::kSysdef:
    case Op::kTcp:
    case Op::kZero:
      return moves_.Execute(i);
    case Op::kWorkdef:
      return works_.Define(i);
    case Op::kWork:
      return works_.Work(i);
    case Op::kLet:
    case Op::kAssign:
    case Op::kUpdate:
    case Op::kImage:
    case Op::kReal:
      return data_.Execute(i);
    case Op::kGo:
      return GoTo(i);
    case Op::kReturn:
      if (!counter_.in_gosub() && !counter_.in_function()) {
        return Error{ErrorCode::kReturnWithoutGosub, {}, {}};
      }
      if (!counter_.in_gosub()) {
        EndModule();
      } else {
        counter_.ReturnFromGosub();
      }
      return {};
    case Op::kEndtask:
      EndModule();
      return {};
    case Op::kPause:
    case Op::kStop: {  // OPT-3.49 to 3.52, OPT-B.66
      const std::string_view name = i.op == Op::kPause ? "PAUSE" : "STOP";
      if (now().mode != machine::Mode::kRemote) {
        halts_.Halt(machine::HaltReason::kProgram, name);
        return {};
      }
      constexpr ErrorCode kCode = ErrorCode::kStopNotRestartable;
      telling_.Warn(kCode, Told("instruction", name) + " in REMOTE", "OPT-3.50");
      Finish(machine::OutcomeKind::kStopped, kCode, Told("instruction", name));
      return {};
    }
    case Op::kBreak:  // stays when the program ends: OPT-6.08
      halts_.SetBreakpoint(step_of());
      return {};
    case Op::kSimul:  // of the next start, not of this run: OPT-6.16
      s_.simul = step_of();
      return {};
    case Op::kTask:
    case Op::kDeclare:
    case Op::kDefine:
    case Op::kIgnored:
    case Op::kInvalid:
      return {};
    default:
      return flow_.Execute(i);
  }
}

Status Control::GoTo(const Instruction& i) {
  const Result<int> slot = flow_.ProgramNumber(counter_.module().Value(i, 0));
  if (!slot) return slot.error();
  if (counter_.program().processes.any_on()) {
    return Error{
        ErrorCode::kWorkActiveAtCall, "GO " + Told("program", *slot) + " with a WORK ON", {}};
  }
  const Result<Loaded> next = counter_.Acquire(*slot, false);
  if (!next) return next.error();
  if (i.Has(kCycle)) now().mode = machine::Mode::kCycle;
  if (i.Has(kRepeat)) now().mode = machine::Mode::kRepeat;
  if (i.Has(kSingle)) now().mode = machine::Mode::kSingle;
  actuators_.ShutDown();
  telling_.observer().OnProgram(now().now, now().place, "go", *slot);
  counter_.Deselect();
  BeginMain(*next, *slot);
  if (i.Has(kSingle))
    halts_.Halt(machine::HaltReason::kSingle,
                "SINGLE");  // waits for START before its first step, OPT-B.62
  return {};
}

void Control::BeginMain(const Loaded& main, int slot) {
  works_.Clear();
  data_.CountExecution(counter_.BeginMain(main, slot));
}

// The beam's process is a reason of the verdict. A schedule, WORK 2, has no beam and stays selected
// even behind its OFF: OPT-3.23, OPT-3.26.
void Control::TellLeftOn(const Processes& processes) {
  if (processes.beam_on()) {
    telling_.Warn(ErrorCode::kWorkActiveAtEnd, "the program ends with a WORK ON", "OPT-3.34");
    process_watch_.OnLeftOn(now().place);
    return;
  }
  telling_.Tell({.code = ErrorCode::kWorkActiveAtEnd,
                 .severity = Severity::kAdvice,
                 .detail = "the program ends with a WORK 2 ON: it has no beam and does no harm",
                 .rule = "OPT-3.34",
                 .where = {.line = now().place.line},
                 .program = now().place.program,
                 .step = now().place.step});
}

// Of a program the machine stands. OPT-3.34, 3.35, B.54
void Control::EndModule() {
  if (counter_.in_function()) return counter_.LeaveFunction();
  const Processes& processes = counter_.program().processes;
  if (processes.any_on()) {
    TellLeftOn(processes);
    actuators_.BeamOff();
  }
  works_.EndProgram();
  if (counter_.call_level() > 1) {
    counter_.EndProgram();
    telling_.observer().OnProgram(now().now, now().place, "return",
                                  counter_.program().program->slot());
    return;
  }
  actuators_.ShutDown();
  ++s_.executions;
  if (now().mode != machine::Mode::kRepeat) {
    return Finish(machine::OutcomeKind::kCompleted, std::nullopt, {});
  }
  const Loaded main = counter_.program().program;
  BeginMain(main, main->slot());
  // A program that carries nothing out still takes its turn: else time would stand for ever.
  if (s_.steps == s_.steps_at_repeat) {
    waits_.BeginTime(cycle_.seconds(), machine::WaitKind::kLoad);
  }
  s_.steps_at_repeat = s_.steps;
}

}  // namespace rmlcell::optimo
