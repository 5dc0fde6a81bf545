#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/run.h"
#include "engine/rml1/device.h"

namespace rmlcell::rml1 {

// What a run knows and its device does not: a motion, or an action, may be under way.
struct ToolNow {
  Point at;
  bool spindle_turns = false;
};

// The present value of a register of the device by name, as a person would write it: X Y Z A (where
// the tool is, work units), LX LY LZ (where the program is), VS VZ F V mm/s, DW W ms, MC RPM
// SPINDLE, Z0 Z1 Z2, MODE TOOL, ERR COM, XSTEPS YSTEPS ZSTEPS ASTEPS, ESC.M ESC.T. Nothing for
// other names.
std::optional<machine::VariableValue> ReadRegister(const Device& device, const Profile& profile,
                                                   const ToolNow& tool, std::string_view name);

// What holds until a command changes it, by the names above: speeds, dwell, !MC, rpm, heights,
// mode, tool.
std::vector<machine::ModalValue> ModalRegisters(const Device& device, const Profile& profile,
                                                const ToolNow& tool);

// Whether a machine of this profile has the register.
bool HasRegister(const Profile& profile, std::string_view name);

}  // namespace rmlcell::rml1
