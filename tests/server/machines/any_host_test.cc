// What hosts tell, whatever it is (live.md 10.06): messages of every kind with any fields.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "server/base/executor.h"
#include "tests/server/any_messages.h"
#include "tests/server/fake_link.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

class AnyHostTest : public testing::Test {
 protected:
  std::shared_ptr<FakeLink> Joined() {
    v1::HostHello hello;
    hello.set_join_token("secret");
    hello.set_machine("machines/mill-1");
    hello.set_host("elsewhere/1");
    hello.set_protocol(1);
    auto link = std::make_shared<FakeLink>();
    const Status joined = hosts_.Join(link, hello);
    EXPECT_TRUE(joined) << (joined ? "" : joined.error().detail);
    return link;
  }

  void TearDown() override {
    hosts_.CloseAll();
    executor_.reset();  // what was posted is done
  }

  // What a host tells, or another one that talks as it does.
  v1::HostRequest Any(AnyMessages& any, std::int64_t fence) {
    v1::HostRequest request;
    do {
      request.Clear();
      any.Any(request);
    } while (request.has_hand_back());  // it would end here
    for (v1::JournalEntry& entry : *request.mutable_entries()->mutable_entries()) {
      if (any.Below(8) != 0) entry.set_fence(fence);
      if (any.Below(8) != 0) entry.set_sequence(++sequence_);
      entry.clear_job();  // of the queue, which is not here
      told_max_ = std::max(told_max_, entry.sequence());
    }
    if (request.entries().entries().empty()) request.clear_entries();
    return request;
  }

  void Ask(AnyMessages& any) {
    ++asked_;
    v1::HostOrder order = any.Order();
    hosts_.Ask("mill-1", std::move(order),
               [this](const Result<v1::HostOrderAnswer>&) { ++answered_; });
  }

  ServerBed bed_;
  EventFeed feed_{bed_.store()};
  TestSteadyClock clock_;
  std::atomic<int> answered_ = 0;
  int asked_ = 0;
  std::int64_t sequence_ = 0;
  std::int64_t told_max_ = 0;
  std::unique_ptr<Executor> executor_ = std::make_unique<Executor>(2);
  Hosts hosts_{{.store = bed_.store(),
                .feed = feed_,
                .executor = *executor_,
                .server = "this server",
                .join_token = "secret",
                .clock = clock_.clock()}};
};

// LIVE-10.06: what is stored counts up and was told, by the fence of the host; each order is
// answered once, by whatever comes; the machine stays the host's.
TEST_F(AnyHostTest, WhateverItTellsIsTakenOrLeft) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    AnyMessages any(seed);
    const auto link = Joined();
    const auto welcome = link->Newest(v1::HostResponse::kWelcome);
    ASSERT_TRUE(welcome);
    const std::int64_t fence = welcome->welcome().fence();
    for (int i = 0; i < 200; ++i) {
      if (any.Below(6) == 0) Ask(any);
      hosts_.Receive(*link, Any(any, fence));
      clock_.Advance(std::chrono::milliseconds(any.Below(40)));
      if (any.Below(10) == 0) hosts_.Look();
      const auto status = hosts_.StatusOf("mill-1");
      ASSERT_TRUE(status);
    }
    // Of what nobody has answered is told in the end that nobody does.
    clock_.Advance(Hosts::kPreviewPatience + std::chrono::seconds(1));
    v1::HostRequest heartbeat;
    heartbeat.mutable_heartbeat()->set_number(1);
    hosts_.Receive(*link, std::move(heartbeat));
    EXPECT_TRUE(Eventually([&] { return answered_ == asked_; })) << answered_ << " of " << asked_;
    std::int64_t stored = 0;
    for (const v1::HostResponse& message : link->All()) {
      if (!message.has_entries_stored()) continue;
      EXPECT_EQ(message.entries_stored().fence(), fence);
      EXPECT_GE(message.entries_stored().sequence(), stored) << "seed " << seed;
      EXPECT_LE(message.entries_stored().sequence(), told_max_) << "seed " << seed;
      stored = message.entries_stored().sequence();
    }
    EXPECT_EQ(Must(bed_.store().MachineLeases()).front().fence, fence);
    hosts_.Leave(*link);
  }
}

}  // namespace
}  // namespace rmlcell::server
