#include "engine/optimo/language/gosub_depth.h"

#include <gtest/gtest.h>

namespace rmlcell::optimo {
namespace {

using Instructions = std::vector<std::uint32_t>;
using LevelEdges = std::vector<LevelEdge>;

constexpr bool kGosub = true;

// OPT-7.21: a chain of GOSUBs; the call at place n is made on level n.
TEST(GosubDepth, AChainIsMeasured) {
  const LevelEdges edges = {{0, 1, kGosub}, {1, 2, kGosub}, {2, 3, kGosub}};
  EXPECT_TRUE(FindNesting(4, 0, edges, 3).too_deep.empty());
  EXPECT_EQ(FindNesting(4, 0, edges, 2).too_deep, (Instructions{2}));
  EXPECT_EQ(FindNesting(4, 0, edges, 1).too_deep, (Instructions{1, 2}));
  // Once for each instruction, however many ways lead on from it.
  const LevelEdges fork = {{0, 1, kGosub}, {1, 2, kGosub}, {1, 3, kGosub}};
  EXPECT_EQ(FindNesting(4, 0, fork, 1).too_deep, (Instructions{1}));
  // In the order of the program, not in that of the calls.
  const LevelEdges back = {{0, 4}, {1, 2}, {2, 3, kGosub}, {4, 1, kGosub}};
  EXPECT_EQ(FindNesting(5, 0, back, 0).too_deep, (Instructions{2, 4}));
  // From the middle of the chain it is shallower; what nothing comes to does not count.
  EXPECT_TRUE(FindNesting(4, 2, edges, 1).too_deep.empty());
}

// OPT-7.21: of two ways to a subroutine the deeper one counts, whichever is met first.
TEST(GosubDepth, TheDeepestWayCounts) {
  const LevelEdges edges = {{0, 3, kGosub}, {0, 1}, {1, 2, kGosub}, {2, 3, kGosub}, {3, 4, kGosub}};
  EXPECT_EQ(FindNesting(5, 0, edges, 2).too_deep, (Instructions{3}));
  EXPECT_TRUE(FindNesting(5, 0, edges, 3).too_deep.empty());
}

// OPT-7.21: a loop is no level, and each of its instructions is as deep as the deepest.
TEST(GosubDepth, LoopsAreOneLevel) {
  const LevelEdges edges = {{0, 1, kGosub}, {0, 2}, {1, 3}, {2, 3}, {2, 4, kGosub}, {3, 2}};
  EXPECT_EQ(FindNesting(5, 0, edges, 1).too_deep, (Instructions{2}));
  EXPECT_TRUE(FindNesting(5, 0, edges, 2).too_deep.empty());
  EXPECT_TRUE(FindNesting(5, 0, edges, 2).recursive.empty());
}

// OPT-7.21: rings are told by the call that closes them, and have no depth.
TEST(GosubDepth, RingsAreFound) {
  const GosubNesting itself = FindNesting(2, 0, {{0, 1, kGosub}, {1, 1, kGosub}});
  EXPECT_EQ(itself.recursive, (Instructions{1}));
  EXPECT_TRUE(itself.too_deep.empty());
  const GosubNesting ring =
      FindNesting(4, 0, {{0, 1, kGosub}, {1, 2, kGosub}, {2, 3, kGosub}, {3, 1, kGosub}});
  EXPECT_EQ(ring.recursive, (Instructions{3}));
  // Closed by a jump: the last GOSUB of the ring.
  const GosubNesting jump =
      FindNesting(4, 0, {{0, 1, kGosub}, {1, 2, kGosub}, {2, 3, kGosub}, {3, 1}});
  EXPECT_EQ(jump.recursive, (Instructions{2}));
  // Two ways to the same subroutine are no ring.
  const LevelEdges two = {{0, 1, kGosub}, {0, 2, kGosub}, {1, 2, kGosub}};
  EXPECT_TRUE(FindNesting(3, 0, two).recursive.empty());
}

// OPT-7.21: into what another branch of the ring has left nothing leads back.
TEST(GosubDepth, ARingIsClosedOnTheWayAlone) {
  const LevelEdges branches = {{0, 1}, {0, 2}, {1, 0, kGosub}, {2, 1, kGosub}};
  EXPECT_EQ(FindNesting(3, 0, branches).recursive, (Instructions{1}));
  // In the order of the program, not in that of the walk.
  const LevelEdges apart = {{0, 2, kGosub}, {0, 1, kGosub}, {1, 1, kGosub}, {2, 2, kGosub}};
  EXPECT_EQ(FindNesting(3, 0, apart).recursive, (Instructions{1, 2}));
}

// OPT-7.21: a ring that a jump closes has all that lies on it, and its GOSUB may be the first one.
TEST(GosubDepth, ARingOfJumpsHasItsGosub) {
  EXPECT_EQ(FindNesting(2, 0, {{0, 1, kGosub}, {1, 0}}).recursive, (Instructions{0}));
  const LevelEdges entered = {{0, 1}, {1, 2, kGosub}, {2, 3}, {3, 1}};
  EXPECT_EQ(FindNesting(4, 0, entered).recursive, (Instructions{1}));
}

// OPT-7.21: what leads into a ring is a level, what stays in it is none.
TEST(GosubDepth, TheWayIntoARingCounts) {
  const LevelEdges edges = {{0, 1, kGosub}, {1, 1, kGosub}};
  EXPECT_EQ(FindNesting(2, 0, edges, 0).too_deep, (Instructions{0}));
  EXPECT_TRUE(FindNesting(2, 0, edges, 1).too_deep.empty());
}

TEST(GosubDepth, WhereThereIsNothingNothingIsFound) {
  EXPECT_TRUE(FindNesting(0, 0, {}).recursive.empty());
  EXPECT_TRUE(FindNesting(0, 0, {}).too_deep.empty());
}

// A chain of a hundred thousand does not need a deep call stack.
TEST(GosubDepth, LongChainsAreNoDeepStack) {
  constexpr std::uint32_t kCount = 100'000;
  LevelEdges edges;
  for (std::uint32_t at = 0; at + 1 < kCount; ++at) edges.push_back({at, at + 1, kGosub});
  EXPECT_EQ(FindNesting(kCount, 0, edges, 16).too_deep.size(), edges.size() - 16);
}

}  // namespace
}  // namespace rmlcell::optimo
