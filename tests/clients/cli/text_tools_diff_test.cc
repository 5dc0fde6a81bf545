// rmlcell diff: what is said of two programs, for people and as JSON, and with which exit code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "clients/cli/text_tools.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class DiffTest : public testing::Test {
 protected:
  DiffOptions Of(const std::string& before, const std::string& after) {
    return {.before = folder.Put("a.S", before),
            .after = folder.Put("b.S", after),
            .svg = {},
            .machine = {}};
  }
  Told Compared(const std::string& before, const std::string& after) {
    const DiffOptions options = Of(before, after);
    return Hear([&] { return Diff(options); });
  }

  CliFolder folder;
};

TEST_F(DiffTest, ThatTheyDoTheSameIsSaid) {
  const Told told = Compared("SPEED 5\n", "speed 5.0 ; slow\n");
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.output, "they do the same\n");
  EXPECT_EQ(told.errors, "");
}

// The first has a step that the other has not, the second of the other stands for none of the
// first.
TEST_F(DiffTest, StepsHaveTheirNumbersOnBothSides) {
  Told told = Compared("OL[11]=ON\nVR[1]=2.\nDELAY 1\n", "VR[1]=2.\nWORKDEF 2,0 (11)\nDELAY 2\n");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, StartsWith("step 1 -> -  outputs\n  - LET OL[11] = ON\n"));
  EXPECT_THAT(told.output, HasSubstr("step - -> 2  power\n  + WORKDEF 2,0 (11)\n"));
  EXPECT_THAT(told.output, HasSubstr("step 3 -> 3  time\n"));
  EXPECT_THAT(told.output, HasSubstr("\n    DELAY 1 -> DELAY 2\n"));
  EXPECT_THAT(told.output, Not(HasSubstr("they do the same")));
  EXPECT_THAT(told.output, Not(HasSubstr("target moved")));
}

// (3, 4, 0): 5 mm.
TEST_F(DiffTest, ATargetThatMovedSaysHowFar) {
  const Told told = Compared("COORD ABSOL\nPATH LIN\nMOVE (1000,900,-500,0,0)\n",
                             "COORD ABSOL\nPATH LIN\nMOVE (1003,904,-500,0,0)\n");
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, HasSubstr("step 3 -> 3  path\n"));
  EXPECT_THAT(told.output, HasSubstr("\n    target moved by 5.000 mm\n"));
}

// Dwells of 1 s and 2 s: the whole takes 1 s longer; whole numbers have no decimals.
TEST_F(DiffTest, FiguresAreThoseOfAMachineThatIsNamed) {
  auto options = Of("DELAY 1\n", "DELAY 2.5\n");
  Told told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, HasSubstr("  1 -> 2.5 s\n"));
  const std::size_t machine = told.output.find("\nmachine  ");
  ASSERT_NE(machine, std::string::npos) << told.output;
  EXPECT_LT(machine, told.output.find("  1 -> 2.5 s\n"));
  // 50 microseconds are told with as many decimals as it takes.
  options = Of("DELAY 1\n", "DELAY 1.00005\n");
  told = Hear([&] { return Diff(options); });
  EXPECT_THAT(told.output, HasSubstr("  1 -> 1.00005 s\n"));
}

TEST_F(DiffTest, JsonSaysItInOneObject) {
  auto options = Of("DELAY 1\n", "DELAY 2\n");
  options.json = true;
  Told told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.errors, "");
  EXPECT_EQ(json::parse(told.output)["steps"][0]["stepAfter"], 1);
  options.after = options.before;
  told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(json::parse(told.output)["equal"], true);
}

TEST_F(DiffTest, APictureGoesToItsFileOrAloneToStandardOutput) {
  const std::string line = "COORD ABSOL\nPATH LIN\nMOVE (1000,900,-500,0,0)\n";
  auto options = Of(line, line + "MOVE (1010,900,-500,0,0)\n");
  options.svg = folder.File("d.svg");
  Told told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, HasSubstr("step - -> 4  path, time\n"));
  EXPECT_THAT(folder.Read("d.svg"), HasSubstr("<svg"));
  options.svg = "-";
  told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.output, folder.Read("d.svg"));
  options.svg = folder.File("none/d.svg");
  told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9023"));
}

TEST_F(DiffTest, WhatCannotBeComparedIsRefused) {
  auto options = Of("SPEED 5\n", "SPEED 101\n");
  Told told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, AllOf(HasSubstr("b.S:1:7: error OPT-E7004"), HasSubstr("SPEED 101\n")));
  options.after = folder.File("none.S");
  told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("CELL-E9022"));
  options.after = folder.Put("c.rml", "PU1,1;");
  told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("programs for different machines"));
  options.after = options.before;
  options.machine.profile = "no-such-machine";
  EXPECT_EQ(Hear([&] { return Diff(options); }).exit_code, 2);
  options.machine = {
      .family = {}, .profile = {}, .file = folder.File("none.toml"), .origin = {}, .clamps_mm = {}};
  EXPECT_EQ(Hear([&] { return Diff(options); }).exit_code, 2);
}

// A FUNCTION that nobody has: what they do is compared, no run is.
TEST_F(DiffTest, ThatThereAreNoFiguresIsSaidOfPeopleAlone) {
  auto options = Of("FUNCTION 44\nDELAY 1\n", "FUNCTION 44\nDELAY 2\n");
  Told told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("no figures: "));
  options.json = true;
  told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.errors, "");
}

}  // namespace
}  // namespace rmlcell::cli
