#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

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

// The most of `f`, smooth and with one peak between the outer two of three places of which the
// middle one has the highest value: by parabolas through the three best places, whose last three
// are so near each other that what is left is below rounding. Where that does not come about, by
// sections.
template <class F>
double MostByParabolas(F f, std::array<double, 3> x, std::array<double, 3> y) {
  constexpr int kSteps = 16;
  const double width = x[2] - x[0];
  const double tight = 5e-3 * width;
  double left = x[0], right = x[2];
  // The best place, and two others.
  double best = x[1], second = x[0], third = x[2];
  double most = y[1], at_second = y[0], at_third = y[2];
  for (int step = 0; step < kSteps; ++step) {
    const double r = (best - second) * (most - at_third);
    const double q = (best - third) * (most - at_second);
    const bool near = std::max(std::abs(best - second), std::abs(best - third)) <= 2.0 * tight;
    double next = best - 0.5 * ((best - third) * q - (best - second) * r) / (q - r);
    if (!(next > left && next < right)) {
      if (most == at_second && most == at_third && near) return most;  // flat to the last digits
      next = 0.5 * (best + (right - best > best - left ? right : left));
    } else if (std::abs(next - best) < 0.5 * tight) {
      if (near && std::abs(next - best) < 1e-6 * width) return most;
      // Not so near that the values differ by rounding alone.
      if (!near) next = best + (right - best > best - left ? tight : -tight);
    }
    const double value = f(next);
    if (near && std::abs(next - best) <= 2.0 * tight) return std::max(most, value);
    if (value > most) {
      (next > best ? left : right) = best;
      third = std::exchange(second, std::exchange(best, next));
      at_third = std::exchange(at_second, std::exchange(most, value));
    } else {
      (next > best ? right : left) = next;
      if (value >= at_second || second == best) {
        third = std::exchange(second, next);
        at_third = std::exchange(at_second, value);
      } else {
        third = next;
        at_third = value;
      }
    }
  }
  return std::max(most, -LeastBySections([&](double at) { return -f(at); }, left, right));
}

// The most of `f` between an end, at which it is higher than at the place `inner`, and that place:
// at the end itself, unless it rises from there. By parabolas or, right beside the end, by
// sections.
template <class F>
double MostNearEnd(F f, double end, double at_end, double inner, double at_inner) {
  const double middle = 0.5 * (end + inner);
  const double at_middle = f(middle);
  if (at_middle > at_end) {
    const bool up = end < inner;
    return up ? MostByParabolas(f, {end, middle, inner}, {at_end, at_middle, at_inner})
              : MostByParabolas(f, {inner, middle, end}, {at_inner, at_middle, at_end});
  }
  // So near that a peak before it is no higher than the end by 1e-9, and so far that a slope shows
  // above rounding.
  constexpr double kBeside = 1e-5;
  if (!(f(end + kBeside * (inner - end)) > at_end)) return at_end;
  return std::max(at_end, -LeastBySections([&](double x) { return -f(x); }, std::min(end, middle),
                                           std::max(end, middle)));
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

// How the least between samples is closed in on: to the last digits, or to some 1e-10 in a fifth of
// the places.
enum class Closing { kSections, kParabolas };

// The least of several positive values over [0, length], to some 1e-9. `values_at(k)` gives them
// all, as an array, at the k-th of `intervals` equal steps, at least three, between which each is
// smooth; `one` gives one of them at any place. A valley of one may be the lowest place of all
// though others are lower at the samples about it, so each value's are looked at by themselves. Who
// only asks whether anything falls below `enough` gets some value above that when nothing does.
template <Closing kClosing = Closing::kSections, class ValuesAt, class One>
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
  const auto matters = [&](double most_asked) {
    return most_asked * std::min(best, enough) > 1.0 + kGain;
  };
  const auto sections = [&](std::size_t which, int from, int to) {
    best = std::min(
        best, LeastBySections([&](double x) { return one(which, x); }, place(from), place(to)));
  };
  const auto less = [&](std::size_t which) {
    return [&one, which](double x) { return -one(which, x); };
  };
  Values before = sample(0);
  Values here = sample(1);
  for (int k = 1; k < intervals; ++k) {
    const Values after = sample(k + 1);
    for (std::size_t i = 0; i < here.size(); ++i) {
      const double a = before[i], b = here[i], c = after[i];
      if (b <= a && b <= c) {
        if (!matters(DrawnOn(std::max(a, c), b))) continue;
        if constexpr (kClosing == Closing::kSections) {
          sections(i, k - 1, k + 1);
        } else {
          best = std::min(best, -MostByParabolas(less(i), {place(k - 1), place(k), place(k + 1)},
                                                 {-a, -b, -c}));
        }
      } else if ((k == 1 && a < b) || (k == intervals - 1 && c < b)) {
        const bool first = k == 1 && a < b;
        if (!matters(first ? MostAskedAtEnd(c, b, a) : MostAskedAtEnd(a, b, c))) continue;
        const int end = first ? 0 : intervals;
        if constexpr (kClosing == Closing::kSections) {
          sections(i, std::min(k, end), std::max(k, end));
        } else {
          best = std::min(best, -MostNearEnd(less(i), place(end), first ? -a : -c, place(k), -b));
        }
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
