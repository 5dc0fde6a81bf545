// The order of the queue: who starts before whom, and who waits for what (store.h).
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr auto kPrecondition = ErrorCode::kCellPrecondition;
constexpr auto kInvalid = ErrorCode::kCellInvalidArgument;

std::int64_t Put(Store& store, NewJob job) {
  if (job.machine.empty()) job.machine = "optimo-1";
  if (job.kind.empty()) job.kind = "SIMULATE";
  return Must(store.SubmitAndWait(std::move(job))).job.id;
}

// The jobs that start, in order, as many as are ready; they run then.
std::vector<std::int64_t> Started(Store& store,
                                  const std::vector<std::string>& kinds = {"SIMULATE"},
                                  const std::vector<std::string>& run_machines = {}) {
  std::vector<std::int64_t> started;
  for (const LeasedJob& leased : Must(store.AcquireJobs({.worker = "w",
                                 .kinds = kinds,
                                 .run_machines = run_machines,
                                 .count = 100,
                                 .duration = hours(100)}))) {
    started.push_back(leased.job.id);
  }
  return started;
}

void End(Store& store, std::int64_t job, JobState state) {
  const std::vector<AttemptRecord> attempts = Must(store.ListAttempts(job));
  Must(store.Finish({.job = job,
                     .attempt = attempts.back().number,
                     .fence = attempts.back().fence,
                     .worker = "w"},
                    {.outcome = {.state = state}}));
}

std::string WaitOf(Store& store, std::int64_t id) {
  const JobRecord job = Must(store.GetJob(id));
  switch (job.wait) {
    case WaitReason::kNone:
      return "nothing";
    case WaitReason::kHeld:
      return "held";
    case WaitReason::kNotBefore:
      return "its time";
    case WaitReason::kAfterJob:
      return "job " + std::to_string(job.waits_for);
    case WaitReason::kAfterJobFailed:
      return "failed job " + std::to_string(job.waits_for);
    case WaitReason::kMachineBusy:
      return "machine with job " + std::to_string(job.waits_for);
  }
  return "?";
}

TEST_P(StoreConformance, ThoseOfAHigherPriorityStartFirstThenTheOldest) {
  const auto low = Put(store(), {.priority = -100});
  const auto first = Put(store(), {});
  const auto high = Put(store(), {.priority = 100});
  const auto second = Put(store(), {});
  const auto high_too = Put(store(), {.priority = 100});
  Reopen();
  EXPECT_THAT(Started(store()), ElementsAre(high, high_too, first, second, low));
  EXPECT_EQ(Must(store().GetJob(high)).priority, 100);
  for (const int priority : {-101, 101})
    EXPECT_EQ(CodeOf(store().SubmitAndWait({.kind = "CHECK", .priority = priority})), kInvalid);
}

// Over kinds and pools, too.
TEST_P(StoreConformance, ThePriorityCountsOverAllThatAWorkerTakes) {
  const auto check = Put(store(), {.kind = "CHECK"});
  const auto paced = Put(store(), {.pool = "paced", .priority = 5});
  const auto simulate = Put(store(), {.priority = 1});
  std::vector<std::int64_t> started;
  for (const LeasedJob& leased : Must(store().AcquireJobs({.worker = "w",
                                 .kinds = {"CHECK", "SIMULATE"},
                                 .pools = {"", "paced"},
                                 .count = 9,
                                 .duration = hours(100)}))) {
    started.push_back(leased.job.id);
  }
  EXPECT_THAT(started, ElementsAre(paced, simulate, check));
}

TEST_P(StoreConformance, TheAnswerOfASubmissionSaysWhatTheJobWaitsFor) {
  const auto first = Put(store(), {});
  const NewJob after{.request_id = "after",
                     .request_hash = "h",
                     .machine = "optimo-1",
                     .kind = "SIMULATE",
                     .after = {first}};
  for (int round = 0; round < 2; ++round) {  // the second one is the first again
    const SubmittedJob submitted = Must(store().SubmitAndWait(after));
    EXPECT_EQ(submitted.already_there, round == 1);
    EXPECT_EQ(submitted.job.wait, WaitReason::kAfterJob);
    EXPECT_EQ(submitted.job.waits_for, first);
    EXPECT_THAT(submitted.job.after, ElementsAre(first));
  }
  EXPECT_TRUE(Must(store().SubmitAndWait({.kind = "SIMULATE", .held = true})).job.blocked);
  EXPECT_FALSE(Must(store().SubmitAndWait({.kind = "SIMULATE"})).job.blocked);
  EXPECT_EQ(Must(store().SubmitAndWait({.kind = "SIMULATE", .held = true})).job.wait,
            WaitReason::kHeld);
}

