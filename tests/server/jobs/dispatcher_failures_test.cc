// What the dispatcher does when the store refuses, when a worker is too late, and at the limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/names.h"
#include "server/jobs/dispatcher.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using storage::JobState;
using testing::ElementsAre;

// A simulation of a stored program, whose executable is worth keeping.
std::int64_t SubmitStored(storage::Store& store, int slot, const std::string& object) {
  v1::Job specification;
  specification.set_kind(v1::JOB_KIND_SIMULATE);
  specification.set_program("machines/optimo-1/programs/" + std::to_string(slot));
  return Must(store.SubmitAndWait({.machine = "optimo-1",
                                   .kind = "SIMULATE",
                                   .specification = specification.SerializeAsString(),
                                   .attempts_max = 2,
                                   .attachments = {{.name = "program", .bytes = object}}}))
      .job.id;
}

// scale-out.md IF-03: a store that is away for a moment does not throw a finished run away.
TEST(DispatcherFailures, AnEndThatTheStoreDoesNotTakeIsStoredALittleLater) {
  DispatcherBed bed;
  storage::Store& store = bed.server.store();
  Must(store.PutPrograms("optimo-1", {{.slot = 32, .object = "object"}}, {}));
  const std::int64_t job = SubmitStored(store, 32, "object");
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  worker.Artifact("report", "of the only attempt");
  bed.hooks.finishes_that_fail = 3;
  worker.Finish(v1::Outcome::KIND_COMPLETED, {{32, "executable"}});
  EXPECT_EQ(worker.Released(), true);
  EXPECT_EQ(bed.Job(job).state, JobState::kSucceeded);
  EXPECT_EQ(bed.Job(job).attempts, 1);
  EXPECT_EQ(Must(store.GetArtifact(job, "report")).size, 19);
  EXPECT_EQ(Must(store.GetProgram("optimo-1", 32)).executable, "executable");
}

// scale-out.md IF-03: nor do events, and all of them come in their order.
TEST(DispatcherFailures, EventsThatTheStoreDoesNotTakeAreStoredALittleLater) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.hooks.appends_that_fail = 3;
  worker.Events(2, "a");
  worker.Events(1, "b");
  while (worker.line().Next(v1::WorkResponse::kEventsStored).events_stored().count() < 3) {
  }
  EXPECT_EQ(bed.hooks.appends_that_fail, 0);
  // The end takes with it what is not stored yet.
  bed.hooks.appends_that_fail = 1'000'000;
  worker.Events(1, "c");
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
  std::vector<std::string> told;
  for (const v1::JobEvent& event : bed.Events(job)) {
    if (event.has_message()) told.push_back(event.message().text());
    if (event.has_ended()) told.emplace_back("end");
  }
  EXPECT_THAT(told, ElementsAre("a", "a", "b", "c", "end"));
  EXPECT_EQ(bed.Job(job).attempts, 1);
}

// When the lease cannot be ours any more the attempt is lost, with what the worker told of it.
TEST(DispatcherFailures, EventsThatAreNotTakenInTheTimeOfALeaseAreAnAttemptThatWasLost) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.hooks.appends_that_fail = 1'000'000;
  worker.Events(1, "a");
  bed.Settle();
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kRelease));
  bed.Advance(milliseconds(bed.config.workers_lease_ms));
  EXPECT_EQ(worker.Released(), false);
  bed.hooks.appends_that_fail = 0;
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.assignment().lease().attempt(), 2);
  worker.Finish();
  EXPECT_TRUE(bed.Becomes(job, JobState::kSucceeded));
}

std::vector<std::string> Told(DispatcherBed& bed, std::int64_t job) {
  std::vector<std::string> told;
  for (const v1::JobEvent& event : bed.Events(job))
    if (event.has_message()) told.push_back(event.message().text());
  return told;
}

// scale-out.md IF-03: what a worker told is not lost with it, whether it dies or gives back.
TEST(DispatcherFailures, WhatAWorkerToldOutlivesItThoughTheStoreIsAway) {
  for (const bool gives_back : {false, true}) {
    DispatcherBed bed;
    const std::int64_t job = bed.server.SubmitCheck();
    FakeWorker worker(bed.dispatcher(), "w");
    ASSERT_TRUE(worker.Take());
    bed.hooks.appends_that_fail = 1'000'000;
    bed.hooks.losses_that_fail = 3;
    worker.Events(2, "a");
    if (gives_back) {
      worker.HandBack();
    } else {
      worker.Leave();
    }
    EXPECT_TRUE(bed.Becomes(job, JobState::kQueued));
    EXPECT_EQ(bed.hooks.losses_that_fail, 0);
    if (gives_back) {
      EXPECT_THAT(Told(bed, job), ElementsAre("a", "a"));
    } else {
      EXPECT_THAT(Told(bed, job), ElementsAre("a", "a", "the worker of attempt 1 died"));
    }
  }
}

