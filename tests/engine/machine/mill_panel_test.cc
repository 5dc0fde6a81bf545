// The keys of a mill's panel: VIEW, SPINDLE, Z0, ORIGIN, HOME, and the step of its jog keys.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

constexpr PressPanel kPressView{PanelKey::kView};
constexpr PressPanel kPressSpindle{PanelKey::kSpindle};
constexpr PressPanel kPressZ0{PanelKey::kZ0};
constexpr PressPanel kPressOrigin{PanelKey::kOrigin};
constexpr PressPanel kPressHome{PanelKey::kHome};
constexpr std::array kEveryKey = {kPressView, kPressSpindle, kPressZ0, kPressOrigin, kPressHome};

// An SRM-20, 203.2 x 152.4 x 60.5 mm, with keys that somebody has described.
class MillPanelTest : public MachineTest {
 protected:
  MillPanelTest() : MachineTest("rml1") {}

  void LoadWith(const std::map<std::string, std::string>& values, const std::string& state = {},
                const std::string& program = "PA;VS10;PU1000,1000;!NR;PU2000,2000;") {
    Parameters made = *MakeParameters(family_, "srm-20", values);
    MachineMemory memory;
    memory.programs[1] = Translated(program);
    machine = *Machine::Make(family_, std::move(made), std::move(memory), state, heard);
  }
  void LoadDescribed(const std::string& program = "PA;VS10;PU1000,1000;!NR;PU2000,2000;") {
    LoadWith({{"PANEL", "FULL"}}, {}, program);
  }
  // At (30, 20, -10) mm.
  void PutAway() {
    const struct {
      JogKey key;
      double seconds;
    } ways[] = {
        {{JogAxis::kX, true}, 30.0}, {{JogAxis::kY, true}, 20.0}, {{JogAxis::kZ, false}, 10.0}};
    for (const auto& [key, seconds] : ways) {
      Good(PressJog{.key = key});
      GoOnFor(seconds);
      Good(ReleaseJog{key});
      GoOnFor(0.1);
    }
    ExpectAt(kAway);
  }
  void ExpectAt(const motion::MachinePoint& place) {
    EXPECT_NEAR((machine->status().run.axes.column - place).norm(), 0.0, 1e-9)
        << machine->status().run.axes.column.transpose();
  }
  // Goes on until it stands.
  void ToRest() {
    for (int n = 0; n < 1000 && MovesAxes(state()); ++n) GoOnFor(0.1);
    EXPECT_FALSE(MovesAxes(state()));
  }
  void GoOnFor(double seconds) { GoOn(machine->time() + At(seconds)); }
  double TipSpeed() const { return machine->status().run.tip_speed_mm_s; }
  bool Turns() const { return machine->status().run.spindle_on; }

  const motion::MachinePoint kAway{30.0, 20.0, -10.0};
};

// LIVE-2.13: of a panel that nobody has described pause, cover and power are known, no more.
TEST_F(MillPanelTest, AnUnknownPanelHasNone) {
  LoadWith({});
  for (const PressPanel& press : kEveryKey) EXPECT_THAT(Refused(press), HasSubstr("CELL-E9424"));
  EXPECT_THAT(Refused(kPressZ0), HasSubstr("a key Z0"));
}

// LIVE-2.13: nor has the other family one.
TEST(PanelOfOptimoTest, ItHasNone) {
  const MachineFamily& family = *families::FindFamily("optimo");
  RunObserver nobody;
  auto machine = *Machine::Make(family, *MakeParameters(family, "", {}), {}, {}, nobody);
  for (const PressPanel& press : kEveryKey)
    EXPECT_EQ(machine->Apply(press).error().code, ErrorCode::kCellNotLive);
}

