#pragma once

#include <functional>
#include <string>

#include "engine/machine/family.h"

namespace rmlcell::cli {

struct FixOptions {
  bool dry_run = false;  // show the changes as a patch, and write nothing
  bool json = false;     // message FixProgramResponse
};

// Applies the fixes of findings to one source, in place: the file is written whole or not at all,
// and only when something changed. `check` is what says what is wrong. Prints what was fixed, what
// is left, and a line in the end. The exit code is that of a check of the result; in a dry run 1
// when something would change, too.
int FixFile(const std::string& file, const std::string& text,
            const std::function<machine::Translation(const machine::SourceFile&)>& check,
            const FixOptions& options);

// The lines in which two texts differ, as a patch of `file` without context lines.
std::string PatchText(const std::string& file, std::string_view before, std::string_view after);

}  // namespace rmlcell::cli
