#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/run.h"
#include "engine/optimo/language/ast.h"

// What two programs do differently: path, time, power, outputs; not lines of text. Layout,
// comments, names for variables, sequence numbers, the spelling of numbers, ENDTASK at the end and
// (in programs without jumps) modal instructions that change nothing do not count.
namespace rmlcell::optimo {

// What a change touches; a change may touch several.
enum Aspect : std::uint8_t {
  kAspectPath = 1,     // where the tool goes
  kAspectTime = 2,     // how fast, and how long it waits
  kAspectPower = 4,    // processes, schedules, beam
  kAspectOutputs = 8,  // what the machine is told by outputs
  kAspectData = 16,    // variables
  kAspectFlow = 32,    // jumps, calls, ends, error handling
};
// "path, time"
std::string AspectText(unsigned aspects);

struct StepChange {
  enum class Kind { kAdded, kRemoved, kChanged };
  Kind kind = Kind::kChanged;
  unsigned aspects = 0;
  int step_a = 0;  // as the control counts; 0: not in this program
  int step_b = 0;
  std::string before;  // canonical text; empty when added
  std::string after;   // empty when removed
  // What changed within the step, one phrase each: "X 10.0 -> 12.0", "SPEED 10.0 -> 12.0 before
  // it", "goes to step 7 -> step 9".
  std::vector<std::string> what;
  // MOVE whose targets are numbers in both: how far the target moved. Else 0.
  double target_moved_mm = 0.0;
};

// A figure of a run that differs, or that only one of the runs has (the other is 0 then).
struct FigureChange {
  std::string name;
  std::string unit;
  double before = 0.0;
  double after = 0.0;
};

struct ProgramDiff {
  std::vector<StepChange> steps;      // in the order of b; what was removed before what follows it
  std::vector<FigureChange> figures;  // by name
  unsigned aspects = 0;               // of all steps

  bool equal() const { return steps.empty() && figures.empty(); }
};

// Both modules are checked, without errors. `figures_a`, `figures_b`: of a run of each program,
// when the caller made them (time, lengths, beam-on time): figures differ beyond 1e-9 of their
// size.
ProgramDiff Diff(const Module& a, const Module& b,
                 const std::vector<machine::Figure>& figures_a = {},
                 const std::vector<machine::Figure>& figures_b = {});

}  // namespace rmlcell::optimo
