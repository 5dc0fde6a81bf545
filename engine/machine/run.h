#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/units.h"
#include "engine/machine/inputs.h"
#include "engine/machine/observer.h"
#include "engine/machine/parameters.h"

namespace rmlcell::machine {

// A program as the machine keeps it: object bytes of an Optimo program, the raw stream of a mill.
// Shared, because a stream may be of hundreds of megabytes and several runs read it.
using Bytes = std::shared_ptr<const std::string>;

// What is known of the text that a program was made from.
struct SourceNotes {
  std::vector<int> step_lines{};          // line, from 1, of each step
  std::vector<AllowedFinding> allowed{};  // not to be told when it runs
};

struct StoredProgram {
  std::string name{};
  Bytes object{};
  Bytes executable{};                           // at slot + 100; null when none was made
  std::shared_ptr<const SourceNotes> source{};  // null when no source is known
};

struct LaserSchedule {
  int number = 0;  // 1..63
  std::string name{};
  std::string mode = "CW";
  double power_percent = 100.0;

  bool operator==(const LaserSchedule&) const = default;
};

enum class Mode { kRemote, kCycle, kSingle, kRepeat };  // OPT-4.23

struct ProgramStep {
  int program = 0;
  int step = 0;
};

// The run is ended by the cell when it needs more. 0: no limit.
struct RunBudget {
  std::uint64_t steps = 100'000'000;
  SimTime virtual_time = std::chrono::hours(24 * 30);
};

// All that a run depends on: same setup, same result, on any worker.
struct RunSetup {
  explicit RunSetup(Parameters machine_parameters) : parameters(std::move(machine_parameters)) {}

  Parameters parameters;
  std::map<int, StoredProgram> programs{};  // by slot 1..99
  // Slots that held a program once and are empty now: deleting counts as altering (OPT-1.13).
  std::set<int> deleted_programs{};
  int main_program = 0;                                   // slot to start
  std::optional<std::vector<LaserSchedule>> schedules{};  // none: all that the machine can have
  std::string machine_state{};                            // from SaveMachine; empty: a new machine
  Mode mode = Mode::kCycle;
  double override_percent = 100.0;
  std::optional<ProgramStep> breakpoint{};  // halt after this step; step 0 ends the kept one
  std::optional<ProgramStep> simul{};       // dry run up to this step; step 0 as above
  InputScript inputs{};
  // SIMULATE and CHECK: a motion that leaves the travel of an axis is told as an error, and the run
  // goes on as if the axis could, so that one run tells of all of them; it ends as failed. False,
  // RUN: such a motion is an alarm before it begins (motion.md 2.6).
  bool forecast = false;
  RunBudget budget{};
};

enum class RunPhase {
  kRunning,   // `until` was reached
  kHalted,    // waits for START; time stands until a key or input comes
  kFinished,  // outcome() tells how
};

enum class OutcomeKind { kCompleted, kStopped, kFailed, kCancelled, kBudgetExceeded };
struct Outcome {
  OutcomeKind kind = OutcomeKind::kCompleted;
  std::optional<ErrorCode> code{};  // the machine's own; none when completed
  std::string detail{};
  Place place{};  // of the last step, or where it failed
};

// For people who watch: where the run is now.
struct RunState {
  SimTime time{0};
  RunPhase phase = RunPhase::kRunning;
  Place place{};
  std::string_view instruction{};
  motion::TipPose tip{};
  motion::AxisPose axes{};
  double tip_speed_mm_s = 0.0;
  double override_percent = 100.0;
  bool beam_on = false;
  bool spindle_on = false;
  double progress = -1.0;  // 0..1 where the length of the program is known, else below 0
};

// A figure that a family computes about a finished run, with a stable name.
struct Figure {
  std::string name{};  // "programmed.cut_length"
  std::string unit{};  // "mm"; empty for counts
  double value = 0.0;
};

// Opaque copy of a run at one instant.
class RunSnapshot {
 public:
  virtual ~RunSnapshot() = default;
};

// One execution of a program in virtual time. Deterministic and resumable: how the caller divides
// time into calls of Advance changes nothing that the observer is told. One thread at a time.
class Run {
 public:
  virtual ~Run() = default;

  // Goes on until virtual time `until`, a halt, or the end, whichever comes first. A motion that
  // spans `until` is left in the middle. Scripted inputs act at their times. After much work in one
  // call it may come back earlier, with kRunning: call again.
  virtual RunPhase Advance(SimTime until) = 0;

  // An input or key at the present time, as if scripted for it.
  virtual void Apply(const InputChange& input) = 0;

  // Ends the run at the present time with beam off, shutter closed: CANCELLED, or a budget of the
  // caller.
  virtual void End(OutcomeKind kind, ErrorCode code) = 0;

  virtual RunState state() const = 0;
  virtual const Outcome& outcome() const = 0;  // meaningful after kFinished
  virtual std::uint64_t steps_executed() const = 0;

  // "VR[5]" -> "7.0"; nothing when the family has no such variable.
  virtual std::optional<std::string> ReadVariable(std::string_view name) const = 0;

  virtual std::vector<Figure> figures() const = 0;

  // What the machine keeps for the next run: variables, images, offsets, position. Versioned bytes.
  virtual std::string SaveMachine() const = 0;

  // Executables that this run made, by slot; the cell stores them at slot + 100 (OPT-1.11).
  virtual std::map<int, std::string> made_executables() const { return {}; }

  virtual std::unique_ptr<RunSnapshot> Save() const = 0;
  // Precondition: the snapshot comes from this run, or one made from an equal setup.
  virtual void Restore(const RunSnapshot& snapshot) = 0;
};

}  // namespace rmlcell::machine
