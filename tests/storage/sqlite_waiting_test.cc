// What waits for the writer is counted with all that it brings, and contents of no bytes are
// contents.
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/hex.h"
#include "storage/content.h"
#include "storage/sqlite/database.h"
#include "tests/storage/quiet_process.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

constexpr std::size_t kPart = 100'000;

// The writer stands within an answer until the end of this; what the answer looks at outlives it.
class StandingWriter {
 public:
  explicit StandingWriter(Store& store)
      : holder_([meeting = meeting_, &store] {
          store.Submit({.kind = "CHECK"}, [meeting](const Result<SubmittedJob>&) {
            meeting->stands.set_value();
            meeting->goes_on.wait();
          });
        }) {
    meeting_->stands.get_future().wait();
  }
  ~StandingWriter() { meeting_->go_on.set_value(); }
  StandingWriter(const StandingWriter&) = delete;
  StandingWriter& operator=(const StandingWriter&) = delete;

 private:
  struct Meeting {
    std::promise<void> stands;
    std::promise<void> go_on;
    std::future<void> goes_on = go_on.get_future();
  };
  const std::shared_ptr<Meeting> meeting_ = std::make_shared<Meeting>();
  std::jthread holder_;
};

class SqliteWaiting : public testing::Test {
 protected:
  static SqliteOptions AMillion() {
    SqliteOptions options;
    options.waiting_bytes_max = 10 * kPart;
    return options;
  }
  // Of so many writes one after the other, while nothing is written: the number that is taken.
  template <class Send>
  int TakenOf(int count, Send send) {
    std::atomic<int> refused = 0;
    std::atomic<int> answered = 0;
    int refused_at_once = 0;
    {
      const StandingWriter stands(bed_.store());
      for (int i = 0; i < count; ++i) {
        send([&](const auto& result) {
          if (!result) {
            EXPECT_EQ(result.error().code, ErrorCode::kCellResourceExhausted);
            ++refused;
          }
          ++answered;
        });
      }
      refused_at_once = refused;
    }
    EXPECT_TRUE(Eventually([&] { return answered == count; }));
    EXPECT_EQ(refused, refused_at_once);
    return count - refused_at_once;
  }
  int TakenOf(int count, const NewJob& job) {
    return TakenOf(count, [&](auto done) { bed_.store().Submit(job, done); });
  }

  SqliteBed bed_{AMillion()};
};

// sqlite_store.h waiting_bytes_max: nine parts and what they are told with have less than ten, ten
// have more; what was written counts no more.
TEST_F(SqliteWaiting, AllThatAJobBringsCounts) {
  const std::string part(kPart, 'x');
  const NewJob with_events{.kind = "CHECK",
                           .events = {{.kind = "e", .payload = part.substr(0, kPart / 2)},
                                      {.kind = "e", .payload = part.substr(0, kPart / 2)}}};
  const NewJob with_specification{.kind = "CHECK", .specification = part};
  const NewJob with_attachments{.kind = "CHECK",
                                .attachments = {{.name = "a", .bytes = part.substr(0, kPart / 2)},
                                                {.name = "b", .bytes = part.substr(0, kPart / 2)}}};
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(TakenOf(12, with_events), 9) << round;
    EXPECT_EQ(TakenOf(12, with_specification), 9) << round;
    EXPECT_EQ(TakenOf(12, with_attachments), 9) << round;
  }
}

TEST_F(SqliteWaiting, AppendedEventsCount) {
  Must(bed_.store().SubmitAndWait({.kind = "SIMULATE"}));
  const Lease lease = Must(bed_.store().Acquire("w", {"SIMULATE"}, kLease, {}))->lease;
  const std::vector<NewEvent> events(2, {.kind = "e", .payload = std::string(kPart / 2, 'x')});
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(TakenOf(12, [&](auto done) { bed_.store().Append(lease, events, done); }), 9)
        << round;
  }
  EXPECT_EQ(Must(bed_.store().GetJob(lease.job)).last_sequence, 2 * 9 * 2);
}

