// The end of a chain of knots that is accepted as it is. motion.md 5.5
#include <gtest/gtest.h>

#include "engine/motion/profile/speed_passes.h"

namespace rmlcell::motion {
namespace {

// Where all of it is accepted the machine stands at the last knot, and what comes behind begins at
// rest there; the knots before it are those of the way to that stop.
TEST(SpeedPasses, AcceptedToTheEndTheyEndAtRest) {
  constexpr PathLimits kOne{300.0, 2000.0, 40000.0};
  for (const int count : {1, 2, 5}) {
    SpeedPasses passes;
    passes.BeginAt(4.0);
    for (int knot = 0; knot < count; ++knot) passes.Push(3.0, kOne, 200.0);
    ASSERT_LT(passes.Settle(), static_cast<std::size_t>(count));
    passes.Accept(passes.size());
    ASSERT_EQ(passes.final_count(), static_cast<std::size_t>(count));
    EXPECT_EQ(passes.speed(static_cast<std::size_t>(count - 1)), 0.0) << count;
    if (count > 1) {
      const double before = passes.speed(static_cast<std::size_t>(count - 2));
      EXPECT_LE(RampLength(before, 0.0, kOne), 3.0 * (1.0 + 1e-9));
      EXPECT_GT(before, 0.9 * Reach(0.0, 3.0, kOne));
    }
    passes.Push(3.0, kOne, 200.0);
    passes.Push(300.0, kOne, 0.0);
    passes.Settle();
    EXPECT_DOUBLE_EQ(passes.speed(static_cast<std::size_t>(count)), Reach(0.0, 3.0, kOne));
  }
}

// Where nothing is open there is nothing to find: neither in a chain without knots nor behind one
// that was final before the others were dropped, which keeps its speed.
TEST(SpeedPasses, SettlingWhatIsFinalChangesNothing) {
  constexpr PathLimits kOne{300.0, 2000.0, 40000.0};
  SpeedPasses passes;
  EXPECT_EQ(passes.Settle(), 0U);
  passes.Push(500.0, kOne, 40.0);
  passes.Push(500.0, kOne, 200.0);
  ASSERT_EQ(passes.Settle(), 1U);
  passes.DropOpen();
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(passes.Settle(), 1U);
    EXPECT_EQ(passes.speed(), 40.0);
  }
  passes.Push(500.0, kOne, 0.0);
  ASSERT_EQ(passes.Settle(), 2U);
  EXPECT_EQ(passes.speed(0), 40.0);
  passes.Pop();
  passes.Pop();
  EXPECT_EQ(passes.Settle(), 0U);
}

}  // namespace
}  // namespace rmlcell::motion
