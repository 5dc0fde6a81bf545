// Breakpoints of a machine: many, on the way, with conditions and passes (live.md 2.10).
#include "engine/machine/machine.h"
#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A program of ten rounds: step 2 is in the loop.
constexpr const char* kLoop = "VI[1] = 0\n10 VI[1] = VI[1] + 1\nDELAY 1\nIF VI[1] < 10 THEN 10\n";

TEST_F(MachineTest, BreakpointsAreManyAndHaveConditions) {
  Load({kLoop});
  Good(SetBreakpoints{{{.at = {1, 1}}, {.at = {1, 2}, .condition = "VI[1] = 3"}}});
  Start();
  GoOn(At(0.5));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().run.halted_by, HaltReason::kBreakpoint);
  EXPECT_EQ(Value("VI[1]"), "0");
  Good(ResumeRun{});
  GoOn(At(50.0));
  // The condition is looked at before the step: 3 is what it finds, 4 what it leaves.
  EXPECT_EQ(Value("VI[1]"), "4");
  EXPECT_EQ(heard.halts, (std::vector<int>{1, 2}));
  // Cleared on the way; another, from its second pass on.
  Good(SetBreakpoints{{{.at = {1, 3}, .from_pass = 2}}});
  Good(ResumeRun{});
  GoOn(At(100.0));
  EXPECT_EQ(Value("VI[1]"), "5");
  EXPECT_EQ(heard.halts, (std::vector<int>{1, 2, 3}));
  Good(SetBreakpoints{});
  Good(ResumeRun{});
  GoOn(At(200.0));
  EXPECT_EQ(Value("VI[1]"), "10");
  EXPECT_EQ(heard.halts.size(), 3U);
}

// Set again on the way a breakpoint goes on counting, and stays due; a cleared one is due no more.
TEST_F(MachineTest, BreakpointsAreReplacedOnTheWay) {
  Load({"VI[1] = 1\nWAIT IL[5]\nVI[1] = 2\nVI[1] = 3\n"});
  Good(SetBreakpoints{{{.at = {1, 2}}}});
  Start();
  GoOn(At(1.0));
  Good(SetBreakpoints{{{.at = {1, 2}}, {.at = {1, 4}}}});
  Good(ChangeInput{.kind = InputKind::kLogical, .index = 5, .value = 1.0});
  GoOn(At(2.0));
  EXPECT_EQ(heard.halts, std::vector<int>{2});
  Good(SetBreakpoints{{{.at = {1, 2}}, {.at = {1, 4}}}});  // it halts there once
  Good(ResumeRun{});
  GoOn(At(3.0));
  EXPECT_EQ(heard.halts, std::vector<int>{2});  // step 4 is the last: the program is over

  heard.halts.clear();
  Load({kLoop});
  Good(SetBreakpoints{{{.at = {1, 2}, .from_pass = 5}}});
  Start();
  GoOn(At(2.5));  // in the third round
  Good(SetBreakpoints{{{.at = {1, 2}, .from_pass = 5}}});
  GoOn(At(20.0));
  EXPECT_EQ(Value("VI[1]"), "5");

  Load(
      {"COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\nVI[1] = 1\nVI[1] = 2\n"});
  Good(SetBreakpoints{{{.at = {1, 4}}}});
  Start();
  GoOn(At(2.0));
  Good(SetBreakpoints{});
  GoOn(At(100.0));
  EXPECT_EQ(state(), MachineState::kIdle);
}

