// RUN jobs on a machine as its host has it (live.md 5): what keeps them from it, how they begin,
// who has control meanwhile, and what is told of them.
#include <algorithm>
#include <utility>

#include "server/host/recovered.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class HostJobsTest : public HostMachineTest {
 protected:
  static v1::HostOrder Job(const std::string& text = kSquare, int slot = 5) {
    v1::HostOrder order;
    v1::WorkerAssignment& assignment = *order.mutable_run_job();
    assignment.mutable_job()->set_name("jobs/17");
    assignment.set_main_program(slot);
    v1::AssignedProgram& program = *assignment.add_programs();
    program.set_slot(slot);
    program.set_file_name("square.rml");
    program.set_is_source(true);
    program.set_content(text);
    return order;
  }
  static v1::HostOrder For(const std::string& job, v1::HostOrder order) {
    order.set_for_job(job);
    return order;
  }
  v1::MachineStatus Status() { return host_->StatusAt(now_); }
  std::vector<std::string> Blockers() {
    std::vector<std::string> codes;
    const v1::MachineStatus status = Status();
    for (const v1::StartBlocker& one : status.start_blockers()) codes.push_back(one.code());
    return codes;
  }
  // Of what was told since the last look, those of this kind.
  std::vector<v1::JournalEntry> Of(v1::JournalEntry::WhatCase what) {
    std::vector<v1::JournalEntry> found;
    for (v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.what_case() == what) found.push_back(std::move(entry));
    }
    return found;
  }
  static v1::HostOrder Mode(v1::OperatingMode mode, const std::string& token) {
    v1::HostOrder order;
    order.mutable_mode()->set_mode(mode);
    order.mutable_mode()->set_control_token(token);
    return order;
  }
};

