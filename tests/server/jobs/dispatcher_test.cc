#include "server/jobs/dispatcher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "server/base/names.h"
#include "tests/server/jobs/dispatcher_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using storage::JobState;
using testing::ElementsAre;

TEST(DispatcherJoin, RefusesWrongTokensAndOtherVersions) {
  DispatcherBed bed;
  for (const std::string token : {"", "the toke", "the tokens", "THE TOKEN"}) {
    v1::WorkerHello hello = Hello("w");
    hello.set_join_token(token);
    EXPECT_EQ(CodeOf(bed.dispatcher().Join(std::make_shared<FakeLine>(), hello)),
              ErrorCode::kCellJoinRefused);
  }
  v1::WorkerHello hello = Hello("w");
  hello.set_version("0.0.0");
  const auto joined = bed.dispatcher().Join(std::make_shared<FakeLine>(), hello);
  EXPECT_EQ(CodeOf(joined), ErrorCode::kCellVersionMismatch);
  EXPECT_THAT(joined.error().detail, testing::HasSubstr("0.0.0"));
  EXPECT_EQ(bed.dispatcher().workers(), 0);
}

// Who asks for its number knows by 0 that it has not joined.
TEST(DispatcherJoin, EachHasANumberOfItsOwnAboveZero) {
  DispatcherBed bed;
  std::set<Dispatcher::WorkerId> known;
  for (const char* name : {"a", "b", "c"}) {
    const Dispatcher::WorkerId joined =
        Must(bed.dispatcher().Join(std::make_shared<FakeLine>(), Hello(name)));
    EXPECT_GT(joined, 0) << name;
    EXPECT_TRUE(known.insert(joined).second) << name;
  }
  for (const Dispatcher::WorkerId joined : known) bed.dispatcher().Leave(joined);
}

TEST(DispatcherJoin, WelcomesAndCountsWorkers) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 7'000;
  FakeWorker one(bed.dispatcher(), "one");
  const v1::WorkResponse welcome = one.line().Next(v1::WorkResponse::kWelcome);
  EXPECT_EQ(welcome.welcome().lease().seconds(), 7);
  EXPECT_GT(welcome.welcome().events_window(), 0);
  FakeWorker two(bed.dispatcher(), "two");
  EXPECT_EQ(bed.dispatcher().workers(), 2);
  one.Leave();
  EXPECT_EQ(bed.dispatcher().workers(), 1);
  one.Leave();  // twice is not an error
  EXPECT_EQ(bed.dispatcher().workers(), 1);
}

// Nothing else wakes an idle worker then, and leases of five minutes are looked at no sooner.
TEST(DispatcherAssign, AJobStartsWhenItsTimeHasComeHoweverLongLeasesAre) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 600'000;
  Must(bed.server.store().SubmitAndWait(
      {.machine = "optimo-1",
       .kind = "CHECK",
       .not_before = bed.server.clock().Now() + std::chrono::minutes(1),
       .attachments = {{.name = std::string(kMainAttachment), .bytes = "STOP\n"}}}));
  FakeWorker worker(bed.dispatcher(), "w");
  bed.LookAgain();
  EXPECT_FALSE(worker.line().Has(v1::WorkResponse::kAssignment));
  bed.Advance(std::chrono::minutes(1));
  EXPECT_TRUE(worker.Take());
}

TEST(DispatcherAssign, GivesTheOldestJobFirstWithAllThatItNeeds) {
  DispatcherBed bed;
  const std::int64_t first = bed.server.SubmitCheck("STOP\n");
  const std::int64_t second = bed.server.SubmitCheck("DELAY 1.0\n");
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), first);
  EXPECT_EQ(worker.assignment().lease().attempt(), 1);
  EXPECT_EQ(worker.assignment().family(), "optimo");
  EXPECT_EQ(worker.assignment().job().name(), JobName(first));
  EXPECT_EQ(worker.assignment().budget().steps(), bed.config.limit_steps);
  ASSERT_EQ(worker.assignment().programs_size(), 1);
  EXPECT_EQ(worker.assignment().programs(0).content(), "STOP\n");
  EXPECT_TRUE(worker.assignment().programs(0).is_source());
  EXPECT_EQ(bed.Job(first).state, JobState::kRunning);
  EXPECT_EQ(bed.Job(second).state, JobState::kQueued);  // one at a time
  worker.Finish();
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), second);
  EXPECT_TRUE(bed.Becomes(first, JobState::kSucceeded));
}

