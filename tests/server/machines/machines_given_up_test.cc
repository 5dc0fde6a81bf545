// A machine that nobody comes for, and one that is forgotten: who looks at it, how often, and who
// is told (live.md 3.02, 5.08).
#include <condition_variable>
#include <functional>
#include <mutex>

#include "tests/server/forwarding_store.h"
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class MachinesGivenUp : public HostsTest {
 protected:
  void SetUp() override {
    hosts.OnChange([this] { ++changes; });
  }
  void TearDown() override {
    hosts.OnChange({});
    HostsTest::TearDown();
  }
  void TakenElsewhere() {
    other = Must(bed.store().TakeMachine(
        {.machine = "mill-1", .host = "elsewhere/9", .server = "s", .duration = Hosts::kLease}));
  }
  int ChangesAfterALook() {
    clock.Advance(seconds(5));
    hosts.Look();
    Settle();
    return changes;
  }

  std::atomic<int> changes = 0;
  storage::MachineLease other{};
};

// While somebody has it nothing has changed; when nobody has any more it has, and once.
TEST_F(MachinesGivenUp, AChangeIsToldOnce) {
  TakenElsewhere();
  hosts.NoteOff("mill-1", "its host ended 5 times");
  Settle();
  EXPECT_EQ(changes, 1);
  EXPECT_EQ(ChangesAfterALook(), 1);
  ASSERT_TRUE(bed.store().ReleaseMachine(other));
  EXPECT_EQ(ChangesAfterALook(), 2);
  EXPECT_EQ(ChangesAfterALook(), 2);
}

// Two looks that came before either was made: the first of them settles it.
TEST_F(MachinesGivenUp, ALookAtWhatIsSettledChangesNothing) {
  std::promise<void> goes_on;
  std::promise<void> alone_goes_on;
  const std::shared_future<void> wait = goes_on.get_future().share();
  const std::shared_future<void> wait_alone = alone_goes_on.get_future().share();
  executor->Post([wait] { wait.wait(); });
  executor->Post([wait_alone] { wait_alone.wait(); });
  hosts.NoteOff("mill-1", "its host ended 5 times");
  hosts.Look();
  goes_on.set_value();  // one thread, which does one behind the other
  std::promise<void> done;
  executor->Post([&done] { done.set_value(); });
  done.get_future().wait();
  EXPECT_EQ(changes, 1);
  alone_goes_on.set_value();
}

// Counts who asks for the leases of machines.
class LeasesAskedFor final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<storage::MachineLease>> MachineLeases() override {
    ++asked;
    return ForwardingStore::MachineLeases();
  }
  std::atomic<int> asked = 0;
};