// LIVE-4.05, LIVE-5.04: it begins at once; the queue has control until its end.
TEST_F(HostJobsTest, TheQueueHasControlForAJob) {
  Make();
  EXPECT_THAT(Blockers(), IsEmpty());
  EXPECT_EQ(Do(Job()).status().state(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(Status().run().job(), "jobs/17");
  EXPECT_EQ(Status().run().source(), v1::START_SOURCE_QUEUE);
  EXPECT_EQ(Status().control().holder(), "queue/jobs/17");
  EXPECT_FALSE(Status().control().has_expire_time());
  EXPECT_THAT(Blockers(), ElementsAre("CELL-E9421"));
  const auto entries = host_->TakeEntries(now_, true);
  EXPECT_THAT(entries, testing::Each(testing::Property(&v1::JournalEntry::job, "jobs/17")));
  EXPECT_EQ(entries.front().applied().input().start().job(), "jobs/17");
  EXPECT_EQ(entries.front().applied().source(), v1::START_SOURCE_QUEUE);
  EXPECT_EQ(entries.back().mark().job(), "jobs/17");
  EXPECT_FALSE(entries.back().mark().clean());
  Pass(5s, 50ms);
  EXPECT_EQ(Status().control().holder(), "queue/jobs/17");
  Pass(3min, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_FALSE(Status().has_control());
  const auto over = Of(v1::JournalEntry::kRunOver);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_EQ(over.front().run_over().job(), "jobs/17");
  EXPECT_EQ(over.front().job(), "jobs/17");
  EXPECT_GT(over.front().run_time_ns(), 80'000'000'000);
  EXPECT_EQ(over.front().run_over().outcome().kind(), v1::Outcome::KIND_COMPLETED);
  // What comes behind it is nobody's.
  EXPECT_EQ(Do(Stop()).halt().status().state(), v1::MACHINE_STATE_IDLE);
}

// The time of a run counts from its begin, however long the machine has stood before.
TEST_F(HostJobsTest, WhatIsToldOfARunHasItsTime) {
  Make();
  Pass(3s, 50ms);
  Do(Job("PA;PA;VS10;PU200,0;"));
  Pass(30s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const auto entries = host_->TakeEntries(now_, true);
  const auto begun = std::ranges::find_if(entries, &v1::JournalEntry::has_run_begun);
  const auto over = std::ranges::find_if(entries, &v1::JournalEntry::has_run_over);
  ASSERT_NE(begun, entries.end());
  ASSERT_NE(over, entries.end());
  EXPECT_GT(begun->virtual_time_ns(), 2'000'000'000);
  EXPECT_EQ(begun->run_time_ns(), 0);
  EXPECT_EQ(begun->run_begun().job(), "jobs/17");
  EXPECT_GT(over->run_time_ns(), 0);
  EXPECT_EQ(over->run_time_ns(), over->virtual_time_ns() - begun->virtual_time_ns());
}

// Nor does a start that is refused meanwhile count, which takes no number either.
TEST_F(HostJobsTest, AStartThatIsRefusedLeavesTheRunAsItIs) {
  Make();
  Do(Job());
  Pass(5s, 50ms);
  v1::HostOrder take;
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("a look");
  token_ = Do(take).control().control_token();
  ASSERT_TRUE(Do(Start()).has_refusal());
  Pass(1s, 50ms);
  Do(For("jobs/17", Stop()));
  const auto entries = host_->TakeEntries(now_, true);
  for (std::size_t i = 1; i < entries.size(); ++i)
    EXPECT_EQ(entries[i].sequence(), entries[i - 1].sequence() + 1);
  EXPECT_EQ(std::ranges::count_if(
                entries, [](const auto& one) { return one.applied().input().has_start(); }),
            1);
  const auto stopped = std::ranges::find_if(entries, [](const auto& one) {
    return one.applied().input().input_case() == v1::AppliedInput::kStop;
  });
  ASSERT_NE(stopped, entries.end());
  EXPECT_GT(stopped->run_time_ns(), 5'000'000'000);
}

// LIVE-6.01: a mark says up to where its run could be worked out again.
TEST_F(HostJobsTest, AMarkSaysHowFarItsRunWas) {
  Make();
  Pass(3s, 50ms);
  Do(Job());
  Pass(5s, 50ms);
  const v1::MachineMark mark = host_->TakeEntries(now_, true).back().mark();
  EXPECT_GT(mark.run_time_ns(), 4'000'000'000);
  EXPECT_EQ(mark.base().until_ns(), mark.run_time_ns());
}

// LIVE-5.05: orders for the job need no token while the queue has control, and are for this job.
TEST_F(HostJobsTest, OrdersForAJobAreForThatJob) {
  Make();
  Do(Job());
  Pass(1s);
  EXPECT_EQ(Do(For("jobs/18", Stop())).refusal().code(), "CELL-E9421");
  EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(Do(For("jobs/17", Stop())).halt().status().state(), v1::MACHINE_STATE_STOPPING);
  Pass(2s);
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Do(Resume()).refusal().code(), "CELL-E9420");
  EXPECT_EQ(Do(For("jobs/18", Resume())).refusal().code(), "CELL-E9421");
  EXPECT_EQ(Do(For("jobs/17", Resume())).status().state(), v1::MACHINE_STATE_RUNNING);
  v1::HostOrder abort;
  abort.mutable_abort();
  Do(For("jobs/17", abort));
  Pass(2s);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(Of(v1::JournalEntry::kRunOver).front().run_over().outcome().kind(),
            v1::Outcome::KIND_CANCELLED);
  EXPECT_EQ(Do(For("jobs/17", Stop())).refusal().code(), "CELL-E9421");
}

// LIVE-5.04: nothing of the run of a job moves before its begin is in the store; that wait is no
// time of the machine. A STOP is not put off by it, and has stopped nothing that moved.
TEST_F(HostJobsTest, ARunOfAJobMovesWhenItsBeginIsStored) {
  for (const bool stopped : {false, true}) {
    Make();
    stores_ = false;
    const v1::MachineStatus before = Status();
    ASSERT_FALSE(Do(Job()).has_refusal());
    Pass(40s, 50ms);
    EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
    EXPECT_EQ(Status().virtual_time_ns(), before.virtual_time_ns());
    if (stopped) {
      Do(For("jobs/17", Stop()));
      Pass(1s);
      EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
      for (int i = 0; i < before.axes_size(); ++i)
        EXPECT_EQ(Status().axes(i).value(), before.axes(i).value());
      Do(For("jobs/17", Resume()));
      Pass(5s);
    }
    std::int64_t newest = 0;
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      EXPECT_FALSE(entry.has_clock_slipped());
      if (entry.has_run_begun()) newest = entry.sequence();
    }
    const std::int64_t waited = Status().virtual_time_ns();
    host_->NoteStored(newest - 1);
    Pass(1s);
    EXPECT_EQ(Status().virtual_time_ns(), waited);
    host_->NoteStored(newest + 1);
    Pass(10ms);
    Pass(5s);
    EXPECT_EQ(Status().virtual_time_ns() - waited, 5'000'000'000);
  }
}

// LIVE-4.05: a person takes control over; then the job is resumed with his token alone.
TEST_F(HostJobsTest, APersonTakesControlOverFromTheQueue) {
  Make();
  Do(Job());
  v1::HostOrder take;
  take.mutable_acquire_control()->set_client("a test");
  const v1::HostOrderAnswer held = Do(take);
  EXPECT_EQ(held.refusal().code(), "CELL-E9408");
  EXPECT_THAT(held.refusal().message(), HasSubstr("queue/jobs/17"));
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("the clamp is loose");
  take.mutable_acquire_control()->mutable_ttl()->set_seconds(60);
  const std::string token = Do(take).control().control_token();
  EXPECT_FALSE(token.empty());
  EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(Status().run().job(), "jobs/17");
  Do(Stop());
  Pass(2s);
  EXPECT_EQ(Do(For("jobs/17", Resume())).refusal().code(), "CELL-E9420");
  token_ = token;
  EXPECT_EQ(Do(For("jobs/17", Resume())).status().state(), v1::MACHINE_STATE_RUNNING);
}

// LIVE-4.05, LIVE-4.02: when he gives it back the run is the queue's again, held as he wanted; and
// when it runs out.
TEST_F(HostJobsTest, TheQueueHasControlAgain) {
  for (const bool runs_out : {false, true}) {
    Make();
    Do(Job());
    v1::HostOrder take;
    take.mutable_acquire_control()->set_take_over(true);
    take.mutable_acquire_control()->set_reason("it chatters");
    const std::string token = Do(take).control().control_token();
    if (runs_out) {
      Pass(6s);
      Pass(40s, 50ms);  // to the end of a side
    } else {
      v1::HostOrder release;
      release.mutable_release_control()->set_control_token(token);
      Do(release);
      Pass(43s, 50ms);
    }
    EXPECT_EQ(Status().control().holder(), "queue/jobs/17") << runs_out;
    EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
    EXPECT_EQ(Status().hold_reason(), v1::HOLD_REASON_CONTROL);
    EXPECT_EQ(Do(For("jobs/17", Resume())).status().state(), v1::MACHINE_STATE_RUNNING);
    Pass(3min, 50ms);
    EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
    EXPECT_FALSE(Status().has_control());
  }
}

// LIVE-4.02: or it goes on, as he wanted.
TEST_F(HostJobsTest, TheRunGoesOnWithTheQueue) {
  Make();
  Do(Job());
  v1::HostOrder take;
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("slower");
  take.mutable_acquire_control()->set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder release;
  release.mutable_release_control()->set_control_token(Do(take).control().control_token());
  Do(release);
  EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(Status().control().holder(), "queue/jobs/17");
  EXPECT_EQ(Status().control().on_loss(), v1::ControlLease::ON_LOSS_GO_ON);
}

// LIVE-5.02 (a): what keeps it in the queue, told in the status and by the refusal alike.
TEST_F(HostJobsTest, WhatKeepsAJobFromItsMachine) {
  Make();
  Control();
  EXPECT_THAT(Blockers(), ElementsAre("CELL-E9408"));
  // Whoever has control does not keep his own.
  v1::HostOrder of_bert = Job();
  of_bert.set_number(99);
  of_bert.set_caller("bert");
  EXPECT_EQ(host_->Do(of_bert, now_).refusal().code(), "CELL-E9408");
  Do(Mode(v1::OPERATING_MODE_MANUAL, token_));
  EXPECT_THAT(Blockers(), ElementsAre("CELL-E9423", "CELL-E9408"));
  EXPECT_EQ(Do(Job()).refusal().code(), "CELL-E9423");
  Do(Mode(v1::OPERATING_MODE_REMOTE, token_));
  v1::HostOrder emergency;
  emergency.mutable_emergency_stop();
  Do(emergency);
  ASSERT_EQ(Blockers().size(), 2U);
  EXPECT_EQ(Do(Job()).refusal().code(), Blockers().front());
  EXPECT_EQ(Status().alarms(0).diagnostic().code(), Blockers().front());
}

// LIVE-5.02 (a): all of it at once, in the status and with the refusal, where what refused it is
// first.
TEST_F(HostJobsTest, AllThatKeepsAJobIsTold) {
  Make();
  Control();
  Do(Mode(v1::OPERATING_MODE_MANUAL, token_));
  v1::HostOrder door;
  door.mutable_inputs()->add_inputs()->set_door_open(true);
  door.mutable_inputs()->set_control_token(token_);
  ASSERT_FALSE(Do(door).has_refusal());
  EXPECT_THAT(Blockers(), ElementsAre("CELL-E9423", "CELL-E9433", "CELL-E9408"));
  const auto told = [](const v1::HostOrderAnswer& answer) {
    std::vector<std::string> codes = {answer.refusal().code() + ":"};
    for (const v1::StartBlocker& one : answer.start_blockers()) codes.push_back(one.code());
    return codes;
  };
  EXPECT_THAT(told(Do(Job())), ElementsAre("CELL-E9423:", "CELL-E9423", "CELL-E9433"));
  EXPECT_THAT(told(Do(Start("a start"))), ElementsAre("CELL-E9423:", "CELL-E9423", "CELL-E9433"));
  v1::HostOrder of_bert = Job();
  of_bert.set_number(99);
  of_bert.set_caller("bert");
  EXPECT_THAT(told(host_->Do(of_bert, now_)),
              ElementsAre("CELL-E9408:", "CELL-E9408", "CELL-E9423", "CELL-E9433"));
  v1::HostOrder emergency;
  emergency.mutable_emergency_stop();
  Do(emergency);
  EXPECT_EQ(Blockers().size(), 4U);
  EXPECT_EQ(Blockers().front(), Status().alarms(0).diagnostic().code());
  // What is wrong with the order itself is no matter of how the machine stands.
  v1::HostOrder without_token = Start();
  without_token.mutable_start()->clear_control_token();
  EXPECT_THAT(told(Do(without_token)), ElementsAre("CELL-E9420:"));
}

TEST_F(HostJobsTest, AMachineThatWaitsForAnInspectionBeginsNoJob) {
  Make({}, true);
  EXPECT_THAT(Blockers(), ElementsAre("CELL-E9409"));
  EXPECT_EQ(Do(Job()).refusal().code(), "CELL-E9409");
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
}

TEST_F(HostJobsTest, ARunThatIsOpenKeepsAJobWaiting) {
  Make();
  Control();
  Do(Start());
  EXPECT_EQ(Do(Job()).refusal().code(), "CELL-E9421");
  EXPECT_EQ(Status().run().job(), "");
}

// LIVE-5.03: what the job brought is for its run alone; nothing of it stays in the memory.
TEST_F(HostJobsTest, AJobBringsItsProgram) {
  Make();
  EXPECT_EQ(Do(Job("PA;PA;VS5;PU100,0;", 9)).status().state(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(Status().run().program(), 9);
  Pass(1min, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  Control();
  EXPECT_EQ(Do(Start("", 9)).refusal().code(), "CELL-E9004");
  v1::HostOrder without = Job();
  without.mutable_run_job()->clear_programs();
  EXPECT_EQ(Do(without).refusal().code(), "CELL-E9003");
}

// LIVE-5.01, LIVE-5.20: a run that was cut off is told as the end of its job.
TEST_F(HostJobsTest, AJobThatWasCutOffIsInterrupted) {
  Make();
  Do(Job());
  Pass(5s, 50ms);
  v1::MachineMark mark = host_->TakeEntries(now_, true).back().mark();
  EXPECT_EQ(mark.job(), "jobs/17");
  const std::int64_t moved = mark.run_time_ns();
  const std::string state = mark.state();
  Make(state, true, mark);
  const auto entries = host_->TakeEntries(now_, true);
  ASSERT_TRUE(entries.front().has_run_over());
  EXPECT_EQ(entries.front().job(), "jobs/17");
  EXPECT_EQ(entries.front().run_over().job(), "jobs/17");
  EXPECT_EQ(entries.front().run_time_ns(), moved);
  EXPECT_EQ(entries.front().run_over().outcome().kind(), v1::Outcome::KIND_INTERRUPTED);
  EXPECT_EQ(entries.front().run_over().outcome().code(), "CELL-E9411");
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  EXPECT_FALSE(Status().has_run());
}

// Whoever asks is told whether a job was begun here; of one that is over, too.
TEST_F(HostJobsTest, ItKnowsWhichJobsItBegan) {
  Make();
  v1::HostOrder ask;
  ask.mutable_run_state();
  EXPECT_EQ(Do(For("jobs/17", ask)).refusal().code(), "CELL-E9004");
  Do(Job());
  EXPECT_FALSE(Do(For("jobs/17", ask)).has_refusal());
  Pass(3min, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_FALSE(Do(For("jobs/17", ask)).has_refusal());
  EXPECT_EQ(Do(For("jobs/18", ask)).refusal().code(), "CELL-E9004");
}

// LIVE-2.11: a job whose machine leaves REMOTE is held, and goes on in REMOTE alone.
TEST_F(HostJobsTest, AJobIsHeldWhereItsMachineLeavesRemote) {
  Make();
  Do(Job());
  v1::HostOrder take;
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("a look");
  take.mutable_acquire_control()->mutable_ttl()->set_seconds(60);
  token_ = Do(take).control().control_token();
  Pass(20s, 50ms);
  Do(Mode(v1::OPERATING_MODE_SINGLE, token_));
  Pass(10s, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Status().hold_reason(), v1::HOLD_REASON_MODE);
  EXPECT_EQ(Do(Resume()).refusal().code(), "CELL-E9423");
  Do(Mode(v1::OPERATING_MODE_REMOTE, token_));
  EXPECT_EQ(Do(Resume()).status().state(), v1::MACHINE_STATE_RUNNING);
}

// LIVE-5.09: a host that ends in order says so, and the next one waits for an inspection.
TEST_F(HostJobsTest, AnOrderlyEndCutsTheRunOff) {
  Make();
  Do(Job());
  Pass(5s, 50ms);
  Do(Stop());
  Pass(2s);
  host_->TakeEntries(now_, true);
  host_->EndRun(now_);
  const auto entries = host_->TakeEntries(now_, true);
  ASSERT_TRUE(entries.front().has_run_over());
  EXPECT_EQ(entries.front().run_over().job(), "jobs/17");
  EXPECT_EQ(entries.front().run_over().outcome().kind(), v1::Outcome::KIND_INTERRUPTED);
  EXPECT_EQ(entries.front().run_over().outcome().code(), "CELL-E9432");
  const v1::MachineMark& mark = entries.back().mark();
  EXPECT_FALSE(mark.clean());
  EXPECT_FALSE(mark.has_run_time_ns()) << "its end is told already";
  EXPECT_EQ(mark.job(), "jobs/17");
  EXPECT_EQ(mark.base().program(), 5);
  EXPECT_EQ(mark.base().place().SerializeAsString(),
            entries.front().run_over().outcome().place().SerializeAsString());
}

// LIVE-4.05, LIVE-5.09: and it is nobody's any more whose end was told: the queue gets no control
// of it.
TEST_F(HostJobsTest, ARunWhoseEndWasToldIsNotTheQueuesAgain) {
  Make();
  Do(Job());
  Pass(5s, 50ms);
  v1::HostOrder take;
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("a look");
  v1::HostOrder release;
  release.mutable_release_control()->set_control_token(Do(take).control().control_token());
  host_->EndRun(now_);
  ASSERT_FALSE(Do(release).has_refusal());
  EXPECT_FALSE(Status().has_control());
}

// LIVE-5.04: nothing moves until the store has the begin, whatever else is asked meanwhile.
TEST_F(HostJobsTest, NothingMovesBeforeTheStoreHasIt) {
  Make();
  EXPECT_FALSE(host_->Do(Job(), now_).has_refusal());
  const std::int64_t begun = Status().virtual_time_ns();
  for (int i = 0; i < 5; ++i) {
    now_.steady += 50ms;
    v1::HostOrder look;
    look.mutable_run_state();
    host_->Do(look, now_);
  }
  EXPECT_EQ(Status().virtual_time_ns(), begun);
  EXPECT_TRUE(host_->waits_for_store());
  host_->NoteStored(host_->TakeEntries(now_, true).back().sequence());
  EXPECT_FALSE(host_->waits_for_store());
  Pass(1s, 50ms);
  EXPECT_GT(Status().virtual_time_ns(), begun);
}

// LIVE-5.20, first row: what a host that was killed then, or told to end, leaves in its journal is
// taken back to the mark before, as long as the store does not have it and nobody has done
// anything.
TEST_F(HostJobsTest, WhatTheStoreHasNotBegunIsTakenBack) {
  enum class End { kKilled, kToldTo, kStopped };
  for (const bool controlled : {false, true}) {
    for (const End end : {End::kKilled, End::kToldTo, End::kStopped}) {
      Make();
      if (controlled) Control();
      std::vector<v1::JournalEntry> journal = host_->TakeEntries(now_, true);
      ASSERT_TRUE(journal.back().has_mark());
      const v1::MachineMark before = journal.back().mark();
      v1::HostOrder order = Job();
      if (controlled) order.set_caller("anna");
      ASSERT_FALSE(host_->Do(order, now_).has_refusal());
      const auto add = [&] {
        for (v1::JournalEntry& entry : host_->TakeEntries(now_, true))
          journal.push_back(std::move(entry));
      };
      add();
      if (end == End::kStopped) {
        v1::HostOrder stop = Stop();
        stop.set_caller("berta");
        host_->Do(stop, now_);
      }
      if (end == End::kToldTo) {
        host_->Hold(v1::HOLD_REASON_STOP, now_);
        host_->EndRun(now_);
      }
      add();
      v1::HostWelcome welcome;
      *welcome.mutable_mark() = before;
      const Recovered found = RecoveredFrom(welcome, journal);
      const bool stopped = end == End::kStopped;
      EXPECT_EQ(found.mark.sequence() == before.sequence(), !stopped);
      EXPECT_EQ(SetupOf(found).cut_off, stopped);
      EXPECT_EQ(found.untold.empty(), !stopped);
      // The store has it: it is cut off.
      *welcome.mutable_mark() = journal.back().mark();
      EXPECT_TRUE(SetupOf(RecoveredFrom(welcome, journal)).cut_off);
    }
  }
}

// LIVE-5.10: a decision is about the run that was cut off last.
TEST_F(HostJobsTest, ADecisionIsAboutTheRunThatWasCutOff) {
  v1::MachineMark mark;
  mark.set_run_time_ns(5);
  mark.set_job("jobs/99");
  Make({}, true, mark);
  Control();
  v1::HostOrder confirm;
  confirm.mutable_confirm()->set_control_token(token_);
  confirm.mutable_confirm()->add_confirmations(v1::CONFIRMATION_INSPECTED);
  const v1::HostOrderAnswer refused = Do(For("jobs/3", confirm));
  EXPECT_EQ(refused.refusal().code(), "CELL-E9421");
  EXPECT_THAT(refused.refusal().message(), HasSubstr("jobs/99"));
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  EXPECT_FALSE(Do(For("jobs/99", confirm)).has_refusal());
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// Nor is it one of a job where a run of nobody's job was cut off, or none was.
TEST_F(HostJobsTest, ADecisionIsAboutARunThatThereIs) {
  Make({}, true);
  Control();
  v1::HostOrder confirm;
  confirm.mutable_confirm()->set_control_token(token_);
  confirm.mutable_confirm()->add_confirmations(v1::CONFIRMATION_INSPECTED);
  const auto why = [&] { return Do(For("jobs/3", confirm)).refusal().message(); };
  EXPECT_THAT(why(), HasSubstr("a run without a job was cut off here, not jobs/3"));
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  ASSERT_FALSE(Do(confirm).has_refusal());
  EXPECT_THAT(why(), HasSubstr("nothing waits for a confirmation"));
}

// A source with errors ends the job with the first of them, and nothing has moved. LIVE-5.02 (b)
TEST_F(HostJobsTest, AProgramWithErrorsBeginsNothing) {
  machine::MachineMemory memory;
  auto made = HostMachine::Make({.name = "machines/optimo-1",
                                 .host = "workshop/1",
                                 .fence = 7,
                                 .family = families::FindFamily("optimo"),
                                 .memory = std::move(memory)},
                                now_, [] { return std::string("token"); });
  ASSERT_TRUE(made) << made.error().detail;
  host_ = *std::move(made);
  v1::HostOrder job = Job("STOP\nNONSENSE\n");
  job.mutable_run_job()->mutable_programs(0)->set_file_name("A.S");
  const v1::HostOrderAnswer refused = Do(job);
  EXPECT_THAT(refused.refusal().code(), testing::StartsWith("OPT-E"));
  EXPECT_EQ(refused.refusal().place().line(), 2);
  EXPECT_THAT(Of(v1::JournalEntry::kApplied), IsEmpty());
  EXPECT_EQ(Status().run().job(), "");
  job.mutable_run_job()->mutable_programs(0)->set_content("STOP\n");
  EXPECT_FALSE(Do(job).has_refusal());
  Pass(1s);
  EXPECT_EQ(Of(v1::JournalEntry::kRunOver).front().run_over().outcome().code(), "OPT-E7507");
}

}  // namespace
}  // namespace rmlcell::server
