// What happens at one and the same instant, and what is looked at there: keys, ticks, errors that
// are told when the machine has come to rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::instant_rules {
namespace {

using machine::InputKind;

constexpr double kCycle_s = 0.048;

double RampTime(double change_mm_s) { return 2.0 * std::sqrt(change_mm_s / 40000.0); }

// 100 mm at 50 mm/s, from rest to rest and settled.
double MoveTime() { return 2.0 + RampTime(50.0) + kSettle_s; }

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

// LIVE-3.05, OPT-6.31: START at the very instant at which a step ends is for the halt behind it.
TEST(InstantRules, StartWhereAStepEnds) {
  const Ran ran = RunText("DELAY 1\nDELAY 1\nDELAY 1\n",
                          {.inputs = {{At(1.0), InputKind::kStart}, {At(2.0), InputKind::kStart}},
                           .mode = machine::Mode::kSingle});
  EXPECT_EQ(ran.told,
            (std::vector<std::string>{"compiling 1", "wait dwell 1.0", "halt SINGLE",
                                      "wait dwell 1.0", "halt SINGLE", "wait dwell 1.0"}));
  EXPECT_EQ(ran.time_s, 3.0);
}

// OPT-B.30: a condition that is false at the instruction is tested again a cycle later, not at the
// same instant.
TEST(InstantRules, AWorkIsTestedAgainACycleLater) {
  const Ran start =
      RunText("WORK 0,0/ON/START (VL[1])/NEXT\nVL[1]=ON\nDELAY 0\nDELAY 1\nWORK 0,0/OFF\n");
  EXPECT_NEAR(start.First("beam on 100.0").at_s, kCycle_s, 1e-9);
  const Ran end = RunText("WORK 0,0/ON/END (VL[1])\nVL[1]=ON\nDELAY 0\nDELAY 1\nWORK 0,0/OFF\n");
  EXPECT_NEAR(end.First("beam off").at_s, kCycle_s, 1e-9);
}

// OPT-B.89, motion.md 6: a MOVE takes over from that of /NEXT at the next tick, but where that ends
// before the tick it begins there.
TEST(InstantRules, AMotionThatEndsBeforeItIsTakenOver) {
  const std::string next = kThere + "MOVE (1100.,1000.,-400.,0.,0.)/NEXT\n";
  const double begin = BeginOf(next);
  const double end = begin + MoveTime();
  const double tick = std::floor(end / kCycle_s) * kCycle_s;
  ASSERT_GT(end - tick, 2e-3);
  const std::string delay = std::to_string((tick + end) / 2.0 - begin);
  const Ran ran = RunText(next + "DELAY " + delay + "\nMOVE (1100.,1100.,-400.,0.,0.)\n");
  ASSERT_EQ(ran.moves.size(), 3U);
  EXPECT_NEAR(ToSeconds(ran.moves[1].at), end, 1e-6);
  EXPECT_NEAR(ToSeconds(ran.moves[2].at), end + MoveTime(), 1e-6);
}

// OPT-3.58: an error of a WORK in the background is told when the machine stands, and is that of
// the WORK, whatever is in execution.
TEST(InstantRules, AnErrorInTheBackgroundIsThatOfItsWork) {
  const Ran ran = RunText(
      "VR[1]=1.\nWORK 0,0/ON/START (1./VR[1] > 2.)/NEXT\nVR[1]=0.\n"
      "MOVE (521.02,2201.2,-50.,0.,0.)\n");
  EXPECT_EQ(CodeOf(ran), 7201);
  EXPECT_EQ(ran.Finding(7201).step, 2);
  EXPECT_EQ(ran.outcome.place.step, 2);
  EXPECT_GT(ran.First("E7201").at_s, kCycle_s);
  EXPECT_LT(ran.end.axes.column.x(), 500.0);
}

// OPT-B.22: a MOVE that never moves stands to the end of its /TIME, however long that is: nothing
// that comes before could end it.
TEST(InstantRules, StandingForYearsIsOverAtOnce) {
  constexpr double kYears_s = 3e8;  // a whole number of cycles
  const Ran ran = RunText(kAbsol +
                              "SPEED 0\nMOVE (1100.,1000.,-400.,0.,0.)/TIME (300000000.,900)"
                              "/END (IL[20])\nENDTASK\n900 VI[2]=1\nRETURN\n",
                          {.variables = {"VI[2]"},
                           .budget = {.virtual_time = At(2.0 * kYears_s)},
                           .slice = At(2.0 * kYears_s)});
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_NEAR(ran.time_s, kYears_s, 1e-3);
}

// What has not happened has no place: a beam without power that is on while the machine settles
// goes no way.
TEST(InstantRules, NoWayIsNoMisdeed) {
  const std::string text = kThere +
                           "WORKDEF 1,1 (50.,0.,0.,0.)\nWORK 1,1/ON/START (IL[20])/NEXT\n"
                           "MOVE (1100.,1000.,-400.,0.,0.)\nWORK 1,1/OFF\nDELAY 1\n";
  const double settles = BeginOf(text) + MoveTime() - 0.5 * kSettle_s;
  const RunOptions options{.inputs = {{At(settles), InputKind::kLogical, 20, 1.0}}};
  EXPECT_NEAR(RunText(text, options).First("beam on 0.0").at_s, settles, 1e-9);
  machine::RunObserver nobody;
  const auto run = *OptimoFamily().NewRun(SetupOf(text, options), nobody);
  while (run->Advance(At(100.0)) == machine::RunPhase::kRunning) {
  }
  const auto figures = run->figures();
  const auto found = std::ranges::find(figures, "no_power_length", &machine::Figure::name);
  ASSERT_NE(found, figures.end());
  EXPECT_EQ(found->value, 0.0);
  EXPECT_EQ(found->first, machine::Place{});
}

}  // namespace
}  // namespace rmlcell::optimo::testing::instant_rules
