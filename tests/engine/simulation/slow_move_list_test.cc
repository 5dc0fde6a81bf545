#include "engine/simulation/report/slow_move_list.h"

#include <gtest/gtest.h>

namespace rmlcell::simulation {
namespace {

SlowMove Slow(int program, int step, double reached, double wanted,
              SlowCause cause = SlowCause::kShort) {
  return {.place = {.program = program, .step = step},
          .cause = cause,
          .wanted_mm_s = wanted,
          .reached_mm_s = reached};
}

// motion.md 8.2: how many, by cause, and the one that came least near by its share: 20 of 100 is
// less than 10 of 40.
TEST(SlowMoves, AreCountedByCause) {
  SpeedShortfall shortfall;
  Count(Slow(1, 1, 10.0, 40.0, SlowCause::kAxis), shortfall);
  EXPECT_EQ(shortfall.worst.step, 1);
  EXPECT_EQ(shortfall.wanted_mm_s, 40.0);
  EXPECT_EQ(shortfall.reached_mm_s, 10.0);
  Count(Slow(1, 2, 20.0, 100.0, SlowCause::kRadius), shortfall);
  EXPECT_EQ(shortfall.worst.step, 2);
  EXPECT_EQ(shortfall.wanted_mm_s, 100.0);
  EXPECT_EQ(shortfall.reached_mm_s, 20.0);
  Count(Slow(1, 3, 4.0, 20.0, SlowCause::kAcceleration), shortfall);  // as slow: the first stays
  Count(Slow(1, 4, 30.0, 40.0), shortfall);
  Count(Slow(1, 5, 30.0, 40.0), shortfall);
  EXPECT_EQ(shortfall.worst.step, 2);
  EXPECT_EQ(shortfall.moves, 5u);
  EXPECT_EQ(shortfall.by_axis, 1u);
  EXPECT_EQ(shortfall.by_radius, 1u);
  EXPECT_EQ(shortfall.by_acceleration, 1u);
  EXPECT_EQ(shortfall.too_short, 2u);
}

TEST(SlowMoves, CausesHaveNames) {
  EXPECT_EQ(SlowCauseText(SlowCause::kAxis), "axis");
  EXPECT_EQ(SlowCauseText(SlowCause::kRadius), "radius");
  EXPECT_EQ(SlowCauseText(SlowCause::kShort), "short");
  EXPECT_EQ(SlowCauseText(SlowCause::kAcceleration), "acceleration");
}

// One entry a step, its slowest move, in order of first occurrence; steps of two programs are two.
TEST(SlowMoveList, KeepsTheSlowestOfAStep) {
  SlowMoveList list;
  list.Add(Slow(1, 7, 10.0, 40.0, SlowCause::kAxis));
  list.Add(Slow(2, 7, 10.0, 40.0));
  list.Add(Slow(1, 7, 20.0, 40.0, SlowCause::kRadius));
  list.Add(Slow(1, 7, 5.0, 40.0, SlowCause::kAcceleration));
  list.Add(Slow(1, 7, 30.0, 40.0));
  ASSERT_EQ(list.moves().size(), 2u);
  EXPECT_EQ(list.moves()[0].place.program, 1);
  EXPECT_EQ(list.moves()[0].reached_mm_s, 5.0);
  EXPECT_EQ(SlowCauseText(list.moves()[0].cause), "acceleration");
  EXPECT_EQ(list.moves()[0].count, 4u);
  EXPECT_EQ(list.moves()[1].count, 1u);
  EXPECT_EQ(list.dropped(), 0u);
}

// Both sides of the limit: the thousandth step is listed, a further one counted only.
TEST(SlowMoveList, IsBounded) {
  SlowMoveList list;
  const int limit = static_cast<int>(kReportedSlowMovesMax);
  EXPECT_EQ(limit, 1000);
  for (int step = 1; step <= limit; ++step) list.Add(Slow(1, step, 1.0, 2.0));
  EXPECT_EQ(list.moves().size(), kReportedSlowMovesMax);
  EXPECT_EQ(list.dropped(), 0u);
  list.Add(Slow(1, limit + 1, 1.0, 2.0));
  list.Add(Slow(1, limit, 1.0, 2.0));
  EXPECT_EQ(list.moves().size(), kReportedSlowMovesMax);
  EXPECT_EQ(list.moves().back().count, 2u);
  EXPECT_EQ(list.dropped(), 1u);
}

}  // namespace
}  // namespace rmlcell::simulation
