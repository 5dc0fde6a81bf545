// Submitting, finding, listing and cancelling jobs with any Store.
#include <gmock/gmock.h>

#include <condition_variable>
#include <future>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "tests/storage/store_conformance.h"

namespace rmlcell::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// design.md section 3, step 2: what was submitted is there, also after a restart.
TEST_P(StoreConformance, JobComesBackAsItWasSubmitted) {
  const NewJob job{.request_id = "r-1",
                   .request_hash = "h",
                   .machine = "optimo-1",
                   .kind = "SIMULATE",
                   .title = "left bracket",
                   .caller = "anna",
                   .specification = Noise(500, 4),
                   .attempts_max = 3,
                   .events = {{.kind = "state", .payload = Noise(40, 5)}}};
  const SubmittedJob submitted = Must(store().SubmitAndWait(job));
  EXPECT_FALSE(submitted.already_there);
  EXPECT_EQ(submitted.job.specification, job.specification);
  Reopen();
  const JobRecord got = Must(store().GetJob(submitted.job.id));
  EXPECT_EQ(got.request_id, "r-1");
  EXPECT_EQ(got.request_hash, "h");
  EXPECT_EQ(got.machine, "optimo-1");
  EXPECT_EQ(got.kind, "SIMULATE");
  EXPECT_EQ(got.title, "left bracket");
  EXPECT_EQ(got.caller, "anna");
  EXPECT_EQ(got.specification, job.specification);
  EXPECT_EQ(got.state, JobState::kQueued);
  EXPECT_FALSE(got.cancel_requested);
  EXPECT_EQ(got.attempts, 0);
  EXPECT_EQ(got.attempts_max, 3);
  EXPECT_FALSE(got.outcome);
  EXPECT_EQ(got.last_sequence, 1);
  EXPECT_EQ(got.events_gone_until, 0);
  EXPECT_EQ(got.created_at, clock().Now());
  EXPECT_FALSE(got.started_at);
  EXPECT_FALSE(got.finished_at);
  const auto events = EventsOf(got.id);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, "state");
  EXPECT_EQ(events[0].payload, job.events[0].payload);
  EXPECT_EQ(events[0].attempt, 0);
}

TEST_P(StoreConformance, LargeSpecificationComesBack) {
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{16'384}, std::size_t{16'385}, std::size_t{3} << 20}) {
    const std::string specification = Noise(size, size);
    const JobRecord job =
        Must(store().SubmitAndWait({.kind = "CHECK", .specification = specification})).job;
    EXPECT_TRUE(job.specification == specification) << size;
    EXPECT_TRUE(Must(store().GetJob(job.id)).specification == specification) << size;
  }
}

// records.h: ids count up in the order of submission, and go on after a restart.
TEST_P(StoreConformance, JobIdsCountUp) {
  const std::int64_t first = Submit().id;
  EXPECT_EQ(Submit().id, first + 1);
  Reopen();
  EXPECT_EQ(Submit().id, first + 2);
}

// store.h: the store makes request ids that differ.
TEST_P(StoreConformance, RequestIdIsMadeWhenNoneIsGiven) {
  std::set<std::string> ids;
  for (int i = 0; i < 100; ++i) ids.insert(Submit().request_id);
  EXPECT_EQ(ids.size(), 100U);
  EXPECT_FALSE(ids.contains(""));
}

// AIP-155, store.h Submit: the same request again gives the first job, as it is by now, and adds
// nothing.
TEST_P(StoreConformance, RepeatedRequestGivesTheFirstJob) {
  const NewJob job{.request_id = "again",
                   .request_hash = "h",
                   .kind = "SIMULATE",
                   .specification = "spec",
                   .events = {{.kind = "state", .payload = ""}}};
  const SubmittedJob first = Must(store().SubmitAndWait(job));
  Reopen();
  const LeasedJob leased = Acquire();
  const SubmittedJob second = Must(store().SubmitAndWait(job));
  EXPECT_TRUE(second.already_there);
  EXPECT_EQ(second.job.id, first.job.id);
  EXPECT_EQ(second.job.state, JobState::kRunning);
  EXPECT_EQ(second.job.specification, "spec");
  EXPECT_EQ(leased.job.id, first.job.id);
  EXPECT_EQ(EventsOf(first.job.id).size(), 1U);
  EXPECT_THAT(IdsOf(Must(store().ListJobs({}))), ElementsAre(first.job.id));
}

