// What the stages of the planner hold is a text: how a chain of moves gets from one to the next.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

#include "engine/core/number_text.h"
#include "engine/core/units.h"
#include "engine/motion/planner/motion_chain.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

void Append(MotionChain& chain, const TipPose& from, const TipPose& to, bool fly,
            std::uint64_t tag) {
  MoveCommand move;
  move.path = PathPiece::Line(from, to);
  move.fly = fly;
  move.tag = tag;
  chain.Append(move, chain.LimitsFor(move), true);
}

// The same by hand, for a stage that is looked at by itself.
void Add(LegStage& legs, const TipPose& from, const TipPose& to, bool fly, std::uint64_t tag) {
  MoveCommand move;
  move.path = PathPiece::Line(from, to);
  move.fly = fly;
  move.tag = tag;
  legs.Add(move, legs.LimitsFor(move), true);
}

// 100 mm along X in two lines, then 30 mm along Y, which changes Y by the whole speed.
void AddAngle(LegStage& legs) {
  Add(legs, {{0, 0, 0}}, {{40, 0, 0}}, true, 7);
  Add(legs, {{40, 0, 0}}, {{100, 0, 0}}, true, 8);
  Add(legs, {{100, 0, 0}}, {{100, 30, 0}}, true, 9);
}

// A mill whose axes may jump by 5 mm/s: so fast it passes the corner.
MachineLimits PlainMill() {
  MachineLimits machine = PlainMachine();
  machine.corners = MachineLimits::Corners::kThrough;
  machine.junction_jump_mm_s = 5.0;
  return machine;
}

// OVERSH of 100 % asks for the 100 mm/s of both sides at the corner; the last leg may still grow.
TEST(LegStageDump, LegsAreClosedByCorners) {
  LegStage legs(PlainMachine(), Planner::kWindow);
  EXPECT_EQ(legs.Dump(), "");
  AddAngle(legs);
  EXPECT_EQ(legs.Dump(),
            "leg 0: moves 0 to 1, length 100.000, BLEND at 100.000, ends the run\n"
            "leg 1: moves 2 to 2, length 30.000, open\n");
  EXPECT_FALSE(legs.closed(1));
  EXPECT_TRUE(legs.End());
  EXPECT_FALSE(legs.End());  // it stands already
  EXPECT_EQ(legs.Dump(),
            "leg 0: moves 0 to 1, length 100.000, BLEND at 100.000, ends the run\n"
            "leg 1: moves 2 to 2, length 30.000, STOP at 0.000, ends the run\n");
  legs.Settle();  // 5 mm are enough to reach 100 mm/s, and to stop
  EXPECT_EQ(legs.Dump(),
            "leg 0: moves 0 to 1, length 100.000, BLEND at 100.000, ends the run, speed 100.000\n"
            "leg 1: moves 2 to 2, length 30.000, STOP at 0.000, ends the run, speed 0.000\n");
  legs.TakeSpeed();
  legs.DropTaken();
  EXPECT_EQ(legs.Dump(),
            "leg 1: moves 2 to 2, length 30.000, STOP at 0.000, ends the run, speed 0.000\n");
}

// Points of a straight line that change nothing are one leg, of 17 moves where corners are passed
// through and none has to wait, else of half a window and one: then too little is known of it.
TEST(LegStageDump, ALineWithoutEndIsCut) {
  for (const bool through : {true, false}) {
    LegStage legs(through ? PlainMill() : PlainMachine(), 64);
    for (int k = 0; k < 40; ++k) Add(legs, {{1.0 * k, 0, 0}}, {{k + 1.0, 0, 0}}, true, 0);
    const std::string first = through ? "leg 0: moves 0 to 16, length 17.000, THROUGH at 100.000, "
                                        "ends the run\nleg 1: moves 17 to 33, "
                                      : "leg 0: moves 0 to 32, length 33.000, THROUGH at 100.000, "
                                        "ends the run\nleg 1: moves 33 to 39, ";
    EXPECT_TRUE(legs.Dump().starts_with(first)) << legs.Dump();
    EXPECT_EQ(legs.starved(), through ? 0U : 1U);
  }
}

