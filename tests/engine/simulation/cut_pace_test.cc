#include "engine/simulation/report/cut_pace.h"

#include <gtest/gtest.h>

namespace rmlcell::simulation {
namespace {

using machine::PowerBySpeed;

constexpr machine::Place kFirst{.program = 1, .step = 1};
constexpr machine::Place kSecond{.program = 1, .step = 2};
constexpr machine::Place kThird{.program = 1, .step = 3};

// 64 % at 32 mm/s: 2 % by mm/s. All numbers are exact in binary.
constexpr PowerBySpeed kSteadyPower{.constant_percent = 64.0};
// 2 % by mm/s at any speed below 50 mm/s.
constexpr PowerBySpeed kRampedPower{.percent_per_mm_s = 2.0};

CutFigures Closed(CutPace& pace) {
  CutFigures figures;
  pace.Close(figures);
  return figures;
}

// Below 0.8 of the speed asked for it is slow, at 0.8 it is not.
TEST(CutPace, SlowIsBelowFourFifthsOfTheSpeed) {
  CutPace pace;
  pace.Begin(32.0, kSteadyPower, kFirst);
  pace.Add(1.0, 32.0, 64.0);
  pace.Add(1.0, kSlowSpeed * 32.0, 64.0);
  EXPECT_EQ(pace.slow_mm(), 0.0);
  pace.Add(2.0, 25.0, 64.0);
  EXPECT_EQ(pace.slow_mm(), 50.0);
  pace.Begin(16.0, kSteadyPower, kSecond);
  pace.Add(1.0, 25.0, 64.0);
  EXPECT_EQ(pace.slow_mm(), 50.0);
  EXPECT_EQ(pace.programmed_max_mm_s(), 32.0);
}

// A constant power is hot where it gives more than 1.5 times what it gives at the speed asked for;
// at a higher speed it gives less, and that is no fault of it.
TEST(CutPace, AConstantPowerIsHotAtLowSpeedAndNeverWeak) {
  CutPace pace;
  pace.Begin(32.0, kSteadyPower, kFirst);
  EXPECT_EQ(pace.bounds(), (std::array{kSlowSpeed * 32.0, 64.0 / 3.0, 0.0}));
  pace.Add(1.0, 32.0, 96.0);  // 3 % by mm/s: 1.5 times as much
  pace.Add(1.0, 64.0, 64.0);  // half as much
  EXPECT_EQ(Closed(pace), CutFigures{});
  pace.Begin(32.0, kSteadyPower, kFirst);
  pace.Add(1.0, 32.0, 64.0);
  pace.Begin(32.0, kSteadyPower, kSecond);
  pace.Add(0.5, 32.0, 97.0);
  pace.Begin(32.0, kSteadyPower, kThird);
  pace.Add(0.25, 32.0, 97.0);
  const CutFigures figures = Closed(pace);
  EXPECT_EQ(figures.hot_mm, (Extreme{.value = 24.0, .place = kSecond}));
  EXPECT_EQ(figures.weak_mm, Extreme{});
}

// A ramp asks for the same at every speed: it is weak where it gives less than 0.8 of that, and its
// hot bound is none.
TEST(CutPace, ARampIsWeakWhereItIsAtItsLimit) {
  CutPace pace;
  pace.Begin(64.0, kRampedPower, kFirst);
  EXPECT_EQ(pace.bounds(), (std::array{kSlowSpeed * 64.0, 0.0, 100.0 / (kWeakEnergy * 2.0)}));
  pace.Add(1.0, 32.0, 32.0 * (kWeakEnergy * 2.0));
  EXPECT_EQ(Closed(pace).weak_mm, Extreme{});
  pace.Begin(64.0, kRampedPower, kSecond);
  pace.Add(1.0, 64.0, 100.0);
  EXPECT_EQ(Closed(pace).weak_mm, (Extreme{.value = 64.0, .place = kSecond}));
}

// A constant and a slope: up to 100 % at 40 mm/s, where 2.5 % by mm/s are asked for; more than 1.5
// times of that it gives below 60 / (3.75 - 1) mm/s.
TEST(CutPace, AConstantWithASlopeHasBothBounds) {
  CutPace pace;
  pace.Begin(40.0, {.constant_percent = 60.0, .percent_per_mm_s = 1.0}, kFirst);
  EXPECT_EQ(pace.bounds(), (std::array{kSlowSpeed * 40.0, 60.0 / 2.75, 50.0}));
}

// Without power there is no speed at which it is hot.
TEST(CutPace, WithoutPowerThereIsNoHotSpeed) {
  CutPace pace;
  pace.Begin(32.0, {}, kFirst);
  EXPECT_EQ(pace.bounds(), (std::array{kSlowSpeed * 32.0, 0.0, 0.0}));
}

// The longest of several stretches; a tip that stands in one does not end it.
TEST(CutPace, KeepsTheLongestStretch) {
  CutPace pace;
  const auto hot = [&](const machine::Place& place, double mm) {
    pace.Begin(32.0, kSteadyPower, place);
    pace.Add(mm / 8.0, 8.0, 64.0);
  };
  hot(kFirst, 5.0);
  pace.Add(1.0, 0.0, 0.0);
  pace.Add(0.0, 32.0, 64.0);
  hot(kSecond, 5.0);
  pace.Add(1.0, 32.0, 64.0);
  hot(kThird, 9.0);
  const CutFigures figures = Closed(pace);
  EXPECT_EQ(figures.hot_mm, (Extreme{.value = 10.0, .place = kFirst}));
}

TEST(CutPace, AStandIsNoEndOfAWeakStretch) {
  CutPace pace;
  pace.Begin(64.0, kRampedPower, kFirst);
  pace.Add(1.0, 64.0, 100.0);
  pace.Add(1.0, 0.0, 100.0);
  pace.Add(1.0, 64.0, 100.0);
  EXPECT_EQ(Closed(pace).weak_mm, (Extreme{.value = 128.0, .place = kFirst}));
}

// Where no speed is asked for nothing is slow, hot or weak, and what was so ends; all of that way
// is told together, of several contours, with its first place.
TEST(CutPace, AWayWithoutASpeedIsUncontrolled) {
  CutFigures figures;
  CutPace pace;
  pace.Begin(32.0, kSteadyPower, kFirst);
  pace.Add(1.0, 8.0, 64.0);
  pace.Begin(0.0, kSteadyPower, kSecond);
  EXPECT_EQ(pace.bounds(), (std::array{0.0, 0.0, 0.0}));
  pace.Add(1.0, 4.0, 64.0);
  pace.Begin(0.0, kSteadyPower, kThird);
  pace.Add(1.0, 2.0, 64.0);
  pace.Begin(32.0, kSteadyPower, kThird);
  pace.Add(1.0, 8.0, 64.0);
  EXPECT_EQ(pace.slow_mm(), 16.0);
  pace.Close(figures);
  EXPECT_EQ(figures.hot_mm, (Extreme{.value = 8.0, .place = kFirst}));
  EXPECT_EQ(figures.uncontrolled_mm, (Extreme{.value = 6.0, .place = kSecond}));
  EXPECT_EQ(pace.slow_mm(), 0.0);
  EXPECT_EQ(pace.programmed_max_mm_s(), 0.0);
  pace.Close(figures);
  EXPECT_EQ(figures.uncontrolled_mm, (Extreme{.value = 6.0, .place = kSecond}));
  pace.Begin(0.0, kRampedPower, kThird);
  pace.Add(1.0, 1.0, 2.0);
  pace.Close(figures);
  EXPECT_EQ(figures.uncontrolled_mm, (Extreme{.value = 7.0, .place = kSecond}));
}

// A way without a speed ends a weak stretch, too.
TEST(CutPace, AWayWithoutASpeedEndsAWeakStretch) {
  CutPace pace;
  for (const double programmed : {64.0, 0.0, 64.0}) {
    pace.Begin(programmed, kRampedPower, kFirst);
    pace.Add(1.0, 64.0, 100.0);
  }
  EXPECT_EQ(Closed(pace).weak_mm.value, 64.0);
}

}  // namespace
}  // namespace rmlcell::simulation
