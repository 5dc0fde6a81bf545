#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// HOLD wherever a chain of /FLY moves is: more than once, before a stop that the chain makes by
// itself, on its last move. motion.md 6, OPT-4.17
namespace rmlcell::optimo::testing::hold_states {
namespace {

using machine::InputKind;

constexpr double kGap_s = 20.0;

machine::InputChange Key(double at_s, InputKind kind) { return {At(at_s), kind}; }

double RampTime(double change_mm_s) { return 2.0 * std::sqrt(change_mm_s / 40000.0); }

double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

// The parts follow each other in place, and in time but for halts.
void ExpectNoGaps(const Ran& ran) {
  for (std::size_t k = 1; k < ran.parts.size(); ++k) {
    const Ran::Part& before = ran.parts[k - 1];
    const Ran::Part& here = ran.parts[k];
    const motion::PathPose from = before.motion.path.At(before.done.travelled);
    const motion::PathPose to = here.motion.path.At(here.done.from);
    if (before.motion.path.in_axes() == here.motion.path.in_axes()) {
      EXPECT_NEAR((to.point - from.point).norm(), 0.0, 1e-6) << k;
    }
    const double gap = ToSeconds(here.done.start - before.done.end);
    EXPECT_TRUE(gap == 0.0 || gap > 1.0) << gap << " s before part " << k;
  }
}

std::string ShortMoves(int count) {
  std::string text = "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n";
  for (int k = 1; k <= count; ++k) {
    text += "MOVE (" + std::to_string(1000 + k) + ".,1000.,-400.,0.,0.)";
    text += k < count ? "/FLY\n" : "\n";
  }
  return text;
}

const std::string kCorners =
    kThere +
    "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)/FLY\n"
    "MOVE (1200.,1100.,-400.,0.,0.)/FLY\nMOVE (1200.,1200.,-400.,0.,0.)\n";

// OPT-4.18: START at the instant of a halt: nobody was waited for.
TEST(HoldStates, AHaltOfNoTimeIsNoWait) {
  const Ran ran = RunText("DELAY 1\nDELAY 1\n",
                          {.inputs = {Key(0.5, InputKind::kStop), Key(0.5, InputKind::kStart)}});
  EXPECT_EQ(ran.told, (std::vector<std::string>{"compiling 1", "wait dwell 0.5", "halt STOP",
                                                "wait dwell 0.5", "wait dwell 1.0"}));
}

// OPT-4.17: what moves is told without a gap, on one move as over many.
TEST(HoldStates, TheWayIsToldWithoutAGap) {
  for (const std::string& text : {kCorners, ShortMoves(100)}) {
    const Ran free = RunText(text);
    const double begin = ToSeconds(free.moves.front().at);
    const double length_s = free.time_s - begin;
    for (int k = 0; k < 10; ++k) {
      const double hold = begin + length_s * (k + 0.3) / 10.0;
      const Ran ran = RunText(
          text, {.inputs = {Key(hold, InputKind::kHold), Key(hold + kGap_s, InputKind::kStart)}});
      SCOPED_TRACE(hold);
      ExpectNoGaps(ran);
      EXPECT_NEAR((free.end.tip.tip - ran.end.tip.tip).norm(), 0.0, 1e-6);
      EXPECT_EQ(ran.moves.size(), free.moves.size());
    }
  }
}

// OPT-4.17: the key again while the machine is on its way to the target: nothing new.
TEST(HoldStates, AgainWhileBraking) {
  const std::string text = ShortMoves(200);
  const double hold = BeginOf(text) + 0.5025;
  const Ran once = RunText(
      text, {.inputs = {Key(hold, InputKind::kHold), Key(hold + kGap_s, InputKind::kStart)}});
  for (const double later : {0.02, 0.07, 0.12}) {
    const Ran twice =
        RunText(text, {.inputs = {Key(hold, InputKind::kHold), Key(hold + later, InputKind::kHold),
                                  Key(hold + kGap_s, InputKind::kStart)}});
    EXPECT_EQ(twice.Count("halt HOLD"), 1);
    EXPECT_EQ(twice.First("halt HOLD").step, once.First("halt HOLD").step);
    EXPECT_EQ(twice.First("halt HOLD").at_s, once.First("halt HOLD").at_s);
    EXPECT_EQ(twice.time_s, once.time_s);
    EXPECT_EQ(twice.parts.size(), once.parts.size());
  }
}

// OPT-4.17, motion.md 6: HOLD while a STOP brakes changes nothing of that; it halts at the first
// target behind START.
TEST(HoldStates, WhileAStopBrakes) {
  const double begin = BeginOf(kCorners);
  const double stop = begin + 1.0;
  const Ran ran =
      RunText(kCorners, {.inputs = {Key(stop, InputKind::kStop), Key(stop + 0.02, InputKind::kHold),
                                    Key(stop + kGap_s, InputKind::kStart)}});
  const Ran only = RunText(
      kCorners, {.inputs = {Key(stop, InputKind::kStop), Key(stop + kGap_s, InputKind::kStart)}});
  EXPECT_EQ(ran.First("halt STOP").at_s, only.First("halt STOP").at_s);
  EXPECT_NEAR(ran.First("halt STOP").at_s, stop + RampTime(50.0), 1e-6);
}

// OPT-4.17: on the last move of a chain there is nothing to keep back: it ends as it would.
TEST(HoldStates, OnTheLastMoveOfAChain) {
  const std::string text = kCorners + "OL[16]=ON\n";
  const Ran free = RunText(text);
  const Ran ran = RunText(text, {.inputs = {Key(free.time_s - 1.0, InputKind::kHold),
                                            Key(free.time_s + kGap_s, InputKind::kStart)}});
  EXPECT_NEAR(ran.First("halt HOLD").at_s, ToSeconds(free.moves.back().at), 1e-9);
  EXPECT_EQ(ran.First("halt HOLD").step, 8);
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, free.time_s + kGap_s, 1e-9);
  EXPECT_EQ(ran.parts.size(), free.parts.size());
}

// OPT-4.17, OPT-B.25: the path turns back at the target of the move under way, which ends in a stop
// by itself: it halts there, and what follows waits for START.
TEST(HoldStates, BeforeAReversal) {
  const std::string text =
      kThere +
      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1050.,1000.,-400.,0.,0.)/FLY\n"
      "MOVE (1050.,1100.,-400.,0.,0.)\n";
  const double begin = BeginOf(text);
  const Ran ran = RunText(text, {.inputs = {Key(begin + 1.0, InputKind::kHold),
                                            Key(begin + kGap_s, InputKind::kStart)}});
  EXPECT_EQ(ran.First("halt HOLD").step, 5);
  EXPECT_NEAR(ran.First("halt HOLD").at_s, begin + 100.0 / 50.0 + RampTime(50.0) + kSettle_s, 1e-6);
  EXPECT_NEAR(ran.end.tip.tip.y(), 1100.0, 1e-4);
  EXPECT_EQ(ran.parts.size(), RunText(text).parts.size());
  EXPECT_NEAR(ran.parts[1].motion.settling_s, kSettle_s, 1e-12);
  EXPECT_EQ(ran.Count("E7316"), 1);  // the reversal is told all the same
}

