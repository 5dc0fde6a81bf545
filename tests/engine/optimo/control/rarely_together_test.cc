// What comes together rarely: a timer whose GOSUB calls another program, one that is due while a
// condition is waited for, a chain that is moved by hand, a STOP that has to wait.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "engine/machine/observer.h"
#include "engine/optimo/control/optimo_family.h"
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

}  // namespace
}  // namespace rmlcell::optimo::testing::rarely_together
