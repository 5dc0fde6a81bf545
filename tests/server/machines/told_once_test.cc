// Each message of a host is what it is and no other one; what it tells is stored, answered and news
// once, over whichever line it comes (live.md 2.10, 3.02, 3.25, 5.04).
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/server/forwarding_store.h"
#include "tests/server/machines/hosts_bed.h"

namespace rmlcell::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

class ToldOnce : public HostsTest {
 protected:
  // Each answer to an order, as it comes.
  void Ask(const std::function<void(v1::HostOrder&)>& set) {
    v1::HostOrder order;
    set(order);
    hosts.Ask("mill-1", std::move(order), [this](const Result<v1::HostOrderAnswer>& answer) {
      answers.push_back(answer ? "answered" : std::string(answer.error().detail));
    });
  }
  static void Stop(v1::HostOrder& order) { order.mutable_stop(); }
  static void Read(v1::HostOrder& order) { order.mutable_read_variables(); }
  static std::ptrdiff_t Count(const FakeLink& link, v1::HostResponse::MessageCase kind) {
    const auto all = link.All();
    return std::ranges::count(all, kind, &v1::HostResponse::message_case);
  }
  // That a run has begun, and no mark behind it.
  static v1::HostRequest RunBegun(std::int64_t fence, std::int64_t sequence) {
    v1::HostRequest request = Entries(fence, sequence, true);
    request.mutable_entries()->mutable_entries()->RemoveLast();
    return request;
  }

  std::vector<std::string> answers;
};

// LIVE-2.10: STOP, HOLD, ABORT and the emergency stop are kept for a host whose line is gone; what
// does not halt is not.
TEST_F(ToldOnce, WhateverHaltsIsKept) {
  const auto first = Joined();
  hosts.Leave(*first);
  const std::vector<std::function<void(v1::HostOrder&)>> halts = {
      [](v1::HostOrder& order) { order.mutable_stop(); },
      [](v1::HostOrder& order) { order.mutable_hold(); },
      [](v1::HostOrder& order) { order.mutable_abort(); },
      [](v1::HostOrder& order) { order.mutable_emergency_stop(); }};
  for (const auto& set : halts) {
    Ask(set);
    EXPECT_EQ(answers.back(), "not delivered: it acts if this host is heard of again");
  }
  const std::vector<std::function<void(v1::HostOrder&)>> others = {
      [](v1::HostOrder& order) { order.mutable_resume(); },
      [](v1::HostOrder& order) { order.mutable_start(); }, Read};
  for (const auto& set : others) {
    Ask(set);
    EXPECT_EQ(answers.back(), "its host is not heard of");
  }
  EXPECT_EQ(Count(*first, v1::HostResponse::kOrder), 0) << "nobody is there any more";
  const auto again = Joined(Hello("elsewhere/1", Fence(*first)));
  EXPECT_EQ(Count(*again, v1::HostResponse::kOrder), 4);
}

// LIVE-3.06: an answer is no entry, an entry no panel, a panel no edit, an edit no wish for the
// lease, and that wish gives nothing back.
TEST_F(ToldOnce, AMessageIsOfOneKind) {
  const auto link = Joined();
  const std::int64_t fence = Fence(*link);
  hosts.Receive(*link, Entries(fence, 1, true));
  link->Newest(v1::HostResponse::kEntriesStored);
  Settle();
  v1::HostRequest answer;
  answer.mutable_answer()->set_number(99);  // of nobody
  hosts.Receive(*link, std::move(answer));
  Settle();
  EXPECT_EQ(Count(*link, v1::HostResponse::kEntriesStored), 1);
  v1::HostRequest panel;
  panel.mutable_panel()->set_display("READY");
  hosts.Receive(*link, std::move(panel));
  Settle();
  EXPECT_EQ(Count(*link, v1::HostResponse::kEditAnswer), 0);
  hosts.Receive(*link, Entries(fence, 3, true));
  Settle();
  ASSERT_TRUE(hosts.HandboxPanelOf("mill-1"));
  EXPECT_EQ(hosts.HandboxPanelOf("mill-1")->display(), "READY");
  v1::HostRequest edit;
  edit.mutable_edit()->set_number(1);
  edit.mutable_edit()->set_slot(5);
  edit.mutable_edit()->set_object("PA;");
  hosts.Receive(*link, std::move(edit));
  EXPECT_FALSE(link->Newest(v1::HostResponse::kEditAnswer)->edit_answer().has_refusal());
  EXPECT_TRUE(Must(bed.store().ListTeachRecords("mill-1", 0, 0, 9)).empty());  // it taught nothing
  Settle();
  EXPECT_EQ(Count(*link, v1::HostResponse::kRenewed), 0);
  v1::HostRequest renew;
  renew.mutable_renew()->set_fence(fence);
  hosts.Receive(*link, std::move(renew));
  link->Newest(v1::HostResponse::kRenewed);
  Settle();
  EXPECT_EQ(Must(bed.store().MachineLeases()).size(), 1U);
  EXPECT_EQ(Count(*link, v1::HostResponse::kHeartbeat), 0);
}

