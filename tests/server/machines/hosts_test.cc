// Hosts as the server hears of them, over lines of the test: leases, orders, what is stored.
#include <unistd.h>

#include "server/base/this_computer.h"
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

// LIVE-3.07: who may join.
TEST_F(HostsTest, OnlyItsOwnHostsJoin) {
  v1::HostHello hello = Hello();
  hello.set_join_token("guessed");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellJoinRefused);
  hello = Hello();
  hello.set_protocol(2);
  EXPECT_EQ(Refused(hello), ErrorCode::kCellVersionMismatch);
  hello = Hello();
  hello.set_machine("machines/none");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellUnknownMachine);
  hello.set_machine("none");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellInvalidArgument);
  EXPECT_FALSE(hosts.IsHosted("mill-1"));
  const auto link = Joined();
  EXPECT_TRUE(hosts.IsHosted("mill-1"));
  const auto welcome = link->Newest(v1::HostResponse::kWelcome)->welcome();
  EXPECT_EQ(welcome.family(), "rml1");
  EXPECT_FALSE(welcome.has_mark());
  EXPECT_TRUE(link->Newest(v1::HostResponse::kMemory)->memory().whole());
}

// LIVE-3.02: one host; another one when the lease has stood unchanged for as long as it holds and
// five seconds more, and then with a higher fence.
TEST_F(HostsTest, AnotherHostWaitsUntilTheFirstIsGone) {
  const auto first = Joined();
  const std::int64_t fence = Fence(*first);
  EXPECT_EQ(Refused(Hello("other/2")), ErrorCode::kCellMachineTaken);
  clock.Advance(Hosts::kLease + std::chrono::seconds(4));
  EXPECT_EQ(Refused(Hello("other/2")), ErrorCode::kCellMachineTaken);
  v1::HostRequest renew;
  renew.mutable_renew()->set_fence(fence);
  hosts.Receive(*first, std::move(renew));
  first->Newest(v1::HostResponse::kRenewed);
  clock.Advance(std::chrono::seconds(2));
  EXPECT_EQ(Refused(Hello("other/2")), ErrorCode::kCellMachineTaken);  // seen anew
  clock.Advance(Hosts::kLease + std::chrono::seconds(5));
  const auto second = Joined(Hello("other/2"));
  EXPECT_GT(Fence(*second), fence);
  EXPECT_TRUE(first->closed());
  // What the first one still says is refused by its fence.
  hosts.Leave(*first);
  EXPECT_TRUE(hosts.IsHosted("mill-1"));
}

