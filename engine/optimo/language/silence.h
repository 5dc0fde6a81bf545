#pragma once

#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// Drops the warnings and advice that a comment allows:
//
//   SPEED 90        ; rmlcell: allow 7033
//   ; rmlcell: allow 7032 7314        on a line of its own: for the line of the next statement
//   ; rmlcell: allow 7413 in file     for the whole text
//
// Errors cannot be allowed. Precondition: the findings have their lines.
void Silence(const ParsedProgram& program, std::vector<Diagnostic>& diagnostics);

}  // namespace rmlcell::optimo
