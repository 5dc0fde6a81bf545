#pragma once

#include <functional>
#include <string>

#include "engine/machine/family.h"
#include "engine/simulation/run/rehearsal.h"
#include "rmlcell/v1/program.pb.h"

namespace rmlcell::cli {

struct FixOptions {
  bool dry_run = false;  // show the changes as a patch, and write nothing
  bool json = false;     // message FixProgramResponse
  bool strict = false;   // only GOOD is good
};

// How a check finds and judges a source, as the tools for texts need it.
struct FixCheck {
  std::function<machine::Translation(const machine::SourceFile&)> translate;
  // What is left, judged, and the same as a message.
  struct Left {
    simulation::CheckedProgram check{};
    v1::Findings found{};
  };
  std::function<Result<Left>(const machine::Translation&)> judge;
};

// Applies the fixes of findings to one source, in place: the file is written whole or not at all,
// and only when something changed. Prints what was fixed, what is left, and the verdict of that
// with its reasons. The exit code is that of a check of the result; in a dry run 1 when something
// would change, too.
int FixFile(const std::string& file, const std::string& text, const FixCheck& check,
            const FixOptions& options);

// The lines in which two texts differ, as a patch of `file` without context lines.
std::string PatchText(const std::string& file, std::string_view before, std::string_view after);

}  // namespace rmlcell::cli
