// HOME and ZERO of a machine whose run is held: the run stays open, whatever stops them, and goes
// on from where the machine stands.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/engine/machine/held_bed.h"

namespace rmlcell::machine {
namespace {

using testing::Contains;
using testing::HasSubstr;

class HeldHomeTest : public HeldTest {
 protected:
  // What the control says to a key: 0, nothing.
  int Key(std::string_view key, KeyAction action = KeyAction::kTap) {
    const Result<KeyAnswer> answer = machine->PressKey(key, action);
    EXPECT_TRUE(answer) << key;
    return answer && answer->message ? Lookup(*answer->message).number : 0;
  }
  int PressHome() { return Key("HOME", KeyAction::kPress); }
  void ReleaseHome() { EXPECT_EQ(Key("HOME", KeyAction::kRelease), 0); }
  void PressZero() {
    EXPECT_EQ(Key("ZERO"), 0);
    EXPECT_EQ(Key("1"), 0);
  }
  double TipSpeed() const { return machine->status().run.tip_speed_mm_s; }
  // The run is the one that was held, it is open and nothing of it is over.
  void ExpectOpen() {
    ASSERT_TRUE(machine->status().open);
    EXPECT_EQ(machine->status().open->number, 1);
    EXPECT_FALSE(machine->status().open->by_hand);
    EXPECT_EQ(machine->status().last_run, 1);
    EXPECT_TRUE(machine->TakeRunsOver().empty());
  }
  // A run that may begin before the axes have their reference, halted before its MOVE.
  void LoadWithoutReference() {
    Load({"DELAY 5\nCOORD ROBOT\nMOVE (100.,200.,-30.,0.,0.)\n"});
    Good(SwitchPower{false});
    Good(SwitchPower{true});
    Good(StartRun{.program = 1, .unzeroed = true});
    GoOnFor(1.0);
    Good(StopRun{});
    GoOnFor(1.0);
    Good(ChangeMode{Mode::kManual});
    ASSERT_EQ(state(), MachineState::kHeld);
    ASSERT_FALSE(machine->status().run.zeroed);
  }
};

// LIVE-2.10, OPT-4.15: HELD + HOME is JOGGING while it is down, then STOPPING, and HELD again; the
// run stays open where it is.
TEST_F(HeldHomeTest, HomeMovesWhileItIsDown) {
  LoadHeld(kCorner, 5.0);
  const motion::AxisPose held = Axes();
  const Place at = machine->status().run.place;
  EXPECT_EQ(PressHome(), 0);
  EXPECT_EQ(state(), MachineState::kJogging);
  EXPECT_EQ(machine->status().by_hand, HandRun::kHome);
  GoOnFor(0.7);
  EXPECT_NEAR(TipSpeed(), 200.0, 1e-6);  // OPT-4.35: 40 % of 500 mm/s
  EXPECT_EQ(machine->status().run.place, at);
  ExpectOpen();
  const double x = Axes().column.x();
  EXPECT_LT(x, held.column.x() - 50.0);
  ReleaseHome();
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().by_hand, std::nullopt);
  EXPECT_LT(Axes().column.x(), x - 1.0);
  EXPECT_GT(Axes().column.x(), x - 50.0);
  EXPECT_EQ(TipSpeed(), 0.0);
  const motion::AxisPose rests = Axes();
  GoOnFor(5.0);
  EXPECT_EQ(Axes(), rests);
  EXPECT_EQ(machine->status().run.place, at);
  ExpectOpen();
  EXPECT_EQ(Key("HOME"), 0);  // LIVE-7.03: a TAP leaves no motion
  EXPECT_EQ(state(), MachineState::kHeld);
}

// LIVE-5.06, OPT-6.42: at home RESUME asks with the displacement, and the MOVE goes from there to
// its old end.
TEST_F(HeldHomeTest, FromHomeTheRunGoesOn) {
  LoadHeld(kCorner, 5.0);
  const double x = Axes().column.x();
  EXPECT_EQ(PressHome(), 0);
  GoOnFor(30.0);
  EXPECT_EQ(state(), MachineState::kHeld);
  ReleaseHome();
  EXPECT_NEAR(Axes().column.x(), 21.02, 1e-6);
  EXPECT_NEAR(Axes().column.y(), 2201.2, 1e-3);  // HOME is a float in the text of the MOVE
  BackInRemote();
  const std::string asked = Refused(ResumeRun{});
  EXPECT_THAT(asked, HasSubstr("CELL-E9425 it was moved in X by -"));
  EXPECT_NEAR(std::stod(asked.substr(asked.find(" by ") + 4)), 21.02 - x, 2e-3);
  Good(ResumeRun{.accept_displaced = true});
  GoOnFor(2.0);
  EXPECT_EQ(machine->status().run.place.step, 4);
  EXPECT_NEAR(Tip().y(), 2201.2, 1e-3);
  EXPECT_NEAR(TipSpeed(), 50.0, 1e-6);
  GoOnFor(60.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_NEAR((Tip() - motion::MachinePoint(521.02, 2301.2, -350.0)).norm(), 0.0, 1e-3);
}

// OPT-4.49, OPT-4.16, OPT-4.51: Z, then A and B, then X and Y, with lamp and text, at no override;
// then the default text, and the machine is held.
TEST_F(HeldHomeTest, ZeroGoesGroupByGroup) {
  LoadHeld(kCorner, 5.0);
  Jog(kHeldBPlus, 1.0);
  const motion::AxisPose from = Axes();
  ASSERT_GT(from.b_rad, 0.1);
  PressZero();
  EXPECT_EQ(state(), MachineState::kJogging);
  EXPECT_EQ(machine->panel().display, "ZERO AXES           ");
  EXPECT_TRUE(machine->panel().flashing);
  EXPECT_THAT(machine->panel().lamps, Contains("ZERO AXES"));
  EXPECT_EQ(Key("OVERRIDE_MINUS"), 7601);
  EXPECT_EQ(Key("ERR"), 0);
  int group = 0;
  for (int n = 0; n < 20'000 && state() == MachineState::kJogging; ++n) {
    const motion::AxisPose at = Axes();
    const bool z = std::abs(at.column.z()) < 1e-9;
    const bool head = std::abs(at.b_rad) < 1e-9;
    if (z) group = std::max(group, 1);
    if (z && head) group = 2;
    if (group < 1) {
      EXPECT_EQ(at.b_rad, from.b_rad);
    }
    if (group < 2) {
      EXPECT_NEAR(at.column.y(), from.column.y(), 1e-9);
    }
    if (group > 0) {
      EXPECT_NEAR(at.column.z(), 0.0, 1e-9);
    }
    ExpectOpen();
    GoOnFor(0.01);
  }
  EXPECT_EQ(group, 2);
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_NEAR(Axes().column.norm(), 0.0, 1e-9);
  EXPECT_EQ(machine->panel().display, "P=01S=0004I=MOVE    ");
  EXPECT_FALSE(machine->panel().flashing);
  Good(ChangeMode{Mode::kRemote});
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9425"));
  Good(ResumeRun{.accept_displaced = true});
  GoOnFor(120.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
}

// OPT-4.49, OPT-4.15: as they move a machine on which no run is open, at every moment.
TEST_F(HeldHomeTest, AsWithoutARun) {
  for (const bool home : {true, false}) {
    std::vector<motion::AxisPose> poses[2];
    for (const bool held : {true, false}) {
      LoadHeld(kCorner, 5.0);
      Jog(kHeldZPlus, 0.2);
      Jog(kHeldBPlus, 1.0);
      if (!held) Good(AbortRun{});
      ASSERT_EQ(state(), held ? MachineState::kHeld : MachineState::kIdle);
      if (home) {
        EXPECT_EQ(PressHome(), 0);
      } else {
        Good(ZeroAxes{});
      }
      for (int n = 0; n < 120; ++n) {
        if (home && n == 3) {
          EXPECT_EQ(Key("OVERRIDE_MINUS"), 0);
        }
        if (home && n == 8) ReleaseHome();
        GoOnFor(0.1);
        poses[held ? 0 : 1].push_back(Axes());
      }
    }
    EXPECT_EQ(poses[0], poses[1]) << home;
    EXPECT_NE(poses[0].front(), poses[0].back());
  }
}

// OPT-4.48: with ZERO in the hold its MOVE has a reference, and without it has none; HOME needs one
// (OPT-4.74). A ZERO that was stopped found none.
TEST_F(HeldHomeTest, ZeroGivesTheRunItsReference) {
  for (const double for_s : {0.0, 1.0, 300.0}) {
    LoadWithoutReference();
    EXPECT_EQ(PressHome(), 7310);
    Good(ClearMessage{});
    if (for_s > 0.0) PressZero();
    GoOnFor(for_s);
    Good(StopRun{});
    GoOnFor(5.0);
    EXPECT_EQ(state(), MachineState::kHeld);
    EXPECT_EQ(machine->status().run.zeroed, for_s == 300.0);
    Good(ChangeMode{Mode::kRemote});
    Good(ResumeRun{.accept_displaced = true});
    GoOnFor(300.0);
    const Outcome outcome = Over().outcome;
    if (for_s == 300.0) {
      EXPECT_EQ(outcome.kind, OutcomeKind::kCompleted);
      EXPECT_NEAR(Axes().column.x(), 100.0, 1e-6);
      EXPECT_EQ(state(), MachineState::kIdle);
    } else {
      EXPECT_EQ(outcome.code, ErrorCode::kNotZeroed);
      EXPECT_EQ(state(), MachineState::kNotZeroed);
    }
  }
}

// OPT-4.48: what the run knew of its reference stays when it is over; one that stands there already
// has it as soon as it is asked.
TEST_F(HeldHomeTest, AtItsReferenceNothingMoves) {
  LoadWithoutReference();
  PressZero();
  GoOnFor(300.0);
  Good(AbortRun{});
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCancelled);
  EXPECT_EQ(state(), MachineState::kIdle);
  LoadWithoutReference();
  for (int n = 0; n < 2; ++n) {
    PressZero();
    GoOnFor(n == 0 ? 300.0 : 0.1);  // what rounding has left of the way
    EXPECT_EQ(state(), MachineState::kHeld);
    EXPECT_TRUE(machine->status().run.zeroed);
  }
}

// LIVE-2.10, LIVE-7.05, LIVE-7.06: what stops it stops it on the way; the machine is held, and
// nothing follows.
TEST_F(HeldHomeTest, WhatStopsIt) {
  using Stop = std::function<void()>;
  const Stop stops[] = {[this] { Good(StopRun{}); },
                        [this] { Good(HoldRun{}); },
                        [this] { Good(ReleaseJogs{}); },
                        [this] { Good(MoveDoor{.open = true}); },
                        [this] { EXPECT_EQ(Key("STOP"), 0); },
                        [this] { EXPECT_EQ(Key("HOLD"), 0); },
                        [this] { EXPECT_EQ(Key("JOG_ABS"), 0); }};
  for (const Stop& stop : stops) {
    for (const bool home : {true, false}) {
      const auto n = &stop - stops;
      LoadHeld(kCorner, 5.0);
      if (home) {
        EXPECT_EQ(PressHome(), 0);
      } else {
        PressZero();
      }
      GoOnFor(0.5);
      ASSERT_GT(TipSpeed(), 10.0);
      stop();
      EXPECT_EQ(state(), MachineState::kStopping) << n << home;
      EXPECT_THAT(Refused(ResumeRun{.source = StartSource::kPanel}), HasSubstr("CELL-E942"));
      GoOnFor(2.0);
      EXPECT_EQ(state(), MachineState::kHeld) << n << home;
      const motion::AxisPose rests = Axes();
      GoOnFor(20.0);
      EXPECT_EQ(Axes(), rests) << n << home;
      EXPECT_EQ(state(), MachineState::kHeld);
      ExpectOpen();
    }
  }
}

// LIVE-7.06: the mode does not change while it moves; the key that asks for it stops HOME.
TEST_F(HeldHomeTest, AModeKeyStopsHome) {
  LoadHeld(kCorner, 5.0);
  EXPECT_EQ(PressHome(), 0);
  GoOnFor(0.5);
  EXPECT_THAT(Refused(ChangeMode{Mode::kCycle}), HasSubstr("CELL-E9421"));
  EXPECT_EQ(Key("MODE_RIGHT"), 7601);
  EXPECT_EQ(state(), MachineState::kStopping);
  EXPECT_EQ(machine->status().mode, Mode::kManual);
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kHeld);
  PressZero();
  EXPECT_EQ(Key("MODE_RIGHT"), 7601);
  EXPECT_EQ(state(), MachineState::kJogging);
}

// LIVE-2.10 a7, a8, a1: ABORT ends the run, and it comes to rest; an emergency stop and the switch
// stop it where it is.
TEST_F(HeldHomeTest, WhatEndsTheRun) {
  LoadHeld(kCorner, 5.0);
  EXPECT_EQ(PressHome(), 0);
  GoOnFor(0.5);
  Good(AbortRun{});
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCancelled);
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_GT(Axes().column.x(), 100.0);
  ReleaseHome();
  for (const MachineInput& end :
       {MachineInput(EmergencyStop{}), MachineInput(SwitchPower{false})}) {
    LoadHeld(kCorner, 5.0);
    PressZero();
    GoOnFor(0.5);
    const motion::AxisPose at = Axes();
    Good(end);
    const bool off = std::holds_alternative<SwitchPower>(end);
    EXPECT_EQ(state(), off ? MachineState::kOff : MachineState::kAlarm);
    EXPECT_EQ(Over().outcome.kind, off ? OutcomeKind::kStopped : OutcomeKind::kFailed);
    GoOnFor(5.0);
    EXPECT_EQ(Axes(), at);
  }
}

