#pragma once

#include <string_view>
#include <vector>

#include "engine/machine/step_entry.h"
#include "engine/rml1/device.h"
#include "engine/rml1/variables.h"

namespace rmlcell::rml1 {

// All that a mill is at, a value each, by the names of its registers (variables.h), with "pose",
// "spindle", "origin", "command set". What is fitted to it, tool and clamps, nobody but a person
// knows: `fitted` says of it what can be said. LIVE-6.02
std::vector<machine::StateItem> ItemsOf(const Device& device, const Profile& profile,
                                        const ToolNow& tool, std::string_view fitted);

}  // namespace rmlcell::rml1
