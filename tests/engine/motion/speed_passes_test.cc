#include "engine/motion/profile/speed_passes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

struct Span {
  double length;
  PathLimits limits;
  double cap;
};

double Reachable(double from, const Span& span, double cap) {
  if (cap <= from) return cap;
  if (RampLength(from, cap, span.limits) <= span.length) return cap;
  return std::min(cap, Reach(from, span.length, span.limits));
}

// Forward and backward over the whole chain at once. motion.md 5.3
std::vector<double> Whole(const std::vector<Span>& chain) {
  std::vector<double> speed;
  double v = 0.0;
  for (const Span& span : chain) speed.push_back(v = Reachable(v, span, span.cap));
  v = speed.back() = 0.0;
  for (std::size_t k = chain.size() - 1; k > 0; --k) {
    speed[k - 1] = v = Reachable(v, chain[k], speed[k - 1]);
  }
  return speed;
}

std::vector<Span> RandomSpans(std::uint64_t seed, bool jerk) {
  Dice dice(seed);
  std::vector<Span> chain;
  const double longest = dice.Magnitude(0.01, 30.0);
  for (int k = 0; k < 400; ++k) {
    Span span{dice.Magnitude(1e-4, longest),
              {300.0, 2000.0 * dice.Magnitude(0.05, 1.0), 40000.0},
              dice.Chance(0.02) ? 0.0 : dice.Magnitude(1.0, 300.0)};
    if (!jerk) span.limits.jerk = std::numeric_limits<double>::infinity();
    chain.push_back(span);
  }
  chain.back().cap = 0.0;
  return chain;
}

// Batches of any size give the speeds of the whole chain, bit for bit. motion.md 5.5
TEST(SpeedPasses, BatchesGiveTheSpeedsOfTheWholeChain) {
  std::size_t early = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const std::vector<Span> chain = RandomSpans(seed, seed % 3 != 0);
    const std::vector<double> whole = Whole(chain);
    for (const double often : {1.0, 0.2, 0.01}) {
      Dice dice(seed);
      SpeedPasses passes;
      std::size_t taken = 0;
      for (const Span& span : chain) {
        passes.Push(span.length, span.limits, span.cap);
        if (!dice.Chance(often) && &span != &chain.back()) continue;
        for (std::size_t left = passes.Settle(); left > 0; --left) {
          ASSERT_EQ(passes.speed(), whole[taken]) << "seed " << seed << " knot " << taken;
          passes.Pop();
          ++taken;
          early += &span != &chain.back() ? 1 : 0;
        }
      }
      EXPECT_EQ(taken, chain.size());
    }
  }
  EXPECT_GT(early, 100000u);  // of 360000
}

// To accept what is final already changes nothing, now or later: the speeds stay those of the whole
// chain. motion.md 5.5
TEST(SpeedPasses, AcceptingWhatIsFinalChangesNothing) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const std::vector<Span> chain = RandomSpans(seed, seed % 3 != 0);
    const std::vector<double> whole = Whole(chain);
    Dice dice(seed);
    SpeedPasses passes;
    std::size_t taken = 0;
    for (const Span& span : chain) {
      passes.Push(span.length, span.limits, span.cap);
      passes.Accept(passes.final_count());
      if (!dice.Chance(0.2) && &span != &chain.back()) continue;
      passes.Settle();
      passes.Accept(passes.final_count());
      passes.Accept(0);
      for (std::size_t left = dice.Chance(0.5) ? passes.final_count() : 0; left > 0; --left) {
        ASSERT_EQ(passes.speed(), whole[taken]) << "seed " << seed << " knot " << taken;
        passes.Pop();
        ++taken;
      }
    }
    for (; passes.final_count() > 0; ++taken) {
      ASSERT_EQ(passes.speed(), whole[taken]) << "seed " << seed << " knot " << taken;
      passes.Pop();
    }
    EXPECT_EQ(taken, chain.size());
  }
}

// Speeds accepted too early are legal: every span can be run between them, and the chain ends at
// rest.
TEST(SpeedPasses, AcceptedSpeedsAreLegal) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const std::vector<Span> chain = RandomSpans(seed, seed % 3 != 0);
    SpeedPasses passes;
    std::vector<double> speeds;
    for (const Span& span : chain) {
      passes.Push(span.length, span.limits, span.cap);
      if (passes.size() < 8 && &span != &chain.back()) continue;
      passes.Settle();
      if (&span != &chain.back()) passes.Accept(passes.size() / 2);
      while (passes.final_count() > 0) {
        speeds.push_back(passes.speed());
        passes.Pop();
      }
    }
    ASSERT_EQ(speeds.size(), chain.size());
    double from = 0.0;
    for (std::size_t k = 0; k < chain.size(); ++k) {
      EXPECT_LE(speeds[k], chain[k].cap);
      // A few last digits of the speed: see Reach.
      const double change = std::max(std::abs(speeds[k] - from) - 1e-13, 0.0);
      EXPECT_LE(RampLength(std::min(from, speeds[k]), std::min(from, speeds[k]) + change,
                           chain[k].limits),
                chain[k].length * (1 + 1e-6));
      from = speeds[k];
    }
    EXPECT_EQ(from, 0.0);
  }
}