// OPT-4.17: the same from a move before it, whose bend has begun: the next move is finished, and
// that is where the path turns back.
TEST(HoldStates, InTheBendBeforeAReversal) {
  const std::string text =
      kThere +
      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)/FLY\n"
      "MOVE (1100.,1050.,-400.,0.,0.)/FLY\nMOVE (1200.,1050.,-400.,0.,0.)\n";
  const double begin = BeginOf(text);
  const double bend = begin + (100.0 - 2.0) / 50.0 + 0.5 * RampTime(50.0);
  const Ran ran = RunText(
      text, {.inputs = {Key(bend, InputKind::kHold), Key(begin + kGap_s, InputKind::kStart)}});
  EXPECT_EQ(ran.First("halt HOLD").step, 6);
  EXPECT_NEAR(ran.First("halt HOLD").at_s, begin + 4.089999848, 1e-6);  // case C01
  EXPECT_NEAR(ran.end.tip.tip.x(), 1200.0, 1e-4);
}

// OPT-4.17, OPT-2.25: a hole is one move: on its lead, which ends in a stop, HOLD finishes the
// circle.
TEST(HoldStates, OnTheLeadOfAHole) {
  const std::string text =
      kThere +
      "PATH HOLE (10.)\nMOVE (1100.,1000.,-400.,0.,0.)/VIA (1100.,1000.,-300.,0.,0.)/FLY\n"
      "PATH LIN\nMOVE (1090.,900.,-400.,0.,0.)/FLY\nMOVE (1000.,900.,-400.,0.,0.)\n";
  const double begin = BeginOf(text);
  const Ran ran = RunText(text, {.inputs = {Key(begin + 1.0, InputKind::kHold),
                                            Key(begin + kGap_s, InputKind::kStart)}});
  EXPECT_EQ(ran.First("halt HOLD").step, 6);
  // 90 mm and a turn of 62.8 mm, each from rest to rest.
  const double turn = 20.0 * M_PI;
  EXPECT_NEAR(ran.First("halt HOLD").at_s,
              begin + (90.0 + turn) / 50.0 + 2.0 * RampTime(50.0) + kSettle_s, 1e-3);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1000.0, 1e-4);
}

}  // namespace
}  // namespace rmlcell::optimo::testing::hold_states
