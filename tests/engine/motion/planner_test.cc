#include "engine/motion/planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion {
namespace {

MoveCommand LineTo(const Vec3& from, const Vec3& to, std::uint64_t tag, bool fly = false) {
  MoveCommand move;
  move.path = PathPiece::Line({from}, {to});
  move.speed_fraction = 0.1;
  move.tag = tag;
  move.fly = fly;
  return move;
}

// "1 m7 2": motions by tag, marks with an m before it.
std::string Drain(Planner& planner) {
  std::string text;
  while (const std::optional<PlannedItem> item = planner.Next()) {
    if (!text.empty()) text += ' ';
    if (const auto* mark = std::get_if<PlannedMark>(&*item)) {
      text += 'm';
      text += std::to_string(mark->tag);
    } else {
      text += std::to_string(std::get<PlannedMotion>(*item).tag);
    }
  }
  return text;
}

// OPT-B.20: 500 mm at SPEED 10 takes 500/50 + 2 sqrt(50/40000) + 0.048 = 10.119 s.
TEST(Planner, MoveWithoutFlySettles) {
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineTo({}, {500, 0, 0}, 5)));
  const std::optional<PlannedItem> item = planner.Next();
  ASSERT_TRUE(item);
  const auto& motion = std::get<PlannedMotion>(*item);
  EXPECT_EQ(motion.tag, 5u);
  EXPECT_NEAR(motion.duration_s(), 10.0 + 2.0 * std::sqrt(50.0 / 40000.0) + 0.048, 1e-12);
  EXPECT_FALSE(motion.upper_bound);
}

// OPT-2.47: /FLY before a stop is as if absent, so the machine settles; before another move it does
// not.
TEST(Planner, FlySettlesOnlyWhereTheMachineStands) {
  Planner planner(StandardMachine());
  ASSERT_TRUE(planner.Append(LineTo({}, {10, 0, 0}, 1, true)));
  ASSERT_TRUE(planner.Append(LineTo({10, 0, 0}, {10, 10, 0}, 2, true)));
  planner.Stop();
  double settling[2] = {-1.0, -1.0};
  for (double& s : settling) {
    const std::optional<PlannedItem> item = planner.Next();
    ASSERT_TRUE(item);
    s = std::get<PlannedMotion>(*item).settling_s;
  }
  EXPECT_EQ(settling[0], 0.0);
  EXPECT_EQ(settling[1], 0.048);
}

TEST(Planner, KeepsTheOrderOfMotionsAndMarks) {
  Planner planner(StandardMachine());
  planner.Mark(9);
  ASSERT_TRUE(planner.Append(LineTo({}, {10, 0, 0}, 1, true)));
  planner.Mark(10);
  planner.Mark(11);
  ASSERT_TRUE(planner.Append(LineTo({10, 0, 0}, {20, 0, 0}, 2)));
  planner.Mark(12);
  planner.Stop();
  EXPECT_EQ(Drain(planner), "m9 1 m10 m11 2 m12");
}

// OPT-B.22: SPEED 0 and ACCEL below 0.1 are refused, and the planner is as before.
TEST(Planner, RefusesWhatWouldNeverArrive) {
  Planner planner(StandardMachine());
  MoveCommand move = LineTo({}, {10, 0, 0}, 1);
  move.speed_fraction = 0.0;
  EXPECT_EQ(planner.Append(move).error().code, ErrorCode::kNoMotion);
  move.speed_fraction = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(planner.Append(move).error().code, ErrorCode::kNoMotion);
  move.speed_fraction = 1.0;
  move.acceleration_fraction = 0.00099;
  EXPECT_EQ(planner.Append(move).error().code, ErrorCode::kNoMotion);
  move.acceleration_fraction = 0.001;
  EXPECT_TRUE(planner.Append(move));
  planner.Stop();
  EXPECT_EQ(Drain(planner), "1");
}

// A path of length zero adds nothing, whatever the speed. OPT-2.02
TEST(Planner, NothingToDoIsNoError) {
  Planner planner(StandardMachine());
  MoveCommand move = LineTo({1, 2, 3}, {1, 2, 3}, 1);
  move.speed_fraction = 0.0;
  EXPECT_TRUE(planner.Append(move));
  planner.Stop();
  EXPECT_EQ(Drain(planner), "");
}

TEST(Planner, RefusesWhatIsNotANumber) {
  Planner planner(StandardMachine());
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    EXPECT_EQ(planner.Append(LineTo({}, {bad, 0, 0}, 1)).error().code,
              ErrorCode::kTargetOutOfTravel);
  }
  EXPECT_FALSE(planner.Next());
}

}  // namespace
}  // namespace rmlcell::motion
