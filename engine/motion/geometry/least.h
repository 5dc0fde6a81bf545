#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace rmlcell::motion {

// The least value of `f` over [0, length], sampled at `intervals` equal steps; every sample minimum
// that could win is refined by golden sections to some 1e-9. `f` is smooth between samples, or the
// least of such. Who only asks whether it falls below `enough` gets any value above that when it
// does not.
template <class F>
double LeastAlong(F f, double length, int intervals, double enough = HUGE_VAL) {
  constexpr double kCandidate = 0.95;  // a sample above best / 0.95 hides no lower value
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSections = 40;  // 0.618^40 = 4e-9 of the bracket; the value is flat there
  const auto place = [&](int k) { return length * k / intervals; };
  constexpr int kKept = 64;  // samples kept for the second look; the others are taken again
  std::array<double, kKept + 1> kept;
  double best = HUGE_VAL;
  for (int k = 0; k <= intervals; ++k) {
    const double value = f(place(k));
    if (k <= kKept) kept[static_cast<std::size_t>(k)] = value;
    best = std::min(best, value);
  }
  if (best * kCandidate >= enough) return best;
  const auto sample = [&](int k) {
    return k <= kKept ? kept[static_cast<std::size_t>(k)] : f(place(k));
  };
  const double worth_a_look = best / kCandidate;

  double before = HUGE_VAL;
  double here = sample(0);
  for (int k = 0; k <= intervals; ++k) {
    const double after = k < intervals ? sample(k + 1) : HUGE_VAL;
    if (here <= worth_a_look && here <= before && here <= after) {
      double low = place(std::max(k - 1, 0));
      double high = place(std::min(k + 1, intervals));
      double left = high - kGolden * (high - low);
      double right = low + kGolden * (high - low);
      double at_left = f(left);
      double at_right = f(right);
      for (int section = 0; section < kSections; ++section) {
        if (at_left < at_right) {
          high = right;
          right = left;
          at_right = at_left;
          left = high - kGolden * (high - low);
          at_left = f(left);
        } else {
          low = left;
          left = right;
          at_left = at_right;
          right = low + kGolden * (high - low);
          at_right = f(right);
        }
      }
      best = std::min({best, at_left, at_right});
    }
    before = here;
    here = after;
  }
  return best;
}

}  // namespace rmlcell::motion
