#pragma once

#include "engine/machine/family.h"

namespace rmlcell::rml1 {

// Roland mills and engravers that speak RML-1.
//
// A program is its raw stream: nothing is compiled, so the object is the stream itself, and the
// check runs it through a device without its clock. Errors of a stream are findings of severity
// `device`, as on the machine, and never refuse it. Translate refuses an empty stream
// (CellEmptyProgram) and parameters that do not fit together; its figures are those of a run,
// without times, and a pause is passed as if the resume key were pressed at once. PlanTransfer
// takes programs only: laser schedules, process definitions and inches are refused. NewRun: see
// MillRun::Make; a slot without program is no error there, the run ends with CellNotFound.
const machine::MachineFamily& Rml1Family();

}  // namespace rmlcell::rml1
