#pragma once

#include <span>

#include "engine/simulation/verdict/measured_rule.h"

namespace rmlcell::simulation {

// By what the contours of a beam are judged, whatever machine carries it. The limits and their
// reasons: docs/decisions/0021.
std::span<const MeasuredRule> CutRules();

}  // namespace rmlcell::simulation