// store.h NewJob::queued_max: jobs that run do not count, a repeated request is no new job, and
// those submitted in one commit are counted one by one.
TEST_P(StoreConformance, SoManyJobsMayWait) {
  const auto job = [](const std::string& id) {
    return NewJob{.request_id = id, .kind = "SIMULATE", .queued_max = 2};
  };
  const SubmittedJob first = Must(store().SubmitAndWait(job("a")));
  std::vector<std::promise<Result<SubmittedJob>>> answers(5);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    store().Submit(job("b" + std::to_string(i)), [&answers, i](Result<SubmittedJob> made) {
      answers[i].set_value(std::move(made));
    });
  }
  int taken = 0;
  for (auto& answer : answers) {
    const Result<SubmittedJob> made = answer.get_future().get();
    taken += made ? 1 : 0;
    if (!made) {
      EXPECT_EQ(made.error().code, ErrorCode::kCellResourceExhausted);
    }
  }
  EXPECT_EQ(taken, 1);
  EXPECT_EQ(Must(store().SubmitAndWait(job("a"))).job.id, first.job.id);
  Acquire();
  EXPECT_TRUE(store().SubmitAndWait(job("c")));
  EXPECT_EQ(CodeOf(store().SubmitAndWait(job("d"))), ErrorCode::kCellResourceExhausted);
  EXPECT_EQ(Must(store().CountJobs()).queued, 2);
}

// store.h Submit: a request id that is used for something else is refused.
TEST_P(StoreConformance, RequestIdOfAnotherRequestIsRefused) {
  Must(store().SubmitAndWait({.request_id = "r", .request_hash = "one"}));
  EXPECT_EQ(CodeOf(store().SubmitAndWait({.request_id = "r", .request_hash = "two"})),
            ErrorCode::kCellRequestIdReused);
  EXPECT_EQ(Must(store().ListJobs({})).size(), 1U);
}

// Issue 2, tests: also when 64 callers repeat the same requests at the same time there is one job
// of each.
TEST_P(StoreConformance, ManyThreadsRepeatTheSameRequests) {
  constexpr int kThreads = 64;
  constexpr int kRequests = 20;
  std::mutex mutex;
  std::map<std::string, std::set<std::int64_t>> ids;
  std::map<std::string, int> made;
  int failures = 0;
  {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < kThreads; ++thread) {
      threads.emplace_back([&, thread] {
        for (int i = 0; i < kRequests; ++i) {
          const std::string request = Numbered("r", (i + thread) % kRequests);
          const auto submitted =
              store().SubmitAndWait({.request_id = request, .request_hash = "h", .kind = "CHECK"});
          const std::lock_guard lock(mutex);
          if (!submitted) {
            ++failures;
            continue;
          }
          ids[request].insert(submitted->job.id);
          if (!submitted->already_there) ++made[request];
        }
      });
    }
  }
  EXPECT_EQ(failures, 0);
  EXPECT_EQ(ids.size(), static_cast<std::size_t>(kRequests));
  for (const auto& [request, jobs] : ids) {
    EXPECT_EQ(jobs.size(), 1U) << request;
    EXPECT_EQ(made[request], 1) << request;
  }
  EXPECT_EQ(Must(store().ListJobs({.limit = 1000})).size(), static_cast<std::size_t>(kRequests));
}

TEST_P(StoreConformance, SubmissionsThatCannotBeAreRefused) {
  EXPECT_EQ(CodeOf(store().SubmitAndWait({.kind = "CHECK", .attempts_max = 0})),
            ErrorCode::kCellInvalidArgument);
  const std::string largest(kEventPayloadBytesMax, 'x');
  EXPECT_EQ(CodeOf(store().SubmitAndWait(
                {.kind = "CHECK", .events = {{.kind = "k", .payload = largest + "x"}}})),
            ErrorCode::kCellTooLarge);
  EXPECT_THAT(Must(store().ListJobs({})), IsEmpty());
  EXPECT_EQ(CodeOf(store().SubmitAndWait(
                {.kind = "CHECK", .events = {{.kind = "k", .payload = largest}}})),
            std::nullopt);
}

