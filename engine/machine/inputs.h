#pragma once

#include <string>
#include <vector>

#include "engine/core/units.h"

namespace rmlcell::machine {

// What comes from outside while a program runs.
enum class InputKind {
  kLogical,   // IL[index] = value
  kAnalogue,  // IA[index] = value
  kDoor,      // operator door; value 1: open
  kStart,     // keys; START also resumes a paused mill; value 1: with the spindle that was stopped
  kHold,
  kStop,
  kEmergencyStop,
  kOverride,  // override in percent
  kVariable,  // a variable by its name, written by hand (Machine: WriteVariable)
};

struct InputChange {
  SimTime at{0};
  InputKind kind = InputKind::kLogical;
  int index = 0;
  double value = 0.0;
  std::string name{};  // of the variable

  bool operator==(const InputChange&) const = default;
};

// Ordered by time; changes of the same time act in the order given.
using InputScript = std::vector<InputChange>;

}  // namespace rmlcell::machine
