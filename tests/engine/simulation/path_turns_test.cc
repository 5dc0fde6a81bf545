// Turns of a coordinate so near to an end of the way that it hardly moves there, and bounds of
// peaks that are as good as the peaks.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/path/path_extent.h"
#include "engine/simulation/path/peak_bounds.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

using motion::PathPiece;

constexpr double kNear_rad = 0.0005;

PointSweep NearSwing(double from, double to) {
  const PathPiece joint = PathPiece::Joint({{0, 0, 0}, 0.0, from}, {{0, 0, 0}, 0.0, to});
  return TipSweepOf({joint, motion::GantryHead{.length_mm = 300.0}, 0.0, 1.0});
}

// The tip hangs at Y 300 sin(B), Z -300 cos(B): Z is lowest at B = 0, Y at its ends at a quarter
// turn, and within half a thousandth of a radian it hardly moves there.
TEST(PathTurns, ATurnRightBesideAnEndIsOne) {
  for (const double middle : {0.0, 0.5 * kPi, -0.5 * kPi, kPi}) {
    for (const double far : {0.7, -0.7}) {
      const double near = far > 0.0 ? -kNear_rad : kNear_rad;
      for (const bool turns_late : {false, true}) {
        const double from = middle + (turns_late ? far : near);
        const double to = middle + (turns_late ? near : far);
        const PointSweep tip = NearSwing(from, to);
        const bool is_z = std::abs(std::sin(middle)) < 0.5;
        const CoordinateSweep& turning = is_z ? tip[2] : tip[1];
        EXPECT_EQ(turning.turns, 1) << middle << ' ' << from;
        EXPECT_EQ(turning.first_sign, -turning.last_sign) << middle << ' ' << from;
        // 300 mm less than 300 mm times the cosines of both ends.
        EXPECT_NEAR(turning.travel, 300.0 * (2.0 - std::cos(near) - std::cos(far)), 1e-9);
        EXPECT_EQ((is_z ? tip[1] : tip[2]).turns, 0) << middle << ' ' << from;
      }
    }
  }
}

std::vector<std::reference_wrapper<double>> EveryFigure(MotionPeaks& peaks) {
  std::vector<std::reference_wrapper<double>> figures{peaks.tip_speed, peaks.tip_acceleration,
                                                      peaks.tip_jerk};
  for (int i = 0; i < motion::kAxisCount; ++i) {
    figures.insert(figures.end(),
                   {peaks.axis_speed[i], peaks.axis_acceleration[i], peaks.axis_jerk[i]});
  }
  return figures;
}

MotionPeaks Anything() {
  MotionPeaks known;
  for (double& figure : EveryFigure(known)) figure = std::numeric_limits<double>::infinity();
  return known;
}

// On a long line with a head that turns little, bounds are hardly above what is reached: who knows
// of a fifth more need not look. Of each figure by itself, who knows of a tenth less has to.
TEST(PathTurns, BoundsOfATurningHeadAreOfUse) {
  const auto planned = Planned(PathPiece::Line({{0, 0, 0}, 0.3, 0.9}, {{80, 60, -30}, 0.5, 0.7}),
                               kSlowLimits, 0.0, motion::GantryHead{.length_mm = 300.0});
  const double to_s = planned.speed.duration_s();
  PartShape shape({planned.path, planned.head, 0.0, planned.path.length()});
  MotionPeaks reached = PeaksBetween(planned, true, 0.0, to_s);
  MotionPeaks more;
  const auto peaks = EveryFigure(reached), known = EveryFigure(more);
  for (std::size_t k = 0; k < known.size(); ++k) known[k].get() = 1.2 * peaks[k];
  EXPECT_FALSE(MayExceed(more, planned, shape, true, 0.0, to_s).any());
  for (std::size_t k = 0; k < known.size(); ++k) {
    MotionPeaks less = Anything();
    EveryFigure(less)[k].get() = 0.9 * peaks[k];
    EXPECT_TRUE(MayExceed(less, planned, shape, true, 0.0, to_s).any()) << k;
  }
}

// The speed is highest in the middle phase of a ride: what is below it is open there, and nowhere
// in the first slice of the first phase.
TEST(PathTurns, OpenIsWhereItMayBeAbove) {
  const auto planned = Planned(PathPiece::Line({{0, 0, 0}, 0.3, 0.9}, {{80, 60, -30}, 0.5, 0.7}),
                               kSlowLimits, 0.0, motion::GantryHead{.length_mm = 300.0});
  PartShape shape({planned.path, planned.head, 0.0, planned.path.length()});
  MotionPeaks known = Anything();
  known.tip_speed = 45.0;
  const OpenSlices open = MayExceed(known, planned, shape, true, 0.0, planned.speed.duration_s());
  ASSERT_EQ(planned.speed.phase_count(), 5);  // up in two phases, along, down in two
  for (std::size_t k = 0; k < OpenSlices::kOfPhase; ++k) {
    EXPECT_FALSE(open.IsOpen(0, k)) << k;
    EXPECT_TRUE(open.IsOpen(2, k)) << k;
    EXPECT_FALSE(open.IsOpen(4, k)) << k;
  }
  EXPECT_FALSE(open.IsOpen(1, 0));
  EXPECT_TRUE(open.IsOpen(1, OpenSlices::kOfPhase - 1));
  EXPECT_TRUE(open.IsOpen(3, 0));
  EXPECT_FALSE(open.IsOpen(3, OpenSlices::kOfPhase - 1));
}

// Round a plain corner of 90 degrees no axis is accelerated more than the tip, which is by v^2 K/d
// (motion.md 4.2): who knows of a hundred-thousandth more of each axis need not look.
TEST(PathTurns, NoAxisOfAPlainCornerHasMoreThanTheTip) {
  const double root = std::sqrt(0.5);
  const double rho = 2.0 * std::sqrt(root);
  const double whole = 15.0 / 8.0 - 7.0 * rho / 16.0;
  const double acceleration =
      2500.0 * 0.75 * rho * root / (root * whole * root * whole) / 4.050462937;
  for (const motion::MachinePoint& out :
       {motion::MachinePoint{100, 100, 0}, {100, -100, 0}, {100, 0, 100}}) {
    const auto motions = PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {out});
    for (std::size_t half = 1; half <= 2; ++half) {
      const motion::PlannedMotion& planned = motions.at(half);
      PartShape shape({planned.path, planned.head, 0.0, planned.path.length()});
      MotionPeaks known = Anything();
      for (int i = 0; i < 3; ++i) {
        known.axis_speed[i] = 50.0 * 1.00001;
        known.axis_acceleration[i] = acceleration * 1.00001;
      }
      EXPECT_FALSE(MayExceed(known, planned, shape, true, 0.0, planned.speed.duration_s()).any())
          << half;
    }
  }
}

}  // namespace
}  // namespace rmlcell::simulation
