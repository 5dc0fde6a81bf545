// What the fuzzer of the language server starts from, and mutations of it: nothing crashes, every
// answer is a message, every edit lies in the text.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/lsp_input.h"

namespace rmlcell::lsp {
namespace {

std::vector<std::string> Corpus() {
  std::vector<std::filesystem::path> paths;
  const std::string folder = std::string(RMLCELL_SOURCE_DIR) + "/tests/fuzz/corpus/lsp";
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::vector<std::string> corpus;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return corpus;
}

TEST(FuzzReplay, TheCorpusHoldsWhatItMust) {
  const auto corpus = Corpus();
  EXPECT_GE(corpus.size(), 10U);
  for (const std::string& one : corpus) EXPECT_EQ(TryLsp(one), "") << one;
}

TEST(FuzzReplay, MutationsOfTheCorpusHoldWhatTheyMust) {
  std::mt19937 random(7);
  const auto corpus = Corpus();
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
