#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// A run that is ended from outside: what went on is told up to that instant, as what it was, at the
// step that the machine was at. New machines stand with the tip at (21.02, 2201.2, -350).
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;
using machine::WaitKind;

RunOptions EmergencyAt(double seconds) {
  return {.inputs = {{At(seconds), InputKind::kEmergencyStop}}};
}

RunOptions AtMost(std::chrono::seconds time) { return {.budget = {.virtual_time = time}}; }

void ExpectOneWait(const Ran& ran, WaitKind kind, double seconds, int step) {
  ASSERT_EQ(ran.waits.size(), 1U);
  EXPECT_EQ(ran.waits[0].kind, kind);
  EXPECT_NEAR(ToSeconds(ran.waits[0].end - ran.waits[0].start), seconds, 1e-9);
  EXPECT_EQ(ran.waits[0].place.step, step);
  EXPECT_EQ(ran.outcome.place.step, step);
}

// OPT-E.7610, OPT-3.45: the part of a DELAY before the emergency stop is dwell.
TEST(BreakOffRules, AnEmergencyStopCutsADwell) {
  ExpectOneWait(RunText("OL[11]=ON\nDELAY 5\n", EmergencyAt(2.0)), WaitKind::kDwell, 2.0, 2);
}

// OPT-E.7610, OPT-3.21: so it is with the dwell of WORK 1, under the beam.
TEST(BreakOffRules, AnEmergencyStopCutsAPierce) {
  const Ran ran = RunText("WORKDEF 1,0 (8.,75.,3.,50.)\nWORK 1,0/ON\n", EmergencyAt(2.0));
  ExpectOneWait(ran, WaitKind::kPierce, 2.0, 2);
  EXPECT_TRUE(ran.waits[0].beam_on);
  EXPECT_EQ(ran.waits[0].power_percent, 50.0);
  EXPECT_EQ(ran.Count("beam off"), 1);
}

// OPT-E.7902: what a budget cuts off is told, too: a DELAY, a WAIT, the /START of a MOVE.
TEST(BreakOffRules, TheTimeBudgetCutsWaits) {
  const RunOptions three = AtMost(std::chrono::seconds(3));
  ExpectOneWait(RunText("OL[11]=ON\nDELAY 5\n", three), WaitKind::kDwell, 3.0, 2);
  ExpectOneWait(RunText("OL[11]=ON\nWAIT IL[20]\n", three), WaitKind::kCondition, 3.0, 2);
  ExpectOneWait(RunText("COORD ABSOL\nMOVE (121.02,2201.2,-350.,0.,0.)/START (IL[20])\n", three),
                WaitKind::kCondition, 3.0, 2);
}

// OPT-B.67, OPT-E.7902: a WAIT that nothing can end lasts until the budget, and the outcome says
// so; it costs no more than one look.
TEST(BreakOffRules, AWaitThatNothingCanEnd) {
  const std::string never = "it waits for a condition, and no input is to come";
  const RunOptions month = AtMost(std::chrono::hours(24 * 30));
  EXPECT_TRUE(RunText("WAIT IL[20]\n", month).outcome.detail.ends_with(never));
  EXPECT_FALSE(RunText("DELAY 9E6\n", month).outcome.detail.ends_with(never));
}

// OPT-E.7902, OPT-2.49: a motion is told up to the budget; the place is that of the move under way,
// not of the one that the program has run ahead to.
TEST(BreakOffRules, TheTimeBudgetCutsAMotion) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/FLY\n"
      "MOVE (821.02,2201.2,-350.,0.,0.)/FLY\nMOVE (921.02,2201.2,-350.,0.,0.)\n",
      AtMost(std::chrono::seconds(3)));
  EXPECT_EQ(CodeOf(ran), 7902);
  ASSERT_EQ(ran.parts.size(), 1U);
  EXPECT_NEAR(ran.parts[0].duration_s(), 3.0, 1e-9);
  // 3 s at 50 mm/s, less half of the ramp.
  EXPECT_NEAR(ran.parts[0].done.travelled, 150.0 - 50.0 * std::sqrt(50.0 / 40000.0), 1e-6);
  EXPECT_NEAR(ran.end.tip.tip.x(), 21.02 + ran.parts[0].done.travelled, 1e-6);
  EXPECT_EQ(ran.outcome.place.step, 4);
}

// OPT-E.7610, OPT-4.18: an emergency stop in a chain is at the move under way, too.
TEST(BreakOffRules, AnEmergencyStopIsAtTheMoveUnderWay) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nWORK 0,0/ON\nMOVE (521.02,2201.2,-350.,0.,0.)/FLY\n"
      "MOVE (821.02,2201.2,-350.,0.,0.)\nWORK 0,0/OFF\n",
      EmergencyAt(2.0));
  EXPECT_EQ(ran.outcome.place.step, 5);
  EXPECT_EQ(ran.First("beam off").step, 5);
  EXPECT_EQ(ran.First("shutter closed").step, 5);
}

// OPT-3.49: the end of a halted run ends the wait for the operator.
TEST(BreakOffRules, AHaltIsAWaitForTheOperator) {
  ExpectOneWait(RunText("OL[11]=ON\nSTOP\n", EmergencyAt(4.0)), WaitKind::kOperator, 4.0, 2);
}

// OPT-2.59: a DELAY beside a motion of /NEXT: that time is the motion's.
TEST(BreakOffRules, TimeBesideAMotionIsTheMotions) {
  const Ran ran =
      RunText("COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02,2201.2,-350.,0.,0.)/NEXT\nDELAY 5\n",
              EmergencyAt(2.0));
  EXPECT_TRUE(ran.waits.empty());
  ASSERT_EQ(ran.parts.size(), 1U);
  EXPECT_NEAR(ran.parts[0].duration_s(), 2.0, 1e-9);
  EXPECT_EQ(ran.outcome.place.step, 5);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
