#pragma once

#include <optional>

#include "engine/core/line_table.h"
#include "engine/machine/editing.h"
#include "engine/optimo/editing/program_index.h"

namespace rmlcell::optimo::editing {

// What stands at `offset`: a word and how it is written, a name and its value, where a sequence
// number is, what a called program is, what a variable is for, what a process does.
std::optional<machine::HoverNote> Hover(const ProgramIndex& index, const LineTable& lines,
                                        std::size_t offset, const machine::Surroundings& around);

}  // namespace rmlcell::optimo::editing
