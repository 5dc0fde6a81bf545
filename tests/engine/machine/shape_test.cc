#include "engine/machine/shape.h"

#include <gtest/gtest.h>

#include "engine/machine/observer.h"
#include "engine/machine/run.h"

namespace rmlcell::machine {
namespace {

TEST(Box, IsEmptyUntilAPointIsAdded) {
  Box box;
  EXPECT_TRUE(box.empty());
  box.Add(motion::MachineVector{1, 2, 3});
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.min, (motion::MachineVector{1, 2, 3}));
  EXPECT_EQ(box.max, (motion::MachineVector{1, 2, 3}));
}

TEST(Box, GrowsInEachDirectionAlone) {
  Box box;
  box.Add(motion::MachineVector{0, 0, 0});
  box.Add(motion::MachineVector{-1, 5, 0});
  box.Add(motion::MachineVector{3, -2, -7});
  box.Add(motion::MachineVector{1, 1, -1});  // inside
  EXPECT_EQ(box.min, (motion::MachineVector{-1, -2, -7}));
  EXPECT_EQ(box.max, (motion::MachineVector{3, 5, 0}));
}

TEST(Box, AnEmptyOneAddsNothing) {
  Box box;
  box.Add(Box());
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box, Box());
  box.Add(motion::MachineVector{1, 1, 1});
  const Box before = box;
  box.Add(Box());
  EXPECT_EQ(box, before);
  Box other;
  other.Add(motion::MachineVector{-1, 0, 2});
  box.Add(other);
  EXPECT_EQ(box.min, (motion::MachineVector{-1, 0, 1}));
  EXPECT_EQ(box.max, (motion::MachineVector{1, 1, 2}));
}

// From corner to corner; 0 of an empty one, and of a point.
TEST(Box, DiagonalGoesFromCornerToCorner) {
  Box box;
  EXPECT_EQ(box.diagonal_mm(), 0.0);
  box.Add(motion::MachineVector{1, 2, 3});
  EXPECT_EQ(box.diagonal_mm(), 0.0);
  box.Add(motion::MachineVector{-1, 5, 9});
  EXPECT_DOUBLE_EQ(box.diagonal_mm(), 7.0);
}

// What a run does without being told: CYCLE at 100 %, at most 100 million steps and 30 days.
TEST(RunSetup, Defaults) {
  const RunSetup setup{Parameters({})};
  EXPECT_EQ(setup.mode, Mode::kCycle);
  EXPECT_EQ(setup.override_percent, 100.0);
  EXPECT_EQ(setup.budget.steps, 100'000'000u);
  EXPECT_EQ(setup.budget.virtual_time, FromSeconds(30.0 * 24.0 * 3600.0));
  EXPECT_FALSE(setup.forecast);
  EXPECT_TRUE(setup.schedules.empty());
  EXPECT_FALSE(setup.breakpoint || setup.simul);
  EXPECT_EQ(LaserSchedule{}.mode, "CW");
  EXPECT_EQ(LaserSchedule{}.power_percent, 100.0);
  EXPECT_EQ(RunState{}.override_percent, 100.0);
  EXPECT_LT(RunState{}.progress, 0.0);
  EXPECT_EQ(MotionDone{}.use, MotionUse::kTravel);
  EXPECT_TRUE(MoveDone{}.programmed);
  EXPECT_EQ(Place{}.byte_offset, -1);
}

}  // namespace
}  // namespace rmlcell::machine
