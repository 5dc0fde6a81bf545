// What is just not told of a way through the work, the last letter of the alphabet, waits of a
// recovery, and the least orders and budgets of a run.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/rml1/clipping.h"
#include "engine/rml1/cut_watch.h"
#include "engine/rml1/device.h"
#include "engine/rml1/number.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

class WatchedSides : public testing::Test {
 protected:
  WatchedSides() {
    registers.surface_z = registers.z0 = 0.0;
    registers.rotation_given = registers.xy_speed_given = registers.z_speed_given = true;
  }
  // Below the surface by V unless it is said otherwise, with the spindle on.
  void Go(const Point& from, const Point& to, double speed, bool by_xy_speed = false) {
    CutWatch::Ride ride{.from = from,
                        .to = to,
                        .length_mm = DistanceXYZ(from, to),
                        .in_work = true,
                        .by_xy_speed = by_xy_speed,
                        .spindle_turns = true,
                        .speed_mm_s = speed,
                        .fastest_z_mm_s = 10.0};
    watch.OnRide(ride, registers, {.number = ++number, .offset = 0, .op = Op::kCall});
  }

  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  Registers registers{profile};
  CutWatch watch;
  std::uint64_t number = 0;
};

// cut_watch.h: more down than across: as far down as across is none, in the plane as along X.
TEST_F(WatchedSides, AsFarDownAsAcrossIsNotSteep) {
  const auto told = [this](double drop) {
    watch = {};
    Go({}, {.x = 3, .y = 4, .z = -drop}, 9.0);
    Go({.x = 3, .y = 4, .z = -drop}, {.x = 30, .y = 4, .z = -drop}, 1.0, true);
    return watch.fast_plunge().mm;
  };
  EXPECT_EQ(told(5.0), 0.0);
  EXPECT_GT(told(5.01), 5.0);
}

// cut_watch.h: more than 1 % beside what the program asked for, and not 1 % itself.
TEST_F(WatchedSides, OnePercentIsAsAsked) {
  const auto told = [this](double used, bool of_spindle, bool sure = true) {
    watch = {};
    (of_spindle ? registers.rpm_limit : registers.xy_limit) = {.asked = 100.0, .used = used};
    registers.rotation_given = sure;
    Go({.z = -1}, {.x = 10, .z = -1}, 1.0, true);
    registers.rpm_limit = registers.xy_limit = {};
    return of_spindle ? watch.rpm_limited().mm : watch.feed_limited().mm;
  };
  for (const bool of_spindle : {false, true}) {
    EXPECT_EQ(told(99.0, of_spindle), 0.0);
    EXPECT_EQ(told(99.0, of_spindle, false), 0.0);
    EXPECT_NEAR(told(98.9, of_spindle, false), 10.0, 1e-9);
    EXPECT_NEAR(told(98.9, of_spindle), 10.0, 1e-9);
    EXPECT_NEAR(told(101.1, of_spindle), 10.0, 1e-9);
  }
}

// cut_watch.h: in the work: what was limited along the surface alone is not the worst of it.
TEST_F(WatchedSides, WhatIsLimitedAboveTheWorkDoesNotCount) {
  registers.rotation_given = false;
  registers.xy_limit = {.asked = 100.0, .used = 50.0};
  Go({}, {.x = 10}, 1.0, true);
  EXPECT_EQ(watch.feed_limited().mm, 0.0);
  registers.xy_limit = {.asked = 100.0, .used = 90.0};
  Go({.z = -1}, {.x = 10, .z = -1}, 1.0, true);
  EXPECT_NEAR(watch.feed_limited().mm, 10.0, 1e-9);
  EXPECT_EQ(watch.feed_limited().worst.used, 90.0);
}

// cut_watch.h: of no clamps nothing is below them, however low the way.
TEST_F(WatchedSides, WithoutClampsNothingIsBelowThem) {
  for (const double height : {0.0, 3.0}) {
    watch = {};
    CutWatch::Ride ride{.from = {.z = -2},
                        .to = {.x = 10, .z = -2},
                        .length_mm = 10.0,
                        .rapid = true,
                        .clamps_height = height};
    watch.OnRide(ride, registers, {.number = 1, .offset = 0, .op = Op::kCall});
    EXPECT_EQ(watch.below_clamps().mm, height > 0.0 ? 10.0 : 0.0);
  }
}

// clipping.h: the ends of a line exactly, where the sum of its parts is another number.
TEST(EndsOfLines, AreThemselves) {
  const Point from{1e9, -1e9, 1e8, 1e7};
  const Point to{0.3, 0.7, -0.1, 359.9};
  EXPECT_NE(from.x + (to.x - from.x), to.x);
  EXPECT_EQ(Between(from, to, 1.0), to);
  EXPECT_EQ(Between(from, to, 0.0), from);
  EXPECT_NEAR(Between(from, to, 0.25).x, 0.75e9 + 0.075, 1e-6);
}

