// Motions that are taken up behind a halt: a hole to whose circle the machine goes back, a motion
// of /NEXT that only had to settle.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/machine/step_entry.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::taken_up {
namespace {

using machine::InputKind;
using machine::RunPhase;

double RampTime(double change_mm_s) { return 2.0 * std::sqrt(change_mm_s / 40000.0); }

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

class Moves final : public machine::RunObserver {
 public:
  void OnMove(const machine::MoveDone& move) override { done.push_back(move); }
  void OnMotion(const machine::MotionDone& part) override { motions.push_back(*part.motion); }
  std::vector<machine::MoveDone> done;
  std::vector<motion::PlannedMotion> motions;
};

motion::MachinePoint TipTo(const motion::PlannedMotion& motion) {
  return motion::TipOn(motion.path, motion.head, motion.path.to()).tip;
}

// OPT-6.42, OPT-2.25: a hole that the machine was moved away from is one move, and told as what it
// is: with its step, its centre and its feed rate.
TEST(TakenUp, AHoleBehindAMotionByHandIsTold) {
  const std::string text =
      kThere +
      "PATH HOLE (10.)\n"
      "MOVE (1100.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-300.,0.,0.)\nPATH LIN\n"
      "MOVE (1100.,900.,-400.,0.,0.)\n";
  const double circle = BeginOf(text) + 90.0 / 50.0 + RampTime(50.0) + 0.6;
  Moves moves;
  const auto run = *OptimoFamily().NewRun(SetupOf(text), moves);
  run->Advance(At(circle));
  run->Apply({.kind = InputKind::kStop});
  ASSERT_EQ(run->Advance(At(circle + 1.0)), RunPhase::kHalted);
  ASSERT_TRUE(run->may_be_moved());
  motion::AxisPose axes = run->state().axes;
  axes.column.z() += 20.0;
  run->MoveTo(axes);
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(circle + 60.0)), RunPhase::kFinished);
  ASSERT_EQ(moves.done.size(), 3U);
  const machine::MoveDone& hole = moves.done[1];
  EXPECT_EQ(hole.place.step, 6);
  EXPECT_EQ(hole.path, "HOLE");
  EXPECT_NEAR(hole.feed_mm_s, 50.0, 1e-9);
  EXPECT_NEAR(hole.program_point.x(), 1100.0, 1e-6);
  EXPECT_NEAR((hole.tip.tip - motion::MachinePoint(1090.0, 1000.0, -400.0)).norm(), 0.0, 1e-3);
  EXPECT_EQ(moves.done[2].place.step, 8);
  EXPECT_NEAR(run->state().tip.tip.y(), 900.0, 1e-4);
}

// OPT-2.25, OPT-6.42: the way back to the circle ends in a stop on it, also where the hole itself
// is passed by /FLY.
TEST(TakenUp, TheWayBackToACircleEndsInAStop) {
  const std::string text =
      kThere +
      "PATH HOLE (10.)\nMOVE (1100.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-300.,0.,0.)/FLY\n"
      "PATH LIN\n"
      "MOVE (1090.,900.,-400.,0.,0.)\n";
  const double circle = BeginOf(text) + 90.0 / 50.0 + RampTime(50.0) + 0.6;
  Moves moves;
  const auto run = *OptimoFamily().NewRun(SetupOf(text), moves);
  run->Advance(At(circle));
  run->Apply({.kind = InputKind::kStop});
  ASSERT_EQ(run->Advance(At(circle + 1.0)), RunPhase::kHalted);
  motion::AxisPose axes = run->state().axes;
  axes.column.z() += 20.0;
  run->MoveTo(axes);
  const std::size_t before = moves.motions.size();
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(circle + 60.0)), RunPhase::kFinished);
  ASSERT_GT(moves.motions.size(), before);
  const motion::PlannedMotion& back = moves.motions[before];
  EXPECT_NEAR((TipTo(back) - motion::MachinePoint(1100.0, 1000.0, -400.0)).norm(), 10.0, 1e-6);
  EXPECT_EQ(back.speed.end().speed, 0.0);
  EXPECT_EQ(back.settling_s, 0.0);  // motion.md 3.3: a stop, and the turn
}

// OPT-6.42, OPT-3.57: where the circle cannot go on from where a person has put the machine, that
// is an error of the MOVE; what its handler moves begins where the machine stands.
TEST(TakenUp, AHandlerMovesFromWhereTheMachineStands) {
  const std::string text = kThere +
                           "ERR 900\nPATH CIR\n"
                           "MOVE (1200.,1000.,-400.,0.,0.)/VIA (1100.,1100.,-400.,0.,0.)\nENDTASK\n"
                           "900 PATH LIN\nMOVE (1000.,900.,-400.,0.,0.)\n";
  const double halt = BeginOf(text) + 2.0;
  Moves moves;
  const auto run = *OptimoFamily().NewRun(SetupOf(text), moves);
  run->Advance(At(halt));
  run->Apply({.kind = InputKind::kStop});
  ASSERT_EQ(run->Advance(At(halt + 1.0)), RunPhase::kHalted);
  motion::AxisPose axes = run->state().axes;
  axes.column = {1200.0, 1000.0, -100.0};  // the target, with the head turned
  axes.a_rad = 0.5;
  run->MoveTo(axes);
  const std::size_t before = moves.motions.size();
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(halt + 60.0)), RunPhase::kFinished);
  ASSERT_GT(moves.motions.size(), before);
  EXPECT_NEAR(moves.motions[before].path.from().a_rad, 0.5, 1e-9);
  EXPECT_NEAR(run->state().tip.tip.y(), 900.0, 1e-4);
}