// LIVE-2.13: up, then out: to the left and back; at rest between, as fast as it goes by hand.
TEST_F(MillPanelTest, ViewTakesTheToolAwayAndBack) {
  LoadDescribed();
  PutAway();
  Good(kPressView);
  EXPECT_EQ(state(), MachineState::kJogging);
  // 10 mm at 30 mm/s and 200 mm/s^2: 10/30 + 30/200 s.
  GoOnFor(10.0 / 30.0 + 30.0 / 200.0 - 0.001);
  EXPECT_NEAR(machine->status().run.axes.column.z(), 0.0, 1e-3);
  EXPECT_NEAR(machine->status().run.axes.column.x(), 30.0, 1e-9);
  ToRest();
  EXPECT_EQ(state(), MachineState::kIdle);
  ExpectAt({0.0, 152.4, 0.0});
  // As it came: across at the top, and down over its place alone.
  Good(kPressView);
  EXPECT_EQ(state(), MachineState::kJogging);
  for (int n = 0; n < 1000 && MovesAxes(state()); ++n) {
    GoOnFor(0.1);
    const motion::MachineVector left = machine->status().run.axes.column - kAway;
    if (std::hypot(left.x(), left.y()) > 1e-6) {
      EXPECT_NEAR(left.z(), 10.0, 1e-9) << n;
    }
  }
  ExpectAt(kAway);
  EXPECT_TRUE(machine->TakeRunsOver().empty());
}

// LIVE-2.13, RML1-3A.40: up, and to the origin.
TEST_F(MillPanelTest, HomeGoesToTheOrigin) {
  LoadWith({{"PANEL", "FULL"}, {"ORIGIN_X", "5"}, {"ORIGIN_Y", "7"}});
  Good(PressJog{.key = {JogAxis::kX, true}, .fast = true});
  GoOnFor(3.0);
  Good(ReleaseJogs{});
  GoOnFor(1.0);
  Good(kPressHome);
  GoOnFor(1.0);
  EXPECT_NEAR(TipSpeed(), 30.0, 2.0);
  ToRest();
  ExpectAt({5.0, 7.0, 0.0});
}

// LIVE-2.05, LIVE-2.10: what stops it stops it on the way; nothing follows.
TEST_F(MillPanelTest, WhatStopsIt) {
  for (const MachineInput& stop : {MachineInput(StopRun{}), MachineInput(HoldRun{}),
                                   MachineInput(ReleaseJogs{}), MachineInput(MoveDoor{true})}) {
    LoadDescribed();
    PutAway();
    Good(kPressHome);
    GoOnFor(1.0);
    EXPECT_THAT(Refused(kPressView), HasSubstr("CELL-E9421"));
    EXPECT_THAT(Refused(PressJog{.key = {JogAxis::kX, true}}), HasSubstr("CELL-E9421"));
    EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("CELL-E9421"));
    const motion::MachinePoint at = machine->status().run.axes.column;
    const double speed = TipSpeed();
    EXPECT_GT(speed, 10.0);
    Good(stop);
    EXPECT_EQ(state(), MachineState::kStopping) << stop.index();
    ToRest();
    const double way = (machine->status().run.axes.column - at).norm();
    EXPECT_GT(way, speed * speed / (2.0 * 200.0) / 1.5) << stop.index();
    EXPECT_LT(way, speed * speed / (2.0 * 200.0) + 1e-6) << stop.index();
    const motion::MachinePoint rests = machine->status().run.axes.column;
    GoOnFor(5.0);
    ExpectAt(rests);
  }
}

// LIVE-3.11: nothing depends on how time is divided.
TEST_F(MillPanelTest, DividedTimeChangesNothing) {
  std::vector<motion::AxisPose> rests;
  for (const double part : {0.001, 0.07, 1.3}) {
    LoadDescribed();
    PutAway();
    const SimTime begun = machine->time();
    Good(kPressView);
    for (SimTime to = begun + At(part); to < begun + At(2.6); to += At(part)) GoOn(to);
    GoOn(begun + At(2.6));
    Good(StopRun{});
    GoOn(begun + At(9.1));
    rests.push_back(machine->status().run.axes);
  }
  EXPECT_EQ(rests[1], rests[0]);
  EXPECT_EQ(rests[2], rests[0]);
}

