#include "engine/optimo/language/gosub_depth.h"

#include <gtest/gtest.h>

namespace rmlcell::optimo {
namespace {

using Places = std::vector<std::uint32_t>;

// OPT-7.21: a chain of GOSUBs; the call at place 10 + s is made on level s + 1.
TEST(GosubDepth, AChainIsMeasured) {
  std::vector<std::vector<GosubCall>> calls(4);
  for (std::size_t s = 0; s + 1 < calls.size(); ++s)
    calls[s].push_back({static_cast<std::uint32_t>(10 + s), s + 1});
  EXPECT_TRUE(FindNesting({{1, 0}}, calls, 4).too_deep.empty());
  EXPECT_EQ(FindNesting({{1, 0}}, calls, 3).too_deep, (Places{12}));
  EXPECT_EQ(FindNesting({{1, 0}}, calls, 2).too_deep, (Places{11, 12}));
  // From the middle of the chain it is shallower; what nothing calls does not count.
  EXPECT_TRUE(FindNesting({{1, 2}}, calls, 2).too_deep.empty());
}

// OPT-7.21: of two ways to a subroutine the deeper one counts, whichever is met first.
TEST(GosubDepth, TheDeepestWayCounts) {
  const std::vector<std::vector<GosubCall>> calls = {{{10, 2}, {11, 1}}, {{12, 2}}, {{13, 3}}, {}};
  EXPECT_EQ(FindNesting({{1, 0}}, calls, 3).too_deep, (Places{13}));
  EXPECT_TRUE(FindNesting({{1, 0}}, calls, 4).too_deep.empty());
}

// OPT-7.21: rings are told by the call that closes them, and have no depth.
TEST(GosubDepth, RingsAreFound) {
  const GosubNesting itself = FindNesting({{1, 0}}, {{{10, 0}}});
  EXPECT_EQ(itself.recursive, (Places{10}));
  EXPECT_TRUE(itself.too_deep.empty());
  const GosubNesting ring = FindNesting({{1, 0}}, {{{10, 1}}, {{11, 2}}, {{12, 0}}});
  EXPECT_EQ(ring.recursive, (Places{12}));
  // Two ways to the same subroutine are no ring.
  EXPECT_TRUE(FindNesting({{1, 0}, {2, 1}}, {{{10, 1}}, {}}).recursive.empty());
}

// A chain of a hundred thousand does not need a deep call stack.
TEST(GosubDepth, LongChainsAreNoDeepStack) {
  std::vector<std::vector<GosubCall>> calls(100'000);
  for (std::size_t s = 0; s + 1 < calls.size(); ++s)
    calls[s].push_back({static_cast<std::uint32_t>(s), s + 1});
  EXPECT_EQ(FindNesting({{1, 0}}, calls, 16).too_deep.size(), calls.size() - 16);
}

}  // namespace
}  // namespace rmlcell::optimo
