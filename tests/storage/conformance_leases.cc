// Leases, attempts and the ends of jobs with any Store: platform.md section 5.
#include <gmock/gmock.h>

#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::chrono::milliseconds kTick{1};

std::vector<std::string> EndsOf(const std::vector<AttemptRecord>& attempts) {
  std::vector<std::string> ends;
  for (const AttemptRecord& attempt : attempts) ends.push_back(attempt.how_it_ended);
  return ends;
}

TEST_P(StoreConformance, LeaseTellsAllOfTheJob) {
  const JobRecord job =
      Must(store().SubmitAndWait({.machine = "m", .kind = "CHECK", .specification = "spec"})).job;
  clock().Advance(std::chrono::seconds(2));
  const std::optional<LeasedJob> leased =
      Must(store().Acquire("w1", {"CHECK"}, kLease, {{.kind = "state", .payload = "running"}}));
  ASSERT_TRUE(leased);
  EXPECT_EQ(leased->lease.job, job.id);
  EXPECT_EQ(leased->lease.attempt, 1);
  EXPECT_EQ(leased->lease.worker, "w1");
  EXPECT_EQ(leased->lease.until, clock().Now() + kLease);
  EXPECT_EQ(leased->job.state, JobState::kRunning);
  EXPECT_EQ(leased->job.attempts, 1);
  EXPECT_EQ(leased->job.specification, "spec");
  EXPECT_EQ(leased->job.started_at, clock().Now());
  const auto events = EventsOf(job.id);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].attempt, 1);
  const auto attempts = Must(store().ListAttempts(job.id));
  ASSERT_EQ(attempts.size(), 1U);
  EXPECT_EQ(attempts[0].number, 1);
  EXPECT_EQ(attempts[0].worker, "w1");
  EXPECT_EQ(attempts[0].fence, leased->lease.fence);
  EXPECT_EQ(attempts[0].started_at, clock().Now());
  EXPECT_EQ(attempts[0].ended_at, std::nullopt);
  EXPECT_EQ(attempts[0].how_it_ended, "");
}

// platform.md 5: at most one holder, however many ask.
TEST_P(StoreConformance, NoJobIsLeasedTwice) {
  constexpr int kJobs = 200;
  constexpr int kWorkers = 8;
  for (int i = 0; i < kJobs; ++i) Submit();
  std::mutex mutex;
  std::multiset<std::int64_t> jobs;
  std::set<std::int64_t> fences;
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < kWorkers; ++i) {
      workers.emplace_back([&, i] {
        for (;;) {
          const auto leased = store().Acquire(Numbered("w", i), {"SIMULATE"}, kLease, {});
          if (!leased || !*leased) return;
          const std::lock_guard lock(mutex);
          jobs.insert((*leased)->job.id);
          fences.insert((*leased)->lease.fence);
        }
      });
    }
  }
  EXPECT_EQ(jobs.size(), static_cast<std::size_t>(kJobs));
  EXPECT_EQ(std::set<std::int64_t>(jobs.begin(), jobs.end()).size(), jobs.size());
  EXPECT_EQ(fences.size(), jobs.size());
}

// store.h Lease: fences grow with every lease ever given, over restarts.
TEST_P(StoreConformance, FencesGrow) {
  std::int64_t fence = 0;
  for (int i = 0; i < 3; ++i) {
    const LeasedJob leased = (Submit(), Acquire());
    EXPECT_GT(leased.lease.fence, fence);
    fence = leased.lease.fence;
    Must(store().HandBack(leased.lease, PolicyOfTests()));
    Reopen();
  }
}

