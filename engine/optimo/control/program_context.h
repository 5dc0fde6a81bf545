#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/core/units.h"
#include "engine/optimo/control/plain_code.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/machine/laser_unit.h"

// What a program has of its own while it runs: values, copied with a snapshot. Programs are shared
// and never change (OPT-B.65).
namespace rmlcell::optimo {

// An executable as it was loaded.
struct LoadedProgram {
  Executable executable{};
  std::vector<ModuleIndex> index{};  // parallel to executable.modules
  std::vector<PlainCode> plain{};    // likewise

  int slot() const { return executable.modules.front().slot; }
};
using Loaded = std::shared_ptr<const LoadedProgram>;
Loaded Load(Executable executable);

// One activation of a module: main, or a FUNCTION.
struct Frame {
  int module = 0;                        // of the executable
  std::uint32_t next = 0;                // instruction
  std::vector<std::uint32_t> returns{};  // of GOSUB
  std::optional<int> error_label{};      // ERR, OPT-3.57
  std::array<float, kParameterCount> parameters{};
};

// Values that hold until they are changed; common to the modules of an executable (OPT-9.16).
struct Modal {
  CoordType coord = CoordType::kRobot;
  PathType path = PathType::kPtp;
  double hole_radius_mm = 0.0;
  double speed_percent = 70.0;
  double accel_percent = 100.0;
  double oversh_percent = 100.0;
  std::uint8_t updated = kAllGroups;  // UPDATE ON
  std::uint8_t imaged = 0;            // IMAGE
};

// What the TIMER of a program is at; the table is in program_counter.h.
enum class TimerStage : std::uint8_t {
  kNone,    // none is set
  kCounts,  // to the time when its GOSUB is due
  kRuns,    // its GOSUB runs, of /AUTO: it is made anew when that is over
  kStands,  // still, while a CALLed program runs. OPT-B.89
};

// TIMER. It belongs to the activation that set it: sequence numbers are local to a module.
struct ProgramTimer {
  SimTime due{0};     // kCounts: its GOSUB; kRuns: the next one
  SimTime period{0};  // of /AUTO
  int label = 0;
  bool repeats = false;                // /AUTO
  std::size_t level = 0;               // ProgramContext::frames.size() where it was set
  std::optional<std::size_t> gosub{};  // the depth of its GOSUB while that runs
  std::optional<SimTime> left{};       // kStands: up to `due`

  // Of one that is set. What it was before it stood still is kept: its GOSUB may have made the
  // CALL.
  TimerStage Stage() const {
    if (left) return TimerStage::kStands;
    return gosub ? TimerStage::kRuns : TimerStage::kCounts;
  }
};

// A GOSUB that is made between two instructions: /TIME of a /NEXT motion.
struct DueGosub {
  int label = 0;
  std::size_t level = 0;
};

// An expression that is tested while the program goes on: with the PAR of its own activation.
struct Condition {
  Loaded program{};
  int module = 0;
  ExprRange expression{};
  std::array<float, kParameterCount> parameters{};
};

// A program that runs or waits for the one that it CALLed.
struct ProgramContext {
  Loaded program{};
  std::vector<Frame> frames{};  // main module first
  Modal modal{};
  Processes processes{};
  std::optional<ProgramTimer> timer{};
  std::optional<DueGosub> due_gosub{};

  TimerStage timer_stage() const { return timer ? timer->Stage() : TimerStage::kNone; }
};

}  // namespace rmlcell::optimo