class ReadBytes final : public DeviceListener {
 public:
  ReadBytes(std::string_view stream, bool at_once)
      : profile_(MakeProfile(ParametersOf("t1")).value()), device_(profile_) {
    for (std::size_t at = 0; at < stream.size();) {
      if (at_once) {
        at +=
            device_
                .Read(stream.substr(at), static_cast<std::int64_t>(at), Device::kAnyCommands, *this)
                .bytes;
      } else {
        device_.Receive(static_cast<unsigned char>(stream[at]), static_cast<std::int64_t>(at),
                        *this);
        ++at;
      }
      do {
        while (!device_.actions().empty()) device_.actions().Pop();
      } while (device_.Step(*this));
    }
  }
  void OnFinding(const Finding&) override { ++findings; }
  const Device* operator->() const { return &device_; }

  int findings = 0;

 private:
  Profile profile_;
  Device device_;
};

// Small letters are letters, from the first to the last.
TEST(SmallLetters, AreLettersFromAToZ) {
  const std::string behind(40, ';');
  for (const bool at_once : {false, true}) {
    ReadBytes two("df;pa5,6;" + behind, at_once);
    EXPECT_EQ(two.findings, 0);
    EXPECT_EQ(two->carriage().logical().x, 5.0);
    ReadBytes one("z7,8,-9;!zz1,1,1;" + behind, at_once);
    EXPECT_EQ(one.findings, 0);
    EXPECT_EQ(one->programmed().x().high, 7.0);
    EXPECT_EQ(one->programmed().y().high, 8.0);
  }
  EXPECT_EQ(ReadBytes("`;{;", false).findings, 2);  // right before a, right behind z
}

// number.h: larger numbers than that saturate there, with a fraction and without.
TEST(SaturatedNumbers, AreOneNumber) {
  const auto read = [](std::string_view text) {
    NumberReader reader;
    reader.Begin(static_cast<unsigned char>(text[0]));
    for (const char c : text.substr(1)) EXPECT_TRUE(reader.Take(static_cast<unsigned char>(c)));
    return reader.value();
  };
  for (const std::string text : {"1000000000", "99999999999", "1000000000.5", "5000000000.25"}) {
    EXPECT_EQ(read(text).decimal, 1e9) << text;
    EXPECT_EQ(read("-" + text).decimal, -1e9) << text;
    EXPECT_EQ(read(text).truncated(), 1'000'000'000) << text;
    Number whole;
    const std::string behind = text + ";";
    const char* const end =
        NumberReader::ReadWhole(behind.data(), behind.data() + behind.size(), whole);
    EXPECT_TRUE(end == nullptr || whole.decimal == 1e9) << text;
  }
  EXPECT_EQ(read("999999999.5").decimal, 999999999.5);
}

// RML1-9.34, RML1-9.53: of the way back of a two-dimensional command that motion waits alone which
// ends at the tool height: neither the way up nor the one across.
TEST(RecoverySides, WaitsBeforeTheToolHeightAlone) {
  TestRun run(ParametersOf("t1"), "!MC0;Z21000,0,1500;W100;PU21000,1000,19000,1000;");
  run.AdvanceToEnd();
  std::vector<std::string> events = run.seen().Events();
  std::erase_if(events, [](const std::string& event) {
    return !event.starts_with("move ") && !event.starts_with("dwell ");
  });
  ASSERT_EQ(events.size(), 6U);
  EXPECT_EQ(events[1], "move 20000.0,0.0,2000.0");
  EXPECT_EQ(events[2], "move 20000.0,1000.0,2000.0");
  EXPECT_EQ(events[3], "dwell 0.1");
  EXPECT_EQ(events[4], "move 20000.0,1000.0,500.0");
  EXPECT_EQ(events[5], "move 19000.0,1000.0,500.0");
}

// LIVE-3.01: as many commands at one instant as the budget says are too many, one less is not.
TEST(LeastOrders, AsManyCommandsAtOneInstant) {
  for (const int commands : {2, 3}) {
    std::string stream;
    for (int n = 0; n < commands; ++n) stream += "VS5;";
    machine::RunSetup setup = SetupOf(ParametersOf("t1"), stream);
    setup.budget.steps_at_one_instant = 3;
    TestRun run(std::move(setup));
    run.AdvanceToEnd();
    EXPECT_EQ(run->outcome().kind,
              commands < 3 ? machine::OutcomeKind::kCompleted : machine::OutcomeKind::kFailed);
    EXPECT_EQ(run->outcome().code == ErrorCode::kCellStepBudget, commands == 3);
  }
}

}  // namespace
}  // namespace rmlcell::rml1
