#pragma once

#include <algorithm>
#include <ctime>
#include <vector>

namespace rmlcell::bench {

// Of the processor: the machine is shared.
template <class Work>
double Seconds(Work work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

inline double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace rmlcell::bench
