// A million random segments without a violation, measured from positions. motion.md section 10.
#include <gtest/gtest.h>

#include "tests/engine/motion/plan_check.h"
#include "tests/engine/motion/random_chain.h"

namespace rmlcell::motion {
namespace {

// OPT-2.16, OPT-B.21, OPT-B.23, OPT-B.24
TEST(MillionSegments, KeepEveryLimit) {
#if defined(NDEBUG) && !defined(RMLCELL_SANITIZED)
  constexpr int kChains = 1000;
#else
  constexpr int kChains =
      20;  // with sanitizers or without optimisation: the release build runs them all
#endif
  const MachineLimits machine = StandardMachine();
  std::size_t segments = 0;
  for (int k = 0; k < kChains; ++k) {
    const ChainOptions options{.arcs = k % 3 != 0,
                               .head = k % 2 == 0,
                               .all_fly = k % 5 == 0,
                               .longest_mm = k % 7 == 0   ? 1000.0
                                             : k % 4 == 0 ? 2.0
                                                          : 50.0};
    const std::vector<MoveCommand> chain =
        RandomChain(static_cast<std::uint64_t>(k) + 1, 1000, options);
    const std::vector<PlannedMotion> motions = Plan(chain, machine);
    const PlanCheck check{chain, motions, machine, 1, options.arcs};
    for (const std::string& violation : check.Violations())
      ADD_FAILURE() << "seed " << k + 1 << ": " << violation;
    segments += chain.size();
    if (HasFailure()) break;
  }
  EXPECT_EQ(segments, static_cast<std::size_t>(kChains) * 1000);
}

}  // namespace
}  // namespace rmlcell::motion
