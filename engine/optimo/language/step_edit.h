#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/optimo/language/ast.h"

// Steps put into an object and taken out of it, as it is done at the machine, without its source.
// OPT-6.38 to 6.44
namespace rmlcell::optimo {

// A place in a program is the number of an instruction, DECLAREs counted: so that what was taken
// out goes back to exactly where it was.

// The instruction as text with its sequence numbers, each but the last in a line of its own.
std::string InstructionText(const Module& module, std::uint32_t place);

// `text`: one instruction. Sequence numbers stay with the instruction that has them; those in the
// text come back from the one that it is put before. Errors: ObjectCorrupt, for what is no
// instruction or a place that is none; else what the compiler says to the program.
Result<std::string> InsertInstruction(const Module& module, std::uint32_t place,
                                      std::string_view text);

// The sequence numbers of the instruction are those of the next one then. OPT-6.44
// Errors: as those of InsertInstruction.
Result<std::string> RemoveInstruction(const Module& module, std::uint32_t place);

}  // namespace rmlcell::optimo
