#include "engine/core/alignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace rmlcell {
namespace {

using Keys = std::vector<std::uint64_t>;

// The length of the longest common subsequence, by the table of all prefixes.
std::size_t LongestByTable(const Keys& a, const Keys& b) {
  std::vector<std::vector<std::size_t>> best(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      best[i + 1][j + 1] = a[i] == b[j] ? best[i][j] + 1 : std::max(best[i][j + 1], best[i + 1][j]);
    }
  }
  return best[a.size()][b.size()];
}

void ExpectOrdered(const std::vector<AlignedPair>& pairs, const Keys& a, const Keys& b) {
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    ASSERT_LT(pairs[p].a, a.size());
    ASSERT_LT(pairs[p].b, b.size());
    EXPECT_EQ(a[pairs[p].a], b[pairs[p].b]);
    if (p == 0) continue;
    EXPECT_LT(pairs[p - 1].a, pairs[p].a);
    EXPECT_LT(pairs[p - 1].b, pairs[p].b);
  }
}

TEST(Alignment, AgreesWithTheTableOfAllPrefixes) {
  std::mt19937 random(7);
  for (int round = 0; round < 500; ++round) {
    Keys a(random() % 13), b(random() % 13);
    for (auto* keys : {&a, &b}) {
      for (std::uint64_t& key : *keys) key = random() % 4;
    }
    const auto pairs = Align(a, b);
    ExpectOrdered(pairs, a, b);
    EXPECT_EQ(pairs.size(), LongestByTable(a, b)) << round;
  }
}

TEST(Alignment, EmptyAndEqualSequences) {
  EXPECT_TRUE(Align(Keys{}, Keys{}).empty());
  EXPECT_TRUE(Align(Keys{1, 2}, Keys{}).empty());
  EXPECT_EQ(Align(Keys{1, 2}, Keys{1, 2}), (std::vector<AlignedPair>{{0, 0}, {1, 1}}));
}

// Equal keys at both ends belong together once, and what is new between them to nothing.
TEST(Alignment, BothEndsAreEqual) {
  using Pairs = std::vector<AlignedPair>;
  EXPECT_EQ(Align(Keys{1, 2, 3}, Keys{1, 9, 3}), (Pairs{{0, 0}, {2, 2}}));
  EXPECT_EQ(Align(Keys{1, 3}, Keys{1, 3, 1, 3}), (Pairs{{0, 0}, {1, 1}}));
  EXPECT_EQ(Align(Keys{1, 7, 2, 8, 3}, Keys{1, 2, 3}), (Pairs{{0, 0}, {2, 1}, {4, 2}}));
  EXPECT_EQ(Align(Keys{7, 2, 8}, Keys{9, 2}), (Pairs{{1, 1}}));
}

// Beyond the limit it stays right: what is paired is equal and in order, ends are found.
TEST(Alignment, ManyDifferencesAreBounded) {
  Keys a(20'000), b(20'000);
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = i;
    b[i] = i % 10 == 0 ? i : 1'000'000 + i;
  }
  b.front() = a.front();
  b.back() = a.back();
  const auto pairs = Align(a, b);
  ExpectOrdered(pairs, a, b);
  EXPECT_EQ(pairs.size(), 2001U);
}

// alignment.h: with kDifferencesMax differences the longest is found, with one more only what
// stands at the same distance from the first: here nothing, as one has `gone` elements more at its
// front.
TEST(Alignment, TheLimitOfDifferencesIsTheLastThatIsKept) {
  constexpr std::size_t kCommon = 50, kNew = 3;
  for (const std::size_t gone : {kDifferencesMax - kNew, kDifferencesMax - kNew + 1}) {
    Keys a(gone, 1), b;
    for (std::size_t i = 0; i < kCommon; ++i) {
      a.push_back(100 + i);
      b.push_back(100 + i);
    }
    b.insert(b.end(), kNew, 2);
    const auto pairs = Align(a, b);
    ExpectOrdered(pairs, a, b);
    EXPECT_EQ(pairs.size(), gone + kNew <= kDifferencesMax ? kCommon : 0U);
    const auto back = Align(b, a);
    ExpectOrdered(back, b, a);
    EXPECT_EQ(back.size(), pairs.size());
  }
}

}  // namespace
}  // namespace rmlcell
