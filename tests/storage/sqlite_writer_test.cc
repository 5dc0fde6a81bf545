// How the embedded store takes writes: many in one commit, bounded waiting, answers that write,
// other programs that hold the file, and its end.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <future>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "storage/sqlite/reader_pool.h"
#include "storage/sqlite/request_ids.h"
#include "storage/sqlite/statement.h"
#include "tests/storage/faulty_disk.h"
#include "tests/storage/quiet_process.h"
#include "tests/storage/sqlite_bed.h"

namespace rmlcell::storage {
namespace {

// Holds the writer inside an answer until it is let go. On a thread of its own: a lone caller may
// be answered before his call returns. The answer may outlast what holds it, its promises do too.
class WriterHold {
 public:
  explicit WriterHold(Store& store)
      : holder_([&store, gates = gates_] {
          store.Submit({.kind = "CHECK"}, [gates](const Result<SubmittedJob>&) {
            gates->held.set_value();
            gates->release.get_future().wait();
          });
        }) {
    gates_->held.get_future().wait();
  }
  void Release() { gates_->release.set_value(); }

 private:
  struct Gates {
    std::promise<void> held;
    std::promise<void> release;
  };
  std::shared_ptr<Gates> gates_ = std::make_shared<Gates>();
  std::jthread holder_;
};

class Answers {
 public:
  std::function<void(Result<SubmittedJob>)> Next() {
    return [this](const Result<SubmittedJob>& submitted) {
      if (submitted)
        ++good;
      else if (submitted.error().code == ErrorCode::kCellResourceExhausted)
        ++refused;
      ++all;
    };
  }
  void WaitFor(int count) const {
    EXPECT_TRUE(Eventually([&] { return all >= count; }));
  }
  std::atomic<int> good = 0;
  std::atomic<int> refused = 0;
  std::atomic<int> all = 0;
};

// platform.md 5, group commit: what waits shares one commit, that is, one sync of the log.
TEST(SqliteWriter, WaitingWritesShareOneCommit) {
  faulty_disk::Register();
  faulty_disk::Heal();
  SqliteOptions options;
  options.vfs = faulty_disk::kName;
  SqliteBed bed(options);
  WriterHold hold(bed.store());
  Answers answers;
  constexpr int kJobs = 500;
  for (int i = 0; i < kJobs; ++i) bed.store().Submit({.kind = "CHECK"}, answers.Next());
  const std::int64_t before = NumberIn(bed.path(), "SELECT count(*) FROM job");
  EXPECT_EQ(before, 1);
  faulty_disk::Fail({});  // counts from here
  hold.Release();
  answers.WaitFor(kJobs);
  EXPECT_EQ(answers.good, kJobs);
  // A commit of its own would be at least two writes for each job.
  EXPECT_LT(faulty_disk::Operations(), kJobs);
}

// store.h AwaitJobs: a request and the job that it waits for, in one commit, whichever comes first.
TEST(SqliteWriter, ARequestAndItsJobInOneCommitMeet) {
  for (const bool request_first : {true, false}) {
    SqliteBed bed;
    std::promise<std::int64_t> given;
    Answers answers;
    {
      WriterHold hold(bed.store());
      if (!request_first) bed.store().Submit({.kind = "SIMULATE"}, answers.Next());
      bed.store().AwaitJobs(
          {.worker = "w", .kinds = {"SIMULATE"}, .duration = std::chrono::hours(1)},
          [&](const Result<std::vector<LeasedJob>>& leased) {
            given.set_value(leased->empty() ? 0 : leased->front().lease.job);
          });
      if (request_first) bed.store().Submit({.kind = "SIMULATE"}, answers.Next());
      hold.Release();
    }
    answers.WaitFor(1);
    auto future = given.get_future();
    ASSERT_EQ(future.wait_for(kPatience), std::future_status::ready) << request_first;
    EXPECT_EQ(Must(bed.store().GetJob(future.get())).state, JobState::kRunning);
  }
}

// Who has stood longest is first, also beside a request that comes with the job.
TEST(SqliteWriter, ANewRequestPassesNoneThatStands) {
  std::mutex mutex;
  std::map<std::string, std::int64_t> given;
  SqliteBed bed;  // goes first: it answers who still stands
  const auto await = [&](const std::string& worker) {
    bed.store().AwaitJobs(
        {.worker = worker, .kinds = {"SIMULATE"}, .duration = std::chrono::hours(1)},
        [&, worker](const Result<std::vector<LeasedJob>>& leased) {
          const std::lock_guard lock(mutex);
          given[worker] = leased->empty() ? 0 : leased->front().lease.job;
        });
  };
  await("old");
  Answers answers;
  {
    WriterHold hold(bed.store());
    bed.store().Submit({.kind = "SIMULATE"}, answers.Next());
    await("new");
    hold.Release();
  }
  answers.WaitFor(1);
  Must(bed.store().ActOn({}, QueueAct::kHold, {}));
  const std::lock_guard lock(mutex);
  EXPECT_EQ(given.size(), 1U);
  EXPECT_GT(given["old"], 0);
}

// docs/decisions/0005: who finds the store idle commits on his own thread, and not only the first
// time.
TEST(SqliteWriter, LoneCallersCommitOnTheirOwnThread) {
  SqliteBed bed;
  // While the store's own thread gets ready it has the turn, and would be given one write after the
  // other if each came before it lets go.
  EXPECT_TRUE(ComesToRest());
  int alone = 0;
  for (int i = 0; i < 100; ++i) {
    std::promise<std::thread::id> answered;
    bed.store().Submit({.kind = "CHECK"}, [&](const Result<SubmittedJob>&) {
      answered.set_value(std::this_thread::get_id());
    });
    if (answered.get_future().get() == std::this_thread::get_id()) ++alone;
  }
  EXPECT_GE(alone, 10);
}

// What is too much is refused at once, what was taken is done.
TEST(SqliteWriter, TooManyWaitingWritesAreRefused) {
  SqliteOptions options;
  options.waiting_operations_max = 10;
  SqliteBed bed(options);
  WriterHold hold(bed.store());
  Answers answers;
  for (int i = 0; i < 15; ++i) bed.store().Submit({.kind = "CHECK"}, answers.Next());
  EXPECT_EQ(answers.all, 5);  // told by this thread
  EXPECT_EQ(answers.refused, 5);
  hold.Release();
  answers.WaitFor(15);
  EXPECT_EQ(answers.good, 10);
  EXPECT_TRUE(bed.store().SubmitAndWait({.kind = "CHECK"}).has_value());
}

TEST(SqliteWriter, TooManyWaitingBytesAreRefused) {
  SqliteOptions options;
  options.waiting_bytes_max = 1'000'000;
  SqliteBed bed(options);
  WriterHold hold(bed.store());
  Answers answers;
  const auto submit = [&] {
    bed.store().Submit(
        {.kind = "CHECK", .events = {{.kind = "e", .payload = std::string(600'000, 'x')}}},
        answers.Next());
  };
  submit();
  submit();
  EXPECT_EQ(answers.refused, 1);
  hold.Release();
  answers.WaitFor(2);
  EXPECT_EQ(answers.good, 1);
  // One that is larger than the bound alone is taken when nothing waits.
  bed.store().Submit(
      {.kind = "CHECK", .events = {{.kind = "e", .payload = std::string(2'000'000, 'x')}}},
      answers.Next());
  answers.WaitFor(3);
  EXPECT_EQ(answers.good, 2);
}

// What brings no bytes is never refused, however much waits: neither who waits for a job nor who
// does so no more.
TEST(SqliteWriter, WhoWaitsForAJobIsNeverRefused) {
  SqliteOptions options;
  options.waiting_operations_max = 2;
  std::promise<std::size_t> withdrawn;
  std::promise<std::int64_t> given;
  Answers answers;
  SqliteBed bed(options);  // goes first: it answers who still stands
  const auto await = [&](const std::function<void(Result<std::vector<LeasedJob>>)>& done) {
    return bed.store().AwaitJobs(
        {.worker = "w", .kinds = {"SIMULATE"}, .duration = std::chrono::hours(1)}, done);
  };
  const std::int64_t first = await([&](const Result<std::vector<LeasedJob>>& leased) {
    withdrawn.set_value(leased ? leased->size() : 99U);
  });
  Must(bed.store().ActOn({}, QueueAct::kHold, {}));  // it stands
  auto nothing = withdrawn.get_future();
  {
    WriterHold hold(bed.store());
    for (int i = 0; i < 3; ++i) bed.store().Submit({.kind = "CHECK"}, answers.Next());
    EXPECT_EQ(answers.refused, 1);
    bed.store().Withdraw(first);
    // It waits as any other: whoever has the turn looks at those that stand, and nobody else.
    EXPECT_EQ(nothing.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
    await([&](const Result<std::vector<LeasedJob>>& leased) {
      given.set_value(leased && !leased->empty() ? leased->front().lease.job : 0);
    });
    hold.Release();
  }
  ASSERT_EQ(nothing.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(nothing.get(), 0U);
  const std::int64_t job = Must(bed.store().SubmitAndWait({.kind = "SIMULATE"})).job.id;
  auto one = given.get_future();
  ASSERT_EQ(one.wait_for(kPatience), std::future_status::ready);
  EXPECT_EQ(one.get(), job);
}

// An answer that writes would wait for room that its own end alone can make.
TEST(SqliteWriter, AnAnswerMayWriteHoweverMuchWaits) {
  SqliteOptions options;
  options.waiting_operations_max = 2;
  std::promise<std::optional<ErrorCode>> written;
  Answers answers;
  SqliteBed bed(options);
  const std::jthread first([&] {
    bed.store().Submit({.kind = "CHECK"}, [&](const Result<SubmittedJob>&) {
      for (int i = 0; i < 3; ++i) bed.store().Submit({.kind = "CHECK"}, answers.Next());
      written.set_value(CodeOf(bed.store().PutMachine({.id = "m"}, 0)));
    });
  });
  EXPECT_EQ(written.get_future().get(), std::nullopt);
  answers.WaitFor(3);
  EXPECT_EQ(answers.refused, 1);
}

// sqlite_store.h group_window: those that were answered together are waited for, here for an hour,
// and written as soon as the last of them is there.
TEST(SqliteWriter, CallersThatWereAnsweredTogetherAreWrittenTogether) {
  faulty_disk::Register();
  faulty_disk::Heal();
  SqliteOptions options;
  options.vfs = faulty_disk::kName;
  options.group_window = std::chrono::hours(1);
  SqliteBed bed(options);
  Answers answers;
  {
    WriterHold hold(bed.store());
    for (int i = 0; i < 3; ++i) bed.store().Submit({.kind = "CHECK"}, answers.Next());
    hold.Release();
  }
  answers.WaitFor(3);
  faulty_disk::Fail({});  // counts from here
  for (int i = 0; i < 2; ++i) bed.store().Submit({.kind = "CHECK"}, answers.Next());
  EXPECT_EQ(answers.all, 3);
  bed.store().Submit({.kind = "CHECK"}, answers.Next());
  answers.WaitFor(6);
  EXPECT_EQ(faulty_disk::Syncs(), 1);
}

// An answer that writes runs what was queued before it first, and the answers of those come after
// it.
TEST(SqliteWriter, AnswerThatWritesKeepsTheOrder) {
  SqliteBed bed;
  Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  const Lease lease = Must(bed.store().Acquire("w", {"CHECK"}, kLease, {}))->lease;
  std::mutex mutex;
  std::vector<std::string> order;
  const auto note = [&](const std::string& what) {
    const std::lock_guard lock(mutex);
    order.push_back(what);
  };
  std::promise<void> begun;
  std::promise<void> queued;
  std::promise<void> all;
  const std::jthread first([&] {
    bed.store().Append(lease, {{.kind = "1"}}, [&](const Result<std::int64_t>& last) {
      note(Numbered("answer ", Must(last)));
      begun.set_value();
      queued.get_future().wait();
      const auto written = bed.store().AppendAndWait(lease, {{.kind = "3"}});
      note(Numbered("inside ", Must(written)));
    });
  });
  begun.get_future().wait();
  bed.store().Append(lease, {{.kind = "2"}}, [&](const Result<std::int64_t>& last) {
    note(Numbered("answer ", Must(last)));
    all.set_value();
  });
  queued.set_value();
  all.get_future().wait();
  EXPECT_THAT(order, testing::ElementsAre("answer 1", "inside 3", "answer 2"));
}

// writer.h: a lone caller commits by himself, many are answered together, and what one of them
// appends is written in the order of his calls, whoever writes it.
TEST(SqliteWriter, OrderHoldsWhoeverWrites) {
  SqliteBed bed;
  constexpr int kThreads = 4;
  constexpr int kEvents = 300;
  std::vector<Lease> leases;
  for (int i = 0; i < kThreads; ++i) {
    Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
    leases.push_back(Must(bed.store().Acquire(Numbered("w", i), {"CHECK"}, kLease, {}))->lease);
  }
  std::atomic<int> answered = 0;
  {
    std::vector<std::jthread> threads;
    for (const Lease& lease : leases) {
      threads.emplace_back([&bed, &answered, lease] {
        for (int i = 0; i < kEvents; ++i) {
          bed.store().Append(
              lease, {{.kind = Numbered("e", i)}},
              [&answered](const Result<std::int64_t>& last) { answered += last ? 1 : 0; });
          // Now and then alone, now and then in company.
          if (i % 16 == 0) Eventually([&, sent = i * kThreads / 2] { return answered >= sent; });
        }
      });
    }
  }
  ASSERT_TRUE(Eventually([&] { return answered >= kThreads * kEvents; }));
  for (const Lease& lease : leases) {
    const auto events = Must(bed.store().JobEvents(lease.job, 0, kEvents + 1));
    ASSERT_EQ(events.size(), kEvents);
    for (int i = 0; i < kEvents; ++i) {
      EXPECT_EQ(events[static_cast<std::size_t>(i)].kind, Numbered("e", i));
    }
  }
}

// Another program that holds the file: the write waits, then ends with CellStoreBusy, and works
// later.
TEST(SqliteWriter, FileHeldByAnotherProgramIsBusy) {
  SqliteOptions options;
  options.busy_timeout = std::chrono::milliseconds(50);
  SqliteBed bed(options);
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(bed.path().c_str(), &other), SQLITE_OK);
  EXPECT_TRUE(ComesToRest());  // the store tidies up no more
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_EQ(CodeOf(bed.store().SubmitAndWait({.kind = "CHECK"})), ErrorCode::kCellStoreBusy);
  EXPECT_EQ(Must(bed.store().ListJobs({})).size(), 0U);
  ASSERT_EQ(sqlite3_exec(other, "ROLLBACK", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(other);
  EXPECT_EQ(CodeOf(bed.store().SubmitAndWait({.kind = "CHECK"})), std::nullopt);
}

// A reader that stays for long: writers and other readers go on, and it sees what was when it
// began.
TEST(SqliteWriter, LongReadersHoldNobodyUp) {
  SqliteBed bed;
  Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  sqlite3* reader = nullptr;
  ASSERT_EQ(sqlite3_open(bed.path().c_str(), &reader), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(reader, "BEGIN; SELECT count(*) FROM job", nullptr, nullptr, nullptr),
            SQLITE_OK);
  Must(bed.store().PutMachine({.id = "m"}, 0));
  for (int slot = 1; slot <= 3; ++slot) {  // more than the log is let grow to
    Must(bed.store().PutPrograms(
        "m", {{.slot = slot, .object = Noise(20 << 20, static_cast<std::uint64_t>(slot))}}, {}));
  }
  Must(bed.store().SubmitAndWait({.kind = "CHECK"}));
  EXPECT_EQ(Must(bed.store().ListJobs({})).size(), 2U);
  std::string seen;
  const auto take = [](void* into, int, char** values, char**) {
    *static_cast<std::string*>(into) = values[0];
    return 0;
  };
  sqlite3_exec(reader, "SELECT count(*) FROM job", take, &seen, nullptr);
  EXPECT_EQ(seen, "1");
  sqlite3_close(reader);
}

// More readers than connections, all of them while others write.
TEST(SqliteWriter, ManyReadersShareFewConnections) {
  SqliteOptions options;
  options.readers = 2;
  SqliteBed bed(options);
  std::atomic<int> bad = 0;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 16; ++i) {
      threads.emplace_back([&] {
        for (int turn = 0; turn < 40; ++turn) {
          const auto submitted = bed.store().SubmitAndWait({.kind = "CHECK"});
          if (!submitted || !bed.store().GetJob(submitted->job.id)) ++bad;
          const auto listed = bed.store().ListJobs({.limit = 20});
          if (!listed || listed->empty()) ++bad;
        }
      });
    }
  }
  EXPECT_EQ(bad, 0);
}

// So many reads at a time, each inside the one before.
Result<int> ReadInside(sqlite::ReaderPool& pool, int depth, std::set<sqlite::Tables*>& used) {
  if (depth == 0) return 0;
  return pool.Read([&](sqlite::Tables& tables) -> Result<int> {
    used.insert(&tables);
    return ReadInside(pool, depth - 1, used);
  });
}

// SqliteOptions::readers: as many connections as asked for, and one at least.
TEST(SqliteWriter, ReadersAreAsManyAsAskedFor) {
  SqliteBed bed;
  for (const auto& [asked, there] : {std::pair{-1, 1}, {0, 1}, {1, 1}, {3, 3}}) {
    sqlite::ReaderPool pool(bed.path(), {}, asked);
    std::set<sqlite::Tables*> used;
    Must(ReadInside(pool, there, used));  // waits for ever for one that is missing
    EXPECT_EQ(used.size(), static_cast<std::size_t>(there)) << asked;
  }
}

// However many read at a time.
TEST(SqliteWriter, ReadersAreNotMoreThanAskedFor) {
  SqliteBed bed;
  sqlite::ReaderPool pool(bed.path(), {}, 2);
  std::mutex mutex;
  std::set<sqlite::Tables*> used;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) {
      threads.emplace_back([&] {
        for (int turn = 0; turn < 50; ++turn) {
          Must(pool.Read([&](sqlite::Tables& tables) -> Result<int> {
            const std::lock_guard lock(mutex);
            used.insert(&tables);
            std::this_thread::yield();
            return 0;
          }));
        }
      });
    }
  }
  EXPECT_LE(used.size(), 2U);
}

// A connection that could not be opened is tried again by the next read, and nobody waits for it.
TEST(SqliteWriter, ReaderThatCannotBeOpenedIsTriedAgain) {
  SqliteBed bed;
  const std::string path = bed.path() + ".not-yet";
  sqlite::ReaderPool pool(path, {}, 1);
  std::set<sqlite::Tables*> used;
  for (int i = 0; i < 2; ++i) {
    const auto refused = ReadInside(pool, 1, used);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kCellStoreFailed);
    EXPECT_EQ(refused.error().detail,
              path + ": unable to open database file (SQLite 14): No such file or directory");
  }
  ExecuteIn(path, "CREATE TABLE something (it)");
  Must(ReadInside(pool, 1, used));
  EXPECT_EQ(used.size(), 1U);
}

// The end of the store: what waits is written and answered.
TEST(SqliteWriter, WaitingWritesAreDoneAtTheEnd) {
  SqliteBed bed;
  Answers answers;
  for (int i = 0; i < 200; ++i) bed.store().Submit({.kind = "CHECK"}, answers.Next());
  bed.Close();
  EXPECT_EQ(answers.good, 200);
  bed.Reopen();
  EXPECT_EQ(Must(bed.store().ListJobs({.limit = 1000})).size(), 200U);
}

// The clock of the store is that of its records, to the microsecond.
TEST(SqliteWriter, TimesAreThoseOfTheClock) {
  SqliteBed bed;
  const WallTime before = bed.clock().Now();
  bed.clock().Advance(std::chrono::hours(24 * 365 * 30));
  EXPECT_EQ(Must(bed.store().SubmitAndWait({.kind = "CHECK"})).job.created_at,
            before + std::chrono::hours(24 * 365 * 30));
  const Lease lease =
      Must(bed.store().Acquire("w", {"CHECK"}, std::chrono::milliseconds::max(), {}))->lease;
  EXPECT_EQ(lease.until,
            bed.clock().Now() + std::chrono::days(366));  // not beyond what a time can say
  const Lease renewed = lease;
  Must(bed.store().Renew(renewed, std::chrono::milliseconds(-5)));
  EXPECT_EQ(Must(bed.store().Expire(PolicyOfTests())).size(), 1U);
}

TEST(SqliteWriter, SystemTimeIsNow) {
  const auto before = std::chrono::system_clock::now();
  const WallTime now = SystemTime();  // whole microseconds
  EXPECT_GT(now, before - std::chrono::microseconds(1));
  EXPECT_LE(now, std::chrono::system_clock::now());
}

// RFC 9562, UUID of version 7: the time first, version and variant at their places, no two alike.
TEST(RequestIds, AreUuidsOfVersion7) {
  sqlite::RequestIds ids;
  const WallTime time{std::chrono::milliseconds(0x0123456789ABLL)};
  std::set<std::string> made;
  for (int i = 0; i < 10'000; ++i) {
    const std::string id = ids.Make(time);
    ASSERT_EQ(id.size(), 36U);
    EXPECT_EQ(id.substr(0, 15), "01234567-89ab-7");
    EXPECT_EQ(id[18], '-');
    EXPECT_TRUE(std::string("89ab").find(id[19]) != std::string::npos) << id;
    EXPECT_EQ(id[23], '-');
    EXPECT_EQ(id.find_first_not_of("0123456789abcdef-"), std::string::npos) << id;
    made.insert(id);
  }
  EXPECT_EQ(made.size(), 10'000U);
  EXPECT_FALSE(made.contains(sqlite::RequestIds().Make(time)));
}

// Each of the other bits is another one in some of 200 objects.
TEST(RequestIds, OfManyObjectsDifferInEachBit) {
  const auto bits_of = [](std::string id) {
    std::erase(id, '-');
    const std::string first = id.substr(13, 3);
    return std::pair(std::stoull(first, nullptr, 16), std::stoull(id.substr(16), nullptr, 16));
  };
  auto [some_high, some_low] = bits_of(sqlite::RequestIds().Make({}));
  auto [all_high, all_low] = std::pair(some_high, some_low);
  for (int i = 0; i < 200; ++i) {
    const auto [high, low] = bits_of(sqlite::RequestIds().Make({}));
    some_high |= high;
    some_low |= low;
    all_high &= high;
    all_low &= low;
  }
  EXPECT_EQ(some_high, 0xFFFU);
  EXPECT_EQ(all_high, 0U);
  EXPECT_EQ(some_low, 0xBFFF'FFFF'FFFF'FFFFU);
  EXPECT_EQ(all_low, 0x8000'0000'0000'0000U);
}

// A statement tells what went wrong at its first step, and can be used again.
TEST(SqliteStatement, TellsErrorsAndGoesOn) {
  const TestDirectory directory;
  const std::string path = directory.File("x.db");
  ExecuteIn(path, "CREATE TABLE t (a INTEGER PRIMARY KEY, b BLOB NOT NULL)");
  sqlite::Database database =
      Must(sqlite::Database::Open(path, sqlite::Database::Access::kReadWrite, {}));
  sqlite::Statement insert(database, "INSERT INTO t (a, b) VALUES (?1, ?2)");
  Must(insert.With(1, "one").Run());
  EXPECT_EQ(CodeOf(insert.With(1, "again").Run()), ErrorCode::kCellStoreFailed);
  EXPECT_EQ(CodeOf(insert.With(2, std::nullopt).Run()), ErrorCode::kCellStoreFailed);
  Must(insert.With(2, std::string_view()).Run());
  sqlite::Statement wrong(database, "SELECT nonsense FROM t");
  EXPECT_EQ(CodeOf(wrong.With().Run()), ErrorCode::kCellStoreFailed);
  sqlite::Statement count(database, "SELECT count(*) FROM t WHERE b = ?1");
  EXPECT_EQ(Must(sqlite::FirstInteger(count.With(""))), 1);
  sqlite3_limit(database.handle(), SQLITE_LIMIT_LENGTH, 1'000);
  const std::string large(2'000, 'x');
  EXPECT_EQ(CodeOf(insert.With(3, large).Run()), ErrorCode::kCellTooLarge);
}

// sqlite_store.h group_window: two that were answered together are enough, and the second of them
// wakes the writer, which waits for an hour otherwise.
TEST(SqliteWriter, TwoCallersThatWereAnsweredTogetherAreWaitedFor) {
  SqliteOptions options;
  options.group_window = std::chrono::hours(1);
  SqliteBed bed(options);
  Answers answers;
  {
    WriterHold hold(bed.store());
    for (int i = 0; i < 2; ++i) bed.store().Submit({.kind = "CHECK"}, answers.Next());
    hold.Release();
  }
  answers.WaitFor(2);
  bed.store().Submit({.kind = "CHECK"}, answers.Next());
  EXPECT_TRUE(ComesToRest());  // the writer waits
  EXPECT_EQ(answers.all, 2);
  bed.store().Submit({.kind = "CHECK"}, answers.Next());
  answers.WaitFor(4);
}

}  // namespace
}  // namespace rmlcell::storage