// An end that is not taken in the time of a lease leaves what was told of the attempt.
TEST(DispatcherFailures, WhatWasToldStaysWhenTheEndIsLost) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.hooks.appends_that_fail = 1'000'000;
  bed.hooks.finishes_that_fail = 1'000'000;
  worker.Events(1, "a");
  worker.Finish();
  bed.Settle();
  // No look at leases comes before that and takes the job: in the store the lease has time left.
  bed.AdvanceDispatcher(milliseconds(bed.config.workers_lease_ms));
  EXPECT_EQ(worker.Released(), false);
  EXPECT_THAT(Told(bed, job), ElementsAre("a", "the worker of attempt 1 died"));
}

// A lease that could not be renewed is not ours for longer than it was given, however often its
// worker says that it lives.
TEST(DispatcherFailures, EventsOfALeaseThatCannotBeRenewedAreNotTriedForEver) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 900;
  bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.hooks.appends_that_fail = 1'000'000;
  bed.hooks.renewals_that_fail = 1'000'000;
  bed.hooks.losses_that_fail = 1'000'000;
  worker.Events(1, "a");
  for (int i = 0; i < 3; ++i) {
    bed.Settle();
    EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kRelease)) << i;
    bed.Advance(milliseconds(300));
    worker.Heartbeat();
  }
  EXPECT_EQ(worker.Released(), false);
}

// What throws in the middle of a worker's work ends with that worker, not with the server.
TEST(DispatcherFailures, AWorkerWhoseWorkThrowsIsSentAway) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.hooks.finishes_that_throw = 1;
  worker.Finish();
  bed.Settle();
  EXPECT_TRUE(worker.line().closed);
  worker.Leave();
  EXPECT_TRUE(bed.Becomes(job, JobState::kQueued));
  FakeWorker another(bed.dispatcher(), "another");
  ASSERT_TRUE(another.Take());
  another.Finish();
  EXPECT_EQ(another.Released(), true);
}

// scale-out.md IF-01: a store that is away holds up no thread of the server, however many workers
// wait for it.
TEST(DispatcherFailures, AStoreThatDoesNotAnswerHoldsUpNoThread) {
  DispatcherBed bed;
  std::vector<std::unique_ptr<FakeWorker>> workers;
  std::vector<std::int64_t> jobs;
  constexpr int kWorkers = 10;  // more than the executor has threads
  for (int i = 0; i < kWorkers; ++i) {
    jobs.push_back(bed.server.SubmitCheck());
    workers.push_back(std::make_unique<FakeWorker>(bed.dispatcher(), "w" + std::to_string(i)));
    ASSERT_TRUE(workers.back()->Take());
  }
  bed.hooks.keeps_ends = true;
  for (const auto& worker : workers) worker->Finish();
  ASSERT_TRUE(Eventually([&] { return bed.hooks.ends_kept == kWorkers; }));
  const std::int64_t another = bed.server.SubmitCheck();
  FakeWorker free_one(bed.dispatcher(), "free");
  ASSERT_TRUE(free_one.Take());
  EXPECT_EQ(free_one.job(), another);
  bed.hooks.Answer();
  for (const auto& worker : workers) EXPECT_EQ(worker->Released(), true);
  for (const std::int64_t job : jobs) EXPECT_EQ(bed.Job(job).state, JobState::kSucceeded);
  free_one.Finish();
  EXPECT_EQ(free_one.Released(), true);
}

