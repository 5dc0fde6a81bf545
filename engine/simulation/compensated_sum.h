#pragma once

#include <cmath>

namespace rmlcell::simulation {

// A sum that does not lose the small ones: Neumaier's variant of Kahan summation. A million moves
// of a micrometre add up to one metre, to the last digit.
class CompensatedSum {
 public:
  void Add(double value) {
    const double sum = sum_ + value;
    lost_ += std::abs(sum_) >= std::abs(value) ? (sum_ - sum) + value : (value - sum) + sum_;
    sum_ = sum;
  }
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0.0;
  double lost_ = 0.0;
};

}  // namespace rmlcell::simulation
