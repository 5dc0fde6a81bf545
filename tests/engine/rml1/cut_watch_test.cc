// What the watch tells of ways that are handed to it one by one. Heights in mm, the surface of the
// work at 0; Z travels at 10 mm/s at most, so that a speed word of 8 mm/s is as fast as a lift.
#include "engine/rml1/cut_watch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

constexpr double kFast = 8.0;  // of what Z travels four fifths: no less counts as fast
constexpr double kNotFast = 7.99;
constexpr double kHalf = 0.5 * kFast;  // a cut that is no faster is a slow one
constexpr double kNear = 1e-4;
constexpr double kSame = 0.5 * Registers::kSameHeight;  // above a height and still at it

class WatchedWay : public testing::Test {
 protected:
  WatchedWay() {
    registers.surface_z = registers.z0 = 0.0;
    registers.rotation_given = registers.xy_speed_given = registers.z_speed_given = true;
    registers.place_given_by = 1;
    registers.act = 2;
  }

  void Ride(CutWatch::Ride ride) {
    const Point& to = ride.to;
    ride.length_mm = std::hypot(to.x - ride.from.x, to.y - ride.from.y, to.z - ride.from.z);
    ride.fastest_z_mm_s = 10.0;
    ride.along_surface =
        ride.in_work && !ride.plunge && !registers.IsBelowSurface(std::min(to.z, ride.from.z));
    watch.OnRide(ride, registers, {.number = ++number, .offset = 0, .op = Op::kCall});
  }
  // Straight down from one height to another.
  void Plunge(double from, double to, double speed) {
    Ride({.from = {.z = from},
          .to = {.z = to},
          .in_work = true,
          .spindle_turns = true,
          .plunge = true,
          .speed_mm_s = speed});
  }
  // 10 mm along X by F; by V where it is said so.
  void Cut(double z, double speed, bool by_xy_speed = true) {
    Ride({.from = {.z = z},
          .to = {.x = 10, .z = z},
          .in_work = true,
          .by_xy_speed = by_xy_speed,
          .spindle_turns = true,
          .speed_mm_s = speed});
  }
  void Lift(double from) { Ride({.from = {.z = from}, .to = {.z = 5}, .rapid = true}); }
  void Travel(double from, double to) {
    Ride({.from = {.z = from}, .to = {.x = 10, .z = to}, .rapid = true});
  }

  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Registers registers{profile};
  CutWatch watch;
  std::uint64_t number = 0;
};

TEST_F(WatchedWay, DownFastToASlowerCutIsAFastPlunge) {
  Plunge(5, -2, kFast);
  EXPECT_EQ(watch.fast_plunge().mm, 0.0);  // so far
  Cut(-2, kFast - 0.01);
  EXPECT_NEAR(watch.fast_plunge().mm, 2.0, kNear);  // of 7 mm what lies below the surface
  EXPECT_EQ(watch.fast_plunge().first.number, 1U);
  Plunge(-2, -3, 1.0);
  EXPECT_EQ(watch.fast_plunge().first.number, 1U);
  EXPECT_EQ(watch.taken_for_cleared().mm, 0.0);
}

TEST_F(WatchedWay, DownFastToACutAsFastIsNone) {
  Plunge(5, -2, kFast);
  Cut(-2, kFast);
  EXPECT_EQ(watch.fast_plunge().mm, 0.0);
}

TEST_F(WatchedWay, DownSlowerThanLiftsIsNone) {
  Plunge(5, -2, kNotFast);
  Cut(-2, 1.0);
  EXPECT_EQ(watch.fast_plunge().mm, 0.0);
}