// A worker that is gone when its end is stored is given a job that it never sees: another one gets
// it, and no attempt counts.
TEST(DispatcherFailures, TheNextJobOfAWorkerThatIsGoneGoesToAnother) {
  DispatcherBed bed;
  const std::int64_t first = bed.server.SubmitCheck();
  const std::int64_t next = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.hooks.keeps_ends = true;
  worker.Finish();
  ASSERT_TRUE(Eventually([&] { return bed.hooks.ends_kept == 1; }));
  worker.Leave();
  bed.hooks.Answer();
  bed.Settle();
  EXPECT_EQ(bed.Job(first).state, JobState::kSucceeded);
  EXPECT_EQ(bed.hooks.next_given, 1);
  FakeWorker other(bed.dispatcher(), "other");
  ASSERT_TRUE(other.Take());
  EXPECT_EQ(other.job(), next);
  other.Finish();
  EXPECT_EQ(other.Released(), true);
  EXPECT_EQ(bed.Job(next).state, JobState::kSucceeded);
}

// One that is told to stop takes no further job.
TEST(DispatcherFailures, AServerThatStopsGivesNoNextJob) {
  DispatcherBed bed;
  bed.server.SubmitCheck();
  const std::int64_t next = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.Settle();  // it was told of the job before it is told to stop, and the dispatcher knows
  std::jthread drain([&] { bed.dispatcher().Drain(kPatience); });
  worker.line().Next(v1::WorkResponse::kStop);
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
  drain.join();
  EXPECT_EQ(bed.hooks.next_given, 0);
  EXPECT_EQ(bed.Job(next).state, JobState::kQueued);
}

// Also when its worker is gone meanwhile.
TEST(DispatcherFailures, AnEndIsStoredThoughItsWorkerIsGone) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.hooks.finishes_that_fail = 1'000'000;
  worker.Finish();
  bed.Settle();
  worker.Leave();
  bed.Settle();
  EXPECT_EQ(bed.Job(job).state, JobState::kRunning);
  bed.hooks.finishes_that_fail = 0;
  EXPECT_TRUE(bed.Becomes(job, JobState::kSucceeded));
}

// design.md section 3: a full disk must not leave the job without an owner. While the lease may be
// held the end is tried again; then the attempt is lost, and the worker is free.
TEST(DispatcherFailures, AnEndThatIsNotTakenInTheTimeOfALeaseIsAnAttemptThatWasLost) {
  for (const int attempts : {1, 2}) {
    DispatcherBed bed;
    const std::int64_t job = bed.server.SubmitCheck("STOP\n", attempts);
    FakeWorker worker(bed.dispatcher(), "w");
    ASSERT_TRUE(worker.Take());
    worker.Artifact("report", "of the first attempt");
    bed.hooks.finishes_that_fail = 1'000'000;
    worker.Finish();
    bed.Settle();
    EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kRelease));
    bed.Advance(milliseconds(bed.config.workers_lease_ms));
    EXPECT_EQ(worker.Released(), false);
    bed.hooks.finishes_that_fail = 0;
    EXPECT_EQ(CodeOf(bed.server.store().GetArtifact(job, "report")), ErrorCode::kCellNotFound);
    if (attempts == 1) {
      EXPECT_EQ(bed.Job(job).state, JobState::kFailed);
      EXPECT_EQ(bed.Job(job).outcome->code, ErrorCode::kCellWorkerDied);
      EXPECT_TRUE(bed.Events(job).back().has_ended());
      continue;
    }
    ASSERT_TRUE(worker.Take());
    EXPECT_EQ(worker.assignment().lease().attempt(), 2);
    worker.Finish();
    EXPECT_EQ(worker.Released(), true);
    EXPECT_EQ(bed.Job(job).attempts, 2);
  }
}

// A job that nobody can work on is no trouble of the store.
TEST(DispatcherFailures, AJobThatCannotBeWorkedOnFails) {
  DispatcherBed bed;
  const std::int64_t broken =
      Must(bed.server.store().SubmitAndWait({.machine = "optimo-1",
                                             .kind = "CHECK",
                                             .specification = "\xFF\xFF no message",
                                             .attempts_max = 2}))
          .job.id;
  bed.hooks.finishes_that_fail = 1;
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(bed.Becomes(broken, JobState::kFailed));
  EXPECT_EQ(bed.Job(broken).outcome->code, ErrorCode::kCellStoreCorrupt);
  EXPECT_EQ(bed.Job(broken).attempts, 1);
  EXPECT_FALSE(worker.HasJob());
}

