#pragma once

#include <map>
#include <set>
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
  kFunctionDeleted,  // a FUNCTION that it contains was deleted, which counts as altering: OPT-1.13
  kDamaged,          // the executable cannot be read
};
// "FUNCTION 44 was altered since the executable was made", for people.
Detail ReasonText(int slot, StaleReason reason);

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

// The program memory as it is now.
struct StoredObjects {
  ObjectLookup lookup;
  // Slots that held an object once and are empty now. A FUNCTION that was never stored makes
  // nothing stale: its executable was linked off-line and brought (OPT-1.15).
  std::set<int> deleted{};
};

// Empty: it is what a new link would give.
std::vector<StalePart> FindStaleParts(int slot, const Executable& executable,
                                      const StoredObjects& stored);

// `executables`: bytes by the slot of their program, 1..99. By slot, only those that are stale.
std::vector<StaleExecutable> FindStaleExecutables(
    const std::map<int, std::string_view>& executables, const StoredObjects& stored);

}  // namespace rmlcell::optimo
