#pragma once

#include <string>
#include <string_view>

#include "engine/machine/machine_note.h"

// Texts of the display, which has one line of 20 characters. OPT-4.01, OPT-B.74
namespace rmlcell::optimo {

std::string OnDisplay(std::string text);  // with blanks behind it; what is too long is cut off
std::string DefaultText(const machine::ShownStep& shown);  // OPT-4.02 to 4.04
// "P=12 S=0007 CALL": what will be recorded there. OPT-B.75
std::string PlacedText(const machine::ShownStep& at, std::string_view name);

}  // namespace rmlcell::optimo
