#pragma once

#include <cstddef>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace rmlcell::cli {

// A place, a way or angles in one word: "X,Y" or "X,Y,Z". (A list of the library would take the
// file behind it, too.) Another count of numbers is refused with `text`, which says what to give;
// so is what is no number. `text` and `into` must outlive the verb.
CLI::Option* AddPlace(CLI::App& verb, const char* name, const char* text, std::size_t numbers_min,
                      std::size_t numbers_max, std::vector<double>& into);

}  // namespace rmlcell::cli
