#include "engine/simulation/report/violation_list.h"

#include "engine/simulation/report/axis_log.h"

namespace rmlcell::simulation {

void ViolationList::Add(const machine::TravelViolation& violation) {
  const std::tuple key{violation.place.program, violation.place.step, violation.axis};
  AxisViolation seen{.place = violation.place,
                     .axis = std::string(AxisName(violation.axis)),
                     .rotary = IsRotaryAxis(violation.axis),
                     .excess = violation.excess,
                     .at_target = violation.at_target,
                     .axes = violation.axes,
                     .tip = violation.tip.tip,
                     .first_at = violation.at,
                     .count = 1};
  const auto [found, is_new] = index_.try_emplace(key, violations_.size());
  if (!is_new) {
    AxisViolation& known = violations_[found->second];
    seen.first_at = known.first_at;
    seen.count = known.count + 1;
    if (seen.excess > known.excess) {
      known = std::move(seen);
    } else {
      known.count = seen.count;
    }
    return;
  }
  if (violations_.size() >= kReportedViolationsMax) {
    index_.erase(found);
    ++dropped_;
    return;
  }
  violations_.push_back(std::move(seen));
}

}  // namespace rmlcell::simulation
