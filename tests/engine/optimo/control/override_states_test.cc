#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/measured.h"
#include "tests/engine/optimo/control/run_text.h"

// The feed override changed while the machine stands, brakes or settles, and what is told then.
// motion.md 6, OPT-4.34 to 4.40
namespace rmlcell::optimo::testing::override_states {
namespace {

using machine::InputKind;

// A ramp over a change of speed with a jerk of 40,000 mm/s3.
double RampTime(double change_mm_s) { return 2.0 * std::sqrt(change_mm_s / 40000.0); }

machine::InputChange Input(double at_s, InputKind kind, double value = 0.0) {
  return {At(at_s), kind, 0, value};
}

// Three corners of 90 degrees, legs of 100 mm at 50 mm/s. At 25 mm/s the corners are those of case
// C02.
const std::string kCorners =
    kThere +
    "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)/FLY\n"
    "MOVE (1200.,1100.,-400.,0.,0.)/FLY\nMOVE (1200.,1200.,-400.,0.,0.)\n";
const motion::MachineVector kFirst{1100.0, 1000.0, -400.0};
const motion::MachineVector kSecond{1100.0, 1100.0, -400.0};
const motion::MachineVector kThird{1200.0, 1100.0, -400.0};
constexpr double kAt25_mm = 0.480425146;
const double kLeg_s = 100.0 / 50.0 + RampTime(50.0) + kSettle_s;

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

// OPT-4.17, motion.md 6: what a HOLD has kept back is planned with the override of its START.
TEST(OverrideStates, WhileHoldKeepsMovesBack) {
  const double begin = BeginOf(kCorners);
  const Ran ran = RunText(kCorners, {.inputs = {Input(begin + 1.0, InputKind::kHold),
                                                Input(begin + 10.0, InputKind::kOverride, 50.0),
                                                Input(begin + 20.0, InputKind::kStart)}});
  EXPECT_NEAR(ran.First("halt HOLD").at_s, begin + kLeg_s, 1e-6);
  EXPECT_NEAR(ran.DistanceTo(kSecond), kAt25_mm, 1e-4);
  EXPECT_NEAR(ran.DistanceTo(kThird), kAt25_mm, 1e-4);
  EXPECT_NEAR(ran.moves.back().feed_mm_s, 25.0, 1e-9);
}

// motion.md 6: on the way to the target of a HOLD the move goes on as it is; what is behind it
// follows the new value.
TEST(OverrideStates, OnTheWayToTheTargetOfAHold) {
  const double begin = BeginOf(kCorners);
  const Ran ran = RunText(kCorners, {.inputs = {Input(begin + 1.0, InputKind::kHold),
                                                Input(begin + 1.5, InputKind::kOverride, 50.0),
                                                Input(begin + 20.0, InputKind::kStart)}});
  EXPECT_NEAR(ran.First("halt HOLD").at_s, begin + kLeg_s, 1e-6);
  EXPECT_LT(ran.DistanceTo(kFirst), 1e-9);
  EXPECT_NEAR(ran.DistanceTo(kSecond), kAt25_mm, 1e-4);
  EXPECT_NEAR(ran.DistanceTo(kThird), kAt25_mm, 1e-4);
}

// OPT-4.37, OPT-4.17: a chain that goes on with another override, and is held then: the value
// stays.
TEST(OverrideStates, BeforeAHold) {
  const double begin = BeginOf(kCorners);
  const Ran ran = RunText(kCorners, {.inputs = {Input(begin + 0.5, InputKind::kOverride, 50.0),
                                                Input(begin + 1.5, InputKind::kHold),
                                                Input(begin + 20.0, InputKind::kStart)}});
  EXPECT_EQ(ran.First("halt HOLD").step, 5);
  EXPECT_LT(ran.DistanceTo(kFirst), 1e-9);
  EXPECT_NEAR(ran.DistanceTo(kSecond), kAt25_mm, 1e-4);
  EXPECT_NEAR(ran.DistanceTo(kThird), kAt25_mm, 1e-4);
  EXPECT_NEAR(ran.moves.back().feed_mm_s, 25.0, 1e-9);
}

// OPT-4.37: twice within one leg; the second counts, and again of the speed that was programmed.
TEST(OverrideStates, TwiceWithinALeg) {
  const double begin = BeginOf(kCorners);
  const Ran ran = RunText(kCorners, {.inputs = {Input(begin + 0.5, InputKind::kOverride, 25.0),
                                                Input(begin + 0.8, InputKind::kOverride, 50.0)}});
  EXPECT_NEAR(ran.DistanceTo(kFirst), kAt25_mm, 1e-4);
  EXPECT_NEAR(ran.DistanceTo(kThird), kAt25_mm, 1e-4);
  EXPECT_NEAR(ran.moves.back().feed_mm_s, 25.0, 1e-9);
}

// motion.md 6: /END is true at the tick of 2.016 s: 50 mm/s x 2.016 s are behind the machine where
// it stands, and no override changes that ramp.
TEST(OverrideStates, TheRampOfEndIsNotChanged) {
  const std::string text = kAbsol + "SPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/END (IL[5]=1)\n";
  for (const double percent : {10.0, 145.0}) {
    const Ran ran = RunText(text, {.inputs = {{At(2.0), InputKind::kLogical, 5, 1.0},
                                              Input(2.03, InputKind::kOverride, percent)}});
    ASSERT_EQ(ran.moves.size(), 1U);
    EXPECT_NEAR(ToSeconds(ran.moves[0].at), 2.016 + RampTime(50.0), 1e-6) << percent;
    EXPECT_NEAR(ran.moves[0].tip.tip.x(), 21.02 + 50.0 * 2.016, 1e-6) << percent;
  }
}

// motion.md 6: a machine that has arrived only settles.
TEST(OverrideStates, WhileItSettlesNothingChanges) {
  const std::string text = kAbsol + "SPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)\n";
  const Ran ran = RunText(text, {.inputs = {Input(2.09, InputKind::kOverride, 10.0)}});
  EXPECT_NEAR(ran.time_s, kLeg_s, 1e-6);
  EXPECT_EQ(ran.parts.size(), 1U);
}

// OPT-4.34: there is no step of 0 %, nor one below.
TEST(OverrideStates, ZeroIsNone) {
  const std::string text = kAbsol + "SPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)\n";
  for (const double percent : {0.0, -10.0}) {
    const Ran ran = RunText(text, {.inputs = {Input(1.0, InputKind::kOverride, percent)}});
    EXPECT_NEAR(ran.time_s, kLeg_s, 1e-6) << percent;
    EXPECT_EQ(ran.parts.size(), 1U) << percent;
    EXPECT_EQ(ran.end.override_percent, 100.0) << percent;
  }
}

// OPT-4.34: the share of a speed that is very low itself: 0.1 mm at 0.0005 mm/s, the second half of
// it at half of that.
TEST(OverrideStates, OfTheLowestSpeeds) {
  const Ran ran = RunText(kAbsol + "SPEED 0.0001\nMOVE (21.12,2201.2,-350.,0.,0.)\n",
                          {.inputs = {Input(100.0, InputKind::kOverride, 50.0)}});
  EXPECT_NEAR(ran.time_s, 100.0 + 200.0, 0.1);
}

// motion.md 3.3: the head in use binds after a change as before it: B turns by 2 rad over 500 mm,
// so the column goes the faster the longer head and tool are.
TEST(OverrideStates, TheLengthOfHeadAndToolBinds) {
  for (const std::string tool : {"", "TCP (0.,0.,-200.,0.,0.,-300.)\n"}) {
    for (const std::string length : {"300", "600"}) {
      const std::string text =
          "COORD ABSOL\nPATH LIN\n" + tool + "MOVE (1000.,2200.,-350.,0.,0.)\n";
      const std::string turning = text + "MOVE (1500.,2200.,-350.,0.,2.)\n";
      const double begin =
          RunText(text, {.parameters = {{"HEAD_LENGTH", length}}, .override_percent = 10.0}).time_s;
      const Ran whole = RunText(turning, {.parameters = {{"HEAD_LENGTH", length}}});
      const Ran raised =
          RunText(turning, {.inputs = {Input(begin + 1.0, InputKind::kOverride, 100.0)},
                            .parameters = {{"HEAD_LENGTH", length}},
                            .override_percent = 10.0});
      EXPECT_NEAR(raised.parts.back().motion.speed.peak_speed(),
                  whole.parts.back().motion.speed.peak_speed(), 1e-9)
          << tool << length;
    }
  }
}

// motion.md 3.3, 5.1: lower and higher, at any time of a move whose head turns: no axis is asked
// for more than it can do, though at a lower speed it could have more acceleration.
TEST(OverrideStates, TheAxesKeepTheirLimits) {
  const std::string text = kAbsol + "MOVE (221.02,2201.2,-350.,0.,2.)\n";
  const double whole_s = RunText(text).time_s;
  for (const double percent : {10.0, 55.0, 145.0}) {
    for (int k = 1; k < 12; ++k) {
      const Ran ran =
          RunText(text, {.inputs = {Input(whole_s * k / 12.0, InputKind::kOverride, percent)}});
      ExpectWithinLimits(ran, true, std::to_string(percent) + " at " + std::to_string(k));
    }
  }
}

// OPT-4.34: in COORD ROBOT no feed rate is told, whatever the override becomes.
TEST(OverrideStates, PointToPointHasNoFeedRate) {
  const Ran ran = RunText(
      "SPEED 10\nMOVE (121.02,2201.2,-50.,0.,0.)/FLY\nMOVE (221.02,2201.2,-50.,0.,0.)/FLY\n"
      "MOVE (221.02,2101.2,-50.,0.,0.)\n",
      {.inputs = {Input(1.0, InputKind::kOverride, 50.0)}});
  ASSERT_EQ(ran.moves.size(), 3U);
  for (const machine::MoveDone& move : ran.moves) EXPECT_EQ(move.feed_mm_s, 0.0);
  for (const Ran::Part& part : ran.parts) EXPECT_EQ(part.done.programmed_mm_s, 0.0);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::override_states
