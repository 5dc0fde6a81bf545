#pragma once

#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// Warns of what fails whenever it is executed, because nothing in it depends on a variable: a
// division by zero (7201), an overflow (7202, 7203), an argument outside its domain (7204), an
// operand outside its range (7205, 7403, 7505), a WAIT that never ends. By the control these are
// program errors, which ERR may catch (OPT-B.36, OPT-B.47), so that they are no errors of the
// compiler; literals out of range are the checker's. Precondition: Check found no errors. Private
// to the folder.
void AdviseOnConstants(const ParsedProgram& program, Findings& findings);

}  // namespace rmlcell::optimo
