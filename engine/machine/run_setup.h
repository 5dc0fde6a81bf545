#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/units.h"
#include "engine/machine/bytes.h"
#include "engine/machine/inputs.h"
#include "engine/machine/parameters.h"

namespace rmlcell::machine {

// What is known of the text that a program was made from.
struct SourceNotes {
  std::vector<int> step_lines{};          // line, from 1, of each step
  std::vector<AllowedFinding> allowed{};  // not to be told when it runs
};

struct StoredProgram {
  std::string name{};
  Bytes object{};
  Bytes executable{};                           // at slot + 100; nothing when none was made
  std::shared_ptr<const SourceNotes> source{};  // null when no source is known
};

struct LaserSchedule {
  int number = 0;  // 1..63
  std::string name{};
  std::string mode = "CW";
  double power_percent = 100.0;

  bool operator==(const LaserSchedule&) const = default;
};

// OPT-4.23. In MANUAL no run begins and none goes on.
enum class Mode { kRemote, kCycle, kSingle, kRepeat, kManual };

struct ProgramStep {
  int program = 0;
  int step = 0;

  bool operator==(const ProgramStep&) const = default;
};

// Of a machine that lives: it is kept in each mark, of at most 16 KiB. LIVE-3.23
inline constexpr std::size_t kBreakpointsMax = 100;
inline constexpr std::size_t kBreakpointConditionMax = 80;  // bytes
inline constexpr std::uint64_t kBreakpointPassMax = 1'000'000'000'000;

// Where somebody who watches a run wants it to halt: behind this step, as behind HOLD.
struct Breakpoint {
  ProgramStep at{};
  std::string condition{};      // in the language of the family: "VI[3] > 10"; empty: always
  std::uint64_t from_pass = 1;  // of the passes on which it holds, the first that halts

  bool operator==(const Breakpoint&) const = default;
};

// The run is ended by the cell when it needs more. 0: no limit.
struct RunBudget {
  std::uint64_t steps = 100'000'000;
  SimTime virtual_time = std::chrono::hours(24 * 30);
  // With no virtual time between them. The run comes to rest and fails with the code of `steps`.
  std::uint64_t steps_at_one_instant = 0;
};

// A machine that lives has no other budget: nobody waits for its time, but a program that lets none
// pass would keep it for ever. LIVE-3.01
inline constexpr RunBudget kLiveBudget = {
    .steps = 0, .virtual_time = SimTime(0), .steps_at_one_instant = 10'000'000};

// All that a run depends on: same setup, same result, on any worker.
struct RunSetup {
  explicit RunSetup(Parameters machine_parameters) : parameters(std::move(machine_parameters)) {}

  Parameters parameters;
  std::map<int, StoredProgram> programs{};  // by slot 1..99
  // Slots that held a program once and are empty now: deleting counts as altering (OPT-1.13).
  std::set<int> deleted_programs{};
  int main_program = 0;                    // slot to start
  std::vector<LaserSchedule> schedules{};  // stored; the others are as the machine has them
  std::string machine_state{};             // from SaveMachine; empty: a new machine
  Mode mode = Mode::kCycle;
  double override_percent = 100.0;
  std::optional<ProgramStep> breakpoint{};  // halt after this step; step 0 ends the kept one
  std::vector<Breakpoint> breakpoints{};    // of a person: set before it begins, kept by no machine
  std::optional<ProgramStep> simul{};       // dry run up to this step; step 0 as above
  InputScript inputs{};
  // SIMULATE and CHECK: a motion that leaves the travel of an axis is told as an error, and the run
  // goes on as if the axis could, so that one run tells of all of them; it ends as failed. False,
  // RUN: such a motion is an alarm before it begins (motion.md 2.6).
  bool forecast = false;
  RunBudget budget{};
};

}  // namespace rmlcell::machine
