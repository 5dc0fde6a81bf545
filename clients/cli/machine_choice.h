#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rmlcell::cli {

// For which machine: options on the command line go before those of a file.
struct MachineChoice {
  std::string family;
  std::string profile;
  std::string file;  // TOML
  std::vector<double>
      origin;  // of the program on the machine: X, Y and perhaps Z, mm; empty: as it is
  std::optional<double> clamps_mm;  // how high they stand above the surface of the work
};

}  // namespace rmlcell::cli
