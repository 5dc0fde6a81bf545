#pragma once

#include <vector>

#include "engine/machine/editing.h"
#include "engine/machine/language_word.h"

namespace rmlcell::optimo {

// What an editor asks about RML sources, behind the interface of machine families.
const machine::Editing& OptimoEditing();

// The reserved words, by name.
std::vector<machine::LanguageWord> OptimoWords();

}  // namespace rmlcell::optimo
