#pragma once

#include <string>
#include <string_view>

namespace rmlcell::machine {

// What a machine that lives must hold, whatever is done to it over its time; both return what is
// wrong, empty when nothing is. The same acts with time divided otherwise give the same answers,
// the same telling and the same bytes of Save. What it saves is what it reads, and a machine made
// of what it saved while it stood goes on as it does itself. A state that moves no axis has no
// speed, no beam and the same place later; into one that does comes nobody by time or by an act
// that begins nothing (LIVE-2.04, 2.05).
//
// The first byte chooses what the machine begins with, the second one at which act it is made
// again, the third one how time is divided.

// Keys of the handbox of an Optimo, two bytes each: which, and how with the wait behind it.
std::string TryKeys(std::string_view bytes);

// Inputs of every kind, and keys among them, on a machine of either family: three bytes each, which
// kind, with what, and the wait behind it.
std::string TryInputs(std::string_view bytes);

}  // namespace rmlcell::machine