// Limits that differ by less than 1e-9 of them are the same, and the moves one leg.
TEST(LegStageDump, LimitsThatAgreeMakeOneLeg) {
  for (const auto& [factor, one] : {std::pair{1.0 + 0.9e-9, true}, {1.0 + 1.1e-9, false}}) {
    for (const bool speed : {true, false}) {
      LegStage legs(PlainMachine(), 64);
      for (int k = 0; k < 2; ++k) {
        MoveCommand move;
        move.path = PathPiece::Line({{10.0 * k, 0, 0}}, {{10.0 * k + 10.0, 0, 0}});
        (speed ? move.speed_fraction : move.acceleration_fraction) = k == 0 ? 0.5 : 0.5 * factor;
        move.fly = true;
        legs.Add(move, legs.LimitsFor(move), true);
      }
      EXPECT_EQ(legs.legs().size(), one ? 1U : 2U) << factor << speed;
    }
  }
}

// What is passed straight on is one run, and becomes spans as one: so does the corner of a mill.
// Before the passes over spans no knot is final. 5 mm/s take 5 * 5 / 2000 mm, so neither line is
// too short for them.
TEST(SpanStageDump, SpansTakeTheLegsAndGetTheirSpeeds) {
  SpanStage spans(PlainMill(), Planner::kWindow);
  AddAngle(spans.leg_stage());
  spans.leg_stage().End();
  EXPECT_FALSE(spans.Resolve(false));  // the running speeds of the legs are not known yet
  EXPECT_EQ(spans.Dump(), "");
  spans.leg_stage().Settle();
  EXPECT_TRUE(spans.Resolve(false));
  EXPECT_EQ(spans.Dump(), "");
  EXPECT_TRUE(spans.Resolve(false));
  EXPECT_EQ(spans.Dump(),
            "span 0: moves 0 from 0.000 to 1 at 60.000, length 100.000, THROUGH at most 5.000, "
            "open\n"
            "span 1: moves 2 from 0.000 to 2 at 30.000, length 30.000, STOP at most 0.000, open\n");
  EXPECT_FALSE(spans.Resolve(false));
  EXPECT_EQ(spans.leg_stage().Dump(), "");
  spans.Settle();
  EXPECT_EQ(spans.Dump(),
            "span 0: moves 0 from 0.000 to 1 at 60.000, length 100.000, THROUGH at most 5.000, "
            "passed at 5.000\n"
            "span 1: moves 2 from 0.000 to 2 at 30.000, length 30.000, STOP at most 0.000, "
            "passed at 0.000\n");
  spans.DropOldest();
  EXPECT_EQ(spans.Dump(),
            "span 1: moves 2 from 0.000 to 2 at 30.000, length 30.000, STOP at most 0.000, "
            "passed at 0.000\n");
}

// A section ends where a knot is passed as fast as it may be: here each span is one. The second
// begins with the 5 mm/s of the corner. What is taken of a move is gone from the stages before.
TEST(ItemStageDump, SectionsAreGivenOutMoveByMove) {
  ItemStage items(PlainMill(), Planner::kWindow);
  SpanStage& spans = items.span_stage();
  LegStage& legs = spans.leg_stage();
  AddAngle(legs);
  items.AddMark(4);
  legs.End();
  legs.Settle();
  while (spans.Resolve(false)) {
  }
  EXPECT_EQ(items.Next(), nullptr);  // no speed of a span is known
  spans.Settle();
  EXPECT_EQ(items.Next(), nullptr);  // nothing may be worked on yet
  items.AllowAll();
  EXPECT_EQ(items.Dump(), "mark 4: waits for move 2\n");
  EXPECT_EQ(std::get<PlannedMotion>(*items.Next()).tag, 7U);
  EXPECT_EQ(items.Dump(), "section: 1 spans, from 0.000, one profile\nmark 4: waits for move 2\n");
  EXPECT_EQ(std::get<PlannedMotion>(*items.Next()).tag, 8U);
  EXPECT_EQ(items.Dump(), "mark 4: waits for move 2\n");
  EXPECT_EQ(legs.moves().size(), 2U);  // one that is at its end, and the one behind it
  const auto& last = std::get<PlannedMotion>(*items.Next());
  EXPECT_EQ(last.tag, 9U);
  EXPECT_NEAR(last.speed.At(0.0).speed, 5.0, 1e-9);
  EXPECT_EQ(items.Dump(), "mark 4\n");
  EXPECT_EQ(spans.Dump(), "");
  EXPECT_TRUE(legs.moves().empty());
}

