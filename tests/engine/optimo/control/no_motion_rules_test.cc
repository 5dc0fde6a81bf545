#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/engine/optimo/control/run_text.h"

// A MOVE that could never end, because SPEED is 0 or ACCEL below 0.1, and has /TIME: it stands
// until the time runs out. New machines stand with the tip at (21.02, 2201.2, -350).
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;
using machine::OutcomeKind;
using machine::WaitKind;

// Steps 1 to 3, and a MOVE as step 4; at 900 a subroutine that sets VI[3].
std::string Standing(const std::string& attributes, const std::string& behind = {}) {
  return "COORD ABSOL\nPATH LIN\nSPEED 0\nMOVE (500.,2201.2,-350.,0,0)" + attributes + "\n" +
         behind + "ENDTASK\n900 VI[3]=VI[3]+1\nVI[4]=VI[2]\nRETURN\n";
}
const RunOptions kReadBoth{.variables = {"VI[2]", "VI[3]", "VI[4]"}};

void ExpectNoMotion(const Ran& ran) {
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_TRUE(ran.parts.empty());
  EXPECT_EQ(ran.end.tip.tip.x(), 21.02);
}

// OPT-B.22, OPT-2.54, OPT-2.55: nothing moves, the GOSUB is made when the time is over, and RETURN
// goes on behind the MOVE.
TEST(NoMotionRules, TheTimeRunsOut) {
  const Ran ran = RunText(Standing("/TIME (1000.,900)", "VI[2]=1\n"), kReadBoth);
  ExpectNoMotion(ran);
  EXPECT_NEAR(ran.time_s, 1000.032, 1e-9);  // 20834 cycles
  EXPECT_EQ(ran.variables.at("VI[3]"), "1");
  EXPECT_EQ(ran.variables.at("VI[4]"), "0");  // before the instruction behind the MOVE
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  ASSERT_EQ(ran.waits.size(), 1U);
  EXPECT_EQ(ran.waits[0].kind, WaitKind::kCondition);
  EXPECT_EQ(ran.waits[0].place.step, 4);
  EXPECT_NEAR(ToSeconds(ran.waits[0].end), 1000.032, 1e-9);
}

// OPT-B.22: the same with too little acceleration, in a circle and in a hole.
TEST(NoMotionRules, WhateverTheReasonAndThePath) {
  for (const char* text :
       {"COORD ABSOL\nPATH LIN\nACCEL 0.05\nMOVE (500.,2201.2,-350.,0,0)/TIME (1.,900)\n900 "
        "VI[3]=1\n",
        "COORD ABSOL\nPATH CIR\nSPEED 0\nMOVE (500.,2201.2,-350.,0,0)/VIA (300.,2300.,-350.,0,0)"
        "/TIME (1.,900)\n900 VI[3]=1\n",
        "COORD ABSOL\nPATH HOLE (5.)\nSPEED 0\nMOVE (500.,2201.2,-350.,0,0)"
        "/VIA (500.,2201.2,-250.,0,0)/TIME (1.,900)\n900 VI[3]=1\n",
        "SPEED 0\nMOVE (500.,2201.2,-350.,0,0)/TIME (1.,900)\n900 VI[3]=1\n"}) {
    const Ran ran = RunText(text, kReadBoth);
    ExpectNoMotion(ran);
    EXPECT_NEAR(ran.time_s, 1.008, 1e-9) << text;  // 21 cycles
    EXPECT_EQ(ran.variables.at("VI[3]"), "1") << text;
  }
}

// OPT-B.22, OPT-E.7307: without /TIME it is an error, also behind a /FLY move, which then stops.
TEST(NoMotionRules, WithoutATimeItIsAnError) {
  const Ran ran = RunText(Standing(""));
  EXPECT_EQ(CodeOf(ran), 7307);
  EXPECT_TRUE(ran.parts.empty());
  EXPECT_EQ(CodeOf(RunText(Standing("/END (IL[20])"))), 7307);
  const Ran chain = RunText(
      "COORD ABSOL\nPATH LIN\nMOVE (121.02,2201.2,-350.,0.,0.)/FLY\nSPEED 0\n"
      "MOVE (221.02,2201.2,-350.,0.,0.)\n");
  EXPECT_EQ(CodeOf(chain), 7307);
  EXPECT_EQ(chain.outcome.place.step, 5);
  EXPECT_NEAR(chain.end.tip.tip.x(), 121.02, 1e-4);
}

// OPT-2.58, OPT-B.30: /END ends it where it stands, at a tick of its own clock; no GOSUB then.
TEST(NoMotionRules, TheEndConditionEndsIt) {
  RunOptions options = kReadBoth;
  options.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}};
  const Ran ran = RunText(Standing("/TIME (10.,900)/END (IL[20])"), options);
  ExpectNoMotion(ran);
  EXPECT_NEAR(ran.time_s, 1.008, 1e-9);
  EXPECT_EQ(ran.variables.at("VI[3]"), "0");
}