TEST(DispatcherAssign, GivesAJobThatComesLaterAndOnlyOfItsKinds) {
  DispatcherBed bed;
  v1::WorkerHello hello = Hello("simulator");
  hello.clear_kinds();
  hello.add_kinds(v1::JOB_KIND_SIMULATE);
  FakeWorker simulator(bed.dispatcher(), hello);
  FakeWorker checker(bed.dispatcher(), "checker");
  const std::int64_t job = bed.server.SubmitCheck();
  ASSERT_TRUE(checker.Take());
  EXPECT_EQ(checker.job(), job);
  bed.LookAgain();
  EXPECT_FALSE(simulator.HasJob());
}

TEST(DispatcherAssign, SendsALargeProgramAfterTheAssignment) {
  DispatcherBed bed;
  const std::string source(1 << 20, 'x');
  bed.server.SubmitCheck(source);
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.assignment().programs(0).content(), "");
  EXPECT_EQ(worker.assignment().programs(0).size(), 1 << 20);
  ASSERT_TRUE(Eventually([&] { return worker.line().programs().size() == 1; }));
  EXPECT_EQ(worker.line().programs().at(1), source);
}

// performance.md Q5: a worker that waits is given the job by the transaction that makes it, so that
// nobody ever sees it wait.
TEST(DispatcherAssign, AJobIsGivenOutAsItIsStored) {
  DispatcherBed bed;
  FakeWorker worker(bed.dispatcher(), "w");
  bed.LookAgain();
  std::int64_t job = 0;
  {
    const auto busy = bed.Occupy();  // as soon as it is stored its orders find its worker
    job = bed.server.SubmitCheck();
    EXPECT_EQ(bed.Job(job).state, JobState::kRunning);
    EXPECT_TRUE(bed.dispatcher().OrderAtOnce(job, {.kind = v1::WorkerControl::KIND_HOLD}));
  }
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), job);
  EXPECT_EQ(worker.Ordered().kind(), v1::WorkerControl::KIND_HOLD);
}

// It left while it was given one: the job goes to another, and its attempt does not count.
TEST(DispatcherAssign, AJobGivenToAWorkerThatLeavesGoesToAnother) {
  DispatcherBed bed;
  FakeWorker leaving(bed.dispatcher(), "leaving");
  bed.LookAgain();
  bool first = true;
  bed.hooks.after_acquire = [&] {
    if (!std::exchange(first, false)) return;
    leaving.Leave();
    bed.Settle();  // it is gone for the dispatcher before that hears of the job
  };
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), job);
  EXPECT_EQ(bed.Job(job).attempts, 1);
}

// A worker that leaves takes its request with it.
TEST(DispatcherAssign, AWorkerThatIsGoneWaitsForNothing) {
  DispatcherBed bed;
  {
    FakeWorker worker(bed.dispatcher(), "w");
    bed.LookAgain();
    EXPECT_EQ(bed.hooks.standing, 1);
    worker.Leave();
  }
  EXPECT_TRUE(Eventually([&] { return bed.hooks.standing == 0; }));
  EXPECT_EQ(bed.Job(bed.server.SubmitCheck()).state, JobState::kQueued);
}

TEST(DispatcherAssign, AJobThatCannotBeWorkedOnFailsAndTheNextIsGiven) {
  DispatcherBed bed;
  const std::int64_t broken =
      Must(bed.server.store().SubmitAndWait(
               {.machine = "optimo-1", .kind = "CHECK", .specification = "\xFF\xFF no message"}))
          .job.id;
  const std::int64_t good = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), good);
  EXPECT_EQ(bed.Job(broken).state, JobState::kFailed);
  EXPECT_EQ(bed.Job(broken).outcome->code, ErrorCode::kCellStoreCorrupt);
  EXPECT_TRUE(bed.Events(broken).back().has_ended());
}

