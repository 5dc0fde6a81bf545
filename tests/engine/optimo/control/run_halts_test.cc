// What stands still with a halt and goes on behind it, and breakpoints that are set while an
// instruction is under way.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::run_halts {
namespace {

using machine::HaltReason;
using machine::InputKind;
using machine::RunPhase;

class Resumes final : public machine::RunObserver {
 public:
  void OnResume(SimTime at, const machine::Place& place) override {
    told.push_back(std::to_string(ToSeconds(at)).substr(0, 5) + " " +
                   std::to_string(place.program) + "/" + std::to_string(place.step));
  }
  std::vector<std::string> told;
};

struct Halted {
  explicit Halted(const std::string& text, const RunOptions& options = {}) {
    run = *OptimoFamily().NewRun(SetupOf(text, options), resumes);
  }
  void Press(InputKind kind, int index = 0, double value = 1.0) {
    run->Apply({.at = run->state().time, .kind = kind, .index = index, .value = value});
  }
  std::string Value(const std::string& name) const { return run->ReadVariable(name)->text; }

  Resumes resumes;
  std::unique_ptr<machine::Run> run;
};

// OPT-4.18, OPT-B.59: time stands still for a TIMER while the run is halted: of its 2 s 1 s is left
// at START, and the DELAY is over before.
TEST(RunHalts, ATimerStandsStill) {
  const Ran ran = RunText(
      "TIMER (2.,900)\nDELAY 1.5\nVI[3]=VI[2]\nDELAY 1\nVI[4]=VI[2]\nENDTASK\n900 VI[2]=1\nRETURN\n",
      {.inputs = {{At(1.0), InputKind::kStop}, {At(11.0), InputKind::kStart}},
       .variables = {"VI[3]", "VI[4]"}});
  EXPECT_EQ(ran.variables.at("VI[3]"), "0");
  EXPECT_EQ(ran.variables.at("VI[4]"), "1");
}

// Whoever listens is told that the run goes on, when and where.
TEST(RunHalts, GoingOnIsTold) {
  Halted one("DELAY 1\nDELAY 2\n",
             {.inputs = {{At(1.5), InputKind::kStop}, {At(4.0), InputKind::kStart}}});
  EXPECT_EQ(one.run->Advance(At(100.0)), RunPhase::kFinished);
  EXPECT_EQ(one.resumes.told, (std::vector<std::string>{"4.000 1/2"}));
}

// OPT-4.17, OPT-E.7408: behind START the program is where it had run ahead to: what is told at its
// end has the place of its last step.
TEST(RunHalts, TheProgramIsWhereItWas) {
  const std::string text = kThere +
                           "WORK 0,0/ON\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\n"
                           "MOVE (1100.,1100.,-400.,0.,0.)\n";
  const Ran free = RunText(text);
  ASSERT_EQ(free.First("E7408").step, 7);
  const double begin = ToSeconds(free.moves.front().at);
  const Ran held = RunText(text, {.inputs = {{At(begin + 1.0), InputKind::kHold},
                                             {At(begin + 20.0), InputKind::kStart}}});
  EXPECT_EQ(held.First("halt HOLD").step, 6);
  EXPECT_EQ(held.First("E7408").step, 7);
}

// OPT-4.18: STOP while the machine settles at its target: it stands, and halts at that instant.
TEST(RunHalts, StopWhileItSettlesHaltsAtOnce) {
  const std::string text = kThere + "MOVE (1100.,1000.,-400.,0.,0.)\nVI[2]=1\n";
  const Ran free = RunText(text);
  const SimTime stop = free.end.time - At(0.02);
  Halted one(text);
  one.run->Advance(stop);
  ASSERT_EQ(one.run->state().tip_speed_mm_s, 0.0);
  one.Press(InputKind::kStop);
  EXPECT_EQ(one.run->Advance(stop + At(0.001)), RunPhase::kHalted);
  EXPECT_EQ(one.run->state().time, stop);
  EXPECT_EQ(one.run->state().halted_by, HaltReason::kStop);
  EXPECT_EQ(one.Value("VI[2]"), "0");
}

// A breakpoint that is set at an instruction while that waits for its condition: it halts behind
// the instruction, which is carried out first.
TEST(RunHalts, ABreakpointAtAWaitingInstruction) {
  Halted wait("WAIT IL[20]\nVI[1]=1\n");
  wait.run->Advance(At(0.5));
  wait.run->SetBreakpoints({{.at = {1, 1}}});
  wait.Press(InputKind::kLogical, 20);
  EXPECT_EQ(wait.run->Advance(At(5.0)), RunPhase::kHalted);
  EXPECT_EQ(wait.Value("VI[1]"), "0");
  EXPECT_EQ(wait.run->steps_executed(), 1U);

  Halted move(kAbsol + "MOVE (121.02,2201.2,-350.,0.,0.)/START (IL[20])\nVI[1]=1\n");
  move.run->Advance(At(0.5));
  move.run->SetBreakpoints({{.at = {1, 3}}});
  move.Press(InputKind::kLogical, 20);
  EXPECT_EQ(move.run->Advance(At(50.0)), RunPhase::kHalted);
  EXPECT_NEAR(move.run->state().tip.tip.x(), 121.02, 1e-4);
  EXPECT_EQ(move.Value("VI[1]"), "0");
}

// One that is set at an instruction under way has its condition as any other.
TEST(RunHalts, ALateBreakpointHasItsCondition) {
  for (const auto& [before, phase] :
       {std::pair{"VI[5]=0\n", RunPhase::kFinished}, std::pair{"VI[5]=1\n", RunPhase::kHalted}}) {
    Halted one(std::string(before) + "DELAY 1\nVI[1]=1\n");
    one.run->Advance(At(0.5));
    one.run->SetBreakpoints({{.at = {1, 2}, .condition = "VI[5] > 0"}});
    EXPECT_EQ(one.run->Advance(At(5.0)), phase) << before;
    EXPECT_EQ(one.Value("VI[1]"), phase == RunPhase::kHalted ? "0" : "1");
  }
}

// OPT-9.26: a condition in a FUNCTION sees the parameters of the call that is carried out.
TEST(RunHalts, ABreakpointSeesTheParametersOfItsCall) {
  Halted one("FUNCTION 44 (1.)\nVI[1]=1\nFUNCTION 44 (2.)\nVI[1]=2\n",
             {.programs = {{44, "DELAY 1\nRETURN\n"}}});
  one.run->SetBreakpoints({{.at = {44, 1}, .condition = "PAR[0] > 1.5"}});
  EXPECT_EQ(one.run->Advance(At(9.0)), RunPhase::kHalted);
  EXPECT_EQ(one.run->state().time, At(2.0));
  EXPECT_EQ(one.Value("VI[1]"), "1");
}

// One that is taken back meanwhile halts nothing.
TEST(RunHalts, ABreakpointThatIsTakenBack) {
  Halted wait("WAIT IL[20]\nVI[1]=1\n");
  wait.run->SetBreakpoints({{.at = {1, 1}}});
  wait.run->Advance(At(0.5));
  wait.run->SetBreakpoints({});
  wait.Press(InputKind::kLogical, 20);
  EXPECT_EQ(wait.run->Advance(At(5.0)), RunPhase::kFinished);

  // In SINGLE it halts all the same, by the mode.
  Halted single("DELAY 1\nDELAY 1\nDELAY 1\n", {.mode = machine::Mode::kSingle});
  single.run->Advance(At(0.5));
  single.run->SetBreakpoints({{.at = {1, 1}}});
  single.run->SetBreakpoints({});
  EXPECT_EQ(single.run->Advance(At(5.0)), RunPhase::kHalted);
  EXPECT_EQ(single.run->state().time, At(1.0));
  EXPECT_EQ(single.run->state().halted_by, HaltReason::kSingle);
}

// OPT-B.22, OPT-B.30: the ticks at which a MOVE that never moves looks at its /END are counted from
// that MOVE on.
TEST(RunHalts, TicksOfAMoveThatNeverMoves) {
  const Ran ran = RunText(
      "SPEED 0\nDELAY .01\nMOVE (121.02,2201.2,-50.,0.,0.)/END (IL[20])/TIME (60.,900)\nOL[16]=ON\n"
      "ENDTASK\n900 RETURN\n",
      {.inputs = {{At(0.99), InputKind::kLogical, 20, 1.0}}});
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, 0.01 + 21.0 * 0.048, 1e-6);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::run_halts
