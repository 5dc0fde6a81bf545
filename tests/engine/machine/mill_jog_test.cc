// The jog keys of a mill's panel.
#include <gmock/gmock.h>

#include <random>

#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

constexpr JogKey kZDown{JogAxis::kZ, false};
constexpr JogKey kXUp{JogAxis::kX, true};

// An SRM-20: 203.2 x 152.4 x 60.5 mm, X and Y to 30 mm/s, Z to 30 mm/s, no rotary axis.
class MillJogTest : public MachineTest {
 protected:
  MillJogTest() : MachineTest("rml1") {}

  void LoadWith(const std::string& profile, const std::map<std::string, std::string>& values = {},
                const std::string& state = {}) {
    Parameters made = *MakeParameters(family_, profile, values);
    MachineMemory memory;
    memory.programs[1] = Translated("PA;PU1000,1000;!NR;PU2000,2000;");
    machine = *Machine::Make(family_, std::move(made), std::move(memory), state, heard);
  }
  motion::AxisPose Axes() const { return machine->status().run.axes; }
  double TipSpeed() const { return machine->status().run.tip_speed_mm_s; }
  void GoOnFor(double seconds) { GoOn(machine->time() + At(seconds)); }
};

// LIVE-8.03: X, Y and Z continuously at 1 mm/s; whatever the mode is.
TEST_F(MillJogTest, KeysMoveItSlowly) {
  LoadWith("srm-20");
  const struct {
    JogAxis axis;
    bool plus;
  } keys[] = {{JogAxis::kX, true}, {JogAxis::kY, true}, {JogAxis::kZ, false}};
  for (const auto& [axis, plus] : keys) {
    const motion::AxisPose at = Axes();
    Good(PressJog{.key = {axis, plus}});
    EXPECT_EQ(state(), MachineState::kJogging);
    GoOnFor(2.0);
    EXPECT_NEAR(TipSpeed(), 1.0, 1e-9);
    Good(ReleaseJog{{axis, plus}});
    EXPECT_EQ(state(), MachineState::kStopping);
    GoOnFor(0.1);
    EXPECT_EQ(state(), MachineState::kIdle);
    motion::MachineVector moved = Axes().column - at.column;
    const int i = static_cast<int>(axis);
    EXPECT_NEAR(moved[i], plus ? 2.0 : -2.0, 1e-9);  // up and down ramps make one another good
    moved[i] = 0.0;
    EXPECT_NEAR(moved.norm(), 0.0, 1e-12);
  }
}

// LIVE-8.03: a tap is one unit step, 0.01 mm.
TEST_F(MillJogTest, ATapIsOneStep) {
  LoadWith("srm-20");
  const double x = Axes().column.x();
  for (int n = 1; n <= 5; ++n) {
    Good(PressJog{.key = kXUp});
    Good(ReleaseJog{kXUp});
    GoOnFor(0.1);
    EXPECT_EQ(state(), MachineState::kIdle);
    EXPECT_NEAR(Axes().column.x(), x + 0.01 * n, 1e-9);
  }
  Good(PressJog{.key = kXUp});  // but not when it is stopped
  Good(StopRun{});
  GoOnFor(0.1);
  EXPECT_NEAR(Axes().column.x(), x + 0.05, 1e-9);
}

// LIVE-8.03: with FAST at the highest speed of the profile; Z down no faster than V and !VZ may.
TEST_F(MillJogTest, FastIsTheHighestOfTheProfile) {
  LoadWith("srm-20", {{"Z_SPEED_MAX", "7"}});
  Good(PressJog{.key = kXUp, .fast = true});
  GoOnFor(1.0);
  EXPECT_NEAR(TipSpeed(), 30.0, 1e-9);
  Good(ReleaseJogs{});
  GoOnFor(1.0);
  Good(PressJog{.key = kZDown, .fast = true});
  GoOnFor(1.0);
  EXPECT_NEAR(TipSpeed(), 7.0, 1e-9);
  Good(ReleaseJogs{});
  GoOnFor(1.0);
  constexpr auto kNoReference = JogReference::kRobot;
  EXPECT_NEAR(machine->run_on(kNoReference, false)->mm, 1.0 / (2.0 * 200.0), 1e-9);
  EXPECT_NEAR(machine->run_on(kNoReference, true)->mm, 30.0 * 30.0 / (2.0 * 200.0), 1e-9);
}

// LIVE-8.05: FAST changed with a key down stops it first.
TEST_F(MillJogTest, FastChangedStopsIt) {
  LoadWith("srm-20");
  Good(PressJog{.key = kXUp});
  GoOnFor(1.0);
  Good(PressJog{.key = kXUp, .fast = true});
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOnFor(1.0);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_THAT(Refused(PressJog{.key = kXUp, .fast = true}), HasSubstr("CELL-E9421"));
  Good(ReleaseJog{kXUp});
  Good(PressJog{.key = kXUp, .fast = true});
  GoOnFor(1.0);
  EXPECT_NEAR(TipSpeed(), 30.0, 1e-9);
}

