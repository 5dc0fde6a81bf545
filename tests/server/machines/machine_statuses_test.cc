// How machines stand of which no host tells: what the feed knows of them as hosts come and go, and
// while the store does not say (live.md 2.10).
#include "server/machines/machine_statuses.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "server/records/job_messages.h"
#include "tests/server/forwarding_store.h"
#include "tests/server/machines/hosts_bed.h"
#include "tests/storage/quiet_process.h"

namespace rmlcell::server {
namespace {

// Which does not say what jobs there are, as long as it is told so.
class UncountedStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::atomic<bool> fails = false;

  Result<std::vector<storage::MachineJobs>> UnfinishedJobs() override {
    if (fails) return Error{ErrorCode::kCellStoreFailed, "the line broke", {}};
    return store_.UnfinishedJobs();
  }
  std::function<void()> changed;  // tells who watches it
  std::unique_ptr<Subscription> Watch(std::function<void()> told) override {
    changed = std::move(told);
    return std::make_unique<Subscription>();
  }
};

// Which counts what changes a moment later, and says so when it is told to.
class LateCount final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;

  void Hold() {
    auto jobs = Must(store_.UnfinishedJobs());
    const std::lock_guard lock(mutex_);
    held_ = std::move(jobs);
  }
  void LetGo() {
    {
      const std::lock_guard lock(mutex_);
      held_.reset();
    }
    changed_();
  }

  Result<std::vector<storage::MachineJobs>> UnfinishedJobs() override {
    const std::lock_guard lock(mutex_);
    if (held_) return *held_;
    return store_.UnfinishedJobs();
  }
  std::unique_ptr<Subscription> Watch(std::function<void()> changed) override {
    changed_ = std::move(changed);
    return std::make_unique<Subscription>();
  }

 private:
  std::mutex mutex_;
  std::optional<std::vector<storage::MachineJobs>> held_;
  std::function<void()> changed_;
};

class StatusesOfMachines : public HostsTest {
 protected:
  // As it is told; nothing: nobody tells of it.
  std::optional<v1::MachineState> StateOf(const std::string& machine) {
    const auto latest = feed.LatestAfter("machines/" + machine, 0);
    v1::MachineStatus status;
    if (!latest || !status.ParseFromString(*latest->bytes)) return std::nullopt;
    return status.state();
  }
  bool Becomes(const std::string& machine, std::optional<v1::MachineState> state) {
    return Eventually([&] { return StateOf(machine) == state; });
  }
};

// What a host told last stays until the machine has none: then it is told what its jobs say.
TEST_F(StatusesOfMachines, AHostTellsOfItsMachineUntilItHasNone) {
  const MachineStatuses statuses(bed.store(), feed, *executor, &hosts);
  ASSERT_TRUE(Becomes("mill-1", v1::MACHINE_STATE_IDLE));
  const auto link = Joined();
  Settle();
  EXPECT_EQ(StateOf("mill-1"), v1::MACHINE_STATE_IDLE) << "until its host says otherwise";
  Tell(*link, v1::MACHINE_STATE_RUNNING);
  ASSERT_TRUE(Becomes("mill-1", v1::MACHINE_STATE_RUNNING));
  hosts.Forget("mill-1");
  EXPECT_TRUE(Becomes("mill-1", v1::MACHINE_STATE_IDLE));
}

TEST_F(StatusesOfMachines, NothingIsToldOfAMachineThatWasRemoved) {
  const MachineStatuses statuses(bed.store(), feed, *executor, &hosts);
  ASSERT_TRUE(Becomes("optimo-1", v1::MACHINE_STATE_IDLE));
  ASSERT_TRUE(Becomes("mill-1", v1::MACHINE_STATE_IDLE));
  Must(bed.store().DeleteMachine("optimo-1", storage::kAnyRevision));
  EXPECT_TRUE(Becomes("optimo-1", std::nullopt));
  EXPECT_EQ(StateOf("mill-1"), v1::MACHINE_STATE_IDLE);
}

// A job that begins, and one that is over, is seen at its machine.
TEST_F(StatusesOfMachines, AJobIsSeenAtItsMachine) {
  const MachineStatuses statuses(bed.store(), feed, *executor);
  ASSERT_TRUE(Becomes("optimo-1", v1::MACHINE_STATE_IDLE));
  bed.SubmitCheck();
  ASSERT_TRUE(Eventually([&] { return feed.position() == Must(bed.store().LastPosition()); }));
  Settle();
  const auto leased =
      Must(bed.store().AcquireJobs({.worker = "w",
                                    .kinds = {"CHECK"},
                                    .duration = std::chrono::hours(1),
                                    .events = {StateEvent(storage::JobState::kRunning)}}));
  ASSERT_EQ(leased.size(), 1U);
  EXPECT_TRUE(Becomes("optimo-1", v1::MACHINE_STATE_RUNNING));
  v1::Outcome outcome;
  outcome.set_kind(v1::Outcome::KIND_COMPLETED);
  Must(bed.store().Finish(leased.front().lease,
                          {.outcome = OutcomeOf(outcome), .events = {EndedEvent(outcome)}}));
  EXPECT_TRUE(Becomes("optimo-1", v1::MACHINE_STATE_IDLE));
}

