#pragma once

#include <string>

#include "engine/optimo/language/ast.h"

namespace rmlcell::optimo::editing {

// What a variable is for: type, who may write it, what the system or the shop's convention keeps in
// it, with rules. Markdown.
std::string VariableFacts(Variable variable);

// The same in a few words, for lists: "tip or column X". Empty when the variable is free.
std::string VariableNote(Variable variable);

}  // namespace rmlcell::optimo::editing
