// The planner that sees a window agrees with one that sees the whole program. motion.md 5.5, 10.
#include "tests/engine/motion/whole_planner.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "engine/motion/ride/trajectory.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// motion.md 12, C01: 90 degrees, legs 100 mm, SPEED 10: worked out there.
TEST(WholePlanner, CornerOfReferenceCaseC01) {
  std::vector<MoveCommand> chain(2);
  chain[0].path = PathPiece::Line({{0, 0, 0}}, {{100, 0, 0}});
  chain[1].path = PathPiece::Line({{100, 0, 0}}, {{100, 100, 0}});
  chain[0].fly = true;
  for (MoveCommand& move : chain) move.speed_fraction = 0.1;
  const WholePlan plan = PlanWhole(chain, StandardMachine());
  EXPECT_NEAR(plan.duration_s, 4.089999848, 1e-6);
  EXPECT_NEAR(plan.length_mm, 198.564458478, 1e-6);
  EXPECT_NEAR(plan.corners[0].cut_mm, 4.050462937, 1e-6);
}

void Compare(std::uint64_t seed, int count, double longest_mm) {
  MachineLimits machine = StandardMachine();
  machine.ramps_across_passages = false;
  const ChainOptions options{.arcs = false, .head = false, .longest_mm = longest_mm};
  const std::vector<MoveCommand> chain = RandomChain(seed, count, options);
  const WholePlan whole = PlanWhole(chain, machine);
  const std::vector<PlannedMotion> streamed = Plan(chain, machine);
  const double duration = Duration(streamed);
  RC_ASSERT(std::abs(duration - whole.duration_s) <= 1e-9 * std::max(1.0, duration));
  for (const PlannedMotion& motion : streamed) {
    if (!motion.ends_move || motion.corner.passage == Passage::kThrough) continue;
    const CornerReport& report = whole.corners[static_cast<std::size_t>(motion.tag)];
    RC_ASSERT(motion.corner.passage == report.passage);
    RC_ASSERT(std::abs(motion.corner.cut_mm - report.cut_mm) <= 1e-9);
    RC_ASSERT(std::abs(motion.corner.speed - report.speed) <= 1e-9 * std::max(1.0, report.speed));
  }
}

RC_GTEST_PROP(WholePlanner, StreamingAgreesOnMixedLengths, ()) {
  Compare(*rc::gen::noShrink(rc::gen::arbitrary<std::uint64_t>()), *rc::gen::inRange(1, 300),
          300.0);
}

RC_GTEST_PROP(WholePlanner, StreamingAgreesOnShortMoves, ()) {
  Compare(*rc::gen::noShrink(rc::gen::arbitrary<std::uint64_t>()), *rc::gen::inRange(100, 2000),
          0.5);
}

}  // namespace
}  // namespace rmlcell::motion
