#pragma once

#include <cstddef>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/untold_findings.h"

namespace rmlcell {

// Adds a finding to a list that tells `most` of them singly; what has no room is counted in
// `untold`. The first error has room whatever was found before it, in place of the last one told:
// it says why there is nothing else.
void KeepFinding(Diagnostic finding, std::size_t most, std::vector<Diagnostic>& told,
                 UntoldFindings& untold);

}  // namespace rmlcell
