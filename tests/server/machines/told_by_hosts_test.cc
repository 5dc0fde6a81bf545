// What a server says to a host, makes of what it tells, and tells others of it (live.md 2.10, 3.02,
// 3.06, 3.17, 3.25).
#include <string>
#include <utility>
#include <vector>

#include "server/base/names.h"
#include "server/base/this_computer.h"
#include "server/machines/host_entries.h"
#include "server/machines/host_words.h"
#include "server/records/job_messages.h"
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

class ToldByHosts : public HostsTest {
 protected:
  void TearDown() override {
    hosts.OnChange({});
    hosts.OnNews({});
    hosts.OnRunOver({});
    HostsTest::TearDown();
  }
  v1::MachineState StateAfter(milliseconds time) {
    clock.Advance(time);
    hosts.Look();
    return hosts.StatusOf("mill-1")->state();
  }

  std::vector<std::string> news;
  std::atomic<int> changes = 0;
  std::atomic<int> over = 0;
};

// LIVE-3.07: all that a host must know of its machine, with its welcome.
TEST_F(ToldByHosts, AWelcomeHasTheMachine) {
  storage::MachineRecord mill = Must(bed.store().GetMachine("mill-1"));
  mill.profile = "t1";
  mill.parameters["ORIGIN_X"] = "5";
  v1::MachineOptions options;
  options.set_start(v1::MachineOptions::START_PERSON);
  mill.options = BytesOf(options);
  Must(bed.store().PutMachine(mill, mill.revision, "anna"));
  const auto link = Joined();
  const v1::HostWelcome welcome = link->Newest(v1::HostResponse::kWelcome)->welcome();
  EXPECT_EQ(welcome.lease().seconds(), 60);
  EXPECT_EQ(welcome.family(), "rml1");
  EXPECT_EQ(welcome.profile(), "t1");
  ASSERT_EQ(welcome.parameters_size(), 1);
  EXPECT_EQ(welcome.parameters().at("ORIGIN_X"), "5");
  EXPECT_EQ(welcome.options().start(), v1::MachineOptions::START_PERSON);
  EXPECT_THAT(welcome.servers(), IsEmpty());
  // A lease that is renewed lasts as long, and is by its fence.
  v1::HostRequest renew;
  renew.mutable_renew()->set_fence(welcome.fence());
  hosts.Receive(*link, std::move(renew));
  const v1::HostRenewed renewed = link->Newest(v1::HostResponse::kRenewed)->renewed();
  EXPECT_EQ(renewed.fence(), welcome.fence());
  EXPECT_EQ(renewed.lease().seconds(), 60);
}

// LIVE-3.06: and the servers of its cell, to any of which it may turn.
TEST_F(ToldByHosts, AWelcomeHasTheServersOfTheCell) {
  Hosts others({.store = bed.store(),
                .feed = feed,
                .executor = *executor,
                .server = "another server",
                .join_token = "secret",
                .servers = {"hall:8443", "unix:/run/rmlcell"},
                .clock = clock.clock()});
  const auto link = std::make_shared<FakeLink>();
  ASSERT_TRUE(others.Join(link, Hello()));
  EXPECT_THAT(link->Newest(v1::HostResponse::kWelcome)->welcome().servers(),
              ElementsAre("hall:8443", "unix:/run/rmlcell"));
  others.CloseAll();
  Settle();
}

// LIVE-3.05: whose lease is another's is told so, by its own fence.
TEST_F(ToldByHosts, ALeaseThatIsLostIsNamed) {
  const auto link = Joined();
  Must(bed.store().TakeMachine({.machine = "mill-1",
                                .host = "other/2",
                                .server = "another",
                                .duration = seconds(15),
                                .by_hand = true}));
  v1::HostRequest renew;
  renew.mutable_renew()->set_fence(Fence(*link));
  hosts.Receive(*link, std::move(renew));
  EXPECT_EQ(link->Newest(v1::HostResponse::kLeaseLost)->lease_lost().fence(), Fence(*link));
}

