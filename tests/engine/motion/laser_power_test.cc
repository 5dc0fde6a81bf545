#include "engine/motion/ride/laser_power.h"

#include <gtest/gtest.h>

namespace rmlcell::motion {
namespace {

const PowerLaw kLaw{.speed_percent = 8.0, .power_percent = 75.0, .tip_speed_max_mm_s = 500.0};

TEST(PowerLaw, IsALineThroughTheOriginUpToFull) {
  EXPECT_DOUBLE_EQ(kLaw.PercentAt(0.0), 0.0);
  EXPECT_DOUBLE_EQ(kLaw.PercentAt(40.0), 75.0);
  EXPECT_DOUBLE_EQ(kLaw.PercentAt(53.0), 99.375);
  EXPECT_DOUBLE_EQ(kLaw.PercentAt(54.0), 100.0);
}

// Without saturation each mm gets laser_W * power/100 / (speed/100 * v_max) J, whatever the ramps:
// here 1500 * 0.75 / 40 = 28.125. motion.md 8.1.
TEST(EnergyOf, PerMillimetreIsConstantBelowSaturation) {
  for (const double length : {0.01, 3.0, 700.0}) {
    for (const double speed : {1.0, 20.0, 53.0}) {
      const SpeedProfile p = SpeedProfile::Span(length, 0, 0, {speed, 2000, 40000});
      EXPECT_NEAR(EnergyOf(p, kLaw, 1500.0), 28.125 * length, 1e-9 * length);
    }
  }
}

// With saturation the exact integral agrees with a fine sum.
TEST(EnergyOf, SplitsPhasesWhereThePowerSaturates) {
  const SpeedProfile p = SpeedProfile::Span(60.0, 10.0, 80.0, {200, 2000, 40000});
  double sum = 0.0;
  const int steps = 200000;
  for (int k = 0; k < steps; ++k) {
    const double t = p.duration_s() * (k + 0.5) / steps;
    sum += kLaw.PercentAt(p.At(t).speed) / 100.0 * 1500.0 * p.duration_s() / steps;
  }
  EXPECT_NEAR(EnergyOf(p, kLaw, 1500.0), sum, 1e-6 * sum);
}

}  // namespace
}  // namespace rmlcell::motion