// LIVE-2.13, RML1-9.11: work coordinates count from where the tool stands; a run begins with them,
// a mark has them, and without power they are as delivered.
TEST_F(MillPanelTest, Z0AndOriginAreWhereTheToolStands) {
  LoadDescribed("PA;!MC0;PU0,0;");
  PutAway();
  Good(kPressZ0);
  Good(kPressOrigin);
  ExpectAt(kAway);
  const motion::MachinePoint zero = *machine->status().run.work_origin;
  EXPECT_NEAR((zero - kAway).norm(), 0.0, 1e-9);
  const std::string mark = machine->Save();
  LoadWith({{"PANEL", "FULL"}}, mark, "PA;!MC0;PU0,0;");
  EXPECT_NEAR((*machine->status().run.work_origin - kAway).norm(), 0.0, 1e-9);
  EXPECT_EQ(machine->Save(), mark);
  Good(kPressHome);
  ToRest();
  ExpectAt({30.0, 20.0, 0.0});
  Start();
  GoOnFor(10.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  ExpectAt(kAway);  // X 0, Y 0, and Z2 is 0 above Z0
  EXPECT_NEAR((*machine->status().run.work_origin - kAway).norm(), 0.0, 1e-9);
  Good(SwitchPower{false});
  Good(SwitchPower{true});
  EXPECT_NEAR((*machine->status().run.work_origin - motion::MachinePoint(0, 0, -20)).norm(), 0.0,
              1e-9);
}

// LIVE-2.04, LIVE-2.13: on a machine without a run nothing turns, and the key says what it is for;
// nor does it start what the program has not started.
TEST_F(MillPanelTest, SpindleIsForAHold) {
  LoadDescribed("PA;!MC0;PU1000,1000;!NR;PU0,0;");
  const std::string refused = Refused(kPressSpindle);
  EXPECT_THAT(refused, HasSubstr("CELL-E9421 the machine is IDLE: SPINDLE stops the spindle of a"));
  EXPECT_FALSE(Turns());
  Good(PressJog{.key = {JogAxis::kX, true}});
  EXPECT_THAT(Refused(kPressSpindle), HasSubstr("CELL-E9421"));
  Good(ReleaseJogs{});
  ToRest();
  Start();
  GoOnFor(20.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_THAT(Refused(kPressSpindle), HasSubstr("CELL-E9421 the program has not started"));
  EXPECT_FALSE(Turns());
}

// LIVE-8.03: with the cover open nothing is moved, and registers are set.
TEST_F(MillPanelTest, WithTheCoverOpen) {
  LoadDescribed();
  Good(MoveDoor{true});
  EXPECT_THAT(Refused(kPressView), HasSubstr("CELL-E9433"));
  EXPECT_THAT(Refused(kPressHome), HasSubstr("CELL-E9433"));
  Good(kPressZ0);
  Good(kPressOrigin);
}

// DEV-3.12, LIVE-2.10 a9: the cover of most mills lets a run come to rest; closing it moves
// nothing, and resuming goes on.
TEST_F(MillPanelTest, AnOpenCoverPauses) {
  LoadWith({}, {}, "PA;VS10;!MC1;PU1000,1000;PU2000,2000;");
  Good(StartRun{.program = 1});
  GoOnFor(3.0);
  ASSERT_EQ(state(), MachineState::kRunning);
  ASSERT_TRUE(Turns());
  Good(MoveDoor{true});
  EXPECT_TRUE(machine->status().run.door_open);
  ToRest();
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_FALSE(Turns());
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9433"));
  const motion::MachinePoint stands = machine->status().run.axes.column;
  Good(MoveDoor{false});
  GoOnFor(5.0);
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().run.axes.column, stands);
  Good(ResumeRun{});
  GoOnFor(1.0);
  EXPECT_TRUE(Turns());
  Good(HoldRun{});
  ToRest();
  EXPECT_TRUE(Turns());  // LIVE-2.04: in a hold it turns on
  Good(MoveDoor{true});
  EXPECT_FALSE(Turns());
  Good(MoveDoor{false});
  EXPECT_FALSE(Turns());
  Good(ResumeRun{});
  GoOnFor(100.0);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_NEAR(machine->status().run.axes.column.x(), 20.0, 1e-9);
  Good(MoveDoor{true});
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("CELL-E9433"));
  EXPECT_THAT(Refused(StartAtStep{.program = 1}), HasSubstr("CELL-E9433"));
}

