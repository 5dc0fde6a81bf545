#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "engine/machine/observer.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// The axes that a run takes out of their travel, by program, step and axis, in order of first
// occurrence. What happens past kReportedViolationsMax such places is counted only.
class ViolationList {
 public:
  void Add(const machine::TravelViolation& violation);

  const std::vector<AxisViolation>& violations() const { return violations_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::vector<AxisViolation> violations_;
  std::map<std::tuple<int, int, int>, std::size_t> index_;  // program, step, axis
  std::uint64_t dropped_ = 0;
};

}  // namespace rmlcell::simulation
