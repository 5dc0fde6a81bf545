#include "engine/simulation/run/timetable.h"

#include <gtest/gtest.h>

#include "engine/families/families.h"
#include "engine/simulation/run/simulate.h"
#include "tests/engine/simulation/fake_family.h"

namespace rmlcell::simulation {
namespace {

// 10 steps take a second, the next 10 another one, the last 2 s.
Timetable ThreeParts() {
  Timetable table;
  table.Note(10, std::chrono::seconds(1));
  table.Note(20, std::chrono::seconds(2));
  table.End(std::chrono::seconds(4));
  return table;
}

TEST(Timetable, ARunAsPlannedIsAsFarAsItsTime) {
  Timetable table = ThreeParts();
  EXPECT_EQ(table.ShareAt(0, SimTime(0)), 0.0);
  EXPECT_EQ(table.ShareAt(5, std::chrono::milliseconds(500)), 0.125);
  EXPECT_EQ(table.ShareAt(10, std::chrono::seconds(1)), 0.25);
  EXPECT_EQ(table.ShareAt(15, std::chrono::milliseconds(1500)), 0.375);
  EXPECT_EQ(table.ShareAt(20, std::chrono::seconds(3)), 0.5);  // reached just now
  EXPECT_EQ(table.ShareAt(20, std::chrono::seconds(4)), 0.75);
  EXPECT_EQ(table.ShareAt(20, std::chrono::seconds(5)), 1.0);
}

// Held, or at half the speed: it does not run past the step that it has not reached.
TEST(Timetable, ASlowerRunWaitsAtTheNextStepThatIsKnown) {
  Timetable table = ThreeParts();
  EXPECT_EQ(table.ShareAt(3, std::chrono::seconds(30)), 0.25);
  EXPECT_EQ(table.ShareAt(10, std::chrono::seconds(40)), 0.25);
  EXPECT_EQ(table.ShareAt(12, std::chrono::seconds(90)), 0.5);
  EXPECT_EQ(table.ShareAt(22, std::chrono::seconds(100)), 0.5);
  EXPECT_EQ(table.ShareAt(22, std::chrono::seconds(200)), 1.0);
}

TEST(Timetable, AFasterRunIsWhereItsStepsAre) {
  Timetable table = ThreeParts();
  EXPECT_EQ(table.ShareAt(20, std::chrono::milliseconds(100)), 0.5);
}

// A step counts from when it is reached first, however long the run stays with it.
TEST(Timetable, AStepCountsFromItsBegin) {
  Timetable table;
  table.Note(10, std::chrono::seconds(1));
  table.Note(10, std::chrono::seconds(2));
  table.Note(20, std::chrono::seconds(3));
  table.End(std::chrono::seconds(4));
  EXPECT_EQ(table.ShareAt(10, std::chrono::seconds(1)), 0.25);
  EXPECT_EQ(table.ShareAt(10, std::chrono::seconds(2)), 0.5);
}

// Two steps that come at once are both known: who has only the first waits there.
TEST(Timetable, StepsMayTakeNoTime) {
  Timetable table;
  table.Note(1, std::chrono::seconds(1));
  table.Note(2, std::chrono::seconds(1));
  table.Note(3, std::chrono::seconds(2));
  table.End(std::chrono::seconds(4));
  EXPECT_EQ(table.ShareAt(1, std::chrono::seconds(1)), 0.25);
  EXPECT_EQ(table.ShareAt(1, std::chrono::milliseconds(1500)), 0.25);
  EXPECT_EQ(table.ShareAt(2, std::chrono::milliseconds(1500)), 0.25);
  EXPECT_EQ(table.ShareAt(2, std::chrono::milliseconds(1800)), 0.325);
}

// An hour of 100,000 steps of 36 ms: however many there are, the share is right to a 500th.
TEST(Timetable, BecomesCoarserAndStaysTrue) {
  Timetable table;
  for (std::uint64_t step = 1; step <= 100'000; ++step)
    table.Note(step, std::chrono::milliseconds(36) * step);
  table.End(std::chrono::seconds(3600));
  for (std::uint64_t step = 0; step <= 100'000; step += 777) {
    const double planned = static_cast<double>(step) / 100'000.0;
    EXPECT_NEAR(table.ShareAt(step, std::chrono::milliseconds(36) * step), planned, 1.0 / 500.0)
        << step;
  }
}

TEST(Timetable, NothingTakesNoTime) {
  Timetable table;
  table.End(SimTime(0));
  EXPECT_EQ(table.ShareAt(0, SimTime(0)), 0.0);
}

SimTime PlannedTime(const machine::MachineFamily& family, const machine::RunSetup& setup) {
  auto run = TimetableRun::Of(family, setup);
  EXPECT_TRUE(bool(run));
  int calls = 0;
  while (!(*run)->Advance() && ++calls < 10000) continue;
  EXPECT_TRUE((*run)->timetable().total().has_value());
  return (*run)->timetable().total().value_or(SimTime(0));
}

// The same total as the run that is watched, in the family whose stream is read as it comes and in
// the one whose program halts on the way: START is given.
TEST(TimetableRun, TakesAsLongAsTheRun) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  machine::RunSetup stream{machine::Parameters(mill.parameters())};
  stream.main_program = 1;
  stream.programs[1].object =
      machine::Bytes::Of("!MC1;V10;!PZ-200,200;PD4000,0,4000,3000;PU;!MC0;");
  const auto milled = Simulate(mill, stream, {});
  ASSERT_TRUE(bool(milled));
  ASSERT_GT(milled->report.total.time.total(), std::chrono::seconds(3));
  EXPECT_EQ(PlannedTime(mill, stream), milled->report.total.time.total());

  const machine::MachineFamily& laser = *families::FindFamily("optimo");
  machine::RunSetup program{machine::Parameters(laser.parameters())};
  program.main_program = 1;
  program.mode = machine::Mode::kSingle;  // a halt behind each step
  machine::Translation made = laser.Translate(
      {.name = "1.S", .bytes = "COORD ABSOL\nDELAY 2.\nMOVE (100.,0.,0.,0.,0.)\nDELAY 3.\n"},
      program.parameters, {});
  ASSERT_TRUE(made.ok);
  program.programs[1].object = machine::Bytes::Of(made.object);
  const auto cut = Simulate(laser, program, {.options = {.at_halt = AtHalt::kStart}});
  ASSERT_TRUE(bool(cut));
  ASSERT_GT(cut->report.total.time.total(), std::chrono::seconds(5));
  EXPECT_EQ(PlannedTime(laser, program), cut->report.total.time.total());
}

// 2 s, a halt up to the START that the inputs give after 10 s, and 3 s more.
TEST(TimetableRun, AHaltLastsUpToTheStartOfItsInputs) {
  Script script;
  script.Step(1, 1).Nothing(2.0).Halt("STOP").Nothing(3.0);
  machine::RunSetup setup = FakeFamily::Setup();
  EXPECT_EQ(PlannedTime(FakeFamily(script), setup), std::chrono::seconds(5));
  setup.inputs = {{.at = std::chrono::seconds(10), .kind = machine::InputKind::kStart}};
  EXPECT_EQ(PlannedTime(FakeFamily(script), setup), std::chrono::seconds(13));
}

TEST(TimetableRun, OfARunThatDoesNotBeginIsNone) {
  machine::RunSetup setup = FakeFamily::Setup();
  setup.main_program = 99;
  const auto refused = TimetableRun::Of(FakeFamily(), setup);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(refused.error().detail, "no");
}

}  // namespace
}  // namespace rmlcell::simulation
