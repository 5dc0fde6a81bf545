#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/handbox.h"
#include "engine/machine/machine_note.h"
#include "engine/machine/run_setup.h"
#include "engine/optimo/language/ast.h"

// Programs as the handbox sees them: steps with their names, and an end. OPT-4.60, OPT-6.36 to 6.44
namespace rmlcell::optimo {

// "WORKON", "LET", "MOVE". OPT-4.05, OPT-5.36
std::string NameOnDisplay(const Instruction& instruction);

class Steps {
 public:
  explicit Steps(Module module) : module_(std::move(module)) {}

  // Nothing: no program is stored there. Errors: ObjectCorrupt.
  static Result<std::optional<Steps>> Of(const std::map<int, machine::StoredProgram>& programs,
                                         int slot);

  const Module& module() const { return module_; }
  // An ENDTASK that is the last step, else the first step that is vacant.
  int end() const;
  // What is shown of it; a step behind the end is the end.
  machine::ShownStep Show(int program, int step) const;
  bool Has(int step) const { return step >= 1 && step <= static_cast<int>(module_.step_count); }
  // Of this step, DECLAREs counted; of one that is not there, behind all.
  int PlaceOf(int step) const;

 private:
  Module module_;
};

// What it makes of the program, with the text of the step as it is printed. Errors: what the
// compiler says to the program that it would be; ObjectTooLong.
Result<machine::ProgramEdit> InsertStep(const Steps& steps, int program, int step,
                                        std::string_view statement, std::size_t object_limit);
Result<machine::ProgramEdit> DeleteStep(const Steps& steps, int program, int step);
machine::ProgramEdit CreateProgram(int program);  // with ENDTASK alone
machine::ProgramEdit RemoveProgram(const Steps& steps, int program);

// MachineFamily::UndoEdit.
Result<std::string> UndoProgramEdit(const machine::ProgramEdit& edit, std::string_view object);

}  // namespace rmlcell::optimo
