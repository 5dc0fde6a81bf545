// When exactly a server hands on, waits, gives up and takes over (live.md 2.10, 3.01 to 3.03).
#include <signal.h>
#include <sys/stat.h>

#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "server/base/names.h"
#include "server/base/restart_delay.h"
#include "server/machines/host_processes.h"
#include "server/machines/teach_book.h"
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class HostsBounds : public HostsTest {
 protected:
  // What nobody answers at once is "".
  std::string Ask(bool stop) {
    v1::HostOrder order;
    if (stop) order.mutable_stop();
    if (!stop) order.mutable_read_variables();
    auto told = std::make_shared<std::string>();
    hosts.Ask("mill-1", std::move(order), [told](const Result<v1::HostOrderAnswer>& answer) {
      *told = answer ? "answered" : answer.error().detail;
    });
    return *told;
  }
  static std::ptrdiff_t Count(const FakeLink& link, v1::HostResponse::MessageCase kind) {
    const auto all = link.All();
    return std::ranges::count(all, kind, &v1::HostResponse::message_case);
  }
  storage::JobState StateOf(std::int64_t job) { return Must(bed.store().GetJob(job)).state; }
};

// LIVE-2.10: 16 orders that halt are kept for a host whose line is gone, and not more.
TEST_F(HostsBounds, SixteenHaltsAreKept) {
  const auto first = Joined();
  hosts.Leave(*first);
  for (int order = 1; order <= 16; ++order)
    EXPECT_EQ(Ask(true), "not delivered: it acts if this host is heard of again") << order;
  EXPECT_EQ(Ask(true), "its host is not heard of");
  const auto again = Joined(Hello("elsewhere/1", Fence(*first)));
  EXPECT_EQ(Count(*again, v1::HostResponse::kOrder), 16);
}

// LIVE-2.10: for as long as its lease lasts, from the first of them on.
TEST_F(HostsBounds, HaltsAreKeptAsLongAsALease) {
  for (const auto& [later, handed] : {std::pair{milliseconds(0), 2}, {milliseconds(1), 0}}) {
    const auto first = Joined();
    hosts.Leave(*first);
    Ask(true);
    clock.Advance(seconds(10));
    Ask(true);
    clock.Advance(Hosts::kLease - seconds(10) + later);
    const auto again = Joined(Hello("elsewhere/1", Fence(*first)));
    EXPECT_EQ(Count(*again, v1::HostResponse::kOrder), handed) << later.count();
    hosts.Leave(*again);
  }
}

// The line of a host that said nothing for more than 5 s is closed.
TEST_F(HostsBounds, ASilentLineIsClosedBehindFiveSeconds) {
  const auto link = Joined();
  clock.Advance(seconds(5));
  hosts.Look();
  EXPECT_FALSE(link->closed());
  clock.Advance(milliseconds(1));
  hosts.Look();
  EXPECT_TRUE(link->closed());
}

// LIVE-3.03: what was given is taken within ten minutes, the last moment among them.
TEST_F(HostsBounds, WhatWasGivenLastsTenMinutes) {
  v1::HostHello other = Hello("office/2");
  other.set_computer("office");
  const auto first = Joined();
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  clock.Advance(Hosts::kGivenFor + milliseconds(1));
  v1::HostRequest renew;
  renew.mutable_renew()->set_fence(Fence(*first));
  hosts.Receive(*first, std::move(renew));
  first->Newest(v1::HostResponse::kRenewed);
  EXPECT_EQ(Refused(other), ErrorCode::kCellMachineTaken);
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  clock.Advance(Hosts::kGivenFor);
  v1::HostRequest again;
  again.mutable_renew()->set_fence(Fence(*first));
  hosts.Receive(*first, std::move(again));
  Settle();
  Joined(other);
  EXPECT_TRUE(first->closed());
}

