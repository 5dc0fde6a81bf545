#include "engine/optimo/handbox/steps.h"

#include <algorithm>
#include <utility>

#include "engine/core/check.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/language/step_edit.h"

namespace rmlcell::optimo {
namespace {

using machine::ProgramEdit;

constexpr std::string_view kEndMarker = "ENDPRG";

Error AnotherObject() {
  return {ErrorCode::kCellEtagMismatch, "the program is not the one behind the edit", {}};
}

std::string ObjectOfText(std::string_view text) {
  Compilation made = Compile(text, {}, {.object_limit = 0, .advice = false});
  RMLCELL_CHECK(made.ok);
  return std::move(made.object);
}

// The program behind the edit is the one given: what the edit left lies at its place.
Result<std::string> UndoStep(const ProgramEdit& edit, std::string_view object) {
  const Result<Module> module = DecodeObject(object);
  if (!module) return module.error();
  const auto place = static_cast<std::uint32_t>(edit.place);
  if (edit.kind == ProgramEdit::Kind::kDelete) {
    Result<std::string> before = InsertInstruction(*module, place, edit.text_before);
    return before ? std::move(before) : AnotherObject();  // there it was one instruction
  }
  if (place >= module->instructions.size() || InstructionText(*module, place) != edit.text_after)
    return AnotherObject();
  return RemoveInstruction(*module, place);
}

}  // namespace

std::string NameOnDisplay(const Instruction& instruction) {
  std::string name(Describe(instruction.op).name);
  if (instruction.op == Op::kWork) name += instruction.Has(kOn) ? "ON" : "OFF";
  return name;
}

Result<std::optional<Steps>> Steps::Of(const std::map<int, machine::StoredProgram>& programs,
                                       int slot) {
  const auto found = programs.find(slot);
  if (found == programs.end() || found->second.object == nullptr) return std::optional<Steps>();
  Result<Module> module = DecodeObject(*found->second.object);
  if (!module) return module.error();
  return std::optional<Steps>(Steps(*std::move(module)));
}

int Steps::end() const {
  const auto count = static_cast<int>(module_.step_count);
  const bool closed =
      !module_.instructions.empty() && module_.instructions.back().op == Op::kEndtask;
  return closed ? count : count + 1;
}

int Steps::PlaceOf(int step) const {
  return static_cast<int>(ModuleIndex(module_)
                              .FindStep(static_cast<std::uint32_t>(std::max(step, 0)))
                              .value_or(static_cast<std::uint32_t>(module_.instructions.size())));
}

machine::ShownStep Steps::Show(int program, int step) const {
  machine::ShownStep shown{.program = program, .step = std::min(step, end())};
  if (shown.step <= 0) {
    shown.step = 0;
  } else if (Has(shown.step)) {
    shown.instruction =
        NameOnDisplay(module_.instructions[static_cast<std::size_t>(PlaceOf(shown.step))]);
  } else {
    shown.instruction = kEndMarker;
  }
  return shown;
}

Result<ProgramEdit> InsertStep(const Steps& steps, int program, int step,
                               std::string_view statement, std::size_t object_limit) {
  ProgramEdit edit{.kind = ProgramEdit::Kind::kInsert,
                   .program = program,
                   .step = step,
                   .place = steps.PlaceOf(step)};
  const auto place = static_cast<std::uint32_t>(edit.place);
  Result<std::string> object = InsertInstruction(steps.module(), place, statement);
  if (!object) return object.error();
  if (object_limit > 0 && object->size() > object_limit)
    return Error{ErrorCode::kObjectTooLong, "no step has room any more", {}};
  const Result<Module> made = DecodeObject(*object);
  if (!made) return made.error();
  edit.text_after = InstructionText(*made, place);
  edit.object = *std::move(object);
  return edit;
}

Result<ProgramEdit> DeleteStep(const Steps& steps, int program, int step) {
  ProgramEdit edit{.kind = ProgramEdit::Kind::kDelete,
                   .program = program,
                   .step = step,
                   .place = steps.PlaceOf(step)};
  const auto place = static_cast<std::uint32_t>(edit.place);
  edit.text_before = InstructionText(steps.module(), place);
  Result<std::string> object = RemoveInstruction(steps.module(), place);
  if (!object) return object.error();
  edit.object = *std::move(object);
  return edit;
}

ProgramEdit CreateProgram(int program) {
  constexpr std::string_view kText = "     ENDTASK\n";
  return {.kind = ProgramEdit::Kind::kCreate,
          .program = program,
          .text_after = std::string(kText),
          .object = ObjectOfText(kText)};
}

ProgramEdit RemoveProgram(const Steps& steps, int program) {
  return {.kind = ProgramEdit::Kind::kRemove,
          .program = program,
          .text_before = Decompile(steps.module())};
}

Result<std::string> UndoProgramEdit(const ProgramEdit& edit, std::string_view object) {
  if (object != edit.object) return AnotherObject();
  switch (edit.kind) {
    case ProgramEdit::Kind::kCreate:
      return std::string();
    case ProgramEdit::Kind::kRemove: {
      Compilation made = Compile(edit.text_before, {}, {.object_limit = 0, .advice = false});
      if (!made.ok) return AnotherObject();
      return std::move(made.object);
    }
    case ProgramEdit::Kind::kInsert:
    case ProgramEdit::Kind::kDelete:
      break;
  }
  return UndoStep(edit, object);
}

}  // namespace rmlcell::optimo
