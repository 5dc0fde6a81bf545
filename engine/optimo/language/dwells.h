#pragma once

#include <array>
#include <cstdint>

#include "engine/optimo/language/ast.h"

namespace rmlcell::optimo {

// Whether WORK 1 ON stands still to pierce: WORKDEF 1 says so, with a delay above 0 (OPT-2.50,
// OPT-3.21). Private to the folder.
class Dwells {
 public:
  enum class Kind : std::uint8_t { kNotKnown, kNone, kSome };

  explicit Dwells(const Module& module);

  // Of the WORKDEFs 1,process that the program has; not known when they differ, are computed, or
  // stand in another program.
  Kind Of(std::uint16_t process) const { return kinds_[process]; }

 private:
  std::array<Kind, 10> kinds_{};
};

}  // namespace rmlcell::optimo