// A way is one down when it drops by more than it goes across, and A stands.
TEST_F(WatchedWay, SteepWaysGoDown) {
  const auto fast_plunge = [this](Point to) {
    watch = {};
    Ride({.to = to, .in_work = true, .spindle_turns = true, .speed_mm_s = kFast});
    Cut(to.z, 1.0);
    return watch.fast_plunge().mm;
  };
  EXPECT_NEAR(fast_plunge({.x = 1, .z = -2}), std::sqrt(5.0), kNear);
  EXPECT_NEAR(fast_plunge({.x = 1, .y = -1, .z = -2}), std::sqrt(6.0), kNear);
  EXPECT_EQ(fast_plunge({.x = 2, .z = -2}), 0.0);
  EXPECT_EQ(fast_plunge({.x = 1.5, .y = 1.5, .z = -2}), 0.0);
  EXPECT_EQ(fast_plunge({.x = 1, .z = -2, .a = 10}), 0.0);
}

// Straight down is a way down also where A turns meanwhile.
TEST_F(WatchedWay, StraightDownWhileATurns) {
  Ride({.from = {.z = 5},
        .to = {.z = -2, .a = 90},
        .in_work = true,
        .spindle_turns = true,
        .plunge = true,
        .speed_mm_s = kFast});
  Cut(-2, 1.0);
  EXPECT_NEAR(watch.fast_plunge().mm, 2.0, kNear);
  EXPECT_EQ(watch.fast_plunge().first.number, 1U);
}

// A hole that is left at once: fast, unless something is cut as fast.
TEST_F(WatchedWay, DownFastAndBackIsAFastPlungeWhereCutsAreSlower) {
  Plunge(5, -3, kFast);
  Lift(-3);
  EXPECT_NEAR(watch.fast_plunge().mm, 3.0, kNear);
  Plunge(1, -1, 1.0);
  Cut(-1, kFast - 0.01);
  EXPECT_NEAR(watch.fast_plunge().mm, 3.0, kNear);
  Cut(-1, kFast);
  EXPECT_EQ(watch.fast_plunge().mm, 0.0);
}

// 0.2 mm before the material: the rest was cleared by an earlier pass, so far as this program
// knows.
TEST_F(WatchedWay, AnApproachOfTwoTenthsIsNoPlunge) {
  Plunge(5, -1, kFast);
  Plunge(-1, -1.2, 1.0);
  EXPECT_NEAR(watch.taken_for_cleared().mm, 1.0, kNear);
  EXPECT_EQ(watch.taken_for_cleared().first.number, 1U);
  Cut(-1.2, 1.0);
  EXPECT_EQ(watch.fast_plunge().mm, 0.0);

  // Behind that only what is deeper than 1.2 mm is taken for cleared.
  Lift(-1.2);
  Plunge(5, -2, kFast);
  Plunge(-2, -2.5, 1.0);
  EXPECT_NEAR(watch.taken_for_cleared().mm, 1.8, kNear);
}

TEST_F(WatchedWay, AShorterApproachIsTooShort) {
  Plunge(5, -1, kFast);
  Plunge(-1, -1.19, 1.0);
  EXPECT_NEAR(watch.fast_plunge().mm, 1.0, kNear);  // so far, too
  EXPECT_EQ(watch.taken_for_cleared().mm, 0.0);
  Cut(-1.19, 1.0);
  EXPECT_NEAR(watch.fast_plunge().mm, 1.0, kNear);
}

// Lengths are added up: a millionth of a mm less is rounding.
TEST_F(WatchedWay, AnApproachMayLackWhatRoundingTakes) {
  registers.surface_z = 1.0;
  Plunge(5, 0, kFast);
  Plunge(0, -(0.2 - 1e-6), 1.0);
  EXPECT_NEAR(watch.taken_for_cleared().mm, 1.0, kNear);
  watch = {};
  Plunge(5, 0, kFast);
  Plunge(0, -(0.2 - 2e-6), 1.0);
  EXPECT_EQ(watch.taken_for_cleared().mm, 0.0);
}

