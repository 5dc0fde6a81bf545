// What the fuzzer of profile files starts from, and mutations of it.
#include <gtest/gtest.h>

#include "tests/fuzz/profile_input.h"
#include "tests/fuzz/seeds.h"

namespace rmlcell::machine {
namespace {

TEST(ProfileFuzzReplay, TheCorpusHoldsWhatItMust) {
  const auto seeds = fuzz::SeedsOf("profile");
  EXPECT_GE(seeds.size(), 15U);
  for (const std::string& one : seeds) EXPECT_EQ(TryProfile(one), "") << one;
}

TEST(ProfileFuzzReplay, MutationsOfTheCorpusHoldWhatTheyMust) {
  std::mt19937 random(12);  // NOLINT: the same every time
  for (const std::string& one : fuzz::SeedsOf("profile")) {
    for (int round = 0; round < 60; ++round) {
      const std::string changed = fuzz::Damaged(one, 1 + round % 4, 0, random);
      EXPECT_EQ(TryProfile(changed), "") << changed;
    }
  }
}

}  // namespace
}  // namespace rmlcell::machine
