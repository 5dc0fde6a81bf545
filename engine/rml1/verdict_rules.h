#pragma once

#include <span>

#include "engine/machine/verdict.h"

namespace rmlcell::rml1 {

// More of a stream than this belongs to no command: it is no RML-1. Prose and source text have 67
// to 73 %, random bytes 80 %; of the real programs the most damaged one, with thousands of lost
// characters, has 2.1 %.
inline constexpr double kForeignShareMax_percent = 10.0;

// By what a stream is judged, of its figures (figures.h), most serious first.
std::span<const machine::VerdictRule> VerdictRules();

}  // namespace rmlcell::rml1
