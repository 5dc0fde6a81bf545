#pragma once

#include <map>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/run_setup.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/machine/optimo_parameters.h"

namespace rmlcell::optimo {

// Objects by slot; `programs` must outlive it.
ObjectLookup ObjectsOf(const std::map<int, machine::StoredProgram>& programs);

// The memory that a run begins with.
struct RunMemory {
  const std::map<int, machine::StoredProgram>& programs;
  const std::vector<machine::LaserSchedule>& schedules;  // that were stored
  OptimoParameters parameters;
};

// Before anything moves: whether a run of this program has what it names by a number, in itself and
// in all that it calls. What is computed nobody knows before. LIVE-5.02 (b)
// Errors: those of Link; CmosFull (7109), there is no room for the executables that it would make;
// ScheduleMissing (7404), of a WORKDEF.
Status CheckNeeds(const RunMemory& memory, int main_slot);

}  // namespace rmlcell::optimo
