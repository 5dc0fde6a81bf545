// The jog keys of a machine that stands: what they move, what stops them, and what refuses them.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <random>

#include "engine/machine/shape.h"
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

constexpr JogKey kXPlus{JogAxis::kX, true};
constexpr JogKey kYPlus{JogAxis::kY, true};
constexpr JogKey kYMinus{JogAxis::kY, false};
constexpr JogKey kZPlus{JogAxis::kZ, true};
constexpr JogKey kBPlus{JogAxis::kB, true};

class MachineJogTest : public MachineTest {
 protected:
  // In MANUAL, at home: column (21.02, 2201.2, -50), A and B 0; 200 mm/s.
  void LoadInManual(const std::vector<std::string>& programs = {"STOP\n"}) {
    Load(programs);
    Good(ChangeMode{Mode::kManual});
    Good(ChangeOverride{145.0});
  }
  motion::AxisPose Axes() const { return machine->status().run.axes; }
  double X() const { return Axes().column.x(); }
  double TipSpeed() const { return machine->status().run.tip_speed_mm_s; }
  void GoOnFor(double seconds) { GoOn(machine->time() + At(seconds)); }
};

// OPT-4.20, LIVE-2.03: motion while pressed; it jogs, comes to rest, and stands.
TEST_F(MachineJogTest, AKeyMovesAsLongAsItIsDown) {
  LoadInManual();
  EXPECT_EQ(state(), MachineState::kIdle);
  Good(PressJog{.key = kXPlus});
  EXPECT_EQ(state(), MachineState::kJogging);
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kJogging);
  EXPECT_NEAR(TipSpeed(), 200.0, 1e-9);
  EXPECT_NEAR(X(), 21.02 + 185.0, 1e-9);
  EXPECT_EQ(Axes().column.y(), 2201.2);
  Good(ReleaseJog{kXPlus});
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(0.149);
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(0.002);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(TipSpeed(), 0.0);
  EXPECT_NEAR(X(), 21.02 + 200.0, 1e-9);
  GoOnFor(5.0);
  EXPECT_NEAR(X(), 21.02 + 200.0, 1e-9);
  EXPECT_TRUE(machine->TakeRunsOver().empty());
}

// OPT-4.20: the C keys do nothing.
TEST_F(MachineJogTest, TheCKeysDoNothing) {
  LoadInManual();
  for (const bool plus : {true, false}) {
    Good(PressJog{.key = {JogAxis::kC, plus}});
    EXPECT_EQ(state(), MachineState::kIdle);
    GoOnFor(1.0);
    EXPECT_EQ(X(), 21.02);
    Good(ReleaseJog{{JogAxis::kC, plus}});
  }
}

// LIVE-7.03: pressed and released at once, nothing moves.
TEST_F(MachineJogTest, ATapMovesNothing) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  Good(ReleaseJog{kXPlus});
  EXPECT_EQ(state(), MachineState::kIdle);
  GoOnFor(1.0);
  EXPECT_EQ(X(), 21.02);
}

// OPT-4.34, OPT-4.35, OPT-4.36, LIVE-8.01: the ten steps, their stop, and the number for it. With
// the tip held the head runs on less far: the column goes round it with 300 mm.
TEST_F(MachineJogTest, TheTenSteps) {
  constexpr std::array kShares = {0.05, 0.3, 1.0, 3.0, 9.0, 15.0, 21.0, 27.0, 33.0, 40.0};
  constexpr std::array kInchPerMin = {0.59,   3.54,   11.81,  35.43,  106.30,
                                      177.17, 248.03, 318.90, 389.76, 472.44};
  LoadInManual();
  for (std::size_t step = 0; step < kShares.size(); ++step) {
    Good(ChangeOverride{10.0 + 15.0 * static_cast<double>(step)});
    Good(PressJog{.key = kXPlus});
    GoOnFor(1.0);
    const double v = kShares[step] / 100.0 * 500.0;
    EXPECT_NEAR(TipSpeed(), v, 1e-9);
    EXPECT_NEAR(TipSpeed() * 60.0 / 25.4, kInchPerMin[step], 0.006);
    const double before = X();
    Good(ReleaseJog{kXPlus});
    GoOnFor(1.0);
    const double way = v >= 100.0 ? v / 2.0 * (v / 2000.0 + 0.05) : v * std::sqrt(v / 40000.0);
    EXPECT_NEAR(X() - before, way, 1e-8);
    EXPECT_NEAR(machine->run_on()->mm, way, 1e-12);
    const double w = kShares[step] / 100.0 * kTurn;
    EXPECT_NEAR(machine->run_on()->rad,
                w >= 1.0 ? w / 2.0 * (w / 20.0 + 0.05) : w * std::sqrt(w / 400.0), 1e-12);
    EXPECT_LT(machine->run_on(JogReference::kAbsolute)->rad, machine->run_on()->rad);
    EXPECT_NEAR(machine->run_on(JogReference::kAbsolute)->mm, way, 1e-12);
  }
}

