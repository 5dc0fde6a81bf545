// Small promises of a machine, each by itself: who hears of a run, what a mark may hold, what a run
// that begins at a step is free of.
#include <gmock/gmock.h>

#include "engine/machine/handbox.h"
#include "engine/machine/reach_step.h"
#include "engine/machine/virtual_driver.h"
#include "tests/engine/machine/start_bed.h"

namespace rmlcell::machine {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Runs as they begin.
class BegunRuns final : public RunObserver {
 public:
  void OnRunBegun(const RunNote& run) override { runs.push_back(run); }
  std::vector<RunNote> runs;
};

class MachinePromises : public StartTest {
 protected:
  void Watch(const std::vector<std::string>& programs) {
    MachineMemory memory;
    for (std::size_t i = 0; i < programs.size(); ++i)
      memory.programs[static_cast<int>(i) + 1] = Translated(programs[i]);
    begun.runs.clear();
    machine = *Machine::Make(family_, parameters(), std::move(memory), "", begun);
  }
  static Result<std::unique_ptr<Machine>> MadeOf(const MachineFamily& family,
                                                 const std::string& state) {
    static RunObserver nobody;
    return Machine::Make(family, *MakeParameters(family, "", {}), {}, state, nobody);
  }

  BegunRuns begun;
};

// Whoever watches hears of each run before anything of it, with its number and what began it.
TEST_F(MachinePromises, EachRunIsToldAsItBegins) {
  Watch({"DELAY 1\n", "DELAY 2\nDELAY 3\n"});
  Start(1);
  GoOn(At(5.0));
  StartAtStep input = At1(2);
  input.program = 2;
  input.source = StartSource::kQueue;
  input.target.at = {2, 2};
  Good(input);
  ASSERT_EQ(begun.runs.size(), 2U);
  EXPECT_EQ(begun.runs[0].program, 1);
  EXPECT_EQ(begun.runs[0].begun, SimTime(0));
  EXPECT_FALSE(begun.runs[0].entered);
  EXPECT_EQ(begun.runs[1].program, 2);
  EXPECT_EQ(begun.runs[1].number, begun.runs[0].number + 1);
  EXPECT_EQ(begun.runs[1].source, StartSource::kQueue);
  EXPECT_EQ(begun.runs[1].begun, At(3.0));  // its 2 s before the entry are over
  ASSERT_TRUE(begun.runs[1].entered);
  EXPECT_EQ(begun.runs[1].entered->at.at, (ProgramStep{2, 2}));
  EXPECT_EQ(begun.runs[1].entered->run_time, At(2.0));
}

// LIVE-3.23: a mark with a breakpoint that the machine cannot have is none.
TEST_F(MachinePromises, AMarkHasNoBreakpointThatCannotBe) {
  for (const char* id : {"optimo", "rml1"}) {
    const MachineFamily& family = *families::FindFamily(id);
    const std::string state = (*MadeOf(family, ""))->Save();
    const std::size_t at = state.find("family\n");
    ASSERT_NE(at, std::string::npos);
    const auto with = [&](const std::string& line) {
      return MadeOf(family, state.substr(0, at) + line + state.substr(at));
    };
    EXPECT_TRUE(with("breakpoint 1 1 1 \n")) << id;
    const auto none = with("breakpoint 1 0 1 \n");
    ASSERT_FALSE(none) << id;
    EXPECT_EQ(none.error().code, ErrorCode::kCellInvalidArgument);
  }
}

// LIVE-2.10: RESUME of a run that runs is answered, whoever asks, and does nothing.
TEST_F(MachinePromises, ResumeOfWhatRunsDoesNothing) {
  Load({"DELAY 5\nDELAY 5\n"});
  Start();
  GoOn(At(1.0));
  ASSERT_EQ(state(), MachineState::kRunning);
  ASSERT_TRUE(machine->base());
  for (const StartSource source : {StartSource::kPanel, StartSource::kConsole})
    Good(ResumeRun{.source = source, .restore_process = true});
  EXPECT_EQ(state(), MachineState::kRunning);
  ASSERT_TRUE(machine->base());
  EXPECT_THAT(machine->base()->inputs, IsEmpty());
  GoOn(At(20.0));
  EXPECT_EQ(Over().lasted, At(10.0));
}

// LIVE-3.01: nobody waits for the time of a machine that lives: a run waits for more than the 30
// days of a job, one that begins at a step as well.
TEST_F(MachinePromises, ARunHasNoEnd) {
  for (const bool from_step : {false, true}) {
    Load({"DELAY 1\nWAIT IL[5]\nVI[1]=1\n"});
    if (from_step) {
      Good(At1(2));
    } else {
      Start();
    }
    GoOn(std::chrono::hours(24 * 31));
    EXPECT_EQ(state(), MachineState::kRunning) << from_step;
  }
}

// LIVE-6.01: a recorded key that ends a halt later than one looks ahead at a time ends it then, and
// not before.
TEST_F(MachinePromises, ARecordedKeyEndsALongHalt) {
  RunSetup setup = Setup({"DELAY 2\nPAUSE\nVI[2]=7\nVI[3]=8\n"});
  for (const double hours : {0.5, 3.0}) {
    setup.inputs = {{At(3600.0 * hours), InputKind::kStart, 0, 1.0}};
    EXPECT_EQ(Reach(setup, {.at = {1, 4}}).run->state().time, At(3600.0 * hours));
    EXPECT_EQ(*OccurrenceAt(family_, setup, {1, 3}, At(3600.0 * hours - 1.0), {}), 0U);
    EXPECT_EQ(*OccurrenceAt(family_, setup, {1, 3}, At(3600.0 * hours + 1.0), {}), 1U);
  }
}

// OPT-9.38: what is set at the handbox the machine has, and keeps.
TEST_F(MachinePromises, AFrameGivenByHandIsKept) {
  Load({"DELAY 1\n"});
  Good(ChangeMode{Mode::kManual});
  for (const char* key :
       {"JOB", "0", "1", "ENT", "SHIFT", "F3", "NEXT", "ENT", "DEL", "1", "0", "ENT"})
    ASSERT_TRUE(machine->PressKey(key)) << key;
  EXPECT_EQ(machine->modal_values().back().value, "(10.0, 0.0, 0.0, 0.0, 0.0, 0.0)");
}

class MillPromises : public StartTest {
 protected:
  MillPromises() : StartTest("rml1") {}
};

// LIVE-6.03: where the whole run goes straight on, who begins there stops; where it stands, nobody
// passes anything.
TEST_F(MillPromises, APlaceThatTheWholeRunPassesIsTold) {
  const RunSetup setup = Setup({"VS10;!VZ8;PU0,0;PD1000,0;PD2000,0;PU2000,0;PU0,500;"});
  const auto passage = [&](int step) {
    const StartPreview preview = PreviewOf(setup, {.at = {1, step}});
    return Row(preview.differences, "passage") != nullptr;
  };
  EXPECT_TRUE(passage(5));
  EXPECT_FALSE(passage(4));
  EXPECT_FALSE(passage(7));
}

// What a stream has more findings of than are told is told by number and place, of the program that
// it is.
TEST_F(MillPromises, UntoldFindingsOfOneStream) {
  std::string bad;
  for (int n = 0; n < 2500; ++n) bad += "PU100,100;PU200,200;QQ;";
  const Translation translation =
      family_.Translate({.name = "3.rml", .bytes = bad}, parameters(), {});
  ASSERT_GT(translation.diagnostics_dropped.count(), 0U);
  ProjectProgram program;
  program.file = {.name = "3.rml", .bytes = bad};
  program.slot = 3;
  const TransferPlan plan = family_.PlanTransfer({.programs = {program}}, parameters(), {});
  EXPECT_EQ(plan.diagnostics.size() + plan.diagnostics_dropped.count(),
            translation.diagnostics.size() + translation.diagnostics_dropped.count());
  for (const auto& [code, kind] : plan.diagnostics_dropped.kinds()) {
    EXPECT_EQ(kind.first.program, 3);
    EXPECT_EQ(kind.last.program, 3);
  }
}

// LIVE-5.04: whoever sets another factor while it waits loses no time of it either.
TEST(VirtualDriver, AnotherFactorWhileItWaits) {
  const MachineFamily& family = *families::FindFamily("optimo");
  RunObserver nobody;
  VirtualDriver driver(
      *Machine::Make(family, *MakeParameters(family, "standard", {}), {}, {}, nobody), At(100.0));
  driver.Pump(At(101.0));
  driver.Wait(true, At(101.0));
  EXPECT_TRUE(driver.SetFactor(At(109.0), 2.0));
  EXPECT_EQ(driver.TakeLost(), SimTime(0));
  EXPECT_EQ(driver.machine().time(), At(1.0));
  driver.Wait(false, At(110.0));
  driver.Pump(At(110.5));
  EXPECT_EQ(driver.machine().time(), At(2.0));
}

}  // namespace
}  // namespace rmlcell::machine
