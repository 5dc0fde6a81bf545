#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"
#include "engine/optimo/control/control.h"

// Fetching, jumps, calls, errors.
namespace rmlcell::optimo {
namespace {

constexpr std::size_t kCallLevels = 4;      // OPT-7.09
constexpr std::size_t kFunctionLevels = 4;  // OPT-9.08

// Instructions that run ahead between two motions of a /FLY passage. A loop without motion would run ahead
// for ever; a passage that needs more than this becomes a stop.
constexpr int kRunAheadMax = 10'000;

}  // namespace

// Carries out the next instruction, or finds out that the machine must stand first.
void Control::Fetch() {
  const auto stand_first = [&] {
    if (!s_.passing && !Busy()) return false;
    StopMotions();
    s_.pending = {.kind = Pending::Kind::kStandstill};
    return true;
  };
  const auto slot = linked().slot;
  std::uint32_t at = index().SkipDeclares(frame().next);
  const bool at_end = at >= module().instructions.size();
  const bool stop_here = s_.stop_requested && !s_.passing;
  if (s_.hold_requested || stop_here || s_.halt_after_step) {
    if (stand_first()) return;
    const bool over = at_end && s_.programs.size() == 1 && program().frames.size() == 1;
    if (!(s_.halt_after_step && over)) {
      return Halt(s_.halt_after_step ? s_.halt_reason : stop_here ? "STOP" : "HOLD");
    }
    s_.halt_after_step = false;
  }
  ProgramContext& context = program();
  if (context.timer && s_.now >= context.timer->due && !s_.passing && !s_.condition_met) {
    const int label = context.timer->label;
    if (context.timer->repeats) {
      context.timer->due += context.timer->period;
    } else {
      context.timer.reset();
    }
    return Gosub(label);
  }
  if (at_end) {
    const bool function = program().frames.size() > 1;
    if (!function && s_.passing) Warn(ErrorCode::kFlyCancelled, "/FLY before the end of the program", "OPT-2.47");
    if (!function && stand_first()) return;
    return EndModule();
  }
  const Instruction& i = module().instructions[at];
  if (simulating() && slot == s_.simulated.until.program &&
      i.step == static_cast<std::uint32_t>(s_.simulated.until.step)) {
    // The first time that control comes to the step: from here on all is real (OPT-6.13, 6.14).
    const int schedule = s_.simulated.schedule;
    s_.simulated = {};
    ConnectOutputs();
    if (schedule > 0) Carry({.kind = PassageEffect::Kind::kSchedule, .place = s_.place, .index = schedule});
    if (s_.phase != machine::RunPhase::kRunning || s_.pending.kind != Pending::Kind::kNone) return;
  }
  if (s_.steps >= setup_.budget.steps) {
    return Finish(machine::OutcomeKind::kBudgetExceeded, ErrorCode::kStepBudget,
                  std::to_string(s_.steps) + " steps were executed");
  }
  s_.place = {.program = slot, .step = static_cast<int>(i.step)};
  s_.op = i.op;
  if (s_.passing || Busy()) {
    if (s_.passing && i.op == Op::kCoord && static_cast<CoordType>(i.choice) != modal().coord) {
      return Raise(ErrorCode::kFlyBeforeCoord, "COORD changes the coordinate type after a /FLY move");
    }
    if (s_.background && i.op == Op::kMove) {
      // The new motion takes over at the next tick (motion.md 6, /NEXT).
      s_.pending = {.kind = Pending::Kind::kTakeOver, .since = s_.now, .until = NextTick(SimTime(0))};
      return;
    }
    if (NeedsStandstill(i) || s_.run_ahead >= kRunAheadMax) {
      if (s_.passing) {
        Warn(ErrorCode::kFlyCancelled,
             "/FLY before " + std::string(Describe(i.op).name) + ": the machine stops at the target", "OPT-2.48");
      }
      stand_first();
      return;
    }
    ++s_.run_ahead;
  }
  if (!s_.condition_met) {
    s_.instruction_since = s_.now;
    observer_.OnStep(s_.now, s_.place, Describe(i.op).name);
  }
  const std::size_t depth = s_.programs.size();
  const std::size_t level = context.frames.size();
  frame().next = at + 1;
  Execute(i);
  if (s_.pending.kind == Pending::Kind::kCondition && s_.programs.size() == depth &&
      s_.programs.back().frames.size() == level) {
    frame().next = at;  // carried out again when the condition is met
    return;
  }
  s_.condition_met = false;
  ++s_.steps;
  if (s_.phase != machine::RunPhase::kRunning) return;
  const bool breakpoint = s_.breakpoint && s_.breakpoint->program == slot &&
                          static_cast<std::uint32_t>(s_.breakpoint->step) == i.step;
  if (breakpoint || s_.mode == machine::Mode::kSingle) {
    s_.halt_after_step = true;
    s_.halt_reason = breakpoint ? "BREAK" : "SINGLE";
  }
}

// Only asked while a /FLY passage is open or a /NEXT motion is under way. OPT-2.48, OPT-B.89
bool Control::NeedsStandstill(const Instruction& i) {
  if (s_.background) {
    switch (i.op) {
      case Op::kCall:
      case Op::kGo:
      case Op::kZero:
      case Op::kTcp:
      case Op::kCoord: return true;
      case Op::kEndtask: return program().frames.size() == 1;
      default: return false;
    }
  }
  if (i.reads_machine) return true;
  const FlyClass fly = Describe(i.op).fly;
  if (fly != FlyClass::kDepends) return fly == FlyClass::kStandstill;
  switch (i.op) {
    case Op::kMove: return i.Has(kStart);
    case Op::kEndtask: return program().frames.size() == 1;
    case Op::kWork: {
      if (i.Has(kStart)) return true;
      if (!i.Has(kOn) || i.numbers[0] != 1) return false;
      const auto& definition = program().processes.definitions[1][i.numbers[1]];
      return !definition || definition->delay_s > 0.0;
    }
    case Op::kTcp: {
      // A TCP that leaves the tip where it is needs no stop; its values may be expressions, so they are
      // looked at without an error being raised here.
      std::array<double, 3> v{};
      for (int n = 0; n < 3; ++n) {
        const Result<Value> value = Evaluate(module().Value(i, n), *this);
        if (!value) return true;
        v[static_cast<std::size_t>(n)] = value->number;
      }
      return motion::ToolOffset{v[0], v[1], v[2]} != s_.machine.tool.offset;
    }
    default: return true;
  }
}

void Control::Execute(const Instruction& i) {
  switch (i.op) {
    case Op::kMove: return Move(i);
    case Op::kCoord: return SetCoord(static_cast<CoordType>(i.choice));
    case Op::kPath: return SetPath(i);
    case Op::kSpeed:
    case Op::kAccel:
    case Op::kOversh: return SetPercent(i);
    case Op::kDelay: {
      const std::optional<double> seconds = Real(module().Value(i, 0));
      if (!seconds) return;
      if (*seconds < 0.0) return Raise(ErrorCode::kValueRange, "DELAY is " + ShortestText(*seconds));
      if (simulating() || *seconds <= 0.0) return;
      return Wait({.kind = Pending::Kind::kTime,
                   .since = s_.now,
                   .until = s_.now + FromSeconds(*seconds),
                   .wait = machine::WaitKind::kDwell,
                   .power_percent = s_.beam.on ? s_.beam.power.constant_percent : 0.0});
    }
    case Op::kSysdef: return SetWorkOffset(i);
    case Op::kTcp: return SetTool(i);
    case Op::kWorkdef: return DefineWork(i);
    case Op::kWork: return Work(i);
    case Op::kGo: return GoTo(i);
    case Op::kCall: return CallProgram(i);
    case Op::kFunction: return CallFunction(i);
    case Op::kGoto: return Jump(module().Targets(i)[0]);
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
    case Op::kGosub: return Gosub(module().Targets(i)[0]);
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
      const auto expression = static_cast<std::uint32_t>(module().Value(i, 0).data() - module().nodes.data());
      const std::optional<bool> met = Truth(expression);
      if (met && !*met) Wait({.kind = Pending::Kind::kCondition, .since = s_.now, .expression = expression});
      return;
    }
    case Op::kReturn: return Return();
    case Op::kEndtask: return EndModule();
    case Op::kPause: return Pause("PAUSE");
    case Op::kStop: return Pause("STOP");
    case Op::kErr: frame().error_label = module().Targets(i)[0]; return;
    case Op::kNoerr: frame().error_label.reset(); return;
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
    case Op::kTimer: return SetTimer(i);
    case Op::kLet: return Let(i);
    case Op::kAssign: return Assign(i);
    case Op::kUpdate:
    case Op::kImage:
    case Op::kReal: return SetGroups(i);
    case Op::kBreak:
      s_.breakpoint = {.program = i.numbers[1] > 0 ? i.numbers[1] : linked().slot, .step = i.numbers[0]};
      return;
    case Op::kSimul: return;  // arms the next start: OPT-6.16
    case Op::kZero: return ZeroAxes();
    case Op::kTask:
    case Op::kDeclare:
    case Op::kDefine:
    case Op::kIgnored:
    case Op::kInvalid: return;
  }
}

