#include "engine/core/near_words.h"

#include <gtest/gtest.h>

#include <array>

namespace rmlcell {
namespace {

using Words = std::vector<std::string>;

Words Near(std::string_view word) {
  static constexpr std::array<std::string_view, 6> kKnown = {"simulate", "check", "--stock",
                                                             "--tool",   "--svg", "put"};
  return NearestTo(word, kKnown).words;
}

// At most a third of the characters: 2 of 8, 1 of 3 to 5, none of 1 and 2.
TEST(NearWords, AtMostAThirdDiffers) {
  EXPECT_EQ(Near("simulat"), Words{"simulate"});   // one is missing
  EXPECT_EQ(Near("simluate"), Words{"simulate"});  // two are swapped: one difference
  EXPECT_EQ(Near("SIMULATE"), Words{"simulate"});  // case is none
  EXPECT_EQ(Near("--stok"), Words{"--stock"});
  EXPECT_EQ(Near("pt"), Words{});  // 2 / 3 is 0
  EXPECT_EQ(Near("pot"), Words{"put"});
  EXPECT_EQ(Near("chkec"), Words{});  // two of five differ
  EXPECT_EQ(NearestTo("simxlxte", std::array<std::string_view, 1>{"simulate"}).distance, 2);
}

// near_words.h: all that are equally near and no other, each once, in the order in which they come.
TEST(NearWords, AllThatAreEquallyNear) {
  const auto nearest = [](std::string_view word, std::vector<std::string_view> candidates) {
    return NearestTo(word, candidates);
  };
  const NearestOf equal = nearest("xat", {"scat", "cat", "bat", "cat", "hat", "rat"});
  EXPECT_EQ(equal.words, (Words{"cat", "bat", "hat"}));  // at most kNearWordsMax
  EXPECT_EQ(equal.distance, 1);
  const NearestOf nearer = nearest("simulate", {"simulx", "simulxxe", "simulatx"});
  EXPECT_EQ(nearer.words, Words{"simulatx"});
  EXPECT_EQ(nearer.distance, 1);
  const NearestOf same = nearest("cat", {"bat", "CAT", "cut", "cat"});
  EXPECT_EQ(same.words, (Words{"CAT", "cat"}));
  EXPECT_EQ(same.distance, 0);
}

// Characters that are missing count on either side, and an empty word is near nothing.
TEST(NearWords, LengthsDiffer) {
  EXPECT_EQ(Near(""), Words{});
  constexpr std::array<std::string_view, 3> kShort = {"", "x", "t"};
  EXPECT_EQ(NearestTo("pot", kShort).words, Words{});
  EXPECT_EQ(NearestTo("", kShort).words, Words{});
  constexpr std::array<std::string_view, 1> kLonger = {"abcdefgh"};
  EXPECT_EQ(NearestTo("abcdef", kLonger).distance, 2);
  EXPECT_EQ(NearestTo("cdefgh", kLonger).distance, 2);
  EXPECT_EQ(NearestTo("bacdef", kLonger).words, Words{});  // three of six
}

// Words of the command line are longer than those of a program.
TEST(NearWords, LongWordsAreCompared) {
  constexpr std::array<std::string_view, 1> kLong = {"--machine-coordinates"};
  EXPECT_EQ(NearestTo("--machine-cordinates", kLong).words, Words{"--machine-coordinates"});
  const std::string longest(32, 'a');
  const std::array<std::string_view, 1> same = {longest};
  EXPECT_EQ(NearestTo(longest, same).words, Words{longest});
  EXPECT_EQ(NearestTo(longest + "a", same).words, Words{});
  const std::string longer = longest + "a";
  EXPECT_EQ(NearestTo(longest, std::array<std::string_view, 1>{longer}).words, Words{});
}

TEST(NearWords, TheQuestionNamesThemAll) {
  EXPECT_EQ(DidYouMean({}), "");
  EXPECT_EQ(DidYouMean(Words{"a"}), "; did you mean a?");
  EXPECT_EQ(DidYouMean(Words{"a", "b", "c"}), "; did you mean a, b or c?");
}

}  // namespace
}  // namespace rmlcell