// It is looked at every five seconds, however often the server looks around.
TEST_F(MachinesGivenUp, WhoHoldsItIsAskedForEveryFiveSeconds) {
  TakenElsewhere();
  LeasesAskedFor store(bed.store());
  Hosts others({.store = store,
                .feed = feed,
                .executor = *executor,
                .server = "another server",
                .join_token = "secret",
                .clock = clock.clock()});
  others.NoteOff("mill-1", "its host ended 5 times");
  Settle();
  const auto asked_after = [&](milliseconds time) {
    const int before = store.asked;
    clock.Advance(time);
    others.Look();
    Settle();
    return store.asked - before;
  };
  asked_after(milliseconds(0));
  EXPECT_EQ(asked_after(milliseconds(0)), 0);
  EXPECT_EQ(asked_after(milliseconds(4'999)), 0);
  EXPECT_EQ(asked_after(milliseconds(1)), 1);
  EXPECT_EQ(asked_after(milliseconds(4'999)), 0);
  others.CloseAll();
  Settle();
}

// Something happens while somebody asks for the leases of machines.
class AskedMeanwhile final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  Result<std::vector<storage::MachineLease>> MachineLeases() override {
    if (meanwhile) meanwhile();
    return ForwardingStore::MachineLeases();
  }
  std::function<void()> meanwhile;
};

// Of a machine that is switched on while it is looked at who has it: it is off no more, which is
// told, though somebody has it.
TEST_F(MachinesGivenUp, BeingOnAgainIsAChange) {
  TakenElsewhere();
  AskedMeanwhile store(bed.store());
  std::atomic<int> told = 0;
  Hosts others({.store = store,
                .feed = feed,
                .executor = *executor,
                .server = "another server",
                .join_token = "secret",
                .clock = clock.clock()});
  others.OnChange([&told] { ++told; });
  others.NoteOff("mill-1", "its host ended 5 times");
  Settle();
  EXPECT_EQ(told, 1);
  store.meanwhile = [&others] { others.ClearOff("mill-1"); };
  clock.Advance(seconds(5));
  others.Look();
  Settle();
  EXPECT_FALSE(others.WhyOff("mill-1"));
  EXPECT_EQ(told, 2);
  others.OnChange({});
  others.CloseAll();
  Settle();
}

// LIVE-2.05: whoever waits for an answer of a machine that is forgotten is told that none comes.
TEST_F(MachinesGivenUp, WhoWaitsForAForgottenMachineIsToldSo) {
  const auto link = Joined();
  std::vector<std::string> told;
  v1::HostOrder order;
  order.mutable_read_variables();
  hosts.Ask("mill-1", std::move(order), [&told](const Result<v1::HostOrderAnswer>& answer) {
    told.push_back(answer ? "answered" : CodeText(answer.error().code));
  });
  EXPECT_TRUE(told.empty());
  const int before = changes;
  hosts.Forget("mill-1");
  EXPECT_EQ(changes, before + 1);
  EXPECT_THAT(told, testing::ElementsAre("CELL-E9424"));
}

// hosts.h, Forget: with a fence it is that host, and no other one.
TEST_F(MachinesGivenUp, AHostIsForgottenByItsFence) {
  const auto link = Joined();
  hosts.Forget("mill-1", Fence(*link) + 1);
  EXPECT_TRUE(hosts.IsHosted("mill-1"));
  hosts.Forget("mill-1", Fence(*link));
  EXPECT_FALSE(hosts.IsHosted("mill-1"));
}

// LIVE-2.10: who watches a machine is told that it is lost, without asking.
TEST_F(MachinesGivenUp, ALostMachineIsPublished) {
  const auto link = Joined();
  const auto state = [this] {
    v1::MachineStatus status;
    const auto latest = feed.LatestAfter("machines/mill-1", 0);
    return latest && status.ParseFromString(*latest->bytes) ? status.state()
                                                            : v1::MACHINE_STATE_UNSPECIFIED;
  };
  Tell(*link, v1::MACHINE_STATE_RUNNING);
  ASSERT_TRUE(Eventually([&] { return state() == v1::MACHINE_STATE_RUNNING; }));
  clock.Advance(milliseconds(3'001));
  hosts.Look();
  EXPECT_TRUE(Eventually([&] { return state() == v1::MACHINE_STATE_LOST; }));
}

// A host that gives its machine back has asked for nothing else.
TEST_F(MachinesGivenUp, GivingBackIsNoHeartbeat) {
  const auto link = Joined();
  v1::HostRequest back;
  back.mutable_hand_back()->set_fence(Fence(*link));
  hosts.Receive(*link, std::move(back));
  EXPECT_TRUE(Eventually([&] { return Must(bed.store().MachineLeases()).empty(); }));
  EXPECT_FALSE(std::ranges::any_of(link->All(), &v1::HostResponse::has_heartbeat));
}

// LIVE-3.03: what was given is used up when it is taken, though the machine was free by then.
TEST_F(MachinesGivenUp, WhatIsTakenFreelyIsTakenOnce) {
  v1::HostHello hello = Hello("office/2");
  hello.set_computer("office");
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  Joined(hello);
  hello.set_host("office/3");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellMachineTaken);
}

// Nor is it given a second time where it was taken from somebody.
TEST_F(MachinesGivenUp, WhatIsTakenFromSomebodyIsTakenOnce) {
  const auto first = Joined();
  v1::HostHello hello = Hello("office/2");
  hello.set_computer("office");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellMachineTaken);
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  Joined(hello);
  EXPECT_TRUE(first->closed());
  hello.set_host("office/3");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellMachineTaken);
}

// LIVE-3.30: a mark of an earlier fence is older, however many entries were told by then.
TEST_F(MachinesGivenUp, AMarkOfAnEarlierFenceIsOlder) {
  const auto before = Joined(Hello("before/1"));
  v1::HostRequest back;
  back.mutable_hand_back()->set_fence(Fence(*before));
  hosts.Receive(*before, std::move(back));
  hosts.Leave(*before);
  ASSERT_TRUE(Eventually([&] { return Must(bed.store().MachineLeases()).empty(); }));
  const auto link = Joined();
  ASSERT_GT(Fence(*link), Fence(*before));
  hosts.Receive(*link, Entries(Fence(*link), 1, false));  // number 2, at 77 ns
  ASSERT_TRUE(Eventually([&] { return !Told().empty(); }));
  hosts.Leave(*link);
  v1::HostHello hello = Hello("other/2");
  EXPECT_EQ(Refused(hello), ErrorCode::kCellMachineTaken);
  v1::MachineMark& mark = *hello.mutable_journal_mark();
  mark.set_fence(Fence(*before));
  mark.set_sequence(1'000);
  mark.set_virtual_time_ns(91);
  clock.Advance(Hosts::kLease + seconds(5));
  Joined(hello);
  ASSERT_TRUE(Told().back().has_recovered());
  EXPECT_EQ(Told().back().recovered().mark_virtual_time_ns(), 77);
}

// LIVE-3.25: a server that hears of a host for the first time knows from the store what is stored:
// what it tells again is not stored twice.
TEST_F(MachinesGivenUp, AnotherServerKnowsWhatIsStored) {
  const auto link = Joined();
  const std::int64_t fence = Fence(*link);
  hosts.Receive(*link, Entries(fence, 1, false));
  ASSERT_EQ(link->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 2);
  hosts.Leave(*link);
  Hosts others({.store = bed.store(),
                .feed = feed,
                .executor = *executor,
                .server = "another server",
                .join_token = "secret",
                .clock = clock.clock()});
  const auto again = std::make_shared<FakeLink>();
  ASSERT_TRUE(others.Join(again, Hello("elsewhere/1", fence)));
  others.Receive(*again, Entries(fence, 1, false));
  EXPECT_EQ(again->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 2);
  Settle();
  EXPECT_EQ(Told().size(), 1U);
  others.CloseAll();
  Settle();
}

// LIVE-7.09: of a program that was deleted at the machine there is no etag behind it.
TEST_F(MachinesGivenUp, WhatIsDeletedAtTheMachineHasNoEtagBehindIt) {
  const auto link = Joined();
  Must(bed.store().PutPrograms("mill-1", {{.slot = 5, .object = "PA;"}}, {}, "anna"));
  v1::HostRequest request;
  v1::HostEdit& edit = *request.mutable_edit();
  edit.set_fence(Fence(*link));
  edit.set_number(1);
  edit.set_slot(5);
  edit.set_object_revision(1);
  edit.set_caller("anna");
  edit.mutable_taught()->mutable_step()->set_program(5);
  hosts.Receive(*link, std::move(request));
  EXPECT_FALSE(link->Newest(v1::HostResponse::kEditAnswer)->edit_answer().has_refusal());
  const auto taught = Must(bed.store().ListTeachRecords("mill-1", 0, 0, 9));
  ASSERT_EQ(taught.size(), 1U);
  v1::TeachEntry entry;
  ASSERT_TRUE(entry.ParseFromString(taught[0].entry));
  EXPECT_EQ(entry.etag_before(), "1");
  EXPECT_EQ(entry.etag_after(), "");
}

}  // namespace
}  // namespace rmlcell::server