// What is dropped leaves the chain as it was before it: at the speed at which it begins, or at that
// of the last knot that is final, whether that was taken or not.
TEST(SpeedPasses, DroppedKnotsLeaveTheSpeedBeforeThem) {
  const PathLimits limits{300.0, 2000.0, 40000.0};
  const auto push_stop = [&](SpeedPasses& passes, double cap) {
    passes.Push(1e-3, limits, cap);   // next to no way: the speed before it
    passes.Push(500.0, limits, 0.0);  // and room to come to rest
    return passes.Settle();
  };
  SpeedPasses passes;
  passes.BeginAt(30.0);
  passes.Push(1.0, limits, 12.0);
  passes.DropOpen();
  EXPECT_EQ(passes.size(), 0U);
  ASSERT_EQ(push_stop(passes, 30.0), 2U);
  EXPECT_EQ(passes.speed(0), 30.0);
  EXPECT_EQ(passes.speed(1), 0.0);

  for (const bool taken : {false, true}) {
    SpeedPasses chain;
    chain.Push(500.0, limits, 40.0);
    chain.Push(500.0, limits, 200.0);
    chain.Settle();
    ASSERT_EQ(chain.final_count(), 1U);
    EXPECT_EQ(chain.speed(), 40.0);
    if (taken) chain.Pop();
    chain.DropOpen();
    EXPECT_EQ(chain.size(), taken ? 0U : 1U);
    EXPECT_FALSE(chain.ends_at_rest());
    push_stop(chain, 40.0);
    EXPECT_EQ(chain.speed(taken ? 0 : 1), 40.0);
  }
}

// With a limit on jerk the least speed that can be reached is not reached from rest.
TEST(ReachMinimum, IsBelowEveryReach) {
  const PathLimits limits{500.0, 2000.0, 40000.0};
  for (const double length : {1e-3, 0.5, 9.0, 11.0, 100.0}) {
    for (const double high : {0.1, 20.0, 300.0}) {
      for (const double low : {0.0, 0.05, 5.0, 20.0, 80.0}) {
        if (low > high) continue;
        const double least = ReachMinimum(low, high, length, limits);
        double seen = 1e9;
        for (int k = 0; k <= 2000; ++k) {
          const double from = low + (high - low) * std::pow(k / 2000.0, 4);
          seen = std::min(seen, Reach(from, length, limits));
        }
        EXPECT_LE(least, seen * (1 + 1e-12));
        EXPECT_GE(least, seen * (1 - 1e-4));
        if (low == 0.0) {
          EXPECT_GE(least, 0.93 * Reach(0.0, length, limits));
        }
      }
    }
  }
}

// Steps far shorter than the way to brake: what lies further from the end than that way is final,
// so a window holds the braking distance and no more (motion.md 5.5). At 150 mm/s and 2000 mm/s2 it
// is 5.625 mm without a limit on jerk: 563 steps of 0.01 mm. With one, ramps end at each step: a
// step adds at most L^2 j / (4 v^2), whose sum up to 150 mm/s takes 150^3 * 4 / (3 L^2 j) steps.
// OPT-2.16
TEST(SpeedPasses, ShortStepsAreFinalBehindTheBrakingDistance) {
  const auto open_knots = [](const PathLimits& limits, double length, int count) {
    SpeedPasses passes;
    for (int k = 0; k < count; ++k) passes.Push(length, limits, 150.0);
    passes.Settle();
    return count - static_cast<int>(passes.final_count());
  };
  EXPECT_LE(open_knots({150.0, 2000.0}, 0.01, 3000), 565);
  const double steps = 4.0 * 150.0 * 150.0 * 150.0 / (3.0 * 0.64 * 40000.0);  // 175.8
  EXPECT_LE(open_knots({150.0, 2000.0, 40000.0}, 0.8, 3000), 1.1 * steps);
  EXPECT_GE(open_knots({150.0, 2000.0, 40000.0}, 0.8, 3000), 0.5 * steps);
}

}  // namespace
}  // namespace rmlcell::motion