// LIVE-2.10: the row of HOME and ZERO, as far as a run is open.
TEST_F(HeldHomeTest, WhereItIsRefused) {
  Load({kCorner});
  Start();
  GoOn(At(5.0));
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9423"));  // RUNNING, x7
  EXPECT_EQ(PressHome(), 7601);
  Good(StopRun{});
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9421"));  // STOPPING
  GoOnFor(10.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  // HELD, x7: in REMOTE program 4 would follow (OPT-4.50), and a machine has one run.
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9423 ZERO works in MANUAL"));
  EXPECT_EQ(PressHome(), 7601);
  Good(ChangeMode{Mode::kCycle});
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9423"));
  EXPECT_EQ(PressHome(), 7601);
  EXPECT_EQ(Key("ZERO"), 7601);
  Good(ChangeMode{Mode::kManual});
  EXPECT_EQ(PressHome(), 0);
  EXPECT_THAT(Refused(PressJog{.key = kHeldXPlus}), HasSubstr("CELL-E9421"));  // JOGGING
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9421"));
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("CELL-E9421"));
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9421"));
  EXPECT_THAT(Refused(StartAtStep{.program = 1, .target = {.at = {1, 5}}}),
              HasSubstr("CELL-E9421"));
  for (const char* key : {"X+", "ZERO", "REC", "JOB", "MOV", "START", "PREV"})
    EXPECT_EQ(Key(key), 7601) << key;
  EXPECT_EQ(state(), MachineState::kJogging);
  ExpectOpen();
}

