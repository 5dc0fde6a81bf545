#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/machine/parameters.h"

namespace rmlcell::rml1 {

struct GcodeText {
  std::string text;
  std::vector<Diagnostic> findings;  // about the stream, as a check has them
  std::uint64_t findings_dropped = 0;
};

// What a machine with these parameters does with a stream, as G-code (docs/gcode.md): the motions
// of its tool, clipped at its travel, in mm from the XY work origin and from the Z0 of the
// parameters, at the speeds that it would use; spindle, dwells and pauses in their places. Motions
// at the travel speed are G0, all others G1 with F in mm/min. Z words follow !ZO: the zero of the
// G-code stays where it was at power-on.
// Errors: as MakeProfile, CellEmptyProgram, Rml1NoProgram (8007), Rml1RotaryMotion (8107) when the
// rotary axis turns.
Result<GcodeText> ToGcode(std::string_view stream, const machine::Parameters& parameters);

}  // namespace rmlcell::rml1
