// The handbox of an Optimo over the line of its host (live.md 7).
#include <sstream>
#include <utility>

#include "proto/recording/replay.h"
#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class HandboxOverTheLine : public HostMachineTest {
 protected:
  void Open() {
    v1::HostOrder order;
    order.mutable_create_session()->set_control_token(token_);
    const v1::HostOrderAnswer answer = Do(order);
    ASSERT_TRUE(answer.has_session()) << answer.refusal().message();
    session_ = answer.session().name();
    keys_pressed_ = 0;
  }
  v1::HostOrder Key(const std::string& key, v1::KeyAction action = v1::KEY_ACTION_TAP) {
    return KeyOf(session_, key, action);
  }
  v1::PressKeyResponse Press(const std::string& names) {
    v1::PressKeyResponse last;
    std::istringstream all(names);
    for (std::string name; all >> name;) {
      const v1::HostOrderAnswer answer = Do(Key(name));
      EXPECT_TRUE(answer.has_key()) << name << ": " << answer.refusal().message();
      last = answer.key();
    }
    return last;
  }
  v1::HostOrder Beat(const std::string& key) {
    v1::HostOrder order;
    v1::HeartbeatHandboxRequest& beat = *order.mutable_handbox_heartbeat();
    beat.set_session(session_);
    beat.set_control_token(token_);
    beat.set_number(++beats_);
    beat.add_keys_down(key);
    *beat.mutable_sent() = Stamp(now_.wall);
    return order;
  }
  // What was asked of the store is there, as its server tells the host then.
  void Store(const v1::HostEdit& edit) {
    v1::HostMemory memory;
    v1::AssignedProgram& program = *memory.add_programs();
    program.set_slot(edit.slot());
    program.set_content(edit.object());
    program.set_object_revision(edit.object_revision() + 1);
    v1::HostEditAnswer answer;
    answer.set_number(edit.number());
    host_->EditAnswered(answer, now_);
    host_->Change(memory, now_);
  }

  std::string session_;
  std::int64_t beats_ = 0;
};

// LIVE-7.02: a session is of whoever has control, and ends with that.
TEST_F(HandboxOverTheLine, ASessionIsOfWhoHasControl) {
  MakeAndTakeOptimo();
  v1::HostOrder order;
  order.mutable_create_session()->set_control_token("no token");
  EXPECT_EQ(Do(order).refusal().code(), "CELL-E9420");
  Open();
  EXPECT_EQ(session_, "machines/optimo-1/handboxSessions/1");
  EXPECT_EQ(Press("MODE_LEFT").panel().holder(), "anna");
  v1::HostOrder release;
  release.mutable_release_control()->set_control_token(token_);
  Do(release);
  EXPECT_EQ(host_->Handbox()->holder(), "");
  Control();
  EXPECT_EQ(host_->Handbox()->holder(), "");
  EXPECT_EQ(Do(Key("MODE_LEFT")).refusal().code(), "CELL-E9004");
  Open();
  EXPECT_EQ(session_, "machines/optimo-1/handboxSessions/2");
}

// LIVE-4.03: a mask that was open when control is taken over is nobody's; one stays open while
// nobody takes anything from anybody.
TEST_F(HandboxOverTheLine, AMaskEndsWhereControlIsTakenOver) {
  MakeAndTakeOptimo();
  Open();
  Press("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT MOV");
  const std::string mask = Press("DEL 3").panel().display();
  EXPECT_THAT(mask, HasSubstr("SPEED"));
  v1::HostOrder take;
  take.mutable_acquire_control()->set_client("another");
  EXPECT_EQ(Do(take).refusal().code(), "CELL-E9408");
  EXPECT_EQ(host_->Handbox()->display(), mask);
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("the next shift");
  token_ = Do(take).control().control_token();
  EXPECT_THAT(host_->Handbox()->display(), testing::Not(HasSubstr("SPEED")));
  Open();
  EXPECT_THAT(Press("ENT").panel().display(), testing::Not(HasSubstr("SPEED")));
  // With the session, too.
  EXPECT_THAT(Press("MOV DEL 4").panel().display(), HasSubstr("SPEED"));
  Open();
  EXPECT_THAT(host_->Handbox()->display(), testing::Not(HasSubstr("SPEED")));
}

