#pragma once

#include <string>

#include "engine/rml1/offline/stream_walk.h"

namespace rmlcell::rml1 {

// What a phrase did, for people: settings with their units, changes of mode and tool state, and
// every motion from where the tool was, in work coordinates (mm from the XY origin and from Z0) and
// mm/s. "absolute coordinates; tool down; down to Z -0.1 at 2 mm/s; cut to X 5 Y 3 at 4 mm/s".
std::string WordsOf(const Phrase& phrase, const Profile& profile);

// One action of the device. `from`: where the tool is, `z0`: of the work, both in device units.
std::string WordsOf(const Action& action, const Point& from, double z0, const Profile& profile);

// What the machine would have taken in place of the first height or coordinate that it refused;
// empty when the phrase has none. "the tool-down height may be from -60.5 to 0 mm".
std::string RangeOfRefused(const Phrase& phrase, const Profile& profile);

// Up to `decimals` decimals without zeros behind: "12.7", "5".
std::string ShortNumber(double value, int decimals = 4);
// Such a number in a finding, where it is an argument.
Detail ToldShort(std::string_view name, double value, std::string_view unit, int decimals = 4);

}  // namespace rmlcell::rml1
