#pragma once

#include <string>
#include <string_view>

namespace rmlcell::machine {

// What every file of a profile must hold; returns what is wrong with one, empty when nothing is.
// It is refused with file and line, or read: then each figure has a name and a source, and the
// machines of the family take the profile whole or refuse it, whatever its figures are.
std::string TryProfile(std::string_view bytes);

}  // namespace rmlcell::machine
