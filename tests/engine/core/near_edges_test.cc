// What stands before a word in memory is no part of it.
#include <gtest/gtest.h>

#include <array>
#include <string_view>

#include "engine/core/near_words.h"

namespace rmlcell {
namespace {

// "abc" and "pqraxbc" are four letters apart, whatever is written before the word: with an x there
// the first two letters of "xabc" would be exchanged in the other one.
TEST(NearEdges, NothingBeforeAWordCounts) {
  constexpr std::string_view kText = "xabc";
  const std::string_view word = kText.substr(1);
  EXPECT_TRUE(NearestTo(word, std::array{std::string_view("pqraxbc")}).words.empty());
  EXPECT_TRUE(NearestTo(word, std::array{std::string_view("pqrstaxbc")}).words.empty());
  EXPECT_TRUE(NearestTo(word, std::array{std::string_view("paxbc")}).words.empty());
}

}  // namespace
}  // namespace rmlcell
