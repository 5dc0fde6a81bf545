// What comes together rarely: a timer whose GOSUB calls another program, one that is due while a
// condition is waited for, a chain that is moved by hand, a STOP that has to wait.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/machine/observer.h"
#include "engine/machine/step_entry.h"
#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/machine/machine_state.h"
#include "engine/optimo/machine/optimo_parameters.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::rarely_together {
namespace {

using machine::InputKind;
using machine::RunPhase;
using ::testing::ElementsAre;

constexpr double kCycle_s = 0.048;

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

// OPT-B.59, OPT-B.89: a repeated timer stands still while its GOSUB has another program called,
// with what it had left of its period: due at 1.008 s, taken at 1.4 s, called to 1.9 s, due again
// at 2.508 s and taken at 2.6 s.
TEST(RarelyTogether, ATimerStandsStillWhileItsGosubCalls) {
  const Ran ran = RunText(
      "TIMER (1.,900)/AUTO\nDELAY .7\nDELAY .7\nDELAY .7\nDELAY .7\nENDTASK\n"
      "900 OL[20]=ON\nOL[20]=OFF\nCALL 45\nRETURN\n",
      {.programs = {{45, "DELAY .5\n"}}});
  std::vector<double> taken;
  for (const Ran::Event& event : ran.events) {
    if (event.what == "OL[20] 1") taken.push_back(event.at_s);
  }
  ASSERT_GE(taken.size(), 2U);
  EXPECT_NEAR(taken[0], 1.4, 1e-6);
  EXPECT_NEAR(taken[1], 2.6, 1e-6);
}

// OPT-B.59: the GOSUB of a timer stands between two instructions: a WAIT that is met while it is
// due is over before, whatever becomes of its input.
TEST(RarelyTogether, AWaitIsOverBeforeTheGosubOfATimer) {
  const Ran ran = RunText(
      "TIMER (1.,900)\nWAIT (IL[20])\nVI[2]=1\nENDTASK\n900 DELAY .5\nRETURN\n",
      {.inputs = {{At(2.0), InputKind::kLogical, 20, 1.0}, {At(2.2), InputKind::kLogical, 20, 0.0}},
       .variables = {"VI[2]"}});
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_THAT(ran.steps_begun, ElementsAre(1, 2, 5, 6, 3, 4));
  EXPECT_NEAR(ran.time_s, 2.5, 1e-9);
}

// OPT-B.32: /TIME counts the wait for /START, and runs on when the motion has begun: 42 cycles.
TEST(RarelyTogether, TheTimeOfAMoveBeginsOnce) {
  const std::string there = kThere +
                            "MOVE (1500.,1000.,-400.,0.,0.)/START (IL[20])/TIME (2.,900)\n"
                            "ENDTASK\n900 OL[16]=ON\nRETURN\n";
  const double begin = BeginOf(there);
  const Ran ran = RunText(there, {.inputs = {{At(begin + 1.0), InputKind::kLogical, 20, 1.0}}});
  const double due = begin + std::ceil(2.0 / kCycle_s) * kCycle_s;
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, due + 2.0 * std::sqrt(50.0 / 40000.0), 1e-6);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1000.0 + 50.0 * (due - begin - 1.0), 1e-3);
}

// OPT-3.34: the beam goes off where the CALLed program ends that left it on, and not with the
// caller.
TEST(RarelyTogether, TheBeamOfACalledProgramEndsWithIt) {
  const Ran ran = RunText("CALL 45\nDELAY 1\nWORK 0,0/ON\nDELAY 1\nWORK 0,0/OFF\n",
                          {.programs = {{45, "WORK 0,0/ON\nDELAY 2\n"}}});
  EXPECT_EQ(ran.Count("beam on 100.0"), 2);
  EXPECT_EQ(ran.Count("beam off"), 2);
  EXPECT_NEAR(ran.First("beam off").at_s, 2.0, 1e-9);
  EXPECT_EQ(ran.First("beam off").program, 45);
  EXPECT_EQ(ran.First("E7408").program, 45);
}

