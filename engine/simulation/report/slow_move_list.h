#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// Counts a slow move under its cause, and keeps the one with the least share of what it asked for.
void Count(const SlowMove& move, SpeedShortfall& shortfall);

// The steps whose moves were too slow, each with its slowest move, in order of first occurrence.
// Those past kReportedSlowMovesMax are counted only.
class SlowMoveList {
 public:
  void Add(const SlowMove& move);

  const std::vector<SlowMove>& moves() const { return moves_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::vector<SlowMove> moves_;
  std::map<std::pair<int, int>, std::size_t> index_;  // program, step
  std::uint64_t dropped_ = 0;
};

}  // namespace rmlcell::simulation
