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
// Where nothing of that kind was looked at on the way, an error that ends the run ends every run:
// it is a finding. A program that is missing is one in the whole memory of a machine only.
//
// Bounds, whatever the program does: an object of 34,000 bytes has some thousand steps, so this is
// many times round the longest one, and a part takes less than a day.
inline constexpr std::uint64_t kCheckStepsMax = 50'000;
inline constexpr SimTime kCheckTimeMax = std::chrono::hours(24);

enum class MemoryGiven : std::uint8_t {
  kInPart,  // what is missing may be there on the machine
  kWhole,   // that of a machine: what is missing is not there
};

// The check did not come to the end of a program.
struct CutShort {
  // A code whose advice fits the reason: CellCheckCutShort (a bound), CellCheckLacksProgram,
  // CellCheckWaits, CellCheckFailsPerhaps, CellWaitsForever; where every run ends so, its error.
  ErrorCode cause = ErrorCode::kCellCheckCutShort;
  Detail text{};  // "only up to step 12, line 9: OPT-E7201 ..."

  bool operator==(const CutShort&) const = default;
};

struct MotionCheck {
  std::vector<Diagnostic> findings;  // each with program, step, line and time
  UntoldFindings findings_dropped;
  std::map<int, CutShort> cut_short;  // by slot; programs that were followed to their end are not
  // What the figures of the runs are judged, and errors of motion that hang on something that the
  // check had to assume (they are warnings among the findings). Each is about the program of its
  // place; where it has none, about the one that was run. What was met in a program that another
  // one calls is there for that one, too.
  std::vector<machine::Reason> reasons;

  bool has_errors() const { return HasErrors(findings); }
};

// Checks the programs of `setup` in these slots; mode, budget and forecast are set here. A program
// that another one of them runs (CALL, GO, FUNCTION) is looked at there only: its caller sets its
// SYSDEF and TCP. A family whose translation tells all has nothing to run: no findings.
// Errors: those of MachineFamily::NewRun.
Result<MotionCheck> CheckMotion(const machine::MachineFamily& family,
                                const machine::RunSetup& setup, const std::set<int>& slots,
                                MemoryGiven given = MemoryGiven::kInPart);

}  // namespace rmlcell::simulation
