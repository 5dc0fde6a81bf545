#pragma once

#include <string>
#include <vector>

#include "clients/cli/machine_choice.h"
#include "clients/cli/simulate_options.h"

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

int Simulate(const SimulateOptions& options);

// Without a family: families and their profiles. Else all parameters as a machine file, or as JSON.
int ListParameters(const std::string& family_id, const std::string& profile_id, bool json);

int Explain(const std::vector<std::string>& codes, bool json);

}  // namespace rmlcell::cli
