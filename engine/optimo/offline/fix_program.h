#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/machine/family.h"

namespace rmlcell::optimo {

struct Fixing {
  std::string text;  // layout, comments and line ends as they were
  // What was repaired, in the order in which it was; places are those of the text at that moment.
  std::vector<Diagnostic> fixed;
  machine::Translation left;  // what there is to say about `text`
};

// The check that decides: with the parameters of the machine, with advice or without.
using ProgramCheck = std::function<machine::Translation(const machine::SourceFile& file)>;

// Applies the fixes of findings until none is left: repairing one error may bring the next to
// light. Fixing the result again changes nothing. A round that would leave more errors than there
// were is not made. Of an inch source, which the check refuses (7030), the form is repaired.
Fixing FixProgram(const machine::SourceFile& file, const ProgramCheck& check);

// Whether bytes are a text that may be rewritten. Errors: CellBadText for an object, and for bytes
// with a zero among them.
Status CheckIsText(std::string_view name, std::string_view bytes);

}  // namespace rmlcell::optimo
