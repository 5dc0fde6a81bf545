#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/machine/family.h"

namespace rmlcell::v1 {
class Budget;
class ScriptedInput;
class SimulationOptions;
}  // namespace rmlcell::v1

// What a simulation is asked for, as the setup of a run: the same for jobs of the queue and for the
// command on a laptop.
namespace rmlcell::bridge {

struct ProgramInput {
  int slot = 0;
  std::string name;       // for people
  std::string file_name;  // decides units and form of a source
  machine::Bytes bytes;
  bool is_source = false;  // false: an object (or a stream that was stored)
  machine::Bytes executable;
};

struct SetupInput {
  const machine::MachineFamily* family = nullptr;
  std::string profile;
  std::map<std::string, std::string> parameters;  // over the profile
  std::vector<ProgramInput> programs;   // a later one of the same slot replaces an earlier one
  std::vector<int> deleted_programs{};  // slots that are empty now and were not always
  int main_program = 0;
  std::optional<std::vector<machine::LaserSchedule>> schedules;  // nothing: all at their defaults
  std::string machine_state;
  machine::Mode default_mode = machine::Mode::kRemote;  // jobs; the command takes CYCLE
};

// A setup, or what stopped a program from being translated.
struct SetupOutcome {
  std::optional<machine::RunSetup> setup;
  std::vector<Diagnostic> diagnostics;  // of every program that was translated, each with its slot
  std::uint64_t diagnostics_dropped = 0;
};

// Errors: CellUnknownParameter, CellParameterRange, CellInvalidArgument: the request itself is
// wrong.
Result<SetupOutcome> MakeSetup(const SetupInput& input, const v1::SimulationOptions& options,
                               const v1::Budget& budget);

// The setup in which the motion of the main program is checked; `main` is its translation. Sources
// among the other programs are translated, those with errors left out, as if they were not there.
machine::RunSetup SetupForCheck(const SetupInput& input, machine::Parameters parameters,
                                const machine::Translation& main);

// Parameters of a machine: defaults of the family, then the profile, then single values. Errors:
// CellInvalidArgument (no such profile), CellUnknownParameter, CellParameterRange, also of values
// that do not fit together.
Result<machine::Parameters> MakeParameters(const machine::MachineFamily& family,
                                           const std::string& profile,
                                           const std::map<std::string, std::string>& parameters);

machine::InputChange FromProto(const v1::ScriptedInput& input);
machine::InputScript InputsOf(const v1::SimulationOptions& options);  // in order of time

// "VR[0..9]", "VI[99]", "Z1" -> the single names, at most 1,000. Error: CellInvalidArgument.
Result<std::vector<std::string>> ExpandVariables(const std::vector<std::string>& names);

}  // namespace rmlcell::bridge
