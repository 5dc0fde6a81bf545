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
  EXPECT_EQ(taken.refused.front().number(), 257);
  ASSERT_EQ(taken.stops.size(), 2U);
  EXPECT_EQ(taken.stops.front().number(), 557);
  EXPECT_TRUE(taken.stops.back().has_stop());
  // Room again.
  EXPECT_TRUE(waiting.empty());
  waiting.Add(Start(559));
  EXPECT_EQ(waiting.Take().messages.size(), 1U);
}

// LIVE-3.10, LIVE-3.20: what lets go finds it full no more than what halts, and more than a STOP is
// not made less of; a key keeps its number, which is used up.
TEST(WaitingMessages, BeyondTheBoundNothingIsMadeLessOf) {
  WaitingMessages waiting;
  for (int i = 1; i <= 256; ++i) waiting.Add(Start(i));
  for (int i = 301; i <= 556; ++i) waiting.Add(Stop(i));
  v1::HostResponse message;
  message.mutable_order()->mutable_emergency_stop();
  waiting.Add(message);
  message.mutable_order()->mutable_inputs()->add_inputs()->set_door_open(true);
  waiting.Add(message);
  message.mutable_order()->mutable_panel_key()->set_sequence(9);
  waiting.Add(message);
  message.mutable_order()->mutable_override()->set_override_percent(50);
  waiting.Add(message);
  message.mutable_order()->mutable_panel_heartbeat();
  waiting.Add(message);
  WaitingMessages::Taken taken = waiting.Take();
  ASSERT_EQ(taken.stops.size(), 2U);
  EXPECT_TRUE(taken.stops[0].has_emergency_stop());
  EXPECT_TRUE(taken.stops[1].has_stop());
  ASSERT_EQ(taken.refused.size(), 1U);
  EXPECT_EQ(taken.refused[0].panel_key().sequence(), 9);
  EXPECT_EQ(taken.messages.size(), 514U);
  // LIVE-2.05: none of what they stop begins behind them.
  EXPECT_EQ(taken.TakeMotions().size(), 256U);
  EXPECT_EQ(taken.messages.size(), 258U);
}

// LIVE-3.10, LIVE-3.20: what does more than a STOP acts as what it is, as keys do; for a HOLD there
// is a STOP of whoever asked for it.
TEST(WaitingMessages, WhatHaltsBeyondTheBoundStillHalts) {
  WaitingMessages waiting;
  for (int i = 1; i <= 256; ++i) waiting.Add(Stop(i));
  v1::HostResponse message;
  message.mutable_order()->mutable_abort();
  waiting.Add(message);
  message.mutable_order()->mutable_disarm();
  waiting.Add(message);
  message.mutable_order()->mutable_panel_key()->set_key("PAUSE");
  message.mutable_order()->mutable_panel_key()->set_action(v1::KEY_ACTION_TAP);
  waiting.Add(message);
  message.mutable_order()->mutable_key()->set_key("STOP");
  message.mutable_order()->mutable_key()->set_action(v1::KEY_ACTION_TAP);
  waiting.Add(message);
  message.mutable_order()->mutable_hold();
  message.mutable_order()->set_number(600);
  message.mutable_order()->set_caller("anna");
  waiting.Add(message);
  const WaitingMessages::Taken taken = waiting.Take();
  ASSERT_EQ(taken.stops.size(), 5U);
  EXPECT_TRUE(taken.stops[0].has_abort());
  EXPECT_TRUE(taken.stops[1].has_disarm());
  EXPECT_EQ(taken.stops[2].panel_key().key(), "PAUSE");
  EXPECT_EQ(taken.stops[3].key().key(), "STOP");
  EXPECT_TRUE(taken.stops[4].has_stop());
  EXPECT_EQ(taken.stops[4].number(), 600);
  EXPECT_EQ(taken.stops[4].caller(), "anna");
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
