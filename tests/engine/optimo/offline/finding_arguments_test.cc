#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/optimo/offline/compensate.h"
#include "engine/optimo/offline/convert.h"
#include "engine/optimo/offline/fix_program.h"
#include "engine/optimo/offline/project.h"
#include "engine/optimo/offline/translate.h"
#include "tests/engine/core/arguments_text.h"

// What findings of the tools know besides their texts.
namespace rmlcell::optimo {
namespace {

std::string FirstArguments(const std::vector<Diagnostic>& findings, int number) {
  for (const Diagnostic& d : findings) {
    if (Lookup(d.code).number == number) return ArgumentsText(d.detail);
  }
  return "no such finding";
}

// A slot of 1 mm: a beam of radius 0.75 comes within 0.25 mm of the other wall.
TEST(ToolArguments, GougesSayHowDeepTheyAre) {
  const Compensation cut = Compensate(
      ";$rad=0.75\n;$left\nPATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\nMOVE (20,0,0,0,0)\nMOVE "
      "(20,-20,0,0,0)\nMOVE (21,-20,0,0,0)\nMOVE (21,0,0,0,0)\nMOVE (40,0,0,0,0)\n");
  EXPECT_EQ(FirstArguments(cut.diagnostics, 7812), "distance=0.25 mm radius=0.75 mm depth=0.5 mm");
}

TEST(ToolArguments, ACornerHasItsAngleInDegrees) {
  const std::string corner =
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\nMOVE (100,0,0,0,0)/FLY\n"
      "MOVE (100,100,0,0,0)\nWORK 0,0/OFF\n";
  for (const Diagnostic& d : TranslateOptimo({"a.S", corner}, {}).diagnostics) {
    if (d.code != ErrorCode::kFlySharp) continue;
    ASSERT_EQ(d.detail.arguments().size(), 2U);
    EXPECT_EQ(d.detail.arguments()[0].name, "angle");
    EXPECT_EQ(d.detail.arguments()[0].unit, "deg");
    EXPECT_NEAR(std::get<double>(d.detail.arguments()[0].value), 90.0, 1e-9);
    EXPECT_EQ(d.detail.arguments()[1].name, "distance");
    EXPECT_EQ(d.detail.arguments()[1].unit, "mm");
    EXPECT_NEAR(std::get<double>(d.detail.arguments()[1].value), 1.3588, 1e-3);
    return;
  }
  FAIL() << "no sharp corner";
}

TEST(ToolArguments, ProjectsNameWhatStandsTwice) {
  machine::ProjectBundle bundle;
  bundle.programs.push_back({45, {"45.S", "SPEED 5\n"}});
  bundle.programs.push_back({45, {"45.S", "SPEED 5\n"}});
  bundle.processes.push_back({1, 3, {10.0, 50.0, 1.0, 50.0}, ""});
  bundle.processes.push_back({1, 3, {10.0, 50.0, 1.0, 50.0}, ""});
  bundle.processes.push_back({2, 1, {7.0}, ""});
  std::vector<std::string> told;
  for (const Diagnostic& d : PlanTransfer(bundle, {}).diagnostics) {
    const std::string arguments = ArgumentsText(d.detail);
    if (!arguments.empty()) told.push_back(arguments);
  }
  EXPECT_EQ(told, (std::vector<std::string>{"program=45", "kind=1 process=3", "schedule=7"}));
}

TEST(ToolArguments, ProcessDefinitionsSayWhichAndHowMany) {
  EXPECT_EQ(FirstArguments(CheckProcess({1, 4, {1.0, 2.0}, ""}), 7019),
            "kind=1 process=4 values=2");
  EXPECT_EQ(FirstArguments(CheckProcess({1, 4, {10.0, 101.0, 1.0, 50.0}, ""}), 7004),
            "kind=1 process=4 name='power'");
}

TEST(ToolArguments, FilesAreNamed) {
  const Status text = CheckIsText("a.S", std::string_view("GO 1\0", 5));
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().detail, "a.S is no text: byte 4 is zero");
  EXPECT_EQ(ArgumentsText(text.error().detail), "file='a.S' byte=4");
  const std::string arguments[] = {"part.txt"};
  const auto request = ReadConvertArguments(arguments);
  ASSERT_FALSE(request);
  EXPECT_EQ(ArgumentsText(request.error().detail), "file='part.txt'");
}

// What CONVERT says of a line that is none goes on knowing what the parser knew.
TEST(ToolArguments, WhatIsHandedOnIsKept) {
  const Conversion converted = Convert("MOVE (1, 2)\n", Direction::kToInch);
  ASSERT_EQ(converted.diagnostics.size(), 1U);
  EXPECT_EQ(converted.diagnostics[0].detail, "the line is copied: MOVE has 2 values, needs 5");
  EXPECT_EQ(ArgumentsText(converted.diagnostics[0].detail), "instruction='MOVE' values=2 needed=5");
}

}  // namespace
}  // namespace rmlcell::optimo
