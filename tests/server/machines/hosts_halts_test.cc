// What halts a machine whose host is silent or has no line (live.md 2.10).
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

// LIVE-2.10: what halts a machine whose line is gone is handed over when the same host is heard
// again, for as long as its lease lasts; behind another host it stands already.
TEST_F(HostsTest, WhatHaltsIsHandedOverLater) {
  const auto ask = [&](bool stop) {
    v1::HostOrder order;
    if (stop) {
      order.mutable_stop();
    } else {
      order.mutable_start()->set_program(5);
    }
    std::string told;
    hosts.Ask("mill-1", std::move(order), [&](const Result<v1::HostOrderAnswer>& answer) {
      told = answer ? "answered" : CodeText(answer.error().code) + " " + answer.error().detail;
    });
    return told;
  };
  const auto orders = [](const FakeLink& link) {
    const auto all = link.All();
    return std::ranges::count_if(
        all, [](const v1::HostResponse& message) { return message.has_order(); });
  };
  const auto first = Joined();
  hosts.Leave(*first);
  EXPECT_THAT(ask(true), testing::StartsWith("CELL-E9424 not delivered"));
  EXPECT_THAT(ask(false), testing::StartsWith("CELL-E9424"));
  const auto again = Joined(Hello("elsewhere/1", Fence(*first)));
  ASSERT_TRUE(again->Newest(v1::HostResponse::kOrder));
  EXPECT_TRUE(again->Newest(v1::HostResponse::kOrder)->order().has_stop());
  EXPECT_EQ(orders(*again), 1);
  hosts.Leave(*again);
  ask(true);
  clock.Advance(Hosts::kLease + std::chrono::seconds(1));
  const auto late = Joined(Hello("elsewhere/1", Fence(*first)));
  EXPECT_TRUE(late->Newest(v1::HostResponse::kWelcome));
  EXPECT_EQ(orders(*late), 0);
}

// LIVE-2.10: of another host the machine stands already: what was to halt the one before is not for
// it, however soon it comes.
TEST_F(HostsTest, WhatWasToHaltTheHostBeforeIsNotForTheNext) {
  const auto first = Joined();
  hosts.Leave(*first);
  v1::HostOrder stop;
  stop.mutable_stop();
  std::string told;
  hosts.Ask("mill-1", std::move(stop), [&told](const Result<v1::HostOrderAnswer>& answer) {
    told = answer ? "answered" : answer.error().detail;
  });
  EXPECT_EQ(told, "not delivered: it acts if this host is heard of again");
  v1::HostHello hello = Hello("office/2");
  hello.set_computer("office");
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  const auto second = Joined(hello);
  ASSERT_NE(Fence(*second), Fence(*first));
  const auto all = second->All();
  EXPECT_TRUE(std::ranges::none_of(all, &v1::HostResponse::has_order));
}

// LIVE-2.10: whoever pressed STOP before its host was known to be silent hears that at once, and
// not when the line is given up.
TEST_F(HostsTest, AStopToASilentHostIsAnsweredWhenItIsLost) {
  const auto link = Joined();
  Tell(*link, v1::MACHINE_STATE_RUNNING);
  std::vector<std::string> told;
  const auto ask = [&](bool stop) {
    v1::HostOrder order;
    if (stop) order.mutable_stop();
    if (!stop) order.mutable_read_variables();
    hosts.Ask("mill-1", std::move(order), [&](const Result<v1::HostOrderAnswer>& answer) {
      told.push_back(answer ? "answered" : answer.error().detail);
    });
  };
  ask(true);
  ask(false);
  clock.Advance(std::chrono::milliseconds(3'001));
  hosts.Look();
  EXPECT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_LOST);
  EXPECT_THAT(told, testing::ElementsAre("its host is silent: whether it halts is not known"));
}

}  // namespace
}  // namespace rmlcell::server
