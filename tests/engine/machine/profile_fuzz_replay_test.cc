// What the fuzzer of profile files starts from, and mutations of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/profile_input.h"

namespace rmlcell::machine {
namespace {

std::vector<std::string> ProfileCorpus() {
  std::vector<std::filesystem::path> paths;
  const std::string folder = RMLCELL_SOURCE_DIR "/tests/fuzz/corpus/profile";
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

TEST(ProfileFuzzReplay, TheCorpusHoldsWhatItMust) {
  const auto corpus = ProfileCorpus();
  EXPECT_GE(corpus.size(), 15U);
  for (const std::string& one : corpus) EXPECT_EQ(TryProfile(one), "") << one;
}

TEST(ProfileFuzzReplay, MutationsOfTheCorpusHoldWhatTheyMust) {
  std::mt19937 random(12);  // NOLINT: the same every time
  for (const std::string& one : ProfileCorpus()) {
    for (int round = 0; round < 60; ++round) {
      std::string changed = one;
      for (int k = 0; k <= round % 4; ++k) {
        const std::size_t at = random() % changed.size();
        if (random() % 4 == 0 && changed.size() > 8) {
          changed.erase(at, random() % 4);
        } else {
          changed[at] = static_cast<char>(random() % 256);
        }
      }
      EXPECT_EQ(TryProfile(changed), "") << changed;
    }
  }
}

}  // namespace
}  // namespace rmlcell::machine