TEST_F(WatchedWay, AcrossFastAmongCutsOfHalfTheSpeed) {
  Plunge(5, -1, 1.0);
  Cut(-1, kFast, false);
  EXPECT_EQ(watch.fast_across().mm, 0.0);
  Cut(-1, kHalf);
  EXPECT_NEAR(watch.fast_across().mm, 10.0, kNear);
  EXPECT_EQ(watch.fast_across().first.number, 2U);
}

TEST_F(WatchedWay, AcrossFastAmongFasterCutsIsAsked) {
  Plunge(5, -1, 1.0);
  Cut(-1, kFast, false);
  Cut(-1, kHalf + 0.01);
  Lift(-1);
  EXPECT_EQ(watch.fast_across().mm, 0.0);
}

// F is of cuts alone: however fast, it is no lift.
TEST_F(WatchedWay, AcrossByFIsNeverFast) {
  Plunge(5, -1, 1.0);
  Cut(-1, 2 * kFast);
  Cut(-1, 1.0);
  EXPECT_EQ(watch.fast_across().mm, 0.0);
}

// Another visit that goes down as fast is compared with the slow cuts of all.
TEST_F(WatchedWay, AcrossFastInAVisitByItself) {
  const auto fast_across = [this](double down, double elsewhere) {
    watch = {};
    Plunge(5, -1, down);
    Cut(-1, kFast, false);
    Lift(-1);
    Plunge(5, -1, 1.0);
    Cut(-1, elsewhere);
    Lift(-1);
    return watch.fast_across().mm;
  };
  EXPECT_NEAR(fast_across(kFast, kHalf), 10.0, kNear);
  EXPECT_EQ(fast_across(kFast, kHalf + 0.01), 0.0);
  EXPECT_EQ(fast_across(kNotFast, kHalf), 0.0);
}

// Up by more than across is no cut; a slow way that leads down is no slow cut.
TEST_F(WatchedWay, ObliqueWaysAcross) {
  Plunge(5, -2, 1.0);
  Ride({.from = {.z = -2},
        .to = {.x = 0.5, .z = -1},
        .in_work = true,
        .spindle_turns = true,
        .speed_mm_s = kFast});
  Cut(-1, kHalf);
  EXPECT_EQ(watch.fast_across().mm, 0.0);

  watch = {};
  Plunge(5, -1, 1.0);
  Cut(-1, kFast, false);
  Ride({.from = {.z = -1},
        .to = {.x = 10, .z = -2},
        .in_work = true,
        .by_xy_speed = true,
        .spindle_turns = true,
        .speed_mm_s = 1.0});
  EXPECT_EQ(watch.fast_across().mm, 0.0);
}

// As much up as across is across; a slow way is level where it leads down by less than what tells
// heights apart.
TEST_F(WatchedWay, ObliqueWaysAtTheirLimits) {
  Plunge(5, -2, 1.0);
  Ride({.from = {.z = -2},
        .to = {.x = 1, .z = -1},
        .in_work = true,
        .spindle_turns = true,
        .speed_mm_s = kFast});
  Cut(-1, kHalf);
  EXPECT_NEAR(watch.fast_across().mm, std::sqrt(2.0), kNear);

  registers.surface_z = 1.0;
  const auto fast_across = [this](double down) {
    watch = {};
    Plunge(5, 0, 1.0);
    Cut(0, kFast, false);
    Ride({.to = {.x = 10, .z = -down},
          .in_work = true,
          .by_xy_speed = true,
          .spindle_turns = true,
          .speed_mm_s = kHalf});
    return watch.fast_across().mm;
  };
  EXPECT_NEAR(fast_across(0.9 * kSame), 10.0, kNear);
  EXPECT_EQ(fast_across(kSame), 0.0);
}

