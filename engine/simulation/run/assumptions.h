#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>

#include "engine/core/detail.h"
#include "engine/machine/inputs.h"
#include "engine/machine/observer.h"

namespace rmlcell::simulation {

// What a run went by although nobody told the check: the first such value, and how many more.
class Assumptions {
 public:
  // Inputs that this script sets are told, all through the run.
  explicit Assumptions(const machine::InputScript& inputs);

  void Add(const machine::Assumed& assumed);

  // ", if VR[86] is 0"; ", if IL[5] is OFF (and 3 more are as they were)". Empty: nothing assumed.
  Detail Text() const;

 private:
  std::set<std::pair<machine::InputKind, int>> told_;
  std::optional<machine::Assumed> first_;
  std::set<std::pair<std::string_view, int>> seen_;
};

}  // namespace rmlcell::simulation
