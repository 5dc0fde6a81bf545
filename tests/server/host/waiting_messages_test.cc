// What waits for the thread of a machine is bounded (live.md 3.10).
#include "server/host/waiting_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/host_protocol.h"

namespace rmlcell::server {
namespace {

v1::HostResponse Stop(std::int64_t number) {
  v1::HostResponse message;
  message.mutable_order()->set_number(number);
  message.mutable_order()->mutable_stop();
  return message;
}
v1::HostResponse Start(std::int64_t number) {
  v1::HostResponse message;
  message.mutable_order()->set_number(number);
  message.mutable_order()->mutable_start();
  return message;
}

// LIVE-3.10: 256 orders and 256 that halt; beyond them one STOP stands for all, and the others are
// told that there is no room.
TEST(WaitingMessages, HaveABound) {
  WaitingMessages waiting;
  for (int i = 1; i <= 256; ++i) waiting.Add(Start(i));
  for (int i = 257; i <= 300; ++i) waiting.Add(Start(i));
  for (int i = 301; i <= 556; ++i) waiting.Add(Stop(i));
  waiting.Add(Stop(557));
  waiting.Add(Stop(558));
  const WaitingMessages::Taken taken = waiting.Take();
  EXPECT_EQ(taken.messages.size(), 512U);
  EXPECT_EQ(taken.refused.size(), 44U);
  EXPECT_EQ(taken.refused.front(), 257);
  EXPECT_THAT(taken.stops, testing::ElementsAre(557, 558));
  // Room again.
  EXPECT_TRUE(waiting.empty());
  waiting.Add(Start(559));
  EXPECT_EQ(waiting.Take().messages.size(), 1U);
}

// What is no order has no bound of its own: it answers what this host has sent.
TEST(WaitingMessages, OthersAreNotCounted) {
  WaitingMessages waiting;
  for (int i = 0; i < 300; ++i) {
    v1::HostResponse message;
    message.mutable_entries_stored()->set_sequence(i);
    waiting.Add(std::move(message));
  }
  WaitingMessages::Taken taken = waiting.Take();
  EXPECT_EQ(taken.messages.size(), 300U);
  waiting.Add(Start(1));
  taken.Append(waiting.Take());
  EXPECT_EQ(taken.messages.back().order().number(), 1);
}

// LIVE-3.07: its own version, and the one before it.
TEST(HostProtocol, TheVersionBeforeIsTaken) {
  EXPECT_TRUE(TakesHost(7, 7));
  EXPECT_TRUE(TakesHost(6, 7));
  EXPECT_FALSE(TakesHost(5, 7));
  EXPECT_FALSE(TakesHost(8, 7));
  EXPECT_FALSE(TakesHost(0, 1));  // whoever says none
}

}  // namespace
}  // namespace rmlcell::server