TEST_P(StoreConformance, AJobThatIsHeldBackStartsWhenItIsLetGo) {
  const auto held = Put(store(), {.held = true});
  const auto other = Put(store(), {});
  EXPECT_EQ(WaitOf(store(), held), "held");
  EXPECT_EQ(Must(store().HoldBack(other, {{.kind = "queue", .caller = "anna"}})).held, true);
  Must(store().HoldBack(other,
                        {{.kind = "queue", .caller = "carl"}}));  // it is, and nothing is told
  EXPECT_THAT(Started(store()), IsEmpty());
  Reopen();
  EXPECT_THAT(Started(store()), IsEmpty());
  EXPECT_FALSE(Must(store().LetGo(held, {})).held);
  EXPECT_THAT(Started(store()), ElementsAre(held));
  Must(store().LetGo(other, {{.kind = "queue", .caller = "berta"}}));
  const auto events = EventsOf(other);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].caller, "anna");
  EXPECT_EQ(events[1].caller, "berta");
  EXPECT_THAT(Started(store()), ElementsAre(other));
  // What runs or is over is not in the queue.
  EXPECT_EQ(CodeOf(store().HoldBack(other, {})), kPrecondition);
  EXPECT_EQ(CodeOf(store().LetGo(other, {})), kPrecondition);
  EXPECT_EQ(CodeOf(store().HoldBack(999, {})), ErrorCode::kCellNotFound);
}

TEST_P(StoreConformance, AJobStartsNotBeforeItsTime) {
  const WallTime at = clock().Now() + hours(1);
  const auto later = Put(store(), {.not_before = at});
  const auto past = Put(store(), {.not_before = clock().Now() - hours(1)});
  EXPECT_EQ(WaitOf(store(), later), "its time");
  EXPECT_EQ(Must(store().GetJob(later)).not_before, at);
  EXPECT_THAT(Started(store()), ElementsAre(past));
  clock().Advance(hours(1) - seconds(1));
  Must(store().Expire(PolicyOfTests()));
  EXPECT_THAT(Started(store()), IsEmpty());
  clock().Advance(seconds(1));
  Must(store().Expire(PolicyOfTests()));
  EXPECT_EQ(WaitOf(store(), later), "nothing");
  EXPECT_THAT(Started(store()), ElementsAre(later));
}

TEST_P(StoreConformance, AJobWaitsForOthersToSucceed) {
  const auto first = Put(store(), {});
  const auto second = Put(store(), {});
  const auto last = Put(store(), {.after = {second, first, second}});
  EXPECT_EQ(Must(store().GetJob(last)).after, (std::vector<std::int64_t>{first, second}));
  EXPECT_EQ(WaitOf(store(), last), "job " + std::to_string(first));
  EXPECT_THAT(Started(store()), ElementsAre(first, second));
  End(store(), first, JobState::kSucceeded);
  EXPECT_EQ(WaitOf(store(), last), "job " + std::to_string(second));
  EXPECT_THAT(Started(store()), IsEmpty());
  Reopen();
  End(store(), second, JobState::kSucceeded);
  EXPECT_THAT(Started(store()), ElementsAre(last));
  EXPECT_THAT(Must(store().GetJob(last)).after, IsEmpty());
  // One that has succeeded before is waited for no more.
  const auto follower = Put(store(), {.after = {first}});
  EXPECT_THAT(Started(store()), ElementsAre(follower));
}

TEST_P(StoreConformance, AfterAJobThatDidNotSucceedAPersonDecides) {
  const auto first = Put(store(), {});
  const auto second = Put(store(), {.after = {first}});
  Started(store());
  End(store(), first, JobState::kFailed);
  EXPECT_EQ(WaitOf(store(), second), "failed job " + std::to_string(first));
  EXPECT_THAT(Started(store()), IsEmpty());
  // Also when nothing is left of it.
  Must(store().DeleteJob(first));
  EXPECT_EQ(WaitOf(store(), second), "failed job " + std::to_string(first));
  Must(store().LetGo(second, {}));
  EXPECT_THAT(Started(store()), ElementsAre(second));
  EXPECT_EQ(CodeOf(store().SubmitAndWait({.kind = "CHECK", .after = {first}})),
            ErrorCode::kCellNotFound);
  End(store(), second, JobState::kCancelled);
  EXPECT_EQ(CodeOf(store().SubmitAndWait({.kind = "CHECK", .after = {second}})), kPrecondition);
}

