#include "engine/core/keep_finding.h"

#include <algorithm>
#include <utility>

namespace rmlcell {
namespace {

// Of the untold first, which are few: a list that lacks room is looked through for two errors only.
bool HasError(const std::vector<Diagnostic>& told, const UntoldFindings& untold) {
  return std::ranges::any_of(untold.kinds(),
                             [](const auto& kind) { return IsError(kind.second.severity); }) ||
         HasErrors(told);
}

}  // namespace

void KeepFinding(Diagnostic finding, std::size_t most, std::vector<Diagnostic>& told,
                 UntoldFindings& untold) {
  if (told.size() >= most) {
    if (told.empty() || !IsError(finding.severity) || HasError(told, untold))
      return untold.Add(finding);
    untold.Add(told.back());
    told.pop_back();
  }
  told.push_back(std::move(finding));
}

}  // namespace rmlcell
