#pragma once

#include <string>

#include "engine/optimo/language/ast.h"

namespace rmlcell::optimo {

// The list file: the source as decompiled, one line each with line number (five columns), a blank,
// step number (five columns, 0 where there is no step), two blanks, the text. OPT-8.73
std::string List(const Module& module);

}  // namespace rmlcell::optimo
