#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/core/untold_findings.h"
#include "engine/machine/bytes.h"
#include "engine/machine/parameters.h"
#include "engine/rml1/offline/byte_sink.h"

namespace rmlcell::rml1 {

struct FromGcodeOptions {
  double tolerance_mm = 0.01;         // of the chords of an arc from the arc
  std::size_t bytes_max = 256 << 20;  // of the stream
};

struct FromGcodeOutcome {
  bool ok = false;                   // false: what the sink was given is worth nothing
  std::vector<Diagnostic> findings;  // at most machine::kDiagnosticsMax
  UntoldFindings findings_dropped;
  // The word of the first motion below Z 0 that leads beyond the travel: where CheckWork
  // (work_check.h) finds something to say.
  std::optional<SourceSpan> beyond_travel;
};

// A stream for a machine with these parameters that does what a program of the plain subset of
// docs/gcode.md says. Coordinates are rounded to whole units of the machine, each by itself, so
// nothing accumulates. A word that is not in the subset is an error with its place, unless it says
// nothing to a mill: then it is left out and named once. All lines are read, so that all errors are
// said at once.
//
// A G0 that leads across or down below Z 0 is no rapid on these machines, which travel at full
// speed above the work alone: it becomes a straight motion at the highest speed with Z, and is told
// with its line (Rml1GcodeRapidInWork, 8110). Errors: as MakeProfile; CellInvalidArgument for a
// tolerance that is not above 0; CellEmptyProgram. Those of the program are findings: 8101 to 8104,
// 8108, 8109; advice 8105, 8106.
Result<FromGcodeOutcome> FromGcode(const machine::Bytes& text,
                                   const machine::Parameters& parameters,
                                   const FromGcodeOptions& options, const ByteSink& sink);

}  // namespace rmlcell::rml1
