#include "engine/motion/feed_steps.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rmlcell::motion
