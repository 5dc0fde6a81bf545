#include "engine/motion/planner/feed_steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rmlcell::motion {
namespace {

// motion.md section 7: 0.5..15 mm/s, steps of 0.1 below 1, of 1 from there on, rounded down.
TEST(FeedSteps, RoundsDownToWhatTheMillKnows) {
  const FeedSteps steps;
  EXPECT_DOUBLE_EQ(steps.Nearest(0.7), 0.7);
  EXPECT_DOUBLE_EQ(steps.Nearest(0.79), 0.7);
  EXPECT_DOUBLE_EQ(steps.Nearest(0.999), 0.9);
  EXPECT_DOUBLE_EQ(steps.Nearest(1.0), 1.0);
  EXPECT_DOUBLE_EQ(steps.Nearest(1.99), 1.0);
  EXPECT_DOUBLE_EQ(steps.Nearest(15.0), 15.0);
  EXPECT_DOUBLE_EQ(steps.Nearest(999.0), 15.0);
  EXPECT_DOUBLE_EQ(steps.Nearest(-3.0), 0.5);
  EXPECT_DOUBLE_EQ(steps.Nearest(std::numeric_limits<double>::quiet_NaN()), 0.5);
}

// motion.md section 7: every step is itself, and the next lower number belongs to the step below.
TEST(FeedSteps, RoundsNothingUp) {
  const FeedSteps steps;
  EXPECT_EQ(steps.Nearest(0.9999999999), 0.9);
  for (int tenth = 6; tenth < 10; ++tenth) {
    EXPECT_EQ(steps.Nearest(tenth / 10.0), tenth / 10.0);
    EXPECT_EQ(steps.Nearest(std::nextafter(tenth / 10.0, 0.0)), (tenth - 1) / 10.0);
    EXPECT_EQ(steps.Nearest(std::nextafter(tenth / 10.0, 1.0)), tenth / 10.0);
  }
  EXPECT_EQ(steps.Nearest(std::nextafter(1.0, 0.0)), 0.9);
  for (int whole = 2; whole < 15; ++whole) {
    EXPECT_EQ(steps.Nearest(whole), whole);
    EXPECT_EQ(steps.Nearest(std::nextafter(whole, 0.0)), whole - 1.0);
  }
  EXPECT_EQ(steps.Nearest(std::nextafter(15.0, 0.0)), 14.0);
}

// motion.md section 7: the range comes first; its ends need not be steps.
TEST(FeedSteps, KeepsTheEndsOfTheRange) {
  const FeedSteps steps{.minimum_mm_s = 0.25, .maximum_mm_s = 9.5};
  EXPECT_EQ(steps.Nearest(0.2), 0.25);
  EXPECT_EQ(steps.Nearest(0.29), 0.25);
  EXPECT_EQ(steps.Nearest(0.3), 0.3);
  EXPECT_EQ(steps.Nearest(9.4), 9.0);
  EXPECT_EQ(steps.Nearest(9.5), 9.5);
  EXPECT_EQ(steps.Nearest(12.0), 9.5);
}

// Other mills, other steps: 1 to 50 mm/s, by quarters up to 10, by 2.5 from there on. The least
// speed goes before the step below it.
TEST(FeedSteps, OtherMills) {
  const FeedSteps steps{.minimum_mm_s = 1.1,
                        .maximum_mm_s = 51.0,
                        .fine_step_mm_s = 0.25,
                        .coarse_step_mm_s = 2.5,
                        .coarse_from_mm_s = 10.0};
  for (const auto& [wanted, got] : {std::pair{1.1, 1.1},
                                    {1.2, 1.1},
                                    {1.25, 1.25},
                                    {1.49, 1.25},
                                    {9.99, 9.75},
                                    {10.0, 10.0},
                                    {12.4, 10.0},
                                    {12.5, 12.5},
                                    {50.9, 50.0},
                                    {51.0, 51.0},
                                    {60.0, 51.0},
                                    {0.0, 1.1}}) {
    EXPECT_DOUBLE_EQ(steps.Nearest(wanted), got) << wanted;
  }
}

// Coarse steps count from exactly there on, be that a step or not.
TEST(FeedSteps, CoarseFromThereOn) {
  const FeedSteps steps{.maximum_mm_s = 51.0,
                        .fine_step_mm_s = 0.25,
                        .coarse_step_mm_s = 2.5,
                        .coarse_from_mm_s = 10.3};
  EXPECT_EQ(steps.Nearest(std::nextafter(10.3, 0.0)), 10.25);
  EXPECT_EQ(steps.Nearest(10.3), 10.0);
  EXPECT_EQ(steps.Nearest(-std::numeric_limits<double>::infinity()), 0.5);
  EXPECT_EQ(steps.Nearest(std::numeric_limits<double>::infinity()), 51.0);
}

}  // namespace
}  // namespace rmlcell::motion
