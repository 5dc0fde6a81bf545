#pragma once

#include <string>
#include <string_view>

namespace rmlcell::simulation {

// What every input of the readers of material must hold; returns what is wrong with one, empty when
// nothing is. The first byte chooses:
//   'f'  a file as the target of a small block: a PNG or an STL, read or refused with a reason
//   'c'  the same, the checksums of a PNG put right before, so that what they guard is reached
//   't'  a line with a block and one with a tool, as people write them
std::string TryMaterial(std::string_view bytes);

}  // namespace rmlcell::simulation