// LIVE-3.25: what is told again over another line is not stored again, be there a mark behind it or
// none; another host counts from 1.
TEST_F(ToldOnce, AnotherLineKnowsWhatIsStored) {
  const auto first = Joined();
  hosts.Receive(*first, RunBegun(Fence(*first), 1));
  EXPECT_EQ(first->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 1);
  ASSERT_EQ(Told().size(), 1U);
  hosts.Leave(*first);
  const auto again = Joined(Hello("elsewhere/1", Fence(*first)));
  hosts.Receive(*again, RunBegun(Fence(*first), 1));
  EXPECT_EQ(again->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 1);
  Settle();
  EXPECT_EQ(Told().size(), 1U);
  v1::HostHello hello = Hello("office/2");
  hello.set_computer("office");
  hosts.GiveTo("mill-1", "office", "anna", "moved");
  const auto next = Joined(hello);
  hosts.Receive(*next, RunBegun(Fence(*next), 1));
  EXPECT_EQ(next->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 1);
  ASSERT_TRUE(Told().back().has_run_begun());
  EXPECT_EQ(Told().back().fence(), Fence(*next));
}

// LIVE-3.25: where not all finds room what is stored ends with a mark: what is behind the last one
// that found some is told again.
TEST_F(ToldOnce, WhatIsStoredOfTooMuchEndsWithAMark) {
  const auto link = Joined();
  v1::HostRequest request;
  request.mutable_entries()->set_fence(Fence(*link));
  for (int i = 1; i <= 100'001; ++i) {
    v1::JournalEntry& entry = *request.mutable_entries()->add_entries();
    entry.set_sequence(i);
    entry.set_fence(Fence(*link));
    if (i == 99'998) {
      entry.mutable_mark()->set_state("where it stands");
    } else {
      entry.mutable_intent()->set_caller("anna");
    }
  }
  hosts.Receive(*link, std::move(request));
  EXPECT_TRUE(Eventually([&] { return link->closed(); }));
  EXPECT_EQ(link->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 99'998);
  const auto mark = Must(bed.store().GetMachineMark("mill-1"));
  ASSERT_TRUE(mark);
  EXPECT_EQ(mark->sequence, 99'998);
}

// LIVE-5.04: the end of a run may be among what was stored: the queue looks.
TEST_F(ToldOnce, WhatIsStoredIsNews) {
  const auto link = Joined();
  std::atomic<int> news = 0;
  hosts.OnNews([&news](const std::string& machine) { news += machine == "mill-1" ? 1 : 0; });
  hosts.Receive(*link, Entries(Fence(*link), 1, true));
  EXPECT_TRUE(Eventually([&] { return news == 1; }));
  hosts.OnNews({});
}

// LIVE-2.10: that a machine is lost is told once, however often the server looks; one that has just
// begun is not lost.
TEST_F(ToldOnce, ALostMachineIsNewsOnce) {
  const auto link = Joined();
  Tell(*link, v1::MACHINE_STATE_STARTING);
  clock.Advance(milliseconds(4'999));
  hosts.Look();
  EXPECT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_STARTING);
  Tell(*link, v1::MACHINE_STATE_RUNNING);
  std::atomic<int> news = 0;
  hosts.OnNews([&news](const std::string&) { ++news; });
  clock.Advance(milliseconds(3'001));
  for (int look = 0; look < 3; ++look) hosts.Look();
  EXPECT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_LOST);
  EXPECT_EQ(news, 1);
  hosts.OnNews({});
}

// LIVE-2.10: who was told at once that nobody answers is told nothing later.
TEST_F(ToldOnce, AnOrderIsAnsweredOnce) {
  const auto link = Joined();
  Tell(*link, v1::MACHINE_STATE_RUNNING);
  clock.Advance(milliseconds(3'001));
  hosts.Look();
  ASSERT_EQ(hosts.StatusOf("mill-1")->state(), v1::MACHINE_STATE_LOST);
  Ask(Stop);
  Ask(Read);
  EXPECT_THAT(answers, ElementsAre("its host is silent: whether it halts is not known",
                                   "its host is silent"));
  EXPECT_EQ(Count(*link, v1::HostResponse::kOrder), 1) << "what halts, and nothing else";
  clock.Advance(Hosts::kAnswerPatience + seconds(1));
  hosts.Look();
  EXPECT_EQ(answers.size(), 2U);
  hosts.Leave(*link);
  const auto again = Joined(Hello("elsewhere/1", Fence(*link)));
  hosts.Leave(*again);  // it has not said where it stands
  Ask(Stop);
  Ask(Read);
  EXPECT_EQ(answers.size(), 4U);
  clock.Advance(Hosts::kAnswerPatience + seconds(1));
  hosts.Look();
  EXPECT_EQ(answers.size(), 4U);
}

// LIVE-3.02: a line that has another one behind it answers nobody any more.
TEST_F(ToldOnce, WhoWaitsOnALineThatIsFollowedIsToldSo) {
  const auto first = Joined();
  Ask(Read);
  EXPECT_THAT(answers, IsEmpty());
  Joined(Hello("elsewhere/1", Fence(*first)));
  EXPECT_THAT(answers, ElementsAre("its host is not heard of any more"));
}

// LIVE-3.01: a machine that is given up has no host, whoever spoke for it last.
TEST_F(ToldOnce, AMachineThatIsGivenUpHasNoHost) {
  const auto link = Joined();
  Tell(*link, v1::MACHINE_STATE_IDLE);
  hosts.NoteOff("mill-1", "its host ended 5 times");
  EXPECT_FALSE(hosts.IsHosted("mill-1"));
  EXPECT_TRUE(link->closed());
  Settle();
  EXPECT_EQ(StatusOf(&hosts, Must(bed.store().GetMachine("mill-1")), {}).state(),
            v1::MACHINE_STATE_OFF);
}

// Which for a while takes nothing that is told of a machine. Thread-safe.
class DeafStore final : public ForwardingStore {
 public:
  using ForwardingStore::ForwardingStore;
  std::atomic<bool> deaf = false;

  Status AppendMachine(const storage::MachineLease& lease,
                       const storage::MachineWrite& write) override {
    if (deaf) return Error{ErrorCode::kCellStoreFailed, "the line broke", {}};
    return store_.AppendMachine(lease, write);
  }
};

// LIVE-5.20: a job of the host before is not given back before the first words of this one are
// stored, which may be of that job; nor is a host settled while something of it waits.
TEST_F(ToldOnce, NothingIsGivenBackBeforeTheFirstWordsAreStored) {
  const std::int64_t job = RunGivenTo("before/1");
  const auto state = [&] { return Must(bed.store().GetJob(job)).state; };
  DeafStore store(bed.store());
  Hosts others({.store = store,
                .feed = feed,
                .executor = *executor,
                .server = "another server",
                .join_token = "secret",
                .clock = clock.clock()});
  const auto link = std::make_shared<FakeLink>();
  ASSERT_TRUE(others.Join(link, Hello()));
  store.deaf = true;
  others.Receive(*link, Entries(Fence(*link), 1, true));
  Settle();
  EXPECT_EQ(state(), storage::JobState::kRunning);
  EXPECT_FALSE(others.IsSettled("mill-1"));
  store.deaf = false;
  v1::HostRequest beat;
  beat.mutable_heartbeat()->set_number(1);
  others.Receive(*link, beat);
  EXPECT_TRUE(Eventually([&] { return state() == storage::JobState::kQueued; }));
  EXPECT_TRUE(Eventually([&] { return others.IsSettled("mill-1"); }));
  store.deaf = true;
  others.Receive(*link, Entries(Fence(*link), 3, true));
  Settle();
  EXPECT_FALSE(others.IsSettled("mill-1"));
  others.CloseAll();
  Settle();
}

// LIVE-5.20: nor is it forgotten where the host that comes back had told a single word, and has
// none to add.
TEST_F(ToldOnce, OneWordThatIsStoredIsEnoughToGiveBack) {
  const auto first = Joined();
  hosts.Receive(*first, RunBegun(Fence(*first), 1));
  ASSERT_EQ(first->Newest(v1::HostResponse::kEntriesStored)->entries_stored().sequence(), 1);
  hosts.Leave(*first);
  const std::int64_t job = RunGivenTo("before/1");
  const auto again = Joined(Hello("elsewhere/1", Fence(*first)));
  Beat(*again);
  EXPECT_TRUE(Eventually(
      [&] { return Must(bed.store().GetJob(job)).state == storage::JobState::kQueued; }));
}

}  // namespace
}  // namespace rmlcell::server
