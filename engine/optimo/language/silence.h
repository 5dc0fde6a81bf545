#pragma once

#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// Drops the warnings and advice that a comment allows:
//
//   SPEED 90        ; rmlcell: allow 7033        at any line of the statement
//   ; rmlcell: allow 7032 7314        on a line of its own: for the next statement
//   ; rmlcell: allow 7413 in file     for the whole text
//
// Upper and lower case are equal (OPT-1.02). Errors cannot be allowed. Comments that cannot be
// followed, and numbers that silence nothing, are told as advice, which none of them silences.
// Returns what is allowed, for findings that only a run can make.
// Precondition: the findings are in order of place and have their lines.
struct SilenceOptions {
  bool tell_idle = false;      // everything was looked at: what silences nothing is idle
  bool with_contours = false;  // the advice on contours, too (7317 to 7319)
  std::string_view file{};     // name for what is told
};
std::vector<AllowedFinding> Silence(const ParsedProgram& program, const SilenceOptions& options,
                                    std::vector<Diagnostic>& diagnostics);

}  // namespace rmlcell::optimo
