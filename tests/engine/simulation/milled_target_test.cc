// A program as the target of another (docs/material.md, "Beside what should be left").
#include "engine/simulation/run/milled_target.h"

#include <gtest/gtest.h>

#include <string>

#include "engine/families/families.h"

namespace rmlcell::simulation {
namespace {

// A block of 10 x 10 mm in cells of 1 mm, and a tool of 2.5 mm.
constexpr Milling kMilling{
    .stock = {.x_max = 10.0, .y_max = 10.0, .bottom = -5.0, .top = 0.0, .cell = 1.0},
    .tool = {.radius_mm = 1.25}};

ProgramMemory Stream(const std::string& text) {
  return {.family = families::FindFamily("rml1"),
          .profile = "t1",
          .programs = {{.slot = 3,
                        .file_name = "old.rml",
                        .bytes = machine::Bytes::Of(text),
                        .is_source = true}}};
}

Result<std::vector<float>> Milled(const std::string& text, RunOptions options,
                                  const StillWanted& wanted = {}) {
  options.main_program = 3;
  options.mode = machine::Mode::kCycle;
  return MilledTarget(Stream(text), options, kMilling, wanted);
}

// A plunge to Z -1 at (5.5, 5.5), 100 units a mm: its cell, and of the eight around it those whose
// centres are within 1.25 mm, which are the four at 1 mm.
TEST(MilledTarget, IsWhatTheProgramLeaves) {
  const auto heights = Milled("!PZ-100,200;PU550,550;PD550,550;PU0,0;", {});
  ASSERT_TRUE(heights) << heights.error().detail;
  ASSERT_EQ(heights->size(), 100U);
  for (std::size_t k = 0; k < 100; ++k) {
    const bool cut = k == 55 || k == 54 || k == 56 || k == 45 || k == 65;
    EXPECT_EQ((*heights)[k], cut ? -1.0f : 0.0f) << k;
  }
}

TEST(MilledTarget, OfAProgramThatDoesNotEndIsNone) {
  std::string endless = "!PZ-100,200;";
  for (int k = 0; k < 1000; ++k) endless += "PD550,550;PD0,0;";
  RunOptions few;
  few.budget.steps = 50;
  const auto cut_off = Milled(endless, few);
  ASSERT_FALSE(cut_off);
  EXPECT_EQ(cut_off.error().code, ErrorCode::kCellStepBudget);
  EXPECT_TRUE(cut_off.error().detail.starts_with("the program does not run to its end"));
  int asked = 0;
  const auto given_up = Milled(endless, {}, [&] { return ++asked < 3; });
  ASSERT_FALSE(given_up);
  EXPECT_EQ(given_up.error().code, ErrorCode::kCellCancelled);
  EXPECT_EQ(asked, 3);
}

// A request that names no parameter of the machine, a program with errors, a run that no mill has.
TEST(MilledTarget, OfAProgramThatDoesNotBeginIsNone) {
  const std::string plunge = "!PZ-100,200;PU550,550;PD550,550;PU0,0;";
  const auto unknown = Milled(plunge, {.parameters = {{"NO_SUCH", "1"}}});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kCellUnknownParameter);
  const auto empty = Milled("", {});
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().code, ErrorCode::kCellBadText);
  EXPECT_EQ(empty.error().detail, "the program has errors: rmlcell check lists them");
  const auto dry = Milled(plunge, {.simul = machine::ProgramStep{3, 2}});
  ASSERT_FALSE(dry);
  EXPECT_EQ(dry.error().code, ErrorCode::kCellUnimplemented);
}

// An emergency stop of a mill has no number: what it leaves is no target, and not for the text of
// the program.
TEST(MilledTarget, OfARunThatEndsWithoutACodeIsNone) {
  const auto ended = Milled("!PZ-100,200;PU550,550;PD550,550;PU0,0;",
                            {.inputs = {{SimTime(1), machine::InputKind::kEmergencyStop, 0, 1.0}}});
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, ErrorCode::kCellWaitsForever);
  EXPECT_EQ(ended.error().detail, "the program does not run to its end; emergency stop");
}

}  // namespace
}  // namespace rmlcell::simulation
