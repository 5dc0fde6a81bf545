// What the fuzzers of journals and messages start from, changes of it, and any messages.
#include <gtest/gtest.h>

#include "tests/fuzz/host_input.h"
#include "tests/fuzz/seeds.h"
#include "tests/server/any_messages.h"

namespace rmlcell::server {
namespace {

std::string AnyBytes(std::mt19937& random, std::size_t size) {
  std::string bytes(random() % size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random() % 256);
  return bytes;
}

void Replay(const std::string& target, std::string (*attempt)(std::string_view), int changes) {
  const auto seeds = fuzz::SeedsOf(target);
  ASSERT_GE(seeds.size(), 4U);
  std::mt19937 random(51);  // NOLINT: the same every time
  for (const std::string& seed : seeds) {
    ASSERT_EQ(attempt(seed), "") << ::testing::PrintToString(seed);
    for (int round = 0; round < changes; ++round) {
      const std::string changed = fuzz::Damaged(seed, 1 + round % 5, 1, random);
      ASSERT_EQ(attempt(changed), "") << ::testing::PrintToString(changed);
    }
  }
}

// LIVE-10.06, LIVE-3.24
TEST(HostFuzzReplay, JournalsHoldWhatTheyMust) { Replay("host-journal", TryJournal, 200); }

// LIVE-3.24: whatever is damaged, all before it is there, and nothing behind.
TEST(HostFuzzReplay, NothingBeforeADamageIsLost) {
  std::mt19937 random(52);  // NOLINT: the same every time
  for (int round = 0; round < 1'000; ++round) {
    const std::string any = "d" + AnyBytes(random, 160);
    ASSERT_EQ(TryJournal(any), "") << ::testing::PrintToString(any);
  }
}

// LIVE-10.06
TEST(HostFuzzReplay, MessagesHoldWhatTheyMust) { Replay("host-messages", TryHostMessages, 40); }

// LIVE-10.06: messages of every kind with any fields.
TEST(HostFuzzReplay, AnyMessagesHoldWhatTheyMust) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    AnyMessages any(seed);
    std::string bytes(1, static_cast<char>(seed % 2));
    for (int i = 0; i < 40; ++i) {
      v1::HostResponse message;
      if (any.Below(4) == 0) {
        any.Any(message);
      } else {
        *message.mutable_order() = any.Order();
      }
      const std::string one = message.SerializeAsString();
      if (one.size() >= 4'096) continue;
      bytes += static_cast<char>(any.Below(16) * 16 + static_cast<int>(one.size() / 256));
      bytes += static_cast<char>(one.size() % 256);
      bytes += one;
    }
    ASSERT_EQ(TryHostMessages(bytes), "") << "seed " << seed;
  }
}

}  // namespace
}  // namespace rmlcell::server
