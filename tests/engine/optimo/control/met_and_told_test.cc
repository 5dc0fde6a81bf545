// What rarely meets: an error where a condition has just been met, a STOP at the very instant a
// passage is written, a failing step that somebody watches, images that nobody connects.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "engine/machine/step_entry.h"
#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::met_and_told {
namespace {

using machine::InputKind;
using machine::RunPhase;
using ::testing::ElementsAre;

constexpr double kCycle_s = 0.048;

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

// OPT-3.55, OPT-7.27: an error that comes while the machine slows down, where a WAIT has just been
// met: the first instruction of the handler is begun like any other, and waits itself.
TEST(MetAndTold, AHandlerBehindAMetWaitWaits) {
  const std::string text = kAbsol +
                           "MOVE (1000.,1000.,-400.,0.,0.)\nSPEED 100\nERR 10\n"
                           "WORK 0,0/ON/END (1./IA[20] > 2.)\n"
                           "MOVE (1900.,1000.,-400.,0.,0.)/NEXT/END (IL[20])\n"
                           "WAIT (IL[21])\nENDTASK\n10 WAIT (IL[22])\nVI[2]=1\n";
  const double begin = BeginOf(text);
  const Ran ran = RunText(text, {.inputs = {{SimTime(0), InputKind::kAnalogue, 20, 1.0},
                                            {At(begin + 1.0), InputKind::kLogical, 20, 1.0},
                                            {At(begin + 1.10), InputKind::kStop},
                                            {At(begin + 1.12), InputKind::kLogical, 21, 1.0},
                                            {At(begin + 1.13), InputKind::kAnalogue, 20, 0.0},
                                            {At(begin + 5.0), InputKind::kStart},
                                            {At(begin + 8.0), InputKind::kLogical, 22, 1.0}},
                                 .variables = {"VI[2]"}});
  EXPECT_EQ(CodeOf(ran), 0);
  EXPECT_EQ(ran.First("E7201").step, 6);
  EXPECT_THAT(ran.steps_begun, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 10, 11));
  EXPECT_EQ(ran.variables.at("VI[2]"), "1");
  EXPECT_NEAR(ran.time_s, begin + 8.0, 1e-9);
}

class Watcher final : public machine::StepWatcher {
 public:
  void OnStepDue(const machine::StepFacts& facts) override { due.push_back(facts.place.step); }
  std::vector<int> due;
};