TEST(DispatcherFinish, StoresOutcomeProductsAndLastEventTogether) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  worker.Artifact("report", "first ");
  worker.Artifact("report", "second");
  worker.SmallArtifact("picture.svg", "small");
  worker.SmallArtifact("empty", "");
  worker.Finish(v1::Outcome::KIND_COMPLETED);
  EXPECT_EQ(worker.Released(), true);
  EXPECT_EQ(bed.Job(job).state, JobState::kSucceeded);
  const auto report = Must(bed.server.store().GetArtifact(job, "report"));
  EXPECT_EQ(Must(bed.server.store().ReadArtifact(job, "report")), "first second");
  EXPECT_EQ(report.media_type, "text/plain");
  EXPECT_EQ(Must(bed.server.store().GetArtifact(job, "empty")).size, 0);
  EXPECT_EQ(Must(bed.server.store().ReadArtifact(job, "picture.svg")), "small");
  const std::vector<v1::JobEvent> events = bed.Events(job);
  ASSERT_TRUE(events.back().has_ended());
  EXPECT_EQ(events.back().ended().kind(), v1::Outcome::KIND_COMPLETED);
}

// OPT-1.13: a run must know which FUNCTIONs were deleted; those that never were are no news.
TEST(DispatcherAssignment, NamesTheProgramsThatWereDeleted) {
  DispatcherBed bed;
  storage::Store& store = bed.server.store();
  Must(store.PutPrograms(
      "optimo-1", {{.slot = 32, .object = "object 32"}, {.slot = 44, .object = "object 44"}}, {}));
  Must(store.DeleteProgram("optimo-1", 44, storage::kAnyRevision));
  v1::Job specification;
  specification.set_kind(v1::JOB_KIND_SIMULATE);
  specification.set_program("machines/optimo-1/programs/32");
  Must(store.SubmitAndWait({.machine = "optimo-1",
                            .kind = "SIMULATE",
                            .specification = specification.SerializeAsString(),
                            .attachments = {{.name = "program", .bytes = "object 32"}}}));
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_THAT(worker.assignment().deleted_programs(), ElementsAre(44));
}

// OPT-1.11: the executable is stored under n + 100; OPT-1.12: not when the object changed
// meanwhile.
TEST(DispatcherFinish, KeepsExecutablesOfObjectsThatAreStillTheSame) {
  DispatcherBed bed;
  storage::Store& store = bed.server.store();
  Must(store.PutPrograms(
      "optimo-1", {{.slot = 32, .object = "object 32"}, {.slot = 44, .object = "object 44"}}, {}));
  v1::Job specification;
  specification.set_kind(v1::JOB_KIND_SIMULATE);
  specification.set_program("machines/optimo-1/programs/32");
  Must(store.SubmitAndWait({.machine = "optimo-1",
                            .kind = "SIMULATE",
                            .specification = specification.SerializeAsString(),
                            .attachments = {{.name = "program", .bytes = "object 32"}}}));
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.assignment().main_program(), 32);
  EXPECT_EQ(worker.assignment().programs_size(), 2);
  EXPECT_TRUE(worker.assignment().deleted_programs().empty());
  Must(store.PutPrograms("optimo-1", {{.slot = 44, .object = "new 44"}}, {}));
  worker.Finish(v1::Outcome::KIND_COMPLETED,
                {{32, "executable 32"}, {44, "executable 44"}, {50, "none"}});
  EXPECT_EQ(worker.Released(), true);
  EXPECT_EQ(Must(store.GetProgram("optimo-1", 32)).executable, "executable 32");
  EXPECT_EQ(Must(store.GetProgram("optimo-1", 44)).executable, std::nullopt);
  EXPECT_EQ(CodeOf(store.GetProgram("optimo-1", 50)), ErrorCode::kCellNotFound);
}

TEST(DispatcherEvents, AreStoredInOrderAndConfirmed) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  worker.Events(3, "a");
  worker.Events(2, "b");
  // Those that came together are confirmed together.
  const auto confirmed = [&] {
    return worker.line().Next(v1::WorkResponse::kEventsStored).events_stored().count();
  };
  if (const std::int64_t first = confirmed(); first != 5) {
    EXPECT_EQ(first, 3);
    EXPECT_EQ(confirmed(), 5);
  }
  std::vector<std::string> texts;
  std::int64_t sequence = 0;
  for (const v1::JobEvent& event : bed.Events(job)) {
    EXPECT_EQ(event.sequence(), ++sequence);
    if (!event.has_message()) continue;
    texts.push_back(event.message().text());
    EXPECT_EQ(event.attempt(), 1);
    EXPECT_EQ(event.job(), JobName(job));
  }
  EXPECT_THAT(texts, ElementsAre("a", "a", "a", "b", "b"));
}

