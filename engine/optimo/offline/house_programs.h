#pragma once

#include <span>
#include <string_view>

// The product's own programs 2, 4 and 90. The control delivers none, and the manual's programs call
// Amada's: these do what the manual says of them (OPT-B.82 to B.84). Stored only when asked for.
namespace rmlcell::optimo {

struct HouseProgram {
  int slot = 0;
  std::string_view name;    // "Z-UP"
  std::string_view source;  // metric RML
};

// Z-UP (2), HOME RETURN (4) and TCP (90), by slot.
std::span<const HouseProgram> HousePrograms();

}  // namespace rmlcell::optimo