TEST_F(WatchedWay, TravelNotAboveTheSurfaceHasNoClearance) {
  Travel(0, 0);
  EXPECT_NEAR(watch.no_clearance().mm, 10.0, kNear);
  EXPECT_EQ(watch.no_clearance().first.number, 1U);
  Travel(kSame, kSame);
  EXPECT_NEAR(watch.no_clearance().mm, 20.0, kNear);
  watch = {};
  Ride({.to = {.x = kSame}, .rapid = true});  // not across
  EXPECT_EQ(watch.no_clearance().mm, 0.0);
  Travel(0, 0);
  Travel(0.001, 0.001);
  EXPECT_NEAR(watch.no_clearance().mm, 10.0, kNear);
  Travel(1, -3);  // three quarters of it
  EXPECT_NEAR(watch.no_clearance().mm, 10.0 + 0.75 * std::sqrt(116.0), kNear);
  Lift(-3);  // not across
  EXPECT_NEAR(watch.no_clearance().mm, 10.0 + 0.75 * std::sqrt(116.0), kNear);
}

// Along the surface by V: a lift that was forgotten, where the cuts around take half of that.
TEST_F(WatchedWay, AlongTheSurfaceAsFastAsLifts) {
  const auto no_clearance = [this](double before, double behind, double along = kFast) {
    watch = {};
    if (before > 0.0) Cut(-1, before);
    Ride({.to = {.x = 10}, .spindle_turns = true, .speed_mm_s = along});
    if (behind > 0.0) Cut(-1, behind);
    return watch.no_clearance().mm;
  };
  EXPECT_NEAR(no_clearance(kHalf, kHalf), 10.0, kNear);
  EXPECT_EQ(no_clearance(kHalf + 0.01, kHalf), 0.0);
  EXPECT_EQ(no_clearance(kHalf, kHalf + 0.01), 0.0);
  EXPECT_EQ(no_clearance(1.0, 1.0, kNotFast), 0.0);
  EXPECT_NEAR(no_clearance(kHalf, 0.0), 10.0, kNear);
  EXPECT_NEAR(no_clearance(0.0, kHalf), 10.0, kNear);
  EXPECT_EQ(no_clearance(0.0, 0.0), 0.0);  // nothing tells it from a cut

  // How fast it goes above the surface does not count.
  watch = {};
  Cut(-1, 5.0);
  Ride({.to = {.x = 10}, .spindle_turns = true, .speed_mm_s = 10.0});
  Ride({.from = {.z = 1}, .to = {.x = 10, .z = 1}, .spindle_turns = true, .speed_mm_s = kFast});
  Cut(-1, 5.0);
  EXPECT_NEAR(watch.no_clearance().mm, 10.0, kNear);
}

TEST_F(WatchedWay, BelowTheClampsToTheWorkAndFromIt) {
  const auto travel = [this](double z) {
    Ride({.from = {.z = z}, .to = {.x = 10, .z = z}, .rapid = true, .clamps_height = 3.0});
  };
  travel(3);
  EXPECT_EQ(watch.below_clamps().mm, 0.0);
  travel(2.999);
  EXPECT_NEAR(watch.below_clamps().mm, 10.0, kNear);
  EXPECT_EQ(watch.below_clamps().first.number, 2U);
  Cut(-1, 1.0);
  travel(1);  // from cut to cut: where the work is no clamps are
  Cut(-1, 1.0);
  EXPECT_NEAR(watch.below_clamps().mm, 10.0, kNear);
  travel(1);
  travel(1);
  EXPECT_NEAR(watch.below_clamps().mm, 30.0, kNear);
  EXPECT_EQ(watch.below_clamps().first.number, 2U);

  watch = {};
  Cut(-1, 1.0);
  travel(1);
  EXPECT_EQ(watch.below_clamps().first.number, number);
}

