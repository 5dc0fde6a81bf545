#include "engine/simulation/report/violation_list.h"

#include <gtest/gtest.h>

namespace rmlcell::simulation {
namespace {

machine::TravelViolation Violation(int step, int axis, double excess, SimTime at) {
  return {.at = at, .place = {.program = 45, .step = step}, .axis = axis, .excess = excess};
}

// motion.md 8.2: step, axis, excess; of a loop the worst pass, with the time of the first.
TEST(ViolationList, KeepsTheWorstOfAStepAndTheFirstTime) {
  ViolationList list;
  list.Add(Violation(3, 0, 5.0, SimTime(10)));
  list.Add(Violation(3, 0, 7.0, SimTime(20)));
  list.Add(Violation(3, 0, 6.0, SimTime(30)));
  list.Add(Violation(3, 4, 0.5, SimTime(30)));
  ASSERT_EQ(list.violations().size(), 2U);
  EXPECT_EQ(list.violations()[0].axis, "X");
  EXPECT_EQ(list.violations()[0].excess, 7.0);
  EXPECT_EQ(list.violations()[0].first_at, SimTime(10));
  EXPECT_EQ(list.violations()[0].count, 3U);
  EXPECT_EQ(list.violations()[1].axis, "B");
  EXPECT_TRUE(list.violations()[1].rotary);
}

// All that was told of the worst pass; of two as bad the first.
TEST(ViolationList, TellsTheWorstPassWhole) {
  ViolationList list;
  machine::TravelViolation told = Violation(3, 1, 5.0, SimTime(10));
  told.at_target = true;
  told.axes = {{1, 2, 3}, 0.5, 0.25};
  told.tip = {{4, 5, 6}, 0.5, 0.25};
  list.Add(told);
  const AxisViolation first{.place = told.place,
                            .axis = "Y",
                            .excess = 5.0,
                            .at_target = true,
                            .axes = told.axes,
                            .tip = {4, 5, 6},
                            .first_at = SimTime(10)};
  EXPECT_EQ(list.violations()[0], first);
  machine::TravelViolation again = Violation(3, 1, 5.0, SimTime(20));
  list.Add(again);
  EXPECT_EQ(list.violations()[0].axes, told.axes);
  EXPECT_EQ(list.violations()[0].count, 2U);
  again.excess = 5.5;
  list.Add(again);
  EXPECT_EQ(list.violations()[0].axes, again.axes);
  EXPECT_FALSE(list.violations()[0].at_target);
  EXPECT_EQ(list.violations()[0].count, 3U);
}

TEST(ViolationList, IsBounded) {
  ViolationList list;
  for (int step = 0; step < static_cast<int>(kReportedViolationsMax) + 5; ++step) {
    list.Add(Violation(step, 0, 1.0, SimTime(0)));
  }
  EXPECT_EQ(list.violations().size(), kReportedViolationsMax);
  EXPECT_EQ(list.dropped(), 5U);
  // One that was dropped is dropped each time; one that is listed goes on counting.
  list.Add(Violation(static_cast<int>(kReportedViolationsMax), 0, 9.0, SimTime(0)));
  EXPECT_EQ(list.dropped(), 6U);
  list.Add(Violation(static_cast<int>(kReportedViolationsMax) - 1, 0, 9.0, SimTime(0)));
  EXPECT_EQ(list.dropped(), 6U);
  EXPECT_EQ(list.violations().back().count, 2U);
  EXPECT_EQ(list.violations().back().excess, 9.0);
}

}  // namespace
}  // namespace rmlcell::simulation
