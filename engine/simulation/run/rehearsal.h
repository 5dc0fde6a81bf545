#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/machine/family.h"
#include "engine/simulation/run/motion_check.h"

// From the program memory of a machine to a check or a run: the same for the command on a laptop,
// the worker, the server and the editor.
namespace rmlcell::simulation {

struct MemoryProgram {
  int slot = 0;
  std::string name{};       // for people
  std::string file_name{};  // decides units and form of a source
  machine::Bytes bytes{};
  bool is_source = false;  // false: an object (or a stream that was stored)
  machine::Bytes executable{};
  // When it was translated already, without errors.
  std::shared_ptr<const machine::Translation> translation{};
};

// A machine as it stands before a program is started.
struct ProgramMemory {
  const machine::MachineFamily* family = nullptr;
  std::string profile{};
  std::map<std::string, std::string> parameters{};  // over the profile
  std::string parameters_of{};  // where they are from, for people: "mine.toml"; may be empty
  machine::OwnMachine own{};    // whose machine it is, and where its figures are from
  std::vector<MemoryProgram> programs{};  // a later one of the same slot replaces an earlier one
  std::vector<int> deleted_programs{};    // slots that are empty now and were not always
  std::vector<machine::LaserSchedule> schedules{};  // that were stored
  std::string machine_state{};
  MemoryGiven given = MemoryGiven::kInPart;  // how a check takes a program that is missing
};

// Which machine that is, for the report of a program that is not run; its profile alone where its
// parameters cannot be.
machine::MachineUsed MachineOf(const ProgramMemory& memory);

// What a program is run with.
struct RunOptions {
  int main_program = 0;
  std::map<std::string, std::string> parameters{};  // over those of the machine
  machine::Mode mode = machine::Mode::kRemote;
  double override_percent = 100.0;
  // As of RunSetup: that of the machine, which its state keeps, and those of a person.
  std::optional<machine::ProgramStep> breakpoint{};
  std::vector<machine::Breakpoint> breakpoints{};
  std::optional<machine::ProgramStep> simul{};
  machine::InputScript inputs{};
  machine::RunBudget budget{};
};

// The setup of a run, or what stopped a program from being translated.
struct PreparedRun {
  std::optional<machine::RunSetup> setup{};
  std::vector<Diagnostic> diagnostics{};  // of every program that was translated, with its slot
  UntoldFindings diagnostics_dropped{};
};

// Errors: those of machine::MakeParameters: the request itself is wrong.
Result<PreparedRun> PrepareRun(const ProgramMemory& memory, const RunOptions& options);

// Makes the executable of program `slot` of a prepared run, as its machine makes it at START
// (OPT-1.11), and puts it there. Errors: what ends the run before it is made.
Status MakeExecutable(const machine::MachineFamily& family, machine::RunSetup& setup, int slot);

// The translation of one program, whatever it is stored as.
machine::Translation TranslateProgram(const machine::MachineFamily& family,
                                      const machine::Parameters& parameters,
                                      const MemoryProgram& program,
                                      const machine::CheckOptions& options);

// What CHECK finds in a program: in its text, and, where that is good and the family asks for it,
// in its motion.
struct CheckedProgram {
  const machine::MachineFamily* family = nullptr;
  machine::MachineUsed machine{};  // for which it was checked
  int slot = 0;                    // in the program memory of the check
  machine::Translation translation{};
  MotionCheck motion{};  // with what it found in programs that this one calls

  bool ok() const { return translation.ok && !motion.has_errors(); }
};

// What a check says of the part that would come out. The findings that make it so are marked.
machine::Judgement JudgeCheck(CheckedProgram& check);

// Errors: those of MachineFamily::NewRun; that of a slot without program.
Result<CheckedProgram> CheckProgram(const ProgramMemory& memory,
                                    const machine::Parameters& parameters, int slot, bool advice,
                                    const machine::InputScript& inputs);

// The motion of these programs of the memory (motion_check.h). Sources among the others are
// translated, those with errors left out, as if they were not there.
Result<MotionCheck> CheckMotionOf(const ProgramMemory& memory,
                                  const machine::Parameters& parameters, const std::set<int>& slots,
                                  const machine::InputScript& inputs);

}  // namespace rmlcell::simulation
