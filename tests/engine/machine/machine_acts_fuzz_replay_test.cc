// What the fuzzers of keys and inputs start from, mutations of it, and acts out of nowhere.
#include <gtest/gtest.h>

#include "tests/fuzz/machine_acts_input.h"
#include "tests/fuzz/seeds.h"

namespace rmlcell::machine {
namespace {

#ifdef RMLCELL_SANITIZED
constexpr int kMutations = 4;
constexpr int kSequences = 6;
#else
constexpr int kMutations = 20;
constexpr int kSequences = 60;
#endif

using Try = std::string (*)(std::string_view);

std::string AnyActs(std::mt19937& random, std::size_t size) {
  std::string bytes(3 + random() % size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random() % 256);
  return bytes;
}

// What replays it, where something is wrong.
std::string Hex(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  for (const char one : bytes) {
    hex += kDigits[static_cast<unsigned char>(one) >> 4];
    hex += kDigits[static_cast<unsigned char>(one) & 15U];
  }
  return hex;
}

void Replay(const std::string& target, Try attempt) {
  const auto seeds = fuzz::SeedsOf(target);
  ASSERT_GE(seeds.size(), 4U);
  std::mt19937 random(31);  // NOLINT: the same every time
  for (const std::string& seed : seeds) {
    ASSERT_EQ(attempt(seed), "") << Hex(seed);
    for (int round = 0; round < kMutations; ++round) {
      const std::string changed = fuzz::Damaged(seed, 1 + round % 6, 0, random);
      ASSERT_EQ(attempt(changed), "") << Hex(changed);
    }
  }
  for (int round = 0; round < kSequences; ++round) {
    const std::string any = AnyActs(random, 300);
    ASSERT_EQ(attempt(any), "") << Hex(any);
  }
}

// LIVE-10.06
TEST(MachineActsFuzzReplay, KeysHoldWhatTheyMust) { Replay("machine-keys", TryKeys); }

// LIVE-10.06
TEST(MachineActsFuzzReplay, InputsHoldWhatTheyMust) { Replay("machine-inputs", TryInputs); }

}  // namespace
}  // namespace rmlcell::machine
