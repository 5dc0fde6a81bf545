// What a host says of why: a run that it held by itself, jobs that wait, orders that are not its
// own.
#include <string>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class ToldReasons : public HostMachineTest {
 protected:
  std::vector<std::string> Messages() {
    std::vector<std::string> texts;
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.event().has_message()) texts.push_back(entry.event().message().text());
    }
    return texts;
  }
  // What the log says where the host brings a run to rest for this.
  std::vector<std::string> ToldOfHold(v1::HoldReason reason, bool disk_is_late) {
    Make();
    host_->Begin({}, now_);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
    EXPECT_FALSE(Do(Start()).has_refusal());
    Pass(500ms);
    Messages();
    host_->NoteDisk(disk_is_late);
    host_->Hold(reason, now_);
    return Messages();
  }
  std::vector<std::string> Blockers() {
    std::vector<std::string> codes;
    const v1::MachineStatus status = host_->StatusAt(now_);
    for (const v1::StartBlocker& one : status.start_blockers()) codes.push_back(one.code());
    return codes;
  }
  v1::HostOrderAnswer DoAs(const std::string& caller, v1::HostOrder order) {
    order.set_number(++number_);
    order.set_caller(caller);
    return host_->Do(order, now_);
  }
};

// LIVE-3.14, LIVE-3.21, LIVE-3.31: each by its own code; where a person asked for it nothing.
TEST_F(ToldReasons, ARunThatNobodyHeldSaysWhy) {
  const auto code = [](ErrorCode one) { return HasSubstr(CodeText(one)); };
  EXPECT_THAT(ToldOfHold(v1::HOLD_REASON_SERVER_LOST, false),
              ElementsAre(code(ErrorCode::kCellServerLost)));
  EXPECT_THAT(ToldOfHold(v1::HOLD_REASON_LATE, false), ElementsAre(code(ErrorCode::kCellHostLate)));
  EXPECT_THAT(ToldOfHold(v1::HOLD_REASON_LATE, true), ElementsAre(code(ErrorCode::kCellJournal)));
  EXPECT_THAT(ToldOfHold(v1::HOLD_REASON_STOP, false), testing::IsEmpty());
}

// LIVE-2.05: what is refused changes nothing, nor why the run is held.
TEST_F(ToldReasons, AStartThatIsRefusedIsNoReason) {
  static_cast<void>(ToldOfHold(v1::HOLD_REASON_LATE, false));
  Pass(3s);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_TRUE(Do(Start()).has_refusal());
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_LATE);
}

// LIVE-5.02 (a): as long as the disk does not answer.
TEST_F(ToldReasons, JobsWaitWhileTheDiskIsLate) {
  Make();
  host_->Begin({}, now_);
  const std::string journal = CodeText(ErrorCode::kCellJournal);
  EXPECT_THAT(Blockers(), Not(Contains(journal)));
  host_->NoteDisk(true);
  EXPECT_THAT(Blockers(), Contains(journal));
  host_->NoteDisk(false);
  EXPECT_THAT(Blockers(), Not(Contains(journal)));
}

// LIVE-7.02: a session is closed by whoever has control, and by nobody else.
TEST_F(ToldReasons, NobodyElseClosesASession) {
  MakeOptimo();
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder open;
  open.mutable_create_session()->set_control_token(token_);
  const std::string session = Do(open).session().name();
  v1::HostOrder close;
  close.mutable_delete_session()->set_name(session);
  EXPECT_EQ(DoAs("bert", close).refusal().code(), CodeText(ErrorCode::kCellControlNeeded));
  EXPECT_FALSE(DoAs("anna", close).has_refusal());
  EXPECT_EQ(DoAs("anna", close).refusal().code(), CodeText(ErrorCode::kCellNotFound));
}

// An order of a later version.
TEST_F(ToldReasons, AnOrderThatIsNotKnownIsNotDone) {
  Make();
  host_->Begin({}, now_);
  EXPECT_EQ(Do(v1::HostOrder()).refusal().code(), CodeText(ErrorCode::kCellUnimplemented));
}

// LIVE-5.02: of all that is in the way of a start that which refused it is told first, wherever it
// stands among the others.
TEST_F(ToldReasons, WhatRefusedAStartIsToldFirst) {
  Make({}, true);
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder emergency;
  emergency.mutable_emergency_stop();
  Do(emergency);
  const v1::HostOrderAnswer refused = Do(Start());
  const std::string alarm = CodeText(ErrorCode::kCellEmergencyStop);
  EXPECT_EQ(refused.refusal().code(), alarm);
  std::vector<std::string> codes;
  for (const v1::StartBlocker& one : refused.start_blockers()) codes.push_back(one.code());
  EXPECT_THAT(codes, ElementsAre(alarm, CodeText(ErrorCode::kCellInspect)));
}

}  // namespace
}  // namespace rmlcell::server
