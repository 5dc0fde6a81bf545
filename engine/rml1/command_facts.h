#pragma once

#include <vector>

#include "engine/machine/language_word.h"

namespace rmlcell::rml1 {

// What whoever writes a stream wants to know of each command, in a line; by name.
std::vector<machine::LanguageWord> CommandFacts();

}  // namespace rmlcell::rml1
