#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine/machine/family.h"
#include "engine/machine/verdict.h"

namespace rmlcell::simulation {

// CHECK of what no text tells: where the motion of a program leaves the travel of an axis, and
// what else the family calls a finding of motion (FamilyInfo::check). The program runs in virtual
// time with the inputs of the setup, by default all off, START being given at every halt; what such
// a run would do is told, with its time, and that it fails, where it does. It is judged by the
// rules of a run (simulation/verdict): with an override of 100 % and nothing else from outside.
//
// Nothing is BAD that hangs on what nobody told the check: a variable or an input that nothing of
// the run has set, or a work offset of a program that ran before. It is DOUBTFUL, and says which.
//
// Bounds, whatever the program does: an object of 34,000 bytes has some thousand steps, so this is
// many times round the longest one, and a part takes less than a day.
inline constexpr std::uint64_t kCheckStepsMax = 50'000;
inline constexpr SimTime kCheckTimeMax = std::chrono::hours(24);

struct MotionCheck {
  std::vector<Diagnostic> findings;  // each with program, step, line and time
  UntoldFindings findings_dropped;
  // By slot: why the motion was not followed to the end of the program, for people: a bound, a wait
  // for an input that never comes, an error.
  std::map<int, std::string> cut_short;
  // What the figures of the runs are judged, and errors of motion that hang on something that the
  // check had to assume (they are warnings among the findings). Each is about the program of its
  // place; where it has none, about the one that was run.
  std::vector<machine::Reason> reasons;

  bool has_errors() const { return HasErrors(findings); }
};

// Checks the programs of `setup` in these slots; mode, budget and forecast are set here. A program
// that another one of them runs (CALL, GO, FUNCTION) is looked at there only: its caller sets its
// SYSDEF and TCP. A family whose translation tells all has nothing to run: no findings.
// Errors: those of MachineFamily::NewRun.
Result<MotionCheck> CheckMotion(const machine::MachineFamily& family,
                                const machine::RunSetup& setup, const std::set<int>& slots);

}  // namespace rmlcell::simulation
