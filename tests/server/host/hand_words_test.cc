// What keys and heartbeats of a handbox are answered, and what is noted of steps that are taught
// (live.md 7.02 to 7.10).
#include <string>
#include <utility>
#include <vector>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class HandWords : public HostMachineTest {
 protected:
  void OpenHandbox() {
    MakeAndTakeOptimo();
    v1::HostOrder open;
    open.mutable_create_session()->set_control_token(token_);
    session_ = Do(open).session().name();
  }
  v1::PressKeyResponse Tap(const std::string& key) {
    const v1::HostOrderAnswer answer = Do(KeyOf(session_, key));
    EXPECT_TRUE(answer.has_key()) << key << ": " << answer.refusal().message();
    return answer.key();
  }
  v1::HostOrder Beat(std::int64_t number) {
    v1::HostOrder order;
    v1::HeartbeatHandboxRequest& beat = *order.mutable_handbox_heartbeat();
    beat.set_session(session_);
    beat.set_control_token(token_);
    beat.set_number(number);
    *beat.mutable_sent() = Stamp(now_.wall);
    return order;
  }
  std::vector<v1::JournalEntry> Inputs() {
    std::vector<v1::JournalEntry> found;
    for (v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.has_applied()) found.push_back(std::move(entry));
    }
    return found;
  }
  std::string session_;
};

// LIVE-7.02: display, lamps, mode, who has it and how often it beeped.
TEST_F(HandWords, ThePanelSaysAllOfIt) {
  OpenHandbox();
  v1::PressKeyResponse answer = Tap("2");  // in REMOTE it does nothing
  EXPECT_EQ(answer.sequence(), 1);
  EXPECT_THAT(answer.panel().lamps(), ElementsAre("REMOTE", "ROB"));
  EXPECT_EQ(answer.message().severity(), v1::SEVERITY_MESSAGE);
  EXPECT_EQ(answer.panel().beeps(), 0);
  EXPECT_EQ(answer.panel().run_on_mm(), 0.0);
  for (const char* key : {"MODE_LEFT", "MODE_LEFT", "MODE_LEFT", "MODE_LEFT"}) Tap(key);
  answer = Tap("SHIFT");
  EXPECT_EQ(answer.sequence(), 6);
  EXPECT_FALSE(answer.has_message());
  EXPECT_THAT(answer.panel().lamps(), ElementsAre("MANUAL", "ROB", "SHIFT"));
  EXPECT_GT(answer.panel().run_on_mm(), 0.0);
  EXPECT_GT(answer.panel().run_on_rad(), 0.0);
  // OPT-4.10: NOTE lets each key beep.
  Tap("NOTE");
  const std::int64_t before = host_->Handbox()->beeps();
  Tap("SHIFT");
  Tap("SHIFT");
  EXPECT_EQ(host_->Handbox()->beeps(), before + 2);
  EXPECT_EQ(host_->Handbox()->holder(), "anna");
}

// LIVE-7.05: beats count from 1, and the time that a line takes is one.
TEST_F(HandWords, ABeatMustMakeSense) {
  OpenHandbox();
  const auto why_not = [this](const v1::HostOrder& beat) {
    const v1::HostOrderAnswer answer = Do(beat);
    const std::string code = answer.refusal().code();
    EXPECT_EQ(code, answer.has_heartbeat() ? "" : CodeText(ErrorCode::kCellInvalidArgument));
    return std::string(answer.refusal().message());
  };
  EXPECT_EQ(why_not(Beat(0)), "number counts from 1");
  EXPECT_EQ(why_not(Beat(1)), "");
  v1::HostOrder odd = Beat(2);
  odd.mutable_handbox_heartbeat()->mutable_round_trip()->set_nanos(-1);
  EXPECT_THAT(why_not(odd), HasSubstr("round_trip"));
  odd.mutable_handbox_heartbeat()->mutable_round_trip()->set_nanos(0);
  EXPECT_EQ(why_not(odd), "");
  v1::HostOrder stranger = Beat(3);
  stranger.mutable_handbox_heartbeat()->set_session("machines/optimo-1/handboxSessions/9");
  const v1::HostOrderAnswer refused = Do(stranger);
  EXPECT_EQ(refused.refusal().code(), CodeText(ErrorCode::kCellNotFound));
  EXPECT_THAT(refused.refusal().message(), HasSubstr("handboxSessions/9: open another one"));
}

// LIVE-7.04: a number that is not the next one is named.
TEST_F(HandWords, ANumberThatIsNotTheNextIsNamed) {
  OpenHandbox();
  v1::HostOrder order = KeyOf(session_, "REC");
  v1::PressKeyRequest& pressed = *order.mutable_key();
  pressed.set_sequence(11);
  EXPECT_EQ(Do(order).refusal().message(), "sequence 11 is not the next one");
  pressed.set_sequence(0);
  EXPECT_EQ(Do(order).refusal().message(), "sequence counts from 1");
  pressed.set_sequence(1);
  EXPECT_TRUE(Do(order).has_key());
}

