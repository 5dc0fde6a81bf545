// What stands as soon as a key of the machine was pressed, and what a start at a step owes to a dry
// run before it.
#include <limits>

#include "engine/machine/hand_travel.h"
#include "tests/engine/machine/held_bed.h"
#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

class ByHandAnswers : public HeldTest {};

// LIVE-2.03, LIVE-2.10: HOME where it is at home already moves nothing: it is HELD, and not JOGGING
// for one moment.
TEST_F(ByHandAnswers, AtHomeTheHomeKeyMovesNothing) {
  LoadHeld("DELAY 50\nDELAY 50\n", 1.0);
  ASSERT_TRUE(machine->PressKey("HOME", KeyAction::kPress));
  GoOnFor(60.0);
  ASSERT_TRUE(machine->PressKey("HOME", KeyAction::kRelease));
  ASSERT_EQ(state(), MachineState::kHeld);
  const motion::AxisPose at = Axes();
  ASSERT_TRUE(machine->PressKey("HOME", KeyAction::kPress));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().by_hand, std::nullopt);
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Axes(), at);
  ASSERT_TRUE(machine->PressKey("HOME", KeyAction::kRelease));
  EXPECT_EQ(machine->status().open->number, 1);
}

// LIVE-6.01, OPT-6.14: a dry run whose step was not reached goes on in the next run of the whole
// program; who begins at a step is there behind real motions and dwells, which take their time.
TEST_F(ByHandAnswers, ADryRunBeforeItMakesNoDryStartAtAStep) {
  const char* program =
      "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (521.02, 2201.2, -380., 0., 0.)\n"
      "DELAY 10\nVI[1]=1\n";
  const StartAtStep input{
      .program = 1, .target = {.at = {1, 6}}, .acknowledged = {"clamps", "table", "tool"}};
  Load({program});
  const Result<StartPreview> first = machine->Preview(input);
  ASSERT_TRUE(first);
  EXPECT_GT(first->run_time, At(15.0));
  Good(SetSimulation{ProgramStep{1, 77}});
  Start();
  GoOn(At(60.0));
  ASSERT_EQ(Over().lasted, SimTime(0));
  ASSERT_EQ(machine->simulation_until(), (ProgramStep{1, 77}));
  const Result<StartPreview> behind = machine->Preview(input);
  ASSERT_TRUE(behind);
  EXPECT_EQ(behind->run_time, first->run_time);
}

// LIVE-7.03: a key that is down and told to be down once more is the same key: nothing changes, in
// the middle of its ramp neither.
TEST_F(ByHandAnswers, AKeyPressedTwiceIsOne) {
  const JogKey y_minus{JogAxis::kY, false};
  const auto after_a_second = [&](bool twice) {
    Load({"DELAY 1\n"});
    Good(ChangeMode{Mode::kManual});
    Good(ChangeOverride{145.0});
    Good(PressJog{.key = y_minus});
    GoOnFor(0.06);
    if (twice) Good(PressJog{.key = y_minus});
    GoOnFor(1.0);
    return Axes();
  };
  EXPECT_EQ(after_a_second(true), after_a_second(false));
}

// OPT-4.50: what follows a ZERO from the console follows that one alone, and no HOME behind it.
TEST_F(ByHandAnswers, NothingFollowsAHomeBehindAZero) {
  Load({"DELAY 1\n", "DELAY 1\n", "DELAY 1\n", "DELAY 2\n"});
  Good(SwitchPower{false});
  Good(SwitchPower{true});
  Good(ZeroAxes{});
  GoOnFor(600.0);
  const std::vector<RunOver> zero = machine->TakeRunsOver();
  ASSERT_EQ(zero.size(), 2U);
  EXPECT_EQ(zero[1].run.program, 4);
  Good(ChangeMode{Mode::kManual});
  ASSERT_TRUE(machine->PressKey("HOME", KeyAction::kPress));
  GoOnFor(60.0);
  ASSERT_TRUE(machine->PressKey("HOME", KeyAction::kRelease));
  GoOnFor(5.0);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(state(), MachineState::kIdle);
}

