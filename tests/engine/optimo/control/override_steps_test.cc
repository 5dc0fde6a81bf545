#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// The ten steps of the feed override while a program runs. OPT-4.34 to 4.40. A ramp over a change
// of speed v takes 2 sqrt(v / j) at the mean of both speeds; j is 40,000 mm/s3, less with ACCEL.
namespace rmlcell::optimo::testing::override_steps {
namespace {

using machine::InputKind;
using machine::Mode;

constexpr double kSteps[] = {10, 25, 40, 55, 70, 85, 100, 115, 130, 145};
// 500 mm along X at 50 mm/s.
const std::string kLine = "COORD ABSOL\nPATH LIN\nSPEED 10\n";
const std::string kFar = "MOVE (521.02,2201.2,-350.,0.,0.)\n";

double RampTime(double change_mm_s, double jerk = 40000.0) {
  return 2.0 * std::sqrt(change_mm_s / jerk);
}

machine::InputChange Override(double at_s, double percent) {
  return {At(at_s), InputKind::kOverride, 0, percent};
}

// OPT-4.34: each step is a share of the programmed speed: step 3 at SPEED 10 is 4 % of VMAX.
TEST(OverrideSteps, EachIsAShareOfTheProgrammedSpeed) {
  for (const double percent : kSteps) {
    const Ran ran = RunText(kLine + kFar, {.override_percent = percent});
    const double speed = 50.0 * percent / 100.0;
    ASSERT_EQ(ran.parts.size(), 1U);
    EXPECT_NEAR(ran.parts[0].SpeedAt(ran.parts[0].duration_s() / 2.0), speed, 1e-9) << percent;
    EXPECT_NEAR(ran.parts[0].done.programmed_mm_s, speed, 1e-9);
    EXPECT_NEAR(ran.moves[0].feed_mm_s, speed, 1e-9);
    EXPECT_NEAR(ran.time_s, 500.0 / speed + RampTime(speed) + kSettle_s, 1e-5) << percent;
  }
}

// OPT-4.34, motion.md 3.3: the axes bind after a change as they do before it. B turns by 2 rad over
// 500 mm, 300 mm below the column: at the tip's 500 mm/s the column would go at up to 1100 mm/s.
TEST(OverrideSteps, AfterAChangeTheColumnBindsAsBefore) {
  const std::string text = "COORD ABSOL\nPATH LIN\nMOVE (521.02,2201.2,-350.,0.,2.)\n";
  const Ran whole = RunText(text);
  const Ran raised = RunText(text, {.inputs = {Override(1.0, 100.0)}, .override_percent = 10.0});
  ASSERT_EQ(raised.parts.size(), 2U);
  const double bound = whole.parts[0].motion.speed.peak_speed();
  EXPECT_LT(bound, 400.0);
  EXPECT_NEAR(raised.parts[1].motion.speed.peak_speed(), bound, 1e-9);
}

// OPT-4.37: from step 7 to step 4 on the way, in every mode: from that instant on a ramp from 50 to
// 27.5 mm/s, with the active ACCEL.
TEST(OverrideSteps, AChangeActsAtOnceInEveryMode) {
  for (const Mode mode : {Mode::kRemote, Mode::kCycle, Mode::kSingle, Mode::kRepeat}) {
    for (const double accel : {100.0, 50.0}) {
      const double jerk = 400.0 * accel;
      machine::InputScript script;
      for (int n = 1; n <= 4; ++n) script.push_back({At(0.01 * n), InputKind::kStart});
      const double begin = mode == Mode::kSingle ? 0.04 : 0.0;
      script.push_back(Override(begin + 3.0, 55.0));
      script.push_back({At(40.0), InputKind::kHold});
      const std::string text = "COORD ABSOL\nPATH LIN\nSPEED 10\nACCEL " + std::to_string(accel) +
                               "\n" + kFar + "DELAY 100\n";
      const Ran ran = RunText(text, {.inputs = script, .mode = mode});
      SCOPED_TRACE(static_cast<int>(mode));
      ASSERT_GE(ran.parts.size(), 2U);
      EXPECT_NEAR(ToSeconds(ran.parts[0].done.end), begin + 3.0, 1e-9);
      EXPECT_NEAR(ran.parts[0].SpeedAt(3.0), 50.0, 1e-6);
      const double ramp = RampTime(22.5, jerk);
      EXPECT_NEAR(ran.parts[1].SpeedAt(0.5 * ramp), 38.75, 1e-6);
      EXPECT_NEAR(ran.parts[1].SpeedAt(ramp), 27.5, 1e-6);
      const double before = 50.0 * (3.0 - 0.5 * RampTime(50.0, jerk));
      const double left = 500.0 - before - 38.75 * ramp - 0.5 * 27.5 * RampTime(27.5, jerk);
      ASSERT_GE(ran.moves.size(), 1U);
      EXPECT_NEAR(ToSeconds(ran.moves[0].at),
                  begin + 3.0 + ramp + left / 27.5 + RampTime(27.5, jerk) + kSettle_s, 1e-4);
    }
  }
}

// OPT-4.40: at power-up it is 100 %, and neither the start of a program nor CALL, GO or a
// repetition changes it.
TEST(OverrideSteps, ProgramsDoNotChangeIt) {
  EXPECT_EQ(RunText("VI[2]=1\n").end.override_percent, 100.0);
  const std::string there = kLine + "MOVE (121.02,2201.2,-350.,0.,0.)\n";
  const std::string back = kLine + "MOVE (21.02,2201.2,-350.,0.,0.)\n";
  const Ran ran =
      RunText("DELAY 1\nCALL 45\n" + there + "GO 46\n",
              {.programs = {{45, there + back}, {46, back}}, .inputs = {Override(0.5, 40.0)}});
  ASSERT_EQ(ran.parts.size(), 4U);
  for (const Ran::Part& part : ran.parts) EXPECT_NEAR(part.SpeedAt(2.0), 20.0, 1e-9);
  EXPECT_EQ(ran.end.override_percent, 40.0);
  const Ran repeat = RunText(
      there + back,
      {.inputs = {Override(0.001, 40.0), {At(12.0), InputKind::kHold}}, .mode = Mode::kRepeat});
  ASSERT_GE(repeat.parts.size(), 4U);
  EXPECT_NEAR(repeat.parts.back().SpeedAt(1.0), 20.0, 1e-9);
}

// OPT-4.39: waiting is not motion: a DELAY, a WAIT and a pierce take their time at every step.
TEST(OverrideSteps, OnlyMotionIsSlower) {
  for (const double percent : {10.0, 145.0}) {
    const RunOptions options{.override_percent = percent};
    EXPECT_NEAR(RunText("DELAY 2\n", options).time_s, 2.0, 1e-9);
    EXPECT_NEAR(
        RunText("WORKDEF 1,0 (5.,80.,1.5,90.)\nWORK 1,0/ON\nWORK 1,0/OFF\n", options).time_s, 1.5,
        1e-9);
  }
  const Ran changed = RunText("DELAY 2\nOL[16]=ON\n", {.inputs = {Override(1.0, 10.0)}});
  EXPECT_NEAR(changed.First("OL[16] 1").at_s, 2.0, 1e-9);
}

// OPT-4.37, OPT-4.40: 0 and less are no step and change nothing.
TEST(OverrideSteps, NothingIsNoStep) {
  const double plain_s = RunText(kLine + kFar).time_s;
  for (const double none : {0.0, -10.0}) {
    const Ran ran = RunText(kLine + kFar, {.inputs = {Override(3.0, none)}});
    EXPECT_EQ(ran.time_s, plain_s);
    EXPECT_EQ(ran.end.override_percent, 100.0);
  }
}

// OPT-4.37: the last one of an instant counts.
TEST(OverrideSteps, TheLastOfAnInstantCounts) {
  const Ran two = RunText(kLine + kFar, {.inputs = {Override(3.0, 10.0), Override(3.0, 55.0)}});
  EXPECT_EQ(two.time_s, RunText(kLine + kFar, {.inputs = {Override(3.0, 55.0)}}).time_s);
  EXPECT_EQ(two.end.override_percent, 55.0);
  // Not so at two instants: 1 s at 10 %.
  const Ran after = RunText(kLine + kFar, {.inputs = {Override(3.0, 10.0), Override(4.0, 55.0)}});
  EXPECT_GT(after.time_s, two.time_s + 0.5);
}

// OPT-4.37: PTP moves and moves in COORD ROBOT go over to it as well: half the speed for the second
// half of the way.
TEST(OverrideSteps, ItActsOnPointToPoint) {
  for (const std::string path :
       {"COORD ROBOT\nSPEED 10\nMOVE (521.02,2201.2,-50.,0.,0.)\n",
        "COORD ABSOL\nPATH PTP\nSPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)\n"}) {
    const Ran ran = RunText(path, {.inputs = {Override(5.0, 55.0)}});
    const double ramp = RampTime(22.5);
    const double left =
        500.0 - 50.0 * (5.0 - 0.5 * RampTime(50.0)) - 38.75 * ramp - 0.5 * 27.5 * RampTime(27.5);
    EXPECT_NEAR(ran.time_s, 5.0 + ramp + left / 27.5 + RampTime(27.5) + kSettle_s, 1e-4) << path;
    EXPECT_NEAR(ran.end.tip.tip.x(), 521.02, 1e-4);
  }
}

// OPT-4.37: a /NEXT move, and the one behind a STOP, go over to it too.
TEST(OverrideSteps, ItActsInTheBackground) {
  const Ran ran = RunText(kLine + "MOVE (521.02,2201.2,-350.,0.,0.)/NEXT\nDELAY 5\nVR[0]=OA[0]\n",
                          {.inputs = {Override(3.0, 55.0)}, .variables = {"VR[0]"}});
  EXPECT_EQ(ran.variables.at("VR[0]"), "1.32");  // 27.5 x 0.048
}

}  // namespace
}  // namespace rmlcell::optimo::testing::override_steps
