#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "engine/machine/step_entry.h"
#include "engine/rml1/action.h"
#include "engine/rml1/device.h"
#include "engine/rml1/profile.h"

// The way to the command where a run begins. LIVE-6.05
namespace rmlcell::rml1 {

// As the recovery of section 5A: up to the top and across at travel speed, the spindle on where
// `spindle_turns` there, and down at V.
std::vector<Action> PlanEntry(const Profile& profile, const Registers& there, bool spindle_turns,
                              const Point& from, const Point& to);

std::string_view NameOfApproach(const Action& motion);  // "PU" or "PD", as moves are told

// By what the place lies outside of the travel.
std::vector<machine::OutOfTravel> OutsideOf(const Profile& profile, const Point& at);

// The number of the command whose name begins at this byte, outside of a call. `device` as before
// the first byte. Error: CellStepUnreachable for a byte inside of a command, a call or an ESC
// sequence, with the command that it belongs to.
Result<int> CommandAt(std::string_view stream, std::int64_t byte_offset, Device device);

}  // namespace rmlcell::rml1
