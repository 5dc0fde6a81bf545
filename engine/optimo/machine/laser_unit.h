#pragma once

#include <array>
#include <optional>

#include "engine/machine/observer.h"
#include "engine/optimo/machine/optimo_parameters.h"

namespace rmlcell::optimo {

inline constexpr int kProcessKinds = 3;       // WORK n
inline constexpr int kProcessesPerKind = 10;  // p

// A WORKDEF in force: its values at the time when it was executed (OPT-3.07). Percent and seconds.
struct WorkDefinition {
  double speed_percent = 0.0;
  double power_percent = 0.0;
  double delay_s = 0.0;
  double peak_percent = 0.0;
  int schedule = 0;  // 0: none
};

// The WORKDEFs of one program and which processes it has ON. OPT-3.11, 3.12
struct Processes {
  using Table =
      std::array<std::array<std::optional<WorkDefinition>, kProcessesPerKind>, kProcessKinds>;
  Table definitions{};
  std::array<std::array<bool, kProcessesPerKind>, kProcessKinds> on{};

  bool any_on() const;
  bool beam_on() const;          // WORK 0 or 1, which have the beam
  bool flag(int process) const;  // IL[87 + p], OPT-3.37
  void AllOff() { on = {}; }
};

// WORKDEF 1 after its dwell: proportional to the tip speed (OPT-3.39, motion.md 8.1).
machine::PowerBySpeed RampedPower(const WorkDefinition& definition, double tip_speed_max_mm_s);

}  // namespace rmlcell::optimo
