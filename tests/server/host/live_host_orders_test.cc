// Orders over the line of a host that is alive: keys, jobs, previews, programs that are taught.
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "server/host/journal.h"
#include "tests/server/host/live_host_bed.h"

namespace rmlcell::server {
namespace {

class LiveHostOrders : public LiveHost {
 protected:
  std::vector<v1::JournalEntry> Orphan() const {
    std::ifstream file(JournalPath() + ".orphan", std::ios::binary);
    return ReadJournal(std::string(std::istreambuf_iterator<char>(file), {})).entries;
  }
};

// LIVE-7.04: a key that comes before the one ahead of it waits for that.
TEST_F(LiveHostOrders, AKeyWaitsForTheOneBeforeIt) {
  Live();
  TakeControl();
  const std::int64_t second = Send(PanelKey("COVER", 2));
  const v1::HostOrderAnswer first = Ask(PanelKey("COVER", 1));
  EXPECT_FALSE(first.has_refusal()) << first.refusal().message();
  const v1::HostOrderAnswer answer = AnswerTo(second);
  EXPECT_FALSE(answer.has_refusal()) << answer.refusal().message();
}

// LIVE-7.04: for a while, and no longer.
TEST_F(LiveHostOrders, AKeyWaitsNoLongerThanItsPatience) {
  patience_.keys = HostPatience{}.keys;
  Live();
  TakeControl();
  const v1::HostOrderAnswer missing = Ask(PanelKey("COVER", 2));
  EXPECT_EQ(missing.refusal().code(), CodeText(ErrorCode::kCellKeySequence));
  EXPECT_EQ(missing.refusal().message(), "keys before it are missing");
  EXPECT_FALSE(Ask(PanelKey("COVER", 1)).has_refusal());
  EXPECT_FALSE(Ask(PanelKey("COVER", 2)).has_refusal());
}

// A key that waits when its line goes is forgotten, though it was the first order of that line: a
// line that comes behind it is not answered for it, and its number in the row is free.
TEST_F(LiveHostOrders, AKeyThatWaitsGoesWithItsLine) {
  Live();
  number_ = 100;
  TakeControl();
  v1::HostResponse first;
  *first.mutable_order() = PanelKey("COVER", 2);
  first.mutable_order()->set_number(1);
  first.mutable_order()->set_caller("anna");
  server_->Tell(first);
  AskWhereItIs();  // it was taken before
  server_->EndLine();
  server_->Told(v1::HostRequest::kHello, 2);
  for (const std::int64_t sequence : {1, 2, 3}) {
    const v1::HostOrderAnswer answer = Ask(PanelKey("COVER", sequence));
    EXPECT_FALSE(answer.has_refusal()) << answer.refusal().message();
  }
  for (const v1::HostRequest& told : server_->Told(v1::HostRequest::kAnswer, 0))
    EXPECT_NE(told.answer().number(), 1);
}

// LIVE-2.13: a key that the panel does not have is refused by its name, be it empty.
TEST_F(LiveHostOrders, AKeyThatThePanelDoesNotHave) {
  Live();
  TakeControl();
  std::int64_t sequence = 0;
  for (const std::string key : {"COFFEE", ""}) {
    const v1::HostOrderAnswer answer = Ask(PanelKey(key, ++sequence));
    EXPECT_EQ(answer.refusal().message(), "the panel has no key " + key);
  }
}

// LIVE-2.05: whoever stops the machine stops the keys that wait, too.
TEST_F(LiveHostOrders, AStopStopsTheKeysThatWait) {
  Live();
  TakeControl();
  const std::int64_t key = Send(PanelKey("COVER", 2));
  AskWhereItIs();  // it waits
  EXPECT_TRUE(Ask(StopOrder()).has_halt());
  EXPECT_EQ(AnswerTo(key).refusal().message(), "it was stopped before it began");
}

// LIVE-3.10, LIVE-2.05: whatever comes while the host is busy is answered, each once: what halts
// acts, what it stops is told so, and for what there is no room that is said.
TEST_F(LiveHostOrders, WhateverComesAtOnceIsAnswered) {
  constexpr std::size_t kOfEach = 300;  // more than may wait
  Live();
  TakeControl();
  const std::size_t before = Count(v1::HostRequest::kAnswer);
  std::string text = "PA;PA;VS1;";
  for (int line = 0; line < 300'000; ++line) text += "PU100,0;";
  v1::HostOrder long_look = PreviewOf(5, 2);
  *long_look.mutable_brought() = JobOrder("", text).run_job().programs(0);
  Send(long_look);
  const std::int64_t started = Send(StartOf());
  v1::HostOrder where;
  where.mutable_run_state();
  for (std::size_t i = 0; i < kOfEach; ++i) Send(where);
  const std::int64_t first_stop = number_ + 1;
  for (std::size_t i = 0; i < kOfEach; ++i) Send(StopOrder());
  const auto told = server_->Told(v1::HostRequest::kAnswer, before + 2 + 2 * kOfEach);
  std::map<std::int64_t, v1::HostOrderAnswer> answers;
  for (auto one = told.begin() + static_cast<std::ptrdiff_t>(before); one != told.end(); ++one)
    EXPECT_TRUE(answers.emplace(one->answer().number(), one->answer()).second);
  EXPECT_EQ(answers.size(), 2 + 2 * kOfEach);
  if (answers[started].has_refusal()) {
    EXPECT_EQ(answers[started].refusal().message(), "it was stopped before it began");
  }
  for (std::int64_t number = started + 1; number < first_stop; ++number) {
    if (answers[number].has_run_state()) continue;
    EXPECT_EQ(answers[number].refusal().code(), CodeText(ErrorCode::kCellUnavailable));
    EXPECT_EQ(answers[number].refusal().message(), "too many orders wait for it");
  }
  for (std::int64_t number = first_stop; number <= number_; ++number)
    EXPECT_TRUE(answers[number].has_halt()) << answers[number].refusal().message();
  EXPECT_NE(Ask(StopOrder()).halt().status().state(), v1::MACHINE_STATE_RUNNING);
}

// LIVE-5.04: the run of a job moves when its begin is in the store.
TEST_F(LiveHostOrders, AJobMovesWhenItsBeginIsStored) {
  Live();
  StoreAll();
  const v1::HostOrderAnswer begun = Ask(JobOrder("jobs/17"));
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  EXPECT_EQ(begun.status().run().job(), "jobs/17");
  const std::size_t before = Count(v1::HostRequest::kStatus);
  EXPECT_EQ(AwaitStatus([](const v1::MachineStatus& one) { return one.has_run(); }, before + 2)
                .run()
                .run_time_ns(),
            0);
  AwaitEntry([](const v1::JournalEntry& one) { return one.has_run_begun(); });
  StoreAll();
  AwaitStatus([](const v1::MachineStatus& one) { return one.run().run_time_ns() > 0; });
  v1::HostOrder abort;
  abort.mutable_abort();
  abort.set_for_job("jobs/17");
  Ask(abort);
  const v1::JournalEntry over =
      AwaitEntry([](const v1::JournalEntry& one) { return one.has_run_over(); });
  EXPECT_EQ(over.run_over().job(), "jobs/17");
}

// LIVE-6.01: worked out beside the machine, one after the other.
TEST_F(LiveHostOrders, AStartIsLookedAt) {
  Live();
  TakeControl();
  const v1::HostOrderAnswer none = Ask(PreviewOf(5, 0));
  EXPECT_EQ(none.refusal().code(), CodeText(ErrorCode::kCellInvalidArgument));
  for (const int step : {8, 9}) {
    const v1::HostOrderAnswer preview = Ask(PreviewOf(5, step));
    ASSERT_TRUE(preview.has_preview()) << preview.refusal().message();
    EXPECT_NE(preview.preview().preview_token(), "");
    EXPECT_EQ(preview.preview().there().fence(), 7);
  }
}

// LIVE-3.05: another host has the machine: it brakes, and what the store did not take is kept.
TEST_F(LiveHostOrders, WhatAMachineThatIsLostDidLastIsKept) {
  Live();
  TakeControl();
  ASSERT_FALSE(Ask(StartOf()).has_refusal());
  AwaitState(v1::MACHINE_STATE_RUNNING);
  v1::HostResponse lost;
  lost.mutable_lease_lost()->set_holder("workshop/2");
  server_->Tell(lost);
  EXPECT_EQ(host_.get(), 3);
  const std::vector<v1::JournalEntry> kept = Orphan();
  ASSERT_FALSE(kept.empty());
  EXPECT_TRUE(std::ranges::any_of(kept, [](const auto& one) { return one.event().has_halted(); }));
  EXPECT_TRUE(kept.back().has_mark());
  EXPECT_EQ(kept.front().sequence(), 1);
  EXPECT_TRUE(std::ranges::is_sorted(kept, std::less<>(), &v1::JournalEntry::sequence));
}

// LIVE-5.09: an end in order: the run ends with it, and the log has that.
TEST_F(LiveHostOrders, ARunEndsWithItsHost) {
  Live();
  TakeControl();
  ASSERT_FALSE(Ask(StartOf()).has_refusal());
  AwaitState(v1::MACHINE_STATE_RUNNING);
  v1::HostResponse stop;
  stop.mutable_stop()->set_reason("a test");
  server_->Tell(stop);
  EXPECT_EQ(host_.get(), 0);
  EXPECT_EQ(server_->Told(v1::HostRequest::kHandBack, 1)[0].hand_back().fence(), 7);
  const v1::JournalEntry over =
      AwaitEntry([](const v1::JournalEntry& one) { return one.has_run_over(); });
  EXPECT_EQ(over.run_over().outcome().kind(), v1::Outcome::KIND_INTERRUPTED);
  EXPECT_EQ(over.run_over().outcome().code(), CodeText(ErrorCode::kCellHostStopped));
  EXPECT_TRUE(Entries().back().has_mark());
}

// LIVE-5.09: a host that ends waits for what the store is still to say. Nothing begins meanwhile;
// what halts, what lets go and what only asks is answered as ever.
TEST_F(LiveHostOrders, NothingBeginsWhileAHostEnds) {
  Live();
  StoreAll();
  const v1::HostOrderAnswer begun = Ask(JobOrder("jobs/17"));
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  v1::HostResponse end;
  end.mutable_stop()->set_reason("a test");
  server_->Tell(end);
  v1::HostOrder acquire;
  acquire.mutable_acquire_control()->mutable_ttl()->set_seconds(60);
  for (const v1::HostOrder& order : {StartOf(), acquire, ReleaseOfControl()}) {
    const v1::HostOrderAnswer refused = Ask(order);
    EXPECT_EQ(refused.refusal().code(), CodeText(ErrorCode::kCellNotLive));
    EXPECT_EQ(refused.refusal().message(), "its host ends");
  }
  EXPECT_EQ(AskWhereItIs().run_state().fence(), 7);
  EXPECT_EQ(Ask(WhereIs("jobs/17")).run_state().fence(), 7);
  EXPECT_TRUE(Ask(StopOrder()).has_halt());
  // It came to the machine, where nobody has control.
  EXPECT_EQ(Ask(PanelKey("COVER", 1)).refusal().code(), CodeText(ErrorCode::kCellControlNeeded));
  EXPECT_EQ(Count(v1::HostRequest::kHandBack), 0U);
  AwaitEntry([](const v1::JournalEntry& one) { return one.has_run_begun(); });
  StoreAll();
  EXPECT_EQ(host_.get(), 0);
  EXPECT_EQ(server_->Told(v1::HostRequest::kHandBack, 1).size(), 1U);
  const v1::JournalEntry over =
      AwaitEntry([](const v1::JournalEntry& one) { return one.has_run_over(); });
  EXPECT_EQ(over.run_over().job(), "jobs/17");
  EXPECT_EQ(over.run_over().outcome().code(), CodeText(ErrorCode::kCellHostStopped));
}

// LIVE-6.01: one after the other; while one is worked out for a job, that is about to begin.
TEST_F(LiveHostOrders, OneStartIsLookedAtAtATime) {
  Live();
  TakeControl();
  v1::HostOrder preview = PreviewOf(5, 8);
  preview.set_for_job("jobs/16");
  ASSERT_TRUE(Ask(preview).has_preview());
  EXPECT_EQ(Ask(WhereIs("jobs/16")).refusal().code(), CodeText(ErrorCode::kCellNotFound));
  v1::HostResponse memory;
  v1::AssignedProgram& program = *memory.mutable_memory()->add_programs();
  program.set_slot(6);
  std::string text = "PA;PA;VS1;!VZ5;!PZ-50,100;!MC0;PU1000,1000;";
  for (int square = 0; square < 100'000; ++square) text += "PD3000,1000,3000,3000,1000,1000;";
  program.set_content(text + "PU0,0;");
  server_->Tell(memory);
  preview = PreviewOf(6, 100'000);
  preview.set_for_job("jobs/17");
  v1::HostOrderAnswer second;
  v1::HostOrderAnswer about;
  v1::HostOrderAnswer other;
  // On a slow computer it may be over before all that is asked has come: then once more.
  for (int tries = 0; tries < 20 && about.refusal().message() != "it is about to begin"; ++tries) {
    Send(preview);  // nobody waits for its end
    const std::int64_t second_asked = Send(PreviewOf(5, 8));
    const std::int64_t about_asked = Send(WhereIs("jobs/17"));
    const std::int64_t other_asked = Send(WhereIs("jobs/16"));
    second = AnswerTo(second_asked);
    about = AnswerTo(about_asked);
    other = AnswerTo(other_asked);
  }
  EXPECT_EQ(second.refusal().code(), CodeText(ErrorCode::kCellUnavailable));
  EXPECT_EQ(second.refusal().message(), "another start is looked at");
  EXPECT_EQ(about.refusal().code(), CodeText(ErrorCode::kCellNotLive));
  EXPECT_EQ(about.refusal().message(), "it is about to begin");
  EXPECT_EQ(other.refusal().code(), CodeText(ErrorCode::kCellNotFound));
}

// LIVE-3.22: what is not stored stays in the journal, by the fence under which it was told.
TEST_F(LiveHostOrders, WhatIsNotStoredStaysInTheJournal) {
  v1::JournalEntry large;
  large.set_fence(3);
  large.set_sequence(1);
  large.mutable_event()->mutable_message()->set_text(std::string(Journal::kBytesKept, 't'));
  ASSERT_TRUE(Journal::Open(JournalPath())->journal->Write({large}));
  Live();
  TakeControl();
  for (const double percent : {90.0, 80.0, 70.0, 60.0, 50.0})
    ASSERT_FALSE(Ask(OverrideOf(percent)).has_refusal());
  const v1::JournalEntry newest = AwaitEntry(
      [](const v1::JournalEntry& one) { return one.applied().input().override_percent() == 50.0; });
  ASSERT_GT(newest.sequence(), 9);
  v1::HostResponse stored;
  stored.mutable_entries_stored()->set_sequence(newest.sequence() - 1);
  server_->Tell(stored);
  const auto left = [this] {
    std::ifstream file(JournalPath(), std::ios::binary);
    return ReadJournal(std::string(std::istreambuf_iterator<char>(file), {})).entries;
  };
  std::vector<v1::JournalEntry> entries = left();
  const auto until = std::chrono::steady_clock::now() + kComesWithin;
  while (!entries.empty() && entries.front().fence() == 3 &&
         std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    entries = left();
  }
  ASSERT_FALSE(entries.empty());
  EXPECT_EQ(entries.front().fence(), 7);
  EXPECT_EQ(entries.front().sequence(), newest.sequence());
}

// LIVE-7.08: what is taught goes to the store, whose answer lets the keys go on.
TEST_F(LiveHostOrders, WhatIsTaughtGoesToTheStore) {
  Live(WelcomeTo("optimo"));
  TakeControl();
  v1::HostOrder open;
  open.mutable_create_session()->set_control_token(token_);
  const std::string session = Ask(open).session().name();
  std::int64_t keys = 0;
  const auto key = [&](const std::string& name) { return HandboxKey(session, name, ++keys); };
  for (const char* name :
       {"MODE_LEFT", "MODE_LEFT", "MODE_LEFT", "MODE_LEFT", "JOB", "1", "2", "ENT", "REC"})
    ASSERT_TRUE(Ask(key(name)).has_key()) << name;
  const auto refuse = [&](std::size_t number) {
    const v1::HostEdit edit = server_->Told(v1::HostRequest::kEdit, number).back().edit();
    EXPECT_EQ(edit.slot(), 12);
    EXPECT_EQ(edit.fence(), 7);
    v1::HostResponse refused;
    refused.mutable_edit_answer()->set_number(edit.number());
    refused.mutable_edit_answer()->mutable_refusal()->set_code("CELL-E9108");
    server_->Tell(refused);
  };
  refuse(1);
  const auto says_so = [](const v1::HostRequest& one) {
    return one.panel().message_code() == "CELL-E9108";
  };
  EXPECT_EQ(Await(v1::HostRequest::kPanel, says_so).panel().holder(), "anna");
  ASSERT_TRUE(Ask(key("REC")).has_key());
  const std::int64_t waits = Send(key("PREV"));
  refuse(2);
  EXPECT_TRUE(AnswerTo(waits).has_key());
  // A server that is gone answers no more: perhaps it has stored it, and perhaps not.
  const std::size_t shown = Count(v1::HostRequest::kPanel);
  ASSERT_TRUE(Ask(key("REC")).has_key());
  server_->Told(v1::HostRequest::kEdit, 3);
  server_->EndLine();
  Await(
      v1::HostRequest::kPanel,
      [](const v1::HostRequest& one) {
        return one.panel().message_code() == CodeText(ErrorCode::kCellStoreUnavailable);
      },
      shown);
}

}  // namespace
}  // namespace rmlcell::server
