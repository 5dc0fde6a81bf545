// Marks on the ramp of a STOP that begins behind the motion under way.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/motion/ride/path_ride.h"
#include "tests/engine/motion/items_text.h"
#include "tests/engine/motion/standard_machine.h"

namespace rmlcell::motion::path_ride_marks {
namespace {

// 100, 0.5 and 100 mm straight on at 50 mm/s, each with a mark behind it: 11, 12 and 13.
PathRide RideWithMarks() {
  Planner planner(StandardMachine());
  const double ends[4] = {0.0, 100.0, 100.5, 200.5};
  for (std::size_t k = 0; k < 3; ++k) {
    MoveCommand move;
    move.path = PathPiece::Line({{ends[k], 0, 0}}, {{ends[k + 1], 0, 0}});
    move.speed_fraction = 0.1;
    move.acceleration_fraction = 1.0 - 0.1 * static_cast<double>(k);  // else they are one move
    move.fly = k < 2;
    move.tag = k + 1;
    EXPECT_TRUE(planner.Append(move));
    planner.Mark(11 + k);
  }
  planner.Stop();
  PathRide ride(HoldRamp::kStays);
  while (const std::optional<PlannedItem> item = planner.Next()) ride.Plan(*item);
  return ride;
}

// STOP at the very end of the first line: its mark is passed first, and each of the others where
// its line ends. The ramp of 1.77 mm goes over the second line into the third.
TEST(PathRideMarks, AtTheEndOfAMotionEachMarkStaysBehindItsOwn) {
  PathRide ride = RideWithMarks();
  const SimTime begin = std::chrono::seconds(5);
  const AxisLimits axes = StandardMachine().axes;
  const SimTime now = ride.Begin(begin).arrival + SimTime(1);
  const auto plan = ride.PlanStop(now, axes);
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->rests_on, 3U);
  ASSERT_EQ(plan->ramp.motions.size(), 2U);
  ride.Stop(*plan, axes);
  EXPECT_EQ(ItemsOf(ride.to_come()), " m11 2 m12 3");
  EXPECT_EQ(ItemsOf(ride.interrupted()), " 3 m13");
}

// path_ride.h: behind a STOP what is interrupted is the rest from there, and nothing of an earlier
// one.
TEST(PathRideMarks, ASecondStopLeavesItsOwnRest) {
  PathRide ride = RideWithMarks();
  const AxisLimits axes = StandardMachine().axes;
  const auto plan = ride.PlanStop(ride.Begin(std::chrono::seconds(5)).arrival, axes);
  ASSERT_TRUE(plan);
  ride.Stop(*plan, axes);
  const std::string rest = ItemsOf(ride.interrupted());
  ride.protocol().Rest();
  ride.protocol().Resume();
  ride.Stop(*plan, axes);
  EXPECT_EQ(ItemsOf(ride.interrupted()), rest);
}

// path_ride.h: a ride that is over in the middle of a motion, held, has nothing of it left.
TEST(PathRideMarks, AFinishedRideIsEmpty) {
  PathRide ride = RideWithMarks();
  for (const std::uint64_t tag : {1U, 2U, 3U}) ride.Append({.tag = tag, .move = MoveCommand{}});
  ride.Begin(std::chrono::seconds(5));
  ride.HoldBehind(1);
  ASSERT_NE(ride.under_way(), nullptr);
  ASSERT_EQ(ride.held().size(), 2U);
  ASSERT_FALSE(ride.to_come().empty());
  ride.Finish();
  EXPECT_EQ(ride.under_way(), nullptr);
  EXPECT_TRUE(ride.to_come().empty());
  EXPECT_TRUE(ride.held().empty());
  EXPECT_TRUE(ride.protocol().goes());
}

}  // namespace
}  // namespace rmlcell::motion::path_ride_marks
