#pragma once

#include "engine/optimo/language/program.h"
#include "engine/optimo/language/start_modes.h"

namespace rmlcell::optimo {

// What can be said about a checked program along its control flow: WORK and WORKDEF on every path,
// /FLY where the machine must stop, paths in COORD ROBOT, CIR and HOLE without /VIA, two assist
// gases, speeds and order of chapter 5.5, code that is never reached, variables that are read
// before they are set, GOSUB without RETURN and RETURN without GOSUB. Warnings and advice only.
// Programs that no object could hold are left out.
void AdviseOnFlow(const ParsedProgram& program, const StartModes& start, Findings& findings);

}  // namespace rmlcell::optimo
