// What halts a machine: whose host is silent or has no line (live.md 2.10), or that is about to
// begin.
#include <future>
#include <string>
#include <vector>

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

// Orders that are on their way to the host behind what was stored, which takes a while.
class HostsHalts : public HostsTest {
 protected:
  void HoldTheLane() {
    const std::shared_future<void> wait = goes_on.get_future().share();
    for (int thread = 0; thread < kThreads; ++thread) executor->Post([wait] { wait.wait(); });
  }
  void LetGo() {
    goes_on.set_value();
    Settle();
  }
  void Ask(v1::HostOrder order) {
    const auto what = order.request_case();
    hosts.Ask("mill-1", std::move(order), [this, what](const Result<v1::HostOrderAnswer>& answer) {
      const std::string how = !answer                 ? CodeText(answer.error().code)
                              : answer->has_refusal() ? answer->refusal().code()
                                                      : "";
      told.emplace_back(what, how);
    });
  }
  static std::vector<v1::HostOrder::RequestCase> SentTo(const FakeLink& link) {
    std::vector<v1::HostOrder::RequestCase> sent;
    for (const v1::HostResponse& message : link.All()) {
      if (message.has_order()) sent.push_back(message.order().request_case());
    }
    return sent;
  }

  std::promise<void> goes_on;
  std::vector<std::pair<v1::HostOrder::RequestCase, std::string>> told;
};

// LIVE-2.05, 7.04: nothing begins behind an answered STOP that was asked before it. What only looks
// at a start goes on, and so does all of it where one job alone is halted.
TEST_F(HostsHalts, WhatHaltsTakesBackWhatWouldBeginBehindIt) {
  using Order = v1::HostOrder;
  const std::string refused = CodeText(ErrorCode::kCellMachineState);
  for (const auto halts : {Order::kStop, Order::kHold, Order::kEmergencyStop, Order::kAbort}) {
    SCOPED_TRACE(halts);
    const auto link = Joined();
    Settle();
    goes_on = std::promise<void>();
    told = {};
    HoldTheLane();
    std::vector<Order> asked(7);
    asked[0].mutable_start();
    asked[1].mutable_zero();
    asked[2].mutable_start_at_step();
    asked[3].mutable_run_job();
    asked[4].mutable_continue_job();
    asked[5].mutable_preview_start();
    asked[6].mutable_abort();
    asked[6].set_for_job("jobs/7");
    for (const Order& order : asked) Ask(order);
    EXPECT_THAT(told, testing::IsEmpty());
    Order halt;
    if (halts == Order::kStop) halt.mutable_stop();
    if (halts == Order::kHold) halt.mutable_hold();
    if (halts == Order::kEmergencyStop) halt.mutable_emergency_stop();
    if (halts == Order::kAbort) halt.mutable_abort();
    Ask(halt);
    EXPECT_THAT(told, testing::UnorderedElementsAre(testing::Pair(Order::kStart, refused),
                                                    testing::Pair(Order::kZero, refused),
                                                    testing::Pair(Order::kStartAtStep, refused),
                                                    testing::Pair(Order::kRunJob, refused),
                                                    testing::Pair(Order::kContinueJob, refused)));
    LetGo();
    EXPECT_THAT(SentTo(*link), testing::ElementsAre(Order::kAbort, halts, Order::kPreviewStart));
    hosts.Leave(*link);
  }
}

// What has gone out is the host's: it answers it, and the STOP behind it.
TEST_F(HostsHalts, WhatHasGoneOutIsNotTakenBack) {
  const auto link = Joined();
  v1::HostOrder start;
  start.mutable_start();
  Ask(start);
  Settle();
  v1::HostOrder stop;
  stop.mutable_stop();
  Ask(stop);
  EXPECT_THAT(told, testing::IsEmpty());
  EXPECT_THAT(SentTo(*link), testing::ElementsAre(v1::HostOrder::kStart, v1::HostOrder::kStop));
}

// LIVE-2.10: nothing begins that nobody sees, also where its host was heard when it was asked for.
TEST_F(HostsHalts, NothingBeginsOnAHostThatIsSilentByThen) {
  const auto link = Joined();
  Tell(*link, v1::MACHINE_STATE_IDLE);
  Settle();
  HoldTheLane();
  v1::HostOrder start;
  start.mutable_start();
  Ask(start);
  clock.Advance(std::chrono::milliseconds(2'501));
  hosts.Look();
  ASSERT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_LOST);
  LetGo();
  EXPECT_THAT(SentTo(*link), testing::IsEmpty());
  EXPECT_THAT(told, testing::ElementsAre(
                        testing::Pair(v1::HostOrder::kStart, CodeText(ErrorCode::kCellNotLive))));
}

}  // namespace
}  // namespace rmlcell::server
