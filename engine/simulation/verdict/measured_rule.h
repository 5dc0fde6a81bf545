#pragma once

#include "engine/simulation/report/report.h"
#include "engine/simulation/verdict/verdict.h"

namespace rmlcell::simulation {

// A figure of a report; nothing where the run has none of it.
struct Measured {
  double value = 0.0;
  machine::Place first{};
  machine::Figure beside{};  // another one that the rule names
};

// A rule for every machine, with how its figure is found in a report.
struct MeasuredRule {
  VerdictRuleInfo info;
  Measured (*measure)(const RunReport&);
};

}  // namespace rmlcell::simulation
