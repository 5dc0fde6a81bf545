#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/engine/optimo/control/run_text.h"

// At which program and step things are told, while the program runs ahead of the motion or beside a
// WORK. New machines stand with the tip at (21.02, 2201.2, -350).
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;

MATCHER_P2(IsAt, program, step, "") { return arg.program == program && arg.step == step; }

// From where a new machine stands, along X at 50 mm/s; steps 1 to 3.
const std::string kAlongX = "COORD ABSOL\nPATH LIN\nSPEED 10\n";
std::string MoveTo(double x_mm, const std::string& attributes = {}) {
  return "MOVE (" + std::to_string(x_mm) + ",2201.2,-350.,0.,0.)" + attributes + "\n";
}

// OPT-2.49, OPT-B.28: what stands between two /FLY moves acts at the passage, and is told at its
// own step, not at the MOVE that the program has run ahead to.
TEST(PlaceRules, EffectsOfAPassageBelongToTheirSteps) {
  const Ran ran = RunText(kAlongX + "OL[11]=ON\n" + MoveTo(121.02) + MoveTo(221.02, "/FLY") +
                              "FUNCTION 44\n" + MoveTo(321.02) + "WORK 0,0/OFF\n",
                          {.programs = {{44, "WORK 0,0/ON\nOL[16]=ON\n"}}});
  EXPECT_THAT(ran.First("OL[11] 1"), IsAt(1, 4));
  EXPECT_THAT(ran.First("sensor on"), IsAt(1, 4));
  EXPECT_THAT(ran.First("shutter open"), IsAt(44, 1));
  EXPECT_THAT(ran.First("beam on 100.0"), IsAt(44, 1));
  EXPECT_THAT(ran.First("OL[16] 1"), IsAt(44, 2));
  EXPECT_THAT(ran.First("beam off"), IsAt(1, 9));
  EXPECT_NEAR(ran.BeamOnLength(), 100.0, 1e-4);  // literals have 24 bits
}

// OPT-3.21, OPT-B.28: the same for WORK 1 without delay, the analogue outputs and WORK 2.
TEST(PlaceRules, EveryKindOfEffectBelongsToItsStep) {
  const Ran ran =
      RunText("WORKDEF 1,0 (10.,80.,0.,50.)\nWORKDEF 2,0 (12)\n" + kAlongX +
              MoveTo(121.02, "/FLY") + "WORK 2,0/ON\nWORK 1,0/ON\nOA[5]=2.5\nOL[8]=ON\n" +
              MoveTo(221.02, "/FLY") + "WORK 1,0/OFF\n" + MoveTo(321.02) + "WORK 2,0/OFF\n");
  EXPECT_THAT(ran.First("schedule 12"), IsAt(1, 7));
  EXPECT_THAT(ran.First("shutter open"), IsAt(1, 8));
  EXPECT_THAT(ran.First("beam on 0.0"), IsAt(1, 8));
  EXPECT_THAT(ran.First("OA[5] 2.5"), IsAt(1, 9));
  EXPECT_THAT(ran.First("OL[8] 1"), IsAt(1, 10));
  EXPECT_THAT(ran.First("gas 2"), IsAt(1, 10));
  EXPECT_THAT(ran.First("beam off"), IsAt(1, 12));
}

// OPT-3.38, OPT-3.45: a WORK with /END goes on beside the program; the time of a DELAY is the
// DELAY's, before and after the beam goes off under it.
TEST(PlaceRules, ADelayBesideAWorkKeepsItsTime) {
  const Ran ran = RunText("OL[11]=ON\nWORK 0,0/ON/END (IL[20])\nDELAY 5\n",
                          {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
  ASSERT_EQ(ran.waits.size(), 2U);
  for (const machine::Wait& wait : ran.waits) EXPECT_THAT(wait.place, IsAt(1, 3));
  EXPECT_NEAR(ToSeconds(ran.waits[0].end), 1.008, 1e-9);  // 21 cycles
  EXPECT_NEAR(ToSeconds(ran.waits[1].end - ran.waits[0].start), 5.0, 1e-9);
  EXPECT_THAT(ran.First("beam off"), IsAt(1, 2));
}

// OPT-B.25: the warning of a reversal stands at the move whose /FLY it is, however far the program
// has run ahead.
TEST(PlaceRules, AReversalIsToldAtItsMove) {
  const Ran ran = RunText(kAlongX + MoveTo(121.02, "/FLY") + MoveTo(21.02, "/FLY") +
                          "VI[1]=1\nVI[2]=1\nMOVE (21.02,2201.2,-450.,0.,0.)\n");
  EXPECT_THAT(ran.First("E7316"), IsAt(1, 4));
}

// OPT-4.18, OPT-B.34: STOP inside a chain halts at the move under way; beam and START belong to it,
// and the program goes on from where it was.
TEST(PlaceRules, StopHaltsAtTheMoveUnderWay) {
  const Ran ran = RunText(kAlongX + "WORK 0,0/ON\n" + MoveTo(121.02, "/FLY") +
                              MoveTo(221.02, "/FLY") + MoveTo(321.02) + "WORK 0,0/OFF\nOL[16]=ON\n",
                          {.inputs = {{At(1.0), InputKind::kStop}, {At(9.0), InputKind::kStart}}});
  EXPECT_THAT(ran.First("halt STOP"), IsAt(1, 5));
  EXPECT_THAT(ran.First("beam off"), IsAt(1, 5));
  EXPECT_THAT(ran.First("OL[16] 1"), IsAt(1, 9));
  EXPECT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_EQ(ran.Count("beam on 100.0"), 2);
  EXPECT_NEAR(ran.moves.back().tip.tip.x(), 321.02, 1e-4);
}

// OPT-3.17: a door opened during a chain takes beam and shutter at the move under way.
TEST(PlaceRules, TheDoorClosesTheShutterAtTheMoveUnderWay) {
  const Ran ran = RunText(kAlongX + "WORK 0,0/ON\n" + MoveTo(121.02, "/FLY") +
                              MoveTo(221.02, "/FLY") + MoveTo(321.02) + "WORK 0,0/OFF\n",
                          {.inputs = {{At(1.0), InputKind::kDoor, 0, 1.0}}});
  EXPECT_THAT(ran.First("beam off"), IsAt(1, 5));
  EXPECT_THAT(ran.First("shutter closed"), IsAt(1, 5));
  EXPECT_NEAR(ran.First("beam off").at_s, 1.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