// scale-out.md IF-04: the store could not give the programs; the job is as good as before.
TEST(DispatcherFailures, AJobWhoseProgramsCannotBeReadGoesBack) {
  DispatcherBed bed;
  bed.hooks.machines_that_fail = 2;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(bed.hooks.machines_that_fail, 0);
  EXPECT_EQ(worker.job(), job);
  EXPECT_EQ(bed.Job(job).attempts, 1);  // those before do not count
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
  EXPECT_EQ(bed.Job(job).state, JobState::kSucceeded);
}

TEST(DispatcherFailures, AWorkerIsGivenAJobWhenAFailingStoreWorksAgain) {
  DispatcherBed bed;
  bed.hooks.acquires_that_fail = 1;
  FakeWorker worker(bed.dispatcher(), "w");
  bed.Settle();
  EXPECT_EQ(bed.hooks.acquires_that_fail, 0);
  const std::int64_t job = bed.server.SubmitCheck();
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), job);
}

// A renewal that fails for another reason than a lost lease leaves the worker at its job.
TEST(DispatcherFailures, ARenewalThatFailsIsTriedAgainAThirdOfTheLeaseLater) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 900;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  const auto heartbeat_after = [&](milliseconds time) {
    bed.Advance(time);
    worker.Heartbeat();
    bed.Settle();
  };
  bed.hooks.renewals_that_fail = 1;
  heartbeat_after(milliseconds(300));
  EXPECT_EQ(bed.hooks.renewals, 1);
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kRelease));
  heartbeat_after(milliseconds(299));
  EXPECT_EQ(bed.hooks.renewals, 1);
  heartbeat_after(milliseconds(1));
  EXPECT_EQ(bed.hooks.renewals, 2);
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kControl));
  bed.Advance(milliseconds(899));  // it was renewed for a whole lease
  ASSERT_TRUE(bed.Swept());
  EXPECT_EQ(bed.Job(job).state, JobState::kRunning);
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
}

// Another server on the same store was asked to cancel: the renewal brings it.
TEST(DispatcherFailures, ACancelThatAnotherServerTookComesWithARenewal) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 900;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  Must(bed.server.store().RequestCancel(job, {}));
  worker.Heartbeat();
  bed.Settle();
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kControl));
  bed.Advance(milliseconds(300));
  worker.Heartbeat();
  const v1::WorkerControl order = worker.Ordered();
  EXPECT_EQ(order.kind(), v1::WorkerControl::KIND_CANCEL);
  EXPECT_EQ(order.lease().job(), job);
  EXPECT_EQ(order.lease().attempt(), 1);
  EXPECT_EQ(order.lease().fence(), worker.assignment().lease().fence());
}

// storage/store.h RequestCancel: waiting jobs end, running ones are marked, ended ones stay.
TEST(DispatcherCancel, InEachState) {
  DispatcherBed bed;
  const auto cancel = [&](std::int64_t job) {
    return Must(bed.dispatcher().Cancel(job, "anna")).state;
  };
  FakeWorker worker(bed.dispatcher(), "w");
  const std::vector<std::pair<v1::Outcome::Kind, JobState>> ends = {
      {v1::Outcome::KIND_COMPLETED, JobState::kSucceeded},
      {v1::Outcome::KIND_STOPPED, JobState::kFailed},
      {v1::Outcome::KIND_FAILED, JobState::kFailed},
      {v1::Outcome::KIND_BUDGET_EXCEEDED, JobState::kFailed},
      {v1::Outcome::KIND_CANCELLED, JobState::kCancelled}};
  for (const auto& [kind, state] : ends) {
    const std::int64_t job = bed.server.SubmitCheck();
    ASSERT_TRUE(worker.Take());
    worker.Finish(kind);
    ASSERT_EQ(worker.Released(), true);
    const std::size_t events = bed.Events(job).size();
    EXPECT_EQ(cancel(job), state);
    EXPECT_EQ(bed.Job(job).cancel_requested, false);
    EXPECT_EQ(bed.Events(job).size(), events);
  }
  bed.Settle();
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kControl));  // nobody is told of these

  const std::int64_t running = bed.server.SubmitCheck();
  ASSERT_TRUE(worker.Take());
  const std::int64_t queued = bed.server.SubmitCheck();
  EXPECT_EQ(cancel(queued), JobState::kCancelled);
  EXPECT_EQ(bed.Job(queued).outcome->code, ErrorCode::kCellCancelled);
  EXPECT_EQ(bed.Events(queued).back().ended().kind(), v1::Outcome::KIND_CANCELLED);
  EXPECT_EQ(cancel(running), JobState::kRunning);
  EXPECT_TRUE(bed.Job(running).cancel_requested);
  EXPECT_FALSE(bed.Events(running).back().has_ended());
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_CANCEL);
  EXPECT_EQ(cancel(running), JobState::kRunning);  // once more, if the first was lost on its way
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_CANCEL);
  // A worker that had done its work before it heard of the order: what it did counts.
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
  EXPECT_EQ(bed.Job(running).state, JobState::kSucceeded);
}