// LIVE-6.05: on its way to a step nothing is moved by hand.
TEST_F(HeldHomeTest, OnTheWayToAStepNothingIsMoved) {
  Load({kCorner});
  Good(StartAtStep{.program = 1, .target = {.at = {1, 5}}, .acknowledged = {"clamps"}});
  GoOnFor(0.5);
  Good(StopRun{});
  GoOnFor(5.0);
  Good(ChangeMode{Mode::kManual});
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(PressHome(), 7601);
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9421"));
}

// LIVE-2.10: FUNCTION is no row of it: beside a run it stays refused. One that is held is a run as
// any other: HOME moves the machine, and START goes on with it.
TEST_F(HeldHomeTest, FunctionAndHome) {
  Load({kCorner, "COORD ROBOT\nSPEED 10\nMOVE (500.,2201.2,-50.,0.,0.)\nRETURN\n"});
  const auto function = [this] {
    for (const char* key : {"JOB", "1", "ENT", "F3", "0", "2", "ENT", "ENT"})
      EXPECT_EQ(Key(key), 0) << key;
    return Key("1");
  };
  HoldAt(5.0);
  EXPECT_EQ(function(), 7601);
  ExpectOpen();
  Good(AbortRun{});
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCancelled);
  EXPECT_EQ(function(), 0);
  GoOnFor(1.0);
  EXPECT_EQ(Key("STOP"), 0);
  GoOnFor(5.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().by_hand, HandRun::kFunction);
  EXPECT_EQ(PressHome(), 0);
  EXPECT_EQ(machine->status().by_hand, HandRun::kHome);
  EXPECT_EQ(Key("START"), 7601);
  GoOnFor(30.0);
  ReleaseHome();
  EXPECT_NEAR(Axes().column.x(), 21.02, 1e-6);
  EXPECT_EQ(machine->status().by_hand, HandRun::kFunction);
  EXPECT_EQ(Key("START"), 0);
  GoOnFor(60.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_NEAR(Axes().column.x(), 500.0, 1e-6);
}

