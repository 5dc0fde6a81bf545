// Ways, works and numbers that end exactly where a rule does, and what a
// command leaves behind it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "engine/rml1/carriage.h"
#include "engine/rml1/cut_watch.h"
#include "engine/rml1/device.h"
#include "engine/rml1/work_fit.h"
#include "tests/engine/rml1/run_support.h"

// T1: 100 units in a mm, X to 200 mm and Y to 150 mm, Z0 20 mm below the top.
namespace rmlcell::rml1 {
namespace {

// A device that has read a text and done all that it says.
class ReadingDevice final : public DeviceListener {
 public:
  ReadingDevice(std::string_view profile_id, std::string_view text)
      : profile(MakeProfile(ParametersOf(profile_id)).value()), device(profile) {
    std::int64_t offset = 0;
    for (const char c : text) {
      device.Receive(static_cast<unsigned char>(c), offset++, *this);
      do {
        while (!device.actions().empty()) device.actions().Pop();
      } while (device.Step(*this));
    }
  }
  void OnFinding(const Finding& finding) override { findings.push_back(finding); }
  int CountOf(FindingKind kind) const {
    int count = 0;
    for (const Finding& finding : findings) count += finding.kind == kind ? 1 : 0;
    return count;
  }

  const Profile profile;
  Device device;
  std::vector<Finding> findings;
};

// Motion.md 7: no axis exceeds its own speed, however short the way.
TEST(MillEnds, ShortWaysAreLimitedToo) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  EXPECT_NEAR(LimitedSpeed(profile, {0, 0, 0}, {0.5, 0, 0}, 100), 60.0, 1e-9);
  EXPECT_NEAR(LimitedSpeed(profile, {0, 0, 0}, {0, 0, -0.25}, 100), 60.0, 1e-9);
  EXPECT_NEAR(LimitedSpeed(profile, {0, 0, 0}, {0.3, 0.4, 0}, 100), 75.0, 1e-9);
  EXPECT_EQ(LimitedSpeed(profile, {1, 2, 3}, {1, 2, 3}, 100), 100.0);
}

// A travel has a length.
TEST(MillEnds, ATravelWithoutALengthIsNone) {
  machine::Parameters flat = ParametersOf("t1");
  ASSERT_TRUE(flat.Set("Z_MIN", 0.0));
  ASSERT_FALSE(MakeProfile(flat));
  EXPECT_EQ(MakeProfile(flat).error().code, ErrorCode::kCellParameterRange);
  for (const char* axis : {"X", "Y"}) {
    machine::Parameters narrow = ParametersOf("t1");
    ASSERT_TRUE(narrow.Set(std::string(axis) + "_MIN", 120.0));
    ASSERT_TRUE(narrow.Set(std::string(axis) + "_MAX", 120.0));
    EXPECT_FALSE(MakeProfile(narrow)) << axis;
    ASSERT_TRUE(narrow.Set(std::string(axis) + "_MAX", 120.01));
    EXPECT_TRUE(MakeProfile(narrow)) << axis;
  }
}

// work_fit.h: work as long as the travel has one place; a longer one has none,
// and what would lie beyond the travel wherever the origin is set must be
// moved.
TEST(MillEnds, WhereWorkFits) {
  const CuttingRange travel{{1000, 21000}, {1000, 21000}, {-6000, 0}};
  const auto fit = [&](double low, double high) {
    WorkExtent work;
    for (Extent* axis : {&work.x, &work.y}) {
      axis->Add(low);
      axis->Add(high);
    }
    return FitOf(work, {}, {}, travel, 0.0, 100.0).x;
  };
  const WorkFit::Axis exact = fit(0, 20000);
  EXPECT_TRUE(exact.known);
  EXPECT_EQ(exact.low, 10.0);
  EXPECT_EQ(exact.high, 10.0);
  const WorkFit::Axis last = fit(-5000, 20000);
  EXPECT_TRUE(last.known);
  EXPECT_EQ(last.over, 50.0);
  const WorkFit::Axis far = fit(22000, 23000);
  EXPECT_TRUE(far.known);
  EXPECT_EQ(far.move, -30.0);
  const WorkFit::Axis before = fit(-23000, -22000);
  EXPECT_TRUE(before.known);
  EXPECT_EQ(before.move, 30.0);
  const WorkFit::Axis high_end = fit(-20000, -19000);
  EXPECT_TRUE(high_end.known);
  EXPECT_EQ(high_end.low, 210.0);
  EXPECT_EQ(high_end.high, 210.0);
}

class WatchedEnds : public testing::Test {
 protected:
  static constexpr double kSame = 0.5 * Registers::kSameHeight;