// A job has so many attempts as it was given, and not one more.
TEST(DispatcherLoss, AJobHasSoManyAttemptsAndNoMore) {
  for (const int attempts : {1, 2, 3}) {
    DispatcherBed bed;
    bed.config.workers_lease_ms = 300;
    const std::int64_t job = bed.server.SubmitCheck("STOP\n", attempts);
    for (int attempt = 1; attempt <= attempts; ++attempt) {
      FakeWorker worker(bed.dispatcher(), "w");
      ASSERT_TRUE(worker.Take());
      EXPECT_EQ(worker.assignment().lease().attempt(), attempt);
      // By turns the line breaks and the lease runs out.
      if (attempt % 2 == 0) {
        worker.BeginAndLeave();
      } else {
        bed.Advance(milliseconds(300));
      }
      const JobState after = attempt < attempts ? JobState::kQueued : JobState::kFailed;
      ASSERT_TRUE(bed.Becomes(job, after)) << attempt << " of " << attempts;
      worker.Leave();
      bed.Settle();
    }
    EXPECT_EQ(bed.Job(job).attempts, attempts);
    EXPECT_EQ(bed.Job(job).outcome->code, ErrorCode::kCellWorkerDied);
    std::vector<std::string> told;
    for (const v1::JobEvent& event : bed.Events(job)) {
      if (event.has_message()) told.push_back(event.message().text());
    }
    EXPECT_EQ(told.size(), static_cast<std::size_t>(attempts));
    EXPECT_EQ(told.front(), "the lease of its worker ran out");
    if (attempts > 1) {
      EXPECT_EQ(told[1], "the worker of attempt 2 died");
    }
  }
}

// Events say that a lost job waits again, before its next attempt.
TEST(DispatcherLoss, IsToldInTheLogOfTheJob) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 2);
  FakeWorker first(bed.dispatcher(), "first");
  ASSERT_TRUE(first.Take());
  first.BeginAndLeave();
  FakeWorker second(bed.dispatcher(), "second");
  ASSERT_TRUE(second.Take());
  second.Finish();
  ASSERT_EQ(second.Released(), true);
  std::vector<std::string> kinds;
  for (const auto& event : Must(bed.server.store().JobEvents(job, 0, 100))) {
    kinds.push_back(event.kind);
  }
  EXPECT_THAT(kinds, ElementsAre("state", "state", "message", "state", "state", "ended"));
  const std::vector<v1::JobEvent> events = bed.Events(job);
  EXPECT_EQ(events[1].state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(events[1].attempt(), 1);
  EXPECT_EQ(events[3].state(), v1::Job::STATE_QUEUED);
  EXPECT_EQ(events[4].state(), v1::Job::STATE_RUNNING);
  EXPECT_EQ(events[4].attempt(), 2);
}

// OPT-1.12: an executable belongs to one revision of its object; one of a program that was deleted,
// or deleted and stored anew, is not kept.
TEST(DispatcherFinish, DropsExecutablesOfObjectsThatAreGone) {
  DispatcherBed bed;
  storage::Store& store = bed.server.store();
  for (const int slot : {32, 44, 45}) {
    Must(store.PutPrograms("optimo-1", {{.slot = slot, .object = "object"}}, {}));
  }
  SubmitStored(store, 32, "object");
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  Must(store.DeleteProgram("optimo-1", 44, storage::kAnyRevision));
  Must(store.DeleteProgram("optimo-1", 45, storage::kAnyRevision));
  Must(store.PutPrograms("optimo-1", {{.slot = 45, .object = "object"}}, {}));
  worker.Finish(v1::Outcome::KIND_COMPLETED,
                {{32, "executable 32"}, {44, "executable 44"}, {45, "executable 45"}});
  ASSERT_EQ(worker.Released(), true);
  bed.Settle();
  EXPECT_EQ(Must(store.GetProgram("optimo-1", 32)).executable, "executable 32");
  EXPECT_EQ(CodeOf(store.GetProgram("optimo-1", 44)), ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(store.GetProgram("optimo-1", 45)).executable, std::nullopt);
}