// LIVE-8.01: with the tip held no linear axis runs on farther than the session says, nor longer
// than by its own key: 15 mm and 0.15 s at 40 %, with the dead-man's 0.2 s 55 mm. All ten steps,
// the keys A, B, and both with Y.
TEST_F(MachineJogTest, TheHeldTipStopsAsSoonAsAnAxis) {
  const std::vector<std::vector<JogAxis>> keys = {
      {JogAxis::kA}, {JogAxis::kB}, {JogAxis::kA, JogAxis::kB, JogAxis::kY}};
  for (int step = 0; step < 10; ++step) {
    for (const std::vector<JogAxis>& pressed : keys) {
      LoadInManual();
      Good(PressJog{.key = kBPlus});
      GoOnFor(0.4);
      Good(ReleaseJogs{});
      GoOnFor(1.0);
      Good(ChangeOverride{10.0 + 15.0 * step});
      const double most = machine->run_on(JogReference::kAbsolute)->mm;
      for (const JogAxis axis : pressed)
        Good(PressJog{.key = {axis, false}, .reference = JogReference::kAbsolute});
      GoOnFor(0.6);
      const motion::MachinePoint silent = Axes().column;
      GoOnFor(0.2);
      const motion::MachinePoint before = Axes().column;
      EXPECT_GT((before - silent).norm(), 0.01);
      Good(ReleaseJogs{});
      GoOnFor(step == 9 ? 0.1501 : 0.3);
      EXPECT_EQ(state(), MachineState::kIdle) << step;
      EXPECT_LE((Axes().column - before).lpNorm<Eigen::Infinity>(), most + 1e-9) << step;
      EXPECT_LE(most, 15.0 + 1e-9);
      EXPECT_LE((Axes().column - silent).lpNorm<Eigen::Infinity>(), 55.0);
    }
  }
}

// LIVE-8.01: 0.15 s of a turn that brakes with half of 2000 mm/s2, and 40000 mm/s3, round 300 mm
// are 125 mm/s; of A, too, over a tip that the column stands straight above. The override lowers it
// to its step, and no farther.
TEST_F(MachineJogTest, AHeldTipSlowsNoMoreThanItMust) {
  LoadInManual();
  Good(PressJog{.key = {JogAxis::kA, true}, .reference = JogReference::kAbsolute});
  GoOnFor(0.5);
  const double before = Axes().a_rad;
  GoOnFor(0.1);
  EXPECT_NEAR(Axes().a_rad - before, 12.5 / 300.0, 1e-9);
  LoadInManual();
  Good(PressJog{.key = kBPlus, .reference = JogReference::kAbsolute});
  GoOnFor(0.5);
  Good(ChangeOverride{40.0});  // 1 %: 5 mm/s round 300 mm
  GoOnFor(0.5);
  const double slow = Axes().b_rad;
  GoOnFor(1.0);
  EXPECT_NEAR(Axes().b_rad - slow, 5.0 / 300.0, 1e-4);
}