// motion.md 5.5: where the window is full, half of what waits is passed as if the machine had to
// stand behind it. Behind 50 mm to speed up on, 10 mm/s2 over steps of 0.1 mm: v^2 = 2 n where n
// steps are to come. Of the 40 moves the legs know half, and half a window and one of these are a
// run of 17 spans.
TEST(SpanStageDump, HalfOfWhatWaitsIsAccepted) {
  SpanStage spans(PlainMachine(), 32);
  LegStage& legs = spans.leg_stage();
  for (int k = 0; k < 40; ++k) {
    MoveCommand move;
    const double from = k == 0 ? -50.0 : 0.1 * (k - 1);
    move.path = PathPiece::Line({{from, 0, 0}}, {{0.1 * k, 0, 0}});
    move.speed_fraction = k % 2 == 0 ? 0.9 : 1.0;  // else they would be one leg
    move.acceleration_fraction = k == 0 ? 1.0 : 0.01;
    move.fly = true;
    legs.Add(move, legs.LimitsFor(move), true);
  }
  legs.AcceptHalf();
  while (spans.Resolve(true)) {
  }
  spans.AcceptHalf();
  std::string wanted;
  for (int k = 0; k < 17; ++k)
    wanted += k < 8 ? "passed at " + FixedText(std::sqrt(2.0 * (16 - k)), 3) + "\n" : "open\n";
  std::string told;  // the end of each line
  std::istringstream lines(spans.Dump());
  for (std::string line; std::getline(lines, line);)
    told += line.substr(line.rfind(", ") + 2) + "\n";
  EXPECT_EQ(told, wanted);
}

// What is timed together of so many moves in a row, with ramps over 405 mm to 90 mm/s: no knot is
// passed as fast as it may be.
std::string SectionOf(std::size_t window, int moves) {
  MachineLimits machine = PlainMachine();
  machine.tip_acceleration_mm_s2 = 10.0;
  machine.tip_jerk_mm_s3 = 1000.0;
  machine.axes.jerk.fill(1e9);
  ItemStage items(machine, window);
  SpanStage& spans = items.span_stage();
  LegStage& legs = spans.leg_stage();
  for (int k = 0; k < moves; ++k) {
    MoveCommand move;
    move.path = PathPiece::Line({{0.1 * k, 0, 0}}, {{0.1 * (k + 1), 0, 0}});
    move.speed_fraction = k % 2 == 0 ? 0.9 : 1.0;  // else they would be one leg
    move.fly = true;
    legs.Add(move, legs.LimitsFor(move), true);
  }
  legs.End();
  legs.Settle();
  while (spans.Resolve(false)) {
  }
  spans.Settle();
  items.AllowAll();
  EXPECT_NE(items.Next(), nullptr);
  return items.Dump();
}

// As many spans are timed together as have room among 2560 cells with three to each: 853, of which
// one is taken here.
TEST(ItemStageDump, SectionsHaveAsManySpansAsThereIsRoomFor) {
  EXPECT_THAT(SectionOf(Planner::kWindow, 2000), testing::StartsWith("section: 852 spans, "));
}