// The last ones come with the end, and stand before it.
TEST(DispatcherEvents, OfTheEndGoIntoTheLogWithIt) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  worker.Events(1, "a");
  worker.Finish(v1::Outcome::KIND_COMPLETED, {}, {"b", "c"});
  EXPECT_EQ(worker.Released(), true);
  std::vector<std::string> told;
  for (const v1::JobEvent& event : bed.Events(job)) {
    if (event.has_message()) told.push_back(event.message().text());
    if (event.has_ended()) told.emplace_back("the end");
  }
  EXPECT_THAT(told, ElementsAre("a", "b", "c", "the end"));
}

// A worker waits for the confirmation of its events: when it cannot come the job is taken from it.
TEST(DispatcherEvents, ThatCannotBeStoredTakeTheJobFromTheWorker) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 500;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  worker.Events(1, std::string(storage::kEventPayloadBytesMax + 1, 'x'));
  EXPECT_EQ(worker.Released(), false);
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), job);
  EXPECT_EQ(worker.assignment().lease().attempt(), 2);
  worker.Finish();
  EXPECT_TRUE(bed.Becomes(job, JobState::kSucceeded));
}

TEST(DispatcherLease, IsRenewedByHeartbeatsAndLostWithoutThem) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 600;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker alive(bed.dispatcher(), "alive");
  ASSERT_TRUE(alive.Take());
  FakeWorker other(bed.dispatcher(), "other");
  // A heartbeat renews after a third of the lease, and not before.
  const auto heartbeat = [&] {
    alive.Heartbeat();
    bed.Settle();
  };
  bed.Advance(milliseconds(199));
  heartbeat();
  EXPECT_EQ(bed.hooks.renewals, 0);
  bed.Advance(milliseconds(1));
  heartbeat();
  EXPECT_EQ(bed.hooks.renewals, 1);
  heartbeat();
  EXPECT_EQ(bed.hooks.renewals, 1);
  for (int i = 0; i < 4; ++i) {  // far beyond the first lease
    bed.Advance(milliseconds(400));
    heartbeat();
    EXPECT_EQ(bed.hooks.renewals, 2 + i);
  }
  // It ends 600 ms after the last renewal, at that instant and not before.
  bed.Advance(milliseconds(599));
  ASSERT_TRUE(bed.Swept());
  EXPECT_EQ(bed.Job(job).state, JobState::kRunning);
  EXPECT_EQ(bed.Job(job).attempts, 1);
  bed.Advance(milliseconds(1));
  ASSERT_TRUE(other.Take());
  EXPECT_EQ(other.job(), job);
  EXPECT_EQ(other.assignment().lease().attempt(), 2);
}

TEST(DispatcherLease, NothingOfAStaleWorkerIsKept) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 300;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker stale(bed.dispatcher(), "stale");
  ASSERT_TRUE(stale.Take());
  FakeWorker second(bed.dispatcher(), "second");
  bed.Advance(milliseconds(300));
  ASSERT_TRUE(second.Take());
  EXPECT_GT(second.assignment().lease().fence(), stale.assignment().lease().fence());
  stale.Events(1, "stale");
  stale.Artifact("report", "stale");
  stale.Finish(v1::Outcome::KIND_FAILED);
  EXPECT_EQ(stale.Released(), false);
  EXPECT_EQ(bed.Job(job).state, JobState::kRunning);
  second.Artifact("report", "good");
  second.Finish();
  EXPECT_EQ(second.Released(), true);
  EXPECT_EQ(bed.Job(job).state, JobState::kSucceeded);
  EXPECT_EQ(Must(bed.server.store().ReadArtifact(job, "report")), "good");
  for (const v1::JobEvent& event : bed.Events(job)) EXPECT_NE(event.message().text(), "stale");
}

// A message with a lease that the worker does not hold changes nothing at all.
TEST(DispatcherLease, MessagesForAnotherLeaseAreDropped) {
  DispatcherBed bed;
  const std::int64_t first = bed.server.SubmitCheck();
  FakeWorker one(bed.dispatcher(), "one");
  ASSERT_TRUE(one.Take());
  const std::int64_t second = bed.server.SubmitCheck();
  FakeWorker two(bed.dispatcher(), "two");
  ASSERT_TRUE(two.Take());
  // What `one` did is over, and it sends the same again; `two` holds another job.
  one.Finish();
  EXPECT_EQ(one.Released(), true);
  one.Finish(v1::Outcome::KIND_FAILED);
  one.Events(5);
  one.HandBack();
  bed.Settle();
  EXPECT_FALSE(one.line().Has(v1::WorkResponse::kRelease));
  EXPECT_FALSE(one.line().Has(v1::WorkResponse::kEventsStored));
  EXPECT_EQ(bed.Job(first).state, JobState::kSucceeded);
  EXPECT_EQ(bed.Job(second).state, JobState::kRunning);
}

