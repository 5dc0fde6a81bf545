#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/rml1/action.h"
#include "engine/rml1/registers.h"

namespace rmlcell::rml1 {

// What a machine keeps from one job to the next while it stays switched on: where the tool stands,
// Z0, heights, speeds, modes and the spindle. Both error registers start clean: whoever starts a
// job has read them. Text, a key and a value a line, with a version in front.
struct MachineState {
  Registers registers;
  Point at;  // machine coordinates
  std::optional<Point>
      origin{};  // X and Y as ORIGIN of the panel set it; none: that of the profile
};
std::string WriteMachineState(const MachineState& state);

// As of a machine where the panel has set the origin; none: as it is.
void UseOrigin(const std::optional<Point>& origin, Profile& profile);
// That which the panel has set; none: it is the profile's.
std::optional<Point> OriginOf(const Profile& profile);

// Errors: CellBadText when the text is none of ours or of another version. A place or a setting
// beyond `profile` is no error: it is limited when the run begins.
Result<MachineState> ReadMachineState(std::string_view text, const Profile& profile);

}  // namespace rmlcell::rml1
