#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/core/untold_findings.h"
#include "engine/machine/tools.h"

// CONVERT: an inch-degree source into the equivalent millimetre-radian source, or back
// (optimo.md 8.2, 8.3). Only numbers that are linear or rotary measurements change; layout and
// comments stay.
namespace rmlcell::optimo {

using machine::ConvertRequest;
using machine::Direction;
using machine::FileNames;

struct Conversion {
  std::string text;
  // 7708 to 7711, and 7004 for a number that would become too large. None of them stops the
  // conversion: the line or the number is copied as it is (OPT-8.53, OPT-8.65).
  std::vector<Diagnostic> diagnostics;
  UntoldFindings diagnostics_dropped{};  // for which the list has no room
};

// The longest statement that CONVERT takes. OPT-8.65
inline constexpr std::uint32_t kConvertTokensMax = 200;

// With `names` a header line is put before the first line (OPT-8.51).
Conversion Convert(std::string_view text, Direction direction,
                   const std::optional<FileNames>& names = {});

// Reads the arguments: filename[.ext] [out] [/i or /m] (OPT-8.54 to 8.67). Nothing when there are
// no arguments: then the parameters are to be explained. An argument that begins with '/' and has
// neither a second '/' nor a '.' is a switch. Errors: 7701, 7702, 7704, 7705, 7707.
Result<std::optional<ConvertRequest>> ReadConvertArguments(std::span<const std::string> arguments);

}  // namespace rmlcell::optimo
