// A mill that starts at a command of its stream (live.md 6).
#include <cmath>

#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// SRM-20: 100 units a mm, Z 0 at the top, Z0 and the origin as the profile has them.
constexpr const char* kPlate =
    "VS10;!VZ8;!PZ-100,200;!RC9;!MC1;PU2010,1510;PD4010,1510;PD4010,3510;PU2010,3510;!PZ-200,300;"
    "PD1000,1000;PU500,500;!MC0;";

class StartAtCommand : public StartTest {
 protected:
  StartAtCommand() : StartTest("rml1") {}
  StepTarget AtByte(const std::string& stream, std::string_view word) const {
    return {.at = {1, 0}, .byte_offset = static_cast<std::int64_t>(stream.find(word))};
  }
};

// LIVE-6.02, LIVE-6.03.
TEST_F(StartAtCommand, TellsWhatIsDifferent) {
  const StartPreview preview = PreviewOf(Setup({kPlate}), {.at = {1, 8}});
  EXPECT_TRUE(preview.may_begin());
  EXPECT_EQ(preview.reach.facts.place.step, 8);
  const auto is = [&](std::string_view item, std::string_view there, StartAction action) {
    const StartDifference* row = Row(preview.differences, item);
    ASSERT_NE(row, nullptr) << item;
    EXPECT_EQ(row->there, there) << item;
    EXPECT_EQ(row->action, action) << item;
  };
  is("VS", "10", StartAction::kSet);
  is("Z1", "-100", StartAction::kSet);
  is("TOOL", "down", StartAction::kSet);
  is("spindle", "on", StartAction::kSwitch);
  is("tool", "as the program means", StartAction::kAsk);
  is("clamps", "as the program means", StartAction::kAsk);
  EXPECT_EQ(Row(preview.differences, "Z0"), nullptr);
  EXPECT_EQ(Row(preview.differences, "origin"), nullptr);
  EXPECT_NE(Row(preview.differences, "pose"), nullptr);
  // The polyline of PD passes there in the whole run.
  EXPECT_EQ(PreviewOf(Setup({kPlate}), {.at = {1, 13}}).reach.facts.passes, false);
  for (const char* item : {"command set", "DW", "MC", "RPM", "MODE", "logical", "pending", "Z2"})
    EXPECT_NE(std::ranges::find(preview.there, item, &StateItem::name), preview.there.end());
}

// LIVE-6.03: Z0 that the stream itself moved is for a person to see to.
TEST_F(StartAtCommand, AMovedZ0IsAskedFor) {
  const StartPreview preview = PreviewOf(Setup({"!ZO-300;PU100,100;PD200,200;"}), {.at = {1, 3}});
  ASSERT_NE(Row(preview.differences, "Z0"), nullptr);
  EXPECT_EQ(Row(preview.differences, "Z0")->action, StartAction::kAsk);
}

// LIVE-6.03, LIVE-6.09: after the entry nothing is different; LIVE-6.01 of every command.
TEST_F(StartAtCommand, AfterTheEntryNothingIsDifferent) {
  const RunSetup setup = Setup({kPlate});
  for (const WholeRun::Step& step : Whole(setup).steps) {
    const StepReach reach = Reach(setup, step.target);
    RunObserver nobody;
    const auto entered = Entered(setup, reach, nobody);
    EXPECT_THAT(ToDo(DifferencesOf(reach.run->enterable()->items(), entered->enterable()->items())),
                IsEmpty())
        << step.target.at.step;
  }
}

// LIVE-6.05: to the top, across at travel speed, spindle on, down at V; LIVE-6.09: marked.
TEST_F(StartAtCommand, Approaches) {
  Observe({kPlate});
  const Result<StartPreview> preview = machine->Preview(At1(8));
  ASSERT_TRUE(preview);
  ASSERT_EQ(preview->approach.size(), 2U);  // it stands at the top
  EXPECT_EQ(preview->approach[0].path, "PU");
  EXPECT_EQ(preview->approach[0].feed_mm_s, 0.0);
  EXPECT_EQ(preview->approach[1].path, "PD");
  EXPECT_EQ(preview->approach[1].feed_mm_s, 8.0);
  EXPECT_LT(preview->approach[1].to.column.z(), preview->approach[0].to.column.z());
  EXPECT_EQ(preview->approach[1].to.column, preview->reach.run->state().axes.column);
  Good(At1(8));
  EXPECT_TRUE(machine->status().run.approaching);
  EXPECT_FALSE(machine->status().run.spindle_on);
  EXPECT_EQ(Value("SPINDLE"), "off");
  GoOn(At(200.0));
  EXPECT_EQ(outside.approach.size(), 2U);
  EXPECT_EQ(outside.uses, std::set<MotionUse>{MotionUse::kTravel});
  EXPECT_FALSE(outside.cuts);
  EXPECT_EQ(outside.moves.front(), "signal 1");
  EXPECT_EQ(outside.steps.front(), 8);
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(over.steps, 13U);
}

