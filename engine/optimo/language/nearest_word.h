#pragma once

#include <span>
#include <string>
#include <string_view>

namespace rmlcell::optimo {

// The candidate that a mistyped word most likely means: fewest exchanged, missing, surplus or
// swapped characters, at most a third of the word. Empty when none is near. The first of equals
// wins.
std::string NearestWord(std::string_view word, std::span<const std::string_view> candidates);

}  // namespace rmlcell::optimo
