#include "engine/optimo/control/program_counter.h"

#include <algorithm>
#include <utility>

#include "engine/optimo/language/staleness.h"

namespace rmlcell::optimo {
namespace {

// What a repeated timer missed meanwhile is not made up for.
void SkipMissed(ProgramTimer& timer, SimTime now) {
  if (timer.due <= now) timer.due += ((now - timer.due) / timer.period + 1) * timer.period;
}

Error NoLabel(int label) {
  return {ErrorCode::kLabelNotFound, "no sequence number " + Told("label", label), {}};
}

ObjectLookup ObjectsOf(const machine::RunSetup& setup) {
  return [&setup](int wanted) -> std::optional<std::string_view> {
    const auto stored = setup.programs.find(wanted);
    if (stored == setup.programs.end() || stored->second.object == nullptr) return std::nullopt;
    return std::string_view(*stored->second.object);
  };
}

}  // namespace

Loaded Load(Executable executable) {
  auto loaded = std::make_shared<LoadedProgram>();
  loaded->executable = std::move(executable);
  loaded->index.reserve(loaded->executable.modules.size());
  for (const LinkedModule& linked : loaded->executable.modules)
    loaded->index.emplace_back(linked.module);
  loaded->plain.reserve(loaded->index.size());
  for (const ModuleIndex& index : loaded->index)
    loaded->plain.emplace_back(loaded->executable, loaded->plain.size(), index);
  return loaded;
}

void ProgramCounter::Begin(Loaded loaded, const std::array<float, kParameterCount>& parameters) {
  ProgramContext context;
  context.modal.coord = parameters_.coord_default;
  context.modal.path = parameters_.path_default;
  Frame main;
  main.parameters = parameters;
  main.next = loaded->index.front().entry();
  context.frames.push_back(std::move(main));
  context.program = std::move(loaded);
  if (!empty()) {
    ProgramContext& caller = program();
    if (caller.timer) caller.timer->left = std::max(SimTime(0), caller.timer->due - situation_.now);
  }
  s_.programs.push_back(std::move(context));
}

bool ProgramCounter::BeginMain(const Loaded& loaded, int slot) {
  s_.programs.clear();
  Begin(loaded, {});
  return std::exchange(s_.selected, slot) != slot;
}

void ProgramCounter::EndProgram() {
  s_.programs.pop_back();
  std::optional<ProgramTimer>& timer = program().timer;
  if (timer) timer->due = situation_.now + *std::exchange(timer->left, std::nullopt);
}

// CMOS holds objects and executables together. OPT-B.73
bool ProgramCounter::HasRoomFor(std::size_t bytes) const {
  std::size_t used = bytes;
  for (const auto& [slot, stored] : setup_.programs) {
    if (stored.object != nullptr) used += stored.object->size();
    if (stored.executable != nullptr) used += stored.executable->size();
  }
  for (const auto& [slot, made] : s_.made_executables) used += made.size();
  return static_cast<double>(used) <= parameters_.cmos_bytes;
}

Result<Loaded> ProgramCounter::Acquire(int slot, bool must_be_executable) {
  if (const auto known = s_.loaded.find(slot); known != s_.loaded.end()) return known->second;
  const auto stored = setup_.programs.find(slot);
  if (stored == setup_.programs.end() ||
      (stored->second.object == nullptr && stored->second.executable == nullptr)) {
    return Error{ErrorCode::kProgramMissing, "program " + Told("program", slot), {}};
  }
  if (stored->second.executable != nullptr) return LoadStored(slot, *stored->second.executable);
  if (must_be_executable) {
    return Error{ErrorCode::kCallNotExecutable,
                 "program " + Told("program", slot) + " at the fourth level",
                 {}};
  }
  return Make(slot);
}

Result<Loaded> ProgramCounter::LoadStored(int slot, std::string_view bytes) {
  const Detail name = "executable " + Told("executable", slot + kExecutableOffset);
  Result<Executable> executable = DecodeExecutable(bytes);
  if (!executable) return Error{executable.error().code, name, {}};
  if (const int made_of = executable->modules.front().slot; made_of != slot) {
    telling_.Warn(
        ErrorCode::kExecutableStale,
        name + " holds program " + Told("holds", made_of) + " instead of " + Told("program", slot),
        "OPT-1.15");
  }
  for (const StalePart& part :
       FindStaleParts(slot, *executable, {ObjectsOf(setup_), setup_.deleted_programs})) {
    if (part.slot == slot) continue;  // what was brought ready made counts, OPT-1.15
    telling_.Warn(ErrorCode::kExecutableStale,
                  name + ": " + ReasonText(part.slot, part.reason) + "; it holds the old one",
                  "OPT-1.13");
  }
  return s_.loaded[slot] = Load(std::move(*executable));
}

Result<Loaded> ProgramCounter::Make(int slot) {
  Result<Executable> executable =
      Link(slot, ObjectsOf(setup_),
           {.executable_limit = static_cast<std::uint32_t>(parameters_.executable_limit),
            .rotary_table = parameters_.rotary_table});
  if (!executable) return Error{executable.error().code, executable.error().detail, {}};
  std::string bytes = EncodeExecutable(*executable);
  if (!HasRoomFor(bytes.size())) {
    return Error{ErrorCode::kCmosFull,
                 "no room for executable " + Told("executable", slot + kExecutableOffset),
                 {}};
  }
  telling_.observer().OnProgram(situation_.now, situation_.place, machine::kCompiling, slot);
  s_.made_executables[slot] = std::move(bytes);
  return s_.loaded[slot] = Load(std::move(*executable));
}

Status ProgramCounter::Jump(int label) {
  const std::optional<std::uint32_t> target = index().FindLabel(label);
  if (!target) return NoLabel(label);
  frame().next = *target;
  return {};
}

Status ProgramCounter::Gosub(int label) {
  if (frame().returns.size() >= static_cast<std::size_t>(parameters_.gosub_depth)) {
    return Error{ErrorCode::kGosubTooDeep,
                 "more than " + Told("limit", parameters_.gosub_depth) + " GOSUBs",
                 {}};
  }
  const std::optional<std::uint32_t> target = index().FindLabel(label);
  if (!target) return NoLabel(label);
  frame().returns.push_back(frame().next);
  frame().next = *target;
  return {};
}

void ProgramCounter::ReturnFromGosub() {
  std::optional<ProgramTimer>& timer = program().timer;
  if (timer && timer->level == level() && timer->gosub >= frame().returns.size()) {
    timer->gosub.reset();
    // Else a handler longer than its period would be all that runs.
    SkipMissed(*timer, situation_.now);
  }
  frame().next = frame().returns.back();
  frame().returns.pop_back();
}

Result<const LinkedModule*> ProgramCounter::FindFunction(int slot) const {
  if (level() > kFunctionLevels) {
    return Error{ErrorCode::kFunctionTooDeep, "a fifth FUNCTION level", {}};
  }
  const LinkedModule* found = program().program->executable.Find(slot);
  if (found == nullptr) {
    return Error{ErrorCode::kFunctionMissing, "FUNCTION " + Told("function", slot), {}};
  }
  return found;
}

void ProgramCounter::EnterFunction(const LinkedModule& function,
                                   const std::array<float, kParameterCount>& parameters) {
  Frame made;
  made.module = static_cast<int>(&function - program().program->executable.modules.data());
  made.parameters = parameters;
  made.next = program().program->index[static_cast<std::size_t>(made.module)].entry();
  program().frames.push_back(std::move(made));
}

Result<bool> ProgramCounter::JumpToErrorLabel() {
  ProgramContext& context = program();
  for (std::size_t n = context.frames.size(); n-- > 0;) {
    Frame& frame = context.frames[n];
    if (!frame.error_label) continue;
    const int label = *frame.error_label;
    const std::optional<std::uint32_t> handler =
        context.program->index[static_cast<std::size_t>(frame.module)].FindLabel(label);
    if (!handler) {
      return Error{
          ErrorCode::kLabelNotFound, "no sequence number " + Told("label", label) + " for ERR", {}};
    }
    frame.error_label.reset();
    frame.next = *handler;
    context.frames.resize(n + 1);
    context.due_gosub.reset();
    return true;
  }
  return false;
}

void ProgramCounter::SetTimer(int label, SimTime due, SimTime period, bool repeats) {
  program().timer = ProgramTimer{
      .due = due, .period = period, .label = label, .repeats = repeats, .level = level()};
}

void ProgramCounter::Shift(SimTime stood) {
  for (ProgramContext& context : s_.programs) {
    if (context.timer) context.timer->due += stood;
  }
}

std::optional<int> ProgramCounter::TakeDueGosub() {
  ProgramContext& context = program();
  const std::size_t here = level();
  if (context.due_gosub && here <= context.due_gosub->level) {
    const DueGosub due = *context.due_gosub;
    context.due_gosub.reset();
    if (here == due.level) return due.label;
  }
  if (!context.timer || here > context.timer->level) return std::nullopt;
  ProgramTimer& timer = *context.timer;
  if (here < timer.level) {
    context.timer.reset();
    return std::nullopt;
  }
  if (situation_.now < timer.due || timer.Stage() != TimerStage::kCounts) return std::nullopt;
  const int label = timer.label;
  if (timer.repeats) {
    SkipMissed(timer, situation_.now);
    timer.gosub = frame().returns.size() + 1;
  } else {
    context.timer.reset();
  }
  return label;
}

}  // namespace rmlcell::optimo