// DEV-3.12: it is its opening that acts: a cover that is told to be closed, and was, stops nothing.
TEST_F(MillPanelTest, AClosedCoverThatClosesStopsNothing) {
  for (const char* cover : {"PAUSE", "EMERGENCY"}) {
    LoadWith({{"COVER", cover}}, {}, "PA;VS10;PU1000,1000;PU2000,2000;");
    Good(StartRun{.program = 1});
    GoOnFor(1.0);
    Good(MoveDoor{false});
    EXPECT_EQ(state(), MachineState::kRunning) << cover;
    GoOnFor(100.0);
    EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted) << cover;
  }
}

// DEV-3.12: one whose cover is none runs on.
TEST_F(MillPanelTest, ACoverThatIsNoneStopsNothing) {
  LoadWith({{"COVER", "NONE"}}, {}, "PA;VS10;PU1000,1000;PU2000,2000;");
  Good(MoveDoor{true});
  Good(StartRun{.program = 1});
  GoOnFor(1.0);
  Good(MoveDoor{false});
  Good(MoveDoor{true});
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kRunning);
}

// DEV-3.12: where it is an emergency stop the run is over; in a pause it is none.
TEST_F(MillPanelTest, ACoverThatIsAnEmergencyStop) {
  LoadWith({{"COVER", "EMERGENCY"}}, {}, "PA;VS10;PU1000,1000;PU2000,2000;");
  Good(StartRun{.program = 1});
  GoOnFor(1.0);
  Good(StopRun{});
  ToRest();
  Good(MoveDoor{true});
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9433"));
  Good(MoveDoor{false});
  Good(ResumeRun{});
  GoOnFor(0.5);
  Good(MoveDoor{true});
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kAlarm);
  ASSERT_EQ(machine->status().alarms.size(), 1U);
  Good(Acknowledge{.alarm = machine->status().alarms.front().id});
  EXPECT_EQ(state(), MachineState::kIdle);
}

// LIVE-2.04: whatever is pressed when, the spindle turns only in a state that moves axes, and in
// HELD; what stands has no speed.
TEST_F(MillPanelTest, WhatTurnsWhere) {
  std::mt19937 random(4);
  int turned_held = 0;
  for (int round = 0; round < 20; ++round) {
    LoadDescribed("PA;VS10;!MC1;PU500,500;PD;PD900,500;!NR;PD900,900;PU;");
    for (int n = 0; n < 100; ++n) {
      const auto any = [&](const MachineInput& input) { static_cast<void>(machine->Apply(input)); };
      switch (random() % 12) {
        case 0:
          any(StartRun{.program = 1});
          break;
        case 1:
          any(ResumeRun{.restore_process = random() % 2 == 0});
          break;
        case 2:
          any(StopRun{});
          break;
        case 3:
          any(HoldRun{});
          break;
        case 4:
          any(random() % 4 == 0 ? MachineInput(AbortRun{}) : MachineInput(ReleaseJogs{}));
          break;
        case 5:
          any(MoveDoor{.open = random() % 3 == 0});
          break;
        case 6:
          any(PressJog{.key = {JogAxis::kX, random() % 2 == 0}});
          break;
        case 7:
          any(SwitchPower{random() % 6 != 0});
          break;
        default:
          any(kEveryKey[random() % kEveryKey.size()]);
          break;
      }
      const bool still = !MovesAxes(state());
      ASSERT_TRUE(!still || state() == MachineState::kHeld || !Turns()) << Name(state());
      ASSERT_TRUE(!still || TipSpeed() == 0.0) << Name(state());
      turned_held += state() == MachineState::kHeld && Turns() ? 1 : 0;
      GoOnFor(static_cast<double>(random() % 4000) * 1e-3);
    }
  }
  EXPECT_GT(turned_held, 20);
}