// OPT-6.08, OPT-6.16: BREAK and SIMUL are of programs: neither halts HOME or makes it a dry run,
// nor is used up by it.
TEST_F(HeldHomeTest, BreakAndSimulAreOfPrograms) {
  Load({std::string("BREAK 99,2\n") + kCorner});
  HoldAt(5.0);
  Good(SetSimulation{ProgramStep{1, 2}});
  EXPECT_EQ(PressHome(), 0);
  GoOnFor(30.0);
  ReleaseHome();
  EXPECT_NEAR(Axes().column.x(), 21.02, 1e-6);
  EXPECT_EQ(machine->simulation_until(), (ProgramStep{1, 2}));
}

// LIVE-3.23, LIVE-3.30: a mark of the way has the axes where they are, and what else the run had;
// who begins with it stands there.
TEST_F(HeldHomeTest, AMarkOnTheWay) {
  LoadWithoutReference();
  Good(WriteVariable{"VR[5]", 7.0});
  PressZero();
  GoOnFor(0.5);
  const motion::AxisPose at = Axes();
  const std::string mark = machine->Save();
  GoOnFor(300.0);
  const std::string later = machine->Save();
  Load({kCorner}, mark);
  EXPECT_EQ(Axes(), at);
  EXPECT_EQ(Value("VR[5]"), "7.0");
  EXPECT_EQ(Value("VI[98]"), "1");
  EXPECT_EQ(state(), MachineState::kNotZeroed);
  GoOnFor(5.0);
  EXPECT_EQ(Axes(), at);
  Load({kCorner}, later);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_NEAR(Axes().column.norm(), 0.0, 1e-9);
}

