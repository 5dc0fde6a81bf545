// For what a run is held, whatever comes to its machine behind that, and until when (live.md 2.01,
// 2.11, 2.13).
#include <sstream>
#include <string>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

class ReasonsOfHolds : public HostMachineTest {
 protected:
  static constexpr const char* kDelays = "DELAY 2\nDELAY 2\nDELAY 20\n";

  v1::HoldReason Reason() { return host_->StatusAt(now_).hold_reason(); }
  void SetMode(v1::OperatingMode mode) {
    v1::HostOrder order;
    order.mutable_mode()->set_mode(mode);
    order.mutable_mode()->set_control_token(token_);
    ASSERT_FALSE(Do(order).has_refusal());
  }
  void HaltAt(int program, int step) {
    v1::HostOrder order;
    order.mutable_breakpoints()->set_control_token(token_);
    v1::StepPlace& at = *order.mutable_breakpoints()->add_breakpoints()->mutable_step();
    at.set_program(program);
    at.set_step(step);
    ASSERT_FALSE(Do(order).has_refusal());
  }
  static v1::HostOrder Hold() {
    v1::HostOrder order;
    order.mutable_hold();
    return order;
  }
  // An Optimo with the delays as program 12, and somebody at its handbox.
  void MakeWithDelays() {
    MakeAndTakeOptimo();
    const machine::MachineFamily& family = *families::FindFamily("optimo");
    const auto made = family.Translate({.name = "12.S", .bytes = kDelays},
                                       *machine::MakeParameters(family, "", {}), {.advice = false});
    ASSERT_TRUE(made.ok);
    v1::HostMemory memory;
    memory.add_programs()->set_slot(12);
    memory.mutable_programs(0)->set_content(made.object);
    host_->Change(memory, now_);
    OpenHandbox();
  }
  void OpenHandbox() {
    v1::HostOrder open;
    open.mutable_create_session()->set_control_token(token_);
    session_ = Do(open).session().name();
    ASSERT_NE(session_, "");
    keys_pressed_ = 0;
  }
  void Press(const std::string& keys) {
    std::istringstream all(keys);
    for (std::string name; all >> name;) ASSERT_TRUE(Do(KeyOf(session_, name)).has_key()) << name;
  }
  // Begun by the START of the handbox, in CYCLE.
  void RunByKey() {
    Press("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT MODE_RIGHT MODE_RIGHT START");
    ASSERT_EQ(State(), v1::MACHINE_STATE_RUNNING);
    Pass(500ms);
  }
  void ComesToHold(v1::HoldReason reason) {
    Pass(4s, 50ms);
    ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
    EXPECT_EQ(Reason(), reason);
  }
  // Held by HOLD in its first delay; then a key of an axis is down.
  void JogInAHold() {
    MakeWithDelays();
    ASSERT_FALSE(Do(Start("", 12)).has_refusal());
    Pass(500ms);
    ASSERT_FALSE(Do(Hold()).has_refusal());
    ComesToHold(v1::HOLD_REASON_HOLD);
    SetMode(v1::OPERATING_MODE_MANUAL);
    ASSERT_TRUE(Do(KeyOf(session_, "X+", v1::KEY_ACTION_PRESS)).has_key());
    Pass(50ms);
    ASSERT_EQ(State(), v1::MACHINE_STATE_JOGGING);
  }
  std::string session_;
};

