#pragma once

#include <string>
#include <string_view>

namespace rmlcell::optimo {

// What the run of every object, and of every executable, must hold; returns what is wrong, empty
// when nothing is. Bytes that are one are run, by themselves and framed as an object, within a
// budget: it ends, or halts until it is started again and is ended at last. The same run with time
// divided, and taken back to what was saved of it on the way, tells the same.
std::string TryObjectRun(std::string_view bytes);

}  // namespace rmlcell::optimo