// LIVE-8.01: keys add, and the sum is limited per axis: aslant along the tool, too.
TEST_F(MachineJogTest, KeysAlongTheToolAddUpToTheStep) {
  LoadInManual();
  Good(PressJog{.key = kBPlus});
  GoOnFor(0.4);
  Good(ReleaseJogs{});
  GoOnFor(1.0);
  for (const JogAxis axis : {JogAxis::kY, JogAxis::kZ})
    Good(PressJog{.key = {axis, false}, .reference = JogReference::kTool});
  GoOnFor(0.6);
  const motion::MachinePoint from = Axes().column;
  GoOnFor(0.1);
  EXPECT_NEAR((Axes().column - from).lpNorm<Eigen::Infinity>(), 20.0, 1e-6);
  const motion::MachinePoint before = Axes().column;
  Good(ReleaseJogs{});
  GoOnFor(0.2);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_LE((Axes().column - before).lpNorm<Eigen::Infinity>(), 15.0 + 1e-9);
}

// OPT-4.35, OPT-4.40: 100 % is step 7; what lies between two steps is the lower one.
TEST_F(MachineJogTest, TheOverrideIsTheStep) {
  Load({"STOP\n"});
  Good(ChangeMode{Mode::kManual});
  Good(PressJog{.key = kXPlus});
  GoOnFor(1.0);
  EXPECT_NEAR(TipSpeed(), 105.0, 1e-9);
  Good(ChangeOverride{54.9});
  GoOnFor(1.0);
  EXPECT_NEAR(TipSpeed(), 5.0, 1e-9);
}

// LIVE-8.01, OPT-4.37: another override acts at once: 200 to 135 mm/s in 65/2000 + 0.05 s.
TEST_F(MachineJogTest, AnotherOverrideActsAtOnce) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  GoOnFor(1.0);
  Good(ChangeOverride{115.0});
  GoOnFor(0.001);
  EXPECT_LT(TipSpeed(), 200.0);
  GoOnFor(2.0 * std::sqrt(65.0 / 40000.0) - 0.0009);
  EXPECT_NEAR(TipSpeed(), 135.0, 1e-9);
}

// LIVE-8.01: keys add; X+ and X- together stand.
TEST_F(MachineJogTest, KeysAdd) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  Good(PressJog{.key = kYMinus});
  GoOnFor(1.0);
  EXPECT_NEAR(TipSpeed(), 200.0 * std::sqrt(2.0), 1e-9);
  Good(ReleaseJog{kYMinus});
  EXPECT_EQ(state(), MachineState::kJogging);
  GoOnFor(0.2);
  EXPECT_NEAR(TipSpeed(), 200.0, 1e-9);
  Good(PressJog{.key = {JogAxis::kX, false}});
  GoOnFor(0.2);
  EXPECT_EQ(TipSpeed(), 0.0);
  EXPECT_EQ(state(), MachineState::kJogging);
  Good(ReleaseJog{kXPlus});
  GoOnFor(0.2);
  EXPECT_NEAR(TipSpeed(), 200.0, 1e-9);
  Good(ReleaseJog{{JogAxis::kX, false}});
  GoOnFor(0.2);
  EXPECT_EQ(state(), MachineState::kIdle);
}

// OPT-4.52, OPT-4.53, OPT-4.54: B+ with each reference.
TEST_F(MachineJogTest, TheReferenceSaysWhatMoves) {
  for (const auto reference :
       {JogReference::kRobot, JogReference::kAbsolute, JogReference::kTool}) {
    LoadInManual();
    const motion::AxisPose at = Axes();
    const motion::MachinePoint tip = machine->status().run.tip.tip;
    Good(PressJog{.key = kBPlus, .reference = reference});
    GoOnFor(0.4);
    const bool held = reference == JogReference::kAbsolute;
    EXPECT_GT(Axes().b_rad, 0.1);
    EXPECT_EQ(held, (Axes().column - at.column).norm() > 1.0);
    EXPECT_EQ(held, (machine->status().run.tip.tip - tip).norm() < 1e-9);
    Good(ReleaseJog{kBPlus});
    GoOnFor(1.0);
    EXPECT_EQ(state(), MachineState::kIdle);
  }
}