// More than one in a hundred beside what was asked for.
TEST_F(WatchedWay, FeedRatesThatTheMachineDoesNotHave) {
  registers.xy_limit = {.asked = 100.0, .used = 99.0};
  Cut(-1, 99.0);
  EXPECT_EQ(watch.feed_limited().mm, 0.0);
  registers.xy_limit = {.asked = 100.0, .used = 98.9};
  Cut(-1, 98.9);
  registers.xy_limit = {.asked = 100.0, .used = 60.0};
  Cut(-1, 60.0);
  registers.xy_limit = {.asked = 100.0, .used = 90.0};
  Cut(-1, 90.0);
  EXPECT_NEAR(watch.feed_limited().mm, 30.0, kNear);
  EXPECT_EQ(watch.feed_limited().first.number, 2U);
  EXPECT_EQ(watch.feed_limited().worst.used, 60.0);
  Cut(-1, 1.0, false);  // by V, which is not limited
  EXPECT_NEAR(watch.feed_limited().mm, 30.0, kNear);
  EXPECT_EQ(watch.rpm_limited().mm, 0.0);

  // Where nothing is cut no speed is missing.
  watch = {};
  Cut(0, 90.0);
  EXPECT_EQ(watch.feed_limited().mm, 0.0);
  EXPECT_EQ(watch.feed_limited().worst.asked, 0.0);
}

// A plunge that is slower harms nothing, one that is faster does.
TEST_F(WatchedWay, PlungesThatTheMachineDoesNotHave) {
  registers.z_limit = {.asked = 20.0, .used = 10.0};
  Plunge(1, -1, 1.0);
  EXPECT_EQ(watch.feed_limited().mm, 0.0);
  registers.z_limit = {.asked = 0.1, .used = 0.5};
  Plunge(1, -1, 0.5);
  EXPECT_NEAR(watch.feed_limited().mm, 1.0, kNear);
}

TEST_F(WatchedWay, SpindleSpeedsThatTheMachineDoesNotHave) {
  registers.rpm_limit = {.asked = 10000.0, .used = 9900.0};
  Cut(-1, 1.0);
  EXPECT_EQ(watch.rpm_limited().mm, 0.0);
  registers.rpm_limit = {.asked = 10000.0, .used = 9800.0};
  Cut(-1, 1.0);
  EXPECT_NEAR(watch.rpm_limited().mm, 10.0, kNear);
  EXPECT_EQ(watch.rpm_limited().worst.asked, 10000.0);
  // Of a spindle that stands something else is told.
  Ride({.from = {.z = -1}, .to = {.x = 10, .z = -1}, .in_work = true, .by_xy_speed = true});
  EXPECT_NEAR(watch.rpm_limited().mm, 10.0, kNear);
  EXPECT_NEAR(watch.spindle_stands().mm, 10.0, kNear);
  EXPECT_EQ(watch.spindle_stands().first.number, number);
}

TEST_F(WatchedWay, WhatTheProgramDidNotSay) {
  registers.rotation_given = false;
  Cut(-1, 1.0);
  EXPECT_NEAR(watch.rotation_not_given().mm, 10.0, kNear);
  EXPECT_EQ(watch.feed_not_given().mm, 0.0);
  registers.rotation_given = true;
  registers.xy_speed_given = false;
  Cut(-1, 1.0, false);
  EXPECT_EQ(watch.feed_not_given().mm, 0.0);
  Cut(-1, 1.0);
  EXPECT_NEAR(watch.feed_not_given().mm, 10.0, kNear);
  registers.z_speed_given = false;
  Plunge(1, -2, 1.0);
  EXPECT_NEAR(watch.feed_not_given().mm, 12.0, kNear);
  EXPECT_NEAR(watch.rotation_not_given().mm, 10.0, kNear);
  EXPECT_EQ(watch.spindle_stands().mm, 0.0);
}

// With the tool down and the spindle on along the surface; not on the way down.
TEST_F(WatchedWay, AlongTheSurfaceNothingIsCut) {
  Cut(0, 1.0);
  EXPECT_NEAR(watch.skims().mm, 10.0, kNear);
  Cut(-0.001, 1.0);
  Plunge(5, 0, 1.0);
  Ride({.to = {.x = 10}, .in_work = true, .by_xy_speed = true});
  EXPECT_NEAR(watch.skims().mm, 10.0, kNear);
  EXPECT_EQ(watch.spindle_stands().mm, 0.0);
  EXPECT_EQ(watch.spindle_stands().first.number, 0U);
}

