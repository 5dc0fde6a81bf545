// Bounds of peaks for rides that no planner makes: whatever the profile is, none is below what is
// reached, and where one term of a bound is all of it, it is hardly above.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/path/peak_bounds.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

using motion::PathPiece;
using motion::SpeedProfile;

constexpr double kEndless = std::numeric_limits<double>::infinity();

std::vector<std::reference_wrapper<double>> Eighteen(MotionPeaks& peaks) {
  std::vector<std::reference_wrapper<double>> figures{peaks.tip_speed, peaks.tip_acceleration,
                                                      peaks.tip_jerk};
  for (int i = 0; i < motion::kAxisCount; ++i) {
    figures.insert(figures.end(),
                   {peaks.axis_speed[i], peaks.axis_acceleration[i], peaks.axis_jerk[i]});
  }
  return figures;
}

// A way, the ride along it, and what it reaches.
class AnyRide {
 public:
  AnyRide(const PathPiece& path, const SpeedProfile& speed, const motion::Head& head,
          bool five_axis = true)
      : five_axis_(five_axis) {
    planned_.path = path;
    planned_.speed = speed;
    planned_.head = head;
    reached_ = PeaksBetween(planned_, five_axis, 0.0, speed.duration_s());
  }

  const MotionPeaks& reached() const { return reached_; }

  bool MayExceedThat(const MotionPeaks& known) const {
    PartShape shape({planned_.path, planned_.head, 0.0, planned_.path.length()});
    return MayExceed(known, planned_, shape, five_axis_, 0.0, planned_.speed.duration_s()).any();
  }

  // With all others anything.
  bool MayExceedFigure(std::size_t figure, double share) {
    MotionPeaks known;
    for (double& each : Eighteen(known)) each = kEndless;
    Eighteen(known)[figure].get() = share * Eighteen(reached_)[figure];
    return MayExceedThat(known);
  }

  void ExpectNoBoundBelow(const std::string& what) {
    for (std::size_t k = 0; k < 18; ++k) {
      if (Eighteen(reached_)[k] > 0.0) {
        EXPECT_TRUE(MayExceedFigure(k, 0.999)) << what << ", figure " << k;
      }
    }
  }

 private:
  motion::PlannedMotion planned_;
  bool five_axis_;
  MotionPeaks reached_;
};

