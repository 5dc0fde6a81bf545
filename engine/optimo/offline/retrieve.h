#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/optimo/offline/convert.h"

namespace rmlcell::optimo {

// What the transfer of a program from the control leaves on the PC (OPT-8.70).
struct RetrievedProgram {
  std::string source;  // as decompiled; converted, with CONVERT's header, when inches are wanted
  std::string list;    // always metric, OPT-8.73
};

// `inch` names the files of the conversion; nothing: the project is metric. Errors: ObjectCorrupt
// (7034).
Result<RetrievedProgram> RetrieveProgram(std::string_view object,
                                         const std::optional<FileNames>& inch);

}  // namespace rmlcell::optimo
