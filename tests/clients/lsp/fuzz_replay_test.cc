// What the fuzzer of the language server starts from, and mutations of it: nothing crashes, every
// answer is a message, every edit lies in the text.
#include <gtest/gtest.h>

#include "tests/fuzz/lsp_input.h"
#include "tests/fuzz/seeds.h"

namespace rmlcell::lsp {
namespace {

TEST(FuzzReplay, TheCorpusHoldsWhatItMust) {
  const auto corpus = fuzz::SeedsOf("lsp");
  EXPECT_GE(corpus.size(), 10U);
  for (const std::string& one : corpus) EXPECT_EQ(TryLsp(one), "") << one;
}

TEST(FuzzReplay, MutationsOfTheCorpusHoldWhatTheyMust) {
  std::mt19937 random(7);
  const auto corpus = fuzz::SeedsOf("lsp");
  for (int round = 0; round < 80; ++round) {
    std::string one = corpus[random() % corpus.size()];
    for (unsigned changes = 1 + random() % 4; changes > 0 && one.size() > 2; --changes) {
      const std::size_t at = 1 + random() % (one.size() - 1);
      switch (random() % 3) {
        case 0:
          one[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          one.erase(at, 1 + random() % 8);
          break;
        default: {
          const std::string& other = corpus[random() % corpus.size()];
          const std::size_t from = random() % other.size();
          one.insert(at, other.substr(from, random() % 20));
          break;
        }
      }
    }
    ASSERT_EQ(TryLsp(one), "") << "round " << round << ": " << one;
  }
}

}  // namespace
}  // namespace rmlcell::lsp
