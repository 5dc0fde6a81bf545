// What the journal of a live machine says of who did what, by which right, and when (live.md 3.20
// to 3.24), and what its marks keep besides the machine.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "proto/recording/recording.h"
#include "server/base/version.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class AppliedInputs : public HostMachineTest {
 protected:
  std::vector<v1::JournalEntry> Of(v1::JournalEntry::WhatCase what) {
    std::vector<v1::JournalEntry> found;
    for (v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.what_case() == what) found.push_back(std::move(entry));
    }
    return found;
  }
  // The one input that acted since the last look.
  v1::InputApplied Applied() {
    const std::vector<v1::JournalEntry> applied = Of(v1::JournalEntry::kApplied);
    EXPECT_EQ(applied.size(), 1U);
    if (applied.size() != 1) return {};
    EXPECT_EQ(applied[0].virtual_time_ns(), host_->StatusAt(now_).virtual_time_ns());
    EXPECT_EQ(applied[0].time().seconds(), Stamp(now_.wall).seconds());
    return applied[0].applied();
  }
  v1::MachineMark Mark() { return host_->TakeEntries(now_, true).back().mark(); }
  v1::HostOrder Override(double percent) {
    v1::HostOrder order;
    order.mutable_override()->set_override_percent(percent);
    order.mutable_override()->set_control_token(token_);
    return order;
  }
  v1::HostOrder Factor(double factor) {
    v1::HostOrder order;
    order.mutable_factor()->set_factor(factor);
    order.mutable_factor()->set_control_token(token_);
    return order;
  }
  v1::HostOrderAnswer DoAs(const std::string& caller, v1::HostOrder order) {
    order.set_number(++number_);
    order.set_caller(caller);
    return host_->Do(order, now_);
  }
  v1::MachineRecording NewestHead() {
    static_cast<void>(host_->TakeEntries(now_, true));
    v1::HostOrder order;
    order.mutable_recording();
    const auto recording = recording::ReadFile(Do(order).recording().chunk());
    EXPECT_TRUE(recording) << recording.error().detail;
    return recording ? recording->head : v1::MachineRecording();
  }
};

