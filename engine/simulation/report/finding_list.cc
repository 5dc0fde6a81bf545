#include "engine/simulation/report/finding_list.h"

#include "engine/machine/family.h"

namespace rmlcell::simulation {

void FindingList::Add(SimTime at, const Diagnostic& diagnostic) {
  const Key key{diagnostic.code, diagnostic.program, diagnostic.step, diagnostic.where.line,
                diagnostic.where.column};
  if (const auto known = index_.find(key); known != index_.end()) {
    ++findings_[known->second].count;
    return;
  }
  if (findings_.size() >= machine::kDiagnosticsMax) {
    dropped_.Add(diagnostic, at);
    return;
  }
  index_.emplace(key, findings_.size());
  findings_.push_back({.diagnostic = diagnostic, .first_at = at, .count = 1});
  findings_.back().diagnostic.at = at;
}

}  // namespace rmlcell::simulation
