#pragma once

#include <string>
#include <string_view>

#include "engine/core/number_text.h"
#include "engine/core/result.h"
#include "engine/machine/family.h"
#include "engine/machine/machine.h"
#include "engine/machine/machine_states.h"

namespace rmlcell::machine {

// What the state of the machine does not allow, and what is possible instead.
inline Error NotNow(MachineState state, std::string_view possible) {
  return {ErrorCode::kCellMachineState,
          "the machine is " + Told("state", Name(state)) + ": " + std::string(possible),
          {}};
}

// Whether a run of this program can begin, as far as the memory goes; `brought`: it comes along.
inline Status MayRun(const FamilyInfo& info, const MachineMemory& memory, int program,
                     bool brought) {
  const Detail slot = Told("program", program);
  if (!IsSlot(program)) return Error{info.no_slot, "program " + slot + ", allowed are 1 to 99", {}};
  if (!brought && !memory.programs.contains(program))
    return Error{info.empty_slot, "no program is stored in slot " + slot, {}};
  return {};
}

inline constexpr std::string_view kReleaseKeys = "it moves by hand; release the keys first";

}  // namespace rmlcell::machine
