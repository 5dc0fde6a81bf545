#pragma once

#include <optional>

#include "engine/core/result.h"
#include "engine/machine/bytes.h"
#include "engine/machine/parameters.h"

namespace rmlcell::rml1 {

// The one rule of all tools that write what a mill is to do: nothing is written, unless forced, of
// which the machine would leave out a part. Looks at the whole stream. What is wrong has its place
// in that stream: Rml1WorkBeyondTravel (8114), with how far beyond which face and by how much it
// must be moved to fit, when more than 0.01 mm of the work would be lost, the limit of the verdict
// (RML1-E8002); Rml1PartRefused (8115) when coordinates or tool heights are refused (RML1-E8008).
// Nothing: the machine can do it. Error: as MakeProfile.
Result<std::optional<Error>> CheckWork(const machine::Bytes& stream,
                                       const machine::Parameters& parameters);

}  // namespace rmlcell::rml1