// Who reads a job in the store before it is counted looks again when it is.
TEST_F(StatusesOfMachines, AJobThatIsCountedLateIsSeen) {
  LateCount store(bed.store());
  const MachineStatuses statuses(store, feed, *executor);
  ASSERT_TRUE(Becomes("optimo-1", v1::MACHINE_STATE_IDLE));
  store.Hold();
  bed.SubmitCheck();
  bed.Lease();
  ASSERT_TRUE(Eventually([&] { return feed.position() == Must(bed.store().LastPosition()); }));
  Settle();
  EXPECT_EQ(StateOf("optimo-1"), v1::MACHINE_STATE_IDLE);
  store.LetGo();
  EXPECT_TRUE(Becomes("optimo-1", v1::MACHINE_STATE_RUNNING));
}

// Whatever comes next brings a whole look, be it a step of a job, which changes no machine.
TEST_F(StatusesOfMachines, WhatTheStoreDidNotSayIsAskedAgain) {
  bed.SubmitCheck();
  const storage::Lease lease = bed.Lease();
  ASSERT_TRUE(Eventually([&] { return feed.position() == Must(bed.store().LastPosition()); }));
  UncountedStore store(bed.store());
  store.fails = true;
  const MachineStatuses statuses(store, feed, *executor);
  Settle();
  EXPECT_EQ(StateOf("optimo-1"), std::nullopt);
  store.fails = false;
  bed.Append(lease, 1);
  EXPECT_TRUE(Becomes("optimo-1", v1::MACHINE_STATE_RUNNING));
  EXPECT_TRUE(Becomes("mill-1", v1::MACHINE_STATE_IDLE));
}

// Nor does a job stay at its machine that is over, and is counted as such a moment later.
TEST_F(StatusesOfMachines, AnEndThatIsCountedLateIsSeen) {
  LateCount store(bed.store());
  bed.SubmitCheck();
  const storage::Lease lease = bed.Lease();
  const MachineStatuses statuses(store, feed, *executor);
  ASSERT_TRUE(Becomes("optimo-1", v1::MACHINE_STATE_RUNNING));
  store.Hold();
  v1::Outcome outcome;
  outcome.set_kind(v1::Outcome::KIND_COMPLETED);
  Must(bed.store().Finish(lease, {.outcome = OutcomeOf(outcome), .events = {EndedEvent(outcome)}}));
  ASSERT_TRUE(Eventually([&] { return feed.position() == Must(bed.store().LastPosition()); }));
  Settle();
  store.LetGo();
  EXPECT_TRUE(Becomes("optimo-1", v1::MACHINE_STATE_IDLE));
}

// Where there was nothing to begin with, the next word of the store is enough, though nothing has
// changed.
TEST_F(StatusesOfMachines, ALookThatFailedIsMadeAgain) {
  UncountedStore store(bed.store());
  store.fails = true;
  const MachineStatuses statuses(store, feed, *executor);
  Settle();
  EXPECT_EQ(StateOf("mill-1"), std::nullopt);
  store.fails = false;
  store.changed();
  EXPECT_TRUE(Becomes("mill-1", v1::MACHINE_STATE_IDLE));
}

// Whose first look waits until it may go on.
class HeldStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::promise<void> begun;
  std::promise<void> goes_on;
  std::atomic<int> looks = 0;
  std::function<void()> changed;

  Result<std::vector<storage::MachineJobs>> UnfinishedJobs() override {
    if (++looks == 1) {
      begun.set_value();
      goes_on.get_future().wait();
    }
    return store_.UnfinishedJobs();
  }
  std::unique_ptr<Subscription> Watch(std::function<void()> told) override {
    changed = std::move(told);
    return std::make_unique<Subscription>();
  }
};

// One look after the other, however often something changes; whoever ends waits for the last.
TEST_F(StatusesOfMachines, ALookThatIsUnderWayIsWaitedFor) {
  HeldStore store(bed.store());
  auto statuses = std::make_unique<MachineStatuses>(store, feed, *executor);
  store.begun.get_future().wait();
  store.changed();
  std::promise<void> behind;
  executor->Post([&behind] { behind.set_value(); });
  behind.get_future().wait();
  EXPECT_EQ(store.looks, 1);
  std::future<void> ended = std::async(std::launch::async, [&statuses] { statuses.reset(); });
  // Whoever does not wait for it is through by then.
  EXPECT_TRUE(ComesToRest());
  EXPECT_EQ(ended.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  store.goes_on.set_value();
  ended.get();
  EXPECT_GE(store.looks, 2) << "what changed meanwhile is looked at as well";
}

TEST_F(StatusesOfMachines, WhoHasEndedHearsNothingOfHosts) {
  auto statuses = std::make_unique<MachineStatuses>(bed.store(), feed, *executor, &hosts);
  ASSERT_TRUE(Becomes("mill-1", v1::MACHINE_STATE_IDLE));
  statuses.reset();
  const auto link = Joined();
  hosts.Leave(*link);
  Settle();
  EXPECT_EQ(StateOf("mill-1"), v1::MACHINE_STATE_IDLE);
}

}  // namespace
}  // namespace rmlcell::server