// OPT-2.59, OPT-B.22: with /NEXT the program goes on; the GOSUB is made between two instructions,
// and the end of the program waits for it.
TEST(NoMotionRules, NextGoesOn) {
  const Ran ran = RunText(Standing("/TIME (2.,900)/NEXT", "DELAY 5\nVI[2]=1\n"), kReadBoth);
  ExpectNoMotion(ran);
  EXPECT_NEAR(ran.time_s, 5.0, 1e-9);
  EXPECT_EQ(ran.variables.at("VI[3]"), "1");
  EXPECT_EQ(ran.variables.at("VI[4]"), "0");
  const Ran waits = RunText(Standing("/TIME (2.,900)/NEXT", "VI[2]=1\n"), kReadBoth);
  EXPECT_NEAR(waits.time_s, 2.016, 1e-9);  // 42 cycles
  EXPECT_EQ(waits.variables.at("VI[3]"), "1");
  EXPECT_EQ(waits.variables.at("VI[4]"), "1");
}

// OPT-2.59: the next MOVE takes over, and the time counts no more.
TEST(NoMotionRules, TheNextMoveTakesOver) {
  const Ran ran = RunText(
      Standing("/TIME (2.,900)/NEXT", "SPEED 10\nMOVE (121.02,2201.2,-350.,0,0)\nDELAY 5\n"),
      kReadBoth);
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_NEAR(ran.end.tip.tip.x(), 121.02, 1e-4);
  EXPECT_EQ(ran.variables.at("VI[3]"), "0");
}

// OPT-2.48, OPT-B.22: behind a /FLY move it needs standstill: its target is reached.
TEST(NoMotionRules, BehindAFlyMove) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)/FLY\nSPEED 0\n"
      "MOVE (221.02,2201.2,-350.,0.,0.)/TIME (1.,900)\nENDTASK\n900 VI[3]=1\nRETURN\n",
      kReadBoth);
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_TRUE(ran.Told("E7304"));
  EXPECT_NEAR(ran.end.tip.tip.x(), 121.02, 1e-4);
  EXPECT_EQ(ran.variables.at("VI[3]"), "1");
  ASSERT_EQ(ran.parts.size(), 1U);
  EXPECT_NEAR(ran.time_s, ToSeconds(ran.parts[0].done.end) + 1.008, 1e-9);
}

// OPT-4.18, OPT-2.54: STOP halts it at once; START goes on with the time that was left.
TEST(NoMotionRules, StopHaltsIt) {
  RunOptions options = kReadBoth;
  options.inputs = {{At(1.0), InputKind::kStop}, {At(2.0), InputKind::kStart}};
  const Ran ran = RunText(Standing("/TIME (5.,900)"), options);
  ExpectNoMotion(ran);
  EXPECT_NEAR(ran.First("halt STOP").at_s, 1.0, 1e-9);
  EXPECT_NEAR(ran.time_s, 6.04, 1e-9);  // 105 cycles, and 1 s of the halt
  EXPECT_THAT(ran.told, ::testing::ElementsAre("compiling 1", "wait condition 1.0", "halt STOP",
                                               "wait operator 1.0", "wait condition 4.04"));
}

// OPT-3.53: an error of its /END is caught like any other; nothing is left of the MOVE.
TEST(NoMotionRules, AnErrorOfItsEndCondition) {
  const Ran ran = RunText(
      "COORD ABSOL\nPATH LIN\nSPEED 0\nERR 800\nVI[5]=1\n"
      "MOVE (500.,2201.2,-350.,0,0)/TIME (9.,900)/NEXT/END (1/VI[5] > 2)\n"
      "VI[5]=0\nDELAY 1\nENDTASK\n800 VI[2]=VI[99]\nENDTASK\n900 VI[3]=1\nRETURN\n",
      kReadBoth);
  ExpectNoMotion(ran);
  EXPECT_EQ(ran.variables.at("VI[2]"), "7201");
  EXPECT_EQ(ran.variables.at("VI[3]"), "0");
}

// OPT-B.22, OPT-2.54: a SPEED above 0 that never arrives is none, either: /TIME runs out where it
// stands, and without a time it is an error.
TEST(NoMotionRules, ASpeedThatNeverArrives) {
  const std::string move = "COORD ABSOL\nPATH LIN\nSPEED 1E-12\nMOVE (500.,2201.2,-350.,0.,0.)";
  const Ran ran = RunText(move + "/TIME (1.,900)\nENDTASK\n900 VI[3]=1\nRETURN\n", kReadBoth);
  ExpectNoMotion(ran);
  EXPECT_NEAR(ran.time_s, 1.008, 1e-9);  // 21 cycles
  EXPECT_EQ(ran.variables.at("VI[3]"), "1");
  EXPECT_EQ(CodeOf(RunText(move + "\n")), 7307);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