// LIVE-3.25: a host of which nothing is stored is not told that something is, and what was the
// host's before it waits for its first words.
TEST_F(HostsBounds, NothingIsStoredOfAHostThatSaidNothing) {
  const std::int64_t job = RunGivenTo("before/1");
  const auto link = Joined();
  v1::HostRequest nothing;
  nothing.mutable_entries()->set_fence(Fence(*link));
  hosts.Receive(*link, nothing);
  Beat(*link);
  Settle();
  EXPECT_EQ(Count(*link, v1::HostResponse::kEntriesStored), 0);
  EXPECT_EQ(StateOf(job), storage::JobState::kRunning);
  hosts.Receive(*link, Entries(Fence(*link), 1, true));
  EXPECT_TRUE(Eventually([&] { return StateOf(job) == storage::JobState::kQueued; }));
  EXPECT_EQ(link->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 2);
}

// LIVE-3.05: what the store did not take is not told to be stored.
TEST_F(HostsBounds, WhatIsNotStoredIsNotToldSo) {
  const auto link = Joined();
  ASSERT_TRUE(bed.store().ReleaseMachine(Must(bed.store().MachineLeases()).front()));
  hosts.Receive(*link, Entries(Fence(*link), 1, true));
  EXPECT_EQ(link->Newest(v1::HostResponse::kLeaseLost)->lease_lost().fence(), Fence(*link));
  Settle();
  EXPECT_EQ(Count(*link, v1::HostResponse::kEntriesStored), 0);
}

// LIVE-3.30: of a machine that the store knows nothing of, the mark beside its host counts.
TEST_F(HostsBounds, TheMarkOfAJournalIsTheFirst) {
  v1::HostHello hello = Hello();
  v1::MachineMark& mark = *hello.mutable_journal_mark();
  mark.set_fence(3);
  mark.set_sequence(5);
  mark.set_virtual_time_ns(91);
  Joined(hello);
  ASSERT_EQ(Told().size(), 1U);
  EXPECT_EQ(Told()[0].recovered().mark_virtual_time_ns(), 91);
  EXPECT_EQ(Told()[0].recovered().mark_fence(), 3);
}

