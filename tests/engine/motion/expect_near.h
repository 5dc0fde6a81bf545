#pragma once

#include <gtest/gtest.h>

#include "engine/motion/vec3.h"

namespace rmlcell::motion {

inline void ExpectNear(const Vec3& got, const Vec3& want, double tolerance = 1e-9) {
  EXPECT_NEAR(got.x, want.x, tolerance);
  EXPECT_NEAR(got.y, want.y, tolerance);
  EXPECT_NEAR(got.z, want.z, tolerance);
}

}  // namespace rmlcell::motion
