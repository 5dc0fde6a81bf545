#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// The findings of a run, in order of first occurrence. A loop that warns a million times gives one
// finding with a count; of findings past machine::kDiagnosticsMax each kind is counted. The first
// error is among them whatever a run told before it, in place of the last one.
class FindingList {
 public:
  void Add(SimTime at, const Diagnostic& diagnostic);
  // One of a kind that was told so often that its text is not made any more.
  void Count(SimTime at, const Diagnostic& diagnostic) { dropped_.Add(diagnostic, at); }

  const std::vector<Finding>& findings() const { return findings_; }
  const UntoldFindings& dropped() const { return dropped_; }

 private:
  // The same finding: code, program, step, line and column (a stream may be one line). Its detail
  // may name other values each time.
  using Key = std::tuple<ErrorCode, int, int, int, int>;

  static Key KeyOf(const Diagnostic& diagnostic);
  void CountLast();

  std::vector<Finding> findings_;
  std::map<Key, std::size_t> index_;
  bool has_error_ = false;
  UntoldFindings dropped_;
};

}  // namespace rmlcell::simulation