// Whichever of them it is: the others may well succeed, and it would help nothing.
TEST_P(StoreConformance, OneThatDidNotSucceedIsToldBeforeThoseThatMay) {
  const auto first = Put(store(), {});
  const auto second = Put(store(), {});
  const auto third = Put(store(), {});
  const auto one = Put(store(), {.after = {first, second}});
  const auto other = Put(store(), {.after = {second, third}});
  const auto last = Put(store(), {.after = {third, first}});
  EXPECT_THAT(Started(store()), ElementsAre(first, second, third));
  End(store(), first, JobState::kFailed);
  EXPECT_EQ(WaitOf(store(), one), "failed job " + std::to_string(first));
  EXPECT_EQ(WaitOf(store(), last), "failed job " + std::to_string(first));
  EXPECT_EQ(WaitOf(store(), other), "job " + std::to_string(second));
  End(store(), third, JobState::kCancelled);
  EXPECT_EQ(WaitOf(store(), other), "failed job " + std::to_string(third));
}

// However they were named: as who asks later finds them.
TEST_P(StoreConformance, AwaitedJobsStandInOrderInTheAnswer) {
  const auto first = Put(store(), {});
  const auto second = Put(store(), {});
  const JobRecord made =
      Must(store().SubmitAndWait({.kind = "SIMULATE", .after = {second, first}})).job;
  EXPECT_THAT(made.after, ElementsAre(first, second));
  EXPECT_EQ(made.wait, WaitReason::kAfterJob);
  EXPECT_EQ(made.waits_for, first);
}

// A submission that is repeated when what it waits for has failed gives the first job.
TEST_P(StoreConformance, ARepeatedRequestGivesItsJobWhateverBecameOfOthers) {
  const auto first = Put(store(), {});
  const NewJob request{.request_id = "r", .kind = "SIMULATE", .after = {first}};
  const auto job = Must(store().SubmitAndWait(request)).job.id;
  Started(store());
  End(store(), first, JobState::kFailed);
  EXPECT_EQ(Must(store().SubmitAndWait(request)).job.id, job);
}

TEST_P(StoreConformance, LettingGoDoesNotEndAWaitThatWillEnd) {
  const auto first = Put(store(), {});
  const auto second = Put(store(), {.held = true, .after = {first}});
  Must(store().LetGo(second, {}));
  EXPECT_EQ(WaitOf(store(), second), "job " + std::to_string(first));
  EXPECT_THAT(Started(store()), ElementsAre(first));
}

TEST_P(StoreConformance, AJobIsMovedInFrontOfAnother) {
  std::vector<std::int64_t> jobs;
  for (int i = 0; i < 4; ++i) jobs.push_back(Put(store(), {}));
  const auto high = Put(store(), {.priority = 3});
  Must(store().Move(jobs[3], jobs[1], {}, {}));
  Must(store().Move(jobs[2], jobs[3], {}, {{.kind = "queue"}}));
  EXPECT_EQ(Must(store().Move(jobs[0], high, {}, {})).priority, 3);
  Reopen();
  EXPECT_THAT(Started(store()), ElementsAre(jobs[0], high, jobs[2], jobs[3], jobs[1]));
}

TEST_P(StoreConformance, AJobIsMovedBehindAllOthersOfItsPriority) {
  const auto first = Put(store(), {});
  const auto second = Put(store(), {});
  Must(store().Move(first, 0, {}, {}));
  Must(store().Move(second, 0, {}, {}));
  const auto third = Put(store(), {});  // whoever comes later stands behind
  const auto low = Put(store(), {.priority = -1});
  Must(store().Move(third, 0, 7, {}));
  EXPECT_EQ(Must(store().GetJob(third)).priority, 7);
  EXPECT_THAT(Started(store()), ElementsAre(third, first, second, low));
}

