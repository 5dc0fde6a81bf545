// Why a machine stands, as its host tells it, and what a machine that waits for an inspection
// refuses (live.md 2.01, 2.10, 2.13, 5.10).
#include <string>
#include <utility>
#include <vector>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class HeldMachines : public HostMachineTest {
 protected:
  static std::string Code(ErrorCode code) { return CodeText(code); }
  std::string CodeOf(const v1::HostOrder& order) { return Do(order).refusal().code(); }
  v1::HoldReason Reason() { return host_->StatusAt(now_).hold_reason(); }
  v1::HostOrder ModeOrder(v1::OperatingMode mode) {
    v1::HostOrder order;
    order.mutable_mode()->set_mode(mode);
    order.mutable_mode()->set_control_token(token_);
    return order;
  }
  v1::HostOrder InputOrder() {
    v1::HostOrder order;
    order.mutable_inputs()->set_control_token(token_);
    order.mutable_inputs()->add_inputs();
    return order;
  }
  void Power(bool on) {
    v1::HostOrder order = InputOrder();
    order.mutable_inputs()->mutable_inputs(0)->set_power(on);
    ASSERT_FALSE(Do(order).has_refusal());
  }
  v1::HostOrder PanelKey(const std::string& key, v1::KeyAction action = v1::KEY_ACTION_TAP) {
    v1::HostOrder order;
    v1::PressPanelKeyRequest& pressed = *order.mutable_panel_key();
    pressed.set_key(key);
    pressed.set_action(action);
    pressed.set_control_token(token_);
    pressed.set_sequence(++keys_pressed_);
    return order;
  }
  v1::HostOrder HandboxKey(const std::string& key, v1::KeyAction action = v1::KEY_ACTION_TAP) {
    return KeyOf(session_, key, action);
  }
  void OpenHandbox() {
    v1::HostOrder open;
    open.mutable_create_session()->set_control_token(token_);
    session_ = Do(open).session().name();
    ASSERT_NE(session_, "");
  }
  // The reason that the log has of the newest halt.
  v1::HoldReason HaltedFor() {
    v1::HoldReason reason = v1::HOLD_REASON_UNSPECIFIED;
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.event().has_halted()) reason = entry.event().halted().reason();
    }
    return reason;
  }
  std::string session_;
};

// LIVE-2.01, DEV-3.12: the cover that was opened, in the status as in the log.
TEST_F(HeldMachines, SayThatTheDoorWasOpened) {
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(10s, 50ms);
  v1::HostOrder door = InputOrder();
  door.mutable_inputs()->mutable_inputs(0)->set_door_open(true);
  ASSERT_FALSE(Do(door).has_refusal());
  Pass(3s);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Reason(), v1::HOLD_REASON_DOOR);
  EXPECT_EQ(HaltedFor(), v1::HOLD_REASON_DOOR);
  // Closed again it stands for the same reason.
  door.mutable_inputs()->mutable_inputs(0)->set_door_open(false);
  ASSERT_FALSE(Do(door).has_refusal());
  EXPECT_EQ(Reason(), v1::HOLD_REASON_DOOR);
}

// LIVE-2.01: HOLD and MANUAL let the stroke in progress end; SINGLE halts behind each by itself.
TEST_F(HeldMachines, SayWhichOrderItWas) {
  const auto reason_of = [this](const v1::HostOrder& order) {
    Pass(200ms);  // on the way to the first corner
    EXPECT_FALSE(Do(order).has_refusal());
    Pass(20s, 50ms);
    EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
    const v1::HoldReason reason = Reason();
    EXPECT_EQ(HaltedFor(), reason);
    return reason;
  };
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  v1::HostOrder hold;
  hold.mutable_hold();
  EXPECT_EQ(reason_of(hold), v1::HOLD_REASON_HOLD);
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  EXPECT_EQ(reason_of(ModeOrder(v1::OPERATING_MODE_MANUAL)), v1::HOLD_REASON_MODE);
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  EXPECT_EQ(reason_of(ModeOrder(v1::OPERATING_MODE_SINGLE)), v1::HOLD_REASON_SINGLE);
}

