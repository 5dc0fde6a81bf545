// What the fuzzer of material starts from, and mutations of it: nothing crashes, what is read is
// whole, what is refused has a reason.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/material_input.h"

namespace rmlcell::simulation {
namespace {

std::vector<std::string> MaterialCorpus() {
  std::vector<std::filesystem::path> paths;
  const std::string folder = RMLCELL_SOURCE_DIR "/tests/fuzz/corpus/material";
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

TEST(MaterialFuzzReplay, TheCorpusHoldsWhatItMust) {
  const auto corpus = MaterialCorpus();
  EXPECT_GE(corpus.size(), 10U);
  for (const std::string& one : corpus) EXPECT_EQ(TryMaterial(one), "");
}

TEST(MaterialFuzzReplay, MutationsOfTheCorpusHoldWhatTheyMust) {
  std::mt19937 random(11);  // NOLINT: the same every time
  for (const std::string& one : MaterialCorpus()) {
    for (int round = 0; round < 60; ++round) {
      std::string changed = one;
      for (int k = 0; k <= round % 4; ++k) {
        const std::size_t at = 1 + random() % (changed.size() - 1);
        if (random() % 4 == 0 && changed.size() > 8) {
          changed.erase(at, random() % 4);
        } else {
          changed[at] = static_cast<char>(random() % 256);
        }
        if (changed.size() < 2) break;
      }
      EXPECT_EQ(TryMaterial(changed), "");
    }
  }
}

}  // namespace
}  // namespace rmlcell::simulation