// LIVE-3.23, LIVE-9.06: alarms are counted on behind a mark: a number is never that of another one.
TEST_F(ByHandAnswers, AlarmsAreCountedOn) {
  Load({"DELAY 1\n"});
  for (std::int64_t id = 1; id <= 3; ++id) {
    Good(EmergencyStop{});
    ASSERT_EQ(machine->status().alarms.size(), 1U);
    EXPECT_EQ(machine->status().alarms[0].id, id);
    Good(EmergencyStop{.pressed = false});
    Good(Acknowledge{.alarm = id});
    Load({"DELAY 1\n"}, machine->Save());
  }
}

// Braked in the last nanoseconds of a leg it stands at its end, and not where it began.
TEST(ByHandTravel, BrakedAtTheVeryEndItIsThere) {
  HandMotion how;
  how.machine.head = motion::MillHead();
  how.machine.axes.speed.setConstant(20.0);
  how.machine.axes.acceleration.setConstant(100.0);
  how.machine.axes.jerk.setConstant(std::numeric_limits<double>::infinity());
  how.plus = how.minus = how.machine.axes.speed;
  for (const int left_ns : {1, 2, 3, 5, 8, 20, 1000}) {
    HandTravel travel({{{14.0, 0.0, 0.0}, 0.0, 0.0}}, how, {{0.0, 0.0, 0.0}, 0.0, 0.0}, At(0.0));
    travel.Advance(At(0.9) - SimTime(left_ns));
    travel.Brake();
    EXPECT_NEAR(travel.axes().column.x(), 14.0, 1e-9) << left_ns;
    travel.Advance(At(1.0));
    EXPECT_TRUE(travel.rests());
    EXPECT_NEAR(travel.axes().column.x(), 14.0, 1e-9) << left_ns;
  }
}

class ViewAnswers : public MachineTest {
 protected:
  ViewAnswers() : MachineTest("rml1") {
    Parameters made = *MakeParameters(family_, "srm-20", {{"PANEL", "FULL"}});
    machine = *Machine::Make(family_, std::move(made), {}, {}, heard);
  }
  void GoOnFor(double seconds) { GoOn(machine->time() + At(seconds)); }
  motion::MachinePoint Column() const { return machine->status().run.axes.column; }
};

// LIVE-2.13: VIEW, back, and VIEW once more: it goes away again, and back again.
TEST_F(ViewAnswers, ViewGoesAwayEachSecondTime) {
  for (const JogKey key : {JogKey{JogAxis::kX, true}, JogKey{JogAxis::kZ, false}}) {
    Good(PressJog{.key = key});
    GoOnFor(9.0);
    Good(ReleaseJogs{});
    GoOnFor(1.0);
  }
  const motion::MachinePoint away = Column();
  ASSERT_GT(away.x(), 8.0);
  ASSERT_LT(away.z(), -8.0);
  for (int n = 0; n < 3; ++n) {
    Good(PressPanel{PanelKey::kView});
    GoOnFor(60.0);
    EXPECT_NEAR((Column() - motion::MachinePoint(0.0, 152.4, 0.0)).norm(), 0.0, 1e-9) << n;
    Good(PressPanel{PanelKey::kView});
    GoOnFor(60.0);
    EXPECT_NEAR((Column() - away).norm(), 0.0, 1e-9) << n;
  }
}

// LIVE-2.03: HOME at the origin moves nothing: it is IDLE at once.
TEST_F(ViewAnswers, AtTheOriginTheHomeKeyMovesNothing) {
  Good(PressPanel{PanelKey::kHome});
  GoOnFor(60.0);
  ASSERT_EQ(state(), MachineState::kIdle);
  Good(PressPanel{PanelKey::kHome});
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_TRUE(machine->Apply(PressPanel{PanelKey::kZ0}));
}

}  // namespace
}  // namespace rmlcell::machine
