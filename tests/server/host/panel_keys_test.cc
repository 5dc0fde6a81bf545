// The panel of a mill over the line of its host (live.md 2.13, 7.04 to 7.06, 8.03).
#include <utility>

#include "tests/server/host/host_machine_bed.h"

namespace rmlcell::server {
namespace {

using testing::HasSubstr;

class PanelKeysTest : public HostMachineTest {
 protected:
  void MakeAndTake(v1::ControlLease::OnLoss on_loss = v1::ControlLease::ON_LOSS_HOLD) {
    HostMachineTest::MakeAndTake(on_loss);
    sequence_of_keys_ = 0;
  }
  v1::HostOrder Key(const std::string& key, v1::KeyAction action = v1::KEY_ACTION_TAP,
                    std::int64_t sequence = 0) {
    v1::HostOrder order;
    v1::PressPanelKeyRequest& pressed = *order.mutable_panel_key();
    pressed.set_key(key);
    pressed.set_action(action);
    pressed.set_control_token(token_);
    pressed.set_sequence(sequence > 0 ? sequence : ++sequence_of_keys_);
    return order;
  }
  v1::HostOrder Beat(const std::vector<std::string>& keys) {
    v1::HostOrder order;
    v1::HeartbeatPanelRequest& beat = *order.mutable_panel_heartbeat();
    beat.set_control_token(token_);
    beat.set_number(++beats_);
    for (const std::string& key : keys) beat.add_keys_down(key);
    *beat.mutable_sent() = Stamp(now_.wall);
    return order;
  }
  double Axis(const std::string& name) {
    const v1::MachineStatus status = host_->StatusAt(now_);
    for (const v1::AxisValue& axis : status.axes()) {
      if (axis.axis() == name) return axis.value();
    }
    ADD_FAILURE() << name;
    return 0.0;
  }
  // Held down for so long, with a beat every 50 ms.
  void Hold(const std::string& key, std::chrono::milliseconds time) {
    for (std::chrono::milliseconds gone{0}; gone < time; gone += 50ms) {
      Pass(50ms);
      EXPECT_TRUE(Do(Beat({key})).has_heartbeat());
    }
  }