// The only worker lost its lease without dying: it must be given work again, the lost job included.
TEST(DispatcherLease, AWorkerThatLostItsLeaseIsGivenTheNextJob) {
  DispatcherBed bed;
  bed.config.workers_lease_ms = 300;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  bed.Advance(milliseconds(300));
  ASSERT_TRUE(bed.Becomes(job, JobState::kQueued));
  worker.Heartbeat();  // would renew
  EXPECT_EQ(worker.Released(), false);
  ASSERT_TRUE(worker.Take());
  EXPECT_EQ(worker.job(), job);
  EXPECT_EQ(worker.assignment().lease().attempt(), 2);
}

TEST(DispatcherLoss, AJobIsTriedAgainAndThenFailsWithACodeThatSaysSo) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 2);
  for (int attempt = 1; attempt <= 2; ++attempt) {
    FakeWorker worker(bed.dispatcher(), "w" + std::to_string(attempt));
    ASSERT_TRUE(worker.Take());
    EXPECT_EQ(worker.assignment().lease().attempt(), attempt);
    worker.BeginAndLeave();
    ASSERT_TRUE(bed.Becomes(job, attempt < 2 ? JobState::kQueued : JobState::kFailed));
  }
  EXPECT_EQ(bed.Job(job).outcome->code, ErrorCode::kCellWorkerDied);
  const std::vector<v1::JobEvent> events = bed.Events(job);
  ASSERT_TRUE(events.back().has_ended());
  EXPECT_EQ(events.back().ended().code(), CodeText(ErrorCode::kCellWorkerDied));
  EXPECT_FALSE(events.back().ended().advice().empty());
  // Others go on.
  const std::int64_t next = bed.server.SubmitCheck();
  FakeWorker healthy(bed.dispatcher(), "healthy");
  ASSERT_TRUE(healthy.Take());
  EXPECT_EQ(healthy.job(), next);
}

// Two workers that are killed at once: the job of the first goes to the second, which is dead
// already and never says that it began.
TEST(DispatcherLoss, AnAttemptThatNeverBeganDoesNotCount) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 2);
  FakeWorker one(bed.dispatcher(), "one");
  ASSERT_TRUE(one.Take());
  FakeWorker other(bed.dispatcher(), "other");
  one.BeginAndLeave();
  ASSERT_TRUE(other.Take());
  other.Leave();
  ASSERT_TRUE(bed.Becomes(job, JobState::kQueued));
  EXPECT_EQ(bed.Job(job).attempts, 1);
  FakeWorker third(bed.dispatcher(), "third");
  ASSERT_TRUE(third.Take());
  EXPECT_EQ(third.assignment().lease().attempt(), 3);
  std::vector<std::string> told;
  for (const v1::JobEvent& event : bed.Events(job)) {
    if (event.has_message()) told.push_back(event.message().text());
  }
  EXPECT_THAT(told, testing::ElementsAre("the worker of attempt 1 died",
                                         "the worker of attempt 2 died before it began"));
  third.Finish();
  EXPECT_EQ(third.Released(), true);
  EXPECT_EQ(bed.Job(job).state, JobState::kSucceeded);
}

// What kills each worker before it can say a word does not do so for ever: kUncountedAttemptsMax.
TEST(DispatcherLoss, AJobThatKillsEveryWorkerAtOnceEnds) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 2);
  for (int attempt = 1; attempt <= 10; ++attempt) {
    FakeWorker worker(bed.dispatcher(), "w" + std::to_string(attempt));
    ASSERT_TRUE(worker.Take());
    worker.Leave();
    ASSERT_TRUE(bed.Becomes(job, attempt < 10 ? JobState::kQueued : JobState::kFailed)) << attempt;
  }
  EXPECT_EQ(bed.Job(job).attempts, 2);
  EXPECT_EQ(bed.Job(job).outcome->code, ErrorCode::kCellWorkerDied);
}