// motion.md 3.6: a MOVE to where the machine goes anyway ends a chain, by whatever path, and is
// told when the chain is over.
TEST(RarelyTogether, AMoveToTheSamePlaceEndsAChain) {
  for (const std::string how :
       {"COORD ABSOL\nPATH LIN\n", "COORD ABSOL\nPATH PTP\n", "COORD ROBOT\nPATH PTP\n"}) {
    const Ran ran = RunText(how +
                            "MOVE (600.,1500.,-300.,0.,0.)/FLY\nMOVE (600.,1800.,-300.,0.,0.)/FLY\n"
                            "MOVE (600.,1800.,-300.,0.,0.)\nMOVE (100.,1800.,-300.,0.,0.)\n");
    SCOPED_TRACE(how);
    EXPECT_EQ(CodeOf(ran), 0);
    EXPECT_EQ(ran.Count("E7304"), 1);
    ASSERT_EQ(ran.moves.size(), 4U);
    EXPECT_EQ(ran.moves[2].place.step, 5);
    EXPECT_GE(ran.moves[2].at, ran.moves[1].at);
    EXPECT_EQ(ran.moves[2].axes, ran.moves[1].axes);
  }
}

// OPT-9.19: where a rotary table is fitted, FUNCTION 99 is the table, whatever the executable holds
// that another machine has made.
TEST(RarelyTogether, TheTableIsTheTable) {
  const std::string text = "VI[2]=1\nFUNCTION 99 (90.)\n";
  RunOptions options{.programs = {{99, "VI[3]=7\nRETURN\n"}}, .variables = {"VI[3]"}};
  const Ran without = RunText(text, options);
  EXPECT_EQ(without.variables.at("VI[3]"), "7");
  options.executables[1] = without.executables.at(1);
  options.parameters = {{"ROTARY_TABLE", "ON"}};
  const Ran with = RunText(text, options);
  EXPECT_TRUE(with.Told("table 90.0"));
  EXPECT_EQ(with.variables.at("VI[3]"), "0");
}

class Way final : public machine::RunObserver {
 public:
  void OnMotion(const machine::MotionDone& done) override {
    const motion::PlannedMotion& motion = *done.motion;
    const auto tip = [&](double s) {
      return motion::TipOn(motion.path, motion.head, motion.path.At(s)).tip;
    };
    if (!ends.empty()) gap = std::max(gap, (tip(done.from) - ends.back()).norm());
    ends.push_back(tip(done.travelled));
  }
  void OnMove(const machine::MoveDone& move) override { moves.push_back(move.place.step); }
  std::vector<motion::MachinePoint> ends;
  double gap = 0.0;  // between one motion and the next
  std::vector<int> moves;
};

// OPT-6.42: a chain that was moved by hand goes on from there, each of its moves once, on one way.
TEST(RarelyTogether, AChainThatWasMovedIsRiddenOnce) {
  const std::string text =
      kThere +
      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)/FLY\n"
      "MOVE (1200.,1100.,-400.,0.,0.)/FLY\nMOVE (1200.,1200.,-400.,0.,0.)\n";
  const double begin = BeginOf(text);
  for (const double stop : {0.5, 1.5, 2.5, 3.5, 5.0}) {
    Way way;
    const auto run = *OptimoFamily().NewRun(SetupOf(text), way);
    run->Advance(At(begin + stop));
    run->Apply({.kind = InputKind::kStop});
    ASSERT_EQ(run->Advance(At(begin + stop + 1.0)), RunPhase::kHalted) << stop;
    ASSERT_TRUE(run->may_be_moved()) << stop;
    motion::AxisPose axes = run->state().axes;
    axes.column.z() += 20.0;
    run->MoveTo(axes);
    way.ends.back().z() += 20.0;
    run->Apply({.kind = InputKind::kStart});
    EXPECT_EQ(run->Advance(At(begin + 100.0)), RunPhase::kFinished);
    EXPECT_LT(way.gap, 1e-3) << stop;
    EXPECT_THAT(way.moves, ElementsAre(3, 5, 6, 7, 8)) << stop;
    EXPECT_NEAR((way.ends.back() - motion::MachinePoint(1200.0, 1200.0, -400.0)).norm(), 0.0, 1e-3);
  }
}

