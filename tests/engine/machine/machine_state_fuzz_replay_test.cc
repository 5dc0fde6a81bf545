// What the fuzzer of machine states starts from, and mutations of it.
#include <gtest/gtest.h>

#include "tests/fuzz/machine_state_input.h"
#include "tests/fuzz/seeds.h"

namespace rmlcell::machine {
namespace {

TEST(MachineStateFuzzReplay, TheCorpusHoldsWhatItMust) {
  const auto seeds = fuzz::SeedsOf("machine-state");
  EXPECT_GE(seeds.size(), 4U);
  for (const std::string& one : seeds) EXPECT_EQ(TryMachineState(one), "");
}

TEST(MachineStateFuzzReplay, MutationsOfTheCorpusHoldWhatTheyMust) {
  std::mt19937 random(21);  // NOLINT: the same every time
  for (const std::string& one : fuzz::SeedsOf("machine-state")) {
    for (int round = 0; round < 200; ++round) {
      const std::string changed = fuzz::Damaged(one, 1 + round % 4, 0, random);
      EXPECT_EQ(TryMachineState(changed), "");
    }
  }
}

}  // namespace
}  // namespace rmlcell::machine