// store.h Submit: `done` is called once, and one that fails does not touch those around it.
TEST_P(StoreConformance, SubmissionsAreAnsweredOneByOne) {
  constexpr int kJobs = 300;
  std::mutex mutex;
  std::condition_variable answered;
  std::vector<int> answers(kJobs, 0);
  int good = 0;
  int all = 0;
  for (int i = 0; i < kJobs; ++i) {
    // Every third fails after its job was written: the second artifact has the name of the first.
    NewJob job{.kind = "CHECK", .attachments = {{.name = "a"}, {.name = i % 3 == 0 ? "a" : "b"}}};
    store().Submit(std::move(job), [&, i](const Result<SubmittedJob>& submitted) {
      const std::lock_guard lock(mutex);
      ++answers[static_cast<std::size_t>(i)];
      if (submitted) ++good;
      EXPECT_EQ(submitted.has_value(), i % 3 != 0);
      ++all;
      answered.notify_one();
    });
  }
  std::unique_lock lock(mutex);
  answered.wait(lock, [&] { return all == kJobs; });
  EXPECT_EQ(answers, std::vector<int>(kJobs, 1));
  EXPECT_EQ(Must(store().ListJobs({.limit = 1000})).size(), static_cast<std::size_t>(good));
  // Without a gap, also where one failed between two.
  EXPECT_EQ(Must(store().ListJobs({.limit = 1})).front().id -
                Must(store().ListJobs({.limit = 1000})).back().id + 1,
            good);
}

// store.h Submit: the answer may call the store, also in ways that wait.
TEST_P(StoreConformance, AnswerMayCallTheStore) {
  std::promise<std::string> told;
  store().Submit({.kind = "CHECK"}, [&](const Result<SubmittedJob>& first) {
    if (!first) return told.set_value("first");
    if (!store().GetJob(first->job.id)) return told.set_value("get");
    if (!store().SubmitAndWait({.kind = "CHECK"})) return told.set_value("second");
    const auto leased = store().Acquire("w", {"CHECK"}, kLease, {});
    if (!leased || !*leased) return told.set_value("acquire");
    store().Append((*leased)->lease, {{.kind = "e", .payload = ""}},
                   [&](const Result<std::int64_t>& appended) {
                     told.set_value(appended ? "good" : "append");
                   });
  });
  EXPECT_EQ(told.get_future().get(), "good");
}

TEST_P(StoreConformance, UnknownJobIsNotFound) {
  constexpr auto kNotFound = ErrorCode::kCellNotFound;
  EXPECT_EQ(CodeOf(store().GetJob(1)), kNotFound);
  EXPECT_EQ(CodeOf(store().RequestCancel(1, {})), kNotFound);
  EXPECT_EQ(CodeOf(store().ListAttempts(1)), kNotFound);
  EXPECT_EQ(CodeOf(store().ListArtifacts(1)), kNotFound);
  EXPECT_EQ(CodeOf(store().GetArtifact(1, "report")), kNotFound);
  EXPECT_EQ(CodeOf(store().JobEvents(1, 0, 10)), kNotFound);
}

// store.h RequestCancel, queued: ended at once, with the code of a cancelled job and the events
// given.
TEST_P(StoreConformance, QueuedJobIsCancelledAtOnce) {
  const JobRecord job = Submit();
  clock().Advance(std::chrono::seconds(3));
  const JobRecord cancelled =
      Must(store().RequestCancel(job.id, {{.kind = "ended", .payload = "c"}}));
  EXPECT_EQ(cancelled.state, JobState::kCancelled);
  EXPECT_TRUE(cancelled.cancel_requested);
  ASSERT_TRUE(cancelled.outcome);
  EXPECT_EQ(cancelled.outcome->state, JobState::kCancelled);
  EXPECT_EQ(cancelled.outcome->code, ErrorCode::kCellCancelled);
  EXPECT_EQ(cancelled.finished_at, clock().Now());
  EXPECT_EQ(cancelled.last_sequence, 1);
  EXPECT_THAT(KindsOf(EventsOf(job.id)), ElementsAre("ended"));
  EXPECT_FALSE(Must(store().Acquire("w", {"SIMULATE"}, kLease, {})));
  EXPECT_EQ(Must(store().GetJob(job.id)).state, JobState::kCancelled);
}

// store.h RequestCancel, running: marked only, and seen by the holder; final: unchanged.
TEST_P(StoreConformance, RunningJobIsMarkedAndItsHolderEndsIt) {
  const LeasedJob leased = (Submit(), Acquire());
  const std::vector<NewEvent> events = {{.kind = "ended", .payload = ""}};
  EXPECT_FALSE(Must(store().Renew(leased.lease, kLease)).cancel_requested);
  EXPECT_EQ(Must(store().RequestCancel(leased.job.id, events)).state, JobState::kRunning);
  EXPECT_TRUE(Must(store().RequestCancel(leased.job.id, events)).cancel_requested);
  EXPECT_TRUE(Must(store().Renew(leased.lease, kLease)).cancel_requested);
  EXPECT_THAT(EventsOf(leased.job.id), IsEmpty());
  Finish(leased.lease, JobState::kCancelled);
  const JobRecord after = Must(store().RequestCancel(leased.job.id, events));
  EXPECT_EQ(after.state, JobState::kCancelled);
  EXPECT_EQ(after.last_sequence, 0);
}

