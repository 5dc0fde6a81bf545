#pragma once

#include "engine/optimo/language/program.h"
#include "engine/optimo/language/start_modes.h"

namespace rmlcell::optimo {

// What a good programmer would say about a checked program, in one pass from top to bottom:
// reserved variables and outputs (OPT-7.104 to 7.106), /FLY where the machine must stop (OPT-2.47
// to 2.53), speeds, order and sensor of chapter 5.5, SYSDEF and TCP with odd numbers. Warnings
// only. Precondition: Check has run; statements that are invalid are skipped.
// `start`: with what the machine starts a program.
void Advise(const ParsedProgram& program, const StartModes& start, Findings& findings);

}  // namespace rmlcell::optimo