// OPT-4.17, LIVE-2.01: HOLD and STOP of the handbox; START lets it go on, and is no reason.
TEST_F(HeldMachines, SayWhichKeyOfAHandboxItWas) {
  MakeOptimo();
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  auto made =
      family.Translate({.name = "12.S", .bytes = "DELAY 2\nDELAY 2\nDELAY 20\n"},
                       *machine::MakeParameters(family, "", {}), {.advice = false, .source = true});
  ASSERT_TRUE(made.ok);
  v1::HostMemory memory;
  memory.add_programs()->set_slot(12);
  memory.mutable_programs(0)->set_content(made.object);
  host_->Change(memory, now_);
  OpenHandbox();
  for (const char* key : {"MODE_LEFT", "MODE_LEFT", "MODE_LEFT", "MODE_LEFT", "JOB", "1", "2",
                          "ENT", "MODE_RIGHT", "MODE_RIGHT", "START"})
    ASSERT_TRUE(Do(HandboxKey(key)).has_key()) << key;
  ASSERT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  Pass(500ms);
  ASSERT_TRUE(Do(HandboxKey("HOLD")).has_key());
  Pass(4s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Reason(), v1::HOLD_REASON_HOLD);
  ASSERT_TRUE(Do(HandboxKey("START")).has_key());
  ASSERT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  Pass(500ms);
  ASSERT_TRUE(Do(HandboxKey("STOP")).has_key());
  Pass(4s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(Reason(), v1::HOLD_REASON_STOP);
}

// LIVE-2.10, column INSPECT: what would move it or end its run waits for a person; what only sets
// something, lets go or halts does not.
TEST_F(HeldMachines, AMillThatWaitsForAnInspectionIsMovedByNoKey) {
  Make({}, true);
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  ASSERT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  const std::string inspect = Code(ErrorCode::kCellInspect);
  for (const char* key : {"VIEW", "HOME", "SPINDLE", "X+", "CONTINUE", "STOP", "BUFFER_CLEAR"})
    EXPECT_EQ(CodeOf(PanelKey(key)), inspect) << key;
  EXPECT_EQ(CodeOf(PanelKey("X+", v1::KEY_ACTION_PRESS)), inspect);
  EXPECT_EQ(CodeOf(PanelKey("X+", v1::KEY_ACTION_RELEASE)), "");
  for (const char* key : {"PAUSE", "COVER"}) EXPECT_EQ(CodeOf(PanelKey(key)), "") << key;
  // Nobody has described them; that comes behind what must be seen to.
  for (const char* key : {"Z0", "ORIGIN"})
    EXPECT_EQ(CodeOf(PanelKey(key)), Code(ErrorCode::kCellNotLive)) << key;
  v1::HostOrder zero;
  zero.mutable_zero()->set_control_token(token_);
  EXPECT_EQ(CodeOf(zero), inspect);
  v1::HostOrder abort;
  abort.mutable_abort();
  EXPECT_EQ(CodeOf(abort), inspect);
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
}

// LIVE-2.10: an alarm goes before the inspection.
TEST_F(HeldMachines, AnAlarmIsToldBeforeTheInspection) {
  Make({}, true);
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostOrder emergency;
  emergency.mutable_emergency_stop();
  Do(emergency);
  ASSERT_EQ(State(), v1::MACHINE_STATE_ALARM);
  EXPECT_EQ(CodeOf(Start()), Code(ErrorCode::kCellEmergencyStop));
  EXPECT_EQ(CodeOf(Resume()), Code(ErrorCode::kCellEmergencyStop));
}

// LIVE-2.10, LIVE-7.03: so of the handbox; of its keys those that begin a motion or say YES to one.
TEST_F(HeldMachines, AnOptimoThatWaitsForAnInspectionIsMovedByNoKey) {
  auto made = HostMachine::Make({.name = "machines/optimo-1",
                                 .host = "workshop/1",
                                 .fence = 7,
                                 .family = families::FindFamily("optimo"),
                                 .cut_off = true},
                                now_, [this] { return "token " + std::to_string(++tokens_); });
  ASSERT_TRUE(made) << made.error().detail;
  host_ = *std::move(made);
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  OpenHandbox();
  ASSERT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  const std::string inspect = Code(ErrorCode::kCellInspect);
  for (const char* key : {"START", "HOME", "ZERO", "1", "ENT", "X+", "B-"})
    EXPECT_EQ(CodeOf(HandboxKey(key)), inspect) << key;
  EXPECT_EQ(CodeOf(HandboxKey("X+", v1::KEY_ACTION_PRESS)), inspect);
  EXPECT_EQ(CodeOf(HandboxKey("X+", v1::KEY_ACTION_RELEASE)), "");
  for (const char* key : {"0", "2", "MODE_LEFT", "REC"})
    EXPECT_EQ(CodeOf(HandboxKey(key)), "") << key;
  EXPECT_EQ(CodeOf(HandboxKey("")), Code(ErrorCode::kCellInvalidArgument));
}

// OPT-7.70: how often the program was carried out whole.
TEST_F(HeldMachines, CountThePassesOfAProgramThatIsRepeated) {
  MakeOptimo();
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  const auto made = family.Translate({.name = "12.S", .bytes = "DELAY 1\n"},
                                     *machine::MakeParameters(family, "", {}), {.advice = false});
  ASSERT_TRUE(made.ok);
  v1::HostMemory memory;
  memory.add_programs()->set_slot(12);
  memory.mutable_programs(0)->set_content(made.object);
  host_->Change(memory, now_);
  OpenHandbox();
  for (const char* key : {"MODE_LEFT", "MODE_LEFT", "MODE_LEFT", "MODE_LEFT", "JOB", "1", "2",
                          "ENT", "MODE_RIGHT", "START"})
    ASSERT_TRUE(Do(HandboxKey(key)).has_key()) << key;
  ASSERT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(host_->StatusAt(now_).run().executions(), 0);
  Pass(1500ms, 50ms);
  EXPECT_EQ(host_->StatusAt(now_).run().executions(), 1);
}

// LIVE-5.10: where a run was cut off stays known, however often its machine is switched off and on
// before anybody has looked.
TEST_F(HeldMachines, WhereARunWasCutOffStaysKnown) {
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(30s, 50ms);
  for (const bool on : {false, true}) Power(on);
  ASSERT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  EXPECT_EQ(host_->StatusAt(now_).cut_off_at().step(), 8);
  for (const bool on : {false, true}) Power(on);
  EXPECT_EQ(State(), v1::MACHINE_STATE_INSPECT);
  EXPECT_EQ(host_->StatusAt(now_).cut_off_at().step(), 8);
  v1::MachineMark mark;
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
    if (entry.has_mark()) mark = entry.mark();
  }
  EXPECT_EQ(mark.base().place().step(), 8);
  EXPECT_EQ(mark.base().program(), 5);
}

