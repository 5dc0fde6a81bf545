// What happens in the middle of something else: a host is heard, comes or asks while it is looked
// at, forgotten or followed (live.md 2.05, 3.02).
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "server/base/this_computer.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/machines/hosts_bed.h"
#include "tests/storage/quiet_process.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

// During whose next call of a kind something else happens, once.
class InterruptedStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::function<void()> behind_release;
  int unreadable = 0;  // so many memories
  int errno_of_leases = 0;

  Status ReleaseMachine(const storage::MachineLease& lease) override {
    const Status released = store_.ReleaseMachine(lease);
    if (const auto act = std::exchange(behind_release, {})) act();
    return released;
  }
  Result<storage::MachineMemory> GetMachineMemory(std::string_view machine,
                                                  const WantsPrograms& wants_programs) override {
    if (unreadable == 0) return store_.GetMachineMemory(machine, wants_programs);
    --unreadable;
    return Error{ErrorCode::kCellStoreFailed, "the line broke", {}};
  }
  Result<std::vector<storage::MachineLease>> MachineLeases() override {
    auto leases = store_.MachineLeases();
    errno = errno_of_leases;  // of anything that failed a moment ago
    return leases;
  }
};

class LinesThatCross : public HostsTest {
 protected:
  void TearDown() override {
    others.CloseAll();
    HostsTest::TearDown();
  }
  std::shared_ptr<FakeLink> JoinedOthers(const v1::HostHello& hello = Hello()) {
    auto link = std::make_shared<FakeLink>();
    const Status joined = others.Join(link, hello);
    EXPECT_TRUE(joined) << (joined ? "" : joined.error().detail);
    return link;
  }
  static v1::HostOrder Start() {
    v1::HostOrder order;
    order.mutable_start()->set_program(5);
    return order;
  }
  static v1::HostOrder Stop() {
    v1::HostOrder order;
    order.mutable_stop();
    return order;
  }
  static void Unheard(const Result<v1::HostOrderAnswer>& /*answer*/) {}
  static std::ptrdiff_t Count(const FakeLink& link, v1::HostResponse::MessageCase kind) {
    const auto all = link.All();
    return std::ranges::count(all, kind, &v1::HostResponse::message_case);
  }

  InterruptedStore store{bed.store()};
  Hosts others{{.store = store,
                .feed = feed,
                .executor = *executor,
                .server = "another server",
                .join_token = "secret",
                .clock = clock.clock()}};
};

// A host that gets the machine while another one is forgotten keeps it.
TEST_F(LinesThatCross, WhoComesWhileAnotherIsForgottenStays) {
  const auto first = JoinedOthers();
  std::shared_ptr<FakeLink> second;
  store.behind_release = [&] { second = JoinedOthers(Hello("office/2")); };
  others.Forget("mill-1");
  ASSERT_TRUE(second);
  EXPECT_TRUE(others.IsHosted("mill-1"));
  EXPECT_TRUE(first->closed());
  EXPECT_FALSE(second->closed());
}

// Something happens while a start is handed to it.
class InterruptedLink final : public HostLink {
 public:
  void Send(v1::HostResponse message) override {
    if (!message.has_order()) return;
    if (message.order().has_start()) {
      if (const auto act = std::exchange(while_starting, {})) act();
    }
    const std::lock_guard lock(mutex_);
    orders_.push_back(message.order().request_case());
  }
  void Close(const Error& /*why*/) override {}
  std::vector<v1::HostOrder::RequestCase> orders() const {
    const std::lock_guard lock(mutex_);
    return orders_;
  }
  std::function<void()> while_starting;

 private:
  mutable std::mutex mutex_;
  std::vector<v1::HostOrder::RequestCase> orders_;
};

// LIVE-2.05: what halts goes out behind what begins, once that is on its way.
TEST_F(LinesThatCross, WhatHaltsGoesOutBehindAStartThatGoesOut) {
  const auto link = std::make_shared<InterruptedLink>();
  ASSERT_TRUE(hosts.Join(link, Hello()));
  std::future<void> halted;
  link->while_starting = [&] {
    halted = std::async(std::launch::async, [this] { hosts.Ask("mill-1", Stop(), Unheard); });
    // Whoever does not wait for its turn is through by then.
    EXPECT_TRUE(ComesToRest());
  };
  hosts.Ask("mill-1", Start(), Unheard);
  Settle();
  ASSERT_TRUE(halted.valid());
  halted.get();
  EXPECT_THAT(link->orders(), ElementsAre(v1::HostOrder::kStart, v1::HostOrder::kStop));
}