// store.h RequestCancel, final: nothing of it changes, and nothing is told.
TEST_P(StoreConformance, AnEndedJobStaysAsItIs) {
  const LeasedJob leased = (Submit(), Acquire());
  const JobRecord ended = Finish(leased.lease);
  const std::uint64_t before = store().JobChanges(ended.id);
  clock().Advance(std::chrono::seconds(1));
  const JobRecord late = Must(store().RequestCancel(ended.id, {{.kind = "ended", .payload = ""}}));
  for (const JobRecord& job : {late, Must(store().GetJob(ended.id))}) {
    EXPECT_EQ(job.state, JobState::kSucceeded);
    EXPECT_FALSE(job.cancel_requested);
    EXPECT_EQ(job.finished_at, ended.finished_at);
    EXPECT_EQ(job.last_sequence, 0);
  }
  EXPECT_EQ(store().JobChanges(ended.id), before);
}

// store.h FindSubmitted: the job of a request, nothing where there was none, and a refusal where it
// was another one.
TEST_P(StoreConformance, ARequestIsLookedUp) {
  const JobRecord job =
      Must(store().SubmitAndWait({.request_id = "r", .request_hash = "h", .kind = "CHECK"})).job;
  EXPECT_EQ(Must(store().FindSubmitted("r", "h"))->id, job.id);
  EXPECT_FALSE(Must(store().FindSubmitted("s", "h")));
  EXPECT_EQ(CodeOf(store().FindSubmitted("r", "i")), ErrorCode::kCellRequestIdReused);
}

// A cancel and a lease at the same time: the job is cancelled in the queue, or it is leased and
// marked.
TEST_P(StoreConformance, CancelRacesWithLease) {
  for (int round = 0; round < 50; ++round) {
    const JobRecord job = Submit();
    std::optional<LeasedJob> leased;
    JobRecord cancelled;
    {
      const std::jthread worker(
          [&] { leased = Must(store().Acquire("w", {"SIMULATE"}, kLease, {})); });
      const std::jthread client([&] { cancelled = Must(store().RequestCancel(job.id, {})); });
    }
    if (leased) {
      EXPECT_EQ(cancelled.state, JobState::kRunning);
      EXPECT_TRUE(Must(store().Renew(leased->lease, kLease)).cancel_requested);
      Finish(leased->lease, JobState::kCancelled);
    } else {
      EXPECT_EQ(cancelled.state, JobState::kCancelled);
    }
    EXPECT_EQ(Must(store().GetJob(job.id)).state, JobState::kCancelled);
  }
}

// A cancel and an end at the same time: the end stands, whoever came first.
TEST_P(StoreConformance, CancelRacesWithFinish) {
  for (int round = 0; round < 50; ++round) {
    const LeasedJob leased = (Submit(), Acquire());
    {
      const std::jthread worker([&] { Finish(leased.lease); });
      const std::jthread client([&] { Must(store().RequestCancel(leased.job.id, {})); });
    }
    EXPECT_EQ(Must(store().GetJob(leased.job.id)).state, JobState::kSucceeded);
  }
}

// store.h CountJobs: what waits and what runs, after each change and after a restart.
TEST_P(StoreConformance, JobsAreCounted) {
  const auto counts = [&] {
    const JobCounts now = Must(store().CountJobs());
    return std::pair(now.queued, now.running);
  };
  using Counts = std::pair<std::int64_t, std::int64_t>;
  EXPECT_EQ(counts(), Counts(0, 0));
  for (int i = 0; i < 5; ++i) Submit();
  EXPECT_EQ(counts(), Counts(5, 0));
  const LeasedJob first = Acquire();
  const LeasedJob second = Acquire();
  const LeasedJob third = Acquire();
  EXPECT_EQ(counts(), Counts(2, 3));
  Finish(first.lease);
  EXPECT_EQ(counts(), Counts(2, 2));
  Must(store().HandBack(second.lease, PolicyOfTests()));
  EXPECT_EQ(counts(), Counts(3, 1));
  Must(store().Abandon(third.lease, PolicyOfTests()));
  EXPECT_EQ(counts(), Counts(4, 0));
  Must(store().RequestCancel(second.job.id, {}));
  EXPECT_EQ(counts(), Counts(3, 0));
  EXPECT_FALSE(store().SubmitAndWait({.attachments = {{.name = "a"}, {.name = "a"}}}));
  EXPECT_EQ(counts(), Counts(3, 0));
  Acquire();
  Reopen();
  EXPECT_EQ(counts(), Counts(2, 1));
}

