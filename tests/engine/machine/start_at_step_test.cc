// An Optimo that starts at a step (live.md 6): what is different there, what is refused, the way
// there, and what the run does from there on.
#include <cmath>

#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Home of the standard machine: column (21.02, 2201.2, -50), so that the tip is at Z -350.
constexpr const char* kSquare =
    "COORD ABSOL\nPATH LIN\nSPEED 20\nWORKDEF 1,0 (8.,75.,.2,50.)\nVR[1]=4.5\nOL[11]=ON\n"
    "MOVE (521.02, 2201.2, -380., 0., 0.)\nOL[8]=ON\nWORK 1,0/ON\n"
    "MOVE (561.02, 2201.2, -380., 0., 0.)/FLY\nMOVE (561.02, 2241.2, -380., 0., 0.)\n"
    "WORK 1,0/OFF\nMOVE (621.02, 2241.2, -380., .5, .25)\nVR[2]=VR[1]*2.\nWORK 1,0/ON\n"
    "MOVE (621.02, 2301.2, -380., .5, .25)\nWORK 1,0/OFF\nOL[8]=OFF\n";

class StartAt : public StartTest {
 protected:
  RunState Now() const { return machine->status().run; }
};

// LIVE-6.03: one row for each difference, with what is done about it; nothing is done before START.
TEST_F(StartAt, TellsWhatIsDifferent) {
  Load({kSquare});
  Good(WriteVariable{"VR[7]", 3.0});
  Good(ChangeOverride{50.0});
  const Result<StartPreview> preview = machine->Preview(At1(13));
  ASSERT_TRUE(preview);
  EXPECT_TRUE(preview->may_begin());
  const std::vector<StartDifference>& rows = preview->differences;
  const auto is = [&](std::string_view item, std::string_view there, std::string_view now,
                      StartAction action) {
    const StartDifference* row = Row(rows, item);
    ASSERT_NE(row, nullptr) << item;
    EXPECT_EQ(row->there, there) << item;
    EXPECT_EQ(row->now, now) << item;
    EXPECT_EQ(row->action, action) << item;
  };
  is("VR[1]", "4.5", "0", StartAction::kSet);
  is("PATH", "LIN", "", StartAction::kSet);
  is("SPEED", "20.0", "", StartAction::kSet);
  is("OL[11]", "1", "0", StartAction::kSet);
  is("output OL[11]", "1", "0", StartAction::kSwitch);
  is("gas", "2", "1", StartAction::kSwitch);
  is("WORKDEF 1,0", "8, 75, 0.2, 50, 0", "", StartAction::kSet);
  is("pose", "X 561.02002 Y 2241.199951 Z -80 A 0 B 0", "X 21.02 Y 2201.2 Z -50 A 0 B 0",
     StartAction::kMove);
  is("clamps", "below SAFE_Z", "not known", StartAction::kAsk);
  EXPECT_EQ(Row(rows, "VR[7]"), nullptr);  // as it is now: the program starts with it
  EXPECT_EQ(Row(rows, "table"), nullptr);
  EXPECT_EQ(Row(rows, "override"), nullptr);
  EXPECT_EQ(preview->reach.run->stack().back().step, 13);
  EXPECT_GT(preview->run_time, At(1.0));
  EXPECT_EQ(Value("VR[1]"), "0.0");
  EXPECT_EQ(state(), MachineState::kIdle);
}

