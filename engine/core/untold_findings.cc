#include "engine/core/untold_findings.h"

#include <algorithm>
#include <tuple>

namespace rmlcell {
namespace {

bool Before(const Diagnostic& a, const Diagnostic& b) {
  const auto key = [](const Diagnostic& one) {
    return std::tuple(one.program, one.where.line, one.where.byte_offset, one.where.column,
                      one.step);
  };
  return key(a) < key(b);
}

// Its texts are left out: a million of these are compared, and two are kept.
void SetPlace(const Diagnostic& finding, Diagnostic& place) {
  place.code = finding.code;
  place.severity = finding.severity;
  place.file = finding.file;
  place.where = finding.where;
  place.program = finding.program;
  place.step = finding.step;
}

}  // namespace

void UntoldFindings::Add(const Diagnostic& finding, SimTime at) {
  GatheredFindings& kind = kinds_[finding.code];
  const bool is_new = kind.count == 0;
  if (is_new) {
    kind.code = finding.code;
    kind.judged = finding.judged;
  }
  if (is_new || (!IsError(kind.severity) && IsError(finding.severity)))
    kind.severity = finding.severity;
  if (is_new || Before(finding, kind.first)) SetPlace(finding, kind.first);
  if (is_new || !Before(finding, kind.last)) SetPlace(finding, kind.last);
  kind.last_at = std::max(kind.last_at, at);
  ++kind.count;
  ++count_;
}

void UntoldFindings::Add(const GatheredFindings& others) {
  if (others.count == 0) return;
  count_ += others.count;
  const auto [at, is_new] = kinds_.try_emplace(others.code, others);
  if (is_new) return;
  GatheredFindings& kind = at->second;
  if (!IsError(kind.severity) && IsError(others.severity)) kind.severity = others.severity;
  if (Before(others.first, kind.first)) kind.first = others.first;
  if (Before(kind.last, others.last)) kind.last = others.last;
  kind.last_at = std::max(kind.last_at, others.last_at);
  kind.count += others.count;
}

void UntoldFindings::Add(const UntoldFindings& others) {
  for (const auto& [code, kind] : others.kinds_) Add(kind);
}

}  // namespace rmlcell
