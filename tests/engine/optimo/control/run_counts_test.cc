// What the control counts and adds up on its way: instructions of a turn and of an instant, passes
// of a breakpoint, periods and ticks after halts, lengths that are told in parts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/control/program_context.h"
#include "engine/optimo/language/compiler.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::run_counts {
namespace {

using machine::InputKind;
using machine::RunPhase;

constexpr double kCycle_s = 0.048;

double FigureOf(const machine::Run& run, const std::string& name) {
  for (const machine::Figure& figure : run.figures()) {
    if (figure.name == name) return figure.value;
  }
  ADD_FAILURE() << name;
  return -1.0;
}

// LIVE-3.12: one turn carries out 20,000 instructions, of whatever kinds.
TEST(RunCounts, ATurnHasItsInstructions) {
  const auto run = RunOfText("OL[16]=ON\nOL[17]=ON\n10 VI[1]=7\nGOTO 10\n");
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kRunning);
  EXPECT_EQ(run->steps_executed(), 20'000U);
  EXPECT_EQ(run->Advance(At(1.0)), RunPhase::kRunning);
  EXPECT_EQ(run->steps_executed(), 40'000U);
}

// OPT-B.67: more time than the budget is too much, all of it is not.
TEST(RunCounts, TheBudgetOfTimeMayBeUsedUp) {
  const auto run = RunOfText("DELAY 5\nVI[2]=1\nDELAY 1\n", {.budget = {.virtual_time = At(5.0)}});
  EXPECT_EQ(run->Advance(At(5.0)), RunPhase::kRunning);
  EXPECT_EQ(run->ReadVariable("VI[2]")->text, "1");
  EXPECT_EQ(run->state().place.step, 3);
  EXPECT_EQ(run->Advance(At(5.0) + SimTime(1)), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().code, ErrorCode::kTimeBudget);
  EXPECT_EQ(run->state().time, At(5.0));
}

// LIVE-3.01: instructions are counted anew at each instant: 700 and 700 with time between them are
// not 1000 at once; a loop that lets no time pass ends behind 1000.
TEST(RunCounts, InstructionsOfOneInstant) {
  for (const std::string step : {"VI[1]=VI[1]+1\n", "OL[16]=ON\n"}) {
    std::string some;
    for (int n = 0; n < 700; ++n) some += step;
    const RunOptions options{.budget = {.steps = 0, .steps_at_one_instant = 1000}};
    EXPECT_EQ(CodeOf(RunText(some + "DELAY .5\n" + some + "DELAY .5\n", options)), 0) << step;
    const Ran endless = RunText(some + "DELAY .5\n10 " + step + "GOTO 10\n", options);
    EXPECT_EQ(CodeOf(endless), 7901) << step;
    EXPECT_EQ(endless.steps, 701U + 1000U) << step;
    EXPECT_EQ(endless.outcome.detail, "1000 steps were executed at one instant") << step;
  }
}

// OPT-2.03: coordinates from sums and products of what the program has set itself.
TEST(RunCounts, CoordinatesAreSumsOfVariables) {
  const Ran ran = RunText(
      "VR[1]=500.\nVR[2]=40.\nVR[3]=3.\nVR[4]=.5\n"
      "MOVE (VR[1]+VR[2]*VR[3]-7., VR[2]*(VR[3]+20.)+5., VR[3]-VR[2]-16., VR[4]*VR[4], VR[4]-.4)\n");
  ASSERT_EQ(ran.moves.size(), 1U);
  EXPECT_NEAR(ran.end.axes.column.x(), 613.0, 1e-9);
  EXPECT_NEAR(ran.end.axes.column.y(), 925.0, 1e-9);
  EXPECT_NEAR(ran.end.axes.column.z(), -53.0, 1e-9);
  EXPECT_NEAR(ran.end.axes.a_rad, 0.25, 1e-9);
  EXPECT_NEAR(ran.end.axes.b_rad, 0.1, 1e-7);
}

// OPT-B.59: a timer with /AUTO comes every second, whenever it was set: here at 3.008, 4.008 and
// 5.008 s.
TEST(RunCounts, APeriodBeginsWithItsTimer) {
  EXPECT_EQ(Value("DELAY 2\nTIMER (1.,900)/AUTO\nDELAY 1.5\nDELAY 1.\nDELAY 1.\nVI[3]=VI[2]\n"
                  "ENDTASK\n900 VI[2]=VI[2]+1\nRETURN\n",
                  "VI[3]"),
            "3");
}

// A step that was begun before anybody watched is its first pass: the second one halts.
TEST(RunCounts, APassThatWasBegunBeforeCounts) {
  for (const auto& [from_pass, halt_s] :
       {std::pair{1U, 1.0}, std::pair{2U, 2.0}, std::pair{3U, 3.0}}) {
    const auto run = RunOfText("10 DELAY 1\nVI[1]=VI[1]+1\nGOTO 10\n");
    EXPECT_EQ(run->Advance(At(0.5)), RunPhase::kRunning);
    run->SetBreakpoints({{.at = {1, 1}, .from_pass = from_pass}});
    EXPECT_EQ(run->Advance(At(9.0)), RunPhase::kHalted);
    EXPECT_EQ(run->state().time, At(halt_s)) << from_pass;
  }
}

// OPT-B.30: the ticks of /END stand still with the halt: they go on 10 ms later than they were.
TEST(RunCounts, TicksOfEndGoOnBehindAHalt) {
  const std::string text = kThere + "MOVE (1900.,1000.,-400.,0.,0.)/END (IL[20])\n";
  const double begin = ToSeconds(RunText(text).moves.front().at);
  const double halt = begin + 1.0 + 2.0 * std::sqrt(50.0 / 40000.0);
  const double stood = 50.0 * kCycle_s + 0.010;
  const Ran ran = RunText(text, {.inputs = {{At(begin + 1.0), InputKind::kStop},
                                            {At(halt + stood), InputKind::kStart},
                                            {At(begin + 8.0), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(ran.First("halt STOP").at_s, halt, 1e-6);
  const double seen = begin + stood + std::ceil((8.0 - stood) / kCycle_s) * kCycle_s;
  EXPECT_NEAR(ToSeconds(ran.moves.back().at), seen + 2.0 * std::sqrt(50.0 / 40000.0), 1e-6);
}

// OPT-3.38: what a CALLed program has in the background goes on beside what its caller has there.
TEST(RunCounts, BackgroundWorkOfCallerAndCallee) {
  const Ran ran = RunText(
      "WORK 0,0/ON/START (IL[20])/NEXT\nCALL 45\nDELAY 1\nWORK 0,0/OFF\n",
      {.programs = {{45, "WORKDEF 0,1\nWORK 0,1/ON/START (IL[21])/NEXT\nDELAY 2\nWORK 0,1/OFF\n"}},
       .inputs = {{At(1.0), InputKind::kLogical, 21, 1.0},
                  {At(2.5), InputKind::kLogical, 20, 1.0}}});
  ASSERT_EQ(ran.Count("beam on 100.0"), 2);
  EXPECT_NEAR(ran.First("beam on 100.0").at_s, 1.0, 1e-9);
  EXPECT_EQ(ran.First("beam on 100.0").program, 45);
  EXPECT_EQ(ran.First("beam on 100.0").step, 2);
  EXPECT_NEAR(ran.First("beam off").at_s, 2.0, 1e-9);
  EXPECT_EQ(ran.Count("E7408"), 0);
}

// OPT-3.11: a WORK that waits takes the place of the one of the same process that waited before.
TEST(RunCounts, AWaitingWorkReplacesTheOneBefore) {
  const Ran ran = RunText(
      "WORKDEF 0,1\nWORK 0,1/ON/START (IL[20])/NEXT\nWORK 0,1/ON/START (IL[21])/NEXT\nDELAY 3\n"
      "WORK 0,1/OFF\n",
      {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0},
                  {At(2.0), InputKind::kLogical, 21, 1.0}}});
  ASSERT_EQ(ran.Count("beam on 100.0"), 1);
  EXPECT_NEAR(ran.First("beam on 100.0").at_s, 2.0, 1e-9);
  EXPECT_EQ(ran.First("beam on 100.0").step, 3);
}

// OPT-3.38, OPT-3.58: what waits in the background is over with its program, and with an error of
// it: the next program of that level, and the handler, know nothing of it.
TEST(RunCounts, BackgroundWorkEndsWithItsProgram) {
  const machine::InputScript input{{At(1.0), InputKind::kLogical, 20, 1.0}};
  const std::string waits = "WORK 0,0/ON/START (IL[20])/NEXT\n";
  const Ran next = RunText("CALL 45\nCALL 46\n",
                           {.programs = {{45, waits}, {46, "DELAY 2\n"}}, .inputs = input});
  EXPECT_EQ(next.Count("beam on 100.0"), 0);
  const Ran caught = RunText(
      "ERR 900\nWORK 0,0/ON\nWORKDEF 0,1\nWORK 0,1/ON/START (IL[20])/NEXT\nVR[0]=1/0\n"
      "ENDTASK\n900 DELAY 2\n",
      {.inputs = input});
  EXPECT_EQ(CodeOf(caught), 0);
  EXPECT_EQ(caught.Count("beam on 100.0"), 1);
  EXPECT_EQ(caught.Count("E7408"), 0);
}

// docs/verdict.md: a way is as long as it is, also where it is told in parts: a dwell in the
// background is over after 1 s of the move, and behind it there is no power.
TEST(RunCounts, LengthsOfPartsOfAMotion) {
  const auto run = RunOfText(kThere +
                             "WORKDEF 1,0 (10.,0.,1.,50.)\nWORK 1,0/ON/NEXT\n"
                             "MOVE (1100.,1000.,-400.,0.,0.)\nWORK 1,0/OFF\n");
  EXPECT_EQ(run->Advance(At(100.0)), RunPhase::kFinished);
  const double before = 50.0 * (1.0 - std::sqrt(50.0 / 40000.0));
  EXPECT_NEAR(FigureOf(*run, "no_power_length"), 100.0 - before, 1e-3);
}

// OPT-1.13, OPT-1.15, OPT-B.73: executables have the number of their program and 100.
TEST(RunCounts, ExecutablesAreNamed) {
  RunOptions options{.programs = {{44, "VI[2]=1\n"}}};
  options.executables[1] = RunText("FUNCTION 44\n", options).executables.at(1);
  options.programs[44] = "VI[2]=2\n";
  EXPECT_EQ(RunText("FUNCTION 44\n", options).Finding(7110).detail,
            "executable 101: FUNCTION 44 was altered since it was made; it holds the old one");
  RunOptions other;
  other.executables[1] = RunText("CALL 7\n", {.programs = {{7, "VI[3]=1\n"}}}).executables.at(7);
  EXPECT_EQ(RunText("VI[2]=1\n", other).Finding(7110).detail,
            "executable 101 holds program 7 instead of 1");
  std::string much;
  for (int n = 0; n < 60; ++n) much += "VR[1]=VR[2]+VR[3]\n";
  const Ran full = RunText(much, {.parameters = {{"CMOS_SIZE", "1000"}}});
  EXPECT_EQ(CodeOf(full), 7109);
  EXPECT_EQ(full.outcome.detail, "no room for executable 101");
}

// OPT-9.08: four levels, also where each instruction is looked at by itself.
TEST(RunCounts, FunctionLevelsUnderABreakpoint) {
  const std::string recursive = "VI[2]=VI[2]+1\nIF VI[2] = VI[3] THEN 9\nFUNCTION 44\n9 RETURN\n";
  const RunOptions options{.programs = {{44, recursive}},
                           .breakpoint = machine::ProgramStep{.program = 99, .step = 1}};
  EXPECT_EQ(CodeOf(RunText("VI[2]=0\nVI[3]=4\nFUNCTION 44\n", options)), 0);
  EXPECT_EQ(CodeOf(RunText("VI[2]=0\nVI[3]=5\nFUNCTION 44\n", options)), 7502);
}

// OPT-9.27, OPT-7.85: a number that becomes LOGIC is ON, and as good as any other ON.
TEST(RunCounts, ALogicalParameterIsOneOrZero) {
  const auto run = [](const std::string& argument) {
    return Value("VR[1]=2.\nFUNCTION 44 (" + argument + ")\n", "VI[5]",
                 {.programs = {{44,
                                "DEFINE PAR[0]=LOGIC\nDEFINE PAR[1]=LOGIC\nPAR[1]=PAR[0]\nVI[5]=1\n"
                                "IF PAR[0] = ON THEN 10\nVI[5]=2\n10 IF PAR[1] = ON THEN 20\n"
                                "VI[5]=VI[5]+2\n20 RETURN\n"}}});
  };
  EXPECT_EQ(run("2."), "1");
  EXPECT_EQ(run("VR[1]"), "1");
  EXPECT_EQ(run("-.5"), "1");
  EXPECT_EQ(run("0."), "4");
}

// plain_code.h: the start of what is not plain, and the end of the module, are kLeave.
TEST(RunCounts, WhatIsNotPlainIsLeft) {
  Executable executable;
  Compilation compiled = Compile("DELAY 1\nVR[1]=2.\nDELAY 2\nDELAY 3\n", "test.S", {});
  ASSERT_TRUE(compiled.ok);
  executable.modules.push_back({.slot = 1, .module = std::move(compiled.module)});
  const Loaded loaded = Load(std::move(executable));
  const PlainCode& code = loaded->plain[0];
  EXPECT_EQ(code.At(1)->op, PlainOp::kBegin);
  for (const std::uint32_t instruction : {0U, 2U, 3U, 4U})
    EXPECT_EQ(code.At(instruction)->op, PlainOp::kLeave) << instruction;
  EXPECT_EQ(code.At(1) - code.At(0), 1);
}

// OPT-2.48, OPT-3.50, OPT-3.61, OPT-2.54: what instructions did is told with their words.
TEST(RunCounts, InstructionsAreTold) {
  const Ran fly = RunText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nDELAY 1\n");
  EXPECT_EQ(fly.Finding(7304).detail, "/FLY before DELAY: the machine stops at the target");
  EXPECT_EQ(ArgumentsText(fly.Finding(7304).detail), "instruction='DELAY'");
  for (const std::string word : {"STOP", "PAUSE"}) {
    const Ran stop = RunText(word + "\n", {.mode = machine::Mode::kRemote});
    EXPECT_EQ(stop.Finding(7507).detail, word + " in REMOTE");
    EXPECT_EQ(ArgumentsText(stop.Finding(7507).detail), "instruction='" + word + "'");
    EXPECT_EQ(stop.outcome.detail, word);
    EXPECT_EQ(ArgumentsText(stop.outcome.detail), "instruction='" + word + "'");
  }
  const Ran seterr = RunText("VR[1]=10000.\nSETERR VR[1]\n");
  EXPECT_EQ(seterr.outcome.detail, "SETERR 10000");
  EXPECT_EQ(ArgumentsText(seterr.outcome.detail), "value=10000");
  const Ran time =
      RunText("VR[1]=-2.5\n" + kThere +
              "MOVE (1100.,1000.,-400.,0.,0.)/TIME (VR[1], 900)\nENDTASK\n900 RETURN\n");
  EXPECT_EQ(CodeOf(time), 7205);
  EXPECT_EQ(time.outcome.detail, "/TIME is -2.5");
  EXPECT_EQ(ArgumentsText(time.outcome.detail), "time=-2.5 s");
}

}  // namespace
}  // namespace rmlcell::optimo::testing::run_counts
