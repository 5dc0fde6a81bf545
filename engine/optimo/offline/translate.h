#pragma once

#include "engine/machine/family.h"
#include "engine/optimo/language/compiler.h"
#include "engine/optimo/offline/contour_advice.h"

namespace rmlcell::optimo {

// Unit and form of a file by its name: .S .CMP metric source, .SI inch source, .O object
// (OPT-8.72). Anything else is metric source, unless its bytes begin like an object.
using machine::FileForm;
FileForm FormOfFile(std::string_view name, std::string_view bytes);

// What the control would store: a source is checked and compiled, an object is checked and taken as
// it is. An inch source is refused with 7030 (OPT-2.04), an empty file with CellEmptyProgram.
// Figures: "steps", "source_bytes", "object_bytes", "sequence_numbers", "names".
// Advice on path and modes of the program is that for `contour_machine`.
machine::Translation TranslateOptimo(
    const machine::SourceFile& file, const machine::CheckOptions& options,
    std::uint32_t object_limit = kObjectLimitStandard,
    const ContourMachine& contour_machine = ContourMachine::Standard());

// 7413 for the program numbers that are reserved for Amada (OPT-10.17), unless the text is the
// product's own program of this number.
std::vector<Diagnostic> CheckProgramNumber(int slot, std::string_view text);

}  // namespace rmlcell::optimo