// The act that gives X and Y says where its own way ends, and not where it begins.
TEST_F(WatchedWay, APlaceIsKnownBehindTheActThatGivesIt) {
  registers.place_given_by = 0;
  Plunge(1, -1, 1.0);
  Cut(-1, 1.0);
  EXPECT_NEAR(watch.place_not_given().mm, 11.0, kNear);
  EXPECT_EQ(watch.place_not_given().first.number, 1U);
  registers.act = registers.place_given_by = 5;
  Plunge(-1, -2, 1.0);  // not across: it stands where it stood
  Cut(-2, 1.0);
  EXPECT_NEAR(watch.place_not_given().mm, 22.0, kNear);
  Cut(-2, 1.0);
  EXPECT_NEAR(watch.place_not_given().mm, 22.0, kNear);

  watch = {};
  registers.act = 6;
  Cut(-1, 1.0);
  EXPECT_EQ(watch.place_not_given().mm, 0.0);
}

// Steps of one way down are one way: as long as all of them, from the first on.
TEST_F(WatchedWay, DownFastInTwoSteps) {
  Plunge(5, -1, kFast);
  Plunge(-1, -2, kFast);
  Cut(-2, 1.0);
  EXPECT_NEAR(watch.fast_plunge().mm, 2.0, kNear);
  EXPECT_EQ(watch.fast_plunge().first.number, 1U);
  EXPECT_EQ(watch.taken_for_cleared().mm, 0.0);
}

// A step down on the way of a cut is part of the cut, also of one that began with a ramp.
TEST_F(WatchedWay, AStepDownBehindARampIsNoPlunge) {
  Ride({.to = {.x = 10, .z = -1}, .in_work = true, .spindle_turns = true, .speed_mm_s = 1.0});
  Plunge(-1, -2, kFast);
  Cut(-2, 1.0);
  EXPECT_EQ(watch.fast_plunge().mm, 0.0);
}

// A way down is told once, however many cuts or ways follow it.
TEST_F(WatchedWay, AFastPlungeIsToldOnce) {
  Plunge(5, -2, kFast);
  Cut(-2, 1.0);
  Cut(-2, 1.0);
  EXPECT_NEAR(watch.fast_plunge().mm, 2.0, kNear);
  watch = {};
  Plunge(5, -3, kFast);
  Lift(-3);
  Travel(5, 5);
  EXPECT_NEAR(watch.fast_plunge().mm, 3.0, kNear);
}

// An approach that was too short stays so: it is over with the cut, and a slow plunge behind that
// is another way down.
TEST_F(WatchedWay, AShortApproachIsOverWithItsCut) {
  Plunge(5, -1, kFast);
  Plunge(-1, -1.19, 1.0);
  Cut(-1.19, 1.0);
  Lift(-1.19);
  Plunge(5, -1, 1.0);
  EXPECT_NEAR(watch.fast_plunge().mm, 1.0, kNear);
  EXPECT_EQ(watch.taken_for_cleared().mm, 0.0);
}

// Where Z travels at 1 mm/s, 0.8 mm/s are fast and 0.4 mm/s slow; no cut follows.
TEST_F(WatchedWay, AlongTheSurfaceOfASlowMachine) {
  const auto go = [this](CutWatch::Ride ride) {
    ride.length_mm = 10.0;
    ride.spindle_turns = true;
    ride.fastest_z_mm_s = 1.0;
    watch.OnRide(ride, registers, {.number = ++number, .offset = 0, .op = Op::kCall});
  };
  go({.from = {.z = -1}, .to = {.x = 10, .z = -1}, .in_work = true, .speed_mm_s = 0.4});
  go({.to = {.x = 10}, .speed_mm_s = 0.8});
  EXPECT_NEAR(watch.no_clearance().mm, 10.0, kNear);
}