TEST_P(StoreConformance, WhatCannotBeMoved) {
  const auto one = Put(store(), {});
  const auto two = Put(store(), {});
  const auto check = Put(store(), {.kind = "CHECK"});
  EXPECT_EQ(CodeOf(store().Move(one, one, {}, {})), kInvalid);
  EXPECT_EQ(CodeOf(store().Move(one, 0, 101, {})), kInvalid);
  EXPECT_EQ(CodeOf(store().Move(one, two, 5, {})), kInvalid);
  EXPECT_EQ(CodeOf(store().Move(one, check, {}, {})), kPrecondition);
  EXPECT_EQ(CodeOf(store().Move(one, 999, {}, {})), ErrorCode::kCellNotFound);
  Started(store());
  EXPECT_EQ(CodeOf(store().Move(one, 0, {}, {})), kPrecondition);
}

// Halving leaves no number in between after some fifty moves; there is room all the same.
TEST_P(StoreConformance, ThereIsAlwaysRoomInFrontOfAJob) {
  const auto front = Put(store(), {});
  const auto back = Put(store(), {});
  std::vector<std::int64_t> moved;
  for (int i = 0; i < 90; ++i) {
    moved.push_back(Put(store(), {}));
    Must(store().Move(moved.back(), back, {}, {}));
  }
  const auto started = Started(store());
  ASSERT_EQ(started.size(), moved.size() + 2);
  EXPECT_EQ(started.front(), front);
  EXPECT_TRUE(std::equal(moved.begin(), moved.end(), started.begin() + 1));
  EXPECT_EQ(started.back(), back);
}

// The same two, again and again: in front of a third, of each other, and behind all.
TEST_P(StoreConformance, JobsAreMovedToAndFroWithoutAnEnd) {
  const auto first = Put(store(), {});
  const auto held = Put(store(), {.held = true});
  const auto third = Put(store(), {});
  const auto fourth = Put(store(), {});
  for (int i = 0; i < 150; ++i) {
    Must(store().Move(fourth, first, {}, {}));
    Must(store().Move(third, fourth, {}, {}));
    Must(store().Move(fourth, third, {}, {}));
  }
  for (int i = 0; i < 150; ++i) {
    Must(store().Move(third, 0, {}, {}));
    Must(store().Move(first, 0, {}, {}));
  }
  const auto last = Put(store(), {});
  Must(store().LetGo(held, {}));
  EXPECT_THAT(Started(store()), ElementsAre(fourth, held, third, first, last));
}

// store.h ActOn: of those that it changes.
TEST_P(StoreConformance, ManyAreChangedAtOnce) {
  const auto first = Put(store(), {});
  const auto follower = Put(store(), {.after = {first}});
  const auto held = Put(store(), {.held = true});
  const auto plain = Put(store(), {});
  const std::vector<std::int64_t> all = {plain, follower, 999, held, first};
  const auto act = [&](QueueAct what) {
    std::vector<std::int64_t> changed;
    const auto event = [](const JobRecord&) { return NewEvent{.kind = "queue"}; };
    for (const JobRecord& job : Must(store().ActOn(all, what, event))) changed.push_back(job.id);
    return changed;
  };
  EXPECT_THAT(act(QueueAct::kHold), ElementsAre(plain, follower, first));
  EXPECT_THAT(act(QueueAct::kRelease), ElementsAre(plain, follower, held, first));
  EXPECT_THAT(act(QueueAct::kRelease), IsEmpty());
  EXPECT_EQ(WaitOf(store(), follower), "job " + std::to_string(first));
  Must(store().RequestCancel(first, {}));
  EXPECT_THAT(act(QueueAct::kRelease), ElementsAre(follower));  // a person decides
  EXPECT_THAT(act(QueueAct::kCancel), ElementsAre(plain, follower, held));
  EXPECT_THAT(act(QueueAct::kCancel), IsEmpty());
  EXPECT_EQ(Must(store().JobEvents(plain, 0, 10)).size(), 3U);
}

// One that is over is no more to be cancelled, and one that runs once.
TEST_P(StoreConformance, ManyAreCancelledOnce) {
  const auto over = Put(store(), {});
  const auto runs = Put(store(), {});
  EXPECT_THAT(Started(store()), ElementsAre(over, runs));
  End(store(), over, JobState::kSucceeded);
  const std::vector<std::int64_t> both = {over, runs};
  const auto event = [](const JobRecord&) { return NewEvent{.kind = "queue"}; };
  EXPECT_THAT(IdsOf(Must(store().ActOn(both, QueueAct::kCancel, event))), ElementsAre(runs));
  EXPECT_TRUE(Must(store().GetJob(runs)).cancel_requested);
  EXPECT_THAT(IdsOf(Must(store().ActOn(both, QueueAct::kCancel, event))), IsEmpty());
}

