#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/tools.h"

namespace rmlcell::optimo {

using machine::ProgramCheck;
using machine::RepairedText;

// Applies the fixes of findings until none is left: repairing one error may bring the next to
// light. Fixing the result again changes nothing. A round that would leave more errors than there
// were is not made. Of an inch source, which the check refuses (7030), the form is repaired.
RepairedText FixProgram(const machine::SourceFile& file, const ProgramCheck& check);

// Whether bytes are a text that may be rewritten. Errors: CellBadText for an object, and for bytes
// with a zero among them.
Status CheckIsText(std::string_view name, std::string_view bytes);

}  // namespace rmlcell::optimo
