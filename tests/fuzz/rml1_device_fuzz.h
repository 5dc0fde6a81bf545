#pragma once

#include <cstddef>
#include <cstdint>

namespace rmlcell::rml1 {

// One input of the fuzz target: two bytes choose the machine, one where the stream is cut, the rest
// is the stream. Runs it through a device without a clock, and as a stored program in virtual time:
// undisturbed, and with keys and overrides on the way, which must not change where the tool goes.
// Ends the process when a promise of their headers does not hold.
void FuzzDevice(const std::uint8_t* data, std::size_t size);

}  // namespace rmlcell::rml1