// LIVE-3.20: with the control lease that was needed for it; what stops needs none.
TEST_F(AppliedInputs, SayWhoDidItAndByWhichRight) {
  MakeAndTake();
  Pass(1s);
  Of(v1::JournalEntry::kApplied);
  v1::HostOrder slower = Override(90.0);
  slower.mutable_override()->set_request_id("slower");
  ASSERT_FALSE(Do(slower).has_refusal());
  v1::InputApplied applied = Applied();
  EXPECT_EQ(applied.input().override_percent(), 90.0);
  EXPECT_EQ(applied.fence(), 7);
  EXPECT_EQ(applied.virtual_time_ns(), 1'000'000'000);
  EXPECT_EQ(applied.caller(), "anna");
  EXPECT_EQ(applied.request_id(), "slower");
  EXPECT_EQ(applied.control_lease(), 1);
  EXPECT_EQ(applied.client(), "a test");
  EXPECT_EQ(applied.source(), v1::START_SOURCE_CONSOLE);
  DoAs("bert", Stop());
  applied = Applied();
  EXPECT_EQ(applied.input().stop(), v1::HOLD_REASON_STOP);
  EXPECT_EQ(applied.caller(), "bert");
  EXPECT_EQ(applied.request_id(), "");
  EXPECT_EQ(applied.control_lease(), 0);
  EXPECT_EQ(applied.client(), "");
  ASSERT_FALSE(Do(Start()).has_refusal());
  Of(v1::JournalEntry::kApplied);
  host_->Hold(v1::HOLD_REASON_LATE, now_);
  EXPECT_EQ(Applied().caller(), "");  // nobody did
}

// LIVE-2.11: from a console, at the panel, or for a job of the queue.
TEST_F(AppliedInputs, SayWhereTheyCameFrom) {
  MakeAndTake();
  Of(v1::JournalEntry::kApplied);
  v1::HostOrder key;
  key.mutable_panel_key()->set_key("COVER");
  key.mutable_panel_key()->set_action(v1::KEY_ACTION_TAP);
  key.mutable_panel_key()->set_control_token(token_);
  for (const int sequence : {1, 2}) {
    key.mutable_panel_key()->set_sequence(sequence);
    ASSERT_FALSE(Do(key).has_refusal());
    EXPECT_EQ(Applied().source(), v1::START_SOURCE_PANEL);
  }
  ASSERT_FALSE(Do(Override(90.0)).has_refusal());
  EXPECT_EQ(Applied().source(), v1::START_SOURCE_CONSOLE);
  ASSERT_FALSE(Do(JobOf(kSquare, "square.rml")).has_refusal());
  EXPECT_EQ(Applied().source(), v1::START_SOURCE_QUEUE);
  v1::HostOrder hold;
  hold.mutable_hold();
  hold.set_for_job("jobs/17");
  ASSERT_FALSE(Do(hold).has_refusal());
  EXPECT_EQ(Applied().source(), v1::START_SOURCE_QUEUE);
  hold.clear_for_job();
  ASSERT_FALSE(Do(hold).has_refusal());
  EXPECT_EQ(Applied().source(), v1::START_SOURCE_CONSOLE);
}

// LIVE-4.01 to 4.03: each change of hands, by whoever has it then, or had it.
TEST_F(AppliedInputs, SayHowControlChangesHands) {
  Make();
  host_->Begin({}, now_);
  Control();
  v1::InputApplied applied = Applied();
  EXPECT_EQ(applied.input().control().kind(), v1::ControlChanged::KIND_ACQUIRED);
  EXPECT_EQ(applied.input().control().from(), "");
  EXPECT_EQ(applied.input().control().to(), "anna");
  EXPECT_EQ(applied.fence(), 7);
  EXPECT_EQ(applied.virtual_time_ns(), host_->StatusAt(now_).virtual_time_ns());
  EXPECT_EQ(applied.caller(), "anna");
  EXPECT_EQ(applied.control_lease(), 1);
  v1::HostOrder take;
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("next shift");
  token_ = DoAs("bert", take).control().control_token();
  applied = Applied();
  EXPECT_EQ(applied.input().control().kind(), v1::ControlChanged::KIND_TAKEN_OVER);
  EXPECT_EQ(applied.input().control().from(), "anna");
  EXPECT_EQ(applied.caller(), "bert");
  EXPECT_EQ(applied.control_lease(), 2);
  v1::HostOrder release;
  release.mutable_release_control()->set_control_token(token_);
  DoAs("bert", release);
  applied = Applied();
  EXPECT_EQ(applied.input().control().kind(), v1::ControlChanged::KIND_RELEASED);
  EXPECT_EQ(applied.input().control().from(), "bert");
  EXPECT_EQ(applied.input().control().to(), "");
  EXPECT_EQ(applied.caller(), "bert");
  EXPECT_EQ(applied.control_lease(), 0);
  Control();
  Applied();
  Pass(60s, 1s);
  applied = Applied();
  EXPECT_EQ(applied.input().control().kind(), v1::ControlChanged::KIND_EXPIRED);
  EXPECT_EQ(applied.caller(), "anna");
}

// From its begin, however long the machine stood before.
TEST_F(AppliedInputs, WhatAJobLeadsToHasTheTimeOfItsRun) {
  Make();
  host_->Begin({}, now_);
  Pass(100s, 50ms);
  ASSERT_FALSE(Do(JobOf("PA;PA;VS10;PU200,0;", "there.rml")).has_refusal());
  Pass(60s, 50ms);
  const std::vector<v1::JournalEntry> over = Of(v1::JournalEntry::kRunOver);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_EQ(over[0].job(), "jobs/17");
  EXPECT_GT(over[0].run_time_ns(), 0);
  EXPECT_LT(over[0].run_time_ns(), 60'000'000'000);
}

// LIVE-4.05: the queue has it for a job, and nobody behind that.
TEST_F(AppliedInputs, SayThatTheQueueHasControl) {
  Make();
  host_->Begin({}, now_);
  v1::HostOrder job = JobOf("PA;PA;", "nothing.rml");
  job.mutable_run_job()->mutable_job()->mutable_run()->set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
  ASSERT_FALSE(Do(job).has_refusal());
  EXPECT_EQ(host_->StatusAt(now_).control().on_loss(), v1::ControlLease::ON_LOSS_GO_ON);
  Pass(5s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  std::vector<v1::ControlChanged> changes;
  for (const v1::JournalEntry& entry : Of(v1::JournalEntry::kApplied)) {
    if (entry.applied().input().has_control()) changes.push_back(entry.applied().input().control());
  }
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(changes[0].kind(), v1::ControlChanged::KIND_ACQUIRED);
  EXPECT_EQ(changes[0].to(), "queue/jobs/17");
  EXPECT_EQ(changes[0].lease(), 1);
  EXPECT_EQ(changes[1].kind(), v1::ControlChanged::KIND_RELEASED);
  EXPECT_EQ(changes[1].from(), "queue/jobs/17");
  EXPECT_FALSE(host_->StatusAt(now_).has_control());
}

// LIVE-4.05: of a run that is over the queue gets no control, though control runs out in the same
// moment.
TEST_F(AppliedInputs, SayNothingOfTheQueueBehindTheRun) {
  const auto begin = [this] {
    Make();
    host_->Begin({}, now_);
    ASSERT_FALSE(Do(JobOf("PA;PA;VS5;PU1000,0;", "there.rml")).has_refusal());
  };
  begin();
  int steps = 0;
  for (; State() != v1::MACHINE_STATE_IDLE && steps < 1'200; ++steps) Pass(50ms, 50ms);
  ASSERT_GT(steps, 21);
  begin();
  Pass(50ms * (steps - 21), 50ms);
  v1::HostOrder take;
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("a look");
  take.mutable_acquire_control()->set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
  // Until the middle of the last step.
  take.mutable_acquire_control()->mutable_ttl()->set_seconds(1);
  take.mutable_acquire_control()->mutable_ttl()->set_nanos(25'000'000);
  ASSERT_FALSE(Do(take).has_refusal());
  Pass(50ms * 20, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  ASSERT_TRUE(host_->StatusAt(now_).has_control());
  Of(v1::JournalEntry::kApplied);
  Pass(50ms, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const std::vector<v1::JournalEntry> applied = Of(v1::JournalEntry::kApplied);
  ASSERT_EQ(applied.size(), 1U);
  EXPECT_EQ(applied[0].applied().input().control().kind(), v1::ControlChanged::KIND_EXPIRED);
}

// LIVE-3.11: how fast its time goes is kept for the next host, where it is not that of the clock.
TEST_F(AppliedInputs, TheFactorOfItsTimeIsKept) {
  MakeAndTake();
  EXPECT_EQ(Mark().factor(), 0.0);
  ASSERT_FALSE(Do(Factor(2.0)).has_refusal());
  const std::vector<v1::JournalEntry> entries = host_->TakeEntries(now_, true);
  const auto applied = std::ranges::find_if(entries, &v1::JournalEntry::has_applied);
  ASSERT_NE(applied, entries.end());
  EXPECT_EQ(applied->applied().input().factor(), 2.0);
  EXPECT_EQ(entries.back().mark().factor(), 2.0);
  auto made = HostMachine::Make({.name = "machines/mill-1",
                                 .host = "workshop/2",
                                 .fence = 8,
                                 .family = families::FindFamily("rml1"),
                                 .profile = "srm-20",
                                 .factor = 10.0},
                                now_, [] { return std::string("token"); });
  ASSERT_TRUE(made) << made.error().detail;
  host_ = *std::move(made);
  EXPECT_EQ(host_->StatusAt(now_).factor(), 10.0);
  Pass(1s);
  EXPECT_EQ(host_->StatusAt(now_).virtual_time_ns(), 10'000'000'000);
}

// LIVE-3.27, LIVE-4.02: when it acted, of whichever machine it was refused, and until when control
// is kept.
TEST_F(AppliedInputs, AnswersSayWhenAndOfWhat) {
  MakeAndTake();
  Pass(3s);
  const auto now = [this] { return Stamp(now_.wall).SerializeAsString(); };
  const v1::HostOrderAnswer started = Do(Start());
  EXPECT_EQ(started.acted_at().SerializeAsString(), now());
  Pass(2s);
  const v1::HostOrderAnswer stopped = Do(Stop());
  EXPECT_EQ(stopped.acted_at().SerializeAsString(), now());
  EXPECT_EQ(stopped.halt().acted_at().SerializeAsString(), now());
  const v1::HostOrderAnswer refused = Do(Start());
  EXPECT_EQ(refused.machine_refusal().machine(), "machines/mill-1");
  EXPECT_EQ(refused.acted_at().SerializeAsString(), now());
  v1::HostOrder renew;
  renew.mutable_renew_control()->set_control_token(token_);
  const v1::HostOrderAnswer renewed = Do(renew);
  ASSERT_TRUE(renewed.has_control_kept());
  EXPECT_EQ(renewed.control_kept().lease().number(), 1);
  EXPECT_EQ(renewed.control_kept().lease().expire_time().SerializeAsString(),
            Stamp(now_.wall + 60s).SerializeAsString());
}

// LIVE-3.20: that an order is about to act says all of it, and counts on: nothing has its number.
TEST_F(AppliedInputs, AnIntentSaysWhatIsAboutToAct) {
  MakeAndTake();
  Pass(2s);
  const std::int64_t before = host_->TakeEntries(now_, true).back().sequence();
  v1::HostOrder start = Start("the one");
  start.set_caller("anna");
  const v1::JournalEntry entry = host_->IntentOf(start, now_);
  EXPECT_EQ(entry.sequence(), before + 1);
  EXPECT_EQ(entry.fence(), 7);
  EXPECT_EQ(entry.intent().fence(), 7);
  EXPECT_EQ(entry.intent().virtual_time_ns(), 2'000'000'000);
  EXPECT_EQ(entry.intent().caller(), "anna");
  EXPECT_EQ(entry.intent().request_id(), "the one");
  EXPECT_EQ(entry.intent().input().start().program(), 5);
  EXPECT_EQ(entry.intent().input().start().job(), "");
  const v1::JournalEntry of_a_job = host_->IntentOf(JobOf(kSquare, "square.rml"), now_);
  EXPECT_EQ(of_a_job.sequence(), before + 2);
  EXPECT_EQ(of_a_job.intent().input().start().job(), "jobs/17");
  const std::vector<v1::JournalEntry> behind = host_->TakeEntries(now_, true);
  ASSERT_EQ(behind.size(), 1U);  // a mark: nothing has acted
  EXPECT_EQ(behind[0].sequence(), before + 3);
}

// LIVE-3.40: the head of a recording says of what it is, and what played it.
TEST_F(AppliedInputs, ARecordingSaysOfWhatItIs) {
  auto made = HostMachine::Make({.name = "machines/mill-1",
                                 .host = "workshop/1",
                                 .fence = 7,
                                 .family = families::FindFamily("rml1"),
                                 .profile = "srm-20",
                                 .parameters = {{"ORIGIN_X", "5"}}},
                                now_, [this] { return "token " + std::to_string(++tokens_); });
  ASSERT_TRUE(made) << made.error().detail;
  host_ = *std::move(made);
  host_->Begin({}, now_);
  const v1::MachineRecording head = NewestHead();
  EXPECT_EQ(head.engine_version(), kVersion);
  EXPECT_EQ(head.machine(), "machines/mill-1");
  EXPECT_EQ(head.family(), "rml1");
  EXPECT_EQ(head.profile(), "srm-20");
  ASSERT_EQ(head.parameters_size(), 1);
  EXPECT_EQ(head.parameters().at("ORIGIN_X"), "5");
  EXPECT_EQ(head.fence(), 7);
}

// LIVE-5.03: what is stored already need not come along.
TEST_F(AppliedInputs, AnObjectThatIsStoredIsNotBrought) {
  MakeAndTake();
  v1::HostOrder job = JobOf(kSquare, "square.rml");
  job.mutable_run_job()->mutable_programs(0)->set_is_source(false);
  ASSERT_FALSE(Do(job).has_refusal());
  EXPECT_FALSE(NewestHead().has_brought());
  v1::HostOrder abort;
  abort.mutable_abort();
  ASSERT_FALSE(Do(abort).has_refusal());
  Pass(3s);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  job.mutable_run_job()->mutable_programs(0)->set_content("PA;PA;VS5;PU100,0;");
  const v1::HostOrderAnswer begun = Do(job);
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  EXPECT_EQ(NewestHead().brought().content(), "PA;PA;VS5;PU100,0;");
}

// LIVE-3.30: what a host did not get to the store is told by the next one, by its own numbers;
// marks and what was only about to act are not.
TEST_F(AppliedInputs, WhatWasNotStoredIsToldByTheNextHost) {
  v1::JournalEntry mark;
  mark.set_fence(6);
  mark.set_sequence(8);
  mark.mutable_mark()->set_clean(true);
  v1::JournalEntry intent;
  intent.set_fence(6);
  intent.set_sequence(9);
  intent.mutable_intent()->set_caller("anna");
  v1::JournalEntry event;
  event.set_fence(6);
  event.set_sequence(10);
  event.set_virtual_time_ns(50);
  event.set_job("jobs/3");
  event.mutable_event()->mutable_message()->set_text("hello");
  auto made = HostMachine::Make({.name = "machines/mill-1",
                                 .host = "workshop/2",
                                 .fence = 7,
                                 .family = families::FindFamily("rml1"),
                                 .profile = "srm-20",
                                 .untold = {mark, intent, event}},
                                now_, [] { return std::string("token"); });
  ASSERT_TRUE(made) << made.error().detail;
  host_ = *std::move(made);
  host_->Begin({}, now_);
  const std::vector<v1::JournalEntry> told = host_->TakeEntries(now_, true);
  ASSERT_EQ(told.size(), 2U);
  event.set_fence(7);
  event.set_sequence(1);
  EXPECT_EQ(told[0].SerializeAsString(), event.SerializeAsString());
  EXPECT_TRUE(told[1].has_mark());
  EXPECT_EQ(told[1].sequence(), 2);
}

// LIVE-5.08, LIVE-5.20: where a run was cut off, how long it had gone, and that it was the last.
TEST_F(AppliedInputs, ARunThatWasCutOffIsToldWithItsPlace) {
  Make();
  host_->Begin({}, now_);
  ASSERT_FALSE(Do(JobOf(kSquare, "square.rml")).has_refusal());
  Pass(30s, 50ms);
  const v1::MachineMark mark = Mark();
  ASSERT_EQ(mark.place().step(), 8);
  inspect_job_ = mark.job();
  Make(mark.state(), true, mark);
  const std::vector<v1::JournalEntry> told = Of(v1::JournalEntry::kRunOver);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].virtual_time_ns(), mark.virtual_time_ns());
  const v1::RunOver& over = told[0].run_over();
  EXPECT_EQ(over.run(), 1);
  EXPECT_EQ(over.program(), 5);
  EXPECT_EQ(over.outcome().place().step(), 8);
  EXPECT_EQ(over.outcome().cycle_time_ns(), mark.run_time_ns());
  const v1::LastRun last = host_->StatusAt(now_).last_run();
  EXPECT_EQ(last.job(), "jobs/17");
  EXPECT_EQ(last.outcome().kind(), v1::Outcome::KIND_INTERRUPTED);
}

// LIVE-5.09: an orderly end is told as well, once, and with where it was.
TEST_F(AppliedInputs, AnOrderlyEndIsToldOnce) {
  MakeAndTake();
  host_->EndRun(now_);
  EXPECT_THAT(Of(v1::JournalEntry::kRunOver), IsEmpty());  // none is open
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(30s, 50ms);
  Do(Stop());
  Pass(2s);
  host_->EndRun(now_);
  host_->EndRun(now_);
  const std::vector<v1::JournalEntry> told = Of(v1::JournalEntry::kRunOver);
  ASSERT_EQ(told.size(), 1U);
  const v1::MachineStatus status = host_->StatusAt(now_);
  EXPECT_EQ(told[0].virtual_time_ns(), status.virtual_time_ns());
  EXPECT_EQ(told[0].run_over().program(), 5);
  EXPECT_EQ(told[0].run_over().outcome().place().step(), 8);
  EXPECT_EQ(told[0].run_over().outcome().cycle_time_ns(), status.run().run_time_ns());
  EXPECT_EQ(told[0].run_over().outcome().kind(), v1::Outcome::KIND_INTERRUPTED);
}

// LIVE-5.20: what is moved by hand is no run that could be cut off, ZERO among it.
TEST_F(AppliedInputs, WhatIsMovedByHandLeavesACleanMark) {
  MakeOptimo();
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder manual;
  manual.mutable_mode()->set_mode(v1::OPERATING_MODE_MANUAL);
  manual.mutable_mode()->set_control_token(token_);
  ASSERT_FALSE(Do(manual).has_refusal());
  v1::HostOrder zero;
  zero.mutable_zero()->set_control_token(token_);
  const v1::HostOrderAnswer begun = Do(zero);
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  ASSERT_TRUE(host_->run_open());
  const v1::MachineMark mark = Mark();
  EXPECT_TRUE(mark.clean());
  EXPECT_FALSE(mark.has_base());
  host_->EndRun(now_);
  EXPECT_THAT(Of(v1::JournalEntry::kRunOver), IsEmpty());
  EXPECT_TRUE(host_->run_open());
}

// LIVE-3.23: what begins is marked at once, though something else comes to it before it is written.
TEST_F(AppliedInputs, WhatBeginsIsMarkedAtOnce) {
  MakeAndTake();
  Mark();
  ASSERT_FALSE(Do(Start()).has_refusal());
  ASSERT_FALSE(Do(Override(90.0)).has_refusal());
  const std::vector<v1::JournalEntry> told = host_->TakeEntries(now_);
  ASSERT_FALSE(told.empty());
  ASSERT_TRUE(told.back().has_mark());
  EXPECT_FALSE(told.back().mark().clean());
}

// LIVE-3.23, LIVE-3.26: what happens on the way is told with the next tenth of a second.
TEST_F(AppliedInputs, WhatHappensOnTheWayWaitsATenthOfASecond) {
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(1s);
  Mark();
  ASSERT_FALSE(Do(Override(90.0)).has_refusal());
  Pass(90ms);
  EXPECT_THAT(host_->TakeEntries(now_), IsEmpty());
  Pass(10ms);
  EXPECT_EQ(host_->TakeEntries(now_).size(), 2U);  // and a mark
}

// LIVE-3.23: a machine that was marked on its way is marked where it came to rest.
TEST_F(AppliedInputs, WhatCameToRestIsMarkedThere) {
  MakeAndTake();
  v1::HostOrder key;
  key.mutable_panel_key()->set_key("X+");
  key.mutable_panel_key()->set_control_token(token_);
  for (const auto action : {v1::KEY_ACTION_PRESS, v1::KEY_ACTION_RELEASE}) {
    key.mutable_panel_key()->set_action(action);
    key.mutable_panel_key()->set_sequence(key.panel_key().sequence() + 1);
    ASSERT_FALSE(Do(key).has_refusal());
    if (action == v1::KEY_ACTION_PRESS) Pass(100ms);
  }
  const std::string on_its_way = Mark().state();
  ASSERT_EQ(State(), v1::MACHINE_STATE_STOPPING);
  Pass(1s);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const std::vector<v1::JournalEntry> told = host_->TakeEntries(now_);
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(told.back().mark().clean());
  EXPECT_NE(told.back().mark().state(), on_its_way);
}

// What a machine has is told no more; what it begins with did not happen now.
TEST_F(AppliedInputs, WhatItBeginsWithDidNotHappen) {
  Make();
  v1::HostMemory memory;
  v1::AssignedProgram& program = *memory.add_programs();
  program.set_slot(9);
  program.set_content("PU9,0;");
  host_->Begin(memory, now_);
  EXPECT_THAT(Told(), ElementsAre("clean mark"));
  host_->Change(memory, now_);
  EXPECT_THAT(Told(), IsEmpty());
  program.set_content("PU8,0;");
  host_->Change(memory, now_);
  EXPECT_THAT(Told(), ElementsAre(Input(v1::AppliedInput::kProgramChanged), "clean mark"));
  // What was made of the same program is another matter.
  program.set_executable("made of it");
  host_->Change(memory, now_);
  EXPECT_THAT(Told(), ElementsAre(Input(v1::AppliedInput::kProgramChanged), "clean mark"));
  host_->Change(memory, now_);
  EXPECT_THAT(Told(), IsEmpty());
}

// LIVE-3.14: nothing is held that does not move.
TEST_F(AppliedInputs, WhatStandsIsNotHeld) {
  MakeAndTake();
  host_->TakeEntries(now_, true);
  host_->Hold(v1::HOLD_REASON_SERVER_LOST, now_);
  EXPECT_THAT(host_->TakeEntries(now_), IsEmpty());
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_UNSPECIFIED);
}

}  // namespace
}  // namespace rmlcell::server
