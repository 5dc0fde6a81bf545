#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "engine/machine/parameters.h"

namespace rmlcell::rml1 {

// Commands, numbers and separators in an order that often makes sense, with what does not.
std::string RandomStream(std::mt19937_64& dice, std::uint64_t pieces);

machine::Parameters RandomMachine(std::mt19937_64& dice);

}  // namespace rmlcell::rml1
