#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/machine/family.h"
#include "engine/simulation/picture/picture.h"
#include "rmlcell/v1/program.pb.h"

// What two programs of a family do differently, the same over the wire and on a laptop.
namespace rmlcell::bridge {

struct ComparedProgram {
  std::string file_name;  // decides units and form, and is its title
  machine::Bytes bytes;
  bool is_object = false;  // whatever the name says
  int slot = 1;            // where it runs, alone in the program memory
};

struct ComparisonOptions {
  bool picture = false;
  std::size_t picture_elements_max = simulation::kPictureElementsMax;
  std::size_t changes_max = 10'000;  // beyond these changed steps are only counted
  std::int64_t steps_max = 0;        // of each run; 0: as long as runs may be
  // Of the machine; a profile by its name, and parameters over it. Neither: the defaults.
  std::string profile{};
  std::map<std::string, std::string> parameters{};
  std::string parameters_of{};    // where those are from, for people: "mine.toml"
  machine::OwnMachine own{};      // whose machine it is
  std::function<bool()> go_on{};  // asked now and then; false: the run is given up, without figures
};

struct ComparisonOutcome {
  bool ok = false;  // false: a program has errors
  v1::DiffProgramsResponse response;
  // Findings of the program before and of the one after; errors alone stop.
  std::array<std::vector<Diagnostic>, 2> diagnostics;
  std::array<UntoldFindings, 2> dropped{};
};

// Errors: ObjectCorrupt (7034), those of a comparison of streams and of MakeParameters;
// CellInvalidArgument for a program of another family, or of one that cannot be compared.
Result<ComparisonOutcome> ComparePrograms(const ComparedProgram& before,
                                          const ComparedProgram& after,
                                          const ComparisonOptions& options);

}  // namespace rmlcell::bridge