// LIVE-6.02: the state is shown whole.
TEST_F(StartAt, ShowsTheStateWhole) {
  const RunSetup setup =
      Setup({"TIMER (5.,900)\nERR 800\nSYSDEF (1.,2.,3.,0.,0.,0.)\nGOSUB 100\nENDTASK\n"
             "100 CALL 2\nRETURN\n800 RETURN\n900 RETURN\n",
             "SPEED 12\nDELAY 2\nVI[3]=1\n"});
  const StartPreview preview = PreviewOf(setup, {.at = {2, 3}});
  const auto value = [&](std::string_view name) {
    const auto found = std::ranges::find(preview.there, name, &StateItem::name);
    return found == preview.there.end() ? std::string("none") : found->value;
  };
  EXPECT_EQ(value("stack"), "1/4 1/6 2/3");
  EXPECT_EQ(value("SPEED"), "12.0");
  EXPECT_EQ(value("caller 1 SPEED"), "70.0");
  EXPECT_EQ(value("caller 1 ERR"), "800");
  EXPECT_EQ(value("ERR"), "OFF");
  EXPECT_EQ(value("caller 1 TIMER"), "900 in 5.04 s");
  EXPECT_EQ(value("SYSDEF"), "(1.0, 2.0, 3.0, 0.0, 0.0, 0.0)");
  EXPECT_EQ(value("WORK"), "OFF");
  EXPECT_EQ(value("UPDATE"), "IL, OL, IA, OA");
  for (const char* name : {"VR[99]", "VL[0]", "VI[50]", "IL[99]", "OA[9]", "input IA[3]",
                           "output OL[40]", "schedule", "gas", "table", "pose", "TCP"})
    EXPECT_NE(value(name), "none") << name;
}

// LIVE-6.03, LIVE-6.09: after the entry nothing is different but what a person sees to; of every
// step. LIVE-6.01 of its values.
TEST_F(StartAt, AfterTheEntryNothingIsDifferent) {
  for (const std::vector<std::string>& programs :
       {std::vector<std::string>{kSquare},
        std::vector<std::string>{
            "COORD ABSOL\nPATH LIN\nTIMER (50.,900)/AUTO\nOA[3]=1.5\nWORKDEF 2,0 (12)\n"
            "WORK 2,0/ON\nWORK 2,0/OFF\nFUNCTION 3 (2.5)\nENDTASK\n900 RETURN\n",
            "VI[1]=1\n", "VR[4]=PAR[1]\nMOVE (500.,2200.,-350.,0.,0.)/FLY\nVI[2]=5\nCALL 2\n"}}) {
    const RunSetup setup = Setup(programs);
    RunObserver nobody;
    for (const WholeRun::Step& step : Whole(setup).steps) {
      const StepReach reach = Reach(setup, step.target);
      const auto entered = Entered(setup, reach, nobody);
      EXPECT_THAT(
          ToDo(DifferencesOf(reach.run->enterable()->items(), entered->enterable()->items())),
          IsEmpty())
          << step.target.at.step;
      EXPECT_EQ(entered->stack(), reach.run->stack());
      EXPECT_EQ(entered->modal_values(), reach.run->modal_values());
    }
  }
}

// LIVE-6.05: across at SPEED 40, down at SPEED 10, both by the override: of 500 mm/s.
TEST_F(StartAt, ApproachesByTheOverride) {
  for (const double percent : {50.0, 145.0}) {
    Observe({kSquare});
    Good(ChangeOverride{percent});
    Good(At1(14));
    GoOn(At(0.7));
    const double x = machine->status().run.axes.column.x();
    GoOn(At(0.8));
    EXPECT_NEAR(machine->status().run.axes.column.x() - x, 0.1 * 2.0 * percent, 1e-6) << percent;
    GoOn(At(100.0));
    EXPECT_NEAR(outside.feeds.front(), 0.0, 1e-9);
    EXPECT_NEAR(outside.feeds.back(), 0.5 * percent, 1e-9);
    Over();
  }
}