// LIVE-2.10: a run that goes on refuses all keys; one that is held all but VIEW and SPINDLE.
TEST_F(MillPanelTest, KeysByState) {
  LoadDescribed();
  Start();
  GoOnFor(0.5);
  ASSERT_EQ(state(), MachineState::kRunning);
  for (const PressPanel& press : kEveryKey) EXPECT_THAT(Refused(press), HasSubstr("CELL-E9421"));
  GoOnFor(20.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  for (const PressPanel& press : {kPressZ0, kPressOrigin, kPressHome})
    EXPECT_THAT(Refused(press), HasSubstr("CELL-E9421 the machine is HELD"));
  Good(EmergencyStop{});
  for (const PressPanel& press : kEveryKey) EXPECT_THAT(Refused(press), HasSubstr("CELL-E9437"));
  Good(SwitchPower{false});
  for (const PressPanel& press : kEveryKey) EXPECT_THAT(Refused(press), HasSubstr("CELL-E9424"));
}

// LIVE-2.13, LIVE-5.06: VIEW in a hold; the run goes on only from where it was held, whoever asks.
TEST_F(MillPanelTest, ViewInAHold) {
  LoadDescribed();
  Start();
  GoOnFor(20.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  const motion::AxisPose held = machine->status().run.axes;
  Good(kPressView);
  EXPECT_EQ(state(), MachineState::kJogging);
  ToRest();
  EXPECT_EQ(state(), MachineState::kHeld);
  ExpectAt({0.0, 152.4, 0.0});
  EXPECT_TRUE(machine->status().open);
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9425 it was moved in X by -10.000 mm, Y by"));
  EXPECT_THAT(Refused(ResumeRun{.source = StartSource::kConsole, .accept_displaced = true}),
              HasSubstr("CELL-E9425"));
  Good(kPressView);
  ToRest();
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().run.axes, held);
  Good(ResumeRun{});
  GoOnFor(20.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_NEAR(machine->status().run.axes.column.x(), 20.0, 1e-9);
}

// LIVE-2.13: a run that ends there leaves the tool there.
TEST_F(MillPanelTest, AbortAtTheView) {
  LoadDescribed();
  Start();
  GoOnFor(20.0);
  Good(kPressView);
  ToRest();
  Good(AbortRun{});
  EXPECT_EQ(state(), MachineState::kIdle);
  ExpectAt({0.0, 152.4, 0.0});
}

constexpr const char* kCutWithAPause =
    "PA;VS10;!MC1;!PZ-200,0;PU1000,1000;PD;PD2000,1000;!NR;PD2000,2000;PU;!MC0;";

// LIVE-5.06, LF-7: a spindle that a person stopped in the hold stays off to the end; the verdict
// tells of what it cut standing.
TEST_F(MillPanelTest, ASpindleStoppedInTheHoldStaysOff) {
  LoadDescribed(kCutWithAPause);
  Start();
  GoOnFor(60.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  ASSERT_TRUE(Turns());
  Good(kPressSpindle);
  EXPECT_FALSE(Turns());
  Good(ResumeRun{});
  EXPECT_FALSE(Turns());
  while (machine->open_run() != nullptr) {
    EXPECT_FALSE(Turns());
    GoOnFor(0.05);
  }
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_FALSE(Turns());
  double cut_standing = 0.0;
  for (const Figure& figure : over.figures) {
    if (figure.name == "spindle_stands_length") cut_standing = figure.value;
  }
  EXPECT_NEAR(cut_standing, 10.0, 1e-6);
}

// DEV-3.12, LIVE-2.04: with the cover open its key stops the spindle, and starts none before it is
// closed, whether the cover stopped it or the key.
TEST_F(MillPanelTest, WithTheCoverOpenNoSpindleStarts) {
  for (const bool stops : {true, false}) {
    LoadWith({{"PANEL", "FULL"}, {"COVER", stops ? "PAUSE" : "NONE"}}, {}, kCutWithAPause);
    Start();
    GoOnFor(60.0);
    ASSERT_EQ(state(), MachineState::kHeld);
    ASSERT_TRUE(Turns());
    Good(MoveDoor{true});
    EXPECT_EQ(Turns(), !stops);
    if (!stops) Good(kPressSpindle);
    EXPECT_FALSE(Turns());
    EXPECT_THAT(Refused(kPressSpindle), HasSubstr("CELL-E9433 the cover is open"));
    EXPECT_FALSE(Turns());
    Good(MoveDoor{false});
    Good(kPressSpindle);
    EXPECT_TRUE(Turns());
  }
}

// LIVE-5.06: asked for at RESUME it turns again before anything moves; and so it does by its key.
TEST_F(MillPanelTest, ItTurnsAgainWhereThatIsAskedFor) {
  LoadDescribed(kCutWithAPause);
  Start();
  GoOnFor(60.0);
  Good(kPressSpindle);
  Good(kPressSpindle);
  EXPECT_TRUE(Turns());
  Good(kPressSpindle);
  const motion::AxisPose held = machine->status().run.axes;
  Good(ResumeRun{.restore_process = true});
  EXPECT_TRUE(Turns());
  GoOnFor(1.9);  // SPIN_UP is 2 s
  EXPECT_EQ(machine->status().run.axes, held);
  GoOnFor(1.0);
  EXPECT_GT(machine->status().run.axes.column.y(), held.column.y() + 1.0);
}

// LIVE-8.03: a tap is one step of the profile.
TEST_F(MillPanelTest, TheStepOfATapIsOfTheProfile) {
  LoadWith({{"JOG_STEP", "0.25"}});
  const double x = machine->status().run.axes.column.x();
  Good(PressJog{.key = {JogAxis::kX, true}});
  Good(ReleaseJog{{JogAxis::kX, true}});
  GoOnFor(1.0);
  EXPECT_NEAR(machine->status().run.axes.column.x(), x + 0.25, 1e-9);
}

// LIVE-2.13: VIEW goes back only where it came from: moved by a key or HOME meanwhile, the tool is
// taken away anew, and comes back to there.
TEST_F(MillPanelTest, ViewBeginsAnewWhereItWasMovedMeanwhile) {
  const motion::MachinePoint view(0.0, 152.4, 0.0);
  LoadDescribed();
  PutAway();
  Good(kPressView);
  ToRest();
  ExpectAt(view);
  Good(PressJog{.key = {JogAxis::kX, true}});
  GoOnFor(5.0);
  Good(ReleaseJogs{});
  GoOnFor(0.1);
  const motion::MachinePoint jogged = machine->status().run.axes.column;
  EXPECT_GT(jogged.x(), 4.0);
  Good(kPressView);
  ToRest();
  ExpectAt(view);
  Good(kPressView);
  ToRest();
  ExpectAt(jogged);
  Good(kPressView);
  ToRest();
  Good(kPressHome);
  ToRest();
  const motion::MachinePoint home = machine->status().run.axes.column;
  EXPECT_GT((home - view).norm(), 100.0);
  Good(kPressView);
  ToRest();
  ExpectAt(view);
  Good(kPressView);
  ToRest();
  ExpectAt(home);
}

// LIVE-2.13: nor is a place from before a run, or from a run that is over, one to go back to.
TEST_F(MillPanelTest, ViewBeginsAnewWithARunAndBehindIt) {
  const motion::MachinePoint view(0.0, 152.4, 0.0);
  const auto begin = [&](const MachineInput& start) {
    LoadDescribed();
    PutAway();
    Good(kPressView);
    ToRest();
    Good(start);
    GoOnFor(100.0);
    ASSERT_EQ(state(), MachineState::kHeld);
    EXPECT_NEAR(machine->status().run.axes.column.x(), 10.0, 1e-9);
    Good(kPressView);
    ToRest();
    ExpectAt(view);
  };
  begin(StartRun{.program = 1});
  Good(AbortRun{});
  Good(kPressView);
  ToRest();
  ExpectAt(view);
  begin(StartAtStep{.program = 1,
                    .target = {.at = {1, 3}},
                    .acknowledged = {"clamps", "table", "tool", "Z0", "origin"}});
}

// LIVE-6.01: a simulation knows nothing of a spindle that a person stopped, or that is started anew
// behind a hold: the run has no base any more.
TEST_F(MillPanelTest, ASpindleByHandLeavesNoBase) {
  const auto hold = [&] {
    LoadDescribed(kCutWithAPause);
    Start();
    GoOnFor(60.0);
    ASSERT_EQ(state(), MachineState::kHeld);
    EXPECT_TRUE(machine->base());
  };
  hold();
  Good(kPressSpindle);
  EXPECT_FALSE(machine->base());
  hold();
  Good(ResumeRun{.restore_process = true});
  EXPECT_FALSE(machine->base());
  hold();
  Good(ResumeRun{});
  EXPECT_TRUE(machine->base());
}

}  // namespace
}  // namespace rmlcell::machine
