#pragma once

#include <cstdint>
#include <optional>

#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

enum class CutSide { kNone, kLeft, kRight };

// A line such as ";$rad=0.254" or "15 ;$cleft" (OPT-8.02 to 8.05). Private to the folder.
struct CutterDirective {
  enum class Kind { kDiameter, kRadius, kSide, kUnknown };
  Kind kind = Kind::kUnknown;
  CutSide side = CutSide::kNone;   // kSide
  std::optional<double> amount{};  // kDiameter, kRadius; nothing when it is no number
  std::uint32_t amount_begin = 0;  // where its digits stand in the text
  std::uint32_t amount_end = 0;
};

// Nothing when the comment is none: directives begin with ";$" and have their line to themselves,
// but for a sequence number. Behind an instruction it is a comment like others.
std::optional<CutterDirective> ReadCutterDirective(const ParsedProgram& program,
                                                   const Comment& comment);

}  // namespace rmlcell::optimo
