// How far the ramps in a bend may go up, against all of them one by one. motion.md 5.4
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "engine/motion/corner/bend_speed.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// Speeds at equal steps of a way, and whether ramps keep below them.
class Opening {
 public:
  Opening(std::span<const double> most, double step_mm, double jerk)
      : most_(most), step_mm_(step_mm), limits_{.acceleration = 1e12, .jerk = jerk} {}

  // From 17 speeds up to the first one, or from the quarters of it, at so many places of each of
  // their phases, closer where that begins.
  bool AllFit(double to, int starts = 16, int places = 100, double room = 1e-8) const {
    for (int from = 0; from <= starts; ++from) {
      if (!Fits(most_.front() * from / starts, to, places, room)) return false;
    }
    return true;
  }
  double Best(double high) const {
    if (AllFit(high)) return high;
    double low = most_.front(), above = high;
    for (int k = 0; k < 24; ++k) {
      const double middle = 0.5 * (low + above);
      (AllFit(middle) ? low : above) = middle;
    }
    return low;
  }

 private:
  // Straight between the steps; rounded down where they bend upwards.
  double Limit(double x) const {
    const auto k = static_cast<std::size_t>(x);
    const double t = x - static_cast<double>(k), rise = most_[k + 1] - most_[k];
    const double bend = k == 0 ? 2.0 * rise : rise - most_[k] + most_[k - 1];
    return most_[k] + t * rise - 0.5 * t * (1.0 - t) * std::max(bend, 0.0);
  }
  bool Fits(double from, double to, int places, double room) const {
    const SpeedProfile ramp = SpeedProfile::OneRamp(from, to, limits_);
    double begin = 0.0;
    for (int phase = 0; phase < ramp.phase_count(); ++phase) {
      for (int k = 1; k <= places; ++k) {
        const double share = static_cast<double>(k * k) / (places * places);
        const PathState at = ramp.At(begin + ramp.phase(phase).duration_s * share);
        const double x = at.s / step_mm_;
        if (x >= static_cast<double>(most_.size() - 1)) return true;
        if (at.speed > Limit(x) * (1.0 + room)) return false;
      }
      begin += ramp.phase(phase).duration_s;
    }
    const auto behind = static_cast<std::size_t>(ramp.end().s / step_mm_) + 1;
    return std::ranges::all_of(most_.subspan(behind),
                               [=](double most) { return to <= most * (1.0 + room); });
  }

  std::span<const double> most_;
  double step_mm_;
  PathLimits limits_;
};

// Half of them much as a ramp from the start opens. `count` steps.
std::vector<double> AnyOpening(Dice& dice, std::size_t count, double start, double share) {
  std::vector<double> most{start};
  const double more = dice.Uniform(0.85, 1.2), power = dice.Uniform(0.5, 2.0);
  const bool as_the_ramp = dice.Chance(0.5);
  for (std::size_t k = 1; k <= count; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(count);
    const double ramp = std::max(1.0 + share * x * x, std::cbrt(9.0 * share * x * x));
    most.push_back(start * (as_the_ramp ? std::max(more * ramp, 1.0)
                                        : 1.0 + share * more * std::pow(x, power)));
  }
  const double top = *std::ranges::max_element(most);
  most.back() = std::max(most.back(), top);
  return most;
}

// A jerk that makes `share` of the start, beside it, on the whole way.
double JerkOf(double share, double start, double way_mm) {
  return 2.0 * share * start * start * start / (way_mm * way_mm);
}

// Whatever the scale: mm or metres, fast or slow.
TEST(BendRamps, GoUpAsFarAsAllOfThemFit) {
  Dice dice(1151);
  int all = 0, some = 0;
  for (int round = 0; round < 600; ++round) {
    SCOPED_TRACE(round);
    constexpr std::size_t kSteps = BendSpeeds::kSteps;
    const double start = dice.Magnitude(0.01, 100.0), half_mm = dice.Magnitude(0.1, 1000.0);
    const double share = dice.Magnitude(0.3, 6.0);
    const std::vector<double> most = AnyOpening(dice, kSteps, start, share);
    if (most.back() < 1.02 * start) continue;
    BendSpeeds speeds;
    std::ranges::copy(most, speeds.most.begin());
    const double jerk = JerkOf(share, start, half_mm);
    const BendStretches bend = StretchesOf(speeds, half_mm, {.acceleration = 1e12, .jerk = jerk});
    const Opening opening(most, half_mm / kSteps, jerk);
    const double best = opening.Best(most.back());
    if (best < start * 1.02) continue;
    (best == most.back() ? all : some) += 1;
    EXPECT_EQ(bend.count, 1U);
    if (best > start + (most.back() - start) / 60.0) {
      EXPECT_GE(bend.open, best - (most.back() - start) / 64.0 - 1e-7 * most.back());
      EXPECT_TRUE(opening.AllFit(bend.open, 4, 8, 0.01));
    }
    if (best == most.back()) {
      EXPECT_EQ(bend.open, best);
    }
  }
  EXPECT_GT(all, 50);
  EXPECT_GT(some, 15);
}

