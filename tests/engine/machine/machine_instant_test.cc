// A run on a machine that lives, which lets no virtual time pass: it fails where it stands, after
// ten million instructions. LIVE-3.01
#include <gmock/gmock.h>

#include <string>

#include "tests/engine/machine/machine_bed.h"

namespace rmlcell::machine {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kStepsMost = 10'000'000;
constexpr std::uint64_t kStepsOfATurn = 20'000;  // LIVE-3.12

std::string RepeatedText(std::size_t count, std::string_view text) {
  std::string made;
  made.reserve(count * text.size());
  for (std::size_t n = 0; n < count; ++n) made += text;
  return made;
}

// So many instructions are too many to keep a line of each.
class InstantTest : public MachineTest {
 protected:
  explicit InstantTest(std::string_view family = "optimo") : MachineTest(family) {}

  void LoadQuietly(const std::vector<std::string>& programs) {
    MachineMemory memory;
    for (std::size_t i = 0; i < programs.size(); ++i)
      memory.programs[static_cast<int>(i) + 1] = Translated(programs[i]);
    machine = *Machine::Make(family_, parameters(), std::move(memory), {}, nobody_);
  }
  // Turns until this time is reached.
  std::uint64_t TurnsTo(SimTime until) {
    std::uint64_t turns = 1;
    while (machine->Advance(until) == Progress::kMoreWork) {
      if (++turns > 10 * kStepsMost / kStepsOfATurn) {
        ADD_FAILURE() << "it turns for ever";
        break;
      }
    }
    return turns;
  }

  RunObserver nobody_;
};

class MillInstantTest : public InstantTest {
 protected:
  MillInstantTest() : InstantTest("rml1") {}
};

// LIVE-3.01, LIVE-3.12: five hundred turns of 20,000, and an order acts between two of them.
TEST_F(InstantTest, AnEndlessLoopFails) {
  LoadQuietly({"10 VR[2] = VR[2] + 1\nGOTO 10\n"});
  Start();
  EXPECT_EQ(machine->Advance(At(1.0)), Progress::kMoreWork);
  EXPECT_EQ(machine->open_run()->steps_executed(), kStepsOfATurn);
  EXPECT_EQ(machine->time(), At(0.0));
  Good(ChangeOverride{50.0});
  EXPECT_EQ(TurnsTo(At(1.0)), kStepsMost / kStepsOfATurn);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_TRUE(machine->status().alarms.empty());
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(over.outcome.code, ErrorCode::kStepBudget);
  EXPECT_THAT(over.outcome.detail, HasSubstr("10000000 steps"));
  EXPECT_EQ(over.steps, kStepsMost);
  EXPECT_EQ(over.lasted, SimTime(0));
  EXPECT_EQ(Value("VR[2]"), "5000000.0");
}

// LIVE-3.01: no ERR of the program takes it.
TEST_F(InstantTest, NoErrTakesIt) {
  LoadQuietly({"ERR 20\n10 GOTO 10\n20 DELAY 1\nGOTO 10\n"});
  Start();
  TurnsTo(At(1.0));
  EXPECT_EQ(Over().outcome.code, ErrorCode::kStepBudget);
}

// LIVE-3.01: repetitions of a program that takes no time are one instant, too.
TEST_F(InstantTest, RepeatOfAProgramThatTakesNoTimeFails) {
  LoadQuietly({"VR[2] = VR[2] + 1\n"});
  Good(ChangeMode{Mode::kRepeat});
  Good(StartRun{.program = 1, .source = StartSource::kPanel});
  TurnsTo(At(1.0));
  EXPECT_EQ(state(), MachineState::kIdle);
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(over.outcome.code, ErrorCode::kStepBudget);
  EXPECT_EQ(over.steps, kStepsMost);
}

// LIVE-3.01: it is time that has to pass. Twelve million steps, six at each of two instants.
TEST_F(InstantTest, StepsOfSeveralInstantsAreFew) {
  const std::string count = "VR[2] = 0\n10 VR[2] = VR[2] + 1\nIF VR[2] < 3000000 THEN 10\n";
  const std::string again = "VR[2] = 0\n20 VR[2] = VR[2] + 1\nIF VR[2] < 3000000 THEN 20\n";
  LoadQuietly({count + "DELAY 0.001\n" + again});
  Start();
  TurnsTo(At(1.0));
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kCompleted) << over.outcome.detail;
  EXPECT_EQ(over.steps, 12'000'003U);
}

// LIVE-3.01: at a machine whose axes have no reference it fails standing, too.
TEST_F(InstantTest, ItFailsWithoutReference) {
  LoadQuietly({"10 GOTO 10\n"});
  Good(SwitchPower{false});
  Good(SwitchPower{true});
  Good(StartRun{.program = 1, .unzeroed = true});
  TurnsTo(At(1.0));
  EXPECT_EQ(state(), MachineState::kNotZeroed);
  EXPECT_EQ(Over().outcome.code, ErrorCode::kStepBudget);
}

