#include "engine/simulation/report/finding_list.h"

#include "engine/machine/family.h"

namespace rmlcell::simulation {

void FindingList::Add(SimTime at, const Diagnostic& diagnostic) {
  const Key key = KeyOf(diagnostic);
  if (const auto known = index_.find(key); known != index_.end()) {
    ++findings_[known->second].count;
    return;
  }
  const bool first_error = IsError(diagnostic.severity) && !has_error_;
  has_error_ = has_error_ || first_error;
  if (findings_.size() >= machine::kDiagnosticsMax) {
    if (!first_error) return dropped_.Add(diagnostic, at);
    CountLast();
  }
  index_.emplace(key, findings_.size());
  findings_.push_back({.diagnostic = diagnostic, .first_at = at, .count = 1});
  findings_.back().diagnostic.at = at;
}

FindingList::Key FindingList::KeyOf(const Diagnostic& diagnostic) {
  return {diagnostic.code, diagnostic.program, diagnostic.step, diagnostic.where.line,
          diagnostic.where.column};
}

// The last one told is told by its count alone from now on.
void FindingList::CountLast() {
  const Finding& last = findings_.back();
  UntoldFindings untold;
  untold.Add(last.diagnostic, last.first_at);
  GatheredFindings gathered = untold.kinds().begin()->second;
  gathered.count = last.count;
  dropped_.Add(gathered);
  index_.erase(KeyOf(last.diagnostic));
  findings_.pop_back();
}

}  // namespace rmlcell::simulation
