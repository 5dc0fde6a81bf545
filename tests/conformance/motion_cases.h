#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"

// The reference cases of motion.md section 12: how their table is read and each case computed.
namespace rmlcell::motion {

struct ReferenceCase {
  std::string name;   // "K01"
  std::string group;  // "kin"
  std::string text;
  std::string input;   // JSON
  std::string output;  // JSON
};

// CSV with the columns case, group, text, input, output and a line of headings.
Result<std::vector<ReferenceCase>> ReadReferenceCases(std::string_view csv);

struct ReferenceVerdict {
  enum class Kind { kAgrees, kDiffers, kUnreadable };
  Kind kind = Kind::kAgrees;
  std::vector<std::string> differences;  // "v1: 49.9, reference 50"
};

// Agreement: |x - reference| <= 1e-6 max(1, |reference|), and T between T_min and T_max where these
// are given.
ReferenceVerdict Judge(const ReferenceCase& reference);

}  // namespace rmlcell::motion