// LIVE-6.05: up, across, down; LIVE-6.09: marked, never cut, never counted.
TEST_F(StartAt, ApproachesSafely) {
  Observe({kSquare});
  Good(WriteVariable{"VR[7]", 3.0});
  const Result<StartPreview> preview = machine->Preview(At1(14));
  ASSERT_TRUE(preview);
  // It stands at SAFE_Z: across at SPEED 40, down at SPEED 10 to where the MOVE before ends.
  ASSERT_EQ(preview->approach.size(), 2U);
  EXPECT_EQ(preview->approach[0].path, "PTP");
  EXPECT_EQ(preview->approach[0].feed_mm_s, 0.0);
  EXPECT_EQ(preview->approach[0].to.column.z(), -50.0);
  EXPECT_EQ(preview->approach[1].path, "LIN");
  EXPECT_EQ(preview->approach[1].feed_mm_s, 50.0);
  Good(At1(14));
  EXPECT_EQ(state(), MachineState::kRunning);
  EXPECT_TRUE(Now().approaching);
  EXPECT_EQ(machine->status().open->entered->at, (StepTarget{.at = {1, 14}}));
  GoOn(At(0.2));
  EXPECT_TRUE(Now().approaching);
  EXPECT_EQ(Value("OL[11]"), "1");  // the image; the output is switched at the entry
  GoOn(At(100.0));
  const motion::AxisPose to = preview->reach.run->state().axes;
  const auto text = [](const char* path, const motion::AxisPose& axes) {
    Outside one;
    one.OnMove({.axes = axes, .path = path, .approach = true});
    return one.approach[0];
  };
  motion::AxisPose above = to;
  above.column.z() = -50.0;
  EXPECT_THAT(outside.approach, ElementsAre(text("PTP", above), text("LIN", to)));
  EXPECT_EQ(outside.uses, std::set<MotionUse>{MotionUse::kTravel});
  EXPECT_FALSE(outside.cuts);
  EXPECT_EQ(outside.feeds.back(), 50.0);
  EXPECT_EQ(outside.steps, (std::vector<int>{14, 15, 16, 17, 18}));
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(over.steps, 18U);
  EXPECT_EQ(over.run.begun, SimTime(0) - preview->run_time);  // its time goes on from there
  EXPECT_EQ(over.run.entered->run_time, preview->run_time);
}

// LIVE-6.05: one that stands low goes up first; the entry's Z where that is higher; the override.
TEST_F(StartAt, GoesUpFirst) {
  const std::string low = "COORD ROBOT\nMOVE (100., 2000., -400., 0., 0.)\n";
  Observe({low, "COORD ROBOT\nMOVE (200., 2100., -20., 0., 0.)\nVI[2]=1\nVI[3]=1\n",
           "COORD ROBOT\nMOVE (300., 2100., -400., 0., 0.)\nVI[4]=1\n"});
  Start();
  GoOn(At(60.0));
  Over();
  outside.approach.clear();
  Good(ChangeOverride{50.0});
  StartAtStep input = At1(3);
  input.program = 2;
  input.target.at = {2, 3};
  Good(input);
  GoOn(At(160.0));
  EXPECT_THAT(outside.approach, ElementsAre("PTP 100.00 2000.00 -20.00 0.00 0.00",
                                            "PTP 200.00 2100.00 -20.00 0.00 0.00"));
  outside.approach.clear();
  input.target.at = {3, 3};
  input.program = 3;
  Good(input);  // it stands higher than the way across
  GoOn(At(260.0));
  EXPECT_THAT(outside.approach, ElementsAre("PTP 300.00 2100.00 -50.00 0.00 0.00",
                                            "LIN 300.00 2100.00 -400.00 0.00 0.00"));
  EXPECT_EQ(outside.feeds.back(), 25.0);  // SPEED 10 of 500 mm/s, and an override of 50 %
}

// LIVE-6.09: the run goes on as the whole run does, of every step that may be entered.
TEST_F(StartAt, GoesOnAsTheWholeRun) {
  const RunSetup setup = Setup({kSquare});
  Outside whole;
  auto run = *family_.NewRun(setup, whole);
  while (run->Advance(run->state().time + At(60.0)) != RunPhase::kFinished) {
  }
  for (int step = 1; step <= 18; ++step) {
    const StepReach reach = Reach(setup, {.at = {1, step}});
    if (reach.facts.work_active) continue;  // its beam stays off: another test
    Outside own;
    auto entered = Entered(setup, reach, own);
    const std::size_t told = own.moves.size();
    entered->Apply({.at = entered->state().time, .kind = InputKind::kStart, .value = 1.0});
    while (entered->Advance(entered->state().time + At(60.0)) != RunPhase::kFinished) {
    }
    EXPECT_EQ(told, 0U);
    ASSERT_LE(own.moves.size(), whole.moves.size());
    EXPECT_TRUE(std::equal(own.moves.rbegin(), own.moves.rend(), whole.moves.rbegin())) << step;
    EXPECT_EQ(own.steps.size(), static_cast<std::size_t>(19 - step));
    EXPECT_EQ(entered->SaveMachine(), run->SaveMachine()) << step;
  }
}

