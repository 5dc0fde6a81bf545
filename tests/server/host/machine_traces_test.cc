// What a live machine leaves behind: executables that its runs made, orders that were refused, time
// that it lost, words that came late (live.md 3, 5, 7).
#include <string>
#include <utility>
#include <vector>

#include "proto/recording/replay.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class MachineTraces : public HostMachineTest {
 protected:
  static std::string ObjectOf(const std::string& source) {
    const machine::MachineFamily& family = *families::FindFamily("optimo");
    const auto made = family.Translate({.name = "12.S", .bytes = source},
                                       *machine::MakeParameters(family, "", {}),
                                       {.advice = false, .source = true});
    EXPECT_TRUE(made.ok);
    return made.object;
  }
  std::vector<v1::JournalEntry> Of(v1::JournalEntry::WhatCase what) {
    std::vector<v1::JournalEntry> found;
    for (v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
      if (entry.what_case() == what) found.push_back(std::move(entry));
    }
    return found;
  }
  v1::HostOrder JogKey(v1::KeyAction action, std::int64_t sequence) {
    v1::HostOrder order;
    v1::PressPanelKeyRequest& pressed = *order.mutable_panel_key();
    pressed.set_key("X+");
    pressed.set_action(action);
    pressed.set_control_token(token_);
    pressed.set_sequence(sequence);
    return order;
  }
  // Sent so long ago, by a clock that agrees.
  v1::HostOrder BeatSentBefore(std::chrono::milliseconds before, bool holds) {
    v1::HostOrder order;
    v1::HeartbeatPanelRequest& beat = *order.mutable_panel_heartbeat();
    beat.set_control_token(token_);
    beat.set_number(++beats_);
    if (holds) beat.add_keys_down("X+");
    *beat.mutable_sent() = Stamp(now_.wall - before);
    return order;
  }
  std::int64_t beats_ = 0;
};

// LIVE-5.07: the end of a run has the executable that it made, for the text that it was made of.
TEST_F(MachineTraces, AnEndHasTheExecutablesThatWereMade) {
  MakeAndTakeOptimo();
  v1::HostMemory memory;
  v1::AssignedProgram& program = *memory.add_programs();
  program.set_slot(12);
  program.set_content(ObjectOf("DELAY 1\nDELAY 1\n"));
  program.set_object_revision(41);
  host_->Change(memory, now_);
  Of(v1::JournalEntry::kRunOver);
  const v1::HostOrderAnswer begun = Do(Start("", 12));
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  Pass(60s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const auto over = Of(v1::JournalEntry::kRunOver);
  ASSERT_EQ(over.size(), 1U);
  ASSERT_EQ(over[0].executables_size(), 1);
  EXPECT_EQ(over[0].executables(0).slot(), 12);
  EXPECT_EQ(over[0].executables(0).object_revision(), 41);
  EXPECT_FALSE(over[0].executables(0).content().empty());
}

// OPT-4.50: ZERO from the console is over before program 4 behind it begins, and both are told.
TEST_F(MachineTraces, ZeroIsOverBeforeProgramFourBegins) {
  MakeAndTakeOptimo();
  v1::HostMemory memory;
  v1::AssignedProgram& program = *memory.add_programs();
  program.set_slot(4);
  program.set_content(ObjectOf("DELAY 1\n"));
  host_->Change(memory, now_);
  host_->TakeEntries(now_, true);
  v1::HostOrder zero;
  zero.mutable_zero()->set_control_token(token_);
  const v1::HostOrderAnswer zeroing = Do(zero);
  ASSERT_FALSE(zeroing.has_refusal()) << zeroing.refusal().message();
  Pass(60s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  std::vector<std::string> told;
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
    if (entry.has_run_begun())
      told.push_back("begun " + std::to_string(entry.run_begun().program()));
    if (entry.has_run_over()) told.push_back("over " + std::to_string(entry.run_over().program()));
  }
  EXPECT_THAT(told, testing::ElementsAre("begun 0", "over 0", "begun 4", "over 4"));
}

// A job that did not begin is nobody's afterwards, and neither is what it brought.
TEST_F(MachineTraces, AJobThatIsRefusedLeavesNothing) {
  MakeAndTakeOptimo();
  for (const bool on : {false, true}) {
    v1::HostOrder power;
    power.mutable_inputs()->set_control_token(token_);
    power.mutable_inputs()->add_inputs()->set_power(on);
    ASSERT_FALSE(Do(power).has_refusal());
    Pass(20s, 50ms);
  }
  ASSERT_EQ(State(), v1::MACHINE_STATE_NOT_ZEROED);
  const v1::HostOrderAnswer refused = Do(JobOf("DELAY 1\nDELAY 2\n"));
  ASSERT_EQ(refused.refusal().code(), CodeText(ErrorCode::kNotZeroed))
      << refused.refusal().message();
  v1::HostMemory memory;
  v1::AssignedProgram& program = *memory.add_programs();
  program.set_slot(12);
  program.set_content(ObjectOf("DELAY 1\n"));
  host_->Change(memory, now_);
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true))
    EXPECT_EQ(entry.job(), "") << entry.ShortDebugString();
  const v1::MachineRecording recorded = RecordingHead();
  EXPECT_FALSE(recorded.has_brought());
  EXPECT_EQ(recorded.job(), "");
}