// OPT-B.30, OPT-4.18: a STOP that waits for more of the path than is planned: what is tested in the
// background is tested at its tick all the same, where the STOP takes effect, too.
TEST(RarelyTogether, AStopThatWaitsPassesOverNoTick) {
  const auto text = [](double delay) {
    return kThere + "WORK 0,0/ON/END (IL[20])\nDELAY " + std::to_string(delay) +
           "\n10 MOVE (1001.,1000.,-400.,0.,0.)/FLY\nMOVE (1001.,1001.,-400.,0.,0.)/FLY\n"
           "MOVE (1000.,1001.,-400.,0.,0.)/FLY\nMOVE (1000.,1000.,-400.,0.,0.)/FLY\n"
           "VI[2]=VI[2]+1\nIF VI[2] < 20 THEN 10\nMOVE (1100.,1000.,-400.,0.,0.)\nWORK 0,0/OFF\n";
  };
  const Ran free = RunText(text(1.0));
  const double begin = ToSeconds(free.moves.front().at);
  for (const Ran::Part& part : free.parts) {
    const double end = ToSeconds(part.done.end) - begin - 1.0;  // from the begin of the chain
    if (end < 0.05 || part.motion.settling_s > 0.0) continue;
    // With this delay the part ends 1 ms behind a tick.
    const double behind = std::fmod(1.0 + end - 0.001, kCycle_s);
    const double delay = 1.0 + kCycle_s - behind;
    const double tick = begin + delay + end - 0.001;
    const Ran ran =
        RunText(text(delay), {.inputs = {{At(tick - 0.02), InputKind::kLogical, 20, 1.0},
                                         {At(tick - 0.001), InputKind::kStop}}});
    EXPECT_NEAR(ran.First("beam off").at_s, tick, 1e-6) << end;
  }
}

// OPT-3.38, OPT-3.37: the /END of a WORK ends that process, of whatever kind and number: nothing of
// it is ON at the end of the program.
TEST(RarelyTogether, TheEndOfAWorkIsThatOfItsProcess) {
  for (const std::string work :
       {"WORKDEF 0,1\nWORK 0,1", "WORKDEF 1,0 (10.,60.,0.,50.)\nWORK 1,0",
        "WORKDEF 1,2 (10.,60.,0.,50.)\nWORK 1,2", "WORKDEF 0,2\nWORK 0,2"}) {
    const Ran ran = RunText(work + "/ON/END (IL[20])\nDELAY 2\n",
                            {.inputs = {{At(1.0), InputKind::kLogical, 20, 1.0}}});
    EXPECT_EQ(CodeOf(ran), 0) << work;
    EXPECT_NEAR(ran.First("beam off").at_s, 21.0 * kCycle_s, 1e-9) << work;
    EXPECT_EQ(ran.Count("E7408"), 0) << work;
  }
}

// OPT-2.56, OPT-2.25: the program goes on beside the whole of a hole: beside the turn as beside the
// line to it, which is over after 1.87 s.
TEST(RarelyTogether, TheProgramGoesOnBesideTheTurnOfAHole) {
  const Ran ran =
      RunText(kThere +
              "PATH HOLE (10.)\nMOVE (1100.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-300.,0.,0.)/NEXT\n"
              "DELAY 2.5\nOL[16]=ON\n");
  const double begin = BeginOf(kThere);
  EXPECT_EQ(CodeOf(ran), 0);
  ASSERT_EQ(ran.moves.size(), 2U);
  EXPECT_GT(ToSeconds(ran.moves[1].at), begin + 3.0);
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, begin + 2.5, 1e-6);
}

