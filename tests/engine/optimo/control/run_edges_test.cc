// Edges of what the control does between instructions and beside them: how far it runs ahead, what
// groups are connected, what is due at one instant, what fails on its way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "engine/machine/step_entry.h"
#include "engine/machine/tools.h"
#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::run_edges {
namespace {

using machine::InputKind;
using machine::RunPhase;

constexpr double kCycle_s = 0.048;

std::unique_ptr<machine::Run> RunOfProgram(const std::string& text,
                                           const RunOptions& options = {}) {
  static machine::RunObserver nobody;
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(SetupOf(text, options), nobody);
  EXPECT_TRUE(bool(run));
  return *std::move(run);
}

// Between two /FLY moves 10,000 instructions may be carried out, the second MOVE included, plain
// ones and others alike: 1 + 3 x 3332 + 2 and that MOVE.
TEST(RunEdges, TenThousandInstructionsInAPassage) {
  const auto cancelled = [](int more) {
    std::string text = kThere +
                       "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nVI[1]=0\n10 SPEED 10\n"
                       "VI[1]=VI[1]+1\nIF VI[1] < 3332 THEN 10\n";
    for (int n = 0; n < more; ++n) text += "SPEED 10\n";
    return RunText(text + "MOVE (1100.,1100.,-400.,0.,0.)\n").Count("E7304");
  };
  EXPECT_EQ(cancelled(2), 0);
  EXPECT_EQ(cancelled(3), 1);
}

// OPT-7.98, OPT-7.12: UPDATE of a group sets the outputs of that group, all of them, and of no
// other one: what a CALLed program left in the images of OA stays there.
TEST(RunEdges, UpdateSetsTheOutputsOfItsGroup) {
  const RunOptions options{.programs = {{45, "UPDATE OA /OFF\nOA[5]=2.5\n"}}};
  const Ran other = RunText("CALL 45\nUPDATE OL /ON\nDELAY 1\nUPDATE OA /ON\n", options);
  EXPECT_NEAR(other.First("OA[5] 2.5").at_s, 1.0, 1e-9);
  const Ran ends = RunText(
      "UPDATE OL, OA /OFF\nOL[0]=ON\nOL[99]=ON\nOA[1]=1.5\nOA[99]=2.5\nDELAY 1\n"
      "UPDATE OL, OA /ON\n");
  for (const char* told : {"OL[0] 1", "OL[99] 1", "OA[1] 1.5", "OA[99] 2.5"})
    EXPECT_NEAR(ends.First(told).at_s, 1.0, 1e-9) << told;
}

// OPT-7.85, OPT-7.97: an image of an input and an output are as good as any other ON, where a
// condition is waited for as well.
TEST(RunEdges, ImagesAreOnOrOff) {
  const Ran ran = RunText(
      "VL[1]=IL[5]\nUPDATE IL /OFF\nOL[16]=ON\nWAIT IL[5] = ON\nVI[1]=1\nWAIT OL[16] = ON\nVI[2]=1\n"
      "WAIT IL[5] = OL[16]\nVI[3]=1\n",
      {.inputs = {{SimTime(0), InputKind::kLogical, 5, 1.0}},
       .variables = {"VI[1]", "VI[2]", "VI[3]"},
       .budget = {.virtual_time = At(100.0)}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.variables.at("VI[1]") + ran.variables.at("VI[2]") + ran.variables.at("VI[3]"),
            "111");
  EXPECT_EQ(ran.time_s, 0.0);
}

// OPT-6.11, OPT-6.16: program 1 is meant where it is named, in whatever program that stands.
TEST(RunEdges, BreakAndSimulNameProgramOne) {
  const Ran ran = RunText("CALL 45\nVI[2]=1\nVI[3]=1\n",
                          {.programs = {{45, "BREAK 2, 1\nVI[4]=1\nVI[5]=1\n"}}});
  EXPECT_EQ(ran.Count("halt BREAK"), 1);
  EXPECT_EQ(ran.First("halt BREAK").program, 1);
  EXPECT_EQ(ran.First("halt BREAK").step, 2);
}

// motion.md 6: a MOVE takes over from one of /NEXT at a tick, to the very instant.
TEST(RunEdges, AMoveTakesOverAtATick) {
  const Ran ran = RunText(kThere +
                          "MOVE (1500.,1000.,-400.,0.,0.)/NEXT\nDELAY 1\n"
                          "MOVE (1000.,1000.,-400.,0.,0.)\n");
  const SimTime cycle = At(kCycle_s);
  const SimTime asked = ran.moves.front().at + At(1.0);
  const SimTime tick = (asked / cycle + 1) * cycle;
  ASSERT_GE(ran.parts.size(), 3U);
  EXPECT_EQ(ran.parts[1].done.end, tick);
}

// OPT-2.48: a move on an arc stands behind a passage like any other.
TEST(RunEdges, AnArcBehindAPassage) {
  const Ran ran = RunText(kThere +
                          "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nPATH CIR\n"
                          "MOVE (1120.,1020.,-400.,0.,0.)/VIA (1114.142,1005.858,-400.,0.,0.)\n");
  EXPECT_EQ(ran.Count("E7304"), 0);
  EXPECT_EQ(CodeOf(ran), 0);
}

// OPT-B.12: from the axis of a hole that is parallel to the program's X the circle is entered along
// its Y; SYSDEF turns both.
TEST(RunEdges, AHoleFromItsAxisAlongX) {
  const Ran plain = RunText(
      kThere + "PATH HOLE (5.)\nMOVE (1000.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-400.,0.,0.)\n");
  EXPECT_NEAR((plain.end.tip.tip - motion::MachinePoint(1000.0, 1005.0, -400.0)).norm(), 0.0, 1e-4);
  const Ran turned = RunText(kThere +
                             "SYSDEF (1000.,1000.,-400.,1.570796,0.,0.)\nPATH HOLE (5.)\n"
                             "MOVE (0.,0.,0.,0.,0.)/VIA (100.,0.,0.,0.,0.)\n");
  EXPECT_NEAR((turned.end.tip.tip - motion::MachinePoint(995.0, 1000.0, -400.0)).norm(), 0.0, 1e-4);
}

// OPT-B.22: which of the two it is that lets nothing move, and OPT-4.38: at 100 % nothing is told.
TEST(RunEdges, WhyNothingMoves) {
  const auto detail = [](const std::string& modal) {
    const Ran ran = RunText(kThere + modal + "MOVE (1100.,1000.,-400.,0.,0.)\n");
    EXPECT_EQ(CodeOf(ran), 7307) << modal;
    return std::string(ran.outcome.detail);
  };
  EXPECT_EQ(detail("SPEED 0\n"), "SPEED is 0");
  EXPECT_EQ(detail("SPEED 1\nACCEL .05\n"), "ACCEL is below 0.1");
  EXPECT_EQ(detail("SPEED .5\nACCEL .05\n"), "ACCEL is below 0.1");
  const std::string move = kAbsol + "SPEED 100\nMOVE (1000.,1000.,-400.,0.,0.)\n";
  EXPECT_EQ(RunText(move).Count("E7320"), 0);
  EXPECT_EQ(RunText(move, {.override_percent = 115.0}).Count("E7320"), 1);
}

// OPT-B.59, OPT-B.89: a timer that was due before a CALL, inside a FUNCTION, makes its GOSUB right
// behind that FUNCTION.
TEST(RunEdges, ATimerThatWasDueBeforeACall) {
  EXPECT_EQ(Value("TIMER (.5,900)\nFUNCTION 44\nVI[3]=VI[2]\nENDTASK\n900 VI[2]=7\nRETURN\n",
                  "VI[3]", {.programs = {{44, "DELAY 1\nCALL 45\n"}, {45, "VI[5]=1\n"}}}),
            "7");
}

// OPT-3.38, OPT-B.30: what is due in the background at the same tick acts at the same tick: the end
// of a dwell before a condition, and two conditions.
TEST(RunEdges, TwoThingsOfOneTick) {
  const Ran dwell = RunText(
      "WORKDEF 1,0 (10.,60.,.5,95.)\nWORKDEF 2,1 (15)\nWORK 1,0/ON/NEXT\n"
      "WORK 2,1/ON/START (VL[3])/NEXT\nDELAY .46\nVL[3]=ON\nDELAY 1\nWORK 1,0/OFF\nWORK 2,1/OFF\n",
      {.parameters = {{"CYCLE", "0.0625"}}});
  EXPECT_NEAR(dwell.First("schedule 15").at_s, 8.0 * 0.0625, 1e-9);
  const Ran both = RunText(
      "WORKDEF 2,1 (15)\nWORK 0,0/ON/START (VL[3])/NEXT\nWORK 2,1/ON/START (VL[3])/NEXT\n"
      "DELAY .45\nVL[3]=ON\nDELAY 1\nWORK 0,0/OFF\nWORK 2,1/OFF\n");
  EXPECT_NEAR(both.First("beam on 100.0").at_s, 10.0 * kCycle_s, 1e-9);
  EXPECT_NEAR(both.First("schedule 15").at_s, 10.0 * kCycle_s, 1e-9);
}

// docs/verdict.md: behind the last OFF no process asks for the beam, and nothing is missing.
TEST(RunEdges, BehindTheLastOffNothingIsMissing) {
  const auto run = RunOfProgram(kThere +
                                "WORK 0,0/ON\nWORK 0,0/OFF\nMOVE (1100.,1000.,-400.,0.,0.)\n"
                                "WORKDEF 2,1 (15)\nWORK 0,0/ON\nWORK 2,1/OFF\n"
                                "MOVE (1150.,1000.,-400.,0.,0.)\nWORK 0,0/OFF\n");
  EXPECT_EQ(run->Advance(At(100.0)), RunPhase::kFinished);
  for (const machine::Figure& figure : run->figures()) {
    if (figure.name == "beam_off_length") {
      EXPECT_NEAR(figure.value, 50.0, 1e-3);  // WORK 0 still counts as ON. OPT-3.25
    }
  }
}

// docs/verdict.md: what is missing is told of contours alone: a way from point to point, and a head
// that turns about its tip, are none.
TEST(RunEdges, OnlyContoursMissTheirBeam) {
  for (const auto& [move, wanted] : {std::pair{"PATH PTP\nMOVE (1100.,1000.,-400.,0.,0.)\n", 0.0},
                                     std::pair{"MOVE (1000.,1000.,-400.,0.,1.)\n", 0.0},
                                     std::pair{"MOVE (1100.,1000.,-400.,0.,0.)\n", 100.0}}) {
    const auto run = RunOfProgram(kThere + "WORKDEF 2,1 (15)\nWORK 0,0/ON\nWORK 2,1/OFF\n" + move +
                                  "WORK 0,0/OFF\n");
    EXPECT_EQ(run->Advance(At(100.0)), RunPhase::kFinished);
    for (const machine::Figure& figure : run->figures()) {
      if (figure.name == "beam_off_length") {
        EXPECT_NEAR(figure.value, wanted, 1e-3) << move;
      }
    }
  }
}

// OPT-3.06: schedules are named by WORKDEF, whatever numbers other instructions have.
TEST(RunEdges, OnlyDefinitionsNameSchedules) {
  const machine::RunSetup setup = SetupOf(
      "WORKDEF 2,1 (11)\nWORK 2,1/ON\nMOVE (500.,600.,-100.,0.,12.)\n"
      "TCP (0.,0.,3./0.,0.,-5.)\nWORK 2,1/OFF\n");
  machine::Parameters few(OptimoFamily().parameters());
  EXPECT_TRUE(few.Set("SCHEDULES", 11.0));
  EXPECT_TRUE(OptimoFamily().CheckNeeds(setup.programs, {}, few, 1));
  EXPECT_TRUE(few.Set("SCHEDULES", 10.0));
  EXPECT_FALSE(OptimoFamily().CheckNeeds(setup.programs, {}, few, 1));
}

// OPT-2.48: who waits for a condition stands: of a WORK as of a MOVE.
TEST(RunEdges, AWorkThatWaitsNeedsStandstill) {
  for (const std::string how : {"/START (VL[1])", "/START (VL[1])/NEXT"}) {
    const Ran ran = RunText(kThere + "VL[1]=ON\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\nWORK 0,0/ON" +
                            how + "\nMOVE (1100.,1100.,-400.,0.,0.)\nWORK 0,0/OFF\n");
    EXPECT_EQ(ran.Count("E7304"), 1) << how;
    EXPECT_LT(ran.DistanceTo({1100.0, 1000.0, -400.0}), 1e-6) << how;
  }
}

// OPT-7.79, OPT-7.27: a condition may fail while it is waited for; and what is written from outside
// to no variable, or does not fit, changes nothing.
TEST(RunEdges, AConditionThatFailsLater) {
  const Ran ran = RunText(
      "VI[5]=1\nWAIT 1/VI[5] > 2\nVI[2]=1\n",
      {.inputs = {{.at = At(1.0), .kind = InputKind::kVariable, .value = 0.0, .name = "VI[5]"}},
       .variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(ran), 7201);
  EXPECT_EQ(ran.outcome.place.step, 2);
  EXPECT_NEAR(ran.time_s, 1.0, 1e-9);
  EXPECT_EQ(ran.variables.at("VI[2]"), "0");
  const auto run = RunOfProgram("VI[5]=1\nDELAY 1\n");
  run->Advance(At(0.5));
  run->WriteVariable("VI[6]", 3.0);
  for (const char* name : {"VX[5]", "VI[5", "IL[5]", "VI[98]"}) run->WriteVariable(name, 7.0);
  EXPECT_EQ(run->ReadVariable("VI[6]")->text, "3");
  run->WriteVariable("VI[5]", 0.5);
  EXPECT_EQ(run->ReadVariable("VI[5]")->text, "1");
  EXPECT_EQ(run->ReadVariable("IL[5]")->text, "0");
  EXPECT_EQ(run->ReadVariable("VI[98]")->text, "1");
}

// OPT-9.22, OPT-7.78: a PAR of INT holds what an INTEGER holds.
TEST(RunEdges, AParameterOfIntegersMayOverflow) {
  for (const std::string value : {"32768.", "-32769."}) {
    const Ran ran = RunText(
        "VR[1]=" + value + "\nFUNCTION 44 (7)\n",
        {.programs = {{44, "DEFINE PAR[0]=INT\nPAR[0]=VR[1]\nVI[2]=1\n"}}, .variables = {"VI[2]"}});
    EXPECT_EQ(CodeOf(ran), 7203) << value;
    EXPECT_EQ(ran.outcome.place.program, 44);
    EXPECT_EQ(ran.outcome.place.step, 2);
    EXPECT_EQ(ran.variables.at("VI[2]"), "0");
  }
}

// OPT-2.48, OPT-B.55: an instruction whose values fail behind a /FLY move: the machine stops at the
// target, and the error is that of the instruction.
TEST(RunEdges, ValuesThatFailBehindAPassage) {
  const std::string fly = kThere + "VR[9]=0.\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\n";
  for (const std::string next :
       {"TCP (0.,0.,(1./VR[9])/0.,0.,-5.)\n", "MOVE (1./VR[9]*2.,1000.,-400.,0.,0.)\n"}) {
    const Ran ran = RunText(fly + next);
    EXPECT_EQ(CodeOf(ran), 7201) << next;
    EXPECT_EQ(ran.outcome.place.step, 7) << next;
    EXPECT_EQ(ran.Count("E7304"), 1) << next;
    EXPECT_NEAR(ran.end.tip.tip.x(), 1100.0, 1e-9) << next;
  }
}

// OPT-2.48, OPT-B.32: a passage that /END or /TIME makes impossible is told as such.
TEST(RunEdges, FlyWithEndOrTime) {
  for (const std::string how : {"/END (IL[20])", "/TIME (60.,900)"}) {
    const Ran ran = RunText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY" + how +
                            "\nMOVE (1100.,1100.,-400.,0.,0.)\nENDTASK\n900 RETURN\n");
    EXPECT_EQ(CodeOf(ran), 0);
    ASSERT_EQ(ran.Count("E7304"), 1) << how;
    EXPECT_EQ(ran.Finding(7304).step, 5);
    EXPECT_EQ(ran.Finding(7304).severity, Severity::kWarning);
    EXPECT_EQ(ran.Finding(7304).detail, "/FLY with /END or /TIME: the machine stops at the target");
  }
}

// OPT-7.50, OPT-1.25: a DECLARE may have a sequence number that is jumped to, as the first line,
// too.
TEST(RunEdges, AJumpToADeclare) {
  EXPECT_EQ(Value("10 DECLARE X = VR[1]\nX = X + 1.\nIF X < 3. THEN 10\n", "VR[1]"), "3.0");
}

// LIVE-6.04: control is in the GOSUB of a timer until that returns, wherever the timer was set: in
// a CALLed program, in a FUNCTION, inside another GOSUB.
TEST(RunEdges, InsideTheGosubOfATimer) {
  const auto inside = [](const std::string& main, const std::map<int, std::string>& programs,
                         const machine::ProgramStep& at) {
    const auto run = RunOfProgram(main, {.programs = programs});
    EXPECT_TRUE(run->enterable()->HaltBefore({.at = at}).ok());
    EXPECT_EQ(run->Advance(At(100.0)), RunPhase::kHalted);
    return run->enterable()->reached()->in_timed_gosub;
  };
  const std::string timed =
      "TIMER (1.,900)\nDELAY 2\nVI[2]=1\nRETURN\n900 VI[3]=1\nGOSUB 800\nVI[4]=1\nRETURN\n"
      "800 VI[5]=1\nRETURN\n";
  const std::string called =
      "TIMER (1.,900)\nDELAY 2\nVI[2]=1\nENDTASK\n900 VI[3]=1\nGOSUB 800\nVI[4]=1\nRETURN\n"
      "800 VI[5]=1\nRETURN\n";
  const std::string nested =
      "GOSUB 700\nVI[6]=1\nENDTASK\n700 TIMER (1.,900)\nDELAY 2\nVI[2]=1\nRETURN\n900 VI[3]=1\n"
      "VI[4]=1\nRETURN\n";
  for (const auto& [step, wanted] :
       {std::pair{5, true}, std::pair{9, true}, std::pair{7, true}, std::pair{3, false}}) {
    EXPECT_EQ(inside("FUNCTION 44\n", {{44, timed}}, {44, step}), wanted) << step;
    EXPECT_EQ(inside("CALL 45\n", {{45, called}}, {45, step}), wanted) << step;
  }
  EXPECT_FALSE(inside("FUNCTION 44\nVI[9]=1\n", {{44, timed}}, {1, 2}));
  EXPECT_FALSE(inside("CALL 45\nVI[9]=1\n", {{45, called}}, {1, 2}));
  EXPECT_TRUE(inside(nested, {}, {1, 9}));
  EXPECT_FALSE(inside(nested, {}, {1, 6}));
  EXPECT_FALSE(inside(nested, {}, {1, 2}));
}

// LIVE-6.04, OPT-7.16: nor is control there where the GOSUB could not be made and ERR took over.
TEST(RunEdges, AGosubOfATimerThatIsNotMade) {
  const auto run =
      RunOfProgram("ERR 600\nTIMER (1.,900)\nDELAY 2\nVI[2]=1\nENDTASK\n600 VI[3]=1\n");
  EXPECT_TRUE(run->enterable()->HaltBefore({.at = {1, 6}}).ok());
  EXPECT_EQ(run->Advance(At(100.0)), RunPhase::kHalted);
  EXPECT_FALSE(run->enterable()->reached()->in_timed_gosub);
}

// OPT-B.67: a budget is told to the nanosecond, and one of a nanosecond is one.
TEST(RunEdges, BudgetsOfNanoseconds) {
  const auto detail = [](SimTime budget) {
    const Ran ran = RunText("DELAY 3000000\n", {.budget = {.virtual_time = budget}});
    EXPECT_EQ(CodeOf(ran), 7902);
    EXPECT_EQ(ran.end.time, budget);
    return std::string(ran.outcome.detail);
  };
  EXPECT_EQ(detail(SimTime(1)), "the run takes longer than 0.000000001 s");
  EXPECT_EQ(detail(SimTime(1'234'567'891'234'567)),
            "the run takes longer than 1234567.891234567 s");
}

// The form of a file is known by its name and by its bytes, each for itself; figures that are
// compared are those before and behind.
TEST(RunEdges, ToolsTakeTheirArgumentsInOrder) {
  const machine::Tools& tools = *OptimoFamily().tools();
  const auto compiled =
      tools.Compile({"a.S", "VI[3]=1\n"}, machine::Parameters(OptimoFamily().parameters()), {});
  EXPECT_EQ(tools.FormOf("a.SI", "SPEED 20\n"), machine::FileForm::kInchSource);
  EXPECT_EQ(tools.FormOf("a", compiled.object), machine::FileForm::kObject);
  EXPECT_EQ(tools.FormOf("a", "VI[3]=1\n"), machine::FileForm::kMetricSource);
  const machine::Figure before{.name = "time", .unit = "s", .value = 4.0};
  const machine::Figure after{.name = "time", .unit = "s", .value = 7.0};
  const auto diff = tools.Diff({.object = compiled.object, .figures = {before}},
                               {.object = compiled.object, .figures = {after}});
  ASSERT_TRUE(diff);
  ASSERT_EQ(diff->figures.size(), 1U);
  EXPECT_EQ(diff->figures[0].before, 4.0);
  EXPECT_EQ(diff->figures[0].after, 7.0);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::run_edges