// LIVE-7.04, LIVE-7.10: a press that came behind its release does nothing, and is told nothing of
// what the control said to another key.
TEST_F(HandWords, APressBehindItsReleaseSaysNothing) {
  OpenHandbox();
  const auto press = [this](const std::string& key, v1::KeyAction action, std::int64_t number) {
    v1::HostOrder order = KeyOf(session_, key, action);
    order.mutable_key()->set_sequence(number);
    const v1::HostOrderAnswer answer = Do(order);
    EXPECT_TRUE(answer.has_key()) << number << answer.refusal().message();
    return answer.key();
  };
  press("X+", v1::KEY_ACTION_RELEASE, 3);
  EXPECT_TRUE(press("REC", v1::KEY_ACTION_TAP, 1).has_message());  // in REMOTE
  EXPECT_FALSE(press("X+", v1::KEY_ACTION_PRESS, 2).has_message());
}

// LIVE-7.09: where the tip was, in each direction.
TEST_F(HandWords, WhatIsTaughtSaysWhereItsTipWas) {
  MakeOptimo();
  const v1::HostOrderAnswer begun =
      Do(JobOf("COORD ABSOL\nPATH PTP\nMOVE (100.,2000.,-400.,0.,0.)\n"));
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  for (int second = 0; second < 600 && State() != v1::MACHINE_STATE_IDLE; ++second) Pass(1s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder open;
  open.mutable_create_session()->set_control_token(token_);
  const v1::Point tip =
      Taught(Do(open).session().name(), "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC")
          .taught()
          .tip();
  EXPECT_EQ(tip.SerializeAsString(), host_->StatusAt(now_).tip().SerializeAsString());
  for (const double coordinate : {tip.x(), tip.y(), tip.z()}) EXPECT_NE(coordinate, 0.0);
}

// LIVE-7.09: where the machine stood when a step was taught, when, and what was in force.
TEST_F(HandWords, WhatIsTaughtSaysWhereTheMachineStood) {
  OpenHandbox();
  Pass(2s);
  const v1::HostEdit edit =
      Taught(session_, "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC");
  EXPECT_EQ(edit.fence(), 7);
  EXPECT_EQ(edit.number(), 1);
  EXPECT_EQ(edit.caller(), "anna");
  const v1::TeachEntry& taught = edit.taught();
  const v1::MachineStatus status = host_->StatusAt(now_);
  EXPECT_EQ(taught.virtual_time_ns(), 2'000'000'000);
  EXPECT_EQ(taught.tip().SerializeAsString(), status.tip().SerializeAsString());
  ASSERT_EQ(taught.axes_size(), status.axes_size());
  for (int axis = 0; axis < taught.axes_size(); ++axis)
    EXPECT_EQ(taught.axes(axis).SerializeAsString(), status.axes(axis).SerializeAsString());
  ASSERT_EQ(taught.values_size(), 4);
  EXPECT_EQ(taught.values(0).value(), "ROBOT");
  EXPECT_EQ(taught.values(2).value(), "OFF");
  EXPECT_THAT(taught.values(3).value(), testing::StartsWith("PATH "));
}

// LIVE-7.08: an answer that is not to the newest edit says nothing of that; one that was not asked
// for is refused to nobody.
TEST_F(HandWords, OnlyTheAnswerToTheNewestEditCounts) {
  OpenHandbox();
  Inputs();
  host_->RefuseEdit(ErrorCode::kCellStoreUnavailable, now_);
  EXPECT_THAT(Inputs(), IsEmpty());
  Taught(session_, "MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC");
  Inputs();
  v1::HostEditAnswer answer;
  answer.mutable_refusal()->set_code("CELL-E9108");
  for (const std::int64_t number : {0, 2}) {
    answer.set_number(number);
    host_->EditAnswered(answer, now_);
    EXPECT_TRUE(host_->Settles()) << number;
    EXPECT_THAT(Inputs(), IsEmpty()) << number;
  }
  answer.clear_refusal();
  answer.set_number(1);
  host_->EditAnswered(answer, now_);
  EXPECT_TRUE(host_->Settles());  // it is stored, and what is stored comes by itself
  answer.mutable_refusal()->set_code("CELL-E9108");
  host_->EditAnswered(answer, now_);
  EXPECT_FALSE(host_->Settles());
  EXPECT_EQ(Inputs().size(), 1U);
  host_->EditAnswered(answer, now_);  // nothing is on its way any more
  EXPECT_THAT(Inputs(), IsEmpty());
}

}  // namespace
}  // namespace rmlcell::server
