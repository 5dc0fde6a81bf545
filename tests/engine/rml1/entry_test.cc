#include "engine/rml1/entry.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "engine/motion/geometry/path.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

const Profile& Mill() {
  static const Profile profile = MakeProfile(ParametersOf("t1")).value();
  return profile;
}

// LIVE-6.04: a command has the byte where its name begins, and no other.
TEST(Entry, FindsTheCommandThatBeginsAtAByte) {
  const std::string stream = "PU1,2;\n^PR;PD;\x1b.K!MC0;PU";
  const auto command_at = [&](std::int64_t byte) -> std::string {
    const Result<int> found = CommandAt(stream, byte, Device(Mill()));
    if (found) return std::to_string(*found);
    return found.error().detail;
  };
  const auto none = [](int byte, int command) {
    return "byte " + std::to_string(byte) + " lies inside of command " + std::to_string(command) +
           " or of a call or ESC sequence: a run begins with a whole command";
  };
  EXPECT_EQ(command_at(0), "1");
  EXPECT_EQ(command_at(1), none(1, 1));
  EXPECT_EQ(command_at(6), none(6, 1));  // between two
  EXPECT_EQ(command_at(7), none(7, 1));  // a call
  EXPECT_EQ(command_at(8), none(8, 2));  // what it calls
  EXPECT_EQ(command_at(11), "3");
  EXPECT_EQ(command_at(15), none(15, 3));
  EXPECT_EQ(command_at(17), "4");
  EXPECT_EQ(command_at(22), "5");  // the last one, which nothing ends
  EXPECT_EQ(command_at(99), none(99, 5));
}

// LIVE-6.05: up to the top and across as fast as the axes travel, then the spindle, and down at V.
TEST(Entry, LeadsOverTheTop) {
  Registers there(Mill());
  there.z_speed = 7.0;
  there.rpm = 6600;
  const Point from{100, 200, -3000, 0};
  const Point to{5000, 200, -2500, 90};
  const std::vector<Action> way = PlanEntry(Mill(), there, true, from, to);
  ASSERT_EQ(way.size(), 4U);
  EXPECT_EQ(way[0].to, (Point{100, 200, 0, 0}));
  EXPECT_EQ(way[0].speed_mm_s, 60.0);
  EXPECT_EQ(way[1].to, (Point{5000, 200, 0, 90}));
  EXPECT_EQ(way[2].kind, Action::Kind::kSpindleStart);
  EXPECT_EQ(way[2].rpm, 6600);
  EXPECT_EQ(way[3].to, to);
  EXPECT_EQ(way[3].speed_mm_s, 7.0);
  for (const std::size_t motion : {0U, 1U, 3U}) {
    EXPECT_EQ(way[motion].kind, Action::Kind::kMotion);
    EXPECT_EQ(way[motion].rapid, motion != 3U);
    EXPECT_EQ(NameOfApproach(way[motion]), motion != 3U ? "PU" : "PD");
  }
  EXPECT_EQ(PlanEntry(Mill(), there, false, from, to).size(), 3U);
  there.rotation = false;
  EXPECT_EQ(PlanEntry(Mill(), there, true, from, to).size(), 3U);
  // Where it is already it does not go: RML1-9.49.
  EXPECT_TRUE(PlanEntry(Mill(), there, false, {1, 2, 0, 3}, {1, 2, 0, 3}).empty());
}

// Rounding is none: 1e-6 mm. T1: 200 by 150 mm and 60 mm down.
TEST(Entry, TellsWhatLiesOutsideOfTheTravel) {
  const double nothing = motion::kTipLengthZero_mm * Mill().units_per_mm;
  EXPECT_TRUE(OutsideOf(Mill(), {-nothing, 15000, -6000, 0}).empty());
  const auto hair = OutsideOf(Mill(), {-2.0 * nothing, 0, 0, 0});
  ASSERT_EQ(hair.size(), 1U);
  EXPECT_DOUBLE_EQ(hair[0].excess, 2e-6);
  const auto outside = OutsideOf(Mill(), {20100, -200, -6300, 400});
  const std::vector<machine::OutOfTravel> wanted = {{.axis = 0, .excess = 1.0, .at_target = true},
                                                    {.axis = 1, .excess = 2.0, .at_target = true},
                                                    {.axis = 2, .excess = 3.0, .at_target = true}};
  EXPECT_EQ(outside, wanted);
}

// Before the first command there is none that a byte could belong to.
TEST(Entry, AByteBeforeTheFirstCommandIsOfNone) {
  const Result<int> found = CommandAt(";PU1,2;", 0, Device(Mill()));
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kCellStepUnreachable);
  EXPECT_TRUE(found.error().detail.starts_with("byte 0 lies inside of command 0 or "));
}

// RML1-2.14, RML1-9.42: a letter that may begin a name of two is no command while nothing is behind
// it, whatever lies behind the stream in memory.
TEST(Entry, ALetterAtTheEndIsNoCommandYet) {
  const std::string longer = "PU1,2;DH;";
  const std::string_view stream = std::string_view(longer).substr(0, 7);
  const Result<int> found = CommandAt(stream, 6, Device(Mill()));
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kCellStepUnreachable);
  EXPECT_TRUE(found.error().detail.starts_with("byte 6 lies inside of command 1 or "));
  const Result<int> there = CommandAt(longer, 6, Device(Mill()));
  ASSERT_TRUE(there);
  EXPECT_EQ(*there, 2);
}

}  // namespace
}  // namespace rmlcell::rml1