// LIVE-3.14: how much time was lost, and of which host.
TEST_F(MachineTraces, TimeThatIsLostIsToldWithItsFence) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(2s);
  Of(v1::JournalEntry::kClockSlipped);
  now_.steady += 700ms;
  now_.wall += 700ms;
  while (!host_->GoOn(now_)) continue;
  const auto slipped = Of(v1::JournalEntry::kClockSlipped);
  ASSERT_EQ(slipped.size(), 1U);
  EXPECT_EQ(slipped[0].clock_slipped().fence(), 7);
  EXPECT_GT(slipped[0].clock_slipped().lost_ns(), 0);
  EXPECT_LE(slipped[0].clock_slipped().lost_ns(), 700'000'000);
  EXPECT_EQ(slipped[0].clock_slipped().virtual_time_ns(), slipped[0].virtual_time_ns());
}

// LIVE-7.05: by clocks that agree each way may take 40 ms; what is held over a slower line is let
// go.
TEST_F(MachineTraces, AKeyIsLetGoWhereItsLineBecomesSlow) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_HOLD);
  ASSERT_FALSE(Do(JogKey(v1::KEY_ACTION_PRESS, 1)).has_refusal());
  for (int beat = 0; beat < 2; ++beat) {
    Pass(50ms);
    EXPECT_TRUE(Do(BeatSentBefore(60ms, true)).has_heartbeat());
    EXPECT_EQ(State(), v1::MACHINE_STATE_JOGGING);
  }
  Pass(50ms);
  Of(v1::JournalEntry::kApplied);
  const v1::HostOrderAnswer slow = Do(BeatSentBefore(60ms, true));
  EXPECT_EQ(Of(v1::JournalEntry::kApplied).size(), 1U);  // at once
  EXPECT_EQ(slow.refusal().code(), CodeText(ErrorCode::kCellKeySequence));
  EXPECT_THAT(slow.refusal().message(), HasSubstr("takes 60 ms to come, at most 40 ms"));
  Pass(100ms);  // less than a silence
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const v1::HostOrderAnswer again = Do(JogKey(v1::KEY_ACTION_PRESS, 2));
  EXPECT_EQ(again.refusal().code(), CodeText(ErrorCode::kCellKeySequence));
}

// As fast as it may be.
TEST_F(MachineTraces, AKeyIsHeldOverALineThatIsFastEnough) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_HOLD);
  ASSERT_FALSE(Do(JogKey(v1::KEY_ACTION_PRESS, 1)).has_refusal());
  for (int beat = 0; beat < 6; ++beat) {
    Pass(50ms);
    const v1::HostOrderAnswer heard = Do(BeatSentBefore(40ms, true));
    ASSERT_TRUE(heard.has_heartbeat()) << heard.refusal().message();
    EXPECT_EQ(heard.heartbeat().sent().nanos(), Stamp(now_.wall - 40ms).nanos());
    EXPECT_EQ(heard.heartbeat().received().nanos(), Stamp(now_.wall).nanos());
  }
  EXPECT_EQ(State(), v1::MACHINE_STATE_JOGGING);
}