// LIVE-7.07, OPT-4.19: START in CYCLE begins the program that is selected, without a job.
TEST_F(HandboxOverTheLine, StartBeginsTheSelectedProgram) {
  MakeAndTakeOptimo();
  Open();
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  auto made =
      family.Translate({.name = "12.S", .bytes = "DELAY 1\nDELAY 1\n"},
                       *machine::MakeParameters(family, "", {}), {.advice = false, .source = true});
  ASSERT_TRUE(made.ok);
  v1::HostMemory memory;
  memory.add_programs()->set_slot(12);
  memory.mutable_programs(0)->set_content(made.object);
  host_->Change(memory, now_);
  Press("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT MODE_RIGHT MODE_RIGHT");
  static_cast<void>(host_->TakeEntries(now_, true));
  const v1::PressKeyResponse begun = Press("START");
  EXPECT_FALSE(begun.has_message()) << begun.message().code();
  EXPECT_EQ(State(), v1::MACHINE_STATE_RUNNING);
  EXPECT_EQ(host_->StatusAt(now_).run().program(), 12);
  // LIVE-3.23: marked at once, however soon a crash comes.
  const std::vector<v1::JournalEntry> told = host_->TakeEntries(now_);
  ASSERT_FALSE(told.empty());
  EXPECT_TRUE(told.back().has_mark());
  EXPECT_FALSE(told.back().mark().clean());
  Pass(3s);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  // LIVE-3.40: a recording of its own, from that key on.
  static_cast<void>(host_->TakeEntries(now_, true));
  v1::HostOrder order;
  order.mutable_recording();
  const auto recording = recording::ReadFile(Do(order).recording().chunk());
  ASSERT_TRUE(recording) << recording.error().detail;
  const auto played = recording::Replay(*recording, {});
  ASSERT_TRUE(played) << played.error().detail;
  EXPECT_FALSE(played->difference) << played->difference->field;
  EXPECT_EQ(played->inputs, 1);
}

// LIVE-9.06, OPT-4.34: the override has ten steps, from afar as well; a mill is set to any.
TEST_F(HandboxOverTheLine, TheOverrideHasTenSteps) {
  MakeAndTakeOptimo();
  const auto set = [this](double percent) {
    v1::HostOrder order;
    order.mutable_override()->set_control_token(token_);
    order.mutable_override()->set_override_percent(percent);
    return Do(order);
  };
  for (int step = 0; step < 10; ++step) EXPECT_FALSE(set(10.0 + 15.0 * step).has_refusal()) << step;
  for (const double between : {11.0, 50.0, 80.0, 120.0, 144.9}) {
    const v1::HostOrderAnswer answer = set(between);
    EXPECT_EQ(answer.refusal().code(), "CELL-E9003") << between;
    EXPECT_THAT(answer.refusal().message(),
                testing::HasSubstr("10, 25, 40, 55, 70, 85, 100, 115, 130, 145"));
  }
  for (const double beyond : {-5.0, 9.0, 146.0, 160.0})
    EXPECT_THAT(set(beyond).refusal().message(), testing::HasSubstr("it is 10 to 145 %"));
  EXPECT_EQ(host_->StatusAt(now_).override_percent(), 145.0);
  Make();
  Control();
  EXPECT_FALSE(set(80.0).has_refusal());
}

