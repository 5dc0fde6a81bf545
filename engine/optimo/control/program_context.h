#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "engine/core/units.h"
#include "engine/optimo/language/linker.h"
#include "engine/optimo/machine/laser_unit.h"

// What a program has of its own while it runs: values, copied with a snapshot. Programs are shared
// and never change (OPT-B.65).
namespace rmlcell::optimo {

// An executable as it was loaded.
struct LoadedProgram {
  Executable executable{};
  std::vector<ModuleIndex> index{};  // parallel to executable.modules

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
  bool coord_given = false;  // by an instruction; a FUNCTION has that of its caller
  PathType path = PathType::kPtp;
  double hole_radius_mm = 0.0;
  double speed_percent = 70.0;
  double accel_percent = 100.0;
  double oversh_percent = 100.0;
  std::uint8_t updated = kAllGroups;  // UPDATE ON
  std::uint8_t imaged = 0;            // IMAGE
};

// TIMER. It belongs to the activation that set it: sequence numbers are local to a module.
struct ProgramTimer {
  SimTime due{0};
  SimTime period{0};
  int label = 0;
  bool repeats = false;
  std::size_t level = 0;    // ProgramContext::frames.size() where it was set
  std::size_t running = 0;  // depth of its GOSUB while that runs; 0: it does not
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
  SimTime timer_left{0};  // stands still while a CALLed program runs, OPT-B.89
  std::optional<DueGosub> due_gosub{};
};

}  // namespace rmlcell::optimo
