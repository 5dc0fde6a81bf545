// Calls of the store that fail while hosts join, tell and are given up, and while somebody teaches:
// each is handed on, and nothing is half done (live.md 3.02, 5.08, 7.09).
#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <utility>
#include <vector>

#include "server/machines/host_entries.h"
#include "server/machines/teach_book.h"
#include "tests/server/engine_bytes.h"
#include "tests/server/failing_store.h"
#include "tests/server/machines/hosts_bed.h"
#include "tests/storage/quiet_process.h"

namespace rmlcell::server {
namespace {

using std::chrono::seconds;

enum class Call {
  kNone,
  kMachine,
  kMark,
  kAppend,
  kTake,
  kTakeOver,
  kLeases,
  kJobs,
  kJob,
  kEvents,
  kRenew
};

// Of which one kind of call fails, as long as it is told so. Thread-safe.
class StoreWithoutACall final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::atomic<Call> fails = Call::kNone;
  std::function<void()> before_append;  // once
  std::atomic<int> releases = 0;        // asked for

  Result<storage::MachineRecord> GetMachine(std::string_view id) override {
    if (fails == Call::kMachine) return Away();
    return store_.GetMachine(id);
  }
  Result<std::optional<storage::MachineMark>> GetMachineMark(std::string_view machine) override {
    if (fails == Call::kMark) return Away();
    return store_.GetMachineMark(machine);
  }
  Status AppendMachine(const storage::MachineLease& lease,
                       const storage::MachineWrite& write) override {
    if (const auto act = std::exchange(before_append, {})) act();
    if (fails == Call::kAppend) return Away();
    return store_.AppendMachine(lease, write);
  }
  Result<storage::MachineLease> TakeMachine(const storage::MachineClaim& claim) override {
    if (fails == Call::kTake || (fails == Call::kTakeOver && claim.seen)) return Away();
    return store_.TakeMachine(claim);
  }
  Result<storage::MachineLease> RenewMachine(const storage::MachineLease& lease,
                                             std::string_view server) override {
    if (fails == Call::kRenew) return Away();
    return store_.RenewMachine(lease, server);
  }
  Status ReleaseMachine(const storage::MachineLease& lease) override {
    ++releases;
    return store_.ReleaseMachine(lease);
  }
  Result<std::vector<storage::MachineLease>> MachineLeases() override {
    if (fails == Call::kLeases) return Away();
    return store_.MachineLeases();
  }
  Result<std::vector<storage::JobRecord>> ListJobs(const storage::JobQuery& query) override {
    if (fails == Call::kJobs) return Away();
    return store_.ListJobs(query);
  }
  Result<storage::JobRecord> GetJob(std::int64_t id) override {
    if (fails == Call::kJob) return Away();
    return store_.GetJob(id);
  }
  Result<std::vector<storage::EventRecord>> AllEvents(std::int64_t after, int limit) override {
    if (fails == Call::kEvents) return Away();
    return store_.AllEvents(after, limit);
  }

 private:
  static Error Away() { return {ErrorCode::kCellStoreFailed, "the line broke", {}}; }
};

class CallsThatFail : public HostsTest {
 protected:
  void TearDown() override {
    troubled.OnChange({});
    troubled.CloseAll();
    HostsTest::TearDown();
  }
  std::optional<ErrorCode> Join() {
    return CodeOf(troubled.Join(std::make_shared<FakeLink>(), Hello()));
  }
  storage::MachineLease TakenBy(const std::string& host, const std::string& machine = "mill-1") {
    return Must(bed.store().TakeMachine(
        {.machine = machine, .host = host, .server = "s", .duration = Hosts::kLease}));
  }
  // A job of the mill that this host was given.
  std::int64_t JobOf(const std::string& host) {
    const std::int64_t job =
        Must(bed.store().SubmitAndWait({.machine = "mill-1", .kind = "RUN", .attempts_max = 1}))
            .job.id;
    Must(bed.store().AcquireJobs(
        {.worker = host, .kinds = {"RUN"}, .duration = std::chrono::hours(1)}));
    return job;
  }
  storage::JobState StateOf(std::int64_t job) { return Must(bed.store().GetJob(job)).state; }
  // What a host told is waited for as long as kAnswerPatience, by no clock of the test: a trial
  // that took longer shows nothing, and is made again. It returns what it is judged by.
  void JudgeInTime(const std::function<std::function<void()>()>& trial) {
    for (int left = 5;; --left) {
      const auto begun = std::chrono::steady_clock::now();
      const std::function<void()> judge = trial();
      const bool in_time = std::chrono::steady_clock::now() - begun < Hosts::kAnswerPatience;
      if (in_time || left == 0) return judge();
    }
  }