// Behind callers that came together one write is enough again, also one that nobody stays for.
TEST(SqliteLoneWrites, AWithdrawalIsDoneThoughNothingElseComes) {
  std::promise<std::size_t> answered;
  std::atomic<int> together = 0;
  SqliteBed bed;
  const std::int64_t request =
      bed.store().AwaitJobs({.worker = "w", .kinds = {"SIMULATE"}, .duration = kLease},
                            [&](const Result<std::vector<LeasedJob>>& leased) {
                              answered.set_value(leased ? leased->size() : 99U);
                            });
  {
    const StandingWriter stands(bed.store());
    for (int i = 0; i < 3; ++i)
      bed.store().Submit({.kind = "CHECK"}, [&](const Result<SubmittedJob>&) { ++together; });
  }
  EXPECT_TRUE(Eventually([&] { return together == 3; }));
  Must(bed.store().PutMachine({.id = "m"}, 0));  // from now on nobody is waited for
  bed.store().Withdraw(request);
  auto nothing = answered.get_future();
  ASSERT_EQ(nothing.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(nothing.get(), 0U);
}

// The first stands in the row of its artifact, those that come then are a content of their own.
TEST(SqliteNoBytes, AProductOfNoBytesComesAgain) {
  SqliteBed bed;
  std::vector<std::int64_t> jobs;
  for (int i = 0; i < 3; ++i) {
    Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
    const Lease lease = Must(bed.store().Acquire("w", {"CHECK"}, kLease, {}))->lease;
    Must(bed.store().Finish(lease, {.artifacts = {{.name = "nothing"}}}));
    jobs.push_back(lease.job);
  }
  EXPECT_EQ(NumberIn(bed.path(), "SELECT count(*) FROM blob"), 1);
  for (int round = 0; round < 2; ++round) {
    for (const std::int64_t job : jobs) {
      EXPECT_EQ(Must(bed.store().ReadArtifact(job, "nothing")), "");
      const ArtifactRecord told = Must(bed.store().GetArtifact(job, "nothing"));
      EXPECT_EQ(told.size, 0);
      EXPECT_EQ(told.sha256, HexOf(Sha256("")));
      EXPECT_EQ(Must(Must(bed.store().OpenArtifact(job, "nothing"))->Next()), "");
    }
    bed.Reopen();
  }
}

// store.h: a lease that ran out stays its holder's until it is taken: one that was seen to be over
// and is renewed before that is not.
TEST(SqliteLeases, ALeaseThatIsRenewedMeanwhileIsNotTaken) {
  SqliteBed bed;
  Store& store = bed.store();
  Must(store.SubmitAndWait({.kind = "SIMULATE"}));
  const Lease lease = Must(store.Acquire("w", {"SIMULATE"}, kLease, {}))->lease;
  bed.clock().Advance(2 * kLease);
  std::atomic<bool> renewed{false};
  std::optional<Result<std::vector<JobRecord>>> taken;
  std::jthread taker;
  {
    const StandingWriter stands(store);
    store.SendRenew(lease, kLease, [&](const Result<JobRecord>& job) { renewed = !CodeOf(job); });
    taker = std::jthread([&] { taken.emplace(store.Expire(PolicyOfTests())); });
    EXPECT_TRUE(ComesToRest());  // it has seen the lease and waits behind the renewal
  }
  taker.join();
  EXPECT_TRUE(renewed);
  EXPECT_TRUE(Must(*taken).empty());
  EXPECT_EQ(Must(store.GetJob(lease.job)).state, JobState::kRunning);
}

// And one that was given back and given to another one meanwhile is that one's, who may have had it
// for no time at all.
TEST(SqliteLeases, ALeaseThatWasGivenAnewMeanwhileIsNotTaken) {
  SqliteBed bed;
  Store& store = bed.store();
  Must(store.SubmitAndWait({.kind = "SIMULATE"}));
  const Lease lease = Must(store.Acquire("w", {"SIMULATE"}, kLease, {}))->lease;
  bed.clock().Advance(2 * kLease);
  std::optional<Result<std::vector<LeasedJob>>> given;
  std::optional<Result<std::vector<JobRecord>>> taken;
  std::jthread other;
  std::jthread taker;
  {
    const StandingWriter stands(store);
    store.SendHandBack(lease, PolicyOfTests(), [](const Result<JobRecord>&) {});
    other = std::jthread(
        [&] { given.emplace(store.AcquireJobs({.worker = "x", .kinds = {"SIMULATE"}})); });
    EXPECT_TRUE(ComesToRest());  // it waits behind what is given back
    taker = std::jthread([&] { taken.emplace(store.Expire(PolicyOfTests())); });
    EXPECT_TRUE(ComesToRest());  // it has seen the first lease and waits behind the other one
  }
  other.join();
  taker.join();
  ASSERT_EQ(Must(*given).size(), 1U);
  EXPECT_TRUE(Must(*taken).empty());
  EXPECT_EQ(Must(store.GetJob(lease.job)).state, JobState::kRunning);
  const std::vector<AttemptRecord> attempts = Must(store.ListAttempts(lease.job));
  ASSERT_EQ(attempts.size(), 2U);
  EXPECT_EQ(attempts[0].how_it_ended, "handed back");
  EXPECT_EQ(attempts[1].how_it_ended, "");
}

// store.h SendFinish: a large program that a run compiled is no more waited for than a large
// product is.
TEST(SqliteLargeEnds, WhoTellsOfALargeExecutableWaitsForNothing) {
  std::promise<std::optional<ErrorCode>> ended;
  SqliteBed bed;
  Store& store = bed.store();
  Must(store.PutMachine({.id = "m"}, 0));
  Must(store.PutPrograms("m", {{.slot = 1, .object = "o"}}, {}));
  Must(store.SubmitAndWait({.machine = "m", .kind = "SIMULATE"}));
  const Lease lease = Must(store.Acquire("w", {"SIMULATE"}, kLease, {}))->lease;
  const std::string large = Noise(kChunkBytes + 1, 1);
  const auto end = std::make_shared<const JobEnd>(
      JobEnd{.executables = {{.slot = 1, .object_revision = 1, .bytes = large}}});
  std::future<void> told;
  {
    const StandingWriter stands(store);
    told = std::async(std::launch::async, [&] {
      store.SendFinish(lease, end, {},
                       [&](const Result<FinishedJob>& job) { ended.set_value(CodeOf(job)); });
    });
    EXPECT_EQ(told.wait_for(kPatience), std::future_status::ready);
  }
  told.get();
  auto answer = ended.get_future();
  ASSERT_EQ(answer.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(answer.get(), std::nullopt);
  EXPECT_TRUE(Must(store.GetProgram("m", 1)).executable == large);
}

// sqlite_store.h waiting_operations_max: submissions and appended events, and no other write.
TEST(SqliteLoneWrites, WhoWaitsForHisWriteIsNeverRefused) {
  SqliteOptions options;
  options.waiting_operations_max = 1;
  std::atomic<int> refused = 0;
  std::optional<Result<MachineRecord>> put;
  SqliteBed bed(options);
  std::jthread waits;
  {
    const StandingWriter stands(bed.store());
    for (int i = 0; i < 2; ++i) {
      bed.store().Submit({.kind = "CHECK"}, [&](const Result<SubmittedJob>& made) {
        if (!made) ++refused;
      });
    }
    EXPECT_EQ(refused, 1);
    waits = std::jthread([&] { put.emplace(bed.store().PutMachine({.id = "m"}, 0)); });
    EXPECT_TRUE(ComesToRest());
  }
  waits.join();
  EXPECT_EQ(CodeOf(*put), std::nullopt);
}

// store.h NewJob::more_come: the store's own thread writes it and answers; who is answered may call
// the store there as well, also in ways that wait.
TEST(SqliteLoneWrites, AnAnswerOfTheStoresOwnThreadMayWrite) {
  std::promise<std::pair<std::thread::id, std::optional<ErrorCode>>> written;
  SqliteBed bed;
  EXPECT_TRUE(ComesToRest());  // the thread has nothing to do
  bed.store().Submit({.kind = "CHECK", .more_come = true}, [&](const Result<SubmittedJob>&) {
    const std::optional<ErrorCode> put = CodeOf(bed.store().PutMachine({.id = "m"}, 0));
    written.set_value({std::this_thread::get_id(), put});
  });
  auto answer = written.get_future();
  ASSERT_EQ(answer.wait_for(kPatience), std::future_status::ready);
  const auto [thread, put] = answer.get();
  EXPECT_NE(thread, std::this_thread::get_id());
  EXPECT_EQ(put, std::nullopt);
}

// Most who ask for work or for orders find nothing: they write nothing, and do not wait for a
// program that holds the file, also where jobs wait that may not begin.
TEST(SqliteLoneWrites, WhoFindsNothingWaitsForNobody) {
  SqliteOptions options;
  options.busy_timeout = std::chrono::milliseconds(50);
  SqliteBed bed(options);
  Must(bed.store().SubmitAndWait({.kind = "CHECK", .held = true}));
  const WallTime later = bed.clock().Now() + std::chrono::hours(1);
  Must(bed.store().SubmitAndWait({.kind = "CHECK", .not_before = later}));
  for (const bool opened_again : {false, true}) {
    if (opened_again) bed.Reopen();
    EXPECT_TRUE(ComesToRest());
    sqlite::Database other =
        Must(sqlite::Database::Open(bed.path(), sqlite::Database::Access::kReadWrite, {}));
    Must(other.Execute("BEGIN IMMEDIATE"));
    const auto leased =
        bed.store().AcquireJobs({.worker = "w", .kinds = {"CHECK"}, .duration = kLease});
    EXPECT_EQ(CodeOf(leased), std::nullopt) << opened_again;
    EXPECT_TRUE(!leased || leased->empty());
    EXPECT_EQ(CodeOf(bed.store().TakeOrders("s")), std::nullopt) << opened_again;
    Must(other.Execute("ROLLBACK"));
  }
}

// How often the store asks for the time: for each write that it runs, and for each request that it
// tries.
class SqliteTries {
 public:
  SqliteTries()
      : store_(Must(OpenSqliteStore({.path = directory_.File("cell.db")}, [this] {
          ++tries_;
          return SystemTime();
        }))) {}

  Store& store() { return *store_; }
  void Await(const JobRequest& request) {
    store_->AwaitJobs(request, [](const Result<std::vector<LeasedJob>>&) {});
  }
  template <class Act>
  int During(Act act) {
    EXPECT_TRUE(ComesToRest());
    const int before = tries_;
    act();
    EXPECT_TRUE(ComesToRest());
    return tries_ - before;
  }

 private:
  const TestDirectory directory_;
  std::atomic<int> tries_ = 0;
  std::unique_ptr<Store> store_;
};

// writer.h: of those who wait for the same, with nothing there for the first one, no other is
// tried.
TEST(SqliteStanding, OfThoseWhoAskForTheSameOneIsTried) {
  const auto tries = [](const std::vector<JobRequest>& requests) {
    SqliteTries bed;
    for (const JobRequest& request : requests) bed.Await(request);
    return bed.During([&] { Must(bed.store().SubmitAndWait({.kind = "CHECK"})); });
  };
  const JobRequest one{.worker = "a", .kinds = {"SIMULATE"}};
  JobRequest same = one;
  same.worker = "b";
  const int first = tries({one});
  EXPECT_EQ(tries({}), first - 1);
  EXPECT_EQ(tries({one, same, same}), first);
  JobRequest kinds = same, pools = same, machines = same;
  kinds.kinds = {"SIMULATE", "RUN"};
  pools.pools = {"p"};
  machines.run_machines = {"m"};
  EXPECT_EQ(tries({one, kinds}), first + 1);
  EXPECT_EQ(tries({one, pools}), first + 1);
  EXPECT_EQ(tries({one, machines}), first + 1);
}

// Who was given a job did not find nothing: of two jobs that come in one commit each of those who
// wait for the same is given one.
TEST(SqliteStanding, JobsOfOneCommitGoToAllWhoWait) {
  std::atomic<int> given = 0;
  std::atomic<int> made = 0;
  SqliteBed bed;
  for (const char* worker : {"a", "b"}) {
    bed.store().AwaitJobs({.worker = worker, .kinds = {"SIMULATE"}, .duration = kLease},
                          [&](const Result<std::vector<LeasedJob>>& leased) {
                            given += leased ? static_cast<int>(leased->size()) : 0;
                          });
  }
  Must(bed.store().ActOn({}, QueueAct::kHold, {}));  // they stand
  {
    const StandingWriter stands(bed.store());
    for (int i = 0; i < 2; ++i)
      bed.store().Submit({.kind = "SIMULATE"}, [&](const Result<SubmittedJob>&) { ++made; });
  }
  EXPECT_TRUE(Eventually([&] { return made == 2; }));
  EXPECT_EQ(given, 2);  // before those that made the jobs are answered
  EXPECT_EQ(Must(bed.store().CountJobs()).running, 2);
}

// What the clock lets go is written: who cannot write it says so, and it goes with the next call.
TEST(SqliteLoneWrites, WhatIsDueWaitsForTheFile) {
  SqliteOptions options;
  options.busy_timeout = std::chrono::milliseconds(50);
  SqliteBed bed(options);
  const std::string name = HexOf(Sha256("content"));
  const auto while_another_writes = [&] {
    EXPECT_TRUE(ComesToRest());
    sqlite::Database other =
        Must(sqlite::Database::Open(bed.path(), sqlite::Database::Access::kReadWrite, {}));
    Must(other.Execute("BEGIN IMMEDIATE"));
    const auto expired = CodeOf(bed.store().Expire(PolicyOfTests()));
    Must(other.Execute("ROLLBACK"));
    return expired;
  };
  const auto writer = Must(bed.store().WriteBlob(name, 7));
  Must(writer->Append("content"));
  Must(writer->Finish(std::chrono::hours(1)));
  EXPECT_EQ(while_another_writes(), std::nullopt);  // nothing is due
  bed.clock().Advance(std::chrono::hours(1));
  EXPECT_EQ(while_another_writes(), ErrorCode::kCellStoreBusy);
  Must(bed.store().Expire(PolicyOfTests()));
  EXPECT_TRUE(
      Eventually([&] { return CodeOf(bed.store().ReadBlob(name)) == ErrorCode::kCellNotFound; }));
  const WallTime later = bed.clock().Now() + std::chrono::hours(1);
  Must(bed.store().SubmitAndWait({.kind = "CHECK", .not_before = later}));
  bed.clock().Advance(std::chrono::hours(1));
  EXPECT_EQ(while_another_writes(), ErrorCode::kCellStoreBusy);
  Must(bed.store().Expire(PolicyOfTests()));
  EXPECT_TRUE(Must(bed.store().Acquire("w", {"CHECK"}, kLease, {})));
}

// A RUN that is over lets the next one of its machine begin; the end of another job lets nothing
// begin, and nobody who waits is tried.
TEST(SqliteStanding, TheEndOfARunIsWaitedFor) {
  const auto tries = [](const std::string& kind, bool waits) {
    SqliteTries bed;
    Must(bed.store().SubmitAndWait({.kind = "CHECK"}));  // ready, and not asked for
    const std::int64_t job = Must(bed.store().SubmitAndWait({.machine = "m", .kind = kind})).job.id;
    if (waits) bed.Await({.worker = "w", .kinds = {"SIMULATE"}});
    return bed.During([&] { Must(bed.store().RequestCancel(job, {})); });
  };
  EXPECT_EQ(tries("CHECK", true), tries("CHECK", false));
  const std::string run(kRunKind);
  EXPECT_EQ(tries(run, true), tries(run, false) + 1);
}

}  // namespace
}  // namespace rmlcell::storage
