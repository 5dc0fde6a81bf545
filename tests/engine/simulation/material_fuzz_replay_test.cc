// What the fuzzer of material starts from, and mutations of it: nothing crashes, what is read is
// whole, what is refused has a reason.
#include <gtest/gtest.h>

#include "tests/fuzz/material_input.h"
#include "tests/fuzz/seeds.h"

namespace rmlcell::simulation {
namespace {

TEST(MaterialFuzzReplay, TheCorpusHoldsWhatItMust) {
  const auto seeds = fuzz::SeedsOf("material");
  EXPECT_GE(seeds.size(), 10U);
  for (const std::string& one : seeds) EXPECT_EQ(TryMaterial(one), "");
}

TEST(MaterialFuzzReplay, MutationsOfTheCorpusHoldWhatTheyMust) {
  std::mt19937 random(11);  // NOLINT: the same every time
  for (const std::string& one : fuzz::SeedsOf("material")) {
    for (int round = 0; round < 60; ++round)
      EXPECT_EQ(TryMaterial(fuzz::Damaged(one, 1 + round % 4, 1, random)), "");
  }
}

}  // namespace
}  // namespace rmlcell::simulation