  std::int64_t sequence_of_keys_ = 0;
  std::int64_t beats_ = 0;
};

// LIVE-8.03: 1 mm/s as long as somebody holds the key; a tap is 0.01 mm.
TEST_F(PanelKeysTest, AKeyMovesWhileItIsHeld) {
  MakeAndTake();
  const double begin = Axis("X");
  EXPECT_EQ(Do(Key("X+", v1::KEY_ACTION_PRESS)).status().state(), v1::MACHINE_STATE_JOGGING);
  Hold("X+", 1s);
  EXPECT_EQ(State(), v1::MACHINE_STATE_JOGGING);
  EXPECT_NEAR(Axis("X") - begin, 1.0, 0.05);
  Do(Key("X+", v1::KEY_ACTION_RELEASE));
  Pass(200ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const double there = Axis("X");
  Do(Key("X+"));
  Pass(500ms);
  EXPECT_NEAR(Axis("X") - there, 0.01, 1e-6);
}

// LIVE-7.05, LIVE-7.06: 150 ms after the last beat it brakes, and the key moves again when it has
// been released: a keyboard that repeats its presses would move the machine on and on.
TEST_F(PanelKeysTest, WhoIsSilentMovesNothing) {
  MakeAndTake();
  Do(Key("X+", v1::KEY_ACTION_PRESS));
  Hold("X+", 500ms);
  const double heard = Axis("X");
  Pass(2s);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_LT(Axis("X") - heard, 0.25);  // 1 mm/s for 160 ms, and what it takes to stop
  // That it was let go is in the journal.
  const auto told = Told();
  EXPECT_GE(std::ranges::count(told, Input(v1::AppliedInput::kKey)), 2);
  EXPECT_EQ(Do(Key("X+", v1::KEY_ACTION_PRESS)).refusal().code(), "CELL-E9434");
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_FALSE(Do(Key("X+", v1::KEY_ACTION_RELEASE)).has_refusal());
  EXPECT_EQ(Do(Key("X+", v1::KEY_ACTION_PRESS)).status().state(), v1::MACHINE_STATE_JOGGING);
}

// LIVE-7.04: a key that was refused before it came to the machine has used up its number, and is
// answered the same when it comes again. Nobody without control uses up any.
TEST_F(PanelKeysTest, AKeyThatWasRefusedOnItsWayIsPassed) {
  MakeAndTake();
  ASSERT_FALSE(Do(Key("COVER")).has_refusal());
  v1::HostOrderAnswer refused;
  refused.mutable_refusal()->set_code("CELL-E9002");
  v1::HostOrder second = Key("COVER");
  second.set_caller("anna");
  host_->PassKey(second, refused, now_);
  EXPECT_EQ(Do(second).refusal().code(), "CELL-E9002");
  EXPECT_FALSE(Do(Key("COVER")).has_refusal());
  v1::HostOrder strange = Key("COVER", v1::KEY_ACTION_TAP, 4);
  strange.set_caller("bert");
  strange.mutable_panel_key()->set_control_token("none");
  host_->PassKey(strange, refused, now_);
  EXPECT_FALSE(Do(Key("COVER")).has_refusal());
}

// LIVE-7.05: a line that is steady and slow would run on for too long: the key is let go by the
// third beat, and refused until the line is fast or forgotten.
TEST_F(PanelKeysTest, ASlowLineMovesNothing) {
  MakeAndTake();
  Do(Key("X+", v1::KEY_ACTION_PRESS));
  v1::HostOrderAnswer heard;
  for (int i = 0; i < 3; ++i) {
    Pass(50ms);
    v1::HostOrder beat = Beat({"X+"});
    beat.mutable_panel_heartbeat()->mutable_round_trip()->set_nanos(100'000'000);
    EXPECT_EQ(State(), v1::MACHINE_STATE_JOGGING);
    heard = Do(beat);
  }
  EXPECT_EQ(heard.refusal().code(), "CELL-E9434");
  EXPECT_THAT(heard.refusal().message(), HasSubstr("100 ms"));
  Pass(200ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_FALSE(Do(Key("X+", v1::KEY_ACTION_RELEASE)).has_refusal());
  EXPECT_EQ(Do(Key("X+", v1::KEY_ACTION_PRESS)).refusal().code(), "CELL-E9434");
  EXPECT_FALSE(Do(Key("X+")).has_refusal());  // a step ends by itself
  Pass(3s);
  EXPECT_EQ(Do(Key("X+", v1::KEY_ACTION_PRESS)).status().state(), v1::MACHINE_STATE_JOGGING);
}

// LIVE-3.14: time that is lost while it moves by hand is told, too.
TEST_F(PanelKeysTest, TimeThatIsLostInAJogIsTold) {
  MakeAndTake();
  Do(Key("X+", v1::KEY_ACTION_PRESS));
  Pass(100ms);
  static_cast<void>(host_->TakeEntries(now_, true));
  Pass(300ms, 300ms);
  std::int64_t lost = 0;
  for (const v1::JournalEntry& entry : host_->TakeEntries(now_, true))
    lost += entry.clock_slipped().lost_ns();
  EXPECT_GT(lost, 0);
}

// LIVE-7.04: the same number is the same press; a press behind its release moves nothing.
TEST_F(PanelKeysTest, NumbersCount) {
  MakeAndTake();
  const v1::HostOrder press = Key("Y+", v1::KEY_ACTION_PRESS);
  EXPECT_FALSE(host_->WaitsForKeys(press, now_));
  Do(press);
  Pass(300ms);  // silent: it stands
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(Do(press).status().state(), v1::MACHINE_STATE_JOGGING);  // as it was then
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const v1::HostOrder late = Key("Y+", v1::KEY_ACTION_PRESS, 2);
  const v1::HostOrder release = Key("Y+", v1::KEY_ACTION_RELEASE, 3);
  EXPECT_FALSE(host_->WaitsForKeys(release, now_));
  Do(release);
  EXPECT_TRUE(host_->WaitsForKeys(Key("Y-", v1::KEY_ACTION_PRESS, 6), now_));
  EXPECT_FALSE(Do(late).has_refusal());
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(Do(Key("Y-", v1::KEY_ACTION_TAP, 0)).refusal().code(), "");
  EXPECT_EQ(Do(Key("Y-", v1::KEY_ACTION_TAP, 50)).refusal().code(), "CELL-E9434");
}

// LIVE-2.13, RML1-3C.09: what was paused at the panel goes on there alone.
TEST_F(PanelKeysTest, APauseAtThePanelEndsThere) {
  MakeAndTake();
  Do(Start());
  Pass(5s, 50ms);
  EXPECT_FALSE(Do(Key("PAUSE")).has_refusal());
  for (int i = 0; i < 600 && State() != v1::MACHINE_STATE_HELD; ++i) Pass(100ms, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_PANEL);
  const v1::HostOrderAnswer refused = Do(Resume());
  EXPECT_EQ(refused.refusal().code(), "CELL-E9421");
  EXPECT_THAT(refused.refusal().message(), HasSubstr("CONTINUE"));
  EXPECT_EQ(Do(Key("CONTINUE")).status().state(), v1::MACHINE_STATE_RUNNING);
  // And STOP drops what is left.
  Do(Key("STOP"));
  Pass(5s, 50ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// LIVE-2.13, LIVE-8.03: cover, power, emergency stop.
TEST_F(PanelKeysTest, CoverPowerEmergencyStop) {
  MakeAndTake();
  EXPECT_TRUE(Do(Key("COVER")).status().door_open());
  EXPECT_EQ(Do(Key("X+", v1::KEY_ACTION_PRESS)).refusal().code(), "CELL-E9433");
  EXPECT_FALSE(Do(Key("COVER")).status().door_open());
  EXPECT_EQ(Do(Key("POWER")).status().state(), v1::MACHINE_STATE_OFF);
  EXPECT_EQ(Do(Key("POWER")).status().state(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(Do(Key("EMERGENCY_STOP", v1::KEY_ACTION_PRESS)).status().state(),
            v1::MACHINE_STATE_ALARM);
  EXPECT_EQ(Do(Key("VOLUME")).refusal().code(), "CELL-E9003");
}

// LIVE-4.02, LIVE-7.06: without control no key; control that is taken over stops what moves.
TEST_F(PanelKeysTest, KeysAreOfWhoHasControl) {
  MakeAndTake();
  Do(Key("X+", v1::KEY_ACTION_PRESS));
  Hold("X+", 300ms);
  const std::string before = std::exchange(token_, "no token");
  EXPECT_EQ(Do(Key("Y+", v1::KEY_ACTION_PRESS)).refusal().code(), "CELL-E9420");
  token_ = before;
  v1::HostOrder release;
  release.mutable_release_control()->set_control_token(token_);
  Do(release);
  Pass(300ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
}

// LIVE-4.03, LIVE-7.06: what is moved by hand brakes when somebody else takes control, and not only
// when nobody says any more that its key is down.
TEST_F(PanelKeysTest, ATakeOverStopsWhatIsMovedByHand) {
  MakeAndTake();
  Do(Key("X+", v1::KEY_ACTION_PRESS));
  Hold("X+", 300ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_JOGGING);
  v1::HostOrder take;
  take.mutable_acquire_control()->set_client("another");
  take.mutable_acquire_control()->set_take_over(true);
  take.mutable_acquire_control()->set_reason("it comes too near");
  take.mutable_acquire_control()->mutable_ttl()->set_seconds(60);
  ASSERT_FALSE(Do(take).has_refusal());
  EXPECT_EQ(State(), v1::MACHINE_STATE_STOPPING);
}

// LIVE-2.13, RML1-3C.09: what !NR pauses goes on at the panel alone, as what its key has paused.
TEST_F(PanelKeysTest, APauseOfTheProgramEndsAtThePanel) {
  MakeAndTake(v1::ControlLease::ON_LOSS_GO_ON);
  v1::HostMemory memory;
  v1::AssignedProgram& program = *memory.add_programs();
  program.set_slot(6);
  program.set_content("PA;PU100,0;!NR;PU200,0;");
  host_->Change(memory, now_);
  const v1::HostOrderAnswer begun = Do(Start("", 6));
  ASSERT_FALSE(begun.has_refusal()) << begun.refusal().message();
  Pass(20s, 100ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_PROGRAM);
  const v1::HostOrderAnswer refused = Do(Resume());
  EXPECT_EQ(refused.refusal().code(), "CELL-E9421");
  EXPECT_THAT(refused.refusal().message(), HasSubstr("CONTINUE"));
  EXPECT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_FALSE(Do(Key("CONTINUE")).has_refusal());
  Pass(20s, 100ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(host_->StatusAt(now_).last_run().outcome().kind(), v1::Outcome::KIND_COMPLETED);
}

// LIVE-7.04: whatever came between: the same number is the same press, with the answer of then.
TEST_F(PanelKeysTest, AnAnswerIsThatOfItsKey) {
  MakeAndTake();
  const v1::HostOrder cover = Key("COVER");
  ASSERT_TRUE(Do(cover).status().door_open());
  v1::HostOrder slower;
  slower.mutable_override()->set_override_percent(50.0);
  slower.mutable_override()->set_control_token(token_);
  ASSERT_FALSE(Do(slower).has_refusal());
  const v1::HostOrderAnswer again = Do(cover);
  EXPECT_TRUE(again.status().door_open());
  EXPECT_EQ(again.status().override_percent(), 100.0);
  EXPECT_TRUE(host_->StatusAt(now_).door_open());  // it was pressed once
}

// LIVE-2.13: keys that act when they are pressed do nothing when they are let go; what becomes of a
// key is said.
TEST_F(PanelKeysTest, LettingGoDoesNothingMore) {
  MakeAndTake();
  for (const char* key : {"PAUSE", "COVER", "POWER", "VIEW"}) {
    const v1::HostOrderAnswer answer = Do(Key(key, v1::KEY_ACTION_RELEASE));
    EXPECT_FALSE(answer.has_refusal()) << key << answer.refusal().message();
  }
  EXPECT_FALSE(host_->StatusAt(now_).door_open());
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  const v1::HostOrderAnswer unsaid = Do(Key("COVER", v1::KEY_ACTION_UNSPECIFIED));
  EXPECT_EQ(unsaid.refusal().code(), "CELL-E9003");
  EXPECT_EQ(unsaid.refusal().message(), "action: say which");
  EXPECT_FALSE(host_->StatusAt(now_).door_open());
}

// LIVE-2.13: a STOP on top of a PAUSE of the panel leaves it to the panel to go on.
TEST_F(PanelKeysTest, APauseThatIsStoppedIsOneOfThePanel) {
  MakeAndTake(v1::ControlLease::ON_LOSS_GO_ON);
  ASSERT_FALSE(Do(Start()).has_refusal());
  Pass(5s, 50ms);
  ASSERT_FALSE(Do(Key("PAUSE")).has_refusal());
  ASSERT_NE(State(), v1::MACHINE_STATE_HELD);  // the stroke ends first
  ASSERT_TRUE(Do(Stop()).has_halt());
  Pass(3s, 50ms);
  ASSERT_EQ(State(), v1::MACHINE_STATE_HELD);
  EXPECT_EQ(host_->StatusAt(now_).hold_reason(), v1::HOLD_REASON_PANEL);
  EXPECT_EQ(Do(Resume()).refusal().code(), "CELL-E9421");
}

// LIVE-7.04, LIVE-7.06: whoever takes control presses from 1 on, and nothing of who had it before
// holds him up: no key that was stopped, no line that was slow.
TEST_F(PanelKeysTest, ANewLeaseKnowsNothingOfTheOneBefore) {
  MakeAndTake();
  Do(Key("X+", v1::KEY_ACTION_PRESS));
  Pass(300ms);  // nobody is heard
  for (int i = 0; i < 3; ++i) {
    Pass(50ms);
    v1::HostOrder beat = Beat({});
    beat.mutable_panel_heartbeat()->mutable_round_trip()->set_nanos(100'000'000);
    Do(beat);
  }
  EXPECT_EQ(Do(Key("X+", v1::KEY_ACTION_PRESS)).refusal().code(), "CELL-E9434");
  v1::HostOrder release;
  release.mutable_release_control()->set_control_token(token_);
  ASSERT_FALSE(Do(release).has_refusal());
  Control();
  sequence_of_keys_ = 0;
  beats_ = 0;
  EXPECT_TRUE(host_->WaitsForKeys(Key("COVER", v1::KEY_ACTION_TAP, 2), now_));
  EXPECT_FALSE(host_->WaitsForKeys(Key("COVER", v1::KEY_ACTION_TAP, 1), now_));
  const v1::HostOrderAnswer pressed = Do(Key("X+", v1::KEY_ACTION_PRESS));
  EXPECT_EQ(pressed.status().state(), v1::MACHINE_STATE_JOGGING) << pressed.refusal().message();
  Hold("X+", 500ms);
  EXPECT_EQ(State(), v1::MACHINE_STATE_JOGGING);
}

// LIVE-7.06: pressing a key that was stopped once more does not release it; a tap, which is a
// release as well, does, and moves nothing itself.
TEST_F(PanelKeysTest, ATapReleasesAKeyThatWasStopped) {
  MakeAndTake();
  Do(Key("X+", v1::KEY_ACTION_PRESS));
  Hold("X+", 300ms);
  Pass(2s);  // nobody is heard
  ASSERT_EQ(State(), v1::MACHINE_STATE_IDLE);
  for (int press = 0; press < 2; ++press)
    EXPECT_EQ(Do(Key("X+", v1::KEY_ACTION_PRESS)).refusal().code(), "CELL-E9434") << press;
  EXPECT_EQ(Do(Key("X+")).refusal().code(), "CELL-E9434");
  EXPECT_EQ(State(), v1::MACHINE_STATE_IDLE);
  EXPECT_EQ(Do(Key("X+", v1::KEY_ACTION_PRESS)).status().state(), v1::MACHINE_STATE_JOGGING);
}

}  // namespace
}  // namespace rmlcell::server