// SIMUL goes up to a step of the program that is named, or else of the selected one.
TEST_F(MachineTraces, ADryRunEndsInTheProgramThatIsMeant) {
  MakeAndTakeOptimo();
  v1::HostMemory memory;
  for (const int slot : {1, 12}) {
    v1::AssignedProgram& program = *memory.add_programs();
    program.set_slot(slot);
    program.set_content(ObjectOf("DELAY 1\nDELAY 1\nDELAY 1\n"));
  }
  host_->Change(memory, now_);
  ASSERT_FALSE(Do(Start("", 12)).has_refusal());
  Pass(30s, 50ms);
  const auto until = [this](int program) {
    v1::HostOrder order;
    order.mutable_simulation()->set_control_token(token_);
    order.mutable_simulation()->mutable_until()->set_program(program);
    order.mutable_simulation()->mutable_until()->set_step(3);
    const v1::HostOrderAnswer answer = Do(order);
    EXPECT_FALSE(answer.has_refusal()) << answer.refusal().message();
    EXPECT_EQ(answer.run_state().fence(), 7);
    EXPECT_EQ(answer.run_state().simulation_until().step(), 3);
    return answer.run_state().simulation_until().program();
  };
  EXPECT_EQ(until(0), 12);
  EXPECT_EQ(until(1), 1);
  EXPECT_EQ(until(12), 12);
  // LIVE-3.16: up to there the run is told to be dry, and no further.
  v1::HostOrder halt;
  halt.mutable_breakpoints()->set_control_token(token_);
  v1::StepPlace& at = *halt.mutable_breakpoints()->add_breakpoints()->mutable_step();
  at.set_program(12);
  at.set_step(2);
  ASSERT_FALSE(Do(halt).has_refusal());
  ASSERT_FALSE(Do(Start("", 12)).has_refusal());
  Pass(500ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_TRUE(host_->StatusAt(now_).run().dry());
  ASSERT_FALSE(Do(Resume()).has_refusal());
  Pass(500ms);  // in the DELAY that is real
  EXPECT_TRUE(host_->StatusAt(now_).has_run());
  EXPECT_FALSE(host_->StatusAt(now_).run().dry());
}

// LIVE-3.27: behind a crash an answer is known for ten minutes from when it was given.
TEST_F(MachineTraces, AnAnswerOfAnEarlierHostIsKeptNoLonger) {
  const auto make = [this](std::chrono::minutes ago) {
    v1::JournalEntry entry;
    entry.set_fence(6);
    entry.set_sequence(3);
    *entry.mutable_time() = Stamp(now_.wall - ago);
    entry.mutable_answered()->set_request_id("once");
    entry.mutable_answered()->set_caller("anna");
    entry.mutable_answered()->set_kind(v1::HostOrder::kStart);
    entry.mutable_answered()->mutable_answer()->mutable_refusal()->set_message("as before");
    auto made = HostMachine::Make({.name = "machines/mill-1",
                                   .host = "workshop/1",
                                   .fence = 7,
                                   .family = families::FindFamily("rml1"),
                                   .profile = "srm-20",
                                   .answered = {entry}},
                                  now_, [this] { return "token " + std::to_string(++tokens_); });
    ASSERT_TRUE(made) << made.error().detail;
    host_ = *std::move(made);
    host_->Begin({}, now_);
    Control(v1::ControlLease::ON_LOSS_GO_ON);
  };
  make(9min);
  Pass(2min, 1s);
  Do(Start("another"));
  EXPECT_NE(Do(Start("once")).refusal().message(), "as before");
  make(9min);
  Pass(30s, 1s);
  Do(Start("another"));
  EXPECT_EQ(Do(Start("once")).refusal().message(), "as before");
}

// LIVE-2.10: a start that is refused begins nothing: why the run of a job is held stays as it was,
// and what comes of it is told by the time since it began.
TEST_F(MachineTraces, AStartThatIsRefusedLeavesTheRunAsItIs) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  Pass(3s, 50ms);
  Of(v1::JournalEntry::kApplied);
  ASSERT_FALSE(Do(JobOf(kSquare, "square.rml")).has_refusal());
  const auto started = Of(v1::JournalEntry::kApplied);
  ASSERT_EQ(started.size(), 1U);
  EXPECT_EQ(started[0].run_time_ns(), 0);
  Pass(5s, 50ms);
  host_->Hold(v1::HOLD_REASON_SERVER_LOST, now_);
  Pass(2s);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  static_cast<void>(host_->TakeEntries(now_, true));
  ASSERT_TRUE(Do(Start()).has_refusal());
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_SERVER_LOST);
  ASSERT_FALSE(Do(Resume()).has_refusal());
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true)) {
    EXPECT_EQ(entry.job(), "jobs/17");
    EXPECT_EQ(entry.run_time_ns(), entry.virtual_time_ns() - started[0].virtual_time_ns());
  }
}

// LIVE-3.14: a run that is held loses time as well, though nothing moves.
TEST_F(MachineTraces, TimeThatIsLostInAHoldIsTold) {
  Make();
  host_->Begin({}, now_);
  Control(v1::ControlLease::ON_LOSS_GO_ON);
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(2s);
  Do(Stop());
  Pass(2s);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  Of(v1::JournalEntry::kClockSlipped);
  Pass(700ms, 700ms);
  const auto slipped = Of(v1::JournalEntry::kClockSlipped);
  ASSERT_EQ(slipped.size(), 1U);
  EXPECT_GT(slipped[0].clock_slipped().lost_ns(), 0);
  EXPECT_LE(slipped[0].clock_slipped().lost_ns(), 700'000'000);
}

// LIVE-3.40: what an earlier host had to tell is in the recording that it made, and is not added
// to that once more.
TEST_F(MachineTraces, WhatAnEarlierHostRecordedStaysAsItWas) {
  v1::JournalEntry event;
  event.set_fence(6);
  event.set_sequence(10);
  event.mutable_event()->mutable_message()->set_text("hello");
  auto made = HostMachine::Make(
      {.name = "machines/mill-1",
       .host = "workshop/1",
       .fence = 7,
       .family = families::FindFamily("rml1"),
       .profile = "srm-20",
       .untold = {event},
       .recording = MachineRecorder::OfJob{.job = "jobs/17", .file = "as it was"}},
      now_, [] { return std::string("token"); });
  ASSERT_TRUE(made) << made.error().detail;
  host_ = *std::move(made);
  host_->Begin({}, now_);
  EXPECT_EQ(Of(v1::JournalEntry::kEvent).size(), 1U);
  v1::HostOrder order;
  order.mutable_recording()->set_job("jobs/17");
  EXPECT_EQ(Do(order).recording().chunk(), "as it was");
}

}  // namespace
}  // namespace rmlcell::server