// design.md section 3, step 9: whoever lost the lease is refused in everything.
TEST_P(StoreConformance, StaleWorkerIsRefused) {
  constexpr auto kLost = ErrorCode::kCellLeaseLost;
  const Lease stale = (Submit(), Acquire("slow")).lease;
  clock().Advance(kLease + kTick);
  ASSERT_EQ(Must(store().Expire(PolicyOfTests())).size(), 1U);
  const auto refused = [&] {
    EXPECT_EQ(CodeOf(store().Renew(stale, kLease)), kLost);
    EXPECT_EQ(CodeOf(store().AppendAndWait(stale, {{.kind = "e", .payload = ""}})), kLost);
    EXPECT_EQ(CodeOf(store().AppendAndWait(stale, {})), kLost);
    EXPECT_EQ(CodeOf(store().Finish(stale, {.artifacts = {{.name = "report", .bytes = "r"}}})),
              kLost);
    EXPECT_EQ(CodeOf(store().HandBack(stale, PolicyOfTests())), kLost);
    EXPECT_EQ(CodeOf(store().Abandon(stale, PolicyOfTests())), kLost);
  };
  refused();  // while the job waits
  const Lease next = Acquire("fast").lease;
  EXPECT_EQ(next.job, stale.job);
  EXPECT_EQ(next.attempt, 2);
  EXPECT_GT(next.fence, stale.fence);
  refused();  // while another works on it
  EXPECT_EQ(Must(store().AppendAndWait(next, {{.kind = "mine", .payload = ""}})), 2);
  EXPECT_EQ(Finish(next).state, JobState::kSucceeded);
  refused();  // and after the end
  EXPECT_THAT(KindsOf(EventsOf(stale.job)), ElementsAre("requeued", "mine"));
  EXPECT_THAT(Must(store().ListArtifacts(stale.job)), IsEmpty());
}

// Every part of a lease counts, not only the fence.
TEST_P(StoreConformance, LeaseIsCheckedByJobAttemptAndFence) {
  const Lease first = (Submit(), Acquire()).lease;
  const Lease second = (Submit(), Acquire()).lease;
  Lease wrong = first;
  wrong.job = second.job;
  EXPECT_EQ(CodeOf(store().Renew(wrong, kLease)), ErrorCode::kCellLeaseLost);
  wrong = first;
  wrong.attempt = 2;
  EXPECT_EQ(CodeOf(store().Renew(wrong, kLease)), ErrorCode::kCellLeaseLost);
  wrong = first;
  wrong.fence += 1;
  EXPECT_EQ(CodeOf(store().Renew(wrong, kLease)), ErrorCode::kCellLeaseLost);
  wrong = first;
  wrong.job = 9'999;
  EXPECT_EQ(CodeOf(store().Renew(wrong, kLease)), ErrorCode::kCellLeaseLost);
  EXPECT_EQ(CodeOf(store().Renew(first, kLease)), std::nullopt);
}

// store.h: until `duration` from now; it ends at that instant, not before.
TEST_P(StoreConformance, RenewedLeaseLivesOn) {
  const Lease lease = (Submit(), Acquire()).lease;
  clock().Advance(kLease - kTick);
  EXPECT_THAT(Must(store().Expire(PolicyOfTests())), IsEmpty());
  EXPECT_EQ(Must(store().Renew(lease, kLease)).state, JobState::kRunning);
  clock().Advance(kLease - kTick);
  EXPECT_THAT(Must(store().Expire(PolicyOfTests())), IsEmpty());
  clock().Advance(kTick);
  EXPECT_EQ(Must(store().Expire(PolicyOfTests())).size(), 1U);
  EXPECT_THAT(Must(store().Expire(PolicyOfTests())), IsEmpty());
}

// store.h: a lease that ran out stays its holder's until Expire() takes it.
TEST_P(StoreConformance, LateFinishCountsWhileNobodyTookTheJob) {
  const Lease lease = (Submit(), Acquire()).lease;
  clock().Advance(2 * kLease);
  EXPECT_EQ(Finish(lease).state, JobState::kSucceeded);
  EXPECT_THAT(Must(store().Expire(PolicyOfTests())), IsEmpty());
}

// platform.md 5, expiry during finish: one of the two happens, wholly.
TEST_P(StoreConformance, ExpiryRacesWithFinish) {
  for (int round = 0; round < 50; ++round) {
    const Lease lease = (Submit(), Acquire()).lease;
    clock().Advance(2 * kLease);
    Result<JobRecord> finished = Error{ErrorCode::kCellInternal, {}, {}};
    std::vector<JobRecord> expired;
    {
      const std::jthread worker([&] {
        finished = store().Finish(lease, {.artifacts = {{.name = "report", .bytes = "r"}},
                                          .events = {{.kind = "finished", .payload = ""}}});
      });
      const std::jthread server([&] { expired = Must(store().Expire(PolicyOfTests())); });
    }
    const JobRecord job = Must(store().GetJob(lease.job));
    const auto events = KindsOf(EventsOf(lease.job));
    const std::size_t artifacts = Must(store().ListArtifacts(lease.job)).size();
    if (finished) {
      EXPECT_THAT(expired, IsEmpty());
      EXPECT_EQ(job.state, JobState::kSucceeded);
      EXPECT_THAT(events, ElementsAre("finished"));
      EXPECT_EQ(artifacts, 1U);
    } else {
      EXPECT_EQ(finished.error().code, ErrorCode::kCellLeaseLost);
      EXPECT_EQ(expired.size(), 1U);
      EXPECT_EQ(job.state, JobState::kQueued);
      EXPECT_THAT(events, ElementsAre("requeued"));
      EXPECT_EQ(artifacts, 0U);
      Must(store().RequestCancel(lease.job, {}));
    }
  }
}