// LIVE-3.02: who has a machine that is off is gone when its lease stands unchanged for as long as
// it lasts and 5 s; it is looked at every 5 s.
TEST_F(HostsBounds, WhoHoldsAMachineThatIsOffIsGoneInTheEnd) {
  Must(bed.store().TakeMachine(
      {.machine = "mill-1", .host = "before/1", .server = "s", .duration = Hosts::kLease}));
  const std::int64_t job = RunGivenTo("before/1");
  const auto look = [&] {
    hosts.Look();
    Settle();
    return StateOf(job);
  };
  hosts.NoteOff("mill-1", "its host ended 5 times");
  Settle();
  clock.Advance(Hosts::kLease);
  EXPECT_EQ(look(), storage::JobState::kRunning);
  clock.Advance(milliseconds(4'999));
  EXPECT_EQ(look(), storage::JobState::kRunning);
  clock.Advance(milliseconds(1));
  EXPECT_EQ(look(), storage::JobState::kInterrupted);
}

// LIVE-7.09: of a program that was not there before, or is not any more, there is no etag.
TEST_F(HostsBounds, WhatWasNotThereHasNoEtag) {
  TeachBook book(bed.store());
  v1::TeachEntry entry;
  entry.mutable_step()->set_program(12);
  const v1::TeachEntry made = Must(book.Add("optimo-1", entry, 0, 1));
  EXPECT_EQ(made.etag_before(), "");
  EXPECT_EQ(made.etag_after(), "1");
  const v1::TeachEntry removed = Must(book.Add("optimo-1", entry, 1, 0));
  EXPECT_EQ(removed.etag_before(), "1");
  EXPECT_EQ(removed.etag_after(), "");
}

// LIVE-5.03: whatever begins a run, or looks at one, goes out behind what was stored before; what
// halts and what asks waits for no store.
TEST_F(HostsBounds, WhatBeginsARunWaitsForWhatIsStored) {
  const auto link = Joined();
  Settle();
  std::promise<void> goes_on;
  const std::shared_future<void> wait = goes_on.get_future().share();
  for (int thread = 0; thread < kThreads; ++thread) executor->Post([wait] { wait.wait(); });
  Ask(true);
  EXPECT_EQ(Count(*link, v1::HostResponse::kOrder), 1);
  Ask(false);
  EXPECT_EQ(Count(*link, v1::HostResponse::kOrder), 2);
  std::vector<v1::HostOrder> begin(6);
  begin[0].mutable_start();
  begin[1].mutable_zero();
  begin[2].mutable_preview_start();
  begin[3].mutable_start_at_step();
  begin[4].mutable_run_job();
  begin[5].mutable_continue_job();
  for (const v1::HostOrder& order : begin) {
    hosts.Ask("mill-1", order, [](const Result<v1::HostOrderAnswer>&) {});
    EXPECT_EQ(Count(*link, v1::HostResponse::kOrder), 2) << order.request_case();
  }
  goes_on.set_value();
  Settle();
  EXPECT_EQ(Count(*link, v1::HostResponse::kOrder), 8);
}

// What a machine tells, and that it was changed itself, is nothing that its host has in its memory.
TEST_F(HostsBounds, OnlyWhatIsInItsMemoryIsSent) {
  const auto link = Joined();
  hosts.Receive(*link, Entries(Fence(*link), 1, true));
  link->Newest(v1::HostResponse::kEntriesStored);
  const storage::MachineRecord mill = Must(bed.store().GetMachine("mill-1"));
  Must(bed.store().PutMachine(mill, mill.revision, "anna"));
  v1::HostOrder order;
  order.mutable_start();
  hosts.Ask("mill-1", order, [](const Result<v1::HostOrderAnswer>&) {});
  link->Newest(v1::HostResponse::kOrder);
  Settle();
  EXPECT_EQ(Count(*link, v1::HostResponse::kMemory), 1);  // with its welcome
}

// What was stored while nobody had the machine comes with the welcome, and not again with the next
// event.
TEST_F(HostsBounds, WhatWasStoredBeforeItJoinedIsSentOnce) {
  Must(bed.store().PutPrograms("mill-1", {{.slot = 5, .object = "PA;"}}, {}, "anna"));
  const std::int64_t stored = Must(bed.store().LastPosition());
  ASSERT_TRUE(Eventually([&] { return feed.position() == stored; }));
  const auto link = Joined();
  EXPECT_EQ(link->Newest(v1::HostResponse::kMemory)->memory().programs_size(), 1);
  hosts.Receive(*link, Entries(Fence(*link), 1, true));
  link->Newest(v1::HostResponse::kEntriesStored);
  Settle();
  EXPECT_EQ(Count(*link, v1::HostResponse::kMemory), 1);
}

// LIVE-3.02: a line that has another one behind it says nothing any more.
TEST_F(HostsBounds, ALineThatWasFollowedSaysNothing) {
  const auto first = Joined();
  const auto again = Joined(Hello("elsewhere/1", Fence(*first)));
  EXPECT_TRUE(first->closed());
  Tell(*first, v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_STARTING);
  Tell(*again, v1::MACHINE_STATE_IDLE);
  hosts.Leave(*first);
  EXPECT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_IDLE);
  hosts.End("optimo-1", "nobody is there");  // who has no host hears nothing
  EXPECT_EQ(Count(*again, v1::HostResponse::kStop), 0);
  hosts.End("mill-1", "a test");
  EXPECT_EQ(again->Newest(v1::HostResponse::kStop)->stop().reason(), "a test");
}

// LIVE-3.03, LIVE-3.30: that somebody gave it away, whose it was and where it stands is told by the
// fence of who has it now, at the time of its mark.
TEST_F(HostsBounds, WhatIsToldOfANewHostIsOfItsFence) {
  const auto first = Joined();
  hosts.Receive(*first, Entries(Fence(*first), 1, false));
  first->Newest(v1::HostResponse::kEntriesStored);
  v1::HostHello hello = Hello("office/2");
  hello.set_computer("office");
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  const auto second = Joined(hello);
  ASSERT_GT(Fence(*second), Fence(*first));
  const std::vector<v1::MachineEvent> told = Told();
  ASSERT_EQ(told.size(), 4U);
  EXPECT_EQ(told[1].run().message().text(), "taken by anna: moved");
  EXPECT_EQ(told[2].host_lost().host(), "elsewhere/1");
  EXPECT_EQ(told[2].host_lost().fence(), Fence(*first));
  EXPECT_EQ(told[3].recovered().mark_fence(), Fence(*first));
  for (std::size_t i = 1; i < told.size(); ++i) {
    EXPECT_EQ(told[i].fence(), Fence(*second)) << i;
    EXPECT_EQ(told[i].virtual_time_ns(), 77) << i;
  }
}

// LIVE-2.03: a machine that has a host is not off, whatever was before; one that is forgotten is
// free at once.
TEST_F(HostsBounds, AHostIsAllThatAMachineNeeds) {
  hosts.NoteOff("mill-1", "its host ended 5 times");
  Settle();
  ASSERT_TRUE(hosts.WhyOff("mill-1"));
  Joined();
  EXPECT_FALSE(hosts.WhyOff("mill-1"));
  EXPECT_EQ(Must(bed.store().MachineLeases()).size(), 1U);
  hosts.Forget("mill-1");
  EXPECT_TRUE(Must(bed.store().MachineLeases()).empty());
  const storage::MachineRecord mill = Must(bed.store().GetMachine("mill-1"));
  EXPECT_EQ(StatusOf(&hosts, mill, {}).state(), v1::MACHINE_STATE_IDLE);
}

// LIVE-2.10, LIVE-3.17: whoever watches sees how many jobs there are, and that the line is gone.
TEST_F(HostsBounds, AMachineWhoseLineIsGoneIsShownAsLost) {
  const auto link = Joined();
  RunGivenTo("elsewhere/1");
  const auto shown = [this] {
    v1::MachineStatus status;
    const auto latest = feed.LatestAfter("machines/mill-1", 0);
    static_cast<void>(status.ParseFromString(latest ? *latest->bytes : std::string()));
    return status;
  };
  Tell(*link, v1::MACHINE_STATE_RUNNING);
  ASSERT_TRUE(Eventually([&] { return shown().state() == v1::MACHINE_STATE_RUNNING; }));
  EXPECT_EQ(shown().jobs_active(), 1);
  EXPECT_EQ(hosts.StatusOf("mill-1")->jobs_active(), 1);
  hosts.Leave(*link);
  EXPECT_TRUE(Eventually([&] { return shown().state() == v1::MACHINE_STATE_LOST; }));
}

// An order that nobody answers is given up after 10 s, though its host says nothing at all.
TEST_F(HostsBounds, AnOrderIsGivenUpByALook) {
  const auto link = Joined();
  std::string told;
  v1::HostOrder order;
  order.mutable_read_variables();
  hosts.Ask("mill-1", std::move(order), [&told](const Result<v1::HostOrderAnswer>& answer) {
    told = answer ? "answered" : answer.error().detail;
  });
  clock.Advance(Hosts::kAnswerPatience - milliseconds(1));
  hosts.Look();
  EXPECT_EQ(told, "");
  clock.Advance(milliseconds(1));
  hosts.Look();
  EXPECT_EQ(told, "its host does not answer");
}

// LIVE-5.20: whoever asks what a host knows waits until all is stored that it told, and its line
// stands.
TEST_F(HostsBounds, AHostIsSettledWhenWhatItToldIsStored) {
  const auto link = Joined();
  const std::int64_t fence = Fence(*link);
  EXPECT_FALSE(hosts.IsSettled("mill-1"));
  for (const std::int64_t first : {1, 3}) {
    std::promise<void> goes_on;
    const std::shared_future<void> wait = goes_on.get_future().share();
    for (int thread = 0; thread < kThreads; ++thread) executor->Post([wait] { wait.wait(); });
    hosts.Receive(*link, Entries(fence, first, true));
    EXPECT_FALSE(hosts.IsSettled("mill-1")) << first;
    goes_on.set_value();
    Settle();
    EXPECT_TRUE(hosts.IsSettled("mill-1")) << first;
  }
  hosts.Leave(*link);
  EXPECT_FALSE(hosts.IsSettled("mill-1"));
}

// Knows why it was closed.
class ClosedLink final : public HostLink {
 public:
  void Send(v1::HostResponse /*message*/) override {}
  void Close(const Error& reason) override { why = reason; }
  std::optional<Error> why;
};

// A server that stops may be tried again, or another one.
TEST_F(HostsBounds, AServerThatStopsSaysSoToItsHosts) {
  const auto link = std::make_shared<ClosedLink>();
  ASSERT_TRUE(hosts.Join(link, Hello()));
  hosts.CloseAll();
  ASSERT_TRUE(link->why);
  EXPECT_EQ(link->why->code, ErrorCode::kCellUnavailable);
  EXPECT_EQ(link->why->detail, "the server stops");
}

// Shell scripts in place of hosts.
class ProcessBounds : public testing::Test {
 protected:
  HostProcesses::Options Options(const std::string& what) {
    const std::string path = folder_.File("host");
    std::ofstream(path) << "#!/bin/sh\necho $$ >> " << folder_.File("lives") << "\n"
                        << what << "\n";
    ::chmod(path.c_str(), 0700);
    return {.program = path,
            .server = "127.0.0.1:1",
            .join_token = "secret",
            .journals = folder_.File("journals"),
            .log_level = "info",
            .log_format = "json",
            .gave_up = [this](const std::string&, const std::string&) { gave_up_ = true; },
            .clock = steady_.clock()};
  }
  std::vector<pid_t> Lives() {
    std::ifstream file(folder_.File("lives"));
    std::vector<pid_t> lives;
    for (pid_t process = 0; file >> process;) lives.push_back(process);
    return lives;
  }
  // One that is started has its log before that returns.
  bool IsStarted(const std::string& machine) {
    return std::filesystem::exists(folder_.File("journals") + "/" + machine + ".log");
  }
  // So many have lived, and their ends were noticed.
  bool Die(std::size_t count) {
    return Eventually([&] { return Lives().size() >= count; }) &&
           Eventually([&] { return ::kill(Lives()[count - 1], 0) != 0; });
  }

  TestSteadyClock steady_;
  storage::TestDirectory folder_;
  std::atomic<bool> gave_up_ = false;
};

// LIVE-3.01: five within 60 s, the last moment of them among these.
TEST_F(ProcessBounds, FiveDeathsWithinAMinuteAreEnough) {
  HostProcesses processes(Options("exit 4"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  for (std::size_t death = 1; death <= 4; ++death) {
    ASSERT_TRUE(Die(death));
    steady_.Advance(seconds(15));
  }
  ASSERT_TRUE(Die(5));
  EXPECT_TRUE(Eventually([&] { return gave_up_.load(); }));
}

TEST_F(ProcessBounds, FiveDeathsInMoreThanAMinuteAreNot) {
  HostProcesses processes(Options("exit 4"));
  ASSERT_TRUE(processes.Enable("mill-1"));
  for (std::size_t death = 1; death <= 5; ++death) {
    ASSERT_TRUE(Die(death));
    steady_.Advance(death == 1 ? milliseconds(15'001) : milliseconds(15'000));
  }
  EXPECT_TRUE(Die(6));
}

// So that those that are there go on undisturbed: four in one round.
TEST_F(ProcessBounds, FourBeginAtOnce) {
  std::mutex mutex;
  std::condition_variable changed;
  bool lives = false;
  int looks = 0;  // since one lives
  bool goes_on = false;
  HostProcesses::Options options = Options("exec sleep 60");
  options.look = [&] {
    std::unique_lock lock(mutex);
    // The round of the first look may have begun before that one was started in it.
    if (!lives || ++looks < 2) return;
    changed.notify_all();
    changed.wait(lock, [&] { return goes_on; });
  };
  HostProcesses processes(std::move(options));
  ASSERT_TRUE(processes.Enable("a"));
  {
    std::unique_lock lock(mutex);
    lives = true;
    changed.wait(lock, [&] { return looks >= 2; });
  }
  for (const char* machine : {"b", "c", "d", "e", "f"}) ASSERT_TRUE(processes.Enable(machine));
  EXPECT_TRUE(IsStarted("b"));
  EXPECT_TRUE(IsStarted("e"));
  EXPECT_FALSE(IsStarted("f"));
  {
    const std::lock_guard lock(mutex);
    goes_on = true;
    changed.notify_all();
  }
  EXPECT_TRUE(Eventually([&] { return Lives().size() == 6; }));
  for (const pid_t process : Lives()) ::kill(process, SIGKILL);
}

}  // namespace
}  // namespace rmlcell::server
