// When something is told, by the clock of the host: JournalEntry.time is that of the moment at
// which it acted, though the machine was looked at last a while before.
#include <string>
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

}  // namespace
}  // namespace rmlcell::server