// Open between the start and the middle: what the ramps of both sides may do, whose ways are of
// other lengths.
TEST(BendRamps, GoUpAsFarAsBothSidesLet) {
  Dice dice(1153);
  int halves = 0;
  for (int round = 0; round < 400; ++round) {
    SCOPED_TRACE(round);
    constexpr std::size_t kSteps = BendSpeeds::kSteps;
    const auto top = 4 + static_cast<std::size_t>(dice.Uniform(0.0, 17.0));
    const double start = dice.Magnitude(0.1, 100.0), half_mm = dice.Magnitude(0.1, 1000.0);
    const double share = dice.Magnitude(0.3, 6.0);
    std::vector<double> up = AnyOpening(dice, top, start, share);
    std::vector<double> down =
        AnyOpening(dice, kSteps - top, start * dice.Uniform(0.9, 1.1), dice.Magnitude(0.3, 6.0));
    const double high = std::max(up.back(), down.back());
    up.back() = down.back() = high;
    if (high < 1.3 * std::max(up.front(), down.front())) continue;
    BendSpeeds speeds;
    std::ranges::copy(up, speeds.most.begin());
    std::copy(down.rbegin(), down.rend(), speeds.most.begin() + static_cast<std::ptrdiff_t>(top));
    const double step_mm = half_mm / kSteps;
    const double jerk = JerkOf(share, start, step_mm * static_cast<double>(top));
    const Opening from_start(up, step_mm, jerk), from_middle(down, step_mm, jerk);
    const double best = std::min(from_start.Best(high), from_middle.Best(high));
    const double ends = std::max(up.front(), down.front());
    if (best < ends + (high - std::min(up.front(), down.front())) / 50.0) continue;
    ++halves;
    const BendStretches bend = StretchesOf(speeds, half_mm, {.acceleration = 1e12, .jerk = jerk});
    ASSERT_EQ(bend.count, 2U);
    EXPECT_EQ(bend.start, up.front());
    EXPECT_EQ(bend.middle, down.front());
    const double gain = high - std::min(up.front(), down.front());
    EXPECT_GE(bend.open, best - gain / 64.0 - 1e-7 * high);
    EXPECT_TRUE(from_start.AllFit(bend.open, 4, 8, 0.01));
    EXPECT_TRUE(from_middle.AllFit(bend.open, 4, 8, 0.01));
  }
  EXPECT_GT(halves, 100);
}

// Six halvings between 10 and 20: what lies at or below 63/64 of the way, and at or above 1/64 of
// it, is found to that; of jerk 250 the ramp to 20 takes 6 mm, the one to a dip less.
TEST(BendRamps, AreFoundToASixtyFourth) {
  constexpr PathLimits kRamp{.acceleration = 1e9, .jerk = 250.0};
  BendSpeeds speeds;
  for (std::size_t k = 0; k < speeds.most.size(); ++k)
    speeds.most[k] = std::min(10.0 + 5.0 * static_cast<double>(k), 20.0);
  for (const auto& [dip, open] :
       {std::pair{19.85, 19.84375}, {19.8, 19.6875}, {10.2, 10.15625}, {10.32, 10.3125}}) {
    BendSpeeds dipped = speeds;
    dipped.most[15] = dip;
    EXPECT_NEAR(StretchesOf(dipped, 24.0, kRamp).open, open, 1e-12) << dip;
  }
  // A dip behind a first step that is wide open.
  speeds.most[1] = 20.1;
  speeds.most[16] = 15.0;
  EXPECT_NEAR(StretchesOf(speeds, 24.0, {.acceleration = 1e9, .jerk = 40.0}).open, 15.0, 1e-12);
}

// What sags between two steps counts: the limit where it bends upwards, by an eighth of its bend,
// and less of it by what the ramp's own bound sags. Steps of 1 mm.
TEST(RampsFitByBounds, KnowWhatSagsBetweenTheSteps) {
  const auto fit = [](std::vector<double> most, double jerk, double fastest, double to) {
    return RampsFitByBounds(most, 1.0, jerk, fastest, to);
  };
  // From rest the cube is 4.5 * 8 * 4 = 144 after two steps: 5.375 is enough, 5 is not.
  EXPECT_TRUE(fit({10, 10, 47}, 8.0, 4.0, 11.0));
  EXPECT_FALSE(fit({10, 10, 50}, 8.0, 4.0, 11.0));
  // The bend is 37.9, and 38.9 where the first rise is none.
  EXPECT_TRUE(fit({9, 10, 48.9}, 8.0, 4.0, 11.0));
  EXPECT_FALSE(fit({10, 10, 48.9}, 8.0, 4.0, 11.0));
  // A tenth of room for a ramp that hardly grows: a bend of 0.8.
  EXPECT_TRUE(fit({10, 10, 10.79}, 1e-4, 9.9, 11.0));
  EXPECT_FALSE(fit({10, 10, 10.81}, 1e-4, 9.9, 11.0));
  // A ramp from 10 grows by an eighth times the square of the step: what bends no more than that
  // may be as near as that, what bends more may not.
  EXPECT_TRUE(fit({10, 10.125, 10.5, 11.125}, 25.0, 10.0, 11.5));
  EXPECT_FALSE(fit({10, 10.125, 10.5, 11.1875}, 25.0, 10.0, 11.5));
}

}  // namespace
}  // namespace rmlcell::motion
