// Keys while a chain of /FLY moves is under way, where little decides: the last move, the room that
// is just enough, moves too slow or too short to matter much.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/measured.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::keys_on_the_way {
namespace {

using machine::InputKind;
using machine::RunPhase;

double RampTime(double change_mm_s) { return 2.0 * std::sqrt(change_mm_s / 40000.0); }

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

Ran Held(const std::string& text, double hold_s, double start_s) {
  return RunText(text,
                 {.inputs = {{At(hold_s), InputKind::kHold}, {At(start_s), InputKind::kStart}}});
}

// From (1000,1000,-400) on, at this SPEED, along X and round a corner of 90 degrees.
std::string Corner(const std::string& speed, double leg_mm) {
  const std::string x = std::to_string(1000.0 + leg_mm);
  return kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED " + speed + "\nMOVE (" + x +
         ",1000.,-400.,0.,0.)/FLY\nMOVE (" + x + "," + std::to_string(1000.0 + leg_mm) +
         ",-400.,0.,0.)\n";
}

// Steps 5 and on: moves of 1 mm along X at 200 mm/s.
std::string ShortMoves(int count) {
  std::string text = kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n";
  for (int k = 1; k <= count; ++k) {
    text += "MOVE (" + std::to_string(1000 + k) + ".,1000.,-400.,0.,0.)";
    text += k < count ? "/FLY\n" : "\n";
  }
  return text;
}

// OPT-4.17: at 0.5 mm/s, 0.5 mm before the target: the machine can come to rest on it, and does.
TEST(KeysOnTheWay, HoldOnAMoveThatCreeps) {
  const std::string text = Corner(".1", 1.0);
  const double begin = BeginOf(text);
  const Ran ran = Held(text, begin + 1.0, begin + 9.0);
  EXPECT_EQ(ran.First("halt HOLD").step, 5);
  ASSERT_EQ(ran.moves.size(), 3U);
  EXPECT_LT(ToSeconds(ran.moves[1].at), begin + 9.0);
  EXPECT_NEAR((ran.moves[1].tip.tip - motion::MachinePoint(1001.0, 1000.0, -400.0)).norm(), 0.0,
              1e-9);
  EXPECT_NEAR(ran.end.tip.tip.y(), 1001.0, 1e-9);
}

// OPT-4.17: from 200 mm/s the machine comes to rest in 15 mm, and 15.01 mm are left.
TEST(KeysOnTheWay, HoldWithJustTheRoomToBrake) {
  const std::string text = kAbsol +
                           "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n"
                           "MOVE (1200.,1000.,-400.,0.,0.)/FLY\n"
                           "MOVE (1205.,1000.,-400.,0.,0.)/FLY\nMOVE (1255.,1000.,-400.,0.,0.)\n";
  const double begin = BeginOf(text);
  const double hold = begin + 0.075 + (200.0 - 15.01) / 200.0;
  const Ran ran = Held(text, hold, begin + 9.0);
  EXPECT_EQ(ran.First("halt HOLD").step, 5);
  EXPECT_NEAR(ran.First("halt HOLD").at_s, hold + 0.01 / 200.0 + 0.15 + kSettle_s, 1e-5);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1255.0, 1e-9);
}

// OPT-4.17, OPT-4.38: HOLD on the last move of a chain changes nothing of it: another override acts
// on it at once, as it would without that key.
TEST(KeysOnTheWay, AnOverrideBehindAHoldOnTheLastMove) {
  const std::string text = Corner("10", 100.0);
  const double begin = BeginOf(text);
  const machine::InputChange slower{At(begin + 3.0), InputKind::kOverride, 0, 50.0};
  const Ran plain = RunText(text, {.inputs = {slower}});
  const Ran held = RunText(text, {.inputs = {{At(begin + 2.5), InputKind::kHold},
                                             slower,
                                             {At(begin + 20.0), InputKind::kStart}}});
  ASSERT_EQ(held.moves.size(), 3U);
  EXPECT_GT(plain.moves.back().at, RunText(text).moves.back().at);
  EXPECT_EQ(held.moves.back().at, plain.moves.back().at);
}

// OPT-4.17: HOLD at 132 mm/s while the machine still gains speed over moves too short to end that
// on one of them: at rest it is 26 mm on the way at the earliest, and a few moves on at the latest.
TEST(KeysOnTheWay, HoldWhileShortMovesGainSpeed) {
  const std::string text = ShortMoves(200);
  const double begin = BeginOf(text);
  const Ran ran = Held(text, begin + 0.0908, begin + 3.0);
  const int target = ran.First("halt HOLD").step - 4;
  EXPECT_GE(target, 26);
  EXPECT_LE(target, 35);
  EXPECT_LT(ran.First("halt HOLD").at_s, begin + 1.0);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1200.0, 1e-6);
  ExpectWithinLimits(ran, true, "HOLD at 0.0908 s");
}

