#include <algorithm>

#include "engine/optimo/control/control.h"
#include "engine/optimo/language/staleness.h"

// Programs that call programs: FUNCTION, CALL, GO, and where they end.
namespace rmlcell::optimo {
namespace {

constexpr std::size_t kCallLevels = 4;      // OPT-7.09
constexpr std::size_t kFunctionLevels = 4;  // OPT-9.08

}  // namespace

// Of a main or CALLed program; the machine stands. OPT-3.34, 3.35, B.54
void Control::EndProgram() {
  program().work_tasks.clear();
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
    return RepeatMain();
  }
  Finish(machine::OutcomeKind::kCompleted, std::nullopt, {});
}

void Control::RepeatMain() {
  const Loaded main = program().program;
  s_.programs.clear();
  Begin(main, {});
  CountExecution(main->slot());
  // A program that carries nothing out still takes its turn: else time would stand for ever.
  if (s_.steps == s_.steps_at_repeat) {
    Wait({.kind = Pending::Kind::kTime,
          .since = s_.now,
          .until = After(parameters_.cycle_s),
          .wait = machine::WaitKind::kLoad});
  }
  s_.steps_at_repeat = s_.steps;
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
  if (found == modules.end())
    return Raise(ErrorCode::kFunctionMissing, "FUNCTION " + std::to_string(slot));
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
          .until = After(parameters_.call_time_s),
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
  s_.machine.selected = 0;  // GO selects it anew
  CountExecution(*slot);
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

// CMOS holds objects and executables together. OPT-B.73
bool Control::HasRoomFor(std::size_t bytes) const {
  std::size_t used = bytes;
  for (const auto& [slot, stored] : setup_.programs) {
    if (stored.object != nullptr) used += stored.object->size();
    if (stored.executable != nullptr) used += stored.executable->size();
  }
  for (const auto& [slot, made] : s_.made_executables) used += made.size();
  return static_cast<double>(used) <= parameters_.cmos_bytes;
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
  if (stored == setup_.programs.end() ||
      (stored->second.object == nullptr && stored->second.executable == nullptr)) {
    Raise(ErrorCode::kProgramMissing, "program " + std::to_string(slot));
    return std::nullopt;
  }
  if (stored->second.executable != nullptr) {
    Result<Executable> executable = DecodeExecutable(*stored->second.executable);
    if (!executable) {
      Raise(executable.error().code, "executable " + std::to_string(slot + kExecutableOffset));
      return std::nullopt;
    }
    if (const int made_of = executable->modules.front().slot; made_of != slot) {
      Warn(ErrorCode::kExecutableStale,
           "executable " + std::to_string(slot + kExecutableOffset) + " holds program " +
               std::to_string(made_of) + " instead of " + std::to_string(slot),
           "OPT-1.15");
    }
    for (const StalePart& part :
         FindStaleParts(slot, *executable, {lookup, setup_.deleted_programs})) {
      if (part.slot == slot) continue;  // what was brought ready made counts, OPT-1.15
      Warn(ErrorCode::kExecutableStale,
           "executable " + std::to_string(slot + kExecutableOffset) + ": " +
               ReasonText(part.slot, part.reason) + "; it holds the old one",
           "OPT-1.13");
    }
    return s_.loaded[slot] = Load(std::move(*executable));
  }
  if (must_be_executable) {
    Raise(ErrorCode::kCallNotExecutable,
          "program " + std::to_string(slot) + " at the fourth level");
    return std::nullopt;
  }
  Result<Executable> executable =
      Link(slot, lookup,
           {.executable_limit = static_cast<std::uint32_t>(parameters_.executable_limit),
            .rotary_table = parameters_.rotary_table});
  if (!executable) {
    Raise(executable.error().code, executable.error().detail);
    return std::nullopt;
  }
  std::string bytes = EncodeExecutable(*executable);
  if (!HasRoomFor(bytes.size())) {
    Raise(ErrorCode::kCmosFull,
          "no room for executable " + std::to_string(slot + kExecutableOffset));
    return std::nullopt;
  }
  observer_.OnProgram(s_.now, s_.place, "compiling", slot);
  s_.made_executables[slot] = std::move(bytes);
  return s_.loaded[slot] = Load(std::move(*executable));
}

}  // namespace rmlcell::optimo