// OPT-2.49, OPT-3.58: what a chain was to show behind the place where an error has ended it is over
// with it; the chain of the handler shows its own.
TEST(RarelyTogether, TheChainOfAHandlerShowsItsOwn) {
  const double begin = BeginOf(kThere);
  const Ran ran =
      RunText(kThere +
                  "ERR 900\nWORK 0,0/ON/END (1./IA[20] > 2.)\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\n"
                  "OL[16]=ON\nMOVE (1100.,1100.,-400.,0.,0.)\nENDTASK\n"
                  "900 MOVE (1000.,1000.,-400.,0.,0.)/FLY\nOL[17]=ON\n"
                  "MOVE (1000.,900.,-400.,0.,0.)\n",
              {.inputs = {{SimTime(0), InputKind::kAnalogue, 20, 1.0},
                          {At(begin + 1.0), InputKind::kAnalogue, 20, 0.0}}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.First("E7201").step, 6);
  EXPECT_TRUE(ran.Told("OL[17] 1"));
  EXPECT_NEAR(ran.end.tip.tip.y(), 900.0, 1e-4);
}

// OPT-2.54, OPT-3.55: the handler of an error takes over from all that was to come: a GOSUB that
// the /TIME of a MOVE has made due at that instant is not made any more.
TEST(RarelyTogether, AnErrorTakesTheGosubThatIsDue) {
  const double due = 42.0 * kCycle_s;  // the first cycle behind 2 s
  const Ran ran = RunText(
      "ERR 800\nWORK 0,0/ON/END (1./IA[20] > 2.)\nSPEED 0\n"
      "MOVE (121.02,2201.2,-50.,0.,0.)/TIME (2.,900)\nENDTASK\n800 VI[2]=1\nENDTASK\n"
      "900 VI[3]=1\nRETURN\n",
      {.inputs = {{SimTime(0), InputKind::kAnalogue, 20, 1.0},
                  {At(due - 0.001), InputKind::kAnalogue, 20, 0.0}},
       .variables = {"VI[2]", "VI[3]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_NEAR(ran.First("E7201").at_s, due, 1e-9);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_EQ(ran.variables.at("VI[3]"), "0");
}

// OPT-3.58, OPT-4.17: an error of a WORK in the background is that of the WORK; where it is caught,
// the run is at the instruction in execution as before: a HOLD halts it there.
TEST(RarelyTogether, AHoldBehindAnErrorInTheBackground) {
  const Ran ran =
      RunText("ERR 900\nWORK 0,0/ON/END (1./IA[20] > 2.)\nDELAY 5\nENDTASK\n900 VI[2]=1\n",
              {.inputs = {{SimTime(0), InputKind::kAnalogue, 20, 1.0},
                          {At(1.0), InputKind::kHold},
                          {At(1.1), InputKind::kAnalogue, 20, 0.0},
                          {At(9.0), InputKind::kStart}},
               .variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.First("E7201").step, 2);
  EXPECT_EQ(ran.First("halt HOLD").step, 3);
  EXPECT_NEAR(ran.First("halt HOLD").at_s, 23.0 * kCycle_s, 1e-9);
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
}

// motion.md 10, LIVE-3.05: of inputs of one instant each is taken; only an override gives way, and
// to another override.
TEST(RarelyTogether, AnOverrideBesideAnotherInput) {
  const Ran ran =
      RunText("DELAY 2\nVL[1]=IL[20]\n", {.inputs = {{At(1.0), InputKind::kOverride, 0, 55.0},
                                                     {At(1.0), InputKind::kLogical, 20, 1.0}},
                                          .variables = {"VL[1]"}});
  EXPECT_EQ(ran.end.override_percent, 55.0);
  EXPECT_EQ(ran.variables.at("VL[1]"), "1");
}

// motion.md 3.6: a MOVE to where the machine stands is told at once, as a line or from point to
// point.
TEST(RarelyTogether, AMoveThatStandsHasItsPath) {
  const std::string move = "MOVE (600.,1500.,-300.,0.,0.)\n";
  for (const auto& [modes, path] :
       {std::pair{"COORD ROBOT\nPATH PTP\n", "PTP"}, std::pair{"COORD ABSOL\nPATH PTP\n", "PTP"},
        std::pair{"COORD ABSOL\nPATH LIN\n", "LIN"}}) {
    const Ran ran = RunText(modes + move + move);
    ASSERT_EQ(ran.moves.size(), 2U) << modes;
    EXPECT_EQ(ran.moves[1].at, ran.moves[0].at) << modes;
    EXPECT_EQ(ran.moves[1].path, path) << modes;
  }
}

// OPT-7.62: an operand is a REAL like any other: what becomes greater is an error, also of sums and
// products of what the program has set itself.
TEST(RarelyTogether, AnOperandThatIsTooGreat) {
  for (const std::string operand : {"VR[1]*100.", "VR[1]+VR[1]", "0.-VR[1]-VR[1]"}) {
    const Ran ran = RunText("VR[1]=9E18\nDELAY " + operand + "\n");
    EXPECT_EQ(CodeOf(ran), 7202) << operand;
    EXPECT_EQ(ran.outcome.place.step, 2) << operand;
  }
}

// OPT-6.05, LIVE-3.10: a breakpoint on a step of a chain that the program has run ahead to, with
// the machine still before it: it halts behind what is under way. On one that is over it does not.
TEST(RarelyTogether, ABreakpointInsideAChain) {
  const std::string text =
      kThere +
      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)/FLY\n"
      "MOVE (1200.,1100.,-400.,0.,0.)/FLY\nMOVE (1200.,1200.,-400.,0.,0.)\nDELAY 1\n";
  const double begin = BeginOf(kThere);
  for (int step = 3; step <= 8; ++step) {
    const auto run = RunOfText(text);
    EXPECT_EQ(run->Advance(At(begin + 0.5)), RunPhase::kRunning);
    ASSERT_EQ(run->state().place.step, 5);
    run->SetBreakpoints({{.at = {1, step}}});
    const RunPhase phase = run->Advance(At(begin + 60.0));
    EXPECT_EQ(phase, step < 5 ? RunPhase::kFinished : RunPhase::kHalted) << step;
    EXPECT_NEAR(run->state().tip.tip.y(), 1200.0, 1e-3) << step;
    if (step < 5) continue;
    EXPECT_EQ(run->state().place.step, 8) << step;
    EXPECT_EQ(run->state().halted_by, machine::HaltReason::kBreakpoint) << step;
  }
}

// OPT-6.05, OPT-6.31: a breakpoint, or SINGLE, that is set while a MOVE is under way halts behind
// that MOVE.
TEST(RarelyTogether, WhatIsSetWhileAMoveIsUnderWay) {
  const double begin = BeginOf(kThere);
  for (const bool single : {false, true}) {
    const auto run = RunOfText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)\nDELAY 1\nDELAY 1\n");
    EXPECT_EQ(run->Advance(At(begin + 0.5)), RunPhase::kRunning);
    if (single) {
      run->SetMode(machine::Mode::kSingle);
    } else {
      run->SetBreakpoints({{.at = {1, 5}}});
    }
    EXPECT_EQ(run->Advance(At(begin + 60.0)), RunPhase::kHalted) << single;
    EXPECT_EQ(run->state().place.step, 5) << single;
    EXPECT_NEAR(run->state().tip.tip.x(), 1100.0, 1e-4) << single;
    EXPECT_EQ(run->state().halted_by,
              single ? machine::HaltReason::kSingle : machine::HaltReason::kBreakpoint);
  }
}

// OPT-7.97: of a loop that reads two inputs the first read is counted: it is carried out a thousand
// times at one instant, and once in a cycle from then on.
TEST(RarelyTogether, ALoopThatReadsTwoInputs) {
  const auto run = RunOfText("10 IF IL[16] THEN 20\nIF NOT IL[17] THEN 10\n20 VI[2]=1\n");
  EXPECT_EQ(run->Advance(At(0.01)), RunPhase::kRunning);
  EXPECT_EQ(run->steps_executed(), 2000U);
  EXPECT_EQ(run->Advance(At(0.05)), RunPhase::kRunning);
  EXPECT_EQ(run->steps_executed(), 2002U);
}

// LIVE-6.09: the way to the step where a run begins is none of its work, and is told as that way;
// what the program moves is its work.
TEST(RarelyTogether, TheWayToAStepIsNoWork) {
  class Ways final : public machine::RunObserver {
   public:
    void OnMotion(const machine::MotionDone& done) override {
      EXPECT_EQ(done.in_work, !done.approach);
      ++(done.approach ? on_the_way : at_work);
    }
    int on_the_way = 0;
    int at_work = 0;
  } told;
  machine::RunSetup setup =
      SetupOf(kAbsol + "MOVE (1000.,1000.,-400.,0.,0.)\nMOVE (1100.,1000.,-400.,0.,0.)\nDELAY 1\n");
  const MachineState stands = NewMachine(Resolve(setup.parameters));
  const auto run = *OptimoFamily().NewRun(std::move(setup), told);
  machine::EnterableRun& entered = *run->enterable();
  ASSERT_TRUE(entered.HaltBefore({.at = {1, 4}}).ok());
  ASSERT_EQ(run->Advance(At(1000.0)), RunPhase::kHalted);
  EXPECT_EQ(told.on_the_way, 0);
  EXPECT_GT(told.at_work, 0);
  told.at_work = 0;
  entered.Enter({.machine_state = EncodeMachineState(stands)});
  EXPECT_EQ(run->Advance(At(2000.0)), RunPhase::kFinished);
  EXPECT_GT(told.on_the_way, 0);
  EXPECT_GT(told.at_work, 0);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::rarely_together
