#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/core/untold_findings.h"
#include "engine/machine/bytes.h"
#include "engine/machine/parameters.h"
#include "engine/rml1/offline/byte_sink.h"

namespace rmlcell::rml1 {

// What is about the stream and G-code cannot say: the errors and advice of a check, a last command
// that is not complete, a feed rate that the program does not set (Rml1FeedNotGiven, 8013), a
// spindle that turns at the end, where M30 stops it (Rml1SpindleLeftOn, 8012). Each stands in the
// G-code, too, as a comment in its place.
struct ToGcodeNotes {
  std::vector<Diagnostic> findings;
  UntoldFindings findings_dropped;
};

// What a machine with these parameters does with a stream, as G-code (docs/gcode.md): the motions
// of its tool, clipped at its travel, in mm from the XY work origin and from the Z0 of the
// parameters, at the speeds that it would use; spindle, dwells and pauses in their places. Motions
// at the travel speed are G0, all others G1 with F in mm/min. Z words follow !ZO: the zero of the
// G-code stays where it was at power-on.
// A stream of which the machine leaves out a part (CheckWork, work_check.h) comes out without it.
// Errors: as MakeProfile, CellEmptyProgram, Rml1NoProgram (8007), Rml1RotaryMotion (8107) when the
// rotary axis turns.
Result<ToGcodeNotes> ToGcode(const machine::Bytes& stream, const machine::Parameters& parameters,
                             const ByteSink& sink);

}  // namespace rmlcell::rml1
