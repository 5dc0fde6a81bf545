#include "engine/simulation/path/peak_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "engine/core/units.h"
#include "tests/engine/motion/random_chain.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

using motion::PathPiece;

constexpr double kAnything = std::numeric_limits<double>::infinity();

// All eighteen figures of peaks.
std::vector<std::reference_wrapper<double>> FiguresOf(MotionPeaks& peaks) {
  std::vector<std::reference_wrapper<double>> figures{peaks.tip_speed, peaks.tip_acceleration,
                                                      peaks.tip_jerk};
  for (int i = 0; i < motion::kAxisCount; ++i) {
    figures.insert(figures.end(),
                   {peaks.axis_speed[i], peaks.axis_acceleration[i], peaks.axis_jerk[i]});
  }
  return figures;
}

std::vector<motion::PlannedMotion> PlannedChain(std::uint64_t seed, int count,
                                                const motion::ChainOptions& options) {
  motion::Planner planner(motion::StandardMachine());
  std::vector<motion::PlannedMotion> motions;
  const auto take = [&] {
    while (const auto item = planner.Next()) {
      if (const auto* planned = std::get_if<motion::PlannedMotion>(&*item))
        motions.push_back(*planned);
    }
  };
  for (const motion::MoveCommand& move : motion::RandomChain(seed, count, options)) {
    EXPECT_TRUE(planner.Append(move));
    take();
  }
  planner.Stop();
  take();
  return motions;
}

struct Counts {
  int curved = 0;
  int told_at_thrice = 0;  // bounds that are of use
};

// Whatever the peak of a motion is, no bound is below it: with that one figure known to be a
// thousandth lower than it is reached, and all others anything, nobody is told that it stays.
void ExpectNoBoundBelow(const motion::PlannedMotion& planned, bool five_axis, Counts& counts) {
  if (planned.path.kind() == PathPiece::Kind::kLine && !(five_axis && Turns(planned.path))) return;
  const double to_s = planned.speed.duration_s();
  MotionPeaks peaks = PeaksBetween(planned, five_axis, 0.0, to_s);
  PartShape shape({planned.path, planned.head, 0.0, planned.path.length()});
  const auto reached = FiguresOf(peaks);
  MotionPeaks known;
  const auto figures = FiguresOf(known);
  for (std::size_t k = 0; k < figures.size(); ++k) {
    if (!(reached[k] > 0.0)) continue;
    for (double& figure : figures) figure = kAnything;
    figures[k].get() = reached[k] * 0.999;
    EXPECT_TRUE(MayExceed(known, planned, shape, five_axis, 0.0, to_s).any()) << "figure " << k;
  }
  for (std::size_t k = 0; k < figures.size(); ++k) {
    // Others of its kind, too, or an axis that hardly moves would decide alone.
    double most = 0.0;
    for (std::size_t like = k % 3; like < figures.size(); like += 3)
      most = std::max<double>(most, reached[like]);
    figures[k].get() = std::max(3.0 * reached[k], most);
  }
  ++counts.curved;
  counts.told_at_thrice += MayExceed(known, planned, shape, five_axis, 0.0, to_s).any() ? 0 : 1;
}

TEST(PeakBounds, AreNeverBelowThePeak) {
  for (const bool head : {false, true}) {
    Counts counts;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const motion::ChainOptions options{
          .head = head, .all_fly = true, .shortest_mm = 0.05, .longest_mm = 5.0};
      for (const auto& planned : PlannedChain(seed, 60, options)) {
        ExpectNoBoundBelow(planned, true, counts);
        if (!Turns(planned.path)) ExpectNoBoundBelow(planned, false, counts);
      }
    }
    EXPECT_GT(counts.curved, 1000);
    EXPECT_GT(counts.told_at_thrice, counts.curved / 8) << "head " << head;
  }
}

// Round the plain corner of 90 degrees at 50 mm/s (CurveOfACorner of motion_peaks_test.cc) the tip
// is accelerated by what its curvature asks for; who knows of a hundred-thousandth more need not
// look.
TEST(PeakBounds, OfAPlainCornerIsItsCurvature) {
  const auto motions = PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {{100, 100, 0}});
  const motion::PlannedMotion& half = motions.at(1);
  const double to_s = half.speed.duration_s();
  PartShape shape({half.path, half.head, 0.0, half.path.length()});
  MotionPeaks known;
  for (double& figure : FiguresOf(known)) figure = kAnything;
  const double root = std::sqrt(0.5);
  const double rho = 2.0 * std::sqrt(root);
  const double whole = 15.0 / 8.0 - 7.0 * rho / 16.0;
  const double acceleration =
      2500.0 * 0.75 * rho * root / (root * whole * root * whole) / 4.050462937;
  known.tip_acceleration = acceleration * 1.00001;
  EXPECT_FALSE(MayExceed(known, half, shape, true, 0.0, to_s).any());
  // Z stands: there 0 is enough.
  known.axis_speed[2] = known.axis_acceleration[2] = known.axis_jerk[2] = 0.0;
  EXPECT_FALSE(MayExceed(known, half, shape, true, 0.0, to_s).any());
  known.tip_acceleration = acceleration * 0.99999;
  EXPECT_TRUE(MayExceed(known, half, shape, true, 0.0, to_s).any());
}

// What is told beyond what is known raises it to the same figures as all of it.
TEST(PeakBounds, WhatLiesBeyondIsWhatIsMissing) {
  MotionPeaks all;
  MotionPeaks beyond;
  for (const auto& planned : PlannedChain(3, 200, {.all_fly = true, .longest_mm = 10.0})) {
    const double to_s = planned.speed.duration_s();
    all.Raise(PeaksBetween(planned, true, 0.0, to_s));
    PartShape shape({planned.path, planned.head, 0.0, planned.path.length()});
    beyond.Raise(PeaksBeyond(beyond, planned, shape, true, 0.0, to_s));
  }
  const auto expected = FiguresOf(all);
  const auto figures = FiguresOf(beyond);
  for (std::size_t k = 0; k < figures.size(); ++k) EXPECT_EQ(figures[k].get(), expected[k].get());
}

// A corner that turns by less than two millionths, or turns back but for as much, has no plane that
// is known well enough: whatever is known already, it is looked at.
TEST(PeakBounds, OfHardlyACornerAreUnknown) {
  MotionPeaks known;
  for (double& figure : FiguresOf(known)) figure = kAnything;
  const auto may_exceed = [&](double turn_rad) {
    motion::PlainCorner corner;
    corner.tangent_in = {1, 0, 0};
    corner.tangent_out = {std::cos(turn_rad), std::sin(turn_rad), 0};
    corner.cut_mm = 1.0;
    motion::PlannedMotion planned;
    planned.path.AssignCorner(corner, 0.0, 1.0, corner.Start(), corner.at);
    planned.speed = motion::SpeedProfile::Steady(1.0, 10.0);
    PartShape shape({planned.path, planned.head, 0.0, 1.0});
    return MayExceed(known, planned, shape, true, 0.0, planned.speed.duration_s()).any();
  };
  EXPECT_FALSE(may_exceed(3e-6));
  EXPECT_TRUE(may_exceed(1e-6));
  EXPECT_FALSE(may_exceed(kPi - 3e-6));
  EXPECT_TRUE(may_exceed(kPi - 1e-6));
}

}  // namespace
}  // namespace rmlcell::simulation
