#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/machine/parameters.h"

namespace rmlcell::rml1 {

struct FromGcodeOptions {
  double tolerance_mm = 0.01;         // of the chords of an arc from the arc
  std::size_t bytes_max = 256 << 20;  // of the stream
};

struct StreamOfGcode {
  bool ok = false;  // false: `stream` is empty
  std::string stream;
  std::vector<Diagnostic> findings;  // at most machine::kDiagnosticsMax
  std::uint64_t findings_dropped = 0;
};

// A stream for a machine with these parameters that does what a program of the plain subset of
// docs/gcode.md says. Coordinates are rounded to whole units of the machine, each by itself, so
// nothing accumulates. A word that is not in the subset is an error with its place, unless it says
// nothing to a mill: then it is left out and named once. All lines are read, so that all errors are
// said at once.
// Errors: as MakeProfile; CellInvalidArgument for a tolerance that is not above 0;
// CellEmptyProgram. Those of the program are findings: 8101 to 8104, 8108, 8109; advice 8105, 8106.
Result<StreamOfGcode> FromGcode(std::string_view text, const machine::Parameters& parameters,
                                const FromGcodeOptions& options = {});

}  // namespace rmlcell::rml1
