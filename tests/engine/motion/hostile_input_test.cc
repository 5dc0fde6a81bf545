// Inputs that no program should have: an error or a result, never a hang. motion.md section 10,
// fuzz.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/engine/motion/random_chain.h"
#include "tests/fuzz/motion_planner_input.h"

namespace rmlcell::motion {
namespace {

TEST(HostileInput, RandomBytesGiveSoundPlans) {
  std::mt19937_64 bits(99);
  for (int round = 0; round < 1000; ++round) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(bits() % 400));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(bits() >> 40);
    ASSERT_EQ(PlanBytes(bytes), "") << round;
  }
}

// A share that is no number is none: the passage is a stop, and every figure a number.
TEST(HostileInput, AnOvershootThatIsNoNumberMakesNoPassage) {
  Planner planner(StandardMachine());
  MoveCommand move{.path = PathPiece::Line({{0, 0, 0}}, {{10, 0, 0}})};
  move.overshoot_fraction = std::numeric_limits<double>::quiet_NaN();
  move.fly = true;
  ASSERT_TRUE(planner.Append(move));
  move.path = PathPiece::Line({{10, 0, 0}}, {{10, 10, 0}});
  ASSERT_TRUE(planner.Append(move));
  planner.Stop();
  const auto item = planner.Next();
  ASSERT_TRUE(item);
  EXPECT_EQ(std::get<PlannedMotion>(*item).speed.end().speed, 0.0);
}

// A million moves of 1e-9 mm make one way of 1e-3 mm; a million to one place make none.
TEST(HostileInput, AMillionTinyMoves) {
  for (const double step : {1e-9, 0.0}) {
    Planner planner(StandardMachine());
    double length = 0.0;
    TipPose at;
    const auto drain = [&] {
      while (const std::optional<PlannedItem> item = planner.Next()) {
        length += std::get<PlannedMotion>(*item).path.length();
      }
    };
    for (int k = 1; k <= 1'000'000; ++k) {
      const TipPose to{{step * k, 0, 0}};
      MoveCommand move;
      move.path = PathPiece::Line(at, to);
      move.fly = true;
      ASSERT_TRUE(planner.Append(move));
      drain();
      at = to;
    }
    planner.Stop();
    drain();
    EXPECT_NEAR(length, step * 1e6, 1.1e-6);
  }
}

// A straight line without end stays in the window.
TEST(HostileInput, EndlessStraightLine) {
  Planner planner(StandardMachine(), 256);
  std::size_t waiting = 0, most = 0;
  for (int k = 0; k < 50'000; ++k) {
    MoveCommand move;
    move.path = PathPiece::Line({{1e-3 * k, 0, 0}}, {{1e-3 * (k + 1), 0, 0}});
    move.fly = true;
    ASSERT_TRUE(planner.Append(move));
    ++waiting;
    while (planner.Next()) --waiting;
    most = std::max(most, waiting);
  }
  EXPECT_LT(most, 4096u);
  EXPECT_GT(planner.lookahead_starved(), 0u);
}

// A part of a bend that ends by less than the last digit before the bend does: there is no stretch
// for what is left.
TEST(HostileInput, PartEndsJustBeforeItsBend) {
  const std::vector<std::uint8_t> bytes{
      0x90, 0x81, 0x81, 0x81, 0x21, 0xc7, 0xc7, 0xc7, 0x81, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7,
      0xc7, 0xc7, 0xc7, 0x31, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7,
      0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7,
      0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7,
      0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7, 0xc7,
      0xc7, 0xc7, 0xc7, 0x81, 0x81, 0x01, 0x81, 0x81, 0x90, 0xd0, 0x81};
  EXPECT_EQ(PlanBytes(bytes), "");
}

}  // namespace
}  // namespace rmlcell::motion
