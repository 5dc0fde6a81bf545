// Chains of a mill in the planner: motion.md section 7, corners.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "engine/motion/planner/planner.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

MachineLimits Mill() {
  MachineLimits mill;
  mill.tip_speed_mm_s = 60.0;
  mill.tip_acceleration_mm_s2 = 200.0;
  mill.tip_jerk_mm_s3 = std::numeric_limits<double>::infinity();
  mill.settling_s = 0.0;
  mill.corners = MachineLimits::Corners::kThrough;
  mill.junction_jump_mm_s = 3.0;
  mill.junction_jump_a_rad_s = 0.5;
  return mill;
}

MoveCommand LineOf(const TipPose& from, const TipPose& to, double speed) {
  MoveCommand move;
  move.path = PathPiece::Line(from, to);
  move.head = MillHead{};
  move.limits = PathLimits{.speed = speed, .acceleration = 200.0};
  move.fly = true;
  return move;
}

std::vector<PlannedMotion> Planned(const std::vector<MoveCommand>& moves) {
  Planner planner(Mill());
  for (const MoveCommand& move : moves) EXPECT_TRUE(planner.Append(move));
  planner.Stop();
  std::vector<PlannedMotion> motions;
  while (const auto item = planner.Next()) motions.push_back(std::get<PlannedMotion>(*item));
  return motions;
}

// Limits in mm/s go before fractions of the machine's, and to the last bit.
TEST(MillChain, TakesLimitsOfTheCaller) {
  const auto motions = Planned({LineOf({{0, 0, 0}}, {{10, 0, 0}}, 7.3)});
  ASSERT_EQ(motions.size(), 1u);
  EXPECT_EQ(motions[0].speed.peak_speed(), 7.3);
  EXPECT_NEAR(motions[0].duration_s(), 10.0 / 7.3 + 7.3 / 200.0, 1e-12);
}

// A passage may be given a limit of its own, besides the vertex.
TEST(MillChain, KeepsTheSpeedOfAPassage) {
  std::vector<MoveCommand> moves = {LineOf({{0, 0, 0}}, {{10, 0, 0}}, 20.0),
                                    LineOf({{10, 0, 0}}, {{20, 0, 0}}, 20.0)};
  EXPECT_EQ(Planned(moves)[0].speed.end().speed, 20.0);
  moves[0].passage_speed_mm_s = 4.5;
  EXPECT_EQ(Planned(moves)[0].speed.end().speed, 4.5);
}

// A starts to turn with 0.1 rad/mm on a straight line, and may jump to 0.5 rad/s: 5 mm/s.
TEST(MillChain, KeepsTheJumpOfTheRotaryAxis) {
  const auto motions = Planned(
      {LineOf({{0, 0, 0}}, {{10, 0, 0}}, 20.0), LineOf({{10, 0, 0}}, {{20, 0, 0}, 1.0}, 20.0)});
  EXPECT_DOUBLE_EQ(motions[0].speed.end().speed, 5.0);
}

// motion.md 5.5: a straight line of thousands of short ones comes out while it comes in.
TEST(MillChain, LetsALineOutBeforeItIsOver) {
  Planner planner(Mill());
  std::size_t out = 0;
  for (int k = 0; k < 5000; ++k) {
    ASSERT_TRUE(planner.Append(LineOf({{0.1 * k, 0, 0}}, {{0.1 * (k + 1), 0, 0}}, 20.0)));
    while (planner.NextInPlace() != nullptr) ++out;
  }
  EXPECT_GT(out, 3000u);  // 1 mm is all that it takes to stop
  EXPECT_EQ(planner.lookahead_starved(), 0u);
}

}  // namespace
}  // namespace rmlcell::motion