// What lies above a height by no more than rounding makes is at it: that share of an oblique way
// counts, to the last of it.
TEST_F(WatchedWay, TheShareOfAnObliqueWay) {
  Travel(1, -3);
  EXPECT_NEAR(watch.no_clearance().mm, std::sqrt(116.0) * (3.0 + kSame) / 4.0, 1e-9);
}

// registers.h: a way a little lower than what tells heights apart is below the surface.
TEST_F(WatchedWay, JustBelowTheSurfaceIsBelowIt) {
  const double z = -1.25 * Registers::kSameHeight;
  ASSERT_TRUE(registers.IsBelowSurface(z));
  Ride({.from = {.z = z}, .to = {.x = 10, .z = z}, .in_work = true, .by_xy_speed = true});
  EXPECT_NEAR(watch.spindle_stands().mm, 10.0, kNear);
}

// However short: half a millimetre across, fast among slow cuts; lower than the clamps, before the
// cuts and behind them; and of ways down that are taken for cleared. The first is named.
TEST_F(WatchedWay, ShortWaysCountAsLongOnes) {
  Plunge(5, -1, 1.0);
  Ride({.from = {.z = -1},
        .to = {.x = 0.5, .z = -1},
        .in_work = true,
        .spindle_turns = true,
        .speed_mm_s = kFast});
  Cut(-1, kHalf);
  EXPECT_NEAR(watch.fast_across().mm, 0.5, kNear);

  watch = {};
  number = 0;
  const auto below_clamps = [this](double x) {
    Ride({.from = {.z = 1}, .to = {.x = x, .z = 1}, .rapid = true, .clamps_height = 3.0});
  };
  below_clamps(0.5);
  Cut(-1, 1.0);
  below_clamps(10.0);
  EXPECT_NEAR(watch.below_clamps().mm, 10.5, kNear);
  EXPECT_EQ(watch.below_clamps().first.number, 1U);

  watch = {};
  number = 0;
  Plunge(5, -0.5, kFast);
  Plunge(-0.5, -0.8, 1.0);
  Cut(-0.8, 1.0);
  Lift(-0.8);
  Plunge(5, -1.5, kFast);
  Plunge(-1.5, -2, 1.0);
  EXPECT_NEAR(watch.taken_for_cleared().mm, 0.5 + 0.7, kNear);
  EXPECT_EQ(watch.taken_for_cleared().first.number, 1U);
}

// cut_watch.h: along the surface as fast as lifts, where the cuts before and behind take half of
// that or less: a slow plunge is such a cut, a fast way across is none. Of several ways the first
// is named, whichever is known for one first.
TEST_F(WatchedWay, BesideWhatTheSurfaceIsCrossed) {
  const auto along = [this] {
    Ride({.to = {.x = 10}, .spindle_turns = true, .speed_mm_s = kFast});
  };
  Plunge(5, -1, 1.0);
  Lift(-1);
  along();
  EXPECT_NEAR(watch.no_clearance().mm, 10.0, kNear);

  watch = {};
  Cut(-1, 1.0);
  along();
  Cut(-1, kFast, false);
  Cut(-1, 1.0);
  EXPECT_EQ(watch.no_clearance().mm, 0.0);

  watch = {};
  number = 0;
  along();
  Travel(0, 0);
  Cut(-1, 1.0);
  EXPECT_NEAR(watch.no_clearance().mm, 20.0, kNear);
  EXPECT_EQ(watch.no_clearance().first.number, 1U);
}

// In the work: a lift out of it is not.
TEST_F(WatchedWay, ALiftAsksForNoPlace) {
  registers.place_given_by = 0;
  Plunge(1, -1, 1.0);
  Lift(-1);
  EXPECT_NEAR(watch.place_not_given().mm, 1.0, kNear);
}

}  // namespace
}  // namespace rmlcell::rml1