// OPT-B.67: where the budget of steps ends the run, the last instruction that was carried out is
// the one that is shown.
TEST(TakenUp, TheLastInstructionIsShown) {
  machine::RunObserver nobody;
  const auto run = *OptimoFamily().NewRun(
      SetupOf("VI[1]=1\nOL[16]=ON\nVI[3]=3\n", {.budget = {.steps = 2}}), nobody);
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().code, ErrorCode::kStepBudget);
  EXPECT_EQ(run->state().instruction, "LET");
}

// OPT-4.18, OPT-B.89: a STOP while a motion of /NEXT settles: behind START there is none any more,
// and the next MOVE begins like any other.
TEST(TakenUp, ANextMoveThatOnlyHadToSettle) {
  const std::string text = kThere +
                           "MOVE (1100.,1000.,-400.,0.,0.)/NEXT\nDELAY 5\n"
                           "MOVE (1100.,1100.,-400.,0.,0.)\n";
  const double stop = BeginOf(text) + 2.0 + RampTime(50.0) + 0.5 * kSettle_s;
  const Ran ran = RunText(
      text, {.inputs = {{At(stop), InputKind::kStop}, {At(stop + 10.0), InputKind::kStart}}});
  EXPECT_EQ(ran.Count("halt STOP"), 1);
  ASSERT_EQ(ran.moves.size(), 3U);
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_NEAR(ran.end.tip.tip.y(), 1100.0, 1e-4);
}

// OPT-4.49, OPT-6.42: behind a STOP on its way, and a motion by hand, ZERO goes on with each of its
// groups.
TEST(TakenUp, ZeroGoesOnWithEachGroup) {
  Moves moves;
  const auto run = *OptimoFamily().NewRun(SetupOf("ZERO\n"), moves);
  run->Advance(At(0.5));
  run->Apply({.kind = InputKind::kStop});
  ASSERT_EQ(run->Advance(At(3.0)), RunPhase::kHalted);
  ASSERT_TRUE(run->may_be_moved());
  motion::AxisPose axes = run->state().axes;
  axes.column.z() -= 20.0;
  run->MoveTo(axes);
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(600.0)), RunPhase::kFinished);
  std::vector<std::string> paths;
  for (const machine::MoveDone& move : moves.done) paths.emplace_back(move.path);
  EXPECT_EQ(paths, (std::vector<std::string>{"ZERO_Z", "ZERO_AB", "ZERO_XY"}));
  EXPECT_TRUE(run->state().zeroed);
  EXPECT_NEAR(run->state().axes.column.norm(), 0.0, 1e-6);
}

// A move is told where it ends: one that goes nowhere between two passages not before the machine
// is there.
TEST(TakenUp, MovesAreToldWhereTheyEnd) {
  const Ran ran = RunText(kThere +
                          "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\n"
                          "MOVE (1200.,1000.,-400.,0.,0.)\nMOVE (1200.,1000.,-400.,0.,0.)\n");
  for (const machine::MoveDone& move : ran.moves) {
    EXPECT_NEAR(move.tip.tip.x(), move.program_point.x(), 1e-3) << move.place.step;
    EXPECT_NEAR(move.tip.tip.y(), move.program_point.y(), 1e-3) << move.place.step;
  }
  EXPECT_EQ(ran.moves.back().place.step, 8);
}

// LIVE-6.04: a /FLY is passed by who starts at a step between two moves; not by one that would have
// made it a stop anyway: there the machine stands.
TEST(TakenUp, WhereAStepIsReached) {
  for (const auto& [instruction, passes] : {std::pair{"SPEED 20\n", true}, {"DELAY 1\n", false}}) {
    machine::RunObserver nobody;
    const auto run =
        *OptimoFamily().NewRun(SetupOf(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n" +
                                       instruction + "MOVE (1100.,1100.,-400.,0.,0.)\n"),
                               nobody);
    machine::EnterableRun* const entered = run->enterable();
    ASSERT_NE(entered, nullptr);
    ASSERT_TRUE(entered->HaltBefore({.at = {1, 6}}));
    EXPECT_EQ(run->Advance(At(60.0)), RunPhase::kHalted);
    ASSERT_TRUE(entered->reached());
    EXPECT_EQ(entered->reached()->passes, passes) << instruction;
    EXPECT_EQ(entered->reached()->stands, !passes) << instruction;
  }
}