// LIVE-8.03: the keys X Y Z A, and A where there is one; no key B.
TEST_F(MillJogTest, KeysThatAMillDoesNotHave) {
  LoadWith("srm-20");
  EXPECT_THAT(Refused(PressJog{.key = {JogAxis::kB, true}}), HasSubstr("CELL-E9003"));
  EXPECT_THAT(Refused(PressJog{.key = {JogAxis::kC, true}}),
              HasSubstr("there is no jog key C+, only X Y Z A"));
  EXPECT_EQ(Refused(PressJog{.key = {JogAxis::kA, true}}), "CELL-E9003 the machine has no axis A");
  LoadWith("srm-20", {{"AXES", "XYZA"}, {"A_SENSE", "LEFT"}});
  Good(PressJog{.key = {JogAxis::kA, true}});
  GoOnFor(3.0);
  Good(ReleaseJogs{});
  GoOnFor(1.0);
  EXPECT_NEAR(Axes().a_rad, 3.0 * kRadPerDegree, 1e-9);
  EXPECT_EQ(Axes().column.x(), 0.0);
}

// LIVE-8.02: no axis leaves its travel.
TEST_F(MillJogTest, ItStandsOnTheEndsOfItsTravel) {
  LoadWith("srm-20");
  for (const bool plus : {true, false}) {
    for (const JogAxis axis : {JogAxis::kX, JogAxis::kY, JogAxis::kZ})
      Good(PressJog{.key = {axis, plus}, .fast = true});
    GoOnFor(60.0);
    EXPECT_EQ(TipSpeed(), 0.0);
    EXPECT_NEAR(Axes().column.x(), plus ? 203.2 : 0.0, 1e-9);
    EXPECT_NEAR(Axes().column.y(), plus ? 152.4 : 0.0, 1e-9);
    EXPECT_NEAR(Axes().column.z(), plus ? 0.0 : -60.5, 1e-9);
    Good(ReleaseJogs{});
    EXPECT_EQ(state(), MachineState::kIdle);
  }
}

// LIVE-8.03: the cover is open: refused CELL-E9433. LIVE-2.10: opened meanwhile, it stops.
TEST_F(MillJogTest, TheCoverStopsIt) {
  LoadWith("srm-20");
  Good(PressJog{.key = kXUp});
  GoOnFor(1.0);
  Good(MoveDoor{.open = true});
  EXPECT_EQ(state(), MachineState::kStopping);
  EXPECT_TRUE(machine->status().run.door_open);
  GoOnFor(1.0);
  Good(ReleaseJog{kXUp});
  EXPECT_THAT(Refused(PressJog{.key = kXUp}), HasSubstr("CELL-E9433"));
  LoadWith("srm-20", {}, machine->Save());
  EXPECT_THAT(Refused(PressJog{.key = kXUp}), HasSubstr("CELL-E9433"));
  Good(MoveDoor{.open = false});
  Good(PressJog{.key = kXUp});
  EXPECT_EQ(state(), MachineState::kJogging);
}

// LIVE-8.03: in IDLE; held, no machine is known that it moves in.
TEST_F(MillJogTest, AHeldMillRefusesKeys) {
  LoadWith("srm-20");
  Start();
  GoOnFor(0.1);
  EXPECT_THAT(Refused(PressJog{.key = kXUp}), HasSubstr("CELL-E9421"));
  GoOnFor(60.0);
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_THAT(Refused(PressJog{.key = kXUp}), HasSubstr("CELL-E9421"));
}

// What it was moved by stays with the machine, and its registers do, too.
TEST_F(MillJogTest, WhatIsSavedInTheMiddleStands) {
  LoadWith("srm-20");
  const double z0 = machine->status().run.work_origin->z();
  Good(PressJog{.key = kXUp});
  GoOnFor(2.0);
  const std::string mark = machine->Save();
  LoadWith("srm-20", {}, mark);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_NEAR(Axes().column.x(), 2.0 - 0.0025, 1e-9);
  EXPECT_EQ(machine->status().run.work_origin->z(), z0);
  Start();
  EXPECT_NEAR(Axes().column.x(), 2.0 - 0.0025, 1e-9);
}

// LIVE-8.02: random keys, in every state.
TEST_F(MillJogTest, RandomKeysStayInside) {
  std::mt19937 random(4);
  LoadWith("srm-20", {{"AXES", "XYZA"}});
  for (int n = 0; n < 3'000; ++n) {
    const JogKey key{static_cast<JogAxis>(random() % 4), random() % 2 == 0};
    const auto which = random() % 8;
    if (which < 4) {
      static_cast<void>(machine->Apply(PressJog{.key = key, .fast = n / 100 % 2 == 0}));
    } else if (which < 7) {
      Good(ReleaseJog{key});
    } else {
      Good(ReleaseJogs{});
    }
    GoOnFor(static_cast<double>(random() % 1000) * 3e-3);
    const motion::MachinePoint at = Axes().column;
    ASSERT_TRUE(at.x() >= 0.0 && at.x() <= 203.2 + 1e-12) << at.x();
    ASSERT_TRUE(at.y() >= 0.0 && at.y() <= 152.4 + 1e-12) << at.y();
    ASSERT_TRUE(at.z() >= -60.5 - 1e-12 && at.z() <= 0.0) << at.z();
  }
}

}  // namespace
}  // namespace rmlcell::machine
