#include "engine/optimo/language/staleness.h"

#include <optional>
#include <utility>

namespace rmlcell::optimo {

Detail ReasonText(int slot, StaleReason reason) {
  switch (reason) {
    case StaleReason::kObjectChanged:
      return "it was not made of the object of program " + Told("program", slot) +
             " that is stored now";
    case StaleReason::kObjectMissing:
      return "program " + Told("program", slot) + " is not stored any more";
    case StaleReason::kFunctionChanged:
      return "FUNCTION " + Told("function", slot) + " was altered since it was made";
    case StaleReason::kFunctionDeleted:
      return "FUNCTION " + Told("function", slot) + " is not stored any more";
    case StaleReason::kDamaged:
      break;
  }
  return "it cannot be read";
}

std::vector<StalePart> FindStaleParts(int slot, const Executable& executable,
                                      const StoredObjects& stored) {
  std::vector<StalePart> parts;
  for (std::size_t m = 0; m < executable.modules.size(); ++m) {
    const LinkedModule& module = executable.modules[m];
    const bool main = m == 0;
    const int object_slot = main ? slot : module.slot;
    const std::optional<std::string_view> object = stored.lookup(object_slot);
    if (object) {
      if (HashObject(*object) == module.object_hash) continue;
      parts.push_back(
          {object_slot, main ? StaleReason::kObjectChanged : StaleReason::kFunctionChanged});
    } else if (main) {
      parts.push_back({object_slot, StaleReason::kObjectMissing});
    } else if (stored.deleted.contains(object_slot)) {
      parts.push_back({object_slot, StaleReason::kFunctionDeleted});
    }
  }
  return parts;
}

std::vector<StaleExecutable> FindStaleExecutables(
    const std::map<int, std::string_view>& executables, const StoredObjects& stored) {
  std::vector<StaleExecutable> stale;
  for (const auto& [slot, bytes] : executables) {
    const Result<Executable> executable = DecodeExecutable(bytes);
    std::vector<StalePart> parts = executable
                                       ? FindStaleParts(slot, *executable, stored)
                                       : std::vector<StalePart>{{slot, StaleReason::kDamaged}};
    if (!parts.empty()) stale.push_back({slot, std::move(parts)});
  }
  return stale;
}

}  // namespace rmlcell::optimo