// Nor more moves than half a window and one, whatever room there is: 33 of them, of which one is
// taken.
TEST(ItemStageDump, SectionsHaveNoMoreThanHalfAWindowOfMoves) {
  EXPECT_THAT(SectionOf(64, 60), testing::StartsWith("section: 32 spans, "));
}

// Where the machine stands a section ends, with a limit on jerk, too: no ramp runs across.
TEST(ItemStageDump, SectionsEndWhereTheMachineStands) {
  MachineLimits machine = PlainMachine();
  machine.tip_jerk_mm_s3 = 1e5;
  machine.axes.jerk.fill(1e9);
  ItemStage items(machine, Planner::kWindow);
  SpanStage& spans = items.span_stage();
  LegStage& legs = spans.leg_stage();
  for (int k = 0; k < 3; ++k) Add(legs, {{10.0 * k, 0, 0}}, {{10.0 * k + 10.0, 0, 0}}, false, 0);
  legs.Settle();
  while (spans.Resolve(false)) {
  }
  spans.Settle();
  items.AllowAll();
  for (int k = 0; k < 3; ++k) {
    ASSERT_NE(items.Next(), nullptr);
    EXPECT_EQ(items.Dump(), "");  // one span of one move, which is out
  }
  EXPECT_EQ(items.Next(), nullptr);
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

// The curve beside an arc takes long: each is worked out when what is behind it is known, and not
// all of them with the last move of the chain.
TEST(ChainDump, CurvesBesideArcsAreWorkedOutOnTheWay) {
  MachineLimits machine = PlainMachine();
  machine.tip_jerk_mm_s3 = 1e5;
  MotionChain chain(machine, Planner::kWindow);
  for (int k = 0; k < 12; ++k) {  // half circles side by side, each corner a turn of 90 degrees
    const TipPose from{{100.0 * k, 0, 0}};
    MoveCommand move;
    move.path = k % 2 == 0
                    ? PathPiece::Circle(from, {100.0 * k + 50.0, 0, 0}, {0, 0, 1}, kPi, 0.0, 0.0)
                    : PathPiece::Line(from, {{100.0 * (k + 1), 0, 0}});
    move.fly = true;
    chain.Append(move, chain.LimitsFor(move), true);
    const std::string text = chain.Dump();
    std::size_t waiting = 0;
    for (std::size_t at = text.find("leg "); at != std::string::npos;
         at = text.find("leg ", at + 1))
      ++waiting;
    EXPECT_LE(waiting, 2U) << text;
  }
}

// Behind the way of a move the halves of its curve wait, each for a move of its own, and between
// them what takes effect there.
TEST(ChainDump, TheHalvesOfACurveWaitBehindTheWay) {
  MotionChain chain(PlainMachine(), Planner::kWindow);
  Append(chain, {{0, 0, 0}}, {{100, 0, 0}}, true, 1);
  chain.Mark(5);
  Append(chain, {{100, 0, 0}}, {{100, 100, 0}}, false, 2);
  chain.Stop();
  EXPECT_EQ(std::get<PlannedMotion>(*chain.Next()).path.kind(), PathPiece::Kind::kLine);
  const std::string dump = chain.Dump();
  const auto next_half = [&chain] {
    const auto& half = std::get<PlannedMotion>(*chain.Next());
    EXPECT_EQ(half.path.kind(), PathPiece::Kind::kBlend);
    return "motion " + std::to_string(half.tag) + ": length " + FixedText(half.path.length(), 3) +
           " in " + FixedText(half.duration_s(), 6) + " s";
  };
  const std::string first = next_half();
  EXPECT_THAT(first, testing::StartsWith("motion 1: "));
  EXPECT_EQ(std::get<PlannedMark>(*chain.Next()).tag, 5U);
  const std::string second = next_half();
  EXPECT_THAT(second, testing::StartsWith("motion 2: "));
  EXPECT_THAT(dump, testing::EndsWith(first + ", BLEND\nmark 5\n" + second + "\n"));
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
