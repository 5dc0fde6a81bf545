#pragma once

#include <string>

// What the engine makes of Optimo programs, as bytes.
namespace rmlcell::server {

std::string ObjectOf(const std::string& source);

// The executable that a first run of the program makes of it, stored alone in `slot`.
std::string ExecutableOf(int slot, const std::string& source);

}  // namespace rmlcell::server