// LIVE-6.05: one that stands low goes up first; without a spindle that turned there none is
// started.
TEST_F(StartAtCommand, GoesUpFirst) {
  Observe({"!MC0;PD100,100;PU300,300;PD400,400;"});
  Start();
  GoOn(At(0.9));
  Good(AbortRun{});
  GoOn(At(100.0));
  Over();
  ASSERT_LT(machine->status().run.axes.column.z(), 0.0);
  outside.moves.clear();
  Good(At1(3));
  GoOn(At(200.0));
  ASSERT_EQ(outside.approach.size(), 3U);
  EXPECT_EQ(outside.approach[0].substr(0, 3), "PU ");
  EXPECT_THAT(outside.approach[0], HasSubstr(" 0.00 0.00 0.00"));  // the top
  EXPECT_EQ(std::ranges::count(outside.moves, "signal 1"), 0);
}

// LIVE-6.09: from there on it does what the whole run does.
TEST_F(StartAtCommand, GoesOnAsTheWholeRun) {
  const RunSetup setup = Setup({kPlate});
  Outside whole;
  auto run = *family_.NewRun(setup, whole);
  while (run->Advance(run->state().time + At(60.0)) != RunPhase::kFinished) {
  }
  for (int command = 1; command <= 13; ++command) {
    const StepReach reach = Reach(setup, {.at = {1, command}});
    Outside own;
    auto entered = Entered(setup, reach, own);
    own.moves.clear();  // the spindle
    entered->Apply({.at = entered->state().time, .kind = InputKind::kStart, .value = 1.0});
    while (entered->Advance(entered->state().time + At(60.0)) != RunPhase::kFinished) {
    }
    ASSERT_LE(own.moves.size(), whole.moves.size());
    EXPECT_TRUE(std::equal(own.moves.rbegin(), own.moves.rend(), whole.moves.rbegin())) << command;
    EXPECT_EQ(own.steps.size(), static_cast<std::size_t>(14 - command));
    EXPECT_EQ(entered->SaveMachine(), run->SaveMachine()) << command;
  }
}