// Also where nothing is left of what it waited for.
TEST_P(StoreConformance, ManyAreLetGoFromADeletedJob) {
  const auto first = Put(store(), {});
  const auto second = Put(store(), {.after = {first}});
  Started(store());
  End(store(), first, JobState::kFailed);
  Must(store().DeleteJob(first));
  const std::vector<std::int64_t> one = {second};
  const auto event = [](const JobRecord&) { return NewEvent{.kind = "queue"}; };
  EXPECT_THAT(IdsOf(Must(store().ActOn(one, QueueAct::kRelease, event))), ElementsAre(second));
  EXPECT_THAT(IdsOf(Must(store().ActOn(one, QueueAct::kRelease, event))), IsEmpty());
  EXPECT_THAT(Started(store()), ElementsAre(second));
}

// Of all kinds together, before those that wait.
TEST_P(StoreConformance, ThoseThatRunAreListedByTheirNumber) {
  const auto simulate = Put(store(), {});
  const auto check = Put(store(), {.kind = "CHECK"});
  const auto paced = Put(store(), {.kind = "CHECK", .pool = "paced"});
  Started(store(), {"CHECK", "SIMULATE"});
  EXPECT_THAT(IdsOf(Must(store().ListJobs({.order = JobOrder::kQueue, .limit = 9}))),
              ElementsAre(simulate, check, paced));
}

// Least of all for the machine that it keeps busy itself.
TEST_P(StoreConformance, WhatRunsWaitsForNothing) {
  const auto run = Put(store(), {.machine = "a", .kind = "RUN"});
  EXPECT_THAT(Started(store(), {"RUN"}), ElementsAre(run));
  EXPECT_EQ(WaitOf(store(), run), "nothing");
}

TEST_P(StoreConformance, AMachineRunsOneRunAtATime) {
  const auto first = Put(store(), {.machine = "a", .kind = "RUN"});
  const auto second = Put(store(), {.machine = "a", .kind = "RUN", .priority = 1});
  const auto other = Put(store(), {.machine = "b", .kind = "RUN"});
  EXPECT_THAT(Started(store(), {"RUN"}), ElementsAre(second, other));
  EXPECT_EQ(WaitOf(store(), first), "machine with job " + std::to_string(second));
  EXPECT_THAT(Started(store(), {"RUN"}), IsEmpty());
  End(store(), second, JobState::kSucceeded);
  EXPECT_EQ(WaitOf(store(), first), "nothing");
  EXPECT_THAT(Started(store(), {"RUN"}), ElementsAre(first));
}

TEST_P(StoreConformance, AHostTakesRunsOfItsMachinesAlone) {
  const auto a = Put(store(), {.machine = "a", .kind = "RUN"});
  const auto b = Put(store(), {.machine = "b", .kind = "RUN"});
  const auto simulated = Put(store(), {.machine = "b"});
  EXPECT_THAT(Started(store(), {"RUN"}, {"c"}), IsEmpty());
  EXPECT_THAT(Started(store(), {"RUN"}, {"b", "c"}), ElementsAre(b));
  // Other kinds do not look at it.
  EXPECT_THAT(Started(store(), {"RUN", "SIMULATE"}, {"a"}), ElementsAre(a, simulated));
}

// Whoever comes back to the queue stands where it stood.
TEST_P(StoreConformance, AJobThatIsHandedBackKeepsItsPlace) {
  const auto first = Put(store(), {});
  const auto second = Put(store(), {});
  Must(store().Move(second, first, {}, {}));
  const auto leased = Must(store().Acquire("w", {"SIMULATE"}, hours(1), {}));
  EXPECT_EQ(leased->job.id, second);
  Must(store().HandBack(leased->lease, PolicyOfTests()));
  EXPECT_THAT(Started(store()), ElementsAre(second, first));
}

