#pragma once

#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/machine_states.h"

namespace rmlcell::machine {

// What the state of the machine does not allow, and what is possible instead.
inline Error NotNow(MachineState state, std::string_view possible) {
  return {ErrorCode::kCellMachineState,
          "the machine is " + Told("state", Name(state)) + ": " + std::string(possible),
          {}};
}

inline constexpr std::string_view kReleaseKeys = "it moves by hand; release the keys first";

}  // namespace rmlcell::machine