// LIVE-6.09: HOLD, STOP and SINGLE in the approach; halted at the entry.
TEST_F(StartAtCommand, IsHaltedInTheApproach) {
  Observe({kPlate});
  StartAtStep input = At1(8);
  input.halt_at_entry = true;
  Good(input);
  GoOn(At(0.3));
  Good(StopRun{});
  GoOn(At(5.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_THAT(outside.approach, IsEmpty());
  EXPECT_TRUE(machine->status().run.approaching);
  Good(ResumeRun{});
  GoOn(At(5.2));
  Good(HoldRun{});
  GoOn(At(20.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(outside.approach.size(), 1U);
  EXPECT_FALSE(machine->status().run.spindle_on);
  Good(ResumeRun{});
  GoOn(At(60.0));
  EXPECT_EQ(state(), MachineState::kHeld);  // at the entry
  EXPECT_EQ(outside.approach.size(), 2U);
  EXPECT_FALSE(machine->status().run.approaching);
  EXPECT_TRUE(machine->status().run.spindle_on);
  EXPECT_THAT(outside.steps, IsEmpty());
  Good(ResumeRun{});
  GoOn(At(200.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);

  Good(ChangeMode{Mode::kSingle});
  outside.approach.clear();
  input.source = StartSource::kPanel;
  input.halt_at_entry = false;
  Good(input);
  GoOn(At(260.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(outside.approach.size(), 1U);
  Good(AbortRun{});
  EXPECT_EQ(state(), MachineState::kIdle);
}

// LIVE-6.09: whatever keys come in the approach and behind it, it does the same.
TEST_F(StartAtCommand, IsNotDisturbedByKeys) { StartTest::IsNotDisturbedByKeys({kPlate}, At1(8)); }

// LIVE-6.05: a rotary axis turns on the way across.
TEST_F(StartAtCommand, TurnsTheRotaryAxis) {
  const Parameters rotary = *MakeParameters(family_, "mdx-40a-rotary", {});
  RunSetup setup(rotary);
  setup.programs[1] = Translated("!MC0;!ZEX1000A90;!ZEX2000A45;");
  setup.main_program = 1;
  const std::string now = (*family_.NewStanding(rotary, ""))->Save();
  const Result<StartPreview> preview =
      PreviewStart(family_, setup, {.target = {.at = {1, 3}}, .machine_state = now}, {});
  ASSERT_TRUE(preview);
  EXPECT_EQ(FirstRefusal(*preview), "none");
  Outside own;
  auto run = *family_.NewRun(setup, own);
  run->Restore(*preview->reach.run->Save());
  run->enterable()->Enter({.machine_state = now, .halt_at_entry = true});
  while (run->Advance(run->state().time + At(60.0)) == RunPhase::kRunning) {
  }
  EXPECT_THAT(ToDo(DifferencesOf(preview->there, run->enterable()->items())), IsEmpty());
  EXPECT_NEAR(std::abs(run->state().axes.a_rad), M_PI / 2.0, 1e-9);
  EXPECT_FALSE(own.approach.empty());
}

// LIVE-6.04: commands that are none, inside of a list, of a call, of an ESC sequence.
TEST_F(StartAtCommand, IsRefused) {
  const std::string stream = "PU100,100;PD200,200,300,300;^PU400,400;\x1b.M1:PU500,500;PU600,600;";
  RunSetup setup = Setup({stream});
  ASSERT_TRUE(setup.parameters.Set("SEQUENCES", std::string_view("ALL")));
  const auto why = [&](const StepTarget& target) { return FirstRefusal(PreviewOf(setup, target)); };
  EXPECT_EQ(why({.at = {1, 2}}), "none");
  EXPECT_EQ(why({.at = {1, 3}}), "none");  // with the call that it stands in
  EXPECT_EQ(why({.at = {1, 4}}), "none");  // behind that, and with the ESC sequence
  EXPECT_EQ(why(AtByte(stream, "PD200")), "none");
  EXPECT_EQ(PreviewOf(setup, AtByte(stream, "PD200")).reach.target.at.step, 2);
  EXPECT_THAT(
      why(AtByte(stream, "300,300")),
      HasSubstr("CELL-E9426 byte 20 lies inside of command 2 or of a call or ESC sequence"));
  EXPECT_THAT(why(AtByte(stream, "PU400")), HasSubstr("CELL-E9426 byte 29 lies inside"));
  EXPECT_THAT(why(AtByte(stream, ".M1")), HasSubstr("CELL-E9426 byte "));
  EXPECT_EQ(why(AtByte(stream, "PU600")), "none");
  EXPECT_THAT(why({.at = {1, 0}}), HasSubstr("CELL-E9426 step 0 is none"));
  EXPECT_THAT(why({.at = {1, 0}}), HasSubstr("clean behind: 1/1"));
  EXPECT_THAT(why({.at = {1, 99}}),
              HasSubstr("CELL-E9426 step 1/99 is not reached: the program ends; the last step "
                        "reached is 1/5; clean before: 1/"));
  EXPECT_THAT(
      why({.at = {1, 2}, .occurrence = 2}),
      HasSubstr("CELL-E9426 a stream has commands from 1 on, and comes to each of them once"));
  // Behind a command that ESC.K cut off no run can halt.
  const RunSetup cut = Setup({"PU100,1\x1b.KPU200,200;PU300,300;"});
  EXPECT_THAT(FirstRefusal(PreviewOf(cut, {.at = {1, 2}})),
              HasSubstr("CELL-E9426 step 1/2 is not reached"));
  EXPECT_EQ(FirstRefusal(PreviewOf(cut, {.at = {1, 3}})), "none");
  EXPECT_THAT(FirstRefusal(PreviewOf(setup, {.at = {1, 2}}, false, ApproachWay::kDirect)),
              HasSubstr("CELL-E9427 this machine begins behind an approach alone"));
  Load({stream});
  StartAtStep input = At1(2);
  input.acknowledged = {"clamps"};
  EXPECT_EQ(Refused(input), "CELL-E9421 nobody has seen to tool");
}

}  // namespace
}  // namespace rmlcell::machine