// LIVE-7.10: what the control says is an answer, what nobody can press is none.
TEST_F(HandboxOverTheLine, TheControlAnswers) {
  MakeAndTakeOptimo();
  Open();
  const v1::PressKeyResponse dead = Press("REC");  // in REMOTE
  EXPECT_EQ(dead.message().code(), "OPT-E7601");
  EXPECT_EQ(dead.panel().display().size(), 20U);
  EXPECT_EQ(dead.panel().mode(), v1::OPERATING_MODE_REMOTE);
  EXPECT_EQ(Do(Key("VOLUME")).refusal().code(), "CELL-E9003");
  EXPECT_EQ(Do(Key("REC", v1::KEY_ACTION_UNSPECIFIED)).refusal().code(), "CELL-E9003");
  const v1::PressKeyResponse manual = Press("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT");
  EXPECT_EQ(manual.panel().mode(), v1::OPERATING_MODE_MANUAL);
  EXPECT_FALSE(manual.has_message());
  EXPECT_GT(manual.panel().run_on_mm(), 0.0);
  EXPECT_EQ(host_->StatusAt(now_).mode(), v1::OPERATING_MODE_MANUAL);
}

// LIVE-7.05, LIVE-3.40: a jog key is held by who is heard; keys are played again.
TEST_F(HandboxOverTheLine, AJogKeyIsHeld) {
  MakeAndTakeOptimo();
  Open();
  Press("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT");
  const auto x = [this] { return host_->StatusAt(now_).axes(0).value(); };
  const double begin = x();
  EXPECT_TRUE(Do(Key("X+", v1::KEY_ACTION_PRESS)).has_key());
  for (int i = 0; i < 10; ++i) {
    Pass(50ms);
    EXPECT_TRUE(Do(Beat("X+")).has_heartbeat());
  }
  EXPECT_EQ(State(), v1::MACHINE_STATE_JOGGING);
  EXPECT_GT(x(), begin + 1.0);
  Pass(1s);  // silent
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  static_cast<void>(host_->TakeEntries(now_, true));
  v1::HostOrder order;
  order.mutable_recording();
  const auto recording = recording::ReadFile(Do(order).recording().chunk());
  ASSERT_TRUE(recording) << recording.error().detail;
  const auto played = recording::Replay(*recording, {});
  ASSERT_TRUE(played) << played.error().detail;
  EXPECT_FALSE(played->difference) << played->difference->field;
  EXPECT_EQ(played->inputs, 6);  // four for the mode, the key, that it was let go
  v1::PressedKey newest;
  for (const v1::JournalEntry& entry : recording->entries) {
    if (entry.has_applied()) newest = entry.applied().input().key();
  }
  EXPECT_EQ(newest.key(), "HANDBOX X+");
  EXPECT_EQ(newest.action(), v1::KEY_ACTION_RELEASE);
}

// LIVE-7.02, LIVE-7.06: a key that is down ends with its session; the next one counts its keys and
// beats from 1.
TEST_F(HandboxOverTheLine, AKeyEndsWithItsSession) {
  MakeAndTakeOptimo();
  Open();
  Press("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT");
  const auto hold = [this] {
    EXPECT_TRUE(Do(Key("X+", v1::KEY_ACTION_PRESS)).has_key());
    beats_ = 0;
    for (int i = 0; i < 10; ++i) {
      Pass(50ms);
      EXPECT_TRUE(Do(Beat("X+")).has_heartbeat());
    }
    EXPECT_EQ(State(), v1::MACHINE_STATE_JOGGING);
  };
  hold();
  v1::HostOrder close;
  close.mutable_delete_session()->set_name(session_);
  ASSERT_FALSE(Do(close).has_refusal());
  Pass(1s);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  Open();
  hold();
}