// OPT-4.54: at home the axes of the tool are those of the machine; turned they turn with it.
TEST_F(MachineJogTest, AlongTheTool) {
  LoadInManual();
  Good(PressJog{.key = kZPlus, .reference = JogReference::kTool});
  GoOnFor(1.0);
  EXPECT_NEAR(Axes().column.z(), -50.0 + 185.0, 1e-9);
  Good(ReleaseJogs{});
  GoOnFor(1.0);
  Good(PressJog{.key = {JogAxis::kB, true}});
  GoOnFor(0.6);
  Good(ReleaseJogs{});
  GoOnFor(1.0);
  const motion::AxisPose turned = Axes();
  Good(PressJog{.key = kZPlus, .reference = JogReference::kTool});
  GoOnFor(1.0);
  const motion::MachineVector moved = Axes().column - turned.column;
  EXPECT_LT((moved / 185.0 - motion::ToolDirection(turned.a_rad, turned.b_rad)).norm(), 1e-9);
}

// OPT-4.55, OPT-4.71: with Z0 below Z1 tool Z and Y are reversed, and X is not; with equal points
// nothing is.
TEST_F(MachineJogTest, AToolThatPointsTheOtherWay) {
  const auto moved = [&](const char* tcp, JogAxis axis) {
    Load({tcp});
    Start();
    GoOnFor(1.0);
    Good(ChangeMode{Mode::kManual});
    const motion::AxisPose at = Axes();
    Good(PressJog{.key = {axis, true}, .reference = JogReference::kTool});
    GoOnFor(1.0);
    const motion::MachineVector way = Axes().column - at.column;
    return way[static_cast<int>(axis)];
  };
  constexpr const char* kReversed = "TCP (0.,0.,0./0.,0.,5.)\n";
  EXPECT_LT(moved(kReversed, JogAxis::kZ), -50.0);
  EXPECT_LT(moved(kReversed, JogAxis::kY), -50.0);
  EXPECT_GT(moved(kReversed, JogAxis::kX), 50.0);
  EXPECT_GT(moved("TCP (0.,0.,3./0.,0.,-6.)\n", JogAxis::kZ), 50.0);
  EXPECT_GT(moved("TCP (0.,0.,0./0.,0.,0.)\n", JogAxis::kZ), 50.0);
  for (const JogAxis axis : {JogAxis::kX, JogAxis::kY, JogAxis::kZ})  // OPT-B.90
    EXPECT_GT(moved("TCP (0.,0.,3./0.,1.,3.)\n", axis), 50.0);
}

// OPT-4.56, LIVE-8.02: it stands on the end of the travel; the key is still down, and it jogs.
TEST_F(MachineJogTest, ItStandsOnTheEndOfTheTravel) {
  LoadInManual();
  Good(PressJog{.key = {JogAxis::kX, false}});
  Good(PressJog{.key = kZPlus});
  GoOnFor(3.4);  // 621 mm
  EXPECT_NEAR(X(), -600.0, 1e-9);
  EXPECT_NEAR(TipSpeed(), 200.0, 1e-9);
  GoOnFor(10.0);
  EXPECT_NEAR(Axes().column.z(), 1100.0, 1e-9);
  EXPECT_EQ(TipSpeed(), 0.0);
  EXPECT_EQ(state(), MachineState::kJogging);
  Good(ReleaseJog{{JogAxis::kX, false}});
  Good(ReleaseJog{kZPlus});
  EXPECT_EQ(state(), MachineState::kIdle);
}

// LIVE-2.10, x7: not in another mode, not off, not in alarm, not while a run is open, not while it
// comes to rest.
TEST_F(MachineJogTest, WhatRefusesAKey) {
  const PressJog press{.key = kXPlus};
  Load({"MOVE (500.,500.,0.,0.,0.)\n"});
  for (const Mode mode : {Mode::kRemote, Mode::kCycle, Mode::kSingle, Mode::kRepeat}) {
    Good(ChangeMode{mode});
    EXPECT_THAT(Refused(press), HasSubstr("CELL-E9423 the mode is"));
  }
  Good(ChangeMode{Mode::kRemote});
  Start();
  GoOnFor(0.2);
  EXPECT_THAT(Refused(press), HasSubstr("CELL-E9423"));
  Good(ChangeMode{Mode::kManual});  // a HOLD
  EXPECT_THAT(Refused(press), HasSubstr("CELL-E9421 the machine is STOPPING"));
  Good(AbortRun{});
  GoOnFor(20.0);
  ASSERT_EQ(state(), MachineState::kIdle);
  Good(press);
  GoOnFor(0.5);
  Good(ReleaseJog{kXPlus});
  EXPECT_THAT(Refused(PressJog{.key = kYPlus}), HasSubstr("CELL-E9421 the machine is STOPPING"));
  GoOnFor(1.0);
  Good(EmergencyStop{});
  EXPECT_THAT(Refused(press), HasSubstr("OPT-E7610"));
  Good(SwitchPower{false});
  EXPECT_THAT(Refused(press), HasSubstr("CELL-E9424"));
}