// LIVE-7.05: HOME of a machine on which no run is open stops, too, when whoever holds the key is
// not heard any more.
TEST_F(HeldHomeTest, ReleasedKeysStopHomeWithoutARun) {
  LoadHeld(kCorner, 5.0);
  Good(AbortRun{});
  Over();
  ASSERT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(PressHome(), 0);
  GoOnFor(0.5);
  EXPECT_EQ(state(), MachineState::kJogging);
  Good(ReleaseJogs{});
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(2.0);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCancelled);
  EXPECT_GT(Axes().column.x(), 50.0);
}

// LIVE-5.03: in a FUNCTION of the handbox its program is in use, and nothing else is.
TEST_F(HeldHomeTest, TheProgramOfAFunctionIsInUse) {
  Load({kCorner, "COORD ROBOT\nSPEED 10\nMOVE (500.,2201.2,-50.,0.,0.)\nRETURN\n"});
  Good(ChangeMode{Mode::kManual});
  for (const char* key : {"JOB", "1", "ENT", "F3", "0", "2", "ENT", "ENT", "1"})
    EXPECT_EQ(Key(key), 0) << key;
  GoOnFor(1.0);
  ASSERT_EQ(machine->status().by_hand, HandRun::kFunction);
  EXPECT_THAT(machine->loaded_programs(), testing::ElementsAre(2));
}

}  // namespace
}  // namespace rmlcell::machine