TEST(DispatcherLoss, AJobWithOneAttemptFailsAtOnce) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck("STOP\n", 1);
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  worker.BeginAndLeave();
  ASSERT_TRUE(bed.Becomes(job, JobState::kFailed));
  EXPECT_EQ(bed.Job(job).attempts, 1);
}

TEST(DispatcherBudget, AWorkerThatSendsTooMuchFailsItsJob) {
  DispatcherBed bed;
  bed.config.limit_output_bytes = 65'536;
  const std::int64_t fits = bed.server.SubmitCheck();
  const std::int64_t large = bed.server.SubmitCheck();
  const std::int64_t many = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  worker.Artifact("report", std::string(65'536, 'a'));
  worker.Finish();
  ASSERT_TRUE(bed.Becomes(fits, JobState::kSucceeded));
  ASSERT_TRUE(worker.Take());
  for (int i = 0; i < 20; ++i) worker.Artifact("report", std::string(65'536, 'a'));  // 1.25 MiB
  worker.Finish();
  ASSERT_TRUE(bed.Becomes(large, JobState::kFailed));
  EXPECT_EQ(bed.Job(large).outcome->code, ErrorCode::kCellOutputBudget);
  EXPECT_THAT(Must(bed.server.store().ListArtifacts(large)), testing::SizeIs(1));  // its program
  ASSERT_TRUE(worker.Take());
  for (int i = 0; i < 1500; ++i) worker.Artifact(std::to_string(i) + std::string(1024, 'n'), "");
  worker.Finish();
  ASSERT_TRUE(bed.Becomes(many, JobState::kFailed));
  EXPECT_EQ(bed.Job(many).outcome->code, ErrorCode::kCellOutputBudget);
}

TEST(DispatcherProgress, IsTheNewestAndEndsWithTheJob) {
  DispatcherBed bed;
  const std::int64_t job = bed.server.SubmitCheck();
  FakeWorker worker(bed.dispatcher(), "w");
  ASSERT_TRUE(worker.Take());
  for (int i = 1; i <= 100; ++i) worker.Position(i);
  v1::JobProgress progress;
  ASSERT_TRUE(Eventually([&] {
    const auto newest = bed.feed().LatestAfter(JobName(job), 0);
    return newest && progress.ParseFromString(*newest->bytes) && progress.virtual_time_ns() == 100;
  }));
  EXPECT_EQ(progress.job(), JobName(job));
  EXPECT_EQ(progress.attempt(), 1);
  worker.Finish();
  EXPECT_EQ(worker.Released(), true);
  EXPECT_TRUE(Eventually([&] { return !bed.feed().LatestAfter(JobName(job), 0); }));
}

// Workers come, work, die and come again while clients submit: every job ends once, as it should.
TEST(Dispatcher, EveryJobEndsOnceAmongWorkersThatDie) {
  constexpr int kJobs = 60;
  DispatcherBed bed;
  Dispatcher& dispatcher = bed.dispatcher();
  std::atomic<bool> stop = false;
  std::atomic<int> finished = 0;
  std::vector<std::jthread> threads;
  for (int number = 0; number < 4; ++number) {
    threads.emplace_back([&, number] {
      for (int life = 0; !stop; ++life) {
        FakeWorker worker(dispatcher, "w" + std::to_string(number) + "-" + std::to_string(life));
        while (!stop) {
          if (!worker.Take(milliseconds(20))) continue;
          worker.Position(1);
          worker.Events(2);
          // The first attempt at every fifth job kills its worker.
          if (worker.job() % 5 == 0 && worker.assignment().lease().attempt() == 1) break;
          worker.Finish();
          if (worker.Released() == true) ++finished;
        }
        worker.Leave();
      }
    });
  }
  std::vector<std::int64_t> jobs;
  for (int i = 0; i < kJobs; ++i) jobs.push_back(bed.server.SubmitCheck());
  for (const std::int64_t job : jobs) ASSERT_TRUE(bed.Becomes(job, JobState::kSucceeded)) << job;
  ASSERT_TRUE(Eventually([&] { return finished == kJobs; }));
  stop = true;
  threads.clear();
  for (const std::int64_t job : jobs) {
    EXPECT_EQ(bed.Job(job).attempts, job % 5 == 0 ? 2 : 1);
    int ends = 0;
    for (const v1::JobEvent& event : bed.Events(job)) ends += event.has_ended() ? 1 : 0;
    EXPECT_EQ(ends, 1);
  }
}

}  // namespace
}  // namespace rmlcell::server
