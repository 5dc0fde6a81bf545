// Ramps in a bend against the speeds from place to place: behind their end, beside the most open
// place, and just below the speeds all along. motion.md 5.4
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/motion/corner/bend_speed.h"
#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::motion {
namespace {

constexpr PathLimits kByJerk{.speed = 1e3, .acceleration = 1e9, .jerk = 250.0};

template <class At>
BendSpeeds PlacesOf(At at) {
  BendSpeeds speeds;
  for (std::size_t k = 0; k < speeds.most.size(); ++k) speeds.most[k] = at(k);
  return speeds;
}

// Ramps to 20 mm/s from 10 and slower end between the sixth and the seventh step: the seventh is
// the first that their end is held to.
TEST(BendEndPlaces, TheFirstStepBehindTheEndCounts) {
  constexpr double kHalf_mm = 24.0 * 5.65 / 6.0;
  BendSpeeds speeds =
      PlacesOf([](std::size_t k) { return std::min(10.0 + 5.0 * static_cast<double>(k), 20.0); });
  speeds.most[6] = 20.19;
  EXPECT_NEAR(StretchesOf(speeds, kHalf_mm, kByJerk).open, 20.0, 1e-12);
  speeds.most[7] = 19.9;
  const BendStretches bend = StretchesOf(speeds, kHalf_mm, kByJerk);
  EXPECT_EQ(bend.count, 1U);
  EXPECT_LE(bend.open, 19.9 * (1.0 + 2e-9));
  EXPECT_GE(bend.open, 19.9 - 10.0 / 32.0);
}

// Open between, at the twelfth step: what is tight right beside it, on either side, counts.
TEST(BendEndPlaces, WhatIsBesideTheMostOpenPlaceCounts) {
  const BendSpeeds open = PlacesOf([](std::size_t k) {
    const double up = 10.0 + 8.0 * static_cast<double>(k);
    return std::min({up, 14.0 + 3.0 * static_cast<double>(24 - k), k == 12 ? 20.5 : 20.0});
  });
  const BendStretches wide = StretchesOf(open, 24.0, kByJerk);
  EXPECT_EQ(wide.count, 2U);
  EXPECT_EQ(wide.start, 10.0);
  EXPECT_EQ(wide.middle, 14.0);
  EXPECT_GE(wide.open, 20.0 - 10.0 / 32.0);
  for (const std::size_t beside : {std::size_t{11}, std::size_t{13}}) {
    BendSpeeds dipped = open;
    dipped.most[beside] = 16.0;
    const BendStretches bend = StretchesOf(dipped, 24.0, kByJerk);
    EXPECT_EQ(bend.count, 2U) << beside;
    EXPECT_LE(bend.open, 16.0 * (1.0 + 2e-9)) << beside;
    EXPECT_GE(bend.open, 16.0 - 10.0 / 32.0) << beside;
  }
}

// Up from either end, open at the twelfth step: the ramp from 15 to 20 mm/s has 19.7 after 4 mm,
// where the fifth step of 0.8 mm is; what is less there is in its way.
TEST(BendEndPlaces, StepsBeforeTheMostOpenPlaceLieWhereTheyAre) {
  const SpeedProfile ramp = SpeedProfile::OneRamp(15.0, 20.0, kByJerk);
  ASSERT_GT(ramp.At(ramp.TimeAt(4.0)).speed, 19.7);
  BendSpeeds speeds = PlacesOf([](std::size_t k) {
    const auto step = static_cast<double>(k);
    return std::min({15.0 + 3.0 * step, 10.0 + 8.0 * (24.0 - step), k == 12 ? 20.0 + 1e-8 : 20.0});
  });
  for (const bool backwards : {false, true}) {
    if (backwards) std::ranges::reverse(speeds.most);
    const std::size_t fifth = backwards ? 24 - 5 : 5;
    ASSERT_GE(StretchesOf(speeds, 24.0 * 0.8, kByJerk).open, 20.0);
    BendSpeeds dipped = speeds;
    dipped.most[fifth] = 19.65;
    EXPECT_LT(StretchesOf(dipped, 24.0 * 0.8, kByJerk).open, 20.0) << backwards;
  }
}

// A bend that opens as the ramp from its start does, and a fiftieth of a mm/s more: it fits, as
// between the steps the speeds are straight where they bend downwards, and sag by no more than an
// eighth of what they bend upwards. With a thousandth less than the ramp it does not.
TEST(BendEndPlaces, ARampJustBelowFits) {
  const SpeedProfile ramp = SpeedProfile::OneRamp(15.0, 20.0, kByJerk);
  constexpr double kHalf_mm = 5.5;
  const auto opens = [&](double more) {
    return PlacesOf([&](std::size_t k) {
      const double s = kHalf_mm * static_cast<double>(k) / BendSpeeds::kSteps;
      const double here = s < ramp.end().s ? ramp.At(ramp.TimeAt(s)).speed : 20.0;
      return k == 0 ? 15.0 : std::min(here + more, 20.0);
    });
  };
  const BendStretches fits = StretchesOf(opens(0.02), kHalf_mm, kByJerk);
  EXPECT_EQ(fits.start, 15.0);
  EXPECT_EQ(fits.open, 20.0);
  EXPECT_LT(StretchesOf(opens(-1e-3), kHalf_mm, kByJerk).open, 20.0);
}

// Where the speeds are steady up to a step and rise from there on, they are taken for lower behind
// it, by up to an eighth of the bend: a ramp that is a fiftieth below the straight line is too
// fast.
TEST(BendEndPlaces, BehindAStepWhereTheyBeginToRiseTheySag) {
  const SpeedProfile ramp = SpeedProfile::OneRamp(15.0, 20.0, kByJerk);
  constexpr double kHalf_mm = 5.5;
  BendSpeeds speeds = PlacesOf([&](std::size_t k) {
    const double s = kHalf_mm * static_cast<double>(k) / BendSpeeds::kSteps;
    const double here = s < ramp.end().s ? ramp.At(ramp.TimeAt(s)).speed : 20.0;
    return k == 0 ? 15.0 : std::min(here + 0.02, 20.0);
  });
  ASSERT_EQ(StretchesOf(speeds, kHalf_mm, kByJerk).open, 20.0);
  speeds.most[9] = speeds.most[10];  // the step before is more open now
  EXPECT_LT(StretchesOf(speeds, kHalf_mm, kByJerk).open, 20.0);
}

// From rest a ramp to 20 mm/s is there after 5.657 mm, from 10 mm/s after 6: where the bend is
// tighter about 5.5 mm and open enough for the one, it is too tight for the other.
TEST(BendEndPlaces, SlowerRampsAreLookedAtBehindAStepThatIsOpen) {
  constexpr double kHalf_mm = 24.0 * 5.66 / 22.0;
  BendSpeeds speeds = PlacesOf([](std::size_t k) { return k == 0 ? 10.0 : k == 1 ? 20.19 : 20.0; });
  EXPECT_EQ(StretchesOf(speeds, kHalf_mm, kByJerk).open, 20.0);
  speeds.most[21] = speeds.most[22] = 19.98;
  const SpeedProfile from_start = SpeedProfile::OneRamp(10.0, 20.0, kByJerk);
  ASSERT_LT(from_start.At(from_start.TimeAt(5.66)).speed, 19.97);
  const BendStretches bend = StretchesOf(speeds, kHalf_mm, kByJerk);
  EXPECT_LT(bend.open, 20.0);
  EXPECT_GT(bend.open, 19.5);
}

// The ramp from 10 to 20 mm/s is past the first step of 0.05 mm after a sixteenth of its first
// phase: a dip there alone is the speed all along.
TEST(BendEndPlaces, ADipAtTheFirstStepAloneCounts) {
  const BendSpeeds speeds = PlacesOf([](std::size_t k) {
    return k == 0 ? 10.0 : k == 1 ? 9.9 : 20.0;
  });
  const SpeedProfile ramp = SpeedProfile::OneRamp(10.0, 20.0, kByJerk);
  ASSERT_GT(ramp.At(ramp.phase(0).duration_s / 16.0).s, 2.0 * 0.05);
  const BendStretches bend = StretchesOf(speeds, 24.0 * 0.05, kByJerk);
  EXPECT_EQ(bend.count, 1U);
  EXPECT_EQ(bend.start, 9.9);
  EXPECT_EQ(bend.open, 9.9);
  EXPECT_EQ(bend.middle, 9.9);
}

// Tight right behind its start, open at its half and tight again in its middle: no ramp up keeps
// below, and at the speed of the start the first place would be too fast. So it is the least of
// all.
TEST(BendEndPlaces, ADipIsNotPassedAtTheSpeedBeforeIt) {
  const BendSpeeds speeds = PlacesOf([](std::size_t k) {
    if (k == 0) return 15.0;
    const auto step = static_cast<double>(k);
    return k <= 12 ? 12.0 + 8.0 * (step - 1.0) / 11.0 : 20.0 - 10.0 * (step - 12.0) / 12.0;
  });
  const BendStretches bend = StretchesOf(speeds, 100.0, kByJerk);
  EXPECT_EQ(bend.count, 1U);
  EXPECT_EQ(bend.start, 10.0);
  EXPECT_EQ(bend.open, 10.0);
  EXPECT_EQ(bend.middle, 10.0);
}

// The dip is passed at its own speed, and so is all of that half but no more: from its other end,
// in 5 mm, a ramp leads up to that. Turned round it is the same.
TEST(BendEndPlaces, ADipHoldsUpItsOwnHalfAlone) {
  const auto at = [](std::size_t k) {
    if (k == 0) return 15.0;
    const auto step = static_cast<double>(k);
    return k <= 12 ? 12.0 + 8.0 * (step - 1.0) / 11.0 : 20.0 - 10.0 * (step - 12.0) / 12.0;
  };
  const BendStretches bend = StretchesOf(PlacesOf(at), 10.0, kByJerk);
  EXPECT_EQ(bend.count, 2U);
  EXPECT_EQ(bend.start, 12.0);
  EXPECT_EQ(bend.open, 12.0);
  EXPECT_EQ(bend.middle, 10.0);
  const BendStretches turned =
      StretchesOf(PlacesOf([&at](std::size_t k) { return at(24 - k); }), 10.0, kByJerk);
  EXPECT_EQ(turned.count, 2U);
  EXPECT_EQ(turned.start, 10.0);
  EXPECT_EQ(turned.open, 12.0);
  EXPECT_EQ(turned.middle, 12.0);
}

// A jerk of less than a step: the ramp from the start, 10 + j s^2 / 200 at first, is faster than a
// bend that opens by 0.001 s^2 mm/s, whatever the figures are that it is bounded by.
TEST(BendEndPlaces, AGentleJerkOnLongSteps) {
  const BendSpeeds speeds = PlacesOf(
      [](std::size_t k) { return 10.0 + 0.004 * static_cast<double>(k) * static_cast<double>(k); });
  const PathLimits gentle{.speed = 1e3, .acceleration = 1e9, .jerk = 0.5};
  ASSERT_LT(RampLength(10.0, speeds.most.back(), gentle), 48.0);
  const BendStretches bend = StretchesOf(speeds, 48.0, gentle);
  EXPECT_EQ(bend.start, 10.0);
  EXPECT_LT(bend.open, speeds.most.back() - 0.1);
}

}  // namespace
}  // namespace rmlcell::motion
