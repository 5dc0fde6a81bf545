#include "engine/simulation/report/time_ledger.h"

#include <algorithm>
#include <utility>

namespace rmlcell::simulation {

void TimeLedger::Open(const Gap& gap) {
  if (gap.end <= gap.start) return;
  if (open_ > 0) {
    Gap& last = gaps_[open_ - 1];
    if (last.end == gap.start && last.beam_on == gap.beam_on && last.halted == gap.halted &&
        last.place == gap.place) {
      last.end = gap.end;
      return;
    }
  }
  if (open_ == kGapsMax) {
    count_(gaps_.front());
    std::move(gaps_.begin() + 1, gaps_.end(), gaps_.begin());
    --open_;
  }
  gaps_[open_++] = gap;
}

void TimeLedger::Leave(SimTime until, const Gap& now) {
  if (until <= reached_) return;
  Gap gap = now;
  gap.start = reached_;
  gap.end = until;
  Open(gap);
  reached_ = until;
}

SimTime TimeLedger::Claim(SimTime start, SimTime end, const Gap& now) {
  Leave(start, now);
  SimTime claimed = std::max(SimTime::zero(), end - std::max(start, reached_));
  const std::array<Gap, kGapsMax> before = gaps_;
  const std::size_t count = std::exchange(open_, 0);
  for (std::size_t k = 0; k < count; ++k) {
    Gap left = before[k];
    Gap right = before[k];
    left.end = std::clamp(start, left.start, left.end);
    right.start = std::clamp(end, left.end, right.end);
    claimed += before[k].length() - left.length() - right.length();
    Open(left);
    Open(right);
  }
  reached_ = std::max(reached_, end);
  return claimed;
}

void TimeLedger::Close() {
  for (std::size_t k = 0; k < open_; ++k) count_(gaps_[k]);
  open_ = 0;
}

}  // namespace rmlcell::simulation