// Issue 2: attempted again while attempts are left (default twice), then it fails with a code that
// says so.
TEST_P(StoreConformance, JobIsAttemptedAgainAsOftenAsItsPolicySays) {
  const JobRecord job = Submit();
  const Lease first = Acquire("w1").lease;
  clock().Advance(2 * kLease);
  const auto requeued = Must(store().Expire(PolicyOfTests()));
  ASSERT_EQ(requeued.size(), 1U);
  EXPECT_EQ(requeued[0].id, job.id);
  EXPECT_EQ(requeued[0].state, JobState::kQueued);
  EXPECT_EQ(requeued[0].attempts, 1);
  EXPECT_EQ(requeued[0].last_sequence, 1);
  EXPECT_FALSE(requeued[0].outcome);

  const LeasedJob second = Acquire("w2");
  EXPECT_EQ(second.job.attempts, 2);
  EXPECT_EQ(second.job.started_at, clock().Now() - 2 * kLease);  // of the first attempt
  clock().Advance(2 * kLease);
  const auto failed = Must(store().Expire(PolicyOfTests()));
  ASSERT_EQ(failed.size(), 1U);
  EXPECT_EQ(failed[0].state, JobState::kFailed);
  ASSERT_TRUE(failed[0].outcome);
  EXPECT_EQ(failed[0].outcome->code, ErrorCode::kCellWorkerDied);
  EXPECT_EQ(failed[0].outcome->detail, "it died");
  EXPECT_EQ(failed[0].outcome->program, 12);
  EXPECT_EQ(failed[0].outcome->step, 34);
  EXPECT_EQ(failed[0].finished_at, clock().Now());

  EXPECT_FALSE(Must(store().Acquire("w3", {"SIMULATE"}, kLease, {})));
  EXPECT_THAT(KindsOf(EventsOf(job.id)), ElementsAre("requeued", "ended"));
  const auto attempts = Must(store().ListAttempts(job.id));
  EXPECT_THAT(EndsOf(attempts), ElementsAre("lease ran out", "lease ran out"));
  EXPECT_EQ(attempts[0].fence, first.fence);
  EXPECT_EQ(attempts[1].worker, "w2");
  EXPECT_EQ(attempts[1].ended_at, clock().Now());
}

// design.md section 8: a job that moved a machine is never repeated by itself; it ends as
// interrupted.
TEST_P(StoreConformance, RunIsInterruptedNotRepeated) {
  const LeasedJob leased = (Submit("RUN"), Acquire("w", "RUN"));
  EXPECT_EQ(leased.job.attempts_max, 2);
  Must(store().RequestCancel(leased.job.id, {}));
  clock().Advance(2 * kLease);
  const auto ended = Must(store().Expire(PolicyOfTests()));
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].state, JobState::kInterrupted);
  EXPECT_EQ(ended[0].outcome->state, JobState::kInterrupted);
  EXPECT_EQ(ended[0].outcome->code, ErrorCode::kCellWorkerDied);
  EXPECT_EQ(ended[0].outcome->step, 34);
  EXPECT_THAT(KindsOf(EventsOf(leased.job.id)), ElementsAre("interrupted"));
  EXPECT_FALSE(Must(store().Acquire("w", {"RUN"}, kLease, {})));
  // It has ended: a cancel that comes late changes nothing.
  EXPECT_EQ(Must(store().RequestCancel(leased.job.id, {{.kind = "ended", .payload = "c"}})).state,
            JobState::kInterrupted);
  EXPECT_THAT(KindsOf(EventsOf(leased.job.id)), ElementsAre("interrupted"));
}

