// What a command leaves to be read behind it: marks, counts, waits and figures.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "engine/rml1/clipping.h"
#include "engine/rml1/device.h"
#include "engine/rml1/timing.h"
#include "tests/engine/rml1/run_support.h"

// T1: 100 units in a mm, X to 200 mm and Y to 150 mm, Z0 20 mm below the top.
namespace rmlcell::rml1 {
namespace {

// A device that has read a text, with what it did.
class MarkedDevice final : public DeviceListener {
 public:
  MarkedDevice(std::string_view profile_id, std::string_view text)
      : profile(MakeProfile(ParametersOf(profile_id)).value()), device(profile) {
    std::int64_t offset = 0;
    for (const char c : text) {
      device.Receive(static_cast<unsigned char>(c), offset++, *this);
      do {
        for (const Action& action : device.actions().all()) kinds.push_back(action.kind);
        while (!device.actions().empty()) device.actions().Pop();
      } while (device.Step(*this));
    }
    device.EndOfData();
  }
  int CountOf(Action::Kind kind) const {
    int count = 0;
    for (const Action::Kind one : kinds) count += one == kind ? 1 : 0;
    return count;
  }
  const Registers& registers() const { return device.registers(); }
  const Programmed& programmed() const { return device.programmed(); }

  const Profile profile;
  Device device;
  std::vector<Action::Kind> kinds;
};

// registers.h: each set and each command that is carried out has a number of
// its own; a place is given by the one that gave the second of its axes.
TEST(CommandMarks, EverySetIsAnAct) {
  EXPECT_EQ(MarkedDevice("t1a", "VS5;").registers().act, 1U);
  EXPECT_EQ(MarkedDevice("t1a", "VS5;PU;").registers().act, 2U);
  EXPECT_EQ(MarkedDevice("t1a", "VS5;PU;!ZE X5 Z0;").registers().act, 3U);
  EXPECT_EQ(MarkedDevice("t1a", "VS5;PU;!ZE X5 Z0;PD1,1,2,2;").registers().act, 5U);
  EXPECT_EQ(MarkedDevice("t1a", "!ZE X5;!ZE Y6;!ZE X7;").registers().place_given_by, 2U);
  EXPECT_EQ(MarkedDevice("t1a", "!ZE Y5;!ZE X6;!ZE Y7;").registers().place_given_by, 2U);
  EXPECT_EQ(MarkedDevice("t1a", "!ZE X5;!ZE X6;").registers().place_given_by, 0U);
  EXPECT_EQ(MarkedDevice("t1", "VS5;PU1,1;PU2,2;").registers().place_given_by, 2U);
  EXPECT_EQ(MarkedDevice("t1", "VS5;Z1,1,1;").registers().place_given_by, 2U);
  EXPECT_EQ(MarkedDevice("t1", "PR;PU1,1;Z1,1,1;").registers().place_given_by, 0U);
}

// device.h: the first command that relies on a height or a mode that the
// program did not set.
TEST(CommandMarks, WhatRestsOnTheMachine) {
  EXPECT_EQ(MarkedDevice("t1", "VS5;PU;PD;").device.assumed().heights.number, 2U);
  EXPECT_EQ(MarkedDevice("t1", "!PZ0,5;PU;PD1,1;").device.assumed().heights.number, 0U);
  EXPECT_EQ(MarkedDevice("t1a", "VS5;!ZE X5;").device.assumed().mode.number, 2U);
  EXPECT_EQ(MarkedDevice("t1a", "PA;!ZE X5;").device.assumed().mode.number, 0U);
  for (const std::string set : {"PU1,1;", "Z1,1,1;"}) {
    const MarkedDevice relies("t1", "VS5;" + set);
    EXPECT_EQ(relies.device.assumed().mode.number, 2U) << set;
    EXPECT_EQ(relies.device.assumed().heights.number, set == "PU1,1;" ? 2U : 0U);
    const MarkedDevice told("t1", "PA;!PZ0,5;" + set);
    EXPECT_EQ(told.device.assumed().mode.number, 0U) << set;
    EXPECT_EQ(told.device.assumed().heights.number, 0U) << set;
  }
  EXPECT_TRUE(MarkedDevice("t1", "!MC1;").registers().rotation_given);
  EXPECT_FALSE(MarkedDevice("t1", "VS5;PU1,1;").registers().rotation_given);
  const MarkedDevice refused("t1", "PU1,99999999;PU2,2;PD99999999,1;");
  EXPECT_EQ(refused.device.positions_refused(), 2U);
  EXPECT_EQ(refused.device.first_refused().number, 1U);
  EXPECT_EQ(MarkedDevice("t1", "!DW5;!DW;").registers().dwell_ms, 0);
}

// RML1-3A.69: one wait before the first motion of a set, whatever leads back
// into the travel first.
TEST(CommandMarks, OneWaitForASet) {
  const std::string out = "!MC0;Z100,100,-100;Z-1000,100,-100;Z-1000,9000,-100;!DW5;";
  EXPECT_EQ(MarkedDevice("t1", out + "Z1000,9000,-600;").CountOf(Action::Kind::kDwell), 1);
  EXPECT_EQ(
      MarkedDevice("t1", out + "Z1000,9000,-600,2000,9000,-700;").CountOf(Action::Kind::kDwell), 2);
  EXPECT_EQ(MarkedDevice("t1a", out + "!ZE X1000 Z-600;").CountOf(Action::Kind::kDwell), 1);
}

// programmed.h: numbers as the program has them, relative ones added up, and
// the heights that commands without numbers go to.
TEST(CommandMarks, WhatTheProgramNames) {
  const MarkedDevice group("t1a", "PR;!ZE X5 Z-20;!ZE X7 Z-30;");
  EXPECT_EQ(group.programmed().x().high, 12.0);
  EXPECT_EQ(group.programmed().z().low, -50.0);
  const MarkedDevice bare("t1", "!PZ-50,200;PD;PU;");
  EXPECT_EQ(bare.programmed().z().low, -50.0);
  EXPECT_EQ(bare.programmed().z().high, 200.0);
  const MarkedDevice defaults("t1", "!PZ-50,200;DF;PD;PU;");
  EXPECT_EQ(defaults.programmed().z_grain(), 0U);
  const MarkedDevice home("t1", "!PZ-50,200;H;PD;PU;");
  EXPECT_EQ(home.programmed().z().low, -50.0);
}

// RML1-3A.42, RML1-3B.07: neither starts the spindle. RML1-6.05: they clear the
// register of errors.
TEST(CommandMarks, InitialiseAndHome) {
  EXPECT_EQ(MarkedDevice("t1", "IN;").CountOf(Action::Kind::kSpindleStart), 0);
  EXPECT_EQ(MarkedDevice("t1", "!MC0;PU100,200;!MC1;H;").CountOf(Action::Kind::kSpindleStart), 0);
  EXPECT_EQ(MarkedDevice("t1", "!MC0;PU100,200;!MC1;IN;").CountOf(Action::Kind::kSpindleStart), 0);
  EXPECT_EQ(MarkedDevice("t1", "!MC0;!ZM-2500;!MC1;H;").CountOf(Action::Kind::kSpindleStart), 0);
  EXPECT_EQ(MarkedDevice("t1", "XX;H;").device.command_errors().value(), 0);
  EXPECT_EQ(MarkedDevice("t1", "XX;IN;").device.command_errors().value(), 0);
  EXPECT_EQ(MarkedDevice("t1", "XX;DF;").device.command_errors().value(), 1);
}

// device.h: how far !ZO took Z0 for a motion, a group of !ZE, too, and not only
// for the end.
TEST(CommandMarks, WhereZ0WasForAGroup) {
  const MarkedDevice group("t1a", "!ZO-2500;!ZE X5;!ZO-2000;");
  EXPECT_EQ(group.device.lowered().by, 500.0);
  EXPECT_EQ(group.device.raised().by, 0.0);
  EXPECT_EQ(MarkedDevice("t1a", "!ZO-2500;!ZO-2000;!ZE X5;").device.lowered().by, 0.0);
}

// Each figure of the end is 1 or 0.
TEST(CommandMarks, FiguresOfTheEnd) {
  const auto figure = [](const std::string& stream, const char* name) {
    TestRun run(ParametersOf("t1"), stream);
    run.AdvanceToEnd();
    const Figures figures = run.figures();
    const auto found = figures.find(name);
    return found == figures.end() ? -1.0 : found->second;
  };
  EXPECT_EQ(figure("!MC1;PU1,1;", "spindle_on_at_end"), 1.0);
  EXPECT_EQ(figure("!MC1;PU1,1;!MC0;", "spindle_on_at_end"), 0.0);
  EXPECT_EQ(figure("PU1,1;PU2,2", "incomplete_at_end"), 1.0);
  EXPECT_EQ(figure("PU1,1;PU2,2;", "incomplete_at_end"), 0.0);
}

// The words and figures of a machine come as they are written.
TEST(CommandMarks, WordsOfAMachine) {
  machine::Parameters parameters = ParametersOf("t1a");
  EXPECT_FALSE(MakeProfile(parameters)->rotary_reversed);
  ASSERT_TRUE(parameters.Set("A_SENSE", std::string_view("LEFT")));
  ASSERT_TRUE(parameters.Set("PANEL", std::string_view("FULL")));
  ASSERT_TRUE(parameters.Set("JOG_STEP", 0.05));
  EXPECT_TRUE(MakeProfile(parameters)->rotary_reversed);
  EXPECT_TRUE(MakeProfile(parameters)->panel_described);
  EXPECT_EQ(MakeProfile(parameters)->jog_step_mm, 0.05);
  ASSERT_TRUE(parameters.Set("PANEL", std::string_view("PLAIN")));
  EXPECT_FALSE(MakeProfile(parameters)->panel_described);
}

// timing.h: the limits of a mill are those of its profile; it settles nowhere
// and has no B.
TEST(CommandMarks, LimitsOfAMill) {
  machine::Parameters parameters = ParametersOf("t1a");
  ASSERT_TRUE(parameters.Set("TRAVEL_SPEED", 70.0));
  ASSERT_TRUE(parameters.Set("Z_SPEED_MAX", 30.0));
  ASSERT_TRUE(parameters.Set("ACCELERATION", 250.0));
  const Profile profile = MakeProfile(parameters).value();
  const motion::MachineLimits limits = MillLimits(profile);
  EXPECT_EQ(limits.tip_speed_mm_s, 70.0);
  EXPECT_EQ(limits.tip_acceleration_mm_s2, 250.0);
  EXPECT_EQ(limits.tip_jerk_mm_s3, std::numeric_limits<double>::infinity());
  EXPECT_EQ(limits.settling_s, 0.0);
  EXPECT_EQ(limits.axes.speed[0], 70.0);
  EXPECT_EQ(limits.axes.speed[1], 70.0);
  EXPECT_EQ(limits.axes.speed[2], 30.0);
  EXPECT_NEAR(limits.axes.speed[3], M_PI / 3.0, 1e-12);
  EXPECT_EQ(limits.axes.speed[4], 0.0);
  EXPECT_EQ(limits.axes.acceleration[2], 250.0);
  EXPECT_EQ(limits.axes.acceleration[4], 0.0);
  EXPECT_EQ(PoseOf(profile, {100, 200, -300, 90}).b_rad, 0.0);
  EXPECT_NEAR(PoseOf(profile, {100, 200, -300, 90}).a_rad, M_PI / 2.0, 1e-12);
}

// clipping.h: a point computed on a face lies on it exactly, on whatever line.
TEST(CommandMarks, CrossingsLieOnTheFaces) {
  const CuttingRange range{{0.3, 199.7}, {0.1, 150.9}, {-60.7, -0.1}};
  for (int k = 1; k < 200; ++k) {
    const Point low{-1.0 - 0.37 * k, 50, -20, 0};
    const Point high{200.0 + 0.71 * k, 51.3, -21.7, 0};
    for (const bool back : {false, true}) {
      const Pieces pieces =
          back ? Pieces::Cut(range, high, low, 1e-6) : Pieces::Cut(range, low, high, 1e-6);
      ASSERT_EQ(pieces.all().size(), 3U);
      const Piece& inside = pieces.all()[1];
      EXPECT_EQ(inside.region, Region::kInside);
      EXPECT_EQ((back ? inside.to : inside.from).x, 0.3) << k;
      EXPECT_EQ((back ? inside.from : inside.to).x, 199.7) << k;
    }
  }
}

}  // namespace
}  // namespace rmlcell::rml1
