#pragma once

#include <vector>

#include "engine/core/line_table.h"
#include "engine/machine/editing.h"
#include "engine/optimo/editing/program_index.h"

namespace rmlcell::optimo::editing {

// Steps are listed in the outline of a program of at most so many: more is no outline any more.
inline constexpr std::uint32_t kOutlineStepsMax = 2000;

// Declared names, then the part before the first sequence number and a part for each sequence
// number, with their steps inside.
std::vector<machine::OutlinePart> Outline(const ProgramIndex& index);

// Comments in a row, statements over several lines, declarations in a row, WORK ON to its OFF,
// subroutines from their sequence number to RETURN. `lines` are those of the text.
std::vector<machine::FoldedLines> Folds(const ProgramIndex& index, const LineTable& lines);

}  // namespace rmlcell::optimo::editing