// store.h LossPolicy: a lost job whose cancel was requested is cancelled, if the caller has events
// for that.
TEST_P(StoreConformance, LostJobIsCancelledWhenThatWasWanted) {
  const LeasedJob leased = (Submit(), Acquire());
  Must(store().RequestCancel(leased.job.id, {}));
  const JobRecord ended = Must(store().Abandon(leased.lease, PolicyOfTests()));
  EXPECT_EQ(ended.state, JobState::kCancelled);
  EXPECT_EQ(ended.outcome->code, ErrorCode::kCellCancelled);
  EXPECT_THAT(KindsOf(EventsOf(leased.job.id)), ElementsAre("cancelled"));

  const LeasedJob another = (Submit(), Acquire());
  Must(store().RequestCancel(another.job.id, {}));
  LossPolicy policy = PolicyOfTests();
  policy.cancelled.clear();
  EXPECT_EQ(Must(store().Abandon(another.lease, policy)).state, JobState::kQueued);
  EXPECT_TRUE(Acquire().job.cancel_requested);  // the new holder ends it
}

// store.h Abandon: as if the lease ran out now.
TEST_P(StoreConformance, AbandonedJobFollowsThePolicyAtOnce) {
  const JobRecord job = Submit();
  EXPECT_EQ(Must(store().Abandon(Acquire().lease, PolicyOfTests())).state, JobState::kQueued);
  const JobRecord ended = Must(store().Abandon(Acquire().lease, PolicyOfTests()));
  EXPECT_EQ(ended.state, JobState::kFailed);
  EXPECT_EQ(ended.outcome->code, ErrorCode::kCellWorkerDied);
  EXPECT_THAT(EndsOf(Must(store().ListAttempts(job.id))), ElementsAre("abandoned", "abandoned"));
}

