#include "engine/motion/geometry/corner_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"

namespace rmlcell::motion {
namespace {

// The curve of cut 1 that all tables are about, and its figures by themselves, place for place.
struct TableCorner {
  explicit TableCorner(double degrees)
      : half_sine(std::sin(degrees * kPi / 360.0)),
        half_cosine(std::cos(degrees * kPi / 360.0)),
        rho(CornerRho(half_cosine)),
        curvature(CornerCurvature(half_sine, half_cosine, rho)),
        in{half_cosine, -half_sine, 0.0},
        out{half_cosine, half_sine, 0.0},
        curve({.pose = {-in, 0, 0}, .tangent = in, .curvature = {}},
              {.pose = {out, 0, 0}, .tangent = out, .curvature = {}}, 1.0),
        length(curve) {}

  double JerkPeak() const {
    double most = 0.0;
    for (int k = 0; k <= 4000; ++k) most = std::max(most, curve.JerkPerCube(k / 4000.0));
    return most;
  }

  double half_sine, half_cosine, rho, curvature;
  MachineVector in, out;
  CornerCurve curve;
  CornerLength length;
};

constexpr double kStep_deg = 2.89;  // meets no node of a table
constexpr double kSharpest_deg = 174.9;

// motion.md 4.2: the arc length is that of the curve itself, at every angle.
TEST(CornerTables, LengthIsThatOfTheCurve) {
  for (double degrees = 0.003; degrees < kSharpest_deg; degrees += kStep_deg) {
    const TableCorner corner(degrees);
    EXPECT_NEAR(CornerArcLength(corner.rho), corner.length.total(), 1e-9) << degrees;
  }
}

// motion.md 4.3: the peak of path jerk is never told too low, and hardly too high.
TEST(CornerTables, JerkPeakIsThatOfTheCurve) {
  for (double degrees = 0.003; degrees < kSharpest_deg; degrees += kStep_deg) {
    const TableCorner corner(degrees);
    const double told = CornerJerkPeak(corner.half_sine, corner.half_cosine, corner.curvature);
    const double peak = corner.JerkPeak();
    EXPECT_GE(told, peak) << degrees;
    EXPECT_LE(told, peak * (1.0 + 1e-5)) << degrees;
  }
}

// The shares from place to place are rounded down, by less than one in a thousand. (Turns of less
// than some degrees have next to no jerk in the middle, and their share is any large number there.)
TEST(CornerTables, HalvesTellCurvatureAndJerkFromPlaceToPlace) {
  for (double degrees = 3.003; degrees < kSharpest_deg; degrees += kStep_deg) {
    const TableCorner corner(degrees);
    const HalfCorner half = CornerHalf(corner.half_sine, corner.half_cosine);
    // The ends of the curve are straight: there the share is any large number.
    EXPECT_GT(half.by_curvature[0], 100.0) << degrees;
    EXPECT_GT(half.by_jerk[0], 0.0) << degrees;
    for (std::size_t k = 1; k <= HalfCorner::kSteps; ++k) {
      const double way = 0.5 * corner.length.total() * static_cast<double>(k) / HalfCorner::kSteps;
      const double u = corner.length.ParameterAt(corner.curve, way);
      const double by_curvature =
          std::sqrt(corner.curvature / corner.curve.SecondByLength(u).point.norm());
      EXPECT_LE(half.by_curvature[k], by_curvature) << degrees << ' ' << k;
      EXPECT_GE(half.by_curvature[k], by_curvature * (1.0 - 1e-3)) << degrees << ' ' << k;
      const double by_jerk = std::cbrt(corner.curvature / corner.curve.JerkPerCube(u));
      EXPECT_LE(half.by_jerk[k], by_jerk) << degrees << ' ' << k;
      EXPECT_GE(half.by_jerk[k], by_jerk * (1.0 - 1e-3)) << degrees << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace rmlcell::motion
