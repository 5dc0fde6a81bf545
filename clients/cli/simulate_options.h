#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "clients/cli/machine_choice.h"
#include "clients/cli/milling.h"
#include "engine/simulation/run/rehearsal.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::cli {

// What `simulate` was asked for, as it was written. Errors of all that read it: CellUsage; those of
// the files that are named.
struct SimulateOptions {
  std::vector<std::string> files;        // programs and folders; the first program is started
  std::vector<std::string> slots;        // "44=FILE"
  std::vector<std::string> executables;  // "44", or "44=FILE"
  int main_slot = 0;                     // 0: from the file name, else 1
  MachineChoice machine;
  std::string inputs_file;
  std::string mode = "cycle";
  double override_percent = 100.0;
  std::string simul;       // "P/S" or "off"
  std::string breakpoint;  // "P/S" or "off"
  std::string budget;      // "steps=N,time=S"
  std::string variables;   // "VR[0..9],VI[99]"
  std::string svg;
  std::string toolpath;
  std::vector<std::string> samples;  // rate and file; empty: none
  std::vector<std::string> plot;     // curves and file; empty: none
  MillingOptions milling;
  std::string state_in;
  std::string state_out;
  bool trace = false;
  bool facts = false;
  bool json = false;
  bool machine_coordinates = false;  // in place of those from the work origin
  bool strict = false;
};

// As the message that jobs have, too. Errors: those of bridge::ParseInputFile, too.
Result<v1::SimulationOptions> OptionsMessage(const SimulateOptions& options,
                                             const machine::MachineFamily& family);

// "steps=1000,time=60"; empty: no limit of its own.
Result<v1::Budget> ParseBudget(std::string_view text);

// --executable 44 makes the executable of program 44 beforehand: its slot is in the answer;
// --executable 44=FILE brings one, which goes to its program.
Result<std::vector<int>> AddExecutables(const std::vector<std::string>& executables,
                                        const machine::MachineFamily& family,
                                        std::vector<simulation::MemoryProgram>& programs);

// Whether the programs that --simul and --break name are there.
Status CheckPlaces(const v1::SimulationOptions& options,
                   const std::vector<simulation::MemoryProgram>& programs);

}  // namespace rmlcell::cli