// run.h: one that comes late halts behind what was read ahead.
TEST_F(MachineTest, BreakpointsThatComeLate) {
  const std::string single =
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)\nVI[1] = 1\nVI[1] = 2\n";
  Load({single});
  Start();
  GoOn(At(2.0));
  Good(SetBreakpoints{{{.at = {1, 4}}}});
  GoOn(At(100.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(Value("VI[1]"), "0");
  std::string chain = "COORD ABSOL\nPATH LIN\nSPEED 20\n";
  for (int i = 1; i <= 4; ++i)
    chain +=
        "MOVE (" + std::to_string(i * 100) + ".,2201.2,-350.,0.,0.)" + (i < 4 ? "/FLY\n" : "\n");
  chain += "VI[1] = 1\nVI[1] = 2\n";
  for (int step = 4; step <= 7; ++step) {
    heard.halts.clear();
    Load({chain});
    Start();
    GoOn(At(0.5));
    Good(SetBreakpoints{{{.at = {1, step}}}});
    GoOn(At(100.0));
    EXPECT_EQ(heard.halts.size(), 1U) << step;
    EXPECT_EQ(machine->status().run.halted_by, HaltReason::kBreakpoint) << step;
    EXPECT_EQ(Value("VI[1]"), "0") << step;
    Good(ResumeRun{});
    GoOn(At(200.0));
    EXPECT_EQ(state(), MachineState::kIdle) << step;
  }
}

// A /FLY target with a breakpoint is reached exactly: OPT-6.07. What only watches changes nothing.
TEST_F(MachineTest, BreakpointsOnChains) {
  const std::string chain =
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (521.02, 2201.2, -350., 0., 0.)/FLY\n"
      "MOVE (521.02, 2301.2, -350., 0., 0.)\n";
  Load({chain});
  Start();
  GoOn(At(100.0));
  const std::vector<std::string> plain = std::exchange(heard.told, {});
  const SimTime lasted = Over().lasted;

  Load({chain});
  Good(SetBreakpoints{{{.at = {1, 4}, .condition = "VI[5] > 0"}}});
  Start();
  GoOn(At(100.0));
  EXPECT_EQ(heard.told, plain);
  EXPECT_EQ(Over().lasted, lasted);

  Load({chain});
  Good(WriteVariable{"VI[5]", 1.0});
  Good(SetBreakpoints{{{.at = {1, 4}, .condition = "VI[5] > 0"}}});
  Start();
  GoOn(At(100.0));
  EXPECT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->status().run.tip.tip.x(), 521.02F);  // single precision: OPT-B.37
  EXPECT_EQ(machine->status().run.tip.tip.y(), 2201.2F);
}

TEST_F(MachineTest, BreakpointsThatAreNone) {
  Load({kLoop});
  const auto refused = [&](const Breakpoint& breakpoint) {
    return Refused(SetBreakpoints{{breakpoint}});
  };
  EXPECT_THAT(refused({.at = {1, 0}}), HasSubstr("stands in no program"));
  EXPECT_THAT(refused({.at = {0, 1}}), HasSubstr("stands in no program"));
  for (const char* condition : {"VI[1] >", "VI[1] > 1 THEN 20", "VI[1]; VI[2]", "VI[1]\nSTOP",
                                "VI[100] > 1", "NAME > 3", "VL[1] + 1"}) {
    EXPECT_THAT(refused({.at = {1, 1}, .condition = condition}),
                HasSubstr("CELL-E9003 the condition"))
        << condition;
  }
  EXPECT_THAT(machine->breakpoints(), IsEmpty());
}

// What is taken can be read back.
TEST_F(MachineTest, BreakpointsHaveLimits) {
  Load({kLoop});
  EXPECT_THAT(Refused(SetBreakpoints{{{.at = {1, 1}, .from_pass = std::uint64_t{1} << 63}}}),
              HasSubstr("pass"));
  EXPECT_THAT(Refused(SetBreakpoints{{{.at = {1, 1}, .from_pass = 0}}}), HasSubstr("pass"));
  std::vector<Breakpoint> many(kBreakpointsMax, Breakpoint{.at = {1, 1}});
  Good(SetBreakpoints{many});
  const std::string saved = machine->Save();
  many.push_back({.at = {1, 2}});
  EXPECT_EQ(Refused(SetBreakpoints{many}), "CELL-E9003 at most 100 breakpoints are set");
  Load({kLoop}, saved);
  EXPECT_EQ(machine->breakpoints().size(), kBreakpointsMax);
}