// LIVE-3.25: nothing is left out between what is stored: what finds no room to wait is told again,
// over another line.
TEST_F(HostsTest, WhatFindsNoRoomIsToldAgain) {
  const auto link = Joined();
  v1::HostRequest request;
  request.mutable_entries()->set_fence(Fence(*link));
  for (int i = 1; i <= 100'001; ++i) {
    v1::JournalEntry& entry = *request.mutable_entries()->add_entries();
    entry.set_sequence(i);
    entry.set_fence(Fence(*link));
    entry.mutable_mark()->set_clean(true);
  }
  hosts.Receive(*link, std::move(request));
  v1::HostRequest behind = Entries(Fence(*link), 100'002, true);
  hosts.Receive(*link, std::move(behind));
  EXPECT_TRUE(Eventually([&] { return link->closed(); }));
  std::int64_t stored = 0;
  for (const v1::HostResponse& message : link->All())
    stored = std::max(stored, message.entries_stored().sequence());
  EXPECT_EQ(stored, 100'000);
}

// LIVE-3.02: a process of this computer's present boot that is gone holds nothing; one of another
// boot may be of another computer of that name, and is waited for.
TEST_F(HostsTest, AProcessThatIsGoneIsNotWaitedFor) {
  const std::string gone = NameOfComputer() + "/2147483646/";
  const std::string other = NameOfBoot() == "00000000" ? "11111111" : "00000000";
  hosts.Leave(*Joined(Hello(gone + other + "5f3a09c1")));
  EXPECT_EQ(Refused(Hello("other/2")), ErrorCode::kCellMachineTaken);
  clock.Advance(Hosts::kLease + std::chrono::seconds(5));
  hosts.Leave(*Joined(Hello(gone + NameOfBoot() + "5f3a09c1")));
  const std::string lives =
      NameOfComputer() + "/" + std::to_string(::getpid()) + "/" + NameOfBoot() + "b06e77d2";
  hosts.Leave(*Joined(Hello(lives)));
  EXPECT_EQ(Refused(Hello("other/2")), ErrorCode::kCellMachineTaken);
}

// LIVE-3.02: the same host keeps its fence, over another line.
TEST_F(HostsTest, TheSameHostComesBackWithItsFence) {
  const auto first = Joined();
  hosts.Leave(*first);
  EXPECT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_STARTING);
  const auto again = Joined(Hello("elsewhere/1", Fence(*first)));
  EXPECT_EQ(Fence(*again), Fence(*first));
}

// LIVE-5.20, server killed: a host that outlives it may be asked what it knows, though it has
// nothing to say by itself; one that follows another says first what that one did.
TEST_F(HostsTest, AHostThatCameBackIsSettled) {
  const auto first = Joined();
  EXPECT_FALSE(hosts.IsSettled("mill-1"));
  hosts.Leave(*first);
  const auto again = Joined(Hello("elsewhere/1", Fence(*first)));
  EXPECT_TRUE(hosts.IsSettled("mill-1"));
}

// LIVE-3.17, LIVE-2.03: status goes to who watches, with what the queue does; LOST without a line.
TEST_F(HostsTest, StatusIsThatOfTheHost) {
  const auto link = Joined();
  Tell(*link, v1::MACHINE_STATE_HELD);
  EXPECT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_HELD);
  EXPECT_TRUE(Eventually([&] {
    const auto latest = feed.LatestAfter("machines/mill-1", 0);
    v1::MachineStatus status;
    return latest && status.ParseFromString(*latest->bytes) &&
           status.state() == v1::MACHINE_STATE_HELD;
  }));
  clock.Advance(std::chrono::milliseconds(40));
  EXPECT_EQ(hosts.StatusOf("mill-1")->age_ns(), 40'000'000);
  hosts.Leave(*link);
  EXPECT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_LOST);
  EXPECT_FALSE(hosts.StatusOf("optimo-1"));
}