// Over a way of this length at one speed; with one acceleration, up and down; with one jerk.
std::vector<SpeedProfile> RidesOver(double length) {
  const motion::PathLimits trapezoid{.speed = 1e6, .acceleration = 2000.0};
  const double fast = std::sqrt(25.0 + 4000.0 * length) * (1.0 - 1e-9);
  const motion::PathLimits jerky{.speed = 1e6, .acceleration = 1e6, .jerk = 40'000.0};
  return {SpeedProfile::Steady(length, 40.0), SpeedProfile::Span(length, 5.0, fast, trapezoid),
          SpeedProfile::Span(length, fast, 5.0, trapezoid),
          SpeedProfile::Span(length, 0.0, 0.0, jerky)};
}

PathPiece CornerHalf(double degrees, std::size_t half, double rise = 0.0) {
  const double angle = degrees * kRadPerDegree;
  const motion::MachinePoint out{100 + 100 * std::cos(angle), 100 * std::sin(angle), rise};
  return PlannedCorner({{0, 0, 0}}, {{100, 0, 0}}, {out}).at(half).path;
}

const motion::Head& LongHead() {
  static const motion::Head head =
      motion::GantryHead{.length_mm = 300.0, .tool = {.x_mm = 12.0, .y_mm = -7.0, .z_mm = 5.0}};
  return head;
}

TEST(AnyRideTest, NoBoundOfAPlainCornerIsBelow) {
  for (const double degrees : {20.0, 60.0, 90.0, 120.0, 160.0}) {
    for (const std::size_t half : {1, 2}) {
      for (const double rise : {0.0, 70.0}) {
        const PathPiece path = CornerHalf(degrees, half, rise);
        for (const SpeedProfile& speed : RidesOver(path.length())) {
          AnyRide ride(path, speed, {});
          ride.ExpectNoBoundBelow(std::to_string(degrees) + " half " + std::to_string(half));
        }
      }
    }
  }
}

// motion.md 2.4: round a circle at one speed the tip and both of its axes are accelerated by v^2/R;
// the jerk is v^3/R^2, and the rotary axis of a mill turns by its share.
TEST(AnyRideTest, BoundsOfACircleAreItsFigures) {
  for (const double turn : {0.0, 3.0}) {
    const PathPiece circle =
        PathPiece::Circle({{2, 0, 0}, 0.5, 0.0}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.5 + turn, 0.0);
    for (const SpeedProfile& speed : RidesOver(circle.length())) {
      AnyRide ride(circle, speed, motion::MillHead{}, false);
      ride.ExpectNoBoundBelow("circle");
    }
    AnyRide steady(circle, SpeedProfile::Steady(circle.length(), 40.0), motion::MillHead{}, false);
    EXPECT_NEAR(steady.reached().tip_acceleration, 800.0, 1e-6);
    const double a = turn / circle.length();
    MotionPeaks known;
    known.tip_speed = known.axis_speed[0] = known.axis_speed[1] = 40.0 * 1.00001;
    known.tip_acceleration = 800.0 * 1.00001;
    known.axis_acceleration[0] = known.axis_acceleration[1] = 800.0 * 1.00001;
    known.tip_jerk = 16'000.0 * 1.00001;
    known.axis_jerk[0] = known.axis_jerk[1] = 16'000.0 * std::sqrt(2.0) * 1.00001;
    known.axis_speed[3] = 40.0 * a * 1.00001;
    // What rounding makes of a steady turn, and no more.
    known.axis_jerk[3] = 1e-6;
    EXPECT_FALSE(steady.MayExceedThat(known)) << turn;
    EXPECT_EQ(steady.MayExceedFigure(12, 0.99), turn > 0.0);
  }
}

// motion.md 4.2: at the middle of a corner its curvature is greatest, whichever the angle is.
// Between both legs the tangent goes from X over to Y, and the normal from Y over to -X.
TEST(AnyRideTest, BoundsOfASteadyCornerAreItsFigures) {
  for (const double degrees : {20.0, 60.0, 90.0, 120.0, 160.0}) {
    for (const std::size_t half : {1, 2}) {
      const PathPiece path = CornerHalf(degrees, half);
      AnyRide ride(path, SpeedProfile::Steady(path.length(), 40.0), {});
      const double sideways = degrees <= 90.0 ? std::sin(degrees * kRadPerDegree) : 1.0;
      MotionPeaks known;
      for (double& each : Eighteen(known)) each = kEndless;
      const double above = 1.0001;
      const double acceleration = ride.reached().tip_acceleration * above;
      known.tip_speed = known.axis_speed[0] = 40.0 * above;
      known.axis_speed[1] = 40.0 * sideways * above;
      known.tip_acceleration = known.axis_acceleration[1] = acceleration;
      known.axis_acceleration[0] = acceleration * sideways;
      known.axis_speed[2] = known.axis_acceleration[2] = known.axis_jerk[2] = 0.0;
      EXPECT_FALSE(ride.MayExceedThat(known)) << degrees;
      EXPECT_FALSE(ride.MayExceedFigure(2, 1.1)) << degrees;
    }
  }
}

std::vector<PathPiece> TurningWays() {
  std::vector<PathPiece> ways{
      PathPiece::Line({{0, 0, 0}, 0.3, 0.9}, {{8, 6, -3}, 0.5, 0.7}),
      PathPiece::Line({{0, 0, 0}, 0.3, 0.4}, {{8, 6, -3}, 0.3, 0.7}),
      PathPiece::Line({{1, 2, 3}, 0.3, 0.9}, {{1, 2, 3}, 0.7, 0.7}),
  };
  for (const auto& corner :
       {PlannedCorner({{0, 0, 0}, 0.0, 0.1}, {{100, 0, 0}, 0.2, 0.1}, {{100, 100, 0}, 0.2, 0.4}),
        PlannedCorner({{0, 0, 0}, 0.1, 0.5}, {{100, 0, 20}, 0.4, 0.2},
                      {{150, 90, 40}, 0.1, 0.7})}) {
    ways.push_back(corner[1].path);
    ways.push_back(corner[2].path);
  }
  return ways;
}

TEST(AnyRideTest, NoBoundOfATurningHeadIsBelow) {
  int way = 0;
  for (const PathPiece& path : TurningWays()) {
    ++way;
    for (const SpeedProfile& speed : RidesOver(path.length())) {
      AnyRide ride(path, speed, LongHead());
      ride.ExpectNoBoundBelow("way " + std::to_string(way));
    }
  }
}

// At one speed bounds are a few per cent above: of speeds, of accelerations, and along a line of
// jerks. A figure that is hardly anything beside others of its kind is as good as those.
TEST(AnyRideTest, BoundsOfASteadyTurnAreOfUse) {
  int way = 0;
  for (const PathPiece& path : TurningWays()) {
    const bool line = ++way <= 3;
    AnyRide ride(path, SpeedProfile::Steady(path.length(), 40.0), LongHead());
    MotionPeaks reached = ride.reached();
    const auto figures = Eighteen(reached);
    for (std::size_t k = 0; k < 18; ++k) {
      const std::size_t kind = k % 3;
      if (kind == 2 && !line) continue;
      double most = 0.0;
      for (std::size_t like = kind; like < (k < 12 ? 12 : 18); like += 3)
        most = std::max<double>(most, figures[like]);
      const double share = kind == 0 ? 1.03 : kind == 2 ? 1.2 : line ? 1.02 : 1.3;
      MotionPeaks known;
      for (double& each : Eighteen(known)) each = kEndless;
      Eighteen(known)[k].get() = std::max(share * figures[k], 0.1 * most) + 1e-3;
      EXPECT_FALSE(ride.MayExceedThat(known)) << way << " figure " << k;
    }
  }
}

}  // namespace
}  // namespace rmlcell::simulation