// LIVE-3.01, OPT-2.59: beside a motion of /NEXT the program waits for its end before it has gone on
// for long: it fails behind it, where the machine stands.
TEST_F(InstantTest, BesideAMotionItFailsBehindIt) {
  LoadQuietly(
      {"COORD ABSOL\nSPEED 20\nPATH LIN\nMOVE (600., 2201.2, -350., 0., 0.) /NEXT\nDELAY 1\n10 GOTO "
       "10\n"});
  Start();
  TurnsTo(At(3.0));
  ASSERT_TRUE(machine->open_run());
  EXPECT_GT(machine->status().run.tip_speed_mm_s, 50.0);
  TurnsTo(At(60.0));
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(over.outcome.code, ErrorCode::kStepBudget);
  // 579 mm at 100 mm/s
  EXPECT_GT(over.lasted, At(5.79));
  EXPECT_LT(over.lasted, At(6.5));
  EXPECT_NEAR(machine->status().run.tip.tip.x(), 600.0, 1e-3);
}

// LIVE-3.01: how the caller divides time changes nothing.
TEST_F(InstantTest, DividedTimeChangesNothing) {
  std::vector<std::string> ends;
  for (const double part : {1.0, 0.01, 0.0003}) {
    LoadQuietly({"DELAY 0.05\n10 VR[2] = VR[2] + 1\nGOTO 10\n"});
    Start();
    for (SimTime to = At(part); to <= At(1.0); to += At(part)) TurnsTo(to);
    const RunOver over = Over();
    ends.push_back(std::to_string(over.lasted.count()) + " " + std::to_string(over.steps) + " " +
                   over.outcome.detail + " " + Value("VR[2]"));
  }
  EXPECT_EQ(ends[1], ends[0]);
  EXPECT_EQ(ends[2], ends[0]);
}

// LIVE-3.01, LIVE-3.12: a mill, with the code of the cell; its numbers are commands.
TEST_F(MillInstantTest, CommandsThatTakeNoTimeFail) {
  MachineMemory memory;
  memory.programs[1] = {
      .name = "a.rml",
      .object = Bytes::Of("PA;PU1000,1000;" + RepeatedText(kStepsMost + 10, "PA;"))};
  machine = *Machine::Make(family_, parameters(), std::move(memory), {}, nobody_);
  Start();
  EXPECT_GE(TurnsTo(At(60.0)), kStepsMost / kStepsOfATurn);
  EXPECT_EQ(state(), MachineState::kIdle);
  EXPECT_TRUE(machine->status().alarms.empty());
  const RunOver over = Over();
  EXPECT_EQ(over.outcome.kind, OutcomeKind::kFailed);
  EXPECT_EQ(over.outcome.code, ErrorCode::kCellStepBudget);
  EXPECT_THAT(over.outcome.detail, HasSubstr("10000000 commands"));
  EXPECT_GE(over.steps, kStepsMost);
  EXPECT_LE(over.steps, kStepsMost + 2);
  EXPECT_NEAR(machine->status().run.axes.column.x(), 10.0, 1e-9);
}

// The same with a bound of a thousand.
class MillBudgetTest : public MillInstantTest {
 protected:
  const machine::Run& Ran(std::string stream) {
    RunSetup setup(parameters());
    setup.programs[1].object = Bytes::Of(std::move(stream));
    setup.main_program = 1;
    setup.budget.steps_at_one_instant = 1000;
    run_ = *family_.NewRun(std::move(setup), nobody_);
    while (run_->Advance(kForever) == RunPhase::kRunning) {
    }
    return *run_;
  }
  std::unique_ptr<machine::Run> run_;
};

// LIVE-3.01: fifteen hundred of them at two instants are few.
TEST_F(MillBudgetTest, CommandsOfSeveralInstantsAreFew) {
  const std::string many = RepeatedText(900, "PA;");
  EXPECT_EQ(Ran("PU1000,1000;" + many + "PU2000,2000;" + many).outcome().kind,
            OutcomeKind::kCompleted);
  EXPECT_EQ(Ran("PU1000,1000;" + many + many).outcome().code, ErrorCode::kCellStepBudget);
}

// LIVE-3.01: in the middle of a polyline, where the tool would pass, it comes to rest first.
TEST_F(MillBudgetTest, WhereTheToolPassesItComesToRestFirst) {
  const machine::Run& run = Ran("!MC0;VS50;PU1000,1000;PD;PD2000,1000;" +
                                RepeatedText(1010, "PA;") + "PD4000,1000;PD4000,2000;");
  EXPECT_EQ(run.outcome().kind, OutcomeKind::kFailed);
  EXPECT_EQ(run.outcome().code, ErrorCode::kCellStepBudget);
  // From 30 mm/s with 200 mm/s^2.
  EXPECT_NEAR(run.state().axes.column.x(), 20.0 + 30.0 * 30.0 / 400.0, 0.1);
  EXPECT_NEAR(run.state().axes.column.y(), 10.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::machine