TEST_P(StoreConformance, ListsHaveThoseThatWaitInEveryWay) {
  std::vector<std::int64_t> jobs;
  jobs.push_back(Put(store(), {}));
  jobs.push_back(Put(store(), {.held = true}));
  jobs.push_back(Put(store(), {.priority = 9}));
  jobs.push_back(Put(store(), {.after = {jobs[0]}}));
  jobs.push_back(Put(store(), {.pool = "paced", .not_before = clock().Now() + hours(1)}));
  std::ranges::reverse(jobs);
  std::vector<std::int64_t> listed;
  for (const JobRecord& job : Must(store().ListJobs({.state = JobState::kQueued})))
    listed.push_back(job.id);
  EXPECT_EQ(listed, jobs);
}

TEST_P(StoreConformance, AJobKnowsHowManyStartBeforeIt) {
  const auto first = Put(store(), {});
  const auto second = Put(store(), {});
  const auto high = Put(store(), {.priority = 5});
  const auto held = Put(store(), {.priority = 9, .held = true});  // it does not start
  Put(store(), {.kind = "CHECK", .priority = 9});                 // for other workers
  Put(store(), {.pool = "paced", .priority = 9});
  const auto third = Put(store(), {});
  const auto before = [&](std::int64_t job) { return Must(store().CountBefore(job)); };
  EXPECT_EQ(before(high), 0);
  EXPECT_EQ(before(first), 1);
  EXPECT_EQ(before(second), 2);
  EXPECT_EQ(before(third), 3);
  Must(store().Move(third, second, std::nullopt, {}));
  EXPECT_EQ(before(third), 2);
  EXPECT_EQ(before(second), 3);
  Must(store().LetGo(held, {}));
  EXPECT_EQ(before(high), 1);
  EXPECT_EQ(Started(store()).size(), 5U);
  EXPECT_EQ(CodeOf(store().CountBefore(first)), kPrecondition);
  EXPECT_EQ(CodeOf(store().CountBefore(999)), ErrorCode::kCellNotFound);
}

Lease LeaseFor(Store& store, const std::string& server) {
  return Must(store.AcquireJobs(
                  {.worker = "w", .server = server, .kinds = {"SIMULATE"}, .duration = hours(100)}))
      .at(0)
      .lease;
}

// IF-07.
TEST_P(StoreConformance, AnOrderIsForTheServerThatHasTheJob) {
  const auto one = Put(store(), {});
  const auto two = Put(store(), {});
  EXPECT_EQ(CodeOf(store().PutOrder(one, "b", "stop")), kPrecondition);  // it waits
  const Lease of_a = LeaseFor(store(), "a");
  const Lease of_b = LeaseFor(store(), "b");
  EXPECT_EQ(of_a.server, "a");
  EXPECT_EQ(CodeOf(store().PutOrder(one, "a", "stop")), kPrecondition);  // it is its own
  EXPECT_EQ(CodeOf(store().PutOrder(999, "a", "stop")), kPrecondition);
  ASSERT_TRUE(store().PutOrder(one, "b", std::string("\0first", 6)));
  ASSERT_TRUE(store().PutOrder(two, "a", "for b"));
  ASSERT_TRUE(store().PutOrder(one, "c", "second"));
  Reopen();
  const std::vector<TakenOrder> taken = Must(store().TakeOrders("a"));
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken[0].payload, std::string("\0first", 6));
  EXPECT_EQ(taken[0].lease.job, one);
  EXPECT_EQ(taken[0].lease.fence, of_a.fence);
  EXPECT_EQ(taken[0].lease.attempt, of_a.attempt);
  EXPECT_EQ(taken[0].lease.worker, "w");
  EXPECT_EQ(taken[0].lease.server, "a");
  EXPECT_EQ(taken[1].payload, "second");
  EXPECT_THAT(Must(store().TakeOrders("a")), IsEmpty());  // once
  EXPECT_EQ(Must(store().TakeOrders("b")).size(), 1U);
}

TEST_P(StoreConformance, AnOrderIsGoneWithItsLease) {
  const auto job = Put(store(), {});
  const Lease first = LeaseFor(store(), "a");
  ASSERT_TRUE(store().PutOrder(job, "b", "of the first attempt"));
  Must(store().HandBack(first, PolicyOfTests()));
  LeaseFor(store(), "a");  // the same server has it again
  EXPECT_THAT(Must(store().TakeOrders("a")), IsEmpty());
  ASSERT_TRUE(store().PutOrder(job, "b", "of the second"));
  EXPECT_EQ(Must(store().TakeOrders("a")).size(), 1U);
}

}  // namespace
}  // namespace rmlcell::storage