// OPT-2.45: the COORD that fails behind a passage is a step that was begun, for who watches, too.
TEST(MetAndTold, ACoordThatFailsIsAStepThatIsDue) {
  const auto run = RunOfText(kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nCOORD ROBOT\nDELAY 1\n");
  Watcher watcher;
  run->enterable()->WatchSteps(&watcher);
  EXPECT_EQ(run->Advance(At(60.0)), RunPhase::kFinished);
  EXPECT_EQ(run->outcome().code, ErrorCode::kFlyBeforeCoord);
  EXPECT_THAT(watcher.due, ElementsAre(1, 2, 3, 4, 5, 6));
}

// OPT-7.97, OPT-7.98: the image of an input is what was read into it last, while its group was
// updated; behind UPDATE OFF the outside does not come through.
TEST(MetAndTold, AnAnalogueImageIsWhatWasReadLast) {
  const Ran ran = RunText(
      "VR[1]=IA[20]\nUPDATE IA /OFF\nDELAY 2\nVR[2]=IA[20]\nVR[3]=IA[21]\nUPDATE IA /ON\n"
      "VR[4]=IA[20]\nIMAGE IA\nDELAY 2\nVR[5]=IA[20]\n",
      {.inputs = {{SimTime(0), InputKind::kAnalogue, 20, 3.5},
                  {SimTime(0), InputKind::kAnalogue, 21, 4.5},
                  {At(1.0), InputKind::kAnalogue, 20, 7.5},
                  {At(3.0), InputKind::kAnalogue, 20, 9.5}},
       .variables = {"VR[1]", "VR[2]", "VR[3]", "VR[4]", "VR[5]"}});
  EXPECT_EQ(ran.variables.at("VR[1]"), "3.5");
  EXPECT_EQ(ran.variables.at("VR[2]"), "3.5");
  EXPECT_EQ(ran.variables.at("VR[3]"), "0.0");
  EXPECT_EQ(ran.variables.at("VR[4]"), "7.5");
  EXPECT_EQ(ran.variables.at("VR[5]"), "7.5");
}

// OPT-4.18: a STOP at an instant at which the program has written a passage, and nothing moves yet:
// it halts at that instant, wherever the program is.
TEST(MetAndTold, AStopAtTheInstantOfAPassageHaltsAtOnce) {
  for (int loops = 9990; loops <= 10'002; ++loops) {
    const auto run = RunOfText("COORD ABSOL\nPATH LIN\nVI[1]=0\n10 VI[1]=VI[1]+1\nIF VI[1] < " +
                               std::to_string(loops) +
                               " THEN 10\nMOVE (500.,1000.,-400.,0.,0.)/FLY\n"
                               "MOVE (1000.,1000.,-400.,0.,0.)\nDELAY 1\n");
    const motion::AxisPose home = run->state().axes;
    EXPECT_EQ(run->Advance(At(1e-3)), RunPhase::kRunning);
    if (run->state().time > SimTime(0)) continue;  // it has begun to move
    run->Apply({.kind = InputKind::kStop});
    EXPECT_EQ(run->Advance(At(2.0)), RunPhase::kHalted) << loops;
    EXPECT_EQ(run->state().time, SimTime(0)) << loops;
    EXPECT_EQ(run->state().halted_by, machine::HaltReason::kStop) << loops;
    EXPECT_EQ(run->state().axes, home) << loops;
    run->Apply({.kind = InputKind::kStart});
    EXPECT_EQ(run->Advance(At(60.0)), RunPhase::kFinished) << loops;
    EXPECT_NEAR(run->state().tip.tip.x(), 1000.0, 1e-3) << loops;
  }
}

// OPT-B.30, OPT-3.38: a STOP in a chain of short moves, however much of it is planned, brings the
// machine to rest; what is tested in the background meanwhile is tested at each of its ticks.
TEST(MetAndTold, AStopInAChainPassesOverNoTick) {
  std::string text = kThere + "WORK 0,0/ON/END (IL[20])\n";
  for (int k = 1; k <= 7; ++k)
    text += "MOVE (" + std::to_string(1000 + 10 * k) + ".," + (k % 2 == 0 ? "1000." : "1005.") +
            ",-400.,0.,0.)/FLY\n";
  text += "MOVE (1100.,1000.,-400.,0.,0.)\nWORK 0,0/OFF\n";
  const double begin = BeginOf(text);
  for (int tick = 1; tick <= 30; ++tick) {
    for (const double behind : {0.015, 0.03, 0.045}) {
      const double at = begin + tick * kCycle_s;
      const Ran ran = RunText(text, {.inputs = {{At(at + 0.010), InputKind::kLogical, 20, 1.0},
                                                {At(at + behind), InputKind::kStop}}});
      EXPECT_NEAR(ran.First("beam off").at_s, at + kCycle_s, 1e-9) << tick << " " << behind;
    }
  }
}

// OPT-3.58, OPT-B.55: while the machine comes to its target behind an error that the program ran
// ahead to, no WORK that waits in the background switches the beam on any more.
TEST(MetAndTold, NoBeamComesOnTheWayToAnError) {
  const std::string text = kThere +
                           "WORK 0,0/ON/START (IL[20])/NEXT\nMOVE (1100.,1000.,-400.,0.,0.)/FLY\n"
                           "VR[0]=1./VR[9]\nMOVE (1100.,1100.,-400.,0.,0.)\nWORK 0,0/OFF\n";
  const double begin = BeginOf(text);
  const Ran ran = RunText(text, {.inputs = {{At(begin + 1.0), InputKind::kLogical, 20, 1.0},
                                            {At(begin + 1.1), InputKind::kLogical, 21, 1.0}}});
  EXPECT_EQ(CodeOf(ran), 7201);
  EXPECT_FALSE(ran.Told("beam on 100.0"));
  EXPECT_NEAR(ran.end.tip.tip.x(), 1100.0, 1e-6);
  EXPECT_GT(ran.First("E7201").at_s, begin + 2.0);
}

// OPT-1.03: a byte 1Ah ends a text: what such a condition makes of the rest is no expression.
TEST(MetAndTold, AConditionEndsWithItsText) {
  const auto said = [](const std::string& condition) {
    const Status taken =
        OptimoFamily().CheckBreakpoint({.at = {1, 1}, .condition = condition, .from_pass = 1});
    return taken ? std::string("taken") : std::string(taken.error().detail);
  };
  EXPECT_EQ(said("VL[1]"), "taken");
  EXPECT_TRUE(said("VL[1] THEN 10\x1A").ends_with("is none: it is one expression"));
  EXPECT_NE(said("VL[1]\x1A"), "taken");
}

// OPT-1.33: where a file has more errors than are told one by one, formatting it counts the rest.
TEST(MetAndTold, FormattingCountsWhatItDoesNotTell) {
  constexpr std::size_t kBad = 5000;
  std::string text;
  for (std::size_t n = 0; n < kBad; ++n) text += "SPEED 200\n";
  const machine::FormattedText made = OptimoFamily().tools()->Format({"a.S", text});
  EXPECT_FALSE(made.readable);
  EXPECT_LT(made.diagnostics.size(), kBad);
  EXPECT_EQ(made.diagnostics.size() + made.diagnostics_dropped.count(), kBad);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::met_and_told