  StoreWithoutACall store{bed.store()};
  Hosts troubled{{.store = store,
                  .feed = feed,
                  .executor = *executor,
                  .server = "this server",
                  .join_token = "secret",
                  .clock = clock.clock()}};
};

// Behind one that was in the middle of a run there is something to be told.
TEST_F(CallsThatFail, AHostThatJoinsIsToldOfTrouble) {
  const storage::MachineLease before = TakenBy("before/1");
  Must(bed.store().AppendMachine(
      before, {.mark = storage::MachineMark{.sequence = 1, .state = "in a run", .clean = false}}));
  Must(bed.store().ReleaseMachine(before));
  for (const Call call : {Call::kTake, Call::kMachine, Call::kMark, Call::kAppend}) {
    store.fails = call;
    EXPECT_EQ(Join(), ErrorCode::kCellStoreFailed) << static_cast<int>(call);
    EXPECT_FALSE(troubled.IsHosted("mill-1")) << static_cast<int>(call);
  }
  store.fails = Call::kNone;
  EXPECT_EQ(Join(), std::nullopt);
  EXPECT_TRUE(troubled.IsHosted("mill-1"));
}

// LIVE-3.02
TEST_F(CallsThatFail, AHostThatFollowsAnotherIsToldOfTrouble) {
  TakenBy("elsewhere/9");
  store.fails = Call::kLeases;
  EXPECT_EQ(Join(), ErrorCode::kCellStoreFailed);
  store.fails = Call::kNone;
  EXPECT_EQ(Join(), ErrorCode::kCellMachineTaken);
  clock.Advance(Hosts::kLease + seconds(5));
  store.fails = Call::kTakeOver;
  EXPECT_EQ(Join(), ErrorCode::kCellStoreFailed);
  store.fails = Call::kNone;
  EXPECT_EQ(Join(), std::nullopt);
}

// LIVE-3.02: who has another machine is nobody's matter here.
TEST_F(CallsThatFail, WhoHasAnotherMachineIsNotLookedAt) {
  TakenBy("elsewhere/8", "optimo-1");
  TakenBy("elsewhere/9");
  EXPECT_EQ(Join(), ErrorCode::kCellMachineTaken);
  clock.Advance(Hosts::kLease + seconds(5));
  EXPECT_EQ(Join(), std::nullopt);
}

// LIVE-5.08: until the jobs of a machine that is off are cut off nothing of it has changed, and
// they are looked at again.
TEST_F(CallsThatFail, AMachineThatIsOffIsLookedAtAgain) {
  std::atomic<int> changes = 0;
  troubled.OnChange([&changes] { ++changes; });
  const std::int64_t job = JobOf("elsewhere/9");
  store.fails = Call::kLeases;
  troubled.NoteOff("mill-1", "its host ended 5 times");
  Settle();
  EXPECT_EQ(changes, 1);
  const auto look = [&](Call call) {
    store.fails = call;
    clock.Advance(seconds(5));
    troubled.Look();
    Settle();
    return changes.load();
  };
  for (const Call call : {Call::kLeases, Call::kTake, Call::kJobs}) {
    EXPECT_EQ(look(call), 1) << static_cast<int>(call);
    EXPECT_EQ(StateOf(job), storage::JobState::kRunning) << static_cast<int>(call);
  }
  EXPECT_EQ(look(Call::kNone), 2);
  EXPECT_EQ(StateOf(job), storage::JobState::kInterrupted);
  EXPECT_EQ(look(Call::kNone), 2);
  troubled.OnChange({});
}

// LIVE-5.08, LIVE-5.20
TEST_F(CallsThatFail, TroubleWithJobsOfAHostIsHandedOn) {
  const std::int64_t job = JobOf("hall/1");
  for (const Call call : {Call::kJobs, Call::kMark}) {
    store.fails = call;
    EXPECT_EQ(CodeOf(EndWithoutHost(store, "mill-1")), ErrorCode::kCellStoreFailed)
        << static_cast<int>(call);
  }
  for (const Call call : {Call::kJobs, Call::kJob}) {
    store.fails = call;
    EXPECT_EQ(CodeOf(GiveBackUnbegun(store, "mill-1", "hall/2", "")), ErrorCode::kCellStoreFailed)
        << static_cast<int>(call);
  }
  EXPECT_EQ(StateOf(job), storage::JobState::kRunning);
  store.fails = Call::kNone;
  EXPECT_EQ(CodeOf(GiveBackUnbegun(store, "mill-1", "hall/2", "")), std::nullopt);
  EXPECT_EQ(StateOf(job), storage::JobState::kQueued);
}

// What was told before it is stored, and nothing of it.
TEST_F(CallsThatFail, AnEntryOfWhatIsNoJobIsNotStored) {
  const storage::MachineLease lease = TakenBy("hall/1");
  std::vector<v1::JournalEntry> entries(2);
  for (std::int64_t number : {1, 2}) {
    v1::JournalEntry& entry = entries[static_cast<std::size_t>(number - 1)];
    entry.set_sequence(number);
    entry.set_fence(lease.fence);
    entry.mutable_run_begun()->set_run(number);
  }
  entries.back().set_job("machines/mill-1");
  const StoredEntries stored = StoreEntries(bed.store(), lease, entries);
  EXPECT_EQ(CodeOf(stored.how), ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(stored.count, 1U);
  EXPECT_EQ(Told().size(), 1U);
}

// LIVE-5.03: where it is not known what has changed, the host is sent all of its memory before what
// it is to begin.
TEST_F(CallsThatFail, WhereEventsAreGoneAllOfTheMemoryIsSent) {
  const auto link = std::make_shared<FakeLink>();
  ASSERT_TRUE(troubled.Join(link, Hello()));
  Must(bed.store().PutPrograms("mill-1", {{.slot = 5, .object = "PA;"}}, {}, "anna"));
  ASSERT_TRUE(Eventually(
      [&] { return link->Newest(v1::HostResponse::kMemory)->memory().programs_size() == 1; }));
  Settle();
  const auto sent = [&link](v1::HostResponse::MessageCase kind) {
    const auto all = link->All();
    return std::ranges::count(all, kind, &v1::HostResponse::message_case);
  };
  const auto before = sent(v1::HostResponse::kMemory);
  store.fails = Call::kEvents;
  v1::HostOrder order;
  order.mutable_start()->set_program(5);
  troubled.Ask("mill-1", order, [](const Result<v1::HostOrderAnswer>&) {});
  EXPECT_TRUE(link->Newest(v1::HostResponse::kOrder));
  EXPECT_EQ(sent(v1::HostResponse::kMemory), before + 1);
  EXPECT_TRUE(link->All().back().has_order());
}

// LIVE-3.25: what the store did not take is tried again when its host is heard; trouble of the
// store takes no machine away.
TEST_F(CallsThatFail, WhatWasNotStoredIsStoredWithTheNextHeartbeat) {
  const auto link = std::make_shared<FakeLink>();
  ASSERT_TRUE(troubled.Join(link, Hello()));
  store.fails = Call::kAppend;
  troubled.Receive(*link, Entries(Fence(*link), 1, true));
  Settle();
  store.fails = Call::kNone;
  EXPECT_TRUE(Told().empty());
  for (const v1::HostResponse& message : link->All()) {
    EXPECT_FALSE(message.has_entries_stored());
    EXPECT_FALSE(message.has_lease_lost());
  }
  v1::HostRequest beat;
  beat.mutable_heartbeat()->set_number(1);
  troubled.Receive(*link, beat);
  const auto stored = link->Newest(v1::HostResponse::kEntriesStored);
  EXPECT_EQ(stored->entries_stored().sequence(), 2);
  EXPECT_EQ(stored->entries_stored().fence(), Fence(*link));
  EXPECT_EQ(Told().size(), 1U);
}

// LIVE-3.04: nor does it where a lease cannot be renewed now.
TEST_F(CallsThatFail, ALeaseThatCannotBeRenewedNowIsNotLost) {
  const auto link = std::make_shared<FakeLink>();
  ASSERT_TRUE(troubled.Join(link, Hello()));
  v1::HostRequest renew;
  renew.mutable_renew()->set_fence(Fence(*link));
  store.fails = Call::kRenew;
  troubled.Receive(*link, renew);
  Settle();
  for (const v1::HostResponse& message : link->All()) {
    EXPECT_FALSE(message.has_renewed());
    EXPECT_FALSE(message.has_lease_lost());
  }
  store.fails = Call::kNone;
  troubled.Receive(*link, renew);
  EXPECT_EQ(link->Newest(v1::HostResponse::kRenewed)->renewed().fence(), Fence(*link));
}

// LIVE-5.09: a machine that is given back is free behind what its host told last, and not before.
TEST_F(CallsThatFail, AMachineIsGivenBackBehindWhatWasTold) {
  JudgeInTime([this]() -> std::function<void()> {
    const auto link = std::make_shared<FakeLink>();
    EXPECT_TRUE(troubled.Join(link, Hello()));
    const std::size_t told = Told().size();
    const int releases = store.releases;
    std::promise<void> begins;
    std::promise<void> goes_on;
    store.before_append = [&] {
      begins.set_value();
      goes_on.get_future().wait();
    };
    troubled.Receive(*link, Entries(Fence(*link), 1, true));
    begins.get_future().wait();
    v1::HostRequest back;
    back.mutable_hand_back()->set_fence(Fence(*link));
    troubled.Receive(*link, back);
    // One thread stores, and the other waits for that: nobody is left to do anything else.
    std::promise<void> behind;
    executor->Post([&behind] { behind.set_value(); });
    EXPECT_TRUE(ComesToRest());
    const std::future_status done = behind.get_future().wait_for(seconds(0));
    const int released = store.releases - releases;
    goes_on.set_value();
    Settle();
    return [this, told, done, released] {
      EXPECT_EQ(done, std::future_status::timeout);
      EXPECT_EQ(released, 0);
      EXPECT_EQ(Told().size(), told + 1);
      EXPECT_TRUE(Must(bed.store().MachineLeases()).empty());
    };
  });
}

// LIVE-5.09: what it told meanwhile is stored, too, though its line has ended by then.
TEST_F(CallsThatFail, WhatWasToldBeforeItWasGivenBackIsStored) {
  JudgeInTime([this]() -> std::function<void()> {
    const auto link = std::make_shared<FakeLink>();
    EXPECT_TRUE(troubled.Join(link, Hello()));
    const std::size_t before = Told().size();
    std::promise<void> begins;
    std::promise<void> goes_on;
    store.before_append = [&] {
      begins.set_value();
      goes_on.get_future().wait();
    };
    troubled.Receive(*link, Entries(Fence(*link), 1, true));
    begins.get_future().wait();
    troubled.Receive(*link, Entries(Fence(*link), 3, true));
    v1::HostRequest back;
    back.mutable_hand_back()->set_fence(Fence(*link));
    troubled.Receive(*link, back);
    troubled.Leave(*link);
    goes_on.set_value();
    EXPECT_TRUE(Eventually([&] { return Must(bed.store().MachineLeases()).empty(); }));
    const std::size_t told = Told().size() - before;
    Settle();  // of a trial that is made again nothing is under way
    return [told] { EXPECT_EQ(told, 2U); };
  });
}

// LIVE-3.25: the next line of a host begins behind what was being stored when it came, and of the
// line before nothing is stored any more.
TEST_F(CallsThatFail, TheNextLineBeginsBehindWhatIsBeingStored) {
  JudgeInTime([this]() -> std::function<void()> {
    const auto first = std::make_shared<FakeLink>();
    const auto again = std::make_shared<FakeLink>();
    EXPECT_TRUE(troubled.Join(first, Hello()));
    const std::int64_t fence = Fence(*first);
    const std::size_t before = Told().size();
    std::future<Status> joined;
    store.before_append = [&] {
      troubled.Receive(*first, Entries(fence, 3, true));  // it waits for what is being stored
      joined = std::async(std::launch::async,
                          [&] { return troubled.Join(again, Hello("elsewhere/1", fence)); });
      EXPECT_TRUE(Eventually([&] { return !troubled.IsHeard("mill-1"); }));
      EXPECT_TRUE(ComesToRest());
    };
    troubled.Receive(*first, Entries(fence, 1, true));
    Settle();
    EXPECT_TRUE(joined.valid() && joined.get());
    for (const std::int64_t sequence : {1, 3})
      troubled.Receive(*again, Entries(fence, sequence, true));
    EXPECT_TRUE(Eventually([&] {
      return again->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence() == 4;
    }));
    Settle();
    const std::size_t told = Told().size() - before;
    v1::HostRequest back;
    back.mutable_hand_back()->set_fence(fence);
    troubled.Receive(*again, back);
    troubled.Leave(*again);
    EXPECT_TRUE(Eventually([&] { return Must(bed.store().MachineLeases()).empty(); }));
    Settle();  // of a trial that is made again nothing is under way
    return [told] { EXPECT_EQ(told, 2U); };
  });
}

// LIVE-3.05: what has nothing for the store is no reason to find that the lease is lost.
TEST_F(CallsThatFail, WhatHasNothingForTheStoreIsTaken) {
  const storage::MachineLease lease = TakenBy("hall/1");
  ASSERT_TRUE(bed.store().ReleaseMachine(lease));
  std::vector<v1::JournalEntry> entries(1);
  entries[0].set_sequence(1);
  entries[0].set_fence(lease.fence);
  entries[0].mutable_intent()->set_caller("anna");
  StoredEntries stored = StoreEntries(bed.store(), lease, entries);
  EXPECT_EQ(CodeOf(stored.how), std::nullopt);
  EXPECT_EQ(stored.count, 1U);
  entries[0].mutable_mark()->set_state("where it stands");
  stored = StoreEntries(bed.store(), lease, entries);
  EXPECT_EQ(CodeOf(stored.how), ErrorCode::kCellLeaseLost);
  EXPECT_EQ(stored.count, 0U);
}

// Of which the n-th call fails, those of teaching among them.
class TeachingStore final : public FailingStore {
 public:
  using FailingStore::FailingStore;
  Result<std::int64_t> AddTeachRecord(const storage::TeachRecord& record) override {
    return Or([&] { return store_.AddTeachRecord(record); });
  }
  Result<std::vector<storage::TeachRecord>> ListTeachRecords(std::string_view machine, int program,
                                                             std::int64_t before,
                                                             int limit) override {
    return Or([&] { return store_.ListTeachRecords(machine, program, before, limit); });
  }
};

class TeachingThatFails : public testing::Test {
 protected:
  // The object in slot 12, as it is after this act.
  void Teach(v1::TeachEntry::Act act, const std::string& text, const std::string& after) {
    const auto before = bed.store().GetProgram("optimo-1", 12);
    const storage::Revision from = before ? before->revision : 0;
    const auto put = Must(bed.store().PutPrograms(
        "optimo-1", {{.slot = 12, .object = ObjectOf(text), .expected = from}}, {}));
    v1::TeachEntry entry;
    entry.mutable_step()->set_program(12);
    entry.set_act(act);
    entry.set_after(after);
    Must(book.Add("optimo-1", entry, from, put.front().revision));
  }
  std::optional<ErrorCode> TakeBack(std::int64_t down_to, int failing) {
    v1::UndoTeachEntriesRequest request;
    request.set_program("machines/optimo-1/programs/12");
    request.set_down_to(down_to);
    store.FailAt(failing);
    const auto undone = book.TakeBack(request, "anna");
    store.FailAt(0);
    return CodeOf(undone);
  }
  std::string Object() {
    const auto program = bed.store().GetProgram("optimo-1", 12);
    return program ? program->object : "";
  }

  ServerBed bed;
  TeachingStore store{bed.store()};
  TeachBook book{store};
};

TEST_F(TeachingThatFails, TroubleWithAListIsHandedOn) {
  v1::ListTeachEntriesRequest request;
  request.set_machine("machines/optimo-1");
  ExpectFailuresHandedOn(store, "list", 1, [&] { return CodeOf(book.List(request)); });
}

// LIVE-7.09: of the machine, the program, what was taught, the change itself.
TEST_F(TeachingThatFails, NothingIsTakenBackByHalves) {
  Teach(v1::TeachEntry::ACT_CREATE, "DELAY 9.0\n", "DELAY 9.0");
  const std::string made = Object();
  for (int call = 1; call <= 4; ++call) {
    EXPECT_EQ(TakeBack(1, call), ErrorCode::kCellStoreFailed) << call;
    EXPECT_EQ(Object(), made) << call;
  }
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 9.0\n", "DELAY 1.0");
  const std::string longer = Object();
  for (int call = 1; call <= 4; ++call) {
    EXPECT_EQ(TakeBack(2, call), ErrorCode::kCellStoreFailed) << call;
    EXPECT_EQ(Object(), longer) << call;
  }
  EXPECT_EQ(TakeBack(1, 5), ErrorCode::kCellStoreFailed) << "that it was taken back is not kept";
  EXPECT_EQ(Object(), "");
}

TEST_F(TeachingThatFails, OfAProgramThatNobodyTaughtThereIsNothing) {
  EXPECT_EQ(TakeBack(1, 0), ErrorCode::kCellNotFound);
}

// LIVE-7.09: the step that was taught is not there, though nobody stored the program since.
TEST_F(TeachingThatFails, AStepThatIsAnotherOneIsNotTakenBack) {
  Teach(v1::TeachEntry::ACT_INSERT, "DELAY 1.0\nDELAY 9.0\n", "DELAY 5.0");
  const std::string stands = Object();
  EXPECT_EQ(TakeBack(1, 0), ErrorCode::kCellEtagMismatch);
  EXPECT_EQ(Object(), stands);
}

}  // namespace
}  // namespace rmlcell::server