// LIVE-2.03, LIVE-3.17: as long as it has not said where it stands.
TEST_F(ToldByHosts, AHostThatSaidNothingYetIsStarting) {
  const auto link = Joined();
  const auto status = hosts.StatusOf("mill-1");
  ASSERT_TRUE(status);
  EXPECT_EQ(status->state(), v1::MACHINE_STATE_STARTING);
  EXPECT_EQ(status->machine(), "machines/mill-1");
  EXPECT_EQ(status->fence(), Fence(*link));
  EXPECT_EQ(status->host(), "elsewhere/1");
  // It is not lost by that, however long it takes.
  EXPECT_EQ(StateAfter(milliseconds(4'999)), v1::MACHINE_STATE_STARTING);
}

// LIVE-2.10: of a host on this computer a second tells enough.
TEST_F(ToldByHosts, AHostOfThisComputerIsLostSooner) {
  const auto link = Joined(Hello(NameOfComputer() + "/1/boot"));
  Tell(*link, v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(StateAfter(milliseconds(1'000)), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(StateAfter(milliseconds(1)), v1::MACHINE_STATE_LOST);
  EXPECT_EQ(hosts.StatusOf("mill-1")->age_ns(), 1'001'000'000);
}

// LIVE-2.03: why it is OFF, for people.
TEST_F(ToldByHosts, AMachineThatIsOffSaysWhy) {
  hosts.NoteOff("mill-1", "its host ended 5 times");
  Settle();
  const auto status = StatusOf(&hosts, Must(bed.store().GetMachine("mill-1")), {});
  EXPECT_EQ(status.state(), v1::MACHINE_STATE_OFF);
  EXPECT_EQ(status.off_reason().code(), CodeText(ErrorCode::kCellNotLive));
  EXPECT_EQ(status.off_reason().severity(), v1::SEVERITY_REQUEST);
  EXPECT_EQ(status.off_reason().message(), "its host ended 5 times");
  EXPECT_NE(status.words().execution(), "");
}

// LIVE-2.14: a machine whose host is about to come, and one that is switched off, is not available
// to whoever reads the words of the standards.
TEST_F(ToldByHosts, WhatHasNoHostYetHasItsWords) {
  storage::MachineRecord mill = Must(bed.store().GetMachine("mill-1"));
  hosts.OnAwaited([](const std::string&) { return true; });
  v1::MachineStatus status = StatusOf(&hosts, mill, {});
  ASSERT_EQ(status.state(), v1::MACHINE_STATE_STARTING);
  EXPECT_EQ(status.words().item_state(), "NotAvailable");
  v1::MachineOptions options;
  options.set_disabled(true);
  mill.options = BytesOf(options);
  status = StatusOf(&hosts, mill, {});
  ASSERT_EQ(status.state(), v1::MACHINE_STATE_OFF);
  EXPECT_EQ(status.words().item_state(), "NotAvailable");
  EXPECT_EQ(status.words().execution(), "STOPPED");
}

// LIVE-5.04: the queue looks when the state changes, or what keeps jobs away, and not each time
// that a machine says where it is.
TEST_F(ToldByHosts, NewsIsWhatMayLetAJobBegin) {
  const auto link = Joined();
  hosts.OnNews([this](const std::string& machine) { news.push_back(machine); });
  v1::HostRequest told;
  told.mutable_status()->set_machine("machines/mill-1");
  told.mutable_status()->set_state(v1::MACHINE_STATE_RUNNING);
  hosts.Receive(*link, told);
  EXPECT_THAT(news, ElementsAre("mill-1"));
  told.mutable_status()->set_virtual_time_ns(7);
  hosts.Receive(*link, told);
  EXPECT_EQ(news.size(), 1U);
  told.mutable_status()->set_state(v1::MACHINE_STATE_HELD);
  hosts.Receive(*link, told);
  EXPECT_EQ(news.size(), 2U);
  told.mutable_status()->add_start_blockers()->set_code("CELL-E9433");
  hosts.Receive(*link, told);
  EXPECT_EQ(news.size(), 3U);
  told.mutable_status()->clear_start_blockers();
  hosts.Receive(*link, told);
  EXPECT_EQ(news.size(), 4U);
  clock.Advance(milliseconds(3'001));
  hosts.Look();  // it is lost
  EXPECT_EQ(news.size(), 5U);
}

// LIVE-3.17: that a machine has a host, and that its line is gone, changes what lists of machines
// show.
TEST_F(ToldByHosts, WhoComesAndGoesIsToldOf) {
  hosts.OnChange([this] { ++changes; });
  const auto link = Joined();
  EXPECT_EQ(changes, 1);
  EXPECT_THAT(hosts.Machines(), ElementsAre("mill-1"));
  hosts.Leave(*link);
  EXPECT_EQ(changes, 2);
  EXPECT_THAT(hosts.Machines(), ElementsAre("mill-1"));
  hosts.Leave(*std::make_shared<FakeLink>());  // of nobody
  EXPECT_EQ(changes, 2);
  EXPECT_FALSE(hosts.IsHeard("mill-1"));
}

// LIVE-3.41: products are looked for when a job is over, and when a host is heard that may have
// some; a run without a job has none.
TEST_F(ToldByHosts, TheEndOfAJobIsToldOf) {
  hosts.OnRunOver([this](const std::string& machine) { over += machine == "mill-1" ? 1 : 0; });
  const auto link = Joined();
  EXPECT_EQ(over, 1);
  const std::int64_t job = RunGivenTo("elsewhere/1");
  v1::HostRequest told = Entries(Fence(*link), 1, true);
  told.mutable_entries()->mutable_entries(0)->mutable_run_over()->set_run(1);
  hosts.Receive(*link, told);
  Settle();
  Settle();
  EXPECT_EQ(over, 1);
  told = Entries(Fence(*link), 3, true);
  v1::JournalEntry& entry = *told.mutable_entries()->mutable_entries(0);
  entry.set_job(JobName(job));
  entry.mutable_run_over()->set_job(JobName(job));
  entry.mutable_run_over()->mutable_outcome()->set_kind(v1::Outcome::KIND_COMPLETED);
  hosts.Receive(*link, told);
  EXPECT_TRUE(Eventually([&] { return over == 2; }));
  EXPECT_EQ(Must(bed.store().GetJob(job)).state, storage::JobState::kSucceeded);
}

// LIVE-5.05: the machine whose host says that it runs the job.
TEST_F(ToldByHosts, TheMachineOfAJobIsWhereItRuns) {
  const auto link = Joined();
  EXPECT_EQ(hosts.MachineThatRuns("jobs/17"), "");
  v1::HostRequest told;
  told.mutable_status()->set_state(v1::MACHINE_STATE_RUNNING);
  told.mutable_status()->mutable_run()->set_job("jobs/17");
  hosts.Receive(*link, told);
  EXPECT_EQ(hosts.MachineThatRuns("jobs/17"), "mill-1");
  EXPECT_EQ(hosts.MachineThatRuns("jobs/18"), "");
}

// LIVE-6.01: what is simulated for an answer may take 75 s, and every other one 10 s.
TEST_F(ToldByHosts, APreviewIsWaitedForLonger) {
  const auto link = Joined();
  std::vector<std::string> told;
  v1::HostOrder preview;
  preview.mutable_preview_start()->set_program(5);
  hosts.Ask("mill-1", preview, [&told](const Result<v1::HostOrderAnswer>& answer) {
    told.push_back(answer ? "answered" : std::string(answer.error().detail));
  });
  for (int part = 0; part < 15; ++part) {
    clock.Advance(part == 14 ? milliseconds(4'999) : milliseconds(5'000));
    Beat(*link);
  }
  EXPECT_THAT(told, IsEmpty());
  clock.Advance(milliseconds(1));
  Beat(*link);
  EXPECT_THAT(told, ElementsAre("its host does not answer"));
}

// LIVE-3.25: each kind of what happens in a run stands in the log of its job as what it is, by the
// time of the run.
TEST_F(ToldByHosts, EachKindStandsInTheLogOfItsJob) {
  const storage::MachineLease lease = Must(bed.store().TakeMachine(
      {.machine = "mill-1", .host = "hall/1", .server = "s", .duration = std::chrono::hours(1)}));
  const std::int64_t job = RunGivenTo("hall/1");
  std::vector<v1::RunEvent> events(7);
  events[0].mutable_resumed()->mutable_place()->set_step(4);
  events[1].mutable_signal()->set_name("beam");
  events[2].mutable_program_loaded()->set_program(44);
  events[3].mutable_executable_made()->set_program(45);
  events[4].mutable_diagnostic()->set_code("OPT-E348");
  events[5].mutable_gathered()->set_count(9);
  events[6].mutable_halted()->set_message("STOP");
  std::vector<v1::JournalEntry> entries;
  for (const v1::RunEvent& event : events) {
    v1::JournalEntry& entry = entries.emplace_back();
    entry.set_sequence(static_cast<std::int64_t>(entries.size()));
    entry.set_fence(lease.fence);
    entry.set_job(JobName(job));
    entry.set_run_time_ns(100 + entry.sequence());
    *entry.mutable_event() = event;
  }
  v1::JournalEntry& input = entries.emplace_back();
  input.set_sequence(8);
  input.set_fence(lease.fence);
  input.set_job(JobName(job));
  input.mutable_applied()->set_caller("anna");
  const std::int64_t before = Must(bed.store().LastPosition());
  const StoredEntries stored = StoreEntries(bed.store(), lease, entries);
  ASSERT_TRUE(stored.how) << stored.how.error().detail;
  EXPECT_EQ(stored.count, 8U);
  std::vector<v1::JobEvent> told;
  for (const storage::EventRecord& event : Must(bed.store().JobEvents(job, 0, 100))) {
    if (event.position > before) told.push_back(ToProto(event));
  }
  ASSERT_EQ(told.size(), 8U);
  EXPECT_EQ(told[0].resumed().place().step(), 4);
  EXPECT_EQ(told[1].signal().name(), "beam");
  EXPECT_EQ(told[2].program_loaded().program(), 44);
  EXPECT_EQ(told[3].executable_made().program(), 45);
  EXPECT_EQ(told[4].diagnostic().code(), "OPT-E348");
  EXPECT_EQ(told[5].gathered().count(), 9);
  EXPECT_EQ(told[6].halted().message(), "STOP");
  EXPECT_EQ(told[7].input_applied().caller(), "anna");
  for (std::size_t i = 0; i < events.size(); ++i)
    EXPECT_EQ(told[i].virtual_time_ns(), 101 + static_cast<std::int64_t>(i));
}

// LIVE-3.16: what is shown of a run is that of its machine.
TEST(ToldProgress, IsThatOfTheMachine) {
  v1::MachineStatus status;
  status.mutable_run()->set_job("jobs/5");
  status.mutable_run()->mutable_place()->set_step(12);
  status.mutable_run()->set_instruction("MOVE");
  status.mutable_tip()->set_x(3.5);
  status.set_speed_mm_s(20.0);
  status.set_override_percent(85.0);
  const v1::JobProgress progress = ProgressOf(status);
  EXPECT_EQ(progress.place().step(), 12);
  EXPECT_EQ(progress.instruction(), "MOVE");
  EXPECT_EQ(progress.position().tip().x(), 3.5);
  EXPECT_EQ(progress.speed_mm_s(), 20.0);
  EXPECT_EQ(progress.override_percent(), 85.0);
}

// OPT-1.11, OPT-3.44: executables and schedules are told with the programs; where there is none of
// them that is told as well.
TEST(ToldProgress, OfTheMemoryHasExecutablesAndSchedules) {
  storage::MachineMemory memory;
  memory.programs.resize(2);
  memory.programs[0].slot = 12;
  memory.programs[0].object = "object 12";
  memory.programs[0].executable = "executable 12";
  memory.programs[1].slot = 13;
  storage::ScheduleRecord& schedule = memory.schedules.emplace_back();
  schedule.number = 7;
  schedule.name = "fine";
  schedule.mode = "PULSE";
  schedule.power_percent = 40.0;
  const v1::HostMemory told = MemoryOf(memory);
  ASSERT_EQ(told.programs_size(), 2);
  EXPECT_EQ(told.programs(0).size(), 9);
  EXPECT_EQ(told.programs(0).executable(), "executable 12");
  EXPECT_EQ(told.programs(1).executable(), "");
  EXPECT_TRUE(told.schedules_changed());
  ASSERT_EQ(told.schedules_size(), 1);
  EXPECT_EQ(told.schedules(0).number(), 7);
  EXPECT_EQ(told.schedules(0).title(), "fine");
  EXPECT_EQ(told.schedules(0).mode(), "PULSE");
  EXPECT_EQ(told.schedules(0).power_percent(), 40.0);
  EXPECT_TRUE(MemoryOf({}).schedules_changed());
}

}  // namespace
}  // namespace rmlcell::server
