// A start at a step of a run that was cut off: with what it began with and what came meanwhile
// (live.md 6.01), and the gates (2.11).
#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

class StartBaseTest : public StartTest {
 protected:
  // As a host finds it again: what the machine keeps, standing.
  std::unique_ptr<Machine> Found() {
    auto found = Machine::Make(family_, parameters(), machine->memory(), machine->Save(), nobody_);
    EXPECT_TRUE(found);
    return *std::move(found);
  }
  // When the step began last, in the time of the run.
  SimTime Begun(const std::string& step) const {
    SimTime begun{-1};
    for (const std::string& line : heard.told) {
      if (line.find(" " + step + " step") != std::string::npos)
        begun = SimTime(std::stoll(line.substr(0, line.find(' '))));
    }
    return begun;
  }
  static std::string There(const StartPreview& preview, std::string_view item) {
    const auto found = std::ranges::find(preview.there, item, &StateItem::name);
    return found == preview.there.end() ? "none" : found->value;
  }
  static ChangeInput Logical(int index, bool on) {
    return {.index = index, .value = on ? 1.0 : 0.0};
  }
  StartAtStep Again(int step) const {
    StartAtStep start = At1(step);
    start.base = machine->base();
    return start;
  }

  RunObserver nobody_;
};

// LIVE-6.01: a pulse that is over, a variable that was counted on, a HOLD, a breakpoint at which it
// stood for long: the run comes to the step when it did, with the values that it had.
TEST_F(StartBaseTest, HasTheValuesThatTheRunHad) {
  Load({"VI[1]=VI[1]+1\nWAIT IL[20]\nVI[2]=VI[1]\nDELAY 10\nVI[3]=7\nDELAY 5\n"});
  Good(SetBreakpoints{.breakpoints = {{.at = {1, 1}}}});
  Start();
  GoOn(At(100.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  const SimTime stood = At(100.0) - Begun("1/1");
  Good(ResumeRun{});
  GoOn(At(103.0));
  Good(Logical(20, true));
  GoOn(At(104.0));
  Good(Logical(20, false));
  GoOn(At(106.0));
  Good(StopRun{});
  GoOn(At(126.0));
  Good(ResumeRun{});
  GoOn(At(130.0));
  ASSERT_TRUE(machine->base());
  const std::vector<InputChange>& inputs = machine->base()->inputs;
  ASSERT_EQ(inputs.size(), 4U);
  EXPECT_EQ(inputs[0].kind, InputKind::kLogical);
  EXPECT_EQ(inputs[1].at - inputs[0].at, At(1.0));
  EXPECT_EQ(inputs[2].kind, InputKind::kStop);
  EXPECT_EQ(inputs[3].kind, InputKind::kStart);
  EXPECT_EQ(inputs[3].at - inputs[2].at, At(20.0));

  const auto found = Found();
  const Result<StartPreview> preview = found->Preview(Again(5));
  ASSERT_TRUE(preview) << preview.error().detail;
  ASSERT_TRUE(preview->may_begin()) << preview->refusals[0].detail;
  EXPECT_EQ(There(*preview, "VI[1]"), "1");
  EXPECT_EQ(There(*preview, "VI[2]"), "1");
  GoOn(At(200.0));
  ASSERT_GT(Begun("1/5"), At(126.0));
  // Its breakpoint is behind the step: a step of nothing but a calculation.
  const SimTime late = Begun("1/5") - stood - preview->run_time;
  EXPECT_LE(late, At(0.0));
  EXPECT_GT(late, At(-0.1));

  StartAtStep as_it_stands = At1(5);
  const Result<StartPreview> other = found->Preview(as_it_stands);
  ASSERT_TRUE(other);
  ASSERT_FALSE(other->may_begin());
  EXPECT_THAT(other->refusals[0].detail, HasSubstr("waits for what does not come"));
}

// LIVE-6.01: the default occurrence is the one that the run was in.
TEST_F(StartBaseTest, KnowsHowOftenItHadComeThere) {
  Load({"10 VI[3]=VI[3]+1\nDELAY 1\nIF VI[3] < 100 THEN 10\nDELAY 3\n"});
  Good(SetBreakpoints{.breakpoints = {{.at = {1, 3}, .from_pass = 7}}});
  Start();
  GoOn(At(60.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  Good(SetBreakpoints{});
  Good(ResumeRun{});
  GoOn(At(65.0));
  Good(HoldRun{});
  GoOn(At(75.0));
  Good(ResumeRun{});
  GoOn(At(90.4));
  const auto passes = std::ranges::count_if(heard.told, [](const std::string& line) {
    return line.find(" 1/2 step") != std::string::npos;
  });
  ASSERT_GT(passes, 15);
  const StartAtStep start = Again(2);
  const auto in = Found()->OccurrenceAt(start, machine->base_time());
  ASSERT_TRUE(in) << in.error().detail;
  EXPECT_EQ(*in, static_cast<std::uint64_t>(passes));
}

// LIVE-6.01: cut off once more behind its entry, it still knows the time of the whole run, in which
// the way there takes none.
TEST_F(StartBaseTest, ARunThatWasEnteredCanBeCutOffAgain) {
  const char* program =
      "COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (521.02, 2201.2, -380., 0., 0.)\nDELAY 10\n"
      "VI[1]=VI[1]+1\nDELAY 20\n";
  Load({program});
  Start();
  GoOn(At(5.0));
  const StartAtStep start = Again(5);
  machine = Found();
  const Result<StartPreview> preview = machine->Preview(start);
  ASSERT_TRUE(preview && preview->may_begin());
  Good(start);
  while (machine->status().run.approaching) GoOn(machine->time() + At(0.01));
  const SimTime approached = machine->status().run.approached;
  EXPECT_GT(approached, At(1.0));
  const SimTime begun = machine->status().open->begun;
  GoOn(begun + preview->run_time + approached + At(3.0));
  EXPECT_EQ(machine->base_time(), preview->run_time + At(3.0));
  Good(Logical(7, true));
  ASSERT_EQ(machine->base()->inputs.size(), 1U);
  EXPECT_EQ(machine->base()->inputs[0].at, preview->run_time + At(3.0));
  EXPECT_EQ(machine->base()->machine_state, start.base->machine_state);
}

// LIVE-6.01, LIVE-5.08: a START that ended a STOP behind the step is not for who comes to the step:
// he would go on to the end of the program, and nothing of it would be cut.
TEST_F(StartBaseTest, AKeyBehindTheStepIsNotForIt) {
  Load({"VI[1]=1\nDELAY 2\nVI[2]=1\nDELAY 10\nVI[3]=1\nDELAY 30\n"});
  Start();
  GoOn(At(5.0));  // in step 4
  Good(StopRun{});
  GoOn(At(8.0));
  Good(ResumeRun{});
  GoOn(At(9.0));
  const SimTime until = machine->base_time();
  const auto found = Found();
  for (const int step : {1, 2, 3, 4}) {
    const Result<StartPreview> preview = found->Preview(Again(step));
    ASSERT_TRUE(preview) << preview.error().detail;
    EXPECT_LT(preview->run_time, until) << step;
    EXPECT_EQ(preview->reach.facts.place.step, step);
    EXPECT_EQ(There(*preview, "VI[3]"), "0") << step;
    EXPECT_EQ(There(*preview, "VI[2]"), step < 4 ? "0" : "1") << step;
  }
}

// LIVE-6.01: what was written by hand while it ran is there again, when it was written: the loop
// ends in the pass in which it did, and no work is left out.
TEST_F(StartBaseTest, HasWhatWasWrittenMeanwhile) {
  Load({"VI[0]=0\n10 VI[0]=VI[0]+1\nDELAY 2\nVI[2]=VI[2]+VI[5]\nIF VI[0] < 6 THEN 10\nDELAY 30\n"});
  Good(WriteVariable{.name = "VI[5]", .value = 1.0});
  Start();
  GoOn(At(5.0));  // in the third pass
  Good(WriteVariable{.name = "VI[5]", .value = 10.0});
  GoOn(At(9.0));
  Good(WriteVariable{.name = "VI[0]", .value = 9.0});
  GoOn(At(14.0));
  const InputScript& inputs = machine->base()->inputs;
  ASSERT_EQ(inputs.size(), 2U);
  EXPECT_EQ(inputs[0].kind, InputKind::kVariable);
  EXPECT_EQ(inputs[0].name, "VI[5]");
  EXPECT_EQ(inputs[1].at - inputs[0].at, At(4.0));
  const auto value = [&](std::string_view name) { return machine->ReadVariable(name)->text; };
  const std::string counted = value("VI[0]");
  const std::string sum = value("VI[2]");
  EXPECT_EQ(counted, "9");
  EXPECT_NE(sum, "5");

  const auto found = Found();
  const Result<StartPreview> preview = found->Preview(Again(6));
  ASSERT_TRUE(preview) << preview.error().detail;
  EXPECT_EQ(There(*preview, "VI[0]"), counted);
  EXPECT_EQ(There(*preview, "VI[2]"), sum);
}

// LIVE-6.01: what comes while it stands at a breakpoint comes there, and what comes on the way to
// an entry comes at the entry.
TEST_F(StartBaseTest, InputsOfAHaltComeInTheHalt) {
  Load({"DELAY 2\nVI[1]=1\nDELAY 5\nVI[2]=2\nDELAY 30\n"});
  Good(SetBreakpoints{.breakpoints = {{.at = {1, 2}}}});
  Start();
  GoOn(At(50.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  const SimTime halted = machine->base_time();
  EXPECT_LT(halted, At(3.0));
  Good(Logical(3, true));
  GoOn(At(60.0));
  Good(ResumeRun{});
  GoOn(At(61.0));
  Good(HoldRun{});
  const std::vector<InputChange>& inputs = machine->base()->inputs;
  ASSERT_EQ(inputs.size(), 2U);
  EXPECT_EQ(inputs[0].at, halted);
  EXPECT_EQ(inputs[1].at, halted + At(1.0));
}

TEST_F(StartBaseTest, TheWayToAnEntryTakesNoTime) {
  Load({"COORD ABSOL\nPATH LIN\nSPEED 20\nMOVE (521.02, 2201.2, -380., 0., 0.)\nDELAY 10\n"});
  Start();
  GoOn(At(5.0));
  const StartAtStep start = Again(5);
  machine = Found();
  const Result<StartPreview> preview = machine->Preview(start);
  ASSERT_TRUE(preview && preview->may_begin());
  Good(start);
  GoOn(machine->time() + At(0.5));
  ASSERT_TRUE(machine->status().run.approaching);
  EXPECT_EQ(machine->base_time(), preview->run_time);
  Good(Logical(7, true));
  Good(StopRun{});
  GoOn(machine->time() + At(3.0));
  Good(ResumeRun{});
  ASSERT_EQ(machine->base()->inputs.size(), 1U);
  EXPECT_EQ(machine->base()->inputs[0].at, preview->run_time);
  while (machine->status().run.approaching) GoOn(machine->time() + At(0.01));
  EXPECT_LT(machine->base_time() - preview->run_time, At(0.02));
}

// Each with its time in the run, its place and its value; what changed nothing is none.
TEST_F(StartBaseTest, KeepsInputsAsTheyCame) {
  Load({"DELAY 100\n"});
  GoOn(At(10.0));
  Start();
  GoOn(At(11.0));
  Good(ChangeOverride{50.0});
  GoOn(At(12.0));
  Good(Logical(3, true));
  Good(MoveDoor{.open = false});  // it is
  GoOn(At(13.0));
  Good(WriteVariable{.name = "VI[1]", .value = 7.0});
  GoOn(At(14.0));
  Good(StopRun{});
  GoOn(At(16.0));
  Good(ResumeRun{});
  const InputScript inputs = {
      {.at = At(1.0), .kind = InputKind::kOverride, .value = 50.0},
      {.at = At(2.0), .kind = InputKind::kLogical, .index = 3, .value = 1.0},
      {.at = At(3.0), .kind = InputKind::kVariable, .value = 7.0, .name = "VI[1]"},
      {.at = At(4.0), .kind = InputKind::kStop},
      {.at = At(6.0), .kind = InputKind::kStart}};
  EXPECT_EQ(machine->base()->inputs, inputs);
}

TEST_F(StartBaseTest, KeepsTheDoorAsItWent) {
  Load({"DELAY 100\n"});
  GoOn(At(10.0));
  Start();
  GoOn(At(11.0));
  Good(MoveDoor{.open = true});
  EXPECT_EQ(machine->base()->inputs,
            (InputScript{{.at = At(1.0), .kind = InputKind::kDoor, .value = 1.0}}));
}

// What a run stood at its breakpoints is no time of the next one.
TEST_F(StartBaseTest, EachRunCountsAnew) {
  Load({"DELAY 2\nVI[1]=1\nDELAY 30\n"});
  Good(SetBreakpoints{.breakpoints = {{.at = {1, 1}}}});
  Start();
  GoOn(At(10.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  Good(ResumeRun{});
  GoOn(At(12.0));
  EXPECT_LT(machine->base_time(), At(5.0));
  Good(AbortRun{});
  GoOn(At(13.0));
  Good(SetBreakpoints{});
  Start();
  GoOn(At(18.0));
  EXPECT_EQ(machine->base_time(), At(5.0));
}

// LIVE-6.01: an input that came when the step began came before it, and is part of what it began
// with, when it is cut off again.
TEST_F(StartBaseTest, WhatCameAtTheEntryStays) {
  Load({"DELAY 2\nVI[1]=1\nDELAY 30\n"});
  Start();
  GoOn(At(10.0));
  StartAtStep start = Again(3);
  machine = Found();
  const SimTime begins = machine->Preview(start)->run_time;
  start.base->inputs = {{.at = begins - SimTime(1), .index = 3, .value = 1.0},
                        {.at = begins, .index = 4, .value = 1.0},
                        {.at = begins + SimTime(1), .index = 5, .value = 1.0}};
  Good(start);
  ASSERT_EQ(machine->base()->inputs.size(), 2U);
  EXPECT_EQ(machine->base()->inputs[1].index, 4);
}

// A run of nobody's program has none, and one to which more comes than is kept has none any more.
TEST_F(StartBaseTest, KeepsAThousandInputs) {
  Load({"DELAY 100\n"});
  EXPECT_FALSE(machine->base());
  Start();
  for (int i = 0; i < 1'000; ++i) Good(Logical(3, i % 2 == 0));
  ASSERT_TRUE(machine->base());
  EXPECT_EQ(machine->base()->inputs.size(), 1'000U);
  Good(Logical(3, true));
  EXPECT_FALSE(machine->base());
  Good(AbortRun{});
  GoOn(At(1.0));
  Start();
  EXPECT_TRUE(machine->base());
}

class GatesTest : public MachineTest {
 protected:
  explicit GatesTest(std::string_view family = "optimo") : MachineTest(family) {}
};

// LIVE-2.11: two inputs with a program each, in REMOTE alone.
TEST_F(GatesTest, EachStartsItsProgram) {
  Load({"VI[1]=1\n", "VI[2]=2\n", "DELAY 5\n"});
  EXPECT_THAT(Refused(PressGate{.gate = 1}), HasSubstr("CELL-E9423"));
  Good(SetGates{.programs = {2, 3}});
  for (const int gate : {0, 3}) {
    EXPECT_EQ(Refused(PressGate{.gate = gate}),
              "CELL-E9003 gate " + std::to_string(gate) + ": there are gate 1 and gate 2");
  }
  for (const int program : {-1, 100}) {
    EXPECT_EQ(
        Refused(SetGates{.programs = {2, program}}),
        "CELL-E9003 gate program " + std::to_string(program) + ": a slot is 1 to 99, 0 is none");
  }
  EXPECT_EQ(machine->gates(), (std::array<int, kGates>{2, 3}));
  Good(PressGate{.gate = 1});
  GoOn(At(1.0));
  const RunOver first = Over();
  EXPECT_EQ(first.run.program, 2);
  EXPECT_EQ(first.run.source, StartSource::kGate1);
  EXPECT_EQ(Value("VI[2]"), "2");
  Good(PressGate{.gate = 2});
  EXPECT_EQ(machine->status().open->source, StartSource::kGate2);
  EXPECT_THAT(Refused(PressGate{.gate = 1}), HasSubstr("CELL-E9421"));
  GoOn(At(10.0));
  for (const Mode mode : {Mode::kManual, Mode::kSingle, Mode::kCycle, Mode::kRepeat}) {
    Good(ChangeMode{mode});
    EXPECT_THAT(Refused(PressGate{.gate = 1}), HasSubstr("CELL-E9423"));
  }
}

// LIVE-2.11: what they start outlives a host; a program that is not there is the control's error.
TEST_F(GatesTest, AreKept) {
  Load({"VI[1]=1\n"});
  Good(SetGates{.programs = {99, 0}});
  Good(SetGates{.programs = {0, 44}});
  Load({"VI[1]=1\n"}, machine->Save());
  EXPECT_EQ(machine->gates(), (std::array<int, kGates>{0, 44}));
  EXPECT_THAT(Refused(PressGate{.gate = 1}), HasSubstr("CELL-E9423"));
  EXPECT_THAT(Refused(PressGate{.gate = 2}), HasSubstr("OPT-E7102"));
  Good(SwitchPower{false});
  EXPECT_THAT(Refused(PressGate{.gate = 2}), HasSubstr("CELL-E9424"));
}

class NoGatesTest : public GatesTest {
 protected:
  NoGatesTest() : GatesTest("rml1") {}
};

TEST_F(NoGatesTest, OfAMill) {
  Load({"PU0,0;"});
  EXPECT_THAT(Refused(SetGates{}), HasSubstr("CELL-E9424"));
  EXPECT_THAT(Refused(PressGate{.gate = 1}), HasSubstr("CELL-E9424"));
}

// LIVE-6.01: each halt at a breakpoint counts from its own time, also in the next run, and what a
// run stood before is no time of one that begins at a step. The steps take 2 s, 30 s and 30 s.
TEST_F(StartBaseTest, EachHaltCountsFromItsOwnTime) {
  Load({"DELAY 2\nDELAY 30\nDELAY 30\n"});
  Good(SetBreakpoints{.breakpoints = {{.at = {1, 1}}, {.at = {1, 2}}}});
  Start();
  GoOn(At(50.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_LT(machine->base_time(), At(3.0));
  Good(ResumeRun{});
  GoOn(At(100.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_GT(machine->base_time(), At(31.0));
  EXPECT_LT(machine->base_time(), At(34.0));
  Good(AbortRun{});
  GoOn(At(101.0));
  Start();
  GoOn(At(150.0));
  ASSERT_EQ(state(), MachineState::kHeld);
  EXPECT_LT(machine->base_time(), At(3.0));
  Good(ResumeRun{});
  GoOn(At(151.0));
  Good(AbortRun{});
  GoOn(At(152.0));
  Good(SetBreakpoints{});
  const Result<StartPreview> preview = machine->Preview(At1(3));
  ASSERT_TRUE(preview && preview->may_begin());
  Good(At1(3));
  while (machine->status().run.approaching) GoOn(machine->time() + At(0.01));
  GoOn(machine->time() + At(1.0));
  EXPECT_GT(machine->base_time(), preview->run_time + At(0.9));
  EXPECT_LT(machine->base_time(), preview->run_time + At(1.1));
}

}  // namespace
}  // namespace rmlcell::machine