// LIVE-6.04: a run that was to halt before a step, and is to go on, goes on like any other: with
// its timer.
TEST(TakenUp, ATimerBehindAForgottenStep) {
  machine::RunObserver nobody;
  const auto run = *OptimoFamily().NewRun(
      SetupOf("TIMER (2.,900)\nDELAY 1\nDELAY 2\nVI[1]=VI[2]\nENDTASK\n900 VI[2]=1\nRETURN\n"),
      nobody);
  ASSERT_TRUE(run->enterable()->HaltBefore({.at = {1, 3}}));
  EXPECT_EQ(run->Advance(At(60.0)), RunPhase::kHalted);
  run->enterable()->ForgetTarget();
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(60.0)), RunPhase::kFinished);
  EXPECT_EQ(run->ReadVariable("VI[1]")->text, "1");
}

// LIVE-6.01: where a run halts before the step that it was to come to, a key of its script is not
// for it; when it goes on behind that like any other, its keys are.
TEST(TakenUp, KeysOfTheScriptBehindAForgottenStep) {
  machine::RunObserver nobody;
  const auto run = *OptimoFamily().NewRun(
      SetupOf("DELAY 1\nSTOP\nVI[2]=1\n", {.inputs = {{At(5.0), InputKind::kStart}}}), nobody);
  ASSERT_TRUE(run->enterable()->HaltBefore({.at = {1, 2}}));
  EXPECT_EQ(run->Advance(At(3.0)), RunPhase::kHalted);
  EXPECT_EQ(run->Advance(At(60.0)), RunPhase::kHalted);
  EXPECT_EQ(run->state().time, At(1.0));
  EXPECT_TRUE(run->enterable()->reached());
  run->enterable()->ForgetTarget();
  EXPECT_FALSE(run->enterable()->reached());
  run->Apply({.kind = InputKind::kStart});
  EXPECT_EQ(run->Advance(At(60.0)), RunPhase::kFinished);
  EXPECT_EQ(run->state().time, At(5.0));
  EXPECT_EQ(run->ReadVariable("VI[2]")->text, "1");
}

// OPT-6.14: a dry run whose step was not reached yet is kept as one, also while it stands.
TEST(TakenUp, ADryRunThatStandsIsKept) {
  machine::RunObserver nobody;
  const auto run = *OptimoFamily().NewRun(
      SetupOf("VI[1]=1\nVI[1]=2\nVI[1]=3\n",
              {.mode = machine::Mode::kSingle, .simul = machine::ProgramStep{1, 3}}),
      nobody);
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kHalted);
  const Result<MachineState> kept = DecodeMachineState(run->SaveMachine());
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->simul, (machine::ProgramStep{1, 3}));
}

// OPT-B.62: a program that GO begins in SINGLE waits for START before its first step.
TEST(TakenUp, GoInSingleHaltsBeforeTheFirstStep) {
  const Ran ran =
      RunText("GO 45/S\n", {.programs = {{45, "VI[1]=1\nVI[2]=2\n"}}, .variables = {"VI[1]"}});
  EXPECT_EQ(ran.Count("halt SINGLE"), 1);
  EXPECT_EQ(ran.variables.at("VI[1]"), "0");
  EXPECT_EQ(ran.steps_begun.size(), 1U);
  EXPECT_EQ(RunText("GO 45/S\n", {.programs = {{45, "\n"}}}).Count("halt SINGLE"), 1);
}

// OPT-7.60, OPT-9.26: an analogue output is no parameter.
TEST(TakenUp, OutputsAreNoParameters) {
  EXPECT_EQ(Value("FUNCTION 45 (3.)\n", "VR[1]",
                  {.programs = {{45, "OA[8]=7.5\nVR[1]=PAR[0]\nRETURN\n"}}}),
            "3.0");
}

// OPT-2.49: so many instructions may stand between two moves of a passage; of one more it becomes a
// stop, also where they are plain ones.
TEST(TakenUp, APassageHasRoomForSoManyInstructions) {
  const auto run = [](int count) {
    return RunText(kThere +
                   "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nVI[1]=0\n10 VI[1]=VI[1]+1\n"
                   "IF VI[1] < " +
                   std::to_string(count) + " THEN 10\nMOVE (1100.,1100.,-400.,0.,0.)\n");
  };
  EXPECT_EQ(run(4999).Count("E7304"), 0);  // 10,000 with the MOVE
  const Ran more = run(5000);
  EXPECT_EQ(more.Count("E7304"), 1);
  EXPECT_EQ(more.Finding(7304).step, 8);  // the last IF
  // Each passage has its own.
  std::string two = kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\n";
  for (const std::string label : {"10", "20"}) {
    two += "VI[1]=0\n" + label + " VI[1]=VI[1]+1\nIF VI[1] < 3000 THEN " + label + "\n";
    two += "MOVE (1100.,1" + label + "0.,-400.,0.,0.)" + (label == "10" ? "/FLY\n" : "\n");
  }
  EXPECT_EQ(RunText(two).Count("E7304"), 0);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::taken_up
