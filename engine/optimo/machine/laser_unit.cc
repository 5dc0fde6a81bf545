#include "engine/optimo/machine/laser_unit.h"

#include <algorithm>

namespace rmlcell::optimo {
namespace {

bool AnyOf(const std::array<bool, kProcessesPerKind>& on) {
  return std::ranges::any_of(on, [](bool b) { return b; });
}

}  // namespace

bool Processes::any_on() const { return beam_on() || AnyOf(on[2]); }
bool Processes::beam_on() const { return AnyOf(on[0]) || AnyOf(on[1]); }

bool Processes::flag(int process) const {
  return std::ranges::any_of(
      on, [&](const auto& kind) { return kind[static_cast<std::size_t>(process)]; });
}

machine::PowerBySpeed RampedPower(const WorkDefinition& definition, double tip_speed_max_mm_s) {
  return {.percent_per_mm_s =
              definition.power_percent * 100.0 / (definition.speed_percent * tip_speed_max_mm_s)};
}

}  // namespace rmlcell::optimo
