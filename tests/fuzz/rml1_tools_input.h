#pragma once

#include <string>
#include <string_view>

namespace rmlcell::rml1 {

// What every input of the tools for streams must hold; they return what is wrong with one, empty
// when nothing is.

// The first byte chooses the machine, the rest is a stream. Its phrases lie in it, in order; a
// stream scaled by 1 from whole numbers is well; what is moved or repeated is understood by the
// device; the G-code of it is read again.
std::string TryWalk(std::string_view bytes);
// A program in G-code: what is made of it has no error for the device.
std::string TryGcode(std::string_view bytes);
// A picture: what is read has the pixels that it says, and what is milled has no error.
std::string TryPng(std::string_view bytes);

}  // namespace rmlcell::rml1
