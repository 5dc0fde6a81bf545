// What is made for a run before it: executables, timetables, families for files; and blocks of a
// toolpath that are cut off.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/run/rehearsal.h"
#include "engine/simulation/run/timetable.h"
#include "engine/simulation/toolpath/toolpath.h"
#include "tests/engine/simulation/fake_family.h"

namespace rmlcell::simulation {
namespace {

// An executable stands in its slot afterwards; of a slot that makes none the machine says why.
TEST(RunMakers, AnExecutableStandsInItsSlot) {
  const FakeFamily family;
  machine::RunSetup setup = FakeFamily::Setup();
  const Status made = MakeExecutable(family, setup, 12);
  ASSERT_TRUE(made) << made.error().detail;
  ASSERT_TRUE(bool(setup.programs[12].executable));
  EXPECT_EQ(*setup.programs[12].executable, "executable");
  EXPECT_EQ(setup.main_program, 1);
  EXPECT_FALSE(bool(setup.programs[1].executable));
  const Status none = MakeExecutable(family, setup, 3);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, family.info().empty_slot);
  const Status refused = MakeExecutable(family, setup, 99);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(refused.error().detail, "no");

  Script fails;
  fails.Step(1, 1).Ends(machine::OutcomeKind::kFailed, ErrorCode::kHoleRadiusZero, "radius is 0");
  const Status failed = MakeExecutable(FakeFamily(fails), setup, 3);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kHoleRadiusZero);
  EXPECT_EQ(failed.error().detail, "radius is 0");
}

// 2 s, then 3 s: who is at the second step already has two fifths behind it.
TEST(RunMakers, ATimetableKnowsItsSteps) {
  const machine::MachineFamily& laser = *families::FindFamily("optimo");
  machine::RunSetup setup{machine::Parameters(laser.parameters())};
  setup.main_program = 1;
  machine::Translation made =
      laser.Translate({.name = "1.S", .bytes = "DELAY 2.\nDELAY 3.\n"}, setup.parameters, {});
  ASSERT_TRUE(made.ok);
  setup.programs[1].object = machine::Bytes::Of(made.object);
  auto run = TimetableRun::Of(laser, setup);
  ASSERT_TRUE(bool(run));
  int calls = 1;
  while (!(*run)->Advance()) ++calls;
  EXPECT_GE(calls, 50);  // a tenth of a second each
  EXPECT_LE(calls, 52);
  EXPECT_TRUE((*run)->Advance());  // it stays so
  Timetable& table = (*run)->timetable();
  EXPECT_EQ(table.total(), FromSeconds(5.0));
  EXPECT_EQ(table.ShareAt(1, SimTime(0)), 0.0);
  EXPECT_NEAR(table.ShareAt(1, FromSeconds(0.5)), 0.1, 0.021);
  EXPECT_NEAR(table.ShareAt(2, FromSeconds(0.75)), 0.4, 0.021);
  EXPECT_NEAR(table.ShareAt(2, FromSeconds(1.75)), 0.6, 0.021);
}

// However a block of two runs is cut off, and however many points it says to have, it is none.
TEST(RunMakers, ABlockThatIsCutOffIsNone) {
  ToolpathBlock block;
  block.points = {{1, 2, 3, 4, 5}, {1001, 2, 3, 4, 5}, {1001, 3002, 3, 9, 5}, {1, 2, 3, 9, 8}};
  block.reached_us = {7, 10'007, 95'000, 100'500};
  block.runs = {{.program = 3, .step = 4, .speed_class = 2, .start_us = 7, .end_us = 10'007},
                {.program = 5,
                 .step = 2,
                 .use = machine::MotionUse::kCut,
                 .beam_on = true,
                 .speed_class = 3,
                 .power_class = 4,
                 .reached_class = 5,
                 .start_us = 20'500,
                 .end_us = 100'500}};
  block.runs[0].point_count = 2;
  block.runs[1].first_point = 1;
  block.runs[1].point_count = 3;
  const std::string whole = EncodeToolpathBlock(block);
  const auto read = DecodeToolpathBlock(whole);
  ASSERT_TRUE(read) << read.error().detail;
  EXPECT_EQ(read->runs, block.runs);
  EXPECT_EQ(read->points, block.points);
  EXPECT_EQ(read->reached_us, block.reached_us);
  ASSERT_EQ(whole[2], 2);
  ASSERT_EQ(whole[3], 4);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    for (char points = 1; points <= 4; ++points) {
      std::string part = whole.substr(0, size);
      if (size > 3) part[3] = points;
      const auto cut_off = DecodeToolpathBlock(part);
      ASSERT_FALSE(cut_off) << size << " of " << whole.size() << " bytes";
      EXPECT_EQ(cut_off.error().code, ErrorCode::kCellToolpathCorrupt);
    }
  }
}

// Streams are compared by their own family, programs by the one with tools for them.
TEST(RunMakers, FilesAreComparedByTheirFamily) {
  const auto compares = [](const char* name) {
    const auto family = families::FamilyThatCompares(name);
    return family ? std::string((*family)->info().id) : std::string("nobody");
  };
  EXPECT_EQ(compares("a.S"), "optimo");
  EXPECT_EQ(compares("a.rml"), "rml1");
  EXPECT_EQ(compares("part"), "optimo");
  const auto refused = families::FamilyWithTools("a.rml");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().detail, "a.rml is a program for " +
                                        std::string(families::FindFamily("rml1")->info().title) +
                                        ": there are no tools for its streams");
}

}  // namespace
}  // namespace rmlcell::simulation
