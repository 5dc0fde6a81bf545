// When something is told, by the clock of the host: JournalEntry.time is that of the moment at
// which it acted, though the machine was looked at last a while before.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

class ToldTimes : public HostMachineTest {
 protected:
  // Time goes by, and nobody looks at the machine.
  void GoesBy() {
    now_.steady += 400ms;
    now_.wall += 400ms;
  }
  std::string Now() const { return Stamp(now_.wall).SerializeAsString(); }
  // Of what was told first since the last look.
  std::string FirstToldAt() {
    const std::vector<v1::JournalEntry> entries = host_->TakeEntries(now_, true);
    EXPECT_FALSE(entries.empty());
    return entries.empty() ? std::string() : entries.front().time().SerializeAsString();
  }
  void Forget() { static_cast<void>(host_->TakeEntries(now_, true)); }
  v1::HostOrder PreviewOfTheSquare() {
    v1::HostOrder order;
    order.set_number(++number_);
    order.mutable_preview_start()->set_program(5);
    order.mutable_preview_start()->mutable_step()->set_step(8);
    return order;
  }
};

// LIVE-3.30: how the run of an earlier host ended is told when the next one finds it; where the
// machine stands behind that, when it is asked.
TEST_F(ToldTimes, OfARunThatWasCutOffAreThoseOfTheNextHost) {
  v1::MachineMark mark;
  mark.set_run_time_ns(5);
  mark.set_job("jobs/3");
  Make({}, true, mark);
  const std::string found = Now();
  GoesBy();
  const std::vector<v1::JournalEntry> told = host_->TakeEntries(now_, true);
  ASSERT_EQ(told.size(), 2U);
  ASSERT_TRUE(told[0].has_run_over());
  EXPECT_EQ(told[0].time().SerializeAsString(), found);
  ASSERT_TRUE(told[1].has_mark());
  EXPECT_EQ(told[1].time().SerializeAsString(), Now());
}

// LIVE-3.20: when an order is about to act, and when what was stored meanwhile came to the machine.
TEST_F(ToldTimes, OfWhatComesToAMachineThatStands) {
  MakeAndTake();
  Forget();
  GoesBy();
  EXPECT_EQ(host_->IntentOf(Start("the one"), now_).time().SerializeAsString(), Now());
  GoesBy();
  v1::HostMemory memory;
  memory.add_programs()->set_slot(6);
  memory.mutable_programs(0)->set_content("PU0,0;");
  host_->Change(memory, now_);
  EXPECT_EQ(FirstToldAt(), Now());
}

// LIVE-3.20: what an order does is done at the moment of the order.
TEST_F(ToldTimes, OfAnOrderAreThoseOfItsMoment) {
  MakeAndTake();
  Forget();
  const std::int64_t before = host_->StatusAt(now_).virtual_time_ns();
  GoesBy();
  v1::HostOrder slower;
  slower.mutable_override()->set_override_percent(90.0);
  slower.mutable_override()->set_control_token(token_);
  ASSERT_FALSE(Do(slower).has_refusal());
  const std::vector<v1::JournalEntry> told = host_->TakeEntries(now_, true);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told[0].time().SerializeAsString(), Now());
  EXPECT_EQ(told[0].virtual_time_ns(), before + 400'000'000);
}

