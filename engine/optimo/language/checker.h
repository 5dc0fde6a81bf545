#pragma once

#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// Resolves names, sets the type of every expression, step numbers and reads_machine, and reports
// what is wrong: 7004, 7007, 7009 to 7018, 7026, 7029, 7206, 7402, 7403 and the static warnings
// 7008, 7012, 7023, 7036. After a check without errors the module satisfies what the interpreter
// and Evaluate presume.
void Check(ParsedProgram& program, Findings& findings);

// The same for a module without text, as it comes from an object: findings have no place.
// Precondition: every index of the module points into its pools, every run of nodes is one
// expression.
void CheckModule(Module& module, Findings& findings);

}  // namespace rmlcell::optimo