// LIVE-7.08: a program that is taught goes to the store, and counts when it is there.
TEST_F(HandboxOverTheLine, WhatIsTaughtIsStored) {
  MakeAndTakeOptimo();
  Open();
  Press("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC");
  std::vector<v1::HostEdit> edits = host_->TakeEdits();
  ASSERT_THAT(edits, SizeIs(1));
  EXPECT_EQ(edits[0].slot(), 12);
  EXPECT_EQ(edits[0].object_revision(), 0);
  EXPECT_EQ(edits[0].caller(), "anna");
  EXPECT_THAT(edits[0].object(), testing::Not(IsEmpty()));
  Store(edits[0]);
  EXPECT_THAT(host_->Handbox()->display(), HasSubstr("P=12"));
  EXPECT_THAT(host_->TakeEdits(), IsEmpty());
  Press("DLY DEL 0 POINT 5 ENT REC");
  edits = host_->TakeEdits();
  ASSERT_THAT(edits, SizeIs(1));
  EXPECT_EQ(edits[0].object_revision(), 1);
  // The store is away: the control says so, and nothing is lost.
  v1::HostEditAnswer refused;
  refused.set_number(edits[0].number());
  refused.mutable_refusal()->set_code("CELL-E9108");
  host_->EditAnswered(refused, now_);
  EXPECT_EQ(host_->Handbox()->message_code(), "CELL-E9108");
  EXPECT_TRUE(host_->Handbox()->flashing());
}

// LIVE-7.04, LIVE-7.08: keys wait while what was taught is being stored; one that moves does not.
TEST_F(HandboxOverTheLine, KeysWaitForWhatIsBeingStored) {
  MakeAndTakeOptimo();
  Open();
  Press("MODE_LEFT MODE_LEFT MODE_LEFT MODE_LEFT JOB 1 2 ENT REC");
  const std::vector<v1::HostEdit> edits = host_->TakeEdits();
  ASSERT_THAT(edits, SizeIs(1));
  const v1::HostOrder next = Key("PREV");
  EXPECT_TRUE(host_->WaitsForKeys(next, now_));
  EXPECT_TRUE(host_->Settles());
  v1::HostOrder slower = next;  // it overtakes no key that was pressed before
  slower.mutable_key()->set_key("OVERRIDE_MINUS");
  EXPECT_TRUE(host_->WaitsForKeys(slower, now_));
  slower.mutable_key()->set_sequence(keys_pressed_ + 2);
  EXPECT_TRUE(host_->WaitsForKeys(slower, now_));
  v1::HostOrder jog = next;
  jog.mutable_key()->set_key("X+");
  jog.mutable_key()->set_action(v1::KEY_ACTION_PRESS);
  EXPECT_FALSE(host_->WaitsForKeys(jog, now_));
  // Whoever has lost control is told so, and not that keys are missing.
  v1::HostOrder stranger = next;
  stranger.mutable_key()->set_control_token("another token");
  stranger.mutable_key()->set_sequence(keys_pressed_ + 5);
  EXPECT_FALSE(host_->WaitsForKeys(stranger, now_));
  EXPECT_EQ(Do(stranger).refusal().code(), "CELL-E9420");
  Store(edits[0]);
  EXPECT_FALSE(host_->WaitsForKeys(next, now_));
  EXPECT_TRUE(Do(next).has_key());
}

// LIVE-4.03: how old a heartbeat is must be known.
TEST_F(HandboxOverTheLine, AHeartbeatSaysWhenItWasSent) {
  MakeAndTakeOptimo();
  Open();
  v1::HostOrder beat = Beat("X+");
  beat.mutable_handbox_heartbeat()->clear_sent();
  EXPECT_EQ(Do(beat).refusal().code(), "CELL-E9003");
  EXPECT_FALSE(Do(Beat("X+")).has_refusal());
}

// LIVE-8.04: a mill has no handbox.
TEST_F(HandboxOverTheLine, AMillHasNone) {
  Make();
  Control();
  v1::HostOrder order;
  order.mutable_create_session()->set_control_token(token_);
  EXPECT_EQ(Do(order).refusal().code(), "CELL-E9424");
  EXPECT_FALSE(host_->Handbox());
}

}  // namespace
}  // namespace rmlcell::server