// LIVE-6.04: whether a start may be looked at is decided for the machine as it is at that moment.
TEST_F(ToldTimes, OfAPreviewAreThoseOfItsMoment) {
  const auto begin = [this] {
    MakeAndTake();
    v1::HostMemory memory;
    memory.add_programs()->set_slot(6);
    memory.mutable_programs(0)->set_content("PA;PA;VS10;PU200,0;");
    host_->Change(memory, now_);
    ASSERT_FALSE(Do(Start("", 6)).has_refusal());
  };
  begin();
  int steps = 0;
  for (; State() != v1::MACHINE_STATE_IDLE && steps < 600; ++steps) Pass(50ms, 50ms);
  begin();
  Pass(50ms * (steps - 1), 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  now_.steady += 50ms;  // its last
  now_.wall += 50ms;
  bool looked_at = false;  // as soon as that is worked out
  for (int turn = 0; turn < 100 && !looked_at; ++turn)
    looked_at = bool(host_->PreparePreview(PreviewOfTheSquare(), now_));
  EXPECT_TRUE(looked_at);
}

// LIVE-4.02: and so is who has control when it was looked at.
TEST_F(ToldTimes, OfWhatWasLookedAtAreThoseOfItsEnd) {
  MakeAndTake();
  const v1::HostOrder order = PreviewOfTheSquare();
  auto task = host_->PreparePreview(order, now_);
  ASSERT_TRUE(task) << task.error().detail;
  now_.steady += 61s;  // of the 60 s for which control was taken
  now_.wall += 61s;
  const v1::HostOrderAnswer answer =
      host_->Previewed(order, *std::move(task),
                       Error{ErrorCode::kCellStepUnreachable, "it took too long", {}}, now_);
  EXPECT_EQ(answer.acted_at().SerializeAsString(), Now());
  ASSERT_TRUE(answer.has_refusal());
  EXPECT_EQ(answer.machine_refusal().control_holder(), "");
}

// LIVE-3.22: a run that begins with its machine begins at the time that this has, whatever an
// earlier host had to tell.
TEST_F(ToldTimes, OfARunThatBeginsAtOnceIsThatOfItsMachine) {
  v1::JournalEntry event;
  event.set_fence(6);
  event.set_sequence(10);
  event.mutable_event()->mutable_message()->set_text("hello");
  auto made = HostMachine::Make({.name = "machines/mill-1",
                                 .host = "workshop/2",
                                 .fence = 7,
                                 .family = families::FindFamily("rml1"),
                                 .profile = "srm-20",
                                 .untold = {event}},
                                now_, [] { return std::string("token"); });
  ASSERT_TRUE(made) << made.error().detail;
  host_ = *std::move(made);
  host_->Begin({}, now_);
  ASSERT_FALSE(Do(JobOf(kSquare, "square.rml")).has_refusal());
  const std::vector<v1::JournalEntry> told = host_->TakeEntries(now_, true);
  const auto begun = std::ranges::find_if(told, &v1::JournalEntry::has_run_begun);
  ASSERT_NE(begun, told.end());
  EXPECT_EQ(begun->virtual_time_ns(), 0);
}

// LIVE-3.14, LIVE-5.09: when its host held a run, and when that ended with it.
TEST_F(ToldTimes, OfWhatAHostDoesByItself) {
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(1s);
  Forget();
  GoesBy();
  host_->Hold(v1::HOLD_REASON_STOP, now_);
  EXPECT_EQ(FirstToldAt(), Now());
  Pass(2s);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  Forget();
  GoesBy();
  host_->EndRun(now_);
  EXPECT_EQ(FirstToldAt(), Now());
}

// LIVE-7.08: when what was taught was refused.
TEST_F(ToldTimes, OfAnEditThatIsRefused) {
  MakeAndTakeOptimo();
  v1::HostOrder open;
  open.mutable_create_session()->set_control_token(token_);
  Taught(Do(open).session().name(), "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC");
  Forget();
  GoesBy();
  host_->RefuseEdit(ErrorCode::kCellStoreUnavailable, now_);
  EXPECT_EQ(FirstToldAt(), Now());
}

// Nor does it act at a moment that is over, where its store has answered.
TEST_F(ToldTimes, OfAnEditThatTheStoreRefusesAreThoseOfItsAnswer) {
  MakeAndTakeOptimo();
  v1::HostOrder open;
  open.mutable_create_session()->set_control_token(token_);
  v1::HostEditAnswer refused;
  refused.set_number(
      Taught(Do(open).session().name(), "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC")
          .number());
  refused.mutable_refusal()->set_code(CodeText(ErrorCode::kCellStoreUnavailable));
  Forget();
  const std::int64_t before = host_->StatusAt(now_).virtual_time_ns();
  GoesBy();
  host_->EditAnswered(refused, now_);
  const std::vector<v1::JournalEntry> told = host_->TakeEntries(now_, true);
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(told[0].has_applied());
  EXPECT_EQ(told[0].virtual_time_ns(), before + 400'000'000);
}

}  // namespace
}  // namespace rmlcell::server