// LIVE-3.23: at most 16 KiB, with every variable used and as many breakpoints as there may be.
TEST_F(MachineTest, AMarkIsSmall) {
  std::string all;
  for (int i = 1; i <= 97; ++i) {
    const std::string index = "[" + std::to_string(i) + "] = ";
    all += "VR" + index + "-1.234567\nVI" + index + "-12345\nVL" + index + "ON\n";
    if (i >= 10 && i <= 64) all += "OL" + index + "ON\nOA" + index + "-1.234567\n";
  }
  std::string condition = "VR[97] > -1.234567 AND VR[96] > -1.234567 AND VI[97] > -12345";
  condition.resize(kBreakpointConditionMax, ' ');
  Load({all});
  Start();
  GoOn(At(100.0));
  EXPECT_EQ(Value("VI[97]"), "-12345");
  std::vector<Breakpoint> many;
  for (int i = 1; i <= static_cast<int>(kBreakpointsMax); ++i)
    many.push_back({.at = {99, 9'900 + i}, .condition = condition, .from_pass = 1'000'000'000'000});
  Good(SetBreakpoints{many});
  EXPECT_LE(machine->Save().size(), 16U * 1024U);
  many[0].condition = std::string(kBreakpointConditionMax + 1, ' ');
  EXPECT_EQ(Refused(SetBreakpoints{many}), "CELL-E9003 a condition has at most 80 bytes");
}

// A dry run ends at a step of a slot; without one there is none.
TEST_F(MachineTest, ADryRunEndsAtAStep) {
  Load({kLoop});
  for (const ProgramStep until : {ProgramStep{1, 1}, ProgramStep{99, 1}}) {
    Good(SetSimulation{until});
    EXPECT_EQ(machine->simulation_until(), until);
  }
  for (const ProgramStep until : {ProgramStep{0, 1}, ProgramStep{100, 1}, ProgramStep{1, 0}}) {
    EXPECT_EQ(Refused(SetSimulation{until}),
              "CELL-E9003 a dry run ends at a step from 1 on of a program of 1 to 99");
    EXPECT_EQ(machine->simulation_until(), (ProgramStep{99, 1}));
  }
  Good(SetSimulation{});
  EXPECT_EQ(machine->simulation_until(), std::nullopt);
}

// LIVE-3.16, OPT-6.24, OPT-6.28: halted in a dry run it is seen to be dry, and what the program
// switches is an image, not at the terminals.
TEST_F(MachineTest, ADryRunIsSeenToBeDry) {
  Load({"OL[3] = ON\nOA[2] = 1.5\nDELAY 1\nDELAY 1\nWAIT IL[5]\n"});
  Good(SetSimulation{.until = ProgramStep{1, 4}});
  Good(SetBreakpoints{{{.at = {1, 3}}}});
  Start();
  GoOn(At(0.5));
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_TRUE(machine->status().run.dry);
  EXPECT_EQ(Value("OL[3]"), "1");
  EXPECT_THAT(machine->outputs().on, IsEmpty());
  Good(ResumeRun{});
  GoOn(At(1.0));  // in the DELAY that is real
  EXPECT_FALSE(machine->status().run.dry);
  const std::vector<OutputNow> on = {{"OL[3]", 1.0}, {"OA[2]", 1.5}};
  EXPECT_EQ(machine->outputs().on, on);
  Good(AbortRun{});
  GoOn(At(2.0));
  EXPECT_FALSE(machine->status().run.dry);
  EXPECT_EQ(machine->outputs().on, on);  // no end of a run switches them off: OPT-B.54
}

// LIVE-3.16: what the laser does now: its power, the schedule that is selected, shutter and table.
TEST_F(MachineTest, TheLaserIsSeenAtWork) {
  Load({"WORKDEF 2,1 (7)\nWORK 2,1/ON\nWORKDEF 0,0\nWORK 0,0/ON\nDELAY 5\nWORK 0,0/OFF\n"});
  LaserSchedule schedule;
  schedule.number = 7;
  schedule.power_percent = 60.0;
  Good(SetSchedules{.schedules = std::vector{schedule}});
  EXPECT_EQ(machine->outputs().power_percent, 0.0);
  Start();
  GoOn(At(3.0));
  const MachineOutputs cutting = machine->outputs();
  EXPECT_EQ(cutting.power_percent, 60.0);
  EXPECT_EQ(cutting.laser_schedule, 7);
  EXPECT_THAT(cutting.on, ElementsAre(OutputNow{"shutter", 1.0}));
  GoOn(At(60.0));
  EXPECT_EQ(machine->outputs().power_percent, 0.0);
  EXPECT_EQ(machine->outputs().laser_schedule, 7);
  EXPECT_THAT(machine->outputs().on, IsEmpty());
}

// LIVE-7.07: how often the program was carried out to its end; and up to where it is dry.
TEST_F(MachineTest, ARunSaysHowFarItIs) {
  Load({"DELAY 1\nDELAY 1\n"});
  Good(ChangeMode{Mode::kRepeat});
  Good(SetSimulation{.until = ProgramStep{1, 2}});
  Good(SetBreakpoints{{{.at = {1, 1}}}});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  GoOn(At(0.1));
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_EQ(machine->simulation_until(), (ProgramStep{1, 2}));
  Good(SetBreakpoints{});
  Good(ResumeRun{.source = StartSource::kPanel});
  GoOn(At(0.6));  // the first round has one DELAY that is real
  EXPECT_FALSE(machine->simulation_until());
  EXPECT_EQ(machine->status().run.executions, 0);
  GoOn(At(5.6));
  EXPECT_EQ(machine->status().run.executions, 3);
}

}  // namespace
}  // namespace rmlcell::machine
