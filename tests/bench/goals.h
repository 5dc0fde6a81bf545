#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "tests/bench/cell_server.h"

namespace rmlcell::bench {

// One line of what a bench tells: the median of the rounds, and whether it reaches the goal.
inline bool Row(const std::string& what, const std::vector<double>& values, double goal,
                bool at_least) {
  const double median = Median(values);
  const bool reached = at_least ? median >= goal : median <= goal;
  std::printf("%-64s %8.2f   goal: at %s %.2f%s\n", what.c_str(), median,
              at_least ? "least" : "most", goal, reached ? "" : "   MISSED");
  return reached;
}

}  // namespace rmlcell::bench