void Control::Wait(Pending pending) { s_.pending = pending; }

void Control::Jump(int label) {
  const std::optional<std::uint32_t> target = index().FindLabel(label);
  if (!target) return Raise(ErrorCode::kLabelNotFound, "no sequence number " + std::to_string(label));
  frame().next = *target;
}

void Control::Gosub(int label) {
  if (frame().returns.size() >= static_cast<std::size_t>(parameters_.gosub_depth)) {
    return Raise(ErrorCode::kGosubTooDeep, "more than " + std::to_string(parameters_.gosub_depth) + " GOSUBs");
  }
  const std::uint32_t back = frame().next;
  const std::optional<std::uint32_t> target = index().FindLabel(label);
  if (!target) return Raise(ErrorCode::kLabelNotFound, "no sequence number " + std::to_string(label));
  frame().returns.push_back(back);
  frame().next = *target;
}

void Control::Return() {
  if (!frame().returns.empty()) {
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

// Of a main or CALLed program; the machine stands. OPT-3.34, 3.35, B.54
void Control::EndProgram() {
  if (program().processes.any_on()) {
    Warn(ErrorCode::kWorkActiveAtEnd, "the program ends with a WORK ON", "OPT-3.34");
    program().processes.AllOff();
    BeamOff();
  }
  if (s_.programs.size() > 1) {
    s_.programs.pop_back();
    if (program().timer) program().timer->due = s_.now + program().timer_left;
    observer_.OnProgram(s_.now, s_.place, "return", program().program->slot());
    return;
  }
  BeamOff();
  CloseShutter();
  if (s_.mode == machine::Mode::kRepeat) {
    const Loaded main = program().program;
    s_.programs.clear();
    Begin(main, {});
    s_.machine.data.vi[98] += 1.0F;
    if (s_.hold_requested) Halt("HOLD");
    return;
  }
  Finish(machine::OutcomeKind::kCompleted, std::nullopt, {});
}

void Control::CallFunction(const Instruction& i) {
  const int slot = i.numbers[0];
  std::array<float, kParameterCount> parameters{};
  if (slot == kRotaryTableFunction && parameters_.rotary_table) {
    const std::optional<double> degrees = i.value_count > 1 ? Real(module().Value(i, 1)) : 0.0;
    if (degrees && !simulating()) {
      Show({.kind = PassageEffect::Kind::kTable, .place = s_.place, .value = *degrees});
    }
    return;
  }
  if (program().frames.size() > kFunctionLevels) {
    return Raise(ErrorCode::kFunctionTooDeep, "a fifth FUNCTION level");
  }
  const std::vector<LinkedModule>& modules = program().program->executable.modules;
  const auto found = std::ranges::find(modules, slot, &LinkedModule::slot);
  if (found == modules.end()) return Raise(ErrorCode::kFunctionMissing, "FUNCTION " + std::to_string(slot));
  if (!PassParameters(i, found->module, parameters)) return;
  Frame made;
  made.module = static_cast<int>(found - modules.begin());
  made.parameters = parameters;
  made.next = program().program->index[static_cast<std::size_t>(made.module)].entry();
  program().frames.push_back(std::move(made));
}

// Values are copied in, converted to the type that the callee defines. OPT-9.26, 9.27
bool Control::PassParameters(const Instruction& i, const Module& callee,
                             std::array<float, kParameterCount>& out) {
  for (int n = 1; n < i.value_count; ++n) {
    const std::optional<Value> value = Eval(module().Value(i, n));
    if (!value) return false;
    const auto at = static_cast<std::size_t>(n - 1);
    const Result<float> converted = ConvertTo(callee.parameter_types[at], *value);
    if (!converted) {
      Raise(converted.error().code, converted.error().detail);
      return false;
    }
    out[at] = *converted;
  }
  return true;
}

std::optional<int> Control::ProgramNumber(Expression expression) {
  const std::optional<double> value = Real(expression);
  if (!value) return std::nullopt;
  const Result<int> number = TruncateToInteger(static_cast<float>(*value));
  if (!number) {
    Raise(number.error().code, number.error().detail);
    return std::nullopt;
  }
  if (!IsSlot(*number)) {
    Raise(ErrorCode::kProgramNumber, "program number is " + std::to_string(*number));
    return std::nullopt;
  }
  return *number;
}

void Control::CallProgram(const Instruction& i) {
  const std::optional<int> slot = ProgramNumber(module().Value(i, 0));
  if (!slot) return;
  if (program().processes.any_on()) {
    return Raise(ErrorCode::kWorkActiveAtCall, "CALL " + std::to_string(*slot) + " with a WORK ON");
  }
  if (s_.programs.size() > kCallLevels) {
    return Raise(ErrorCode::kCallTooDeep, "CALL " + std::to_string(*slot) + " is a fifth level");
  }
  const std::optional<Loaded> callee = Acquire(*slot, s_.programs.size() == kCallLevels);
  if (!callee) return;
  std::array<float, kParameterCount> parameters{};
  if (!PassParameters(i, (*callee)->executable.modules.front().module, parameters)) return;
  if (program().timer) program().timer_left = std::max(SimTime(0), program().timer->due - s_.now);
  observer_.OnProgram(s_.now, s_.place, "call", *slot);
  Begin(*callee, parameters);
  if (parameters_.call_time_s > 0.0 && !simulating()) {
    Wait({.kind = Pending::Kind::kTime,
          .since = s_.now,
          .until = s_.now + FromSeconds(parameters_.call_time_s),
          .wait = machine::WaitKind::kLoad});
  }
}

void Control::GoTo(const Instruction& i) {
  const std::optional<int> slot = ProgramNumber(module().Value(i, 0));
  if (!slot) return;
  if (program().processes.any_on()) {
    return Raise(ErrorCode::kWorkActiveAtCall, "GO " + std::to_string(*slot) + " with a WORK ON");
  }
  const std::optional<Loaded> next = Acquire(*slot, false);
  if (!next) return;
  if (i.Has(kCycle)) s_.mode = machine::Mode::kCycle;
  if (i.Has(kRepeat)) s_.mode = machine::Mode::kRepeat;
  if (i.Has(kSingle)) s_.mode = machine::Mode::kSingle;
  BeamOff();
  CloseShutter();
  observer_.OnProgram(s_.now, s_.place, "go", *slot);
  s_.programs.clear();
  Begin(*next, {});
  s_.machine.data.vi[98] = 1.0F;
  if (i.Has(kSingle)) Halt("SINGLE");  // waits for START before its first step, OPT-B.62
}

void Control::Begin(Loaded loaded, const std::array<float, kParameterCount>& parameters) {
  ProgramContext context;
  context.modal.coord = parameters_.coord_default;
  context.modal.path = parameters_.path_default;
  Frame main;
  main.parameters = parameters;
  main.next = loaded->index.front().entry();
  context.frames.push_back(std::move(main));
  context.program = std::move(loaded);
  s_.programs.push_back(std::move(context));
}

// The executable of a slot: the stored one, or made of the object now (OPT-1.11).
std::optional<Loaded> Control::Acquire(int slot, bool must_be_executable) {
  if (const auto known = s_.loaded.find(slot); known != s_.loaded.end()) return known->second;
  const ObjectLookup lookup = [this](int wanted) -> std::optional<std::string_view> {
    const auto stored = setup_.programs.find(wanted);
    if (stored == setup_.programs.end() || stored->second.object == nullptr) return std::nullopt;
    return std::string_view(*stored->second.object);
  };
  const auto stored = setup_.programs.find(slot);
  if (stored == setup_.programs.end() || (stored->second.object == nullptr && stored->second.executable == nullptr)) {
    Raise(ErrorCode::kProgramMissing, "program " + std::to_string(slot));
    return std::nullopt;
  }
  if (stored->second.executable != nullptr) {
    Result<Executable> executable = DecodeExecutable(*stored->second.executable);
    if (!executable) {
      Raise(executable.error().code, "executable " + std::to_string(slot + kExecutableOffset));
      return std::nullopt;
    }
    for (const int stale : StaleFunctions(*executable, lookup)) {
      Warn(ErrorCode::kExecutableStale,
           "executable " + std::to_string(slot + kExecutableOffset) + " holds an older FUNCTION " +
               std::to_string(stale),
           "OPT-1.13");
    }
    return s_.loaded[slot] = Load(std::move(*executable));
  }
  if (must_be_executable) {
    Raise(ErrorCode::kCallNotExecutable, "program " + std::to_string(slot) + " at the fourth level");
    return std::nullopt;
  }
  Result<Executable> executable =
      Link(slot, lookup, {.executable_limit = static_cast<std::uint32_t>(parameters_.executable_limit),
                          .rotary_table = parameters_.rotary_table});
  if (!executable) {
    Raise(executable.error().code, executable.error().detail);
    return std::nullopt;
  }
  observer_.OnProgram(s_.now, s_.place, "compiling", slot);
  s_.made_executables[slot] = EncodeExecutable(*executable);
  return s_.loaded[slot] = Load(std::move(*executable));
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
  const SimTime period = FromSeconds(std::max(*seconds, parameters_.cycle_s));
  program().timer = ProgramTimer{.due = s_.now + FromSeconds(*seconds),
                                 .period = period,
                                 .label = module().Targets(i)[0],
                                 .repeats = i.Has(kAuto)};
}

void Control::Warn(ErrorCode code, std::string detail, std::string_view rule) {
  observer_.OnDiagnostic(s_.now, {.code = code,
                                  .severity = Lookup(code).severity,
                                  .detail = std::move(detail),
                                  .rule = std::string(rule),
                                  .program = s_.place.program,
                                  .step = s_.place.step});
}

// The failing instruction has no effect. What moves comes to rest first; an error that was raised ahead of a
// motion is handled when that motion is over.
void Control::Raise(ErrorCode code, std::string detail) {
  const Error error{code, std::move(detail), {}};
  if (s_.deferred) return;
  if (s_.passing || Busy()) {
    if (s_.background && s_.active) EndMotionHere();
    StopMotions();
    s_.deferred = error;
    s_.pending = {.kind = Pending::Kind::kStandstill};
    return;
  }
  HandleError(error);
}

void Control::HandleError(const Error& error) {
  const CatalogueEntry& entry = Lookup(error.code);
  s_.machine.data.vi[99] = static_cast<float>(entry.number);
  s_.pending = {};
  s_.condition_met = false;
  s_.time_label.reset();
  s_.end_condition.reset();
  s_.watched_move.reset();
  BeamOff();
  Severity severity = entry.severity;
  std::optional<std::uint32_t> handler;
  std::size_t catching = 0;
  if (!s_.programs.empty()) {
    program().processes.AllOff();
    // The innermost module with an armed ERR, up to the main module of this executable (OPT-3.57).
    std::vector<Frame>& frames = program().frames;
    for (std::size_t n = frames.size(); severity == Severity::kProgram && n-- > 0;) {
      if (!frames[n].error_label) continue;
      catching = n;
      handler = program().program->index[static_cast<std::size_t>(frames[n].module)].FindLabel(*frames[n].error_label);
      if (!handler) {
        Warn(error.code, error.detail, {});
        s_.machine.data.vi[99] = 60.0F;
        return Finish(machine::OutcomeKind::kFailed, ErrorCode::kLabelNotFound,
                      "no sequence number " + std::to_string(*frames[n].error_label) + " for ERR");
      }
      break;
    }
  }
  Warn(error.code, error.detail, {});
  if (!handler) return Finish(machine::OutcomeKind::kFailed, error.code, error.detail);
  program().frames.resize(catching + 1);
  frame().error_label.reset();  // taking the handler disarms it, OPT-3.55
  frame().next = *handler;
}

}  // namespace rmlcell::optimo