// LIVE-7.06, LIVE-2.10: what stops the jog; the key must be released before it moves again, another
// one moves at once.
TEST_F(MachineJogTest, WhatStopsIt) {
  for (const MachineInput& stop :
       {MachineInput(StopRun{}), MachineInput(HoldRun{}), MachineInput(AbortRun{}),
        MachineInput(MoveDoor{.open = true})}) {
    LoadInManual();
    Good(PressJog{.key = kXPlus});
    GoOnFor(1.0);
    Good(stop);
    EXPECT_EQ(state(), MachineState::kStopping) << stop.index();
    GoOnFor(0.16);
    EXPECT_EQ(state(), MachineState::kIdle) << stop.index();
    EXPECT_NEAR(X(), 21.02 + 200.0, 1e-9);
    EXPECT_THAT(Refused(PressJog{.key = kXPlus}), HasSubstr("CELL-E9421"));
    Good(PressJog{.key = kYMinus});
    GoOnFor(1.0);
    EXPECT_NEAR(X(), 21.02 + 200.0, 1e-9);
    Good(ReleaseJog{kXPlus});
    Good(PressJog{.key = kXPlus});
    GoOnFor(1.0);
    EXPECT_GT(X(), 21.02 + 300.0);
  }
}

// LIVE-2.10: STOP while it already comes to rest changes nothing.
TEST_F(MachineJogTest, ASecondStopChangesNothing) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  GoOnFor(1.0);
  Good(ReleaseJog{kXPlus});
  GoOnFor(0.05);
  Good(StopRun{});
  Good(ReleaseJogs{});
  GoOnFor(0.2);
  EXPECT_NEAR(X(), 21.02 + 200.0, 1e-9);
}

// LIVE-7.05: whoever holds the keys is not heard any more: as if each were released.
TEST_F(MachineJogTest, AllAreReleased) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  Good(PressJog{.key = kYMinus});
  GoOnFor(1.0);
  Good(ReleaseJogs{});
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(0.2);
  EXPECT_EQ(state(), MachineState::kIdle);
  Good(PressJog{.key = kXPlus});
  EXPECT_EQ(state(), MachineState::kJogging);
}

// motion.md 6: at an emergency stop it stands where it is. LIVE-7.06: and so do the keys.
TEST_F(MachineJogTest, AnEmergencyStopFreezesIt) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  GoOnFor(1.0);
  Good(EmergencyStop{});
  EXPECT_EQ(state(), MachineState::kAlarm);
  EXPECT_EQ(TipSpeed(), 0.0);
  GoOnFor(1.0);
  EXPECT_NEAR(X(), 21.02 + 185.0, 1e-9);
  Good(EmergencyStop{.pressed = false});
  Good(Acknowledge{machine->status().alarms.front().id});
  EXPECT_EQ(state(), MachineState::kIdle);
  GoOnFor(1.0);
  EXPECT_NEAR(X(), 21.02 + 185.0, 1e-9);
  EXPECT_THAT(Refused(PressJog{.key = kXPlus}), HasSubstr("release it"));
}

// LIVE-2.10: power off, in the middle of it.
TEST_F(MachineJogTest, PowerOffEndsIt) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  GoOnFor(1.0);
  Good(SwitchPower{false});
  EXPECT_EQ(state(), MachineState::kOff);
  GoOnFor(1.0);
  Good(SwitchPower{true});
  EXPECT_EQ(state(), MachineState::kNotZeroed);
  EXPECT_NEAR(X(), 21.02 + 185.0, 1e-9);
}