// Of a worker that lost its lease nothing is kept, its executables neither.
TEST(DispatcherFinish, DropsExecutablesOfAStaleWorker) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 300;
  storage::Store& store = bed.server.store();
  Must(store.PutPrograms("optimo-1", {{.slot = 32, .object = "object"}}, {}));
  const std::int64_t job = SubmitStored(store, 32, "object");
  FakeWorker stale(bed.dispatcher(), "stale");
  ASSERT_TRUE(stale.Take());
  FakeWorker second(bed.dispatcher(), "second");
  bed.Advance(milliseconds(300));
  ASSERT_TRUE(second.Take());
  stale.Finish(v1::Outcome::KIND_COMPLETED, {{32, "stale"}});
  EXPECT_EQ(stale.Released(), false);
  bed.Settle();
  EXPECT_EQ(Must(store.GetProgram("optimo-1", 32)).executable, std::nullopt);
  EXPECT_EQ(bed.Job(job).state, JobState::kRunning);
  EXPECT_EQ(bed.Job(job).attempts, 2);  // the other's was not taken from it
}

// limits.output_bytes, and one megabyte more until the worker has noticed: on both sides.
TEST(DispatcherBudget, CountsNamesAndBytesUpToItsLimit) {
  constexpr std::int64_t kSlack = 1 << 20;
  for (const std::int64_t over : {0, 1}) {
    DispatcherBed bed;
    bed.config.limit_output_bytes = 1000;
    const std::int64_t job = bed.server.SubmitCheck();
    FakeWorker worker(bed.dispatcher(), "w");
    ASSERT_TRUE(worker.Take());
    const auto record = static_cast<std::int64_t>(sizeof(storage::NewArtifact)) + 6;  // "report"
    const std::int64_t room = 1000 + kSlack - record;
    worker.Artifact("report", std::string(100, 'a'));
    worker.Artifact("report", std::string(static_cast<std::size_t>(room - 100 + over), 'b'));
    worker.Finish();
    EXPECT_EQ(worker.Released(), true);
    EXPECT_EQ(bed.Job(job).state, over == 0 ? JobState::kSucceeded : JobState::kFailed);
    if (over == 0) {
      EXPECT_EQ(Must(bed.server.store().GetArtifact(job, "report")).size, room);
    } else {
      EXPECT_EQ(bed.Job(job).outcome->code, ErrorCode::kCellOutputBudget);
      EXPECT_EQ(bed.Events(job).back().ended().kind(), v1::Outcome::KIND_BUDGET_EXCEEDED);
    }
  }
}

// The window that a worker is told: events that it may send before the first of them is durable.
TEST(DispatcherJoin, TellsTheWindowOfEvents) {
  DispatcherBed bed;
  FakeWorker worker(bed.dispatcher(), "w");
  EXPECT_EQ(worker.line().Next(v1::WorkResponse::kWelcome).welcome().events_window(), 256);
}

// A worker says what it can do; what it does not say it is not given.
TEST(DispatcherJoin, AWorkerForChecksIsGivenChecks) {
  DispatcherBed bed;
  storage::Store& store = bed.server.store();
  Must(store.PutPrograms("optimo-1", {{.slot = 32, .object = "object"}}, {}));
  SubmitStored(store, 32, "object");
  const std::int64_t check = bed.server.SubmitCheck();
  v1::WorkerHello hello = Hello("checker");
  hello.clear_kinds();
  hello.add_kinds(v1::JOB_KIND_CHECK);
  hello.add_kinds(v1::JOB_KIND_RUN);  // nobody runs those yet
  FakeWorker checker(bed.dispatcher(), hello);
  ASSERT_TRUE(checker.Take());
  EXPECT_EQ(checker.job(), check);
}

TEST(DispatcherProgress, ANewAttemptBeginsWithoutAPosition) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  worker.Position(7);
  ASSERT_TRUE(Eventually([&] { return bed.feed().LatestAfter(JobName(job), 0).has_value(); }));
  worker.Leave();
  ASSERT_TRUE(bed.Becomes(job, JobState::kQueued));
  bed.Settle();
  EXPECT_FALSE(bed.feed().LatestAfter(JobName(job), 0));
}

}  // namespace
}  // namespace rmlcell::server
