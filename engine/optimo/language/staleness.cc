#include "engine/optimo/language/staleness.h"

#include <utility>

namespace rmlcell::optimo {
namespace {

std::vector<StalePart> StaleParts(int slot, const Executable& executable,
                                  const ObjectLookup& lookup) {
  std::vector<StalePart> parts;
  for (std::size_t m = 0; m < executable.modules.size(); ++m) {
    const LinkedModule& module = executable.modules[m];
    const int object_slot = m == 0 ? slot : module.slot;
    const std::optional<std::string_view> object = lookup(object_slot);
    if (!object) {
      parts.push_back(
          {object_slot, m == 0 ? StaleReason::kObjectMissing : StaleReason::kFunctionMissing});
    } else if (HashObject(*object) != module.object_hash) {
      parts.push_back(
          {object_slot, m == 0 ? StaleReason::kObjectChanged : StaleReason::kFunctionChanged});
    }
  }
  return parts;
}

}  // namespace

std::string_view ReasonText(StaleReason reason) {
  switch (reason) {
    case StaleReason::kObjectChanged:
      return "the program was altered since";
    case StaleReason::kObjectMissing:
      return "the program is not stored any more";
    case StaleReason::kFunctionChanged:
      return "the FUNCTION was altered since";
    case StaleReason::kFunctionMissing:
      return "the FUNCTION is not stored";
    case StaleReason::kDamaged:
      break;
  }
  return "the executable cannot be read";
}

std::vector<StaleExecutable> FindStaleExecutables(
    const std::map<int, std::string_view>& executables, const ObjectLookup& lookup) {
  std::vector<StaleExecutable> stale;
  for (const auto& [slot, bytes] : executables) {
    const Result<Executable> executable = DecodeExecutable(bytes);
    std::vector<StalePart> parts = executable
                                       ? StaleParts(slot, *executable, lookup)
                                       : std::vector<StalePart>{{slot, StaleReason::kDamaged}};
    if (!parts.empty()) stale.push_back({slot, std::move(parts)});
  }
  return stale;
}

}  // namespace rmlcell::optimo