// LIVE-2.01: a run that goes on is held for nothing, and later for what holds it then.
TEST_F(ReasonsOfHolds, OfARunThatWentOnIsTheNewOne) {
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(200ms);
  ASSERT_FALSE(Do(Hold()).has_refusal());
  Pass(20s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Reason(), v1::HOLD_REASON_HOLD);
  ASSERT_EQ(Do(Resume()).status().state(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(Reason(), v1::HOLD_REASON_UNSPECIFIED);
  SetMode(v1::OPERATING_MODE_SINGLE);
  Pass(40s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Reason(), v1::HOLD_REASON_SINGLE);
}

// OPT-4.19: so where the START of the handbox let it go on.
TEST_F(ReasonsOfHolds, OfARunThatAKeyLetGoOnIsTheNewOne) {
  MakeWithDelays();
  HaltAt(12, 2);
  RunByKey();
  Press("HOLD");
  ComesToHold(v1::HOLD_REASON_HOLD);
  Press("START");
  ASSERT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  ComesToHold(v1::HOLD_REASON_BREAKPOINT);
}

// LIVE-2.13: a key that lets nothing go on changes nothing of it.
TEST_F(ReasonsOfHolds, StaysWhateverKeyIsPressed) {
  MakeWithDelays();
  RunByKey();
  host_->Hold(v1::HOLD_REASON_LATE, now_);
  ComesToHold(v1::HOLD_REASON_LATE);
  Press("SHIFT OVERRIDE_MINUS");
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Reason(), v1::HOLD_REASON_LATE);
}

// OPT-4.11: in REMOTE the handbox halts nothing, and so is no reason for what does later.
TEST_F(ReasonsOfHolds, IsNoKeyThatTheControlDoesNotTake) {
  MakeWithDelays();
  HaltAt(12, 2);
  ASSERT_FALSE(Do(Start("", 12)).has_refusal());
  Pass(500ms);
  Press("HOLD STOP");
  EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  ComesToHold(v1::HOLD_REASON_BREAKPOINT);
}

// LIVE-2.13: nor what stops a motion by hand in a hold, be it a person or the host.
TEST_F(ReasonsOfHolds, StaysWhateverStopsAMotionInTheHold) {
  JogInAHold();
  EXPECT_TRUE(Do(Stop()).has_halt());
  ComesToHold(v1::HOLD_REASON_HOLD);
  JogInAHold();
  host_->Hold(v1::HOLD_REASON_SERVER_LOST, now_);
  ComesToHold(v1::HOLD_REASON_HOLD);
}

// LIVE-2.11: a key that leaves REMOTE holds a job for that; another one does not.
TEST_F(ReasonsOfHolds, OfAJobIsTheModeWhereAKeyLeavesRemote) {
  MakeWithDelays();
  ASSERT_FALSE(Do(JobOf(kDelays)).has_refusal());
  HaltAt(5, 2);
  Press("OVERRIDE_MINUS");
  ComesToHold(v1::HOLD_REASON_BREAKPOINT);
  ASSERT_EQ(Do(Resume()).status().state(), v1::MACHINE_STATE_RUNNING);
  Pass(500ms);
  Press("MODE_LEFT");
  ComesToHold(v1::HOLD_REASON_MODE);
}

// LIVE-2.01: a run that is over was held for something; what is moved by hand behind it is not.
TEST_F(ReasonsOfHolds, EndsWithTheRun) {
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(1s);
  Do(Stop());
  Pass(2s);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  v1::HostOrder abort;
  abort.mutable_abort();
  ASSERT_FALSE(Do(abort).has_refusal());
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  v1::HostOrder key;
  v1::PressPanelKeyRequest& pressed = *key.mutable_panel_key();
  pressed.set_key("X+");
  pressed.set_control_token(token_);
  for (const auto action : {v1::KEY_ACTION_PRESS, v1::KEY_ACTION_RELEASE}) {
    pressed.set_action(action);
    pressed.set_sequence(pressed.sequence() + 1);
    ASSERT_FALSE(Do(key).has_refusal());
    Pass(action == v1::KEY_ACTION_PRESS ? 100ms : 0ms);
  }
  ASSERT_EQ(State(), v1::MACHINE_STATE_STOPPING);
  EXPECT_EQ(Reason(), v1::HOLD_REASON_UNSPECIFIED);
}

}  // namespace
}  // namespace rmlcell::server
