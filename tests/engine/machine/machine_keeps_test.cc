// What a machine keeps to itself or tells though nobody asks at once: where a run begins, what is
// armed for another one, which key moves what.
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/machine/handbox.h"
#include "tests/engine/machine/held_bed.h"
#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

class KeptStart : public StartTest {};

constexpr const char* kCalls = "DELAY 1\nDELAY 1\nCALL 2\nDELAY 1\n";
constexpr const char* kIsCalled =
    "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (521.02, 2201.2, -380., 0., 0.)\nDELAY 1\n"
    "MOVE (561.02, 2201.2, -380., 0., 0.)\n";

// LIVE-6.09: on its way the run is at the step where it begins, of the program that is called
// there.
TEST_F(KeptStart, OnItsWayItIsInTheCalledProgram) {
  Load({kCalls, kIsCalled});
  Good(StartAtStep{.program = 1,
                   .target = {.at = {2, 5}},
                   .acknowledged = {"clamps", "table", "tool", "Z0", "origin"}});
  GoOn(At(0.2));
  const RunState now = machine->status().run;
  ASSERT_TRUE(now.approaching);
  EXPECT_EQ(now.place.program, 2);
  EXPECT_EQ(now.place.step, 5);
  // Behind the call it is in the program that called.
  Load({kCalls, kIsCalled});
  Good(StartAtStep{.program = 1,
                   .target = {.at = {1, 4}},
                   .acknowledged = {"clamps", "table", "tool", "Z0", "origin"}});
  ASSERT_TRUE(machine->status().run.approaching);
  EXPECT_EQ(machine->status().run.place.program, 1);
  EXPECT_EQ(machine->status().run.place.step, 4);
}

// LIVE-2.10: what was prepared does not begin where nothing may begin any more.
TEST_F(KeptStart, WhatIsPreparedMayBeRefusedYet) {
  Load({kIsCalled});
  StartAtStep input = At1(6);
  input.prepared = std::make_shared<const StartPreview>(*machine->Preview(input));
  ASSERT_TRUE(input.prepared->may_begin());
  Good(ChangeMode{Mode::kManual});
  EXPECT_THAT(Refused(input), HasSubstr("MANUAL"));
  Good(ChangeMode{Mode::kRemote});
  Good(EmergencyStop{.pressed = true});
  EXPECT_NE(Refused(input), "it was taken");
  EXPECT_FALSE(machine->status().open);
  EXPECT_EQ(machine->status().last_run, 0);
}

class KeptSimul : public HeldTest {
 protected:
  int Key(std::string_view key, KeyAction action) {
    const Result<KeyAnswer> answer = machine->PressKey(key, action);
    EXPECT_TRUE(answer) << key;
    return answer && answer->message ? Lookup(*answer->message).number : 0;
  }
};

// OPT-6.14, OPT-6.16: SIMUL that the program has armed for the next start is for programs: HOME
// beside the held run moves the axes, and leaves it armed.
TEST_F(KeptSimul, HomeIsNoDryRun) {
  LoadHeld(std::string("SIMUL 99,2\n") + kCorner, 5.0);
  ASSERT_GT(Axes().column.x(), 100.0);
  EXPECT_EQ(Key("HOME", KeyAction::kPress), 0);
  GoOnFor(30.0);
  EXPECT_EQ(Key("HOME", KeyAction::kRelease), 0);
  GoOnFor(1.0);
  EXPECT_NEAR(Axes().column.x(), 21.02, 1e-4);
  EXPECT_NEAR(Axes().column.y(), 2201.2, 1e-4);
  Good(AbortRun{});
  GoOnFor(1.0);
  EXPECT_EQ(machine->simulation_until(), (ProgramStep{2, 99}));
}

class KeptKeys : public MachineTest {
 protected:
  KeptKeys() : MachineTest("rml1") {}
};

// A mill has no references: keys of any move together, along its axes.
TEST_F(KeptKeys, AMillHasNoReferences) {
  Load({"PA;"});
  const auto x = [&] { return machine->status().run.axes.column.x(); };
  const auto y = [&] { return machine->status().run.axes.column.y(); };
  const double from_x = x(), from_y = y();
  Good(PressJog{.key = {JogAxis::kX, true}, .reference = JogReference::kRobot});
  GoOn(At(1.0));
  Good(PressJog{.key = {JogAxis::kY, true}, .reference = JogReference::kTool});
  GoOn(At(2.0));
  EXPECT_EQ(state(), MachineState::kJogging);
  EXPECT_NEAR(x() - from_x, 2.0, 0.02);
  EXPECT_NEAR(y() - from_y, 1.0, 0.02);
}

