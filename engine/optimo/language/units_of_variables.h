#pragma once

#include "engine/optimo/language/ast.h"

namespace rmlcell::optimo {

// What CONVERT takes the numbers of a variable for (OPT-8.30 to 8.32).
enum class Unit : std::uint8_t { kNone, kLinear, kRotary };

constexpr Unit UnitOf(Variable variable) {
  if (variable.group != VariableGroup::kVr) return Unit::kNone;
  const int n = variable.index;
  if (n <= 24) return n % 5 <= 2 ? Unit::kLinear : Unit::kRotary;
  if ((n >= 80 && n <= 88) || (n >= 92 && n <= 94)) return Unit::kLinear;
  if ((n >= 89 && n <= 91) || (n >= 95 && n <= 97)) return Unit::kRotary;
  return Unit::kNone;
}

}  // namespace rmlcell::optimo