  WatchedEnds() {
    registers.surface_z = registers.z0 = 0.0;
    registers.rotation_given = registers.xy_speed_given = registers.z_speed_given = true;
    registers.place_given_by = 1;
    registers.act = 2;
  }
  void Go(CutWatch::Ride ride) {
    ride.length_mm = std::hypot(ride.to.x - ride.from.x, ride.to.z - ride.from.z);
    ride.fastest_z_mm_s = 10.0;
    ride.spindle_turns = true;
    watch.OnRide(ride, registers, {.number = ++number, .offset = 0, .op = Op::kCall});
  }
  void Down(double from, double to, double speed) {
    Go({.from = {.z = from},
        .to = {.z = to},
        .in_work = true,
        .plunge = true,
        .speed_mm_s = speed});
  }
  void Across(double z, double speed, bool by_xy_speed) {
    Go({.from = {.z = z},
        .to = {.x = 10, .z = z},
        .in_work = true,
        .by_xy_speed = by_xy_speed,
        .speed_mm_s = speed});
  }
  void Up(double from) { Go({.from = {.z = from}, .to = {.z = 5}, .rapid = true}); }

  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Registers registers{profile};
  CutWatch watch;
  std::uint64_t number = 0;
};

// cut_watch.h: what differs by rounding alone is no way across, and still at
// the surface.
TEST_F(WatchedEnds, RoundingIsNoWayAcross) {
  Go({.to = {.x = kSame}, .rapid = true});
  EXPECT_EQ(watch.no_clearance().mm, 0.0);
  Go({.from = {.z = kSame}, .to = {.x = 10, .z = kSame}, .rapid = true});
  EXPECT_EQ(watch.no_clearance().mm, 10.0);
}

// Lower than the clamps count the ways to the first cut and from the last one
// on, and none between.
TEST_F(WatchedEnds, BetweenCutsClampsDoNotCount) {
  const auto travel = [&] {
    Go({.from = {.z = 5}, .to = {.x = 10, .z = 5}, .rapid = true, .clamps_height = 8.0});
  };
  Across(-1, 4.0, true);
  travel();
  EXPECT_EQ(watch.below_clamps().mm, 10.0);
  Across(-1, 4.0, true);
  EXPECT_EQ(watch.below_clamps().mm, 0.0);
  travel();
  travel();
  EXPECT_EQ(watch.below_clamps().mm, 20.0);
}

// A visit is entered by the last way down before it crosses: a step down behind
// that is none.
TEST_F(WatchedEnds, AStepDownEntersNothing) {
  Down(5, -1, 1.0);
  Across(-1, 8.0, false);
  Down(-1, -2, 8.0);
  Across(-2, 8.0, false);
  Up(-2);
  Down(5, -1, 1.0);
  Across(-1, 2.0, true);
  Up(-1);
  EXPECT_EQ(watch.fast_across().mm, 0.0);
}

// A place that the command itself gives was given by none before it.
TEST_F(WatchedEnds, APlaceIsGivenBefore) {
  registers.place_given_by = 2;
  Across(-1, 4.0, true);
  EXPECT_EQ(watch.place_not_given().mm, 10.0);
  CutWatch fresh;
  watch = fresh;
  registers.place_given_by = 1;
  Across(-1, 4.0, true);
  EXPECT_EQ(watch.place_not_given().mm, 0.0);
}

// What lies above the surface limits nothing in the work.
TEST_F(WatchedEnds, NoLimitAboveTheWork) {
  registers.xy_limit = {.asked = 100.0, .used = 50.0};
  Across(3, 4.0, true);
  EXPECT_EQ(watch.feed_limited().mm, 0.0);
  EXPECT_EQ(watch.feed_limited().worst.off(), 0.0);
  Across(-3, 4.0, true);
  EXPECT_EQ(watch.feed_limited().mm, 10.0);
  EXPECT_EQ(watch.feed_limited().worst.asked, 100.0);
}

// Along the surface by V: each way is measured by itself against the cuts on
// both of its sides.
TEST_F(WatchedEnds, EachWayAlongTheSurfaceIsMeasuredByItself) {
  Go({.to = {.x = 10}, .speed_mm_s = 8.0});
  Across(-1, 4.0, true);
  Go({.to = {.x = 10}, .speed_mm_s = 10.0});
  Across(-1, 5.0, true);
  EXPECT_EQ(watch.no_clearance().mm, 20.0);
  EXPECT_EQ(watch.no_clearance().first.number, 1U);
}

// Half a millimetre counts: of clamps, and of a plunge below the surface.
TEST_F(WatchedEnds, HalfAMillimetreCounts) {
  Go({.from = {.z = 0.2}, .to = {.x = 10, .z = 0.2}, .rapid = true, .clamps_height = 0.5});
  EXPECT_EQ(watch.below_clamps().mm, 10.0);
  Down(5, -0.5, 8.0);
  Across(-0.5, 4.0, true);
  EXPECT_NEAR(watch.fast_plunge().mm, 0.5, 1e-4);
}

// A way across ends where its set says: what is cut behind it begins at a place
// that is given. And of many cuts the first is named.
TEST_F(WatchedEnds, AWayAcrossEndsAtAPlace) {
  registers.place_given_by = registers.act = 1;
  registers.rotation_given = false;
  Go({.from = {.z = 5}, .to = {.x = 10, .z = 5}, .rapid = true});
  Across(-1, 4.0, true);
  Across(-1, 4.0, true);
  EXPECT_EQ(watch.place_not_given().mm, 0.0);
  EXPECT_EQ(watch.rotation_not_given().mm, 20.0);
  EXPECT_EQ(watch.rotation_not_given().first.number, 2U);
}

// RML1-3A.03, RML1-3A.52: without numbers, what the machine has by itself.
TEST(MillEnds, SettingsWithoutNumbers) {
  const ReadingDevice bare("t1", "V9;V;!PZ-50,200;!PZ;");
  EXPECT_EQ(bare.device.registers().z_speed, 2.0);
  EXPECT_EQ(bare.device.registers().z1, 0.0);
  EXPECT_EQ(bare.device.registers().z2, 500.0);
  // RML1-9.31: stage 0 is the lowest speed. A tool-up height of 0 is one, too.
  const ReadingDevice zero("t1", "!RC15;!RC0;!PZ-1,0;");
  EXPECT_EQ(zero.device.registers().rpm, 4500);
  EXPECT_EQ(zero.device.registers().z2, 0.0);
  EXPECT_TRUE(zero.findings.empty());
}

// RML1-3C.33: in relative coordinates !ZO counts from where the tool stands; A
// counts as X does.
TEST(MillEnds, WhatCountsFromWhereTheToolStands) {
  const ReadingDevice lowered("t1", "!MC0;!ZM-500;PR;!ZO-100;");
  EXPECT_EQ(lowered.device.registers().z0, -600.0);
  const ReadingDevice turned("t1a", "PR;!ZE A90;!ZE A80;");
  EXPECT_EQ(turned.device.carriage().logical().a, 170.0);
}

// A group of !ZE that leads out of the travel in the work is told.
TEST(MillEnds, AGroupThatIsClipped) {
  const ReadingDevice out("t1a", "!MC0;!ZE Z-500;!ZE X-1000;");
  EXPECT_EQ(out.CountOf(FindingKind::kClipped), 1);
  EXPECT_EQ(out.device.carriage().lost().length, 1000.0);
}

// RML1-4.05: what a sequence that is none leaves keeps its place, and an open
// one ends the data.
TEST(MillEnds, PlacesBehindASequence) {
  const ReadingDevice foreign("t1", "PU;\x1b.$");
  ASSERT_EQ(foreign.findings.size(), 2U);
  EXPECT_EQ(foreign.findings[1].kind, FindingKind::kForeignCharacter);
  EXPECT_EQ(foreign.findings[1].offset, 5);
  const ReadingDevice open("t1", "PU;\x1b.");
  EXPECT_TRUE(open.device.pending());
  EXPECT_EQ(open.device.pending_offset(), 4);
}

// clipping.h: what is within a millionth of a face counts as on it, and the
// tool never leaves the range, however little.
TEST(MillEnds, NothingIsBeyondAFace) {
  const ReadingDevice device("t1", "!MC0;Z10,10,-50;Z-0.0000005,10,-50;Z10,-0.0000005,-50;");
  EXPECT_EQ(device.device.carriage().physical().y, 0.0);
  const ReadingDevice left("t1", "!MC0;Z10,10,-50;Z-0.0000005,10,-50;");
  EXPECT_EQ(left.device.carriage().physical().x, 0.0);
  EXPECT_EQ(left.device.carriage().clipped_sets(), 0U);
}

}  // namespace
}  // namespace rmlcell::rml1
