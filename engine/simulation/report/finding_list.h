#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// The findings of a run, in order of first occurrence. A loop that warns a million times gives one
// finding with a count; findings past machine::kDiagnosticsMax are counted only.
class FindingList {
 public:
  void Add(SimTime at, const Diagnostic& diagnostic);

  const std::vector<Finding>& findings() const { return findings_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  // The same finding: code, program, step, line and column (a stream may be one line). Its detail
  // may name other values each time.
  using Key = std::tuple<ErrorCode, int, int, int, int>;

  std::vector<Finding> findings_;
  std::map<Key, std::size_t> index_;
  std::uint64_t dropped_ = 0;
};

}  // namespace rmlcell::simulation
