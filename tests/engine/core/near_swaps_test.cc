// Swapped neighbours are one difference (near_words.h), and no other two are.
#include <gtest/gtest.h>

#include <array>

#include "engine/core/near_words.h"

namespace rmlcell {
namespace {

// -1: it is not near.
int DifferencesOf(std::string_view word, std::string_view candidate) {
  const NearestOf near = NearestTo(word, std::array{candidate});
  return near.words.empty() ? -1 : near.distance;
}

// At the front, in the middle and at the end, of either case; of three characters one may differ,
// so that two exchanged ones would be too many.
TEST(NearWords, SwappedNeighboursAreOneDifference) {
  EXPECT_EQ(DifferencesOf("upt", "put"), 1);
  EXPECT_EQ(DifferencesOf("ptu", "put"), 1);
  EXPECT_EQ(DifferencesOf("pTU", "put"), 1);
  EXPECT_EQ(DifferencesOf("abdcefghi", "abcdefghi"), 1);
  EXPECT_EQ(DifferencesOf("abdc", "abcd"), 1);
  EXPECT_EQ(DifferencesOf("uqt", "put"), -1);
}

// They add to what differs before them and behind them.
TEST(NearWords, SwapsAddToOtherDifferences) {
  EXPECT_EQ(DifferencesOf("xbdcefghi", "abcdefghi"), 2);
  EXPECT_EQ(DifferencesOf("bacdefgih", "abcdefghi"), 2);
  EXPECT_EQ(DifferencesOf("xbdcefgih", "abcdefghi"), 3);
  EXPECT_EQ(DifferencesOf("abdcefgh", "abcdefghi"), 2);
}

// One of two neighbours that stands in the other's place, beside a third one, is no swap; nor are
// characters that do not stand side by side.
TEST(NearWords, HalfASwapIsTwoDifferences) {
  EXPECT_EQ(DifferencesOf("abcdefghi", "abdxefghi"), 2);
  EXPECT_EQ(DifferencesOf("abcdefghi", "abxcefghi"), 2);
  EXPECT_EQ(DifferencesOf("abedcfghi", "abcdefghi"), 2);
}

// What stands before a candidate in a longer text is none of it.
TEST(NearWords, ACandidateBeginsWithItself) {
  constexpr std::string_view kText = "qa";
  EXPECT_EQ(DifferencesOf("zzaq", kText.substr(1)), -1);
}

}  // namespace
}  // namespace rmlcell