// LIVE-2.10, LIVE-8.05: the mode stays while it jogs; once it comes to rest it may change.
TEST_F(MachineJogTest, TheModeStaysWhileItJogs) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  GoOnFor(1.0);
  EXPECT_THAT(Refused(ChangeMode{Mode::kRemote}), HasSubstr("CELL-E9421"));
  GoOnFor(0.1);
  EXPECT_NEAR(TipSpeed(), 200.0, 1e-9);
  Good(StopRun{});
  Good(ChangeMode{Mode::kRemote});
  GoOnFor(0.2);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_NEAR(X(), 21.02 + 220.0, 1e-9);
}

// LIVE-8.05, LIVE-7.06: another reference with a key down stops it first; both keys are to be
// released.
TEST_F(MachineJogTest, AnotherReferenceStopsIt) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  GoOnFor(1.0);
  Good(PressJog{.key = kBPlus, .reference = JogReference::kAbsolute});
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_NEAR(X(), 21.02 + 200.0, 1e-9);
  EXPECT_EQ(Axes().b_rad, 0.0);
  EXPECT_THAT(Refused(PressJog{.key = kBPlus, .reference = JogReference::kAbsolute}),
              HasSubstr("release it"));
  Good(ReleaseJog{kXPlus});
  Good(ReleaseJog{kBPlus});
  Good(PressJog{.key = kBPlus, .reference = JogReference::kAbsolute});
  GoOnFor(0.5);
  EXPECT_GT(Axes().b_rad, 0.1);
}

// OPT-4.48, LIVE-8.02: before the axes are zeroed jogging moves them, up to the ends.
TEST_F(MachineJogTest, WithoutReference) {
  LoadInManual();
  Good(SwitchPower{false});
  Good(SwitchPower{true});
  ASSERT_EQ(state(), MachineState::kNotZeroed);
  Good(PressJog{.key = {JogAxis::kX, false}});
  EXPECT_EQ(state(), MachineState::kJogging);
  GoOnFor(5.0);
  EXPECT_NEAR(X(), -600.0, 1e-9);
  Good(ReleaseJog{{JogAxis::kX, false}});
  EXPECT_EQ(state(), MachineState::kNotZeroed);
}

// LIVE-2.10: while it jogs nothing else begins.
TEST_F(MachineJogTest, NothingBeginsMeanwhile) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  GoOnFor(0.1);
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("CELL-E9421 the machine is JOGGING"));
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9421"));
  EXPECT_THAT(Refused(ResumeRun{}), HasSubstr("CELL-E9421"));
  Good(ReleaseJog{kXPlus});
  EXPECT_THAT(Refused(StartRun{.program = 1}), HasSubstr("CELL-E9421 the machine is STOPPING"));
  EXPECT_THAT(Refused(ZeroAxes{}), HasSubstr("CELL-E9421"));
}

// Where it was moved to a run begins.
TEST_F(MachineJogTest, ARunBeginsWhereItStands) {
  LoadInManual({"MOVE (500.,500.,0.,0.,0.)\n"});
  Good(PressJog{.key = kXPlus});
  GoOnFor(1.0);
  Good(ReleaseJog{kXPlus});
  GoOnFor(1.0);
  Good(ChangeMode{Mode::kRemote});
  Start();
  EXPECT_NEAR(X(), 21.02 + 200.0, 1e-9);
}

// How the caller divides time changes nothing: LIVE-10.08 rests on it.
TEST_F(MachineJogTest, TheDivisionOfTimeChangesNothing) {
  std::vector<std::string> saved;
  for (const int parts : {1, 7, 100}) {
    LoadInManual();
    const auto go_on = [&](double seconds) {
      const SimTime from = machine->time();
      for (int n = 1; n <= parts; ++n) GoOn(from + At(seconds) * n / parts);
    };
    for (const auto reference :
         {JogReference::kTool, JogReference::kAbsolute, JogReference::kRobot}) {
      Good(PressJog{.key = {JogAxis::kY, false}, .reference = reference});
      go_on(0.21);
      Good(PressJog{.key = kBPlus, .reference = reference});
      go_on(0.333);
      Good(ChangeOverride{70.0});
      go_on(0.05);
      Good(ReleaseJog{{JogAxis::kY, false}});
      go_on(0.4);
      Good(ReleaseJogs{});
      go_on(0.5);
      EXPECT_EQ(state(), MachineState::kIdle);
      Good(ChangeOverride{145.0});
    }
    saved.push_back(machine->Save());
  }
  EXPECT_EQ(saved[0], saved[1]);
  EXPECT_EQ(saved[0], saved[2]);
}

