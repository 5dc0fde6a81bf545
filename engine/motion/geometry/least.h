#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace rmlcell::motion {

// Where golden sections close in on the least of `f` between two places: to 3e-8 of the way between
// them, where the value is flat to 1e-15.
template <class F>
double LeastBySections(F f, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSections = 36;
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
  return std::min(at_left, at_right);
}

// Where a value is low its reciprocal, what is asked of the machine, has a peak. That bends
// downwards, so it stays below its sides drawn on: from the sample `beside` over the one `at`.
inline double DrawnOn(double beside, double at) { return 2.0 / at - 1.0 / beside; }

// At an end there is but one side, and curves may change their bend just there: it is looked at
// also when it is near the least.
inline double MostAskedAtEnd(double inner, double next, double end) {
  constexpr double kNear = 0.95;
  return std::max(DrawnOn(inner, next), 1.0 / (kNear * end));
}

// The least of several positive values over [0, length], to some 1e-9. `values_at(k)` gives them
// all, as an array, at the k-th of `intervals` equal steps, at least three, between which each is
// smooth; `one` gives one of them at any place. A valley of one may be the lowest place of all
// though others are lower at the samples about it, so each value's are looked at by themselves. Who
// only asks whether anything falls below `enough` gets some value above that when nothing does.
template <class ValuesAt, class One>
double LeastOfSampled(ValuesAt values_at, One one, double length, int intervals,
                      double enough = HUGE_VAL) {
  using Values = decltype(values_at(0));
  constexpr double kGain = 1e-12;  // relative; less is rounding
  constexpr int kKept = 64;        // samples kept for the second look; the others are taken again
  const auto place = [&](int k) { return length * k / intervals; };
  std::array<Values, kKept + 1> kept;
  double best = HUGE_VAL;
  for (int k = 0; k <= intervals; ++k) {
    const Values values = values_at(k);
    if (k <= kKept) kept[static_cast<std::size_t>(k)] = values;
    for (const double value : values) best = std::min(best, value);
  }
  const auto sample = [&](int k) {
    return k <= kKept ? kept[static_cast<std::size_t>(k)] : values_at(k);
  };
  const auto look = [&](std::size_t which, double most_asked, int from, int to) {
    if (!(most_asked * std::min(best, enough) > 1.0 + kGain)) return;
    best = std::min(
        best, LeastBySections([&](double x) { return one(which, x); }, place(from), place(to)));
  };
  Values before = sample(0);
  Values here = sample(1);
  for (int k = 1; k < intervals; ++k) {
    const Values after = sample(k + 1);
    for (std::size_t i = 0; i < here.size(); ++i) {
      const double a = before[i], b = here[i], c = after[i];
      if (b <= a && b <= c) {
        look(i, DrawnOn(std::max(a, c), b), k - 1, k + 1);
      } else if (k == 1 && a < b) {
        look(i, MostAskedAtEnd(c, b, a), 0, 1);
      } else if (k == intervals - 1 && c < b) {
        look(i, MostAskedAtEnd(a, b, c), k, intervals);
      }
    }
    before = here;
    here = after;
  }
  return best;
}

// The same of values that are only known together: `f` gives them for a place.
template <class F>
double LeastOfAll(F f, double length, int intervals, double enough = HUGE_VAL) {
  return LeastOfSampled([&](int k) { return f(length * k / intervals); },
                        [&](std::size_t which, double x) { return f(x)[which]; }, length, intervals,
                        enough);
}

// The same of a single value.
template <class F>
double LeastAlong(F f, double length, int intervals, double enough = HUGE_VAL) {
  return LeastOfAll([&](double x) { return std::array{f(x)}; }, length, intervals, enough);
}

}  // namespace rmlcell::motion