// LIVE-5.10: who looked, and what he made of it.
TEST_F(HeldMachines, AnInspectionIsToldWithItsReason) {
  const auto told = [this](const std::string& reason) {
    Make({}, true);
    host_->Begin({}, now_);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
    v1::HostOrder confirm;
    confirm.set_reason(reason);
    confirm.mutable_confirm()->set_control_token(token_);
    confirm.mutable_confirm()->add_confirmations(v1::CONFIRMATION_INSPECTED);
    EXPECT_FALSE(Do(confirm).has_refusal());
    std::string text;
    for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.event().has_message()) text = entry.event().message().text();
    }
    return text;
  };
  EXPECT_EQ(told(""), "inspected by anna");
  EXPECT_EQ(told("the tool is whole"), "inspected by anna: the tool is whole");
}

// LIVE-2.05: what ends a run acts, also by an id that was used for something else.
TEST_F(HeldMachines, AnAbortActsWhateverItsIdWasUsedFor) {
  MakeAndTake();
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(1s);
  v1::HostOrder abort;
  abort.mutable_abort()->set_request_id("the one");
  abort.mutable_abort()->set_run(99);
  EXPECT_EQ(CodeOf(abort), Code(ErrorCode::kCellMachineState));
  abort.mutable_abort()->set_run(1);
  EXPECT_EQ(CodeOf(abort), "");
  Pass(3s);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// LIVE-6.08, LIVE-2.05: STOP stops what would begin, also where nothing moves; a question does not.
TEST_F(HeldMachines, AStopStopsAStartThatWasLookedAt) {
  MakeAndTake();
  const auto preview = [this] {
    v1::HostOrder order;
    order.set_number(++number_);
    order.mutable_preview_start()->set_program(5);
    order.mutable_preview_start()->mutable_step()->set_step(8);
    auto task = host_->PreparePreview(order, now_);
    EXPECT_TRUE(task) << task.error().detail;
    auto made = task->run(task->start, {});
    return host_->Previewed(order, *std::move(task), std::move(made), now_);
  };
  const auto start = [this](const std::string& token) {
    v1::HostOrder order;
    v1::StartAtStepRequest& asked = *order.mutable_start_at_step();
    asked.set_control_token(token_);
    asked.set_preview_token(token);
    for (const auto one : {v1::CONFIRMATION_CLAMPS, v1::CONFIRMATION_TOOL,
                           v1::CONFIRMATION_ORIGIN_VALID, v1::CONFIRMATION_TABLE_CLEAR})
      asked.add_confirmations(one);
    return Do(order);
  };
  const v1::HostOrderAnswer first = preview();
  EXPECT_EQ(first.acted_at().seconds(), Stamp(now_.wall).seconds());
  EXPECT_EQ(first.preview().expire_time().seconds(), Stamp(now_.wall + 120s).seconds());
  Do(Stop());
  const v1::HostOrderAnswer stopped = start(first.preview().preview_token());
  EXPECT_EQ(stopped.refusal().code(), Code(ErrorCode::kCellMachineState));
  EXPECT_THAT(stopped.refusal().message(), HasSubstr("it was stopped before it began"));
  const std::string token = preview().preview().preview_token();
  v1::HostOrder look;
  look.mutable_run_state();
  Do(look);
  const v1::HostOrderAnswer begun = start(token);
  EXPECT_FALSE(begun.has_refusal()) << begun.refusal().message();
}

// OPT-1.12, LIVE-6.08: programs that go, one by one or since they are not among all that there are.
TEST_F(HeldMachines, ProgramsThatGoAreGone) {
  MakeAndTake();
  v1::HostMemory memory;
  for (const int slot : {6, 7}) {
    v1::AssignedProgram& program = *memory.add_programs();
    program.set_slot(slot);
    program.set_content("PU" + std::to_string(slot) + ",0;");
  }
  host_->Change(memory, now_);
  v1::HostOrder question;
  question.set_number(++number_);
  question.mutable_preview_start()->set_program(5);
  question.mutable_preview_start()->mutable_step()->set_step(8);
  auto task = host_->PreparePreview(question, now_);
  ASSERT_TRUE(task) << task.error().detail;
  auto made = task->run(task->start, {});
  const std::string token =
      host_->Previewed(question, *std::move(task), std::move(made), now_).preview().preview_token();
  v1::HostMemory gone;
  gone.add_deleted_programs(6);
  gone.add_deleted_programs(8);  // nothing is there
  host_->TakeEntries(now_, true);
  host_->Change(gone, now_);
  EXPECT_EQ(host_->TakeEntries(now_, true).size(), 2U);  // one is gone; and a mark
  v1::HostOrder start;
  start.mutable_start_at_step()->set_control_token(token_);
  start.mutable_start_at_step()->set_preview_token(token);
  EXPECT_THAT(Do(start).refusal().message(), HasSubstr("programs were changed"));
  EXPECT_EQ(CodeOf(Start("", 6)), Code(ErrorCode::kCellNotFound));
  memory.set_whole(true);
  memory.mutable_programs()->RemoveLast();
  host_->Change(memory, now_);  // slot 6 alone
  for (const int slot : {5, 7}) EXPECT_EQ(CodeOf(Start("", slot)), Code(ErrorCode::kCellNotFound));
  EXPECT_EQ(CodeOf(Start("", 6)), "");
}

// LIVE-5.03: laser schedules that are the same, or not told of, are no change.
TEST_F(HeldMachines, SchedulesThatAreTheSameAreNoChange) {
  MakeOptimo();
  host_->TakeEntries(now_, true);
  const auto entries = [this](const v1::HostMemory& memory) {
    host_->Change(memory, now_);
    return host_->TakeEntries(now_).size();
  };
  v1::HostMemory memory;
  memory.set_schedules_changed(true);
  EXPECT_EQ(entries(memory), 0U);
  v1::AssignedSchedule& schedule = *memory.add_schedules();
  schedule.set_number(12);
  schedule.set_mode("CW");
  schedule.set_power_percent(40.0);
  memory.set_schedules_changed(false);
  EXPECT_EQ(entries(memory), 0U);
  memory.set_schedules_changed(true);
  EXPECT_EQ(entries(memory), 2U);  // what changed, and a mark
  EXPECT_EQ(entries(memory), 0U);
}

}  // namespace
}  // namespace rmlcell::server
