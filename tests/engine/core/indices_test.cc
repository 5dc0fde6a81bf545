#include "engine/core/indices.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace rmlcell {
namespace {

std::vector<std::size_t> Listed(Indices indices) {
  std::vector<std::size_t> listed;
  for (const std::size_t i : indices) listed.push_back(i);
  return listed;
}

TEST(Indices, CountFromNothingToOneLess) {
  using List = std::vector<std::size_t>;
  EXPECT_EQ(Listed(Indices(0)), List{});
  EXPECT_EQ(Listed(Indices(1)), List{0});
  EXPECT_EQ(Listed(Indices(3)), (List{0, 1, 2}));
  EXPECT_EQ(Listed(IndicesOf(std::array{'a', 'b'})), (List{0, 1}));
  EXPECT_EQ(Listed(IndicesOf(std::vector<int>{})), List{});
}

}  // namespace
}  // namespace rmlcell