// LIVE-3.15 ff.: a mark taken while it moves: it stands where it was at that instant.
TEST_F(MachineJogTest, WhatIsSavedInTheMiddleStands) {
  LoadInManual();
  Good(PressJog{.key = kXPlus});
  GoOnFor(0.7);
  const std::string mark = machine->Save();
  Load({"STOP\n"}, mark);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_NEAR(X(), 21.02 + 125.0, 1e-9);
  EXPECT_EQ(TipSpeed(), 0.0);
  GoOnFor(1.0);
  EXPECT_NEAR(X(), 21.02 + 125.0, 1e-9);
  EXPECT_EQ(machine->status().mode, Mode::kManual);
}

// LIVE-8.02, LIVE-2.04, LIVE-7.06: 10,000 random inputs. No axis is ever out, none moves in a state
// in which none may, and none by a key that is not down.
TEST_F(MachineJogTest, RandomKeysStayInside) {
  std::mt19937 random(8);
  LoadInManual();
  const motion::AxisLimits limits = family_.Shape(parameters()).limits->axes;
  const auto key = [&] { return JogKey{static_cast<JogAxis>(random() % 6), random() % 2 == 0}; };
  for (int n = 0; n < 10'000; ++n) {
    const auto apply = [&](const MachineInput& input) { static_cast<void>(machine->Apply(input)); };
    const auto which = random() % 40;
    if (which < 16) {
      apply(PressJog{.key = key(), .reference = static_cast<JogReference>(n / 50 % 3)});
    } else if (which < 28) {
      apply(ReleaseJog{key()});
    } else if (which < 31) {
      apply(ReleaseJogs{});
    } else if (which == 31) {
      apply(MoveDoor{.open = random() % 2 == 0});
    } else if (which == 32) {
      apply(StopRun{});
    } else if (which == 33) {
      apply(EmergencyStop{});
      apply(EmergencyStop{.pressed = false});
      for (const Alarm& alarm : machine->status().alarms) apply(Acknowledge{alarm.id});
    } else if (which == 34) {
      apply(SwitchPower{random() % 8 != 0});
    } else if (which == 35) {
      apply(ChangeMode{random() % 8 == 0 ? Mode::kRemote : Mode::kManual});
    } else {
      apply(ChangeOverride{10.0 + 15.0 * static_cast<double>(random() % 10)});
    }
    const MachineState before = state();
    const motion::AxisPose at = Axes();
    GoOnFor(static_cast<double>(random() % 1000) * 1e-3);
    ASSERT_LE(motion::WorstExcess(Axes(), limits).excess, 0.0) << n;
    const auto moves = [](MachineState one) {
      return one == MachineState::kJogging || one == MachineState::kStopping;
    };
    ASSERT_TRUE(moves(before) || Axes() == at) << n << " " << Name(before);
    ASSERT_TRUE(moves(state()) || TipSpeed() == 0.0) << n;
  }
}

// LIVE-7.02: what a key asked for is not over until the axis stands.
TEST_F(MachineJogTest, ItSettlesWhenTheKeyIsUp) {
  LoadInManual();
  EXPECT_FALSE(machine->settles());
  Good(PressJog{.key = kXPlus});
  GoOnFor(1.0);
  EXPECT_FALSE(machine->settles());
  Good(ReleaseJog{kXPlus});
  EXPECT_TRUE(machine->settles());
  GoOnFor(0.2);
  EXPECT_FALSE(machine->settles());
}

}  // namespace
}  // namespace rmlcell::machine
