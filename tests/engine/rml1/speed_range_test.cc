// Mills whose highest speeds of cutting, of Z and of travel differ.
#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "engine/rml1/timing.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

struct SpeedRange {
  double xy_fastest, z_fastest, travel;
};

machine::Parameters MillOf(const SpeedRange& speeds, std::string_view profile = "t1") {
  machine::Parameters parameters = ParametersOf(profile);
  EXPECT_TRUE(parameters.Set("XY_SPEED_MAX", speeds.xy_fastest).ok());
  EXPECT_TRUE(parameters.Set("Z_SPEED_MAX", speeds.z_fastest).ok());
  EXPECT_TRUE(parameters.Set("TRAVEL_SPEED", speeds.travel).ok());
  return parameters;
}

// The highest speed of each motion of a stream. All are long enough to reach it.
std::vector<double> PeaksOf(const machine::Parameters& parameters, const std::string& stream,
                            double override_percent = 100.0) {
  machine::RunSetup setup = SetupOf(parameters, "!MC0;" + stream);
  setup.override_percent = override_percent;
  TestRun run(std::move(setup));
  run.AdvanceToEnd();
  std::vector<double> peaks;
  for (std::size_t i = 0; i < run.seen().motions().size(); ++i) {
    peaks.push_back(run.seen().motions()[i].planned.speed.peak_speed());
    EXPECT_NEAR(run.seen().moves().at(i).feed_mm_s, peaks.back(), 1e-9) << i;
  }
  return peaks;
}

void ExpectSpeeds(const std::vector<double>& peaks, const std::vector<double>& expected) {
  ASSERT_EQ(peaks.size(), expected.size());
  for (std::size_t i = 0; i < peaks.size(); ++i) EXPECT_NEAR(peaks[i], expected[i], 1e-9) << i;
}

// RML1-3A.46, RML1-3A.51, RML1-9.44, motion.md section 7: a speed word is limited by what it is
// for; travel is as fast as the profile says, but up and down not faster than Z can. To the height,
// across, down, cut, up; H up and home.
TEST(MillSpeedRange, EveryMotionHasTheSpeedOfItsKind) {
  const std::string stream = "VS100;V100;PU4000,0;PD10000,0;PU;H;";
  const auto speeds = [&](const SpeedRange& range) { return PeaksOf(MillOf(range), stream); };
  ExpectSpeeds(speeds({15, 10, 40}), {10, 40, 10, 15, 10, 10, 40});
  ExpectSpeeds(speeds({60, 25, 20}), {25, 20, 25, 60, 25, 20, 20});
  ExpectSpeeds(speeds({10, 12, 8}), {12, 8, 12, 10, 12, 8, 8});
}

// motion.md section 7: V and !VZ are the speed of the vector, lowered until no axis exceeds its own
// maximum. X and Y can do what they do when they travel, even where they cut slower. At 40 mm/s
// along (3, 4) X has 24 and Z 32.
TEST(MillSpeedRange, ThreeAxesKeepTheMaximumOfEach) {
  const std::string flat = "V40;Z5000,0,2000;";
  const std::string slope = "V40;Z3000,0,-2000;";  // 30 mm aside and 40 down, from the top
  ExpectSpeeds(PeaksOf(MillOf({15, 40, 12}), flat), {15});
  ExpectSpeeds(PeaksOf(MillOf({15, 40, 30}), flat), {30});
  ExpectSpeeds(PeaksOf(MillOf({15, 40, 12}), slope), {25});
  ExpectSpeeds(PeaksOf(MillOf({60, 40, 60}), slope), {40});
  ExpectSpeeds(PeaksOf(MillOf({60, 30, 60}), slope), {30});  // V itself is limited
}

// motion.md section 6 and 7: the override raises a feed as far as the axes can, and lowers it no
// further than to the lowest speed of the machine; travel stays.
TEST(MillSpeedRange, TheOverrideStaysWithinTheMachine) {
  const std::string stream = "VS15;V10;PU4000,0;PD10000,0;";
  ExpectSpeeds(PeaksOf(MillOf({15, 10, 40}), stream, 200.0), {10, 40, 10, 30});
  ExpectSpeeds(PeaksOf(MillOf({15, 12, 12}), stream, 200.0), {12, 12, 12, 15});
  ExpectSpeeds(PeaksOf(MillOf({15, 10, 40}), stream, 50.0), {5, 40, 5, 7.5});
  machine::Parameters coarse = MillOf({15, 10, 40});
  ASSERT_TRUE(coarse.Set("XY_SPEED_MIN", 4.0).ok());
  ASSERT_TRUE(coarse.Set("Z_SPEED_MIN", 3.0).ok());
  ExpectSpeeds(PeaksOf(coarse, stream, 10.0), {3, 40, 3, 3});
}

// motion.md section 7: what the planner and reports are told an axis can do.
TEST(MillSpeedRange, TheLimitsOfTheMachineAreThoseOfItsFastestUse) {
  for (const auto& [range, xy] :
       {std::pair<SpeedRange, double>{{15, 10, 40}, 40}, {{60, 25, 20}, 60}, {{20, 30, 20}, 20}}) {
    const motion::MachineLimits limits = MillLimits(MakeProfile(MillOf(range)).value());
    EXPECT_EQ(limits.tip_speed_mm_s, xy);
    EXPECT_EQ(limits.axes.speed[0], xy);
    EXPECT_EQ(limits.axes.speed[1], xy);
    EXPECT_EQ(limits.axes.speed[2], range.z_fastest);
  }
}

// RML1-3D.29: A in step lowers the common speed, by its speed and its acceleration. 30 degrees in
// 50 mm are 0.6 deg/mm: 6 deg/s allow 10 mm/s, 12 deg/s2 allow 20 mm/s2; 12 deg/s and 600 deg/s2
// leave the 15 mm/s and 200 mm/s2 of the others.
TEST(MillSpeedRange, ARotaryAxisInStepLowersTheCommonSpeed) {
  const auto limits_of = [](double speed, double acceleration) {
    machine::Parameters parameters = MillOf({15, 15, 40}, "t1a");
    EXPECT_TRUE(parameters.Set("A_SPEED", speed).ok());
    EXPECT_TRUE(parameters.Set("A_ACCELERATION", acceleration).ok());
    TestRun run(parameters, "!MC0;V15;!ZE X5000A30;");
    run.AdvanceToEnd();
    const motion::PathLimits& limits = run.seen().motions().back().planned.limits;
    return std::pair(limits.speed, limits.acceleration);
  };
  const auto slow = limits_of(6.0, 12.0);
  EXPECT_NEAR(slow.first, 10.0, 1e-9);
  EXPECT_NEAR(slow.second, 20.0, 1e-9);
  const auto fast = limits_of(12.0, 600.0);
  EXPECT_NEAR(fast.first, 15.0, 1e-9);
  EXPECT_NEAR(fast.second, 200.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::rml1