// store.h DeleteJob: all that belongs to it goes, what it shares with others stays, and whoever
// asks for its events hears that they are gone.
TEST_P(StoreConformance, DeletedJobTakesEverythingAlong) {
  const auto finished = [&](const std::string& request_id) {
    Must(store().SubmitAndWait({.request_id = request_id, .kind = "SIMULATE"}));
    const LeasedJob leased = Acquire();
    Must(store().AppendAndWait(leased.lease, {{.kind = "one"}, {.kind = "two"}}));
    Must(store().Finish(leased.lease, {.artifacts = {{.name = "report", .bytes = "shared"},
                                                     {.name = "own", .bytes = request_id}}}));
    return leased.job.id;
  };
  const std::int64_t kept = finished("kept");
  const std::int64_t gone = finished("gone");
  const std::int64_t position = Must(store().LastPosition());
  Must(store().DeleteJob(gone));
  Reopen();
  EXPECT_EQ(CodeOf(store().GetJob(gone)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().ListArtifacts(gone)), ErrorCode::kCellNotFound);
  EXPECT_EQ(CodeOf(store().DeleteJob(gone)), ErrorCode::kCellNotFound);
  EXPECT_EQ(Must(store().LastPosition()), position + 1);  // that it was deleted
  EXPECT_EQ(EventsOf(kept).size(), 2U);
  EXPECT_EQ(Must(store().ReadArtifact(kept, "report")), "shared");
  // The number is not given again, and the request is a new one.
  const JobRecord again =
      Must(store().SubmitAndWait({.request_id = "gone", .kind = "SIMULATE"})).job;
  EXPECT_GT(again.id, gone);
}

TEST_P(StoreConformance, JobThatHasNotEndedIsNotDeleted) {
  EXPECT_EQ(CodeOf(store().DeleteJob(1)), ErrorCode::kCellNotFound);
  const JobRecord job = Submit();
  EXPECT_EQ(CodeOf(store().DeleteJob(job.id)), ErrorCode::kCellPrecondition);
  const LeasedJob leased = Acquire();
  EXPECT_EQ(CodeOf(store().DeleteJob(job.id)), ErrorCode::kCellPrecondition);
  Finish(leased.lease, JobState::kCancelled);
  Must(store().DeleteJob(job.id));
  EXPECT_EQ(Must(store().CountJobs()).queued, 0);
}

// store.h UnfinishedJobs: by machine what waits or runs, and the oldest that runs.
TEST_P(StoreConformance, UnfinishedJobsAreCountedByMachine) {
  EXPECT_TRUE(Must(store().UnfinishedJobs()).empty());
  const auto submit = [&](const std::string& machine) {
    return Must(store().SubmitAndWait({.machine = machine, .kind = "SIMULATE"})).job.id;
  };
  const std::int64_t first = submit("mill-2");
  submit("mill-1");
  submit("mill-2");
  submit("mill-2");
  const auto told = [&] {
    std::string text;
    for (const MachineJobs& jobs : Must(store().UnfinishedJobs())) {
      text += jobs.machine + " " + std::to_string(jobs.unfinished) + " " +
              std::to_string(jobs.oldest_running) + "; ";
    }
    return text;
  };
  EXPECT_EQ(told(), "mill-1 1 0; mill-2 3 0; ");
  const LeasedJob oldest = Acquire();
  ASSERT_EQ(oldest.job.id, first);
  const LeasedJob only = Acquire();  // of mill-1
  const LeasedJob third = Acquire();
  EXPECT_EQ(told(), "mill-1 1 " + std::to_string(only.job.id) + "; mill-2 3 " +
                        std::to_string(first) + "; ");
  Reopen();
  EXPECT_EQ(told(), "mill-1 1 " + std::to_string(only.job.id) + "; mill-2 3 " +
                        std::to_string(first) + "; ");
  Finish(oldest.lease);
  EXPECT_EQ(told(), "mill-1 1 " + std::to_string(only.job.id) + "; mill-2 2 " +
                        std::to_string(third.job.id) + "; ");
  Finish(only.lease);
  Must(store().HandBack(third.lease, PolicyOfTests()));
  EXPECT_EQ(told(), "mill-2 2 0; ");
}

}  // namespace
}  // namespace rmlcell::storage