// Hosts::Ask: whoever hears that its start does not begin may ask for something else at once.
TEST_F(LinesThatCross, WhoIsRefusedMayAskAgain) {
  const auto link = Joined();
  Tell(*link, v1::MACHINE_STATE_IDLE);
  Settle();
  int refused = 0;
  for (const bool is_silent : {false, true}) {
    std::promise<void> goes_on;
    const std::shared_future<void> wait = goes_on.get_future().share();
    for (int thread = 0; thread < kThreads; ++thread) executor->Post([wait] { wait.wait(); });
    hosts.Ask("mill-1", Start(), [&](const Result<v1::HostOrderAnswer>& /*answer*/) {
      ++refused;
      hosts.Ask("mill-1", Stop(), Unheard);
    });
    if (is_silent) {
      clock.Advance(milliseconds(2'501));
      hosts.Look();
    } else {
      hosts.Ask("mill-1", Stop(), Unheard);
    }
    goes_on.set_value();
    Settle();
  }
  EXPECT_EQ(refused, 2);
  EXPECT_EQ(Count(*link, v1::HostResponse::kOrder), 3) << "the stops";
}

// LIVE-5.03: a memory that could not be read is sent once, when it can be.
TEST_F(LinesThatCross, AMemoryThatCanBeReadAgainIsSentOnce) {
  store.unreadable = 2;
  const auto first = JoinedOthers();
  EXPECT_EQ(Count(*first, v1::HostResponse::kMemory), 0);
  const auto again = JoinedOthers(Hello("elsewhere/1", Fence(*first)));
  EXPECT_EQ(Count(*first, v1::HostResponse::kMemory), 0) << "nor when the other one came";
  EXPECT_EQ(Count(*again, v1::HostResponse::kMemory), 1);
  others.TakeStored();
  EXPECT_EQ(Count(*again, v1::HostResponse::kMemory), 1);
}

// A server that stops says nothing more to the hosts that it had.
TEST_F(LinesThatCross, NothingIsSentWhenTheServerStops) {
  const auto link = Joined();
  Settle();
  std::atomic<bool> told = false;
  const auto watch = feed.Subscribe(std::string(EventFeed::kEverything), [&told] { told = true; });
  hosts.CloseAll();
  Must(bed.store().PutPrograms("mill-1", {{.slot = 5, .object = "PA;"}}, {}, "anna"));
  ASSERT_TRUE(
      Eventually([&] { return told && feed.position() == Must(bed.store().LastPosition()); }));
  Settle();
  EXPECT_EQ(Count(*link, v1::HostResponse::kMemory), 1) << "with its welcome";
}

// LIVE-3.02: a process that lives has its machine, whatever else was not found a moment ago.
TEST_F(LinesThatCross, AProcessThatLivesIsNotGone) {
  const std::string lives =
      NameOfComputer() + "/" + std::to_string(::getpid()) + "/" + NameOfBoot() + "b06e77d2";
  others.Leave(*JoinedOthers(Hello(lives)));
  store.errno_of_leases = ESRCH;
  EXPECT_EQ(CodeOf(others.Join(std::make_shared<FakeLink>(), Hello("other/2"))),
            ErrorCode::kCellMachineTaken);
}

// LIVE-3.02: nor is one gone that is not there on this computer, and is of another one.
TEST_F(LinesThatCross, AProcessOfAnotherComputerIsNotLookedFor) {
  std::string other = NameOfComputer();
  other.back() = other.back() == 'x' ? 'y' : 'x';
  others.Leave(*JoinedOthers(Hello(other + "/2147483646/" + NameOfBoot() + "5f3a09c1")));
  EXPECT_EQ(CodeOf(others.Join(std::make_shared<FakeLink>(), Hello("other/2"))),
            ErrorCode::kCellMachineTaken);
}

}  // namespace
}  // namespace rmlcell::server