// LIVE-6.09: halted at the entry, RESUME runs the step. LIVE-2.10: from IDLE alone.
TEST_F(StartAt, HaltsAtTheEntry) {
  Load({kSquare});
  StartAtStep input = At1(14);
  input.halt_at_entry = true;
  Good(input);
  EXPECT_THAT(Refused(input), HasSubstr("CELL-E9421 the machine is RUNNING"));
  GoOn(At(60.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Now().place.step, 14);
  EXPECT_EQ(Value("VR[2]"), "0.0");
  EXPECT_THAT(Refused(input), HasSubstr("CELL-E9421 the machine is HELD"));
  Good(ResumeRun{});
  GoOn(At(120.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_EQ(Value("VR[2]"), "9.0");
}

// LIVE-6.09: STOP, HOLD (in REMOTE a STOP), ABORT and the emergency stop in the approach.
TEST_F(StartAt, IsStoppedInTheApproach) {
  Observe({kSquare});
  Good(At1(14));
  GoOn(At(0.3));
  Good(StopRun{});
  EXPECT_EQ(state(), MachineState::kStopping);
  GoOn(At(3.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_TRUE(Now().approaching);
  EXPECT_EQ(Now().tip_speed_mm_s, 0.0);
  const double x = Now().axes.column.x();
  EXPECT_GT(x, 25.0);
  EXPECT_LT(x, 500.0);
  Good(ResumeRun{});
  GoOn(At(3.3));
  Good(HoldRun{});
  GoOn(At(10.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  Good(ResumeRun{});
  GoOn(At(100.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(outside.approach.size(), 2U);

  Good(At1(14));
  GoOn(At(100.3));
  Good(AbortRun{});
  GoOn(At(110.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCancelled);
  EXPECT_EQ(state(), MachineState::kIdle);
  Good(At1(14));
  GoOn(At(110.1));
  Good(EmergencyStop{});
  EXPECT_EQ(state(), MachineState::kAlarm);
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kFailed);
}

// LIVE-6.09: SINGLE and HOLD behind each motion of the approach.
TEST_F(StartAt, SingleAndHoldInTheApproach) {
  Observe({kSquare});
  StartAtStep input = At1(14);
  input.source = StartSource::kPanel;
  Good(ChangeMode{Mode::kSingle});
  Good(input);
  GoOn(At(30.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(outside.approach.size(), 1U);
  Good(ResumeRun{StartSource::kPanel});
  GoOn(At(60.0));
  EXPECT_EQ(outside.approach.size(), 2U);
  EXPECT_THAT(outside.steps, IsEmpty());
  Good(ChangeMode{Mode::kCycle});
  Good(ResumeRun{StartSource::kPanel});
  GoOn(At(90.0));
  EXPECT_EQ(state(), MachineState::kIdle);

  outside.approach.clear();
  Good(input);
  GoOn(At(90.2));
  Good(HoldRun{});
  GoOn(At(120.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(outside.approach.size(), 1U);  // what was under way
}

// LIVE-6.04: an active WORK, unless the beam may stay off until the next one (OPT-6.21), and then
// what is not cut.
TEST_F(StartAt, WhereAWorkIsOn) {
  Observe({kSquare});
  EXPECT_EQ(Refused(At1(11)),
            "CELL-E9426 a WORK is ON there: allow that the beam stays off until the next one; "
            "clean before: 1/9; clean behind: 1/13");
  StartAtStep input = At1(10);
  input.off_until_work_on = true;
  const Result<StartPreview> preview = machine->Preview(input);
  ASSERT_TRUE(preview);
  EXPECT_GT(preview->missing_cut_mm, 75.0);  // two sides of 40 mm, and a corner
  EXPECT_LE(preview->missing_cut_mm, 80.0);
  Good(input);
  GoOn(At(100.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(std::ranges::count(outside.moves, "signal 1"), 1);  // the second WORK ON
  EXPECT_EQ(PreviewOf(Setup({kSquare}), {.at = {1, 14}}).missing_cut_mm, 0.0);
}

// LIVE-6.04: /NEXT and the GOSUB of a timer, open there.
TEST_F(StartAt, WhatIsOpenThere) {
  const std::string beside =
      "COORD ABSOL\nPATH LIN\nSPEED 1\nMOVE (300.,2200.,-350.,0.,0.)/NEXT\nVI[2]=1\nDELAY 1\n"
      "WAIT VI[2]=1\nCALL 2\nVI[3]=1\n";
  EXPECT_THAT(FirstRefusal(PreviewOf(Setup({beside, "VI[4]=1\n"}), {.at = {1, 6}})),
              HasSubstr("CELL-E9426 a motion or a WORK of /NEXT goes on there; clean before: 1/4; "
                        "clean behind: "));
  const std::string timed =
      "TIMER (1.,900)\nDELAY 2\nVI[2]=1\nGOSUB 800\nENDTASK\n800 VI[4]=1\nRETURN\n"
      "900 VI[3]=1\nGOSUB 800\nRETURN\n";
  const RunSetup setup = Setup({timed});
  const auto why = [&](int step, std::uint64_t occurrence = 1) {
    return FirstRefusal(PreviewOf(setup, {.at = {1, step}, .occurrence = occurrence}));
  };
  EXPECT_EQ(why(8),
            "CELL-E9426 control is in a GOSUB of a timer there; clean before: 1/2; clean behind: "
            "1/3");
  EXPECT_THAT(why(6), HasSubstr("GOSUB of a timer"));
  EXPECT_EQ(why(6, 2), "none");  // of the program's own GOSUB
  EXPECT_EQ(why(3), "none");
  EXPECT_THAT(why(0), HasSubstr("CELL-E9426 step 0 is none: they count from 1; clean behind: 1/1"));
  EXPECT_THAT(why(5, 9), HasSubstr("CELL-E9426 step 1/5 is not reached for the 9. time"));
}

// LIVE-6.04, LIVE-2.10: states and sources; LIVE-6.08: what a person has not seen to.
TEST_F(StartAt, IsRefusedByTheMachine) {
  Load({kSquare});
  StartAtStep input = At1(14);
  input.program = 7;
  EXPECT_THAT(Refused(input), HasSubstr("OPT-E7102"));
  input = At1(14);
  input.acknowledged.clear();
  EXPECT_EQ(Refused(input), "CELL-E9421 nobody has seen to clamps");
  input.acknowledged = {"clamps"};
  input.source = StartSource::kPanel;
  EXPECT_THAT(Refused(input), HasSubstr("CELL-E9423"));
  Good(EmergencyStop{});
  EXPECT_THAT(Refused(At1(14)), HasSubstr("OPT-E7610"));
  Good(EmergencyStop{.pressed = false});
  Good(Acknowledge{.alarm = 1});
  Good(SwitchPower{false});
  EXPECT_THAT(Refused(At1(14)), HasSubstr("CELL-E9424"));
  Good(SwitchPower{true});
  EXPECT_EQ(state(), MachineState::kNotZeroed);
  EXPECT_THAT(Refused(At1(14)), HasSubstr("OPT-E7310"));
}

// LIVE-6.07: a motion of the approach that leaves the travel, with axis and excess.
TEST_F(StartAt, TheWayLeavesTheTravel) {
  RunSetup setup = Setup({kSquare});
  ASSERT_TRUE(setup.parameters.Set("TRAVEL_Z_MAX", -45.0));
  ASSERT_TRUE(setup.parameters.Set("SAFE_Z", -40.0));
  const StartPreview preview = PreviewOf(setup, {.at = {1, 14}});
  EXPECT_THAT(FirstRefusal(preview),
              HasSubstr("CELL-E9427 Z of the target of motion 1 of the approach leaves its travel "
                        "by 5.000 mm; clean before: 1/13; clean behind: 1/15"));
  ASSERT_FALSE(preview.approach[0].beyond.empty());
  EXPECT_EQ(preview.approach[0].beyond[0].axis, 2);
  EXPECT_NEAR(preview.approach[0].beyond[0].excess, 5.0, 1e-9);
  ASSERT_TRUE(setup.parameters.Set("SAFE_Z", -60.0));
  EXPECT_EQ(FirstRefusal(PreviewOf(setup, {.at = {1, 14}})), "none");
}

// LIVE-6.06: the first motion begins where the machine stands: PTP and LIN only, inside the travel.
TEST_F(StartAt, StartsDirectly) {
  Observe({kSquare});
  StartAtStep input = At1(13);
  input.way = ApproachWay::kDirect;
  const Result<StartPreview> preview = machine->Preview(input);
  ASSERT_TRUE(preview);
  EXPECT_THAT(preview->approach, IsEmpty());
  EXPECT_EQ(Row(preview->differences, "pose")->action, StartAction::kNone);
  Good(input);
  GoOn(At(60.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_THAT(outside.approach, IsEmpty());
  EXPECT_EQ(outside.moves.front().substr(0, 4), "LIN ");

  const std::string curve =
      "COORD ABSOL\nPATH LIN\nMOVE (500.,2200.,-350.,0.,0.)\nPATH CIR\n"
      "MOVE (560.,2200.,-350.,0.,0.)/VIA (530.,2230.,-350.,0.,0.)\nPATH HOLE (10.)\n"
      "MOVE (560.,2200.,-350.,0.,0.)/VIA (560.,2200.,-300.,0.,0.)\nPATH LIN\n"
      "MOVE (560.,2200.,-1700.,0.,1.4)\n";
  const auto why = [&](int step) {
    return FirstRefusal(PreviewOf(Setup({curve}), {.at = {1, step}}, false, ApproachWay::kDirect));
  };
  EXPECT_EQ(why(3), "none");
  EXPECT_THAT(why(4), HasSubstr("CELL-E9427 the first motion is CIR"));
  EXPECT_THAT(why(6), HasSubstr("CELL-E9427 the first motion is HOLE"));
  EXPECT_THAT(why(8), HasSubstr("CELL-E9427 Z of the target of the first motion leaves its travel "
                                "by "));
  const auto turned = [&](const std::string& angles) {
    const std::string program =
        "COORD ABSOL\nPATH LIN\nMOVE (500.,2200.,-350.,0.,0.)\n"
        "MOVE (560.,2200.,-350.," +
        angles + ")\n";
    return FirstRefusal(PreviewOf(Setup({program}), {.at = {1, 4}}, false, ApproachWay::kDirect));
  };
  EXPECT_THAT(turned("13.,0."),
              HasSubstr("A of the target of the first motion leaves its travel by "
                        "0.400 rad"));
  EXPECT_THAT(turned("0.,3."), HasSubstr("B of the target of the first motion leaves its travel by "
                                         "0.600 rad"));
}

// LIVE-6.06: the axes by themselves are no curve, and one that comes behind them is none of theirs;
// where nothing moves any more nothing speaks against it.
TEST_F(StartAt, StartsDirectlyWithTheAxesByThemselves) {
  const RunSetup setup =
      Setup({"COORD ABSOL\nPATH LIN\nMOVE (500.,2200.,-350.,0.,0.)\nPATH PTP\n"
             "MOVE (560.,2200.,-350.,0.,0.)\nPATH CIR\n"
             "MOVE (620.,2200.,-350.,0.,0.)/VIA (590.,2230.,-350.,0.,0.)\nVI[1]=1\n"});
  for (const int step : {4, 5, 8}) {
    const StartPreview preview = PreviewOf(setup, {.at = {1, step}}, false, ApproachWay::kDirect);
    EXPECT_EQ(FirstRefusal(preview), "none") << step;
  }
}

// LIVE-6.01: of a run that was cut off: the values that it had, and the inputs of now.
TEST_F(StartAt, WithTheBaseOfAnInterruptedRun) {
  Observe({"WAIT IL[5]\nVR[3]=VR[3]+1.\nDELAY 1\nVL[1]=IL[5]\nVI[9]=1\n"});
  StartAtStep input = At1(3);
  EXPECT_THAT(Refused(input), HasSubstr("waits for what does not come"));
  auto standing = *family_.NewStanding(parameters(), "");
  standing->WriteVariable("VR[3]", 40.0);
  input.base = StartBase{.machine_state = standing->Save(),
                         .inputs = {{At(1.0), InputKind::kLogical, 5, 1.0}}};
  Good(input);
  GoOn(At(60.0));
  EXPECT_EQ(Value("VR[3]"), "41.0");
  EXPECT_EQ(Value("VL[1]"), "0");  // IL[5] as it is now
}

// LIVE-6.01, LIVE-6.09: what is left of a TIMER there is left at the entry, however long the way.
TEST_F(StartAt, TimersHaveWhatTheyHadLeft) {
  const RunSetup setup = Setup(
      {"TIMER (3.,900)\nDELAY 1\nVI[2]=1\nDELAY 4\nVI[4]=VI[3]\nENDTASK\n900 VI[3]=1\nRETURN\n"});
  const StepReach reach = Reach(setup, {.at = {1, 4}});
  RunObserver nobody;
  const auto entered = Entered(setup, reach, nobody);
  entered->Apply({.at = entered->state().time, .kind = InputKind::kStart, .value = 1.0});
  while (entered->Advance(entered->state().time + At(60.0)) != RunPhase::kFinished) {
  }
  EXPECT_EQ(entered->ReadVariable("VI[4]")->text, "1");
}

// LIVE-6.05, OPT-3.38: what a WORK waits for in the background is looked at from the entry on.
TEST_F(StartAt, AWorkInTheBackgroundWaitsForTheEntry) {
  Observe(
      {"WORKDEF 1,0 (8.,75.,0.,50.)\nCOORD ROBOT\nMOVE (300.,2200.,-80.,0.,0.)\n"
       "WORK 1,0/ON/END (IL[20])\nVI[2]=1\nVL[1]=IL[87]\nDELAY 1\nVL[2]=IL[87]\n"});
  Good(ChangeInput{.kind = InputKind::kLogical, .index = 20, .value = 1.0});
  StartAtStep input = At1(5);
  input.off_until_work_on = true;
  input.base = StartBase{.machine_state = StandingState()};  // there IL[20] was 0
  Good(input);
  GoOn(At(60.0));
  EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
  EXPECT_EQ(Value("VL[1]"), "1");
  EXPECT_EQ(Value("VL[2]"), "0");
  EXPECT_EQ(std::ranges::count(outside.moves, "signal 1"), 0);
}

// LIVE-6.09: whatever keys come in the approach and behind it, it does the same.
TEST_F(StartAt, IsNotDisturbedByKeys) { StartTest::IsNotDisturbedByKeys({kSquare}, At1(14)); }

// A preview that was made for it is used as it is; the same is told whatever the slices.
TEST_F(StartAt, IsTheSameHoweverItIsDriven) {
  std::vector<std::string> told;
  for (const double slice : {100.0, 0.037, 0.2}) {
    heard.told.clear();
    Load({kSquare});
    StartAtStep input = At1(14);
    if (slice < 0.1)
      input.prepared = std::make_shared<const StartPreview>(*machine->Preview(input));
    Good(input);
    while (machine->time() < At(100.0)) GoOn(std::min(At(100.0), machine->time() + At(slice)));
    EXPECT_EQ(Over().outcome.kind, OutcomeKind::kCompleted);
    if (told.empty()) told = heard.told;
    EXPECT_EQ(heard.told, told) << slice;
  }
  EXPECT_THAT(told, Not(IsEmpty()));
}

// LIVE-6.09: breakpoints that are set hold for a run that begins at a step, too.
TEST_F(StartAt, HasTheBreakpointsThatAreSet) {
  Load({"DELAY 1\nVI[1]=1\nVI[2]=1\nDELAY 5\n"});
  Good(SetBreakpoints{.breakpoints = {{.at = {1, 3}}}});
  Good(At1(2));
  GoOn(At(60.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Now().halted_by, HaltReason::kBreakpoint);
}

// LIVE-6.09: on its way the run is at the step where it begins.
TEST_F(StartAt, IsAtItsStepOnTheWay) {
  Load({kSquare});
  Good(At1(14));
  GoOn(At(0.2));
  ASSERT_TRUE(Now().approaching);
  EXPECT_EQ(Now().place.program, 1);
  EXPECT_EQ(Now().place.step, 14);
}

// LIVE-6.03: another override than the run had, and a corner that the whole run passes, are told;
// nothing is done about them.
TEST_F(StartAt, TellsOverrideAndPassage) {
  Load({kSquare});
  Good(ChangeOverride{50.0});
  StartAtStep input = At1(13);
  input.base = StartBase{.machine_state = StandingState(), .override_percent = 80.0};
  const Result<StartPreview> preview = machine->Preview(input);
  ASSERT_TRUE(preview);
  const StartDifference* changed = Row(preview->differences, "override");
  ASSERT_NE(changed, nullptr);
  EXPECT_EQ(*changed, (StartDifference{"override", "80", "50", StartAction::kNone}));
  EXPECT_EQ(Row(preview->differences, "passage"), nullptr);
  const StartPreview passed = PreviewOf(Setup({kSquare}), {.at = {1, 11}});
  const StartDifference* passage = Row(passed.differences, "passage");
  ASSERT_NE(passage, nullptr);
  EXPECT_EQ(*passage, (StartDifference{"passage", "passed", "stop", StartAction::kNone}));
}

// LIVE-6.03: what is on one side alone is a difference, too; what is the same is none.
TEST(StartDifferences, OfBothSides) {
  const std::vector<StateItem> there = {{"same", "1", StartAction::kSet},
                                        {"gone", "2", StartAction::kMove},
                                        {"other", "3", StartAction::kAsk}};
  const std::vector<StateItem> now = {{"new", "5", StartAction::kSwitch},
                                      {"other", "4", StartAction::kSet},
                                      {"same", "1", StartAction::kSet}};
  EXPECT_THAT(DifferencesOf(there, now),
              ElementsAre(StartDifference{"gone", "2", "", StartAction::kMove},
                          StartDifference{"other", "3", "4", StartAction::kAsk},
                          StartDifference{"new", "", "5", StartAction::kSwitch}));
}

// LIVE-6.06: what cannot begin where the machine stands is refused before anything moves. From home
// the via point lies on the line to the target, behind it; from (500, 2100) all is well.
TEST_F(StartAt, ADirectStartThatCannotBegin) {
  const RunSetup setup =
      Setup({"COORD ABSOL\nPATH LIN\nMOVE (500.,2100.,-350.,0.,0.)\nPATH CIR\n"
             "MOVE (560.,2201.2,-350.,0.,0.)/VIA (600.,2201.2,-350.,0.,0.)\nVI[1]=1\n"});
  EXPECT_THAT(FirstRefusal(PreviewOf(setup, {.at = {1, 5}}, false, ApproachWay::kDirect)),
              HasSubstr("CELL-E9427 the first motion cannot begin where the machine stands: "));
}

}  // namespace
}  // namespace rmlcell::machine
