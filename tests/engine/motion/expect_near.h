#pragma once

#include <gtest/gtest.h>

#include "engine/motion/geometry/frames.h"

namespace rmlcell::motion {

inline void ExpectNear(const MachineVector& got, const MachineVector& want,
                       double tolerance = 1e-9) {
  EXPECT_NEAR(got.x(), want.x(), tolerance);
  EXPECT_NEAR(got.y(), want.y(), tolerance);
  EXPECT_NEAR(got.z(), want.z(), tolerance);
}

}  // namespace rmlcell::motion
