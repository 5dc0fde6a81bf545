// What the stages of the planner hold is a text: how a chain of moves gets from one to the next.
#include <gtest/gtest.h>

#include <string>

#include "engine/motion/planner/motion_chain.h"

namespace rmlcell::motion {
namespace {

// Without a limit on jerk, and with axes that are no bound: all figures follow from two numbers,
// 100 mm/s and 1000 mm/s2.
MachineLimits PlainMachine() {
  MachineLimits machine;
  machine.tip_speed_mm_s = 100.0;
  machine.tip_acceleration_mm_s2 = 1000.0;
  machine.tip_jerk_mm_s3 = HUGE_VAL;
  machine.settling_s = 0.0;
  machine.axes.speed.fill(1e6);
  machine.axes.acceleration.fill(1e6);
  machine.axes.jerk.fill(HUGE_VAL);
  return machine;
}

void Append(MotionChain& chain, const TipPose& from, const TipPose& to, bool fly,
            std::uint64_t tag) {
  MoveCommand move;
  move.path = PathPiece::Line(from, to);
  move.fly = fly;
  move.tag = tag;
  chain.Append(move, chain.LimitsFor(move), true);
}

// Two lines in a row are one leg, and open until the chain is at an end; then a span that takes
// 0.1 s to speed up over 5 mm, 0.9 s for the 90 mm between and 0.1 s to stop.
TEST(ChainDump, ALineSplitInTwoIsOneLeg) {
  MotionChain chain(PlainMachine(), Planner::kWindow);
  EXPECT_EQ(chain.Dump(), "");
  Append(chain, {{0, 0, 0}}, {{40, 0, 0}}, true, 7);
  Append(chain, {{40, 0, 0}}, {{100, 0, 0}}, true, 8);
  EXPECT_EQ(chain.Dump(), "leg 0: moves 0 to 1, length 100.000, open\n");
  chain.Mark(9);
  chain.Stop();
  EXPECT_EQ(chain.Dump(),
            "span 0: moves 0 from 0.000 to 1 at 60.000, length 100.000, STOP at most 0.000, "
            "passed at 0.000\n"
            "mark 9: waits for move 1\n");
  const PlannedItem* first = chain.Next();
  ASSERT_NE(first, nullptr);
  EXPECT_NEAR(std::get<PlannedMotion>(*first).duration_s(), 0.1 + 0.35, 1e-9);
  EXPECT_EQ(chain.Dump(),
            "span 0: moves 0 from 0.000 to 1 at 60.000, length 100.000, STOP at most 0.000, "
            "passed at 0.000\n"
            "section: 1 spans, from 0.000, one profile\n"
            "mark 9: waits for move 1\n");
  const PlannedItem* second = chain.Next();
  EXPECT_NEAR(std::get<PlannedMotion>(*second).duration_s(), 0.55 + 0.1, 1e-9);
  EXPECT_EQ(chain.Dump(), "mark 9\n");
  EXPECT_EQ(std::get<PlannedMark>(*chain.Next()).tag, 9U);
  EXPECT_EQ(chain.Dump(), "");
}

// A corner ends its leg. What is behind it must be known before its curve is: the last leg is open.
TEST(ChainDump, ACornerWaitsForWhatIsBehindIt) {
  MotionChain chain(PlainMachine(), Planner::kWindow);
  Append(chain, {{0, 0, 0}}, {{50, 0, 0}}, true, 1);
  Append(chain, {{50, 0, 0}}, {{50, 30, 0}}, false, 2);
  const std::string dump = chain.Dump();
  EXPECT_NE(dump.find("span 0: moves 0 from 0.000 to 0 at "), std::string::npos) << dump;
  EXPECT_NE(dump.find("BLEND"), std::string::npos) << dump;
  EXPECT_NE(dump.find("span 1: moves 1 from "), std::string::npos) << dump;
  EXPECT_NE(dump.find("to 1 at 30.000"), std::string::npos) << dump;
  EXPECT_EQ(dump.find("leg"), std::string::npos) << dump;
}

}  // namespace
}  // namespace rmlcell::motion
