#pragma once

#include <map>
#include <string_view>
#include <vector>

#include "engine/optimo/language/linker.h"

// Which executables no longer are what a new link of the stored objects would give, and why
// (OPT-1.12 to 1.15).
namespace rmlcell::optimo {

enum class StaleReason {
  kObjectChanged,    // the program's own object is another one: OPT-1.12 deletes such an executable
  kObjectMissing,    // the program's own object is gone: OPT-1.12
  kFunctionChanged,  // a FUNCTION that it contains is stored with another object: OPT-1.13
  kFunctionMissing,  // a FUNCTION that it contains is not stored: OPT-1.13, OPT-1.15
  kDamaged,          // the executable cannot be read
};
// "the FUNCTION was altered since", for people.
std::string_view ReasonText(StaleReason reason);

struct StalePart {
  int slot = 0;  // 1..99, of the object concerned
  StaleReason reason = StaleReason::kFunctionChanged;

  bool operator==(const StalePart&) const = default;
};
struct StaleExecutable {
  int slot = 0;                  // of the program; the executable lies in slot + 100
  std::vector<StalePart> parts;  // its own object first, then functions in order of first use

  bool operator==(const StaleExecutable&) const = default;
};

// `executables`: bytes by the slot of their program, 1..99. By slot, only those that are stale.
std::vector<StaleExecutable> FindStaleExecutables(
    const std::map<int, std::string_view>& executables, const ObjectLookup& lookup);

}  // namespace rmlcell::optimo
