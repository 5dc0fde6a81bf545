#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// Where halts come between the steps of programs, functions and calls, and what an instant that two
// things share brings first.
namespace rmlcell::optimo::testing::flow_states {
namespace {

using machine::InputKind;
using machine::Mode;
using machine::OutcomeKind;
using ::testing::ElementsAre;

machine::InputChange Key(double at_s, InputKind kind) { return {At(at_s), kind}; }

machine::InputScript Starts(int count) {
  machine::InputScript script;
  for (int n = 1; n <= count; ++n) script.push_back(Key(n, InputKind::kStart));
  return script;
}

// The halts in order, as "why program.step".
std::vector<std::string> Halts(const Ran& ran) {
  std::vector<std::string> halts;
  for (const Ran::Event& event : ran.events) {
    if (event.what.starts_with("halt ")) {
      halts.push_back(event.what.substr(5) + " " + std::to_string(event.program) + "." +
                      std::to_string(event.step));
    }
  }
  return halts;
}

// OPT-6.31: one START for each step in SINGLE: behind the last step of a CALLed program and of a
// FUNCTION, too; behind the last one of all the program is over.
TEST(FlowStates, SingleHaltsAtTheEndsOfModules) {
  const Ran called =
      RunText("CALL 2\nVI[2]=1\n",
              {.programs = {{2, "VI[3]=1\n"}}, .inputs = Starts(5), .mode = Mode::kSingle});
  EXPECT_THAT(Halts(called), ElementsAre("SINGLE 1.1", "SINGLE 2.1"));
  EXPECT_EQ(called.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(called.time_s, 2.0);
  const Ran last =
      RunText("VI[2]=1\nCALL 2\n",
              {.programs = {{2, "VI[3]=1\n"}}, .inputs = Starts(5), .mode = Mode::kSingle});
  EXPECT_THAT(Halts(last), ElementsAre("SINGLE 1.1", "SINGLE 1.2", "SINGLE 2.1"));
  const Ran function =
      RunText("VI[2]=1\nFUNCTION 44\n",
              {.programs = {{44, "VI[3]=1\n"}}, .inputs = Starts(5), .mode = Mode::kSingle});
  EXPECT_THAT(Halts(function), ElementsAre("SINGLE 1.1", "SINGLE 1.2", "SINGLE 44.1"));
}

// OPT-6.31, OPT-3.51: a STOP in the program is a step like any other: one START leads behind it.
TEST(FlowStates, AStopInSingleHaltsOnce) {
  const Ran ran = RunText("STOP\nVI[2]=1\n",
                          {.inputs = Starts(3), .mode = Mode::kSingle, .variables = {"VI[2]"}});
  EXPECT_THAT(Halts(ran), ElementsAre("STOP 1.1"));
  EXPECT_EQ(ran.time_s, 1.0);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
}

// OPT-4.17: during the last instruction: it is finished, the machine halts, START ends the program.
TEST(FlowStates, HoldDuringTheLastInstruction) {
  const Ran ran =
      RunText("DELAY 1\n", {.inputs = {Key(0.5, InputKind::kHold), Key(3.0, InputKind::kStart)}});
  EXPECT_THAT(Halts(ran), ElementsAre("HOLD 1.1"));
  EXPECT_EQ(ran.First("halt HOLD").at_s, 1.0);
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.time_s, 3.0);
}

// OPT-6.07: a breakpoint on the last step: the program is over, there is nothing to halt for.
TEST(FlowStates, ABreakpointOnTheLastStep) {
  const Ran ran =
      RunText("VI[2]=1\nVI[3]=1\n",
              {.inputs = Starts(1), .breakpoint = machine::ProgramStep{.program = 1, .step = 2}});
  EXPECT_TRUE(Halts(ran).empty());
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
}

// OPT-B.59, OPT-B.30: a time that is over at the instant at which a DELAY ends is over: three
// cycles of half a second.
TEST(FlowStates, ATimerThatIsDueWithTheEndOfADelay) {
  const auto seen = [](const std::string& delay) {
    return Value(
        "TIMER (1.5,900)\nDELAY " + delay + "\nVI[3]=VI[2]\nENDTASK\n900 VI[2]=1\nRETURN\n",
        "VI[3]", {.parameters = {{"CYCLE", "0.5"}}});
  };
  EXPECT_EQ(seen("1.5"), "1");
  EXPECT_EQ(seen("1.4999"), "0");
}

// OPT-3.45: a DELAY of nothing lets no time pass, also beside a motion, and does not end a chain's
// waiting for its standstill twice.
TEST(FlowStates, ADelayOfNothing) {
  const std::string text = kThere + "MOVE (1100.,1000.,-400.,0.,0.)/NEXT\n";
  const Ran without = RunText(text + "OL[16]=ON\n");
  const Ran with = RunText(text + "DELAY 0\nOL[16]=ON\n");
  EXPECT_EQ(with.First("OL[16] 1").at_s, without.First("OL[16] 1").at_s);
  EXPECT_EQ(with.time_s, without.time_s);
  EXPECT_EQ(with.steps, without.steps + 1);
  EXPECT_TRUE(with.waits.empty());
}

// OPT-2.59, OPT-2.54, OPT-B.55: a hole of /NEXT that ends on its lead, by /END or by an error: a
// move behind it is waited for like any other.
TEST(FlowStates, AHoleOfNextThatEndsOnItsLead) {
  const std::string hole = "MOVE (1100.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-300.,0.,0.)";
  const std::string behind = "PATH LIN\nMOVE (1100.,1100.,-400.,0.,0.)\nOL[16]=ON\n";
  const double begin = ToSeconds(RunText(kThere).moves.front().at);
  for (const std::string& text :
       {kThere + "PATH HOLE (10.)\n" + hole + "/END (IL[20])/NEXT\nDELAY 5\n" + behind,
        kThere + "PATH HOLE (10.)\nERR 10\n" + hole +
            "/NEXT\nDELAY 1\nVR[0]=1/VI[2]\n10 DELAY 0\n" + behind}) {
    const Ran ran = RunText(text, {.inputs = {{At(begin + 1.0), InputKind::kLogical, 20, 1.0}}});
    ASSERT_EQ(ran.moves.size(), 3U) << text;
    EXPECT_LT(ran.moves[1].tip.tip.x(), 1080.0);
    EXPECT_EQ(ran.First("OL[16] 1").at_s, ToSeconds(ran.moves[2].at)) << text;
    EXPECT_EQ(ran.First("OL[16] 1").at_s, ran.time_s);
  }
}

// OPT-3.45: a time longer than any run, halted and started meanwhile, is still to come.
TEST(FlowStates, AnEndlessDelayOverAHalt) {
  for (const std::string seconds : {"9E18", "3E9"}) {
    const Ran ran = RunText("VR[0]=" + seconds + "\nDELAY VR[0]\nVI[2]=1\n",
                            {.inputs = {Key(1.0, InputKind::kStop), Key(1e6, InputKind::kStart)},
                             .variables = {"VI[2]"},
                             .budget = {.virtual_time = std::chrono::hours(1000)}});
    EXPECT_EQ(CodeOf(ran), 7902) << seconds;
    EXPECT_EQ(ran.variables.at("VI[2]"), "0");
  }
}

// OPT-3.51: a START at the very instant of the halt: nobody was waited for.
TEST(FlowStates, AHaltOfNoTimeIsNoWait) {
  const Ran ran =
      RunText("STOP\nVI[2]=1\n", {.inputs = {Key(0.0, InputKind::kStart)}, .variables = {"VI[2]"}});
  EXPECT_EQ(ran.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_THAT(Halts(ran), ElementsAre("STOP 1.1"));
  EXPECT_TRUE(ran.waits.empty());
}

}  // namespace
}  // namespace rmlcell::optimo::testing::flow_states