class KeptMarks : public MachineTest {};

// LIVE-3.23: who begins with a mark has its alarms, acknowledges them and counts on from there.
TEST_F(KeptMarks, AlarmsAreThereAgain) {
  Load({"DELAY 5\n"});
  Good(EmergencyStop{.pressed = true});
  const std::vector<Alarm> alarms = machine->status().alarms;
  ASSERT_EQ(alarms.size(), 1U);
  const std::string mark = machine->Save();
  Load({"DELAY 5\n"}, mark);
  EXPECT_EQ(state(), MachineState::kAlarm);
  ASSERT_EQ(machine->status().alarms.size(), 1U);
  EXPECT_EQ(machine->status().alarms[0].id, alarms[0].id);
  EXPECT_EQ(machine->status().alarms[0].code, alarms[0].code);
  EXPECT_NE(Refused(Acknowledge{alarms[0].id}), "it was taken");  // the key is down yet
  Good(EmergencyStop{.pressed = false});
  Good(Acknowledge{alarms[0].id});
  EXPECT_NE(state(), MachineState::kAlarm);
}

class KeptMillStart : public StartTest {
 protected:
  KeptMillStart() : StartTest("rml1") {}
};

// LIVE-6.09: a mill is at its command on the way there as well.
TEST_F(KeptMillStart, OnItsWayItIsAtItsCommand) {
  Load({"PA;PU1000,1000;PU2000,1000;PU2000,2000;PU3000,2000;PU3000,3000;"});
  Good(At1(5));
  GoOn(At(0.2));
  ASSERT_TRUE(machine->status().run.approaching);
  EXPECT_EQ(machine->status().run.place.program, 1);
  EXPECT_EQ(machine->status().run.place.step, 5);
}

const MachineFamily& KeptMills() { return *families::FindFamily("rml1"); }

// A wrong name of a profile has its proposal: the profiles whose name it holds or that hold it, of
// two letters too; a letter alone holds nothing.
TEST(ProfileProposals, OfShortNames) {
  const auto said = [](const std::string& name) {
    const Result<Parameters> made = MakeParameters(KeptMills(), name, {});
    return made ? std::string("it was made") : std::string(made.error().detail);
  };
  EXPECT_EQ(said("my t1 mill"), "no profile 'my t1 mill'; did you mean t1?");
  EXPECT_EQ(said("srm"), "no profile 'srm'; did you mean srm-20?");
  EXPECT_THAT(said("1"), HasSubstr("; there are t1 "));
}

// Whether somebody named the profile is told of the one that was applied last.
TEST(NamedProfiles, AreToldAsNamed) {
  Parameters parameters(KeptMills().parameters());
  const MachineProfile& profile = KeptMills().profiles().front();
  EXPECT_FALSE(parameters.profile_named());
  ASSERT_TRUE(parameters.Apply(profile));
  EXPECT_TRUE(parameters.profile_named());
  EXPECT_TRUE(parameters.Used().named);
  ASSERT_TRUE(parameters.ApplyUnnamed(profile));
  EXPECT_FALSE(parameters.profile_named());
  EXPECT_FALSE(parameters.Used().named);
}

// What is wrong with a whole project is of no slot.
TEST(ProjectFaults, OfNoProgramHaveNoSlot) {
  const Parameters t1 = *MakeParameters(KeptMills(), "t1", {});
  for (const bool schedules : {true, false}) {
    ProjectBundle project;
    if (schedules)
      project.schedules = {LaserSchedule{}};
    else
      project.processes = {ProcessDefinition{}};
    const TransferPlan plan = KeptMills().PlanTransfer(project, t1, {});
    EXPECT_FALSE(plan.ok);
    ASSERT_EQ(plan.diagnostics.size(), 1U);
    EXPECT_EQ(plan.diagnostics[0].program, 0);
    EXPECT_EQ(plan.diagnostics[0].file, "");
    EXPECT_EQ(plan.diagnostics[0].severity, Lookup(ErrorCode::kCellInvalidArgument).severity);
  }
}

}  // namespace
}  // namespace rmlcell::machine
