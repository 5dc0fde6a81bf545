#pragma once

#include <string>
#include <string_view>

namespace rmlcell::machine {

// What every state of a machine must hold; returns what is wrong with one, empty when nothing is.
// Each family refuses it as text that is none, or makes a machine of it that saves what it read and
// can be started.
std::string TryMachineState(std::string_view bytes);

}  // namespace rmlcell::machine
