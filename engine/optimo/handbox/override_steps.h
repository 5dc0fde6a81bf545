#pragma once

// The ten steps of the override key. OPT-4.34 to 4.40
namespace rmlcell::optimo {

// The next step above or below; at the ends the same. From a value between two steps it goes to the
// next one.
double NextOverride(double percent, bool up);

// Of the machine's speed, for jog and HOME; between two steps it is the lower one. OPT-4.35
double JogShareOf(double override_percent);

}  // namespace rmlcell::optimo
