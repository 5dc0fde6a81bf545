#pragma once

#include "engine/core/result.h"
#include "engine/machine/parameters.h"
#include "engine/machine/tools.h"

namespace rmlcell::rml1 {

// What two streams do differently on a machine with these parameters: motions, their depth and
// speed, spindle, waits and pauses, in their order, and the figures of two runs. How they are
// written does not count: PU and M, one command with many points or many with one, the units of a
// setting. Steps are numbers of commands. Texts and places are in mm of the work.
// Aspects: path; time for speeds and waits; power for the spindle; flow for pauses.
// Errors: as MakeProfile, Rml1NoProgram; Rml1TooManyMotions (8113) beyond kComparedMax.
Result<machine::ProgramDiff> CompareStreams(const machine::ComparedObject& a,
                                            const machine::ComparedObject& b,
                                            const machine::Parameters& parameters);
inline constexpr std::size_t kComparedMax = 500'000;  // actions of one stream; some 50 MB
// Changes beyond these have their aspects and steps, and no text.
inline constexpr std::size_t kToldChangesMax = 20'000;

}  // namespace rmlcell::rml1
