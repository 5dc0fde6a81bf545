#pragma once

#include <string>
#include <vector>

#include "clients/cli/machine_choice.h"
#include "clients/cli/milling.h"

namespace rmlcell::cli {

// Verbs that need no server.
struct CheckOptions {
  std::vector<std::string> files;
  MachineChoice machine;
  std::string inputs_file;  // what comes from outside while the motion is checked
  bool errors_only = false;
  bool fix = false;      // repair the files, and check what comes out
  bool dry_run = false;  // with fix: show what would change, and write nothing
  bool json = false;
  bool machine_coordinates = false;  // in the figures, too
  bool strict = false;               // a DOUBTFUL verdict is an exit code of 1, too
};
int Check(const CheckOptions& options);

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
int Simulate(const SimulateOptions& options);

// Without a family: families and their profiles. Else all parameters as a machine file, or as JSON.
int ListParameters(const std::string& family_id, const std::string& profile_id, bool json);

int Explain(const std::vector<std::string>& codes, bool json);

}  // namespace rmlcell::cli