TEST_P(StoreConformance, PolicyNeedsAFinalOutcome) {
  const LeasedJob leased = (Submit(), Acquire());
  LossPolicy policy = PolicyOfTests();
  policy.outcome.state = JobState::kQueued;
  EXPECT_EQ(CodeOf(store().Abandon(leased.lease, policy)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(store().Expire(policy)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(store().Finish(leased.lease, {.outcome = {.state = JobState::kRunning}})),
            ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(store().Renew(leased.lease, kLease)), std::nullopt);
}

// store.h HandBack: the attempt does not count, but keeps its number.
TEST_P(StoreConformance, HandedBackAttemptDoesNotCount) {
  const JobRecord job = Submit();
  for (int i = 1; i <= 5; ++i) {
    const LeasedJob leased = Acquire();
    EXPECT_EQ(leased.lease.attempt, i);
    EXPECT_EQ(leased.job.attempts, 1);
    EXPECT_EQ(Must(store().HandBack(leased.lease, PolicyOfTests())).state, JobState::kQueued);
    EXPECT_EQ(Must(store().GetJob(job.id)).state, JobState::kQueued);
    EXPECT_EQ(Must(store().GetJob(job.id)).attempts, 0);
  }
  EXPECT_EQ(Must(store().Abandon(Acquire().lease, PolicyOfTests())).state, JobState::kQueued);
  EXPECT_EQ(Must(store().Abandon(Acquire().lease, PolicyOfTests())).state, JobState::kFailed);
  const auto attempts = Must(store().ListAttempts(job.id));
  EXPECT_EQ(attempts.size(), 7U);
  EXPECT_EQ(attempts[0].how_it_ended, "handed back");
  EXPECT_EQ(attempts[6].number, 7);
  EXPECT_EQ(EventsOf(job.id)[4].attempt, 5);
}

// store.h HandBack: what moved a machine is not begun again, though attempts are left.
TEST_P(StoreConformance, RunThatIsHandedBackIsInterrupted) {
  const LeasedJob leased = (Submit("RUN"), Acquire("w", "RUN"));
  const JobRecord ended = Must(store().HandBack(leased.lease, PolicyOfTests()));
  EXPECT_EQ(ended.state, JobState::kInterrupted);
  EXPECT_EQ(ended.attempts, 1);
  ASSERT_TRUE(ended.outcome);
  EXPECT_EQ(ended.outcome->state, JobState::kInterrupted);
  EXPECT_EQ(ended.outcome->code, ErrorCode::kCellWorkerDied);
  EXPECT_EQ(ended.outcome->program, 12);
  EXPECT_EQ(ended.outcome->step, 34);
  EXPECT_EQ(ended.finished_at, clock().Now());
  EXPECT_THAT(KindsOf(EventsOf(leased.job.id)), ElementsAre("interrupted"));
  EXPECT_THAT(EndsOf(Must(store().ListAttempts(leased.job.id))), ElementsAre("handed back"));
  EXPECT_FALSE(Must(store().Acquire("w", {"RUN"}, kLease, {})));
  EXPECT_EQ(CodeOf(store().HandBack(leased.lease, PolicyOfTests())), ErrorCode::kCellLeaseLost);
}

// LIVE-5.01: before START it goes back to the queue, and that does not count.
TEST_P(StoreConformance, RunThatNeverBeganWaitsAgain) {
  const LeasedJob leased = (Submit("RUN"), Acquire("w", "RUN"));
  LossPolicy policy = PolicyOfTests();
  policy.not_begun = true;
  const JobRecord back = Must(store().HandBack(leased.lease, policy));
  EXPECT_EQ(back.state, JobState::kQueued);
  EXPECT_EQ(back.attempts, 0);
  EXPECT_EQ(Acquire("w", "RUN").lease.attempt, 2);
}

// LIVE-5.01: where a person is wanted it waits for one.
TEST_P(StoreConformance, RunThatIsHandedBackToAPersonIsHeld) {
  const LeasedJob leased = (Submit("RUN"), Acquire("w", "RUN"));
  LossPolicy policy = PolicyOfTests();
  policy.not_begun = true;
  policy.held = true;
  const JobRecord back = Must(store().HandBack(leased.lease, policy));
  EXPECT_EQ(back.state, JobState::kQueued);
  EXPECT_TRUE(back.held);
  EXPECT_EQ(Must(store().GetJob(leased.job.id)).wait, WaitReason::kHeld);
  EXPECT_FALSE(Must(store().Acquire("w", {"RUN"}, kLease, {})));
  Must(store().LetGo(leased.job.id, {}));
  EXPECT_EQ(Acquire("w", "RUN").lease.attempt, 2);
}

// LIVE-5.01: nobody but its machine would end one whose cancel came meanwhile: it ends as it is
// given back. One of another kind is ended by whoever takes it next.
TEST_P(StoreConformance, RunThatNeverBeganAndIsCancelledEnds) {
  LossPolicy policy = PolicyOfTests();
  policy.not_begun = true;
  const LeasedJob run = (Submit("RUN"), Acquire("w", "RUN"));
  Must(store().RequestCancel(run.job.id, {}));
  const JobRecord ended = Must(store().HandBack(run.lease, policy));
  EXPECT_EQ(ended.state, JobState::kCancelled);
  ASSERT_TRUE(ended.outcome);
  EXPECT_EQ(ended.outcome->code, ErrorCode::kCellCancelled);
  EXPECT_EQ(ended.attempts, 0);
  EXPECT_THAT(KindsOf(EventsOf(run.job.id)), ElementsAre("cancelled"));
  EXPECT_EQ(EventsOf(run.job.id)[0].attempt, run.lease.attempt);
  EXPECT_THAT(EndsOf(Must(store().ListAttempts(run.job.id))), ElementsAre("handed back"));
  EXPECT_EQ(Must(store().GetJob(run.job.id)).state, JobState::kCancelled);
  const LeasedJob other = (Submit(), Acquire());
  Must(store().RequestCancel(other.job.id, {}));
  EXPECT_EQ(Must(store().HandBack(other.lease, policy)).state, JobState::kQueued);
  EXPECT_THAT(KindsOf(EventsOf(other.job.id)), ElementsAre("requeued"));
  EXPECT_TRUE(Acquire().job.cancel_requested);
}

// store.h LossPolicy: its outcome is one that ends a job.
TEST_P(StoreConformance, WhatIsGivenBackHasAnOutcomeThatEndsIt) {
  const LeasedJob leased = (Submit(), Acquire());
  LossPolicy policy = PolicyOfTests();
  policy.outcome.state = JobState::kRunning;
  EXPECT_EQ(CodeOf(store().HandBack(leased.lease, policy)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(store().Abandon(leased.lease, policy)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(CodeOf(store().Expire(policy)), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(Must(store().GetJob(leased.job.id)).state, JobState::kRunning);
}

// scale-out.md section 16 and OPT-1.15: what a run compiled comes with its end, for the object that
// it had.
TEST_P(StoreConformance, FinishKeepsExecutablesOfUnchangedObjects) {
  PutMachine("m");
  Must(store().PutPrograms("m", {{.slot = 3, .object = "three"}, {.slot = 4, .object = "four"}},
                           {}));
  Must(store().PutPrograms("m", {{.slot = 4, .object = "altered"}}, {}));
  Submit("SIMULATE", "m");
  const LeasedJob leased = Acquire();
  const JobEnd end{
      .executables = {{3, 1, "made of three"}, {4, 1, "made of four"}, {5, 1, "of none"}}};
  Lease stale = leased.lease;
  stale.fence -= 1;
  EXPECT_EQ(CodeOf(store().Finish(stale, end)), ErrorCode::kCellLeaseLost);
  EXPECT_EQ(Must(store().GetProgram("m", 3)).executable, std::nullopt);
  Must(store().Finish(leased.lease, end));
  Reopen();
  EXPECT_EQ(Must(store().GetProgram("m", 3)).executable, "made of three");
  EXPECT_EQ(Must(store().GetProgram("m", 4)).executable, std::nullopt);
  EXPECT_EQ(CodeOf(store().GetProgram("m", 5)), ErrorCode::kCellNotFound);
}

// store.h Finish: state, outcome, times, events and artifacts come together.
TEST_P(StoreConformance, FinishEndsTheJob) {
  const LeasedJob leased = (Submit(), Acquire());
  clock().Advance(std::chrono::seconds(1));
  const JobOutcome outcome{.state = JobState::kFailed,
                           .code = ErrorCode::kHoleRadiusZero,
                           .detail = "radius is 0",
                           .program = 45,
                           .step = 7};
  const JobRecord finished =
      Must(store().Finish(leased.lease, {.outcome = outcome,
                                         .artifacts = {{.name = "report", .bytes = "{}"}},
                                         .events = {{.kind = "ended", .payload = "x"}}}));
  EXPECT_EQ(finished.last_sequence, 1);
  Reopen();
  const JobRecord job = Must(store().GetJob(leased.job.id));
  EXPECT_EQ(job.state, JobState::kFailed);
  ASSERT_TRUE(job.outcome);
  EXPECT_EQ(job.outcome->state, JobState::kFailed);
  EXPECT_EQ(job.outcome->code, ErrorCode::kHoleRadiusZero);
  EXPECT_EQ(job.outcome->detail, "radius is 0");
  EXPECT_EQ(job.outcome->program, 45);
  EXPECT_EQ(job.outcome->step, 7);
  EXPECT_EQ(job.finished_at, clock().Now());
  EXPECT_EQ(EventsOf(job.id).at(0).attempt, 1);
  EXPECT_EQ(Must(store().ListArtifacts(job.id)).size(), 1U);
  EXPECT_THAT(EndsOf(Must(store().ListAttempts(job.id))), ElementsAre("failed"));
}

// LIVE-3.41, store.h AddProducts: behind the end, all or nothing, and the end stays what it was.
TEST_P(StoreConformance, ProductsComeBehindTheEnd) {
  const LeasedJob leased = (Submit(), Acquire());
  const LateProducts products{
      .artifacts = {{.name = "report", .bytes = "{}"}, {.name = "picture.svg", .bytes = "<svg/>"}},
      .judgement = "why",
      .verdict = "BAD",
      .events = {{.kind = "products_made", .payload = "x"}}};
  EXPECT_EQ(CodeOf(store().AddProducts(leased.job.id, products)), ErrorCode::kCellPrecondition);
  EXPECT_EQ(CodeOf(store().AddProducts(999, products)), ErrorCode::kCellNotFound);
  Must(store().Finish(
      leased.lease,
      {.outcome = {.state = JobState::kFailed, .code = ErrorCode::kHoleRadiusZero, .step = 7},
       .artifacts = {{.name = "recording", .bytes = "r"}},
       .events = {{.kind = "ended", .payload = "x"}}}));
  const std::uint64_t before = store().JobChanges(leased.job.id);
  EXPECT_EQ(Must(store().AddProducts(leased.job.id, products)).last_sequence, 2);
  EXPECT_NE(store().JobChanges(leased.job.id), before);
  // Once: a second server that made them too changes nothing.
  EXPECT_EQ(CodeOf(store().AddProducts(leased.job.id,
                                       {.artifacts = {{.name = "steps", .bytes = "s"},
                                                      {.name = "report", .bytes = "other"}},
                                        .verdict = "GOOD"})),
            ErrorCode::kCellInvalidArgument);
  Reopen();
  const JobRecord job = Must(store().GetJob(leased.job.id));
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.outcome->code, ErrorCode::kHoleRadiusZero);
  EXPECT_EQ(job.outcome->step, 7);
  EXPECT_EQ(job.outcome->judgement, "why");
  EXPECT_EQ(job.outcome->verdict, "BAD");
  EXPECT_EQ(Must(store().ListArtifacts(job.id)).size(), 3U);
  EXPECT_EQ(Must(store().ReadArtifact(job.id, "report")), "{}");
  ASSERT_EQ(EventsOf(job.id).size(), 2U);
  EXPECT_EQ(EventsOf(job.id).at(1).kind, "products_made");
  // What they say is kept where none is known.
  Must(store().AddProducts(job.id, {.artifacts = {{.name = "steps", .bytes = "s"}}}));
  EXPECT_EQ(Must(store().GetJob(job.id)).outcome->verdict, "BAD");
}

TEST_P(StoreConformance, EveryFinalStateIsAnEnd) {
  const std::vector<std::pair<JobState, std::string>> ends = {
      {JobState::kSucceeded, "succeeded"},
      {JobState::kFailed, "failed"},
      {JobState::kCancelled, "cancelled"},
      {JobState::kInterrupted, "interrupted"}};
  for (const auto& [state, how] : ends) {
    const LeasedJob leased = (Submit(), Acquire());
    const JobRecord finished = Finish(leased.lease, state);
    EXPECT_EQ(finished.state, state);
    EXPECT_FALSE(finished.outcome->code);
    EXPECT_THAT(EndsOf(Must(store().ListAttempts(leased.job.id))), ElementsAre(how));
  }
}

// A whole cell at once: workers that die, hand back, are late and finish; every job ends once, and
// no more attempts count than its policy allows.
TEST_P(StoreConformance, ManyWorkersFinishEveryJobOnce) {
  constexpr int kJobs = 120;
  for (int i = 0; i < kJobs; ++i) Submit();
  std::mutex mutex;
  std::multiset<std::int64_t> ended;
  const auto note = [&](const JobRecord& job) {
    const std::lock_guard lock(mutex);
    if (IsFinal(job.state)) ended.insert(job.id);
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < 6; ++i) {
      workers.emplace_back([&, i] {
        std::mt19937 random(static_cast<unsigned>(i));
        for (;;) {
          const auto leased = store().Acquire("w", {"SIMULATE"}, kLease, {});
          if (!leased) return;
          if (!*leased) {
            const JobCounts counts = Must(store().CountJobs());
            if (counts.queued + counts.running == 0) return;
            for (const JobRecord& job : Must(store().Expire(PolicyOfTests()))) note(job);
            continue;
          }
          const Lease& lease = (*leased)->lease;
          static_cast<void>(store().AppendAndWait(lease, {{.kind = "e", .payload = ""}}));
          switch (random() % 5) {
            case 0:
              static_cast<void>(store().HandBack(lease, PolicyOfTests()));
              break;
            case 1:
              clock().Advance(2 * kLease);
              break;  // dead, and so are many others
            case 2:
              if (const auto lost = store().Abandon(lease, PolicyOfTests())) note(*lost);
              break;
            default:
              if (const auto job = store().Finish(lease, {})) note(*job);
          }
        }
      });
    }
  }
  EXPECT_EQ(ended.size(), static_cast<std::size_t>(kJobs));
  EXPECT_EQ(std::set<std::int64_t>(ended.begin(), ended.end()).size(), ended.size());
  for (const JobRecord& job : Must(store().ListJobs({.limit = 1000}))) {
    EXPECT_TRUE(IsFinal(job.state));
    EXPECT_LE(job.attempts, job.attempts_max);
    const auto events = EventsOf(job.id);
    ExpectWithoutGap(events);
    EXPECT_EQ(job.last_sequence, static_cast<std::int64_t>(events.size()));
  }
}

}  // namespace
}  // namespace rmlcell::storage