// LIVE-2.10: a host that is silent is LOST: over a network after three seconds while a run is open,
// sooner where the machine rests; nothing moves then as far as anybody knows, and it is not lost
// any more when it is heard.
TEST_F(HostsTest, ASilentHostIsLost) {
  const auto link = Joined();
  v1::HostRequest moving;
  moving.mutable_status()->set_machine("machines/mill-1");
  moving.mutable_status()->set_state(v1::MACHINE_STATE_RUNNING);
  moving.mutable_status()->set_speed_mm_s(2.0);
  hosts.Receive(*link, moving);
  const auto state_after = [&](std::chrono::milliseconds time) {
    clock.Advance(time);
    hosts.Look();
    return hosts.StatusOf("mill-1")->state();
  };
  EXPECT_EQ(state_after(std::chrono::milliseconds(3'000)), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(state_after(std::chrono::milliseconds(1)), v1::MACHINE_STATE_LOST);
  // Nothing begins there; what halts is handed over all the same.
  const auto refused = [&](const std::function<void(v1::HostOrder&)>& set) {
    v1::HostOrder order;
    set(order);
    std::string code;
    hosts.Ask("mill-1", std::move(order), [&](const Result<v1::HostOrderAnswer>& answer) {
      code = answer ? "answered" : CodeText(answer.error().code);
    });
    return code;
  };
  EXPECT_EQ(refused([](v1::HostOrder& order) { order.mutable_start()->set_program(5); }),
            "CELL-E9424");
  const auto is_order = [](const v1::HostResponse& message) { return message.has_order(); };
  EXPECT_TRUE(std::ranges::none_of(link->All(), is_order));
  EXPECT_EQ(refused([](v1::HostOrder& order) { order.mutable_stop(); }), "CELL-E9424");
  EXPECT_TRUE(link->Newest(v1::HostResponse::kOrder));
  EXPECT_EQ(hosts.StatusOf("mill-1")->speed_mm_s(), 0.0);
  EXPECT_EQ(hosts.StatusOf("mill-1")->words().item_state(), "NotAvailable");
  Tell(*link, v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(state_after(std::chrono::milliseconds(2'500)), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(state_after(std::chrono::milliseconds(1)), v1::MACHINE_STATE_LOST);
  EXPECT_FALSE(link->closed());
  state_after(std::chrono::milliseconds(2'500));
  EXPECT_TRUE(link->closed());
}

// LIVE-2.03: OFF where somebody switched it off, STARTING where its host is about to come.
TEST_F(HostsTest, WithoutAHost) {
  storage::MachineRecord machine = Must(bed.store().GetMachine("mill-1"));
  const auto state = [&] { return StatusOf(&hosts, machine, {}).state(); };
  EXPECT_EQ(state(), v1::MACHINE_STATE_IDLE);  // nobody has said that it lives
  hosts.OnAwaited([](const std::string& id) { return id == "mill-1"; });
  EXPECT_EQ(state(), v1::MACHINE_STATE_STARTING);
  v1::MachineOptions options;
  options.set_disabled(true);
  machine.options = BytesOf(options);
  EXPECT_EQ(state(), v1::MACHINE_STATE_OFF);
}

// LIVE-3.06: an order goes to the host and its answer back; without a line it says so at once, and
// without an answer after a while.
TEST_F(HostsTest, OrdersAreAnswered) {
  std::vector<std::string> answers;
  const auto ask = [&] {
    v1::HostOrder order;
    order.mutable_stop();
    hosts.Ask("mill-1", std::move(order), [&](const Result<v1::HostOrderAnswer>& answer) {
      answers.push_back(answer ? "answered" : CodeText(answer.error().code));
    });
  };
  ask();
  EXPECT_THAT(answers, testing::ElementsAre("CELL-E9424"));
  const auto link = Joined();
  ask();
  ask();
  const auto order = link->Newest(v1::HostResponse::kOrder);
  ASSERT_TRUE(order);
  v1::HostRequest request;
  request.mutable_answer()->set_number(order->order().number());
  request.mutable_answer()->mutable_halt();
  hosts.Receive(*link, request);
  hosts.Receive(*link, request);  // heard twice
  EXPECT_THAT(answers, testing::ElementsAre("CELL-E9424", "answered"));
  v1::HostRequest heartbeat;
  heartbeat.mutable_heartbeat()->set_number(1);
  clock.Advance(std::chrono::milliseconds(9'999));
  hosts.Receive(*link, heartbeat);
  EXPECT_EQ(answers.size(), 2U);
  clock.Advance(std::chrono::milliseconds(1));
  hosts.Receive(*link, heartbeat);
  EXPECT_EQ(answers.size(), 3U);
  ask();
  hosts.Leave(*link);
  EXPECT_THAT(answers, testing::ElementsAre("CELL-E9424", "answered", "CELL-E9424", "CELL-E9424"));
}

// LIVE-3.25, LIVE-3.30: events and the newest mark are stored together and acknowledged; who hosts
// it next begins there, and is told that a run was cut off.
TEST_F(HostsTest, WhatAHostTellsIsStored) {
  const auto link = Joined();
  const std::int64_t fence = Fence(*link);
  hosts.Receive(*link, Entries(fence, 1, false));
  EXPECT_EQ(link->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 2);
  const auto mark = Must(bed.store().GetMachineMark("mill-1"));
  ASSERT_TRUE(mark);
  EXPECT_EQ(mark->state, "where it stands");
  EXPECT_FALSE(mark->clean);
  ASSERT_EQ(Told().size(), 1U);
  EXPECT_TRUE(Told()[0].has_run_begun());
  EXPECT_EQ(Told()[0].fence(), fence);
  // The same again is stored once, and acknowledged again: over this line and over another one.
  hosts.Receive(*link, Entries(fence, 1, false));
  EXPECT_EQ(std::ranges::count(link->All(), v1::HostResponse::kEntriesStored,
                               &v1::HostResponse::message_case),
            2);
  hosts.Leave(*link);
  const auto back = Joined(Hello("elsewhere/1", fence));
  hosts.Receive(*back, Entries(fence, 1, false));
  EXPECT_EQ(back->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 2);
  hosts.Receive(*back, Entries(fence, 3, false));
  EXPECT_TRUE(Eventually([&] { return Told().size() == 2; }));
  hosts.Leave(*back);
  clock.Advance(std::chrono::seconds(1));
  EXPECT_EQ(Refused(Hello("other/2")), ErrorCode::kCellMachineTaken);
  clock.Advance(Hosts::kLease + std::chrono::seconds(4));
  EXPECT_EQ(Refused(Hello("other/2")), ErrorCode::kCellMachineTaken);
  clock.Advance(std::chrono::seconds(1));
  const auto next = Joined(Hello("other/2"));
  const auto welcome = next->Newest(v1::HostResponse::kWelcome)->welcome();
  EXPECT_EQ(welcome.mark().state(), "where it stands");
  EXPECT_FALSE(welcome.mark().clean());
  EXPECT_EQ(welcome.mark().fence(), fence);
  ASSERT_TRUE(Told().back().has_recovered());
  EXPECT_EQ(Told().back().recovered().mark_virtual_time_ns(), 77);
  EXPECT_EQ(Told().back().recovered().mark_fence(), fence);
  // LIVE-5.20: first that its host is gone.
  const auto told = Told();
  ASSERT_TRUE(told.at(told.size() - 2).has_host_lost());
  EXPECT_EQ(told.at(told.size() - 2).host_lost().host(), "elsewhere/1");
  EXPECT_EQ(told.at(told.size() - 2).host_lost().fence(), fence);
}

// LIVE-5.03: whoever stored a program and begins it at once begins that one: the host has it before
// the order, however late watchers hear of what is stored.
TEST_F(HostsTest, WhatWasStoredIsThereBeforeItIsBegun) {
  const auto link = Joined();
  for (int round = 1; round <= 30; ++round) {
    const std::string object = "PU" + std::to_string(round) + ",0;";
    const auto put = bed.store().PutPrograms("mill-1", {{.slot = 5, .object = object}}, {}, "me");
    ASSERT_TRUE(put) << put.error().detail;
    v1::HostOrder order;
    order.mutable_start()->set_program(5);
    hosts.Ask("mill-1", order, [](const Result<v1::HostOrderAnswer>&) {});
    std::string known;  // when the newest order came
    EXPECT_TRUE(Eventually([&] {
      int orders = 0;
      std::string newest;
      for (const v1::HostResponse& message : link->All()) {
        for (const v1::AssignedProgram& program : message.memory().programs())
          newest = program.content();
        if (message.has_order() && ++orders == round) known = newest;
      }
      return orders == round;
    }));
    ASSERT_EQ(known, object);
  }
}

// LIVE-2.05: what waited for the store so long that its caller was told so begins nothing later.
TEST_F(HostsTest, AnOrderThatWasGivenUpIsNotSent) {
  const auto link = Joined();
  std::promise<void> goes_on;
  const std::shared_future<void> wait = goes_on.get_future().share();
  for (int thread = 0; thread < kThreads; ++thread) executor->Post([wait] { wait.wait(); });
  std::promise<ErrorCode> told;
  v1::HostOrder order;
  order.mutable_start()->set_program(5);
  hosts.Ask("mill-1", order, [&told](const Result<v1::HostOrderAnswer>& answer) {
    told.set_value(answer ? ErrorCode::kCellInternal : answer.error().code);
  });
  clock.Advance(Hosts::kAnswerPatience + std::chrono::seconds(1));
  Beat(*link);
  EXPECT_EQ(told.get_future().get(), ErrorCode::kCellNotLive);
  goes_on.set_value();
  // One that is wanted comes, and is the only one.
  order.mutable_start()->set_program(6);
  hosts.Ask("mill-1", order, [](const Result<v1::HostOrderAnswer>&) {});
  EXPECT_TRUE(Eventually([&] {
    return std::ranges::any_of(link->All(), [](const v1::HostResponse& message) {
      return message.order().start().program() == 6;
    });
  }));
  EXPECT_EQ(std::ranges::count_if(link->All(), &v1::HostResponse::has_order), 1);
}

// LIVE-3.03: a machine with a device is never taken by waiting, whoever holds the lock of the
// device elsewhere.
TEST_F(HostsTest, AMachineWithADeviceWaitsForAPerson) {
  v1::HostHello hello = Hello("hall/1");
  hello.set_computer("hall");
  hello.set_has_device(true);
  const auto first = Joined(hello);
  EXPECT_TRUE(Must(bed.store().MachineLeases()).front().pinned);
  hosts.Leave(*first);
  v1::HostHello other = Hello("office/2");
  other.set_computer("office");
  other.set_has_device(true);
  EXPECT_EQ(Refused(other), ErrorCode::kCellMachineTaken);
  clock.Advance(std::chrono::minutes(10));
  EXPECT_EQ(Refused(other), ErrorCode::kCellMachineTaken);

  hosts.GiveTo("mill-1", "cellar", "anna", "a mistake");
  EXPECT_EQ(Refused(other), ErrorCode::kCellMachineTaken);
  hosts.GiveTo("mill-1", "office", "anna", "the hall is without power");
  other.set_has_device(false);
  EXPECT_EQ(Refused(other), ErrorCode::kCellMachineTaken);
  other.set_has_device(true);
  const auto second = Joined(other);
  EXPECT_GT(Fence(*second), Fence(*first));
  const auto told = Told();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told.at(0).run().message().text(), "taken by anna: the hall is without power");
  EXPECT_EQ(told.at(1).host_lost().host(), "hall/1");

  // Given once, taken once.
  v1::HostHello third = Hello("cellar/3");
  third.set_computer("cellar");
  third.set_has_device(true);
  EXPECT_EQ(Refused(third), ErrorCode::kCellMachineTaken);
}

// LIVE-3.03: who has the lock of the device on the same computer has the machine: whoever had it is
// gone.
TEST_F(HostsTest, TheNextHostOfTheComputerThatHasTheDeviceGetsTheMachine) {
  v1::HostHello hello = Hello("hall/1");
  hello.set_computer("hall");
  hello.set_has_device(true);
  const auto first = Joined(hello);
  hosts.Leave(*first);
  hello.set_host("hall/2");
  hello.set_has_device(false);
  EXPECT_EQ(Refused(hello), ErrorCode::kCellMachineTaken);
  hello.set_has_device(true);
  EXPECT_GT(Fence(*Joined(hello)), Fence(*first));
}

// LIVE-3.03: a virtual machine is given by hand, too, and what is given is given for a while.
TEST_F(HostsTest, WhatAPersonGaveIsTakenWithinTenMinutes) {
  const auto first = Joined();
  v1::HostHello other = Hello("office/2");
  other.set_computer("office");
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  clock.Advance(Hosts::kGivenFor + std::chrono::seconds(1));
  v1::HostRequest renew;
  renew.mutable_renew()->set_fence(Fence(*first));
  hosts.Receive(*first, std::move(renew));
  first->Newest(v1::HostResponse::kRenewed);
  EXPECT_EQ(Refused(other), ErrorCode::kCellMachineTaken);
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  Joined(other);
  EXPECT_TRUE(first->closed());
}

// LIVE-3.06: each side knows that the other one is there.
TEST_F(HostsTest, AHeartbeatIsAnswered) {
  const auto link = Joined();
  v1::HostRequest beat;
  beat.mutable_heartbeat()->set_number(7);
  hosts.Receive(*link, beat);
  EXPECT_EQ(link->Newest(v1::HostResponse::kHeartbeat)->heartbeat().number(), 7);
}

// LIVE-3.06, LIVE-3.12: the status of a machine that stands is its heartbeat; of one that moves,
// which has others, it is none.
TEST_F(HostsTest, AStatusAtRestIsAnswered) {
  const auto link = Joined();
  const auto answers = [&link] {
    const std::vector<v1::HostResponse> all = link->All();
    return std::ranges::count_if(all, &v1::HostResponse::has_heartbeat);
  };
  Tell(*link, v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(answers(), 0);
  Tell(*link, v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(answers(), 1);
  EXPECT_EQ(link->Newest(v1::HostResponse::kHeartbeat)->heartbeat().number(), 0);  // it has none
}

// LIVE-3.05: a host whose lease was given away is told so, and nothing of it is stored.
TEST_F(HostsTest, WhoHasLostItsLeaseStoresNothing) {
  const auto link = Joined();
  Must(bed.store().TakeMachine({.machine = "mill-1",
                                .host = "other/2",
                                .server = "another",
                                .duration = std::chrono::seconds(15),
                                .by_hand = true}));
  hosts.Receive(*link, Entries(Fence(*link), 1, true));
  EXPECT_TRUE(link->Newest(v1::HostResponse::kLeaseLost));
  EXPECT_FALSE(Must(bed.store().GetMachineMark("mill-1")));
  EXPECT_TRUE(Told().empty());
}

// LIVE-5.03: what is stored in the memory of a machine goes to its host.
TEST_F(HostsTest, WhatIsStoredMeanwhileGoesToTheHost) {
  const auto link = Joined();
  Must(bed.store().PutPrograms("mill-1", {{.slot = 5, .name = "p", .object = "PA;"}}, {}, "anna"));
  EXPECT_TRUE(Eventually([&] {
    const auto memory = link->Newest(v1::HostResponse::kMemory)->memory();
    return memory.programs_size() == 1 && memory.programs(0).content() == "PA;";
  }));
}

// A host that this server knows nothing of has the machine, and runs a job of it.
class HeldElsewhere : public HostsTest {
 protected:
  void SetUp() override {
    other_ = Must(bed.store().TakeMachine(
        {.machine = "mill-1", .host = "elsewhere/9", .server = "s", .duration = Hosts::kLease}));
    job_ = Must(bed.store().SubmitAndWait(
                    {.machine = "mill-1", .kind = "RUN", .specification = "", .attempts_max = 1}))
               .job.id;
    Must(bed.store().AcquireJobs(
        {.worker = "elsewhere/9", .kinds = {"RUN"}, .duration = std::chrono::hours(1)}));
  }
  storage::JobState state() { return Must(bed.store().GetJob(job_)).state; }

  storage::MachineLease other_{};
  std::int64_t job_ = 0;
};

// LIVE-3.01, LIVE-5.08: a job whose machine nobody comes for is cut off; not one that the host of
// another server runs there.
TEST_F(HeldElsewhere, AMachineThatIsOffHasNoJobThatRuns) {
  std::atomic<int> looks = 0;
  hosts.OnChange([&looks] { ++looks; });
  hosts.NoteOff("mill-1", "its host ended 5 times");
  EXPECT_TRUE(Eventually([&] { return looks == 1; }));
  EXPECT_EQ(state(), storage::JobState::kRunning);
  ASSERT_TRUE(bed.store().ReleaseMachine(other_));
  hosts.NoteOff("mill-1", "its host ended 5 times");
  EXPECT_TRUE(Eventually([&] { return looks == 2; }));
  EXPECT_EQ(state(), storage::JobState::kInterrupted);
  hosts.OnChange({});
}

// LIVE-3.02, LIVE-5.08: who has a machine that is off, of a boot or of a computer that this one
// cannot look into, is gone when its lease stands unchanged.
TEST_F(HeldElsewhere, WhoHoldsAMachineThatIsOffIsWaitedFor) {
  std::atomic<int> looks = 0;
  hosts.OnChange([&looks] { ++looks; });
  hosts.NoteOff("mill-1", "its host ended 5 times");
  EXPECT_TRUE(Eventually([&] { return looks == 1; }));
  clock.Advance(Hosts::kLease + std::chrono::seconds(4));
  hosts.Look();
  Settle();
  EXPECT_EQ(state(), storage::JobState::kRunning);
  clock.Advance(std::chrono::seconds(1));
  EXPECT_TRUE(Eventually([&] {
    hosts.Look();
    clock.Advance(std::chrono::seconds(1));
    return state() == storage::JobState::kInterrupted;
  }));
  EXPECT_TRUE(Eventually([&] { return looks == 2; }));
  hosts.OnChange({});
}

// LIVE-5.09: it gives the machine back; the next one takes it at once.
TEST_F(HostsTest, AMachineThatIsGivenBackIsFree) {
  const auto link = Joined();
  hosts.End("mill-1", "a test");
  EXPECT_EQ(link->Newest(v1::HostResponse::kStop)->stop().reason(), "a test");
  v1::HostRequest back;
  back.mutable_hand_back()->set_fence(Fence(*link));
  hosts.Receive(*link, std::move(back));
  hosts.Leave(*link);
  EXPECT_FALSE(hosts.IsHosted("mill-1"));
  EXPECT_TRUE(Eventually([&] { return Must(bed.store().MachineLeases()).empty(); }));
  Joined(Hello("other/2"));
}

// The server stops: lines end, and nobody joins any more.
TEST_F(HostsTest, AServerThatStopsTakesNoHost) {
  const auto link = Joined();
  hosts.CloseAll();
  EXPECT_TRUE(link->closed());
  EXPECT_EQ(Refused(Hello("elsewhere/1", Fence(*link))), ErrorCode::kCellUnavailable);
}

// LIVE-7.08: what was taught at the machine is stored, and its host hears whether.
TEST_F(HostsTest, WhatIsTaughtAtAMachineIsStored) {
  const auto link = Joined();
  const auto edit = [&](std::int64_t number, const std::string& object, std::int64_t revision) {
    v1::HostRequest request;
    v1::HostEdit& told = *request.mutable_edit();
    told.set_fence(Fence(*link));
    told.set_number(number);
    told.set_slot(5);
    told.set_object(object);
    told.set_object_revision(revision);
    told.set_caller("anna");
    told.mutable_taught()->mutable_step()->set_program(5);
    hosts.Receive(*link, std::move(request));
    v1::HostEditAnswer answer;
    EXPECT_TRUE(Eventually([&] {
      for (const v1::HostResponse& message : link->All()) {
        if (message.has_edit_answer()) answer = message.edit_answer();
      }
      return answer.number() == number;
    }));
    return answer;
  };
  EXPECT_FALSE(edit(1, "PA;", 0).has_refusal());
  const storage::ProgramRecord stored = Must(bed.store().GetProgram("mill-1", 5));
  EXPECT_EQ(stored.object, "PA;");
  const auto taught = Must(bed.store().ListTeachRecords("mill-1", 0, 0, 9));
  ASSERT_EQ(taught.size(), 1U);
  EXPECT_EQ(taught[0].program, 5);
  v1::TeachEntry entry;
  ASSERT_TRUE(entry.ParseFromString(taught[0].entry));
  EXPECT_EQ(entry.etag_after(), "1");
  // Somebody else was first: nothing is stored, and nothing taught.
  EXPECT_TRUE(edit(2, "PU;", 0).has_refusal());
  EXPECT_EQ(Must(bed.store().GetProgram("mill-1", 5)).object, "PA;");
  EXPECT_FALSE(edit(3, "", 1).has_refusal());
  EXPECT_FALSE(bed.store().GetProgram("mill-1", 5));
  EXPECT_EQ(Must(bed.store().ListTeachRecords("mill-1", 0, 0, 9)).size(), 2U);
}

// LIVE-7.02: the newest that is to be seen at its handbox.
TEST_F(HostsTest, TheHandboxIsThatOfTheHost) {
  EXPECT_FALSE(hosts.HandboxPanelOf("mill-1"));
  const auto link = Joined();
  EXPECT_FALSE(hosts.HandboxPanelOf("mill-1"));
  for (const char* display : {"READY", "TEACH"}) {
    v1::HostRequest request;
    request.mutable_panel()->set_display(display);
    hosts.Receive(*link, std::move(request));
    ASSERT_TRUE(hosts.HandboxPanelOf("mill-1"));
    EXPECT_EQ(hosts.HandboxPanelOf("mill-1")->display(), display);
  }
}

// A machine that is disabled has no host; what kept it off is forgotten when it is enabled again.
TEST_F(HostsTest, AMachineThatIsForgottenHasNoHost) {
  EXPECT_FALSE(hosts.IsHeard("mill-1"));
  EXPECT_FALSE(hosts.IsSettled("mill-1"));
  const auto link = Joined();
  EXPECT_TRUE(hosts.IsHeard("mill-1"));
  const storage::MachineRecord mill = Must(bed.store().GetMachine("mill-1"));
  Tell(*link, v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(StatusOf(&hosts, mill, {}).state(), v1::MACHINE_STATE_RUNNING);
  hosts.Forget("mill-1");
  EXPECT_FALSE(hosts.IsHosted("mill-1"));
  EXPECT_TRUE(link->closed());
  hosts.Forget("mill-1");  // there is nothing to forget any more
  hosts.NoteOff("mill-1", "its host ended 5 times");
  ASSERT_TRUE(hosts.WhyOff("mill-1"));
  EXPECT_EQ(hosts.WhyOff("mill-1")->code, ErrorCode::kCellNotLive);
  EXPECT_EQ(StatusOf(&hosts, mill, {}).state(), v1::MACHINE_STATE_OFF);
  hosts.ClearOff("mill-1");
  EXPECT_FALSE(hosts.WhyOff("mill-1"));
  storage::MachineRecord disabled = mill;
  v1::MachineOptions options;
  options.set_disabled(true);
  disabled.options = BytesOf(options);
  EXPECT_EQ(StatusOf(&hosts, disabled, {}).state(), v1::MACHINE_STATE_OFF);
  hosts.CloseAll();
  EXPECT_TRUE(hosts.IsHeard("mill-1"));  // nothing is to be started any more
}

}  // namespace
}  // namespace rmlcell::server
