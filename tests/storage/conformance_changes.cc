// What is told of changes without a look at what has changed.
#include <gmock/gmock.h>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using namespace std::chrono_literals;

// store.h JobChanges: whatever becomes of a job, and of what it leaves, is seen in it, and what
// becomes of others is not.
TEST_P(StoreConformance, EachChangeOfAJobIsCounted) {
  const std::int64_t job = Submit().id;
  const std::int64_t other = Submit("CHECK").id;
  const std::uint64_t of_other = store().JobChanges(other);
  std::uint64_t before = 0;
  const auto grew = [&] {
    return store().JobChanges(job) > std::exchange(before, store().JobChanges(job));
  };
  grew();
  EXPECT_FALSE(grew());
  Must(store().HoldBack(job, {}));
  EXPECT_TRUE(grew());
  Must(store().LetGo(job, {}));
  EXPECT_TRUE(grew());
  Must(store().Move(job, 0, 7, {}));
  EXPECT_TRUE(grew());
  LeasedJob leased = Acquire();
  EXPECT_TRUE(grew());
  Must(store().AppendAndWait(leased.lease, {{.kind = "message", .payload = "x"}}));
  EXPECT_TRUE(grew());
  Must(store().HandBack(leased.lease, PolicyOfTests()));
  EXPECT_TRUE(grew());
  Must(store().Abandon(Acquire().lease, PolicyOfTests()));
  EXPECT_TRUE(grew());
  leased = Acquire();
  EXPECT_TRUE(grew());
  Must(store().RequestCancel(job, {}));
  EXPECT_TRUE(grew());
  Must(store().Finish(leased.lease, {.outcome = {.state = JobState::kCancelled},
                                     .artifacts = {{.name = "report", .bytes = "r"}}}));
  EXPECT_TRUE(grew());
  Must(store().ListArtifacts(job));
  Must(store().GetJob(job));
  EXPECT_FALSE(grew());
  Must(store().DeleteJob(job, {}));
  EXPECT_TRUE(grew());
  EXPECT_EQ(store().JobChanges(other), of_other);
}

// One write may change several jobs: the end of a job lets those go that wait for it.
TEST_P(StoreConformance, AChangeOfThoseThatFollowIsCounted) {
  const std::int64_t first = Submit().id;
  const std::int64_t follower =
      Must(store().SubmitAndWait({.kind = "SIMULATE", .after = {first}})).job.id;
  const LeasedJob leased = Acquire();
  ASSERT_EQ(leased.job.id, first);
  const std::uint64_t of_first = store().JobChanges(first);
  const std::uint64_t of_follower = store().JobChanges(follower);
  Finish(leased.lease);
  EXPECT_GT(store().JobChanges(first), of_first);
  EXPECT_GT(store().JobChanges(follower), of_follower);
}

// A lease that ran out is a change as well, and so is a job that a time lets go.
TEST_P(StoreConformance, AChangeByTheClockIsCounted) {
  const std::int64_t job = Submit().id;
  Must(store().AcquireJobs({.worker = "w", .kinds = {"SIMULATE"}, .duration = 1s}));
  const std::int64_t waits =
      Must(store().SubmitAndWait({.kind = "SIMULATE", .not_before = clock().Now() + 2s})).job.id;
  const std::uint64_t of_job = store().JobChanges(job);
  const std::uint64_t of_waits = store().JobChanges(waits);
  clock().Advance(3s);
  Must(store().Expire(PolicyOfTests()));
  EXPECT_GT(store().JobChanges(job), of_job);
  EXPECT_GT(store().JobChanges(waits), of_waits);
}

// store.h MachineChanges.
TEST_P(StoreConformance, EachChangeOfAMachineIsCounted) {
  std::uint64_t before = store().MachineChanges();
  const auto grew = [&] {
    return store().MachineChanges() > std::exchange(before, store().MachineChanges());
  };
  MachineRecord machine = PutMachine("mill-1");
  EXPECT_TRUE(grew());
  machine.parameters["speed"] = "3";
  machine = Must(store().PutMachine(machine, machine.revision));
  EXPECT_TRUE(grew());
  machine.parameters.clear();
  Must(store().PutMachine(machine, machine.revision));
  EXPECT_TRUE(grew());
  Must(store().RequestCancel(Submit("SIMULATE", "mill-1").id, {}));
  PutProgram("mill-1", 1, "object");
  Must(store().ListMachines());
  EXPECT_FALSE(grew());
  Must(store().DeleteMachine("mill-1", kAnyRevision));
  EXPECT_TRUE(grew());
}

// What a caller was told of is counted by then, as is what watchers are woken for.
TEST_P(StoreConformance, AChangeIsCountedBeforeAnybodyIsToldOfIt) {
  const std::int64_t job = Submit().id;
  std::uint64_t before = store().JobChanges(job);
  std::atomic<int> told = 0;
  std::atomic<int> early = 0;
  for (int i = 0; i < 6; ++i) {  // it may be handed back only so often
    const LeasedJob leased = Acquire();
    EXPECT_GT(store().JobChanges(job), before);
    before = store().JobChanges(job);
    store().Append(leased.lease, {{.kind = "message", .payload = "x"}},
                   [&, before](const Result<std::int64_t>&) {
                     early += store().JobChanges(job) == before ? 1 : 0;
                     ++told;
                   });
    ASSERT_TRUE(Eventually([&] { return told == i + 1; }));
    before = store().JobChanges(job);
    Must(store().HandBack(leased.lease, PolicyOfTests()));
    EXPECT_GT(store().JobChanges(job), before);
    before = store().JobChanges(job);
  }
  EXPECT_EQ(early, 0);
}

}  // namespace
}  // namespace rmlcell::storage
