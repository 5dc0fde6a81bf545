#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/untold_findings.h"
#include "engine/optimo/offline/convert.h"

// RMLCOMP: offsets the moves of a metric source sideways by the beam's radius (optimo.md 8.1).
// Directives are comments: ;$dia=v  ;$rad=v  ;$left  ;$right  ;$none.
namespace rmlcell::optimo {

struct Compensation {
  bool ok = false;   // false: an error; the text is empty and nothing may be written
  std::string text;  // with the header line when names were given
  // 7801 to 7803, 7805 to 7808, 7810, 7305 for an arc that is none, and the errors of the parser
  // stop; 7804, 7809, 7811 and the gouge check 7812 (the path is nearer to an edge than the beam is
  // wide, gouge.h) are warnings; 7812 as advice says which steps were not looked at.
  std::vector<Diagnostic> diagnostics;
  UntoldFindings diagnostics_dropped{};  // for which the list has no room
};

// `inch`: the source is in inches, which is refused (7801); a name with .SI says so, too. The file
// is taken as COORD ABSOL and PATH PTP until it says otherwise (OPT-8.06, OPT-8.21).
Compensation Compensate(std::string_view text, const std::optional<FileNames>& names = {},
                        bool inch = false);

}  // namespace rmlcell::optimo
