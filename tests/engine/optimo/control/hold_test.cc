#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/optimo/control/run_text.h"

// HOLD inside a chain of /FLY moves: motion.md 6. Two legs of 100 mm at SPEED 10 with a corner of
// 90 degrees, from rest to rest, are case C01: 4.089999848 s.
namespace rmlcell::optimo::testing {
namespace {

using machine::InputKind;

constexpr double kTwoLegs_s = 4.089999848;
constexpr double kDeviation_mm = 1.358847515;
const std::string kTwoCorners =
    kThere +
    "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)/FLY\n"
    "OL[16]=ON\nMOVE (1200.,1100.,-400.,0.,0.)/FLY\nMOVE (1200.,1200.,-400.,0.,0.)\n";

// When the chain begins.
double BeginOf(const std::string& text) { return ToSeconds(RunText(text).moves.front().at); }

Ran Held(const std::string& text, double hold_s, double start_s) {
  return RunText(text, {.inputs = {{FromSeconds(hold_s), InputKind::kHold},
                                   {FromSeconds(start_s), InputKind::kStart}}});
}

// OPT-4.17: on the second leg, whose bend is not begun: its own target is reached exactly, and
// settled.
TEST(Hold, MakesTheMoveUnderWayExact) {
  const double begin = BeginOf(kTwoCorners);
  const Ran ran = Held(kTwoCorners, begin + 3.0, begin + 20.0);
  EXPECT_EQ(ran.First("halt HOLD").step, 6);
  EXPECT_NEAR(ran.First("halt HOLD").at_s, begin + kTwoLegs_s, 1e-6);
  EXPECT_LT(ran.DistanceTo({1100.0, 1100.0, -400.0}), 1e-9);
  EXPECT_NEAR(ran.DistanceTo({1100.0, 1000.0, -400.0}), kDeviation_mm, 1e-6);
  EXPECT_NEAR(ran.DistanceTo({1200.0, 1100.0, -400.0}), kDeviation_mm, 1e-6);
  // What stood between the moves comes with START, and the other two legs from rest.
  EXPECT_NEAR(ran.First("OL[16] 1").at_s, begin + 20.0, 1e-9);
  EXPECT_NEAR(ran.time_s, begin + 20.0 + kTwoLegs_s, 1e-6);
}

// OPT-4.17: on the first leg the first target; 100 mm from rest to rest.
TEST(Hold, HaltsAtTheFirstTarget) {
  const double begin = BeginOf(kTwoCorners);
  const Ran ran = Held(kTwoCorners, begin + 1.0, begin + 20.0);
  EXPECT_EQ(ran.First("halt HOLD").step, 5);
  EXPECT_NEAR(ran.First("halt HOLD").at_s,
              begin + 100.0 / 50.0 + 2.0 * std::sqrt(50.0 / 40000.0) + 0.048, 1e-6);
  EXPECT_LT(ran.DistanceTo({1100.0, 1000.0, -400.0}), 1e-9);
  EXPECT_NEAR(ran.end.tip.tip.y(), 1200.0, 1e-4);
}

// OPT-4.17: a target straight on that it halts on is no passage any more.
TEST(Hold, ATargetThatItHaltsOnIsNoPassage) {
  const std::string text =
      kThere + "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1200.,1000.,-400.,0.,0.)\n";
  const auto passage_of_first = [](const Ran& ran) {
    for (const Ran::Part& part : ran.parts) {
      if (part.done.end == ran.moves.at(1).at) return part.motion.corner.passage;
    }
    ADD_FAILURE() << "nothing ends there";
    return motion::Passage::kBlend;
  };
  EXPECT_EQ(passage_of_first(RunText(text)), motion::Passage::kThrough);
  const double begin = BeginOf(text);
  const Ran held = Held(text, begin + 1.0, begin + 20.0);
  EXPECT_EQ(held.First("halt HOLD").step, 5);
  EXPECT_EQ(passage_of_first(held), motion::Passage::kStop);
}

// OPT-4.17: inside the bend the next move is finished too.
TEST(Hold, FinishesTheBendAndTheNextMove) {
  const Ran free = RunText(kTwoCorners);
  const double begin = ToSeconds(free.moves.front().at);
  double in_bend = 0.0;
  for (const Ran::Part& part : free.parts) {
    if (part.motion.path.kind() != motion::PathPiece::Kind::kBlend) continue;
    in_bend = ToSeconds(part.done.start) + 0.01;
    break;
  }
  ASSERT_GT(in_bend, begin);
  const Ran ran = Held(kTwoCorners, in_bend, begin + 20.0);
  EXPECT_EQ(ran.First("halt HOLD").step, 6);
  EXPECT_NEAR(ran.First("halt HOLD").at_s, begin + kTwoLegs_s, 1e-6);
}

// OPT-4.17: moves of 1 mm at 200 mm/s, on none of which the machine can come to rest: that takes 15
// mm (200 / 2000 + 2000 / 40000 s at 100 mm/s in the mean). It halts on a target within the next
// few more, goes no way twice, and START makes the rest.
TEST(Hold, HaltsOnATargetWhereMovesAreTooShortToBrake) {
  std::string text = "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n";
  constexpr int kMoves = 200;
  for (int k = 1; k <= kMoves; ++k) {
    text += "MOVE (" + std::to_string(1000 + k) + ".,1000.,-400.,0.,0.)";
    text += k < kMoves ? "/FLY\n" : "\n";
  }
  const Ran free = RunText(text);
  const double begin = ToSeconds(free.moves.front().at);
  const double hold = begin + 0.5;  // 200 x (0.5 - 0.075) = 85 mm on the way
  const Ran ran = Held(text, hold, begin + 20.0);
  const Ran::Event& halt = ran.First("halt HOLD");
  const int target = halt.step - 4;
  EXPECT_GE(target, 85 + 15);
  EXPECT_LE(target, 85 + 15 + 8);
  EXPECT_GT(halt.at_s, hold + 0.15);
  EXPECT_LT(halt.at_s, hold + 0.35);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1000.0 + kMoves, 1e-4);
  double travelled = 0.0;
  for (const Ran::Part& part : ran.parts) {
    if (part.motion.path.kind() == motion::PathPiece::Kind::kLine &&
        part.done.start >= ran.moves.front().at) {
      travelled += part.done.travelled - part.done.from;
    }
  }
  EXPECT_NEAR(travelled, kMoves, 1e-6);
}

// OPT-4.17: the same at 200 mm/s after 85.5 mm: at rest after 15 mm more, so just on the target at
// 101 mm, the first that can be reached.
TEST(Hold, HaltsOnTheFirstTargetThatCanBeReached) {
  std::string text = "COORD ABSOL\nPATH LIN\nMOVE (1000.,1000.,-400.,0.,0.)\nSPEED 40\n";
  for (int k = 1; k <= 200; ++k) {
    text += "MOVE (" + std::to_string(1000 + k) + ".,1000.,-400.,0.,0.)";
    text += k < 200 ? "/FLY\n" : "\n";
  }
  const double begin = BeginOf(text);
  const Ran ran = Held(text, begin + 0.5025, begin + 20.0);
  EXPECT_EQ(ran.First("halt HOLD").step - 4, 101);
  EXPECT_NEAR(ran.end.tip.tip.x(), 1200.0, 1e-4);
}

// OPT-4.17: while it still speeds up, it has all the room there is: the first target, in the time
// of 100 mm from rest to rest and a little more, as the acceleration is brought to zero first.
TEST(Hold, WhileSpeedingUp) {
  const double begin = BeginOf(kTwoCorners);
  for (const double later : {0.01, 0.03, 0.06}) {
    const Ran ran = Held(kTwoCorners, begin + later, begin + 20.0);
    const double taken = ran.First("halt HOLD").at_s - begin;
    EXPECT_EQ(ran.First("halt HOLD").step, 5) << later;
    EXPECT_GE(taken, 100.0 / 50.0 + 2.0 * std::sqrt(50.0 / 40000.0) + 0.048 - 1e-6);
    EXPECT_LE(taken, 100.0 / 50.0 + 2.0 * std::sqrt(50.0 / 40000.0) + 0.048 + 0.02);
  }
}

// OPT-4.17, OPT-4.37: what was held back is a chain like any other: it can be held again, and the
// override acts on it: three legs are left, two corners of them at 25 mm/s, those of case C02.
TEST(Hold, TheRestIsAChainAgain) {
  const double begin = BeginOf(kTwoCorners);
  const Ran twice =
      RunText(kTwoCorners, {.inputs = {{FromSeconds(begin + 1.0), InputKind::kHold},
                                       {FromSeconds(begin + 20.0), InputKind::kStart},
                                       {FromSeconds(begin + 23.0), InputKind::kHold},
                                       {FromSeconds(begin + 40.0), InputKind::kStart}}});
  EXPECT_EQ(twice.Count("halt HOLD"), 2);
  EXPECT_LT(twice.DistanceTo({1100.0, 1000.0, -400.0}), 1e-9);
  EXPECT_NEAR(twice.DistanceTo({1100.0, 1100.0, -400.0}), kDeviation_mm, 1e-6);
  EXPECT_LT(twice.DistanceTo({1200.0, 1100.0, -400.0}), 1e-9);
  EXPECT_NEAR(twice.end.tip.tip.y(), 1200.0, 1e-4);
  const Ran slower = RunText(
      kTwoCorners, {.inputs = {{FromSeconds(begin + 1.0), InputKind::kHold},
                               {FromSeconds(begin + 20.0), InputKind::kStart},
                               {FromSeconds(begin + 21.0), InputKind::kOverride, 0, 50.0}}});
  EXPECT_NEAR(slower.DistanceTo({1100.0, 1100.0, -400.0}), 0.480425146, 1e-4);
  EXPECT_NEAR(slower.DistanceTo({1200.0, 1100.0, -400.0}), 0.480425146, 1e-4);
}

// OPT-2.59, OPT-4.17: a chain that ends in a move of /NEXT, held and started: the program goes on
// beside that move again.
TEST(Hold, ANextMoveBehindTheHaltGoesOnBesideTheProgram) {
  const std::string text =
      kThere +
      "MOVE (1100.,1000.,-400.,0.,0.)/FLY\nMOVE (1100.,1100.,-400.,0.,0.)/FLY\n"
      "MOVE (1200.,1100.,-400.,0.,0.)/NEXT\nOL[16]=ON\n";
  const double begin = BeginOf(text);
  const Ran ran = Held(text, begin + 1.0, begin + 20.0);
  EXPECT_EQ(ran.outcome.kind, machine::OutcomeKind::kCompleted);
  EXPECT_LT(ran.First("OL[16] 1").at_s, ToSeconds(ran.moves.back().at) - 1.0);
}

}  // namespace
}  // namespace rmlcell::optimo::testing