// OPT-4.18, OPT-2.44: stopped half a millimetre before the bend, which begins 4.05 mm before the
// corner: too near to reach 50 mm/s again before it, and yet the corner keeps the shape of that.
TEST(KeysOnTheWay, AStopJustBeforeABendKeepsItsShape) {
  const std::string text = Corner("10", 100.0);
  const double ramp_mm = 25.0 * RampTime(50.0);
  const double stop = BeginOf(text) + (100.0 - 4.05 - 0.5 - ramp_mm) / 50.0 + 0.5 * RampTime(50.0);
  const Ran ran = RunText(
      text, {.inputs = {{At(stop), InputKind::kStop}, {At(stop + 5.0), InputKind::kStart}}});
  EXPECT_EQ(ran.Count("halt STOP"), 1);
  EXPECT_NEAR(ran.DistanceTo({1100.0, 1000.0, -400.0}), 1.358847515, 1e-4);
}

// OPT-4.38: 0.5 mm before the end of a move another override acts at once, not with the next move:
// from 5 to 2.5 mm/s in 0.016 s.
TEST(KeysOnTheWay, AnOverrideNearTheEndOfASlowMove) {
  const std::string text = kAbsol +
                           "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 1\n"
                           "MOVE (1010.,1000.,-400.,0.,0.)/FLY\nMOVE (1020.,1000.,-400.,0.,0.)\n";
  const double change = BeginOf(text) + 0.5 * RampTime(5.0) + 9.5 / 5.0;
  const auto run = RunOfText(text);
  run->Advance(At(change));
  EXPECT_NEAR(run->state().tip_speed_mm_s, 5.0, 1e-9);
  run->Apply({.kind = InputKind::kOverride, .value = 50.0});
  run->Advance(At(change + 0.03));
  EXPECT_NEAR(run->state().tip_speed_mm_s, 2.5, 1e-6);
}

// OPT-4.37: any share above nothing is one, however small.
TEST(KeysOnTheWay, AnOverrideOfLessThanOnePercent) {
  EXPECT_EQ(RunText("DELAY 2\n", {.inputs = {{At(1.0), InputKind::kOverride, 0, 0.5}}})
                .end.override_percent,
            0.5);
}

// What is told of a motion lasts: not so a part before the beam that goes on where it begins.
TEST(KeysOnTheWay, ABeamThatGoesOnWithAMotionCutsNothingOff) {
  const Ran ran = RunText(kThere +
                          "MOVE (1100.,1000.,-400.,0.,0.)/NEXT\nWORK 0,0/ON\nDELAY 5\n"
                          "WORK 0,0/OFF\n");
  ASSERT_EQ(ran.parts.size(), 2U);
  EXPECT_TRUE(ran.parts[1].done.beam_on);
  for (const Ran::Part& part : ran.parts) EXPECT_GT(part.done.end, part.done.start);
}

// A /FLY chain of 80 moves round a square of 1 mm, of which the planner decides a part only, and a
// way out of it.
const std::string kRounds =
    kThere +
    "10 MOVE (1001.,1000.,-400.,0.,0.)/FLY\nMOVE (1001.,1001.,-400.,0.,0.)/FLY\n"
    "MOVE (1000.,1001.,-400.,0.,0.)/FLY\nMOVE (1000.,1000.,-400.,0.,0.)/FLY\n"
    "VI[2]=VI[2]+1\nIF VI[2] < 20 THEN 10\nMOVE (1100.,1000.,-400.,0.,0.)\n";

// OPT-6.42, LIVE-5.06: halted by either key while the program has run ahead in a chain that is not
// decided to its end, the machine may be moved, and goes on from there to the last target.
TEST(KeysOnTheWay, AChainThatIsNotDecidedMayBeMoved) {
  const double begin = BeginOf(kRounds);
  for (const InputKind key : {InputKind::kStop, InputKind::kHold}) {
    const auto run = RunOfText(kRounds);
    run->Advance(At(begin + 0.3));
    run->Apply({.kind = key});
    ASSERT_EQ(run->Advance(At(begin + 20.0)), RunPhase::kHalted);
    ASSERT_TRUE(run->may_be_moved());
    motion::AxisPose axes = run->state().axes;
    axes.column.z() += 20.0;
    run->MoveTo(axes);
    run->Apply({.kind = InputKind::kStart});
    EXPECT_EQ(run->Advance(At(begin + 100.0)), RunPhase::kFinished);
    EXPECT_NEAR((run->state().tip.tip - motion::MachinePoint(1100.0, 1000.0, -400.0)).norm(), 0.0,
                1e-4);
    EXPECT_EQ(run->ReadVariable("VI[2]")->text, "20");
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing::keys_on_the_way
