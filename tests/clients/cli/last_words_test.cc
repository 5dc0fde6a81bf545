// What is told once, at the right place, or not at all: variables, the progress of a run, tables.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "clients/cli/local.h"
#include "clients/cli/simulate_options.h"
#include "clients/cli/terminal.h"
#include "clients/cli/text_tools.h"
#include "engine/families/families.h"
#include "tests/clients/cli/cli_folder.h"
#include "tests/clients/cli/on_terminal.h"

namespace rmlcell::cli {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class LastWords : public testing::Test {
 protected:
  LastWords() { ::setenv("NO_COLOR", "1", 1); }
  CliFolder folder_;
};

// The first that the machine does not have, behind those that it has.
TEST_F(LastWords, OneVariableThatIsNoneIsNamed) {
  SimulateOptions options;
  options.files = {folder_.Put("a.S", "VI[2] = 7\n")};
  options.variables = "VI[2],ZZ[1],YY[1]";
  const Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.errors, "rmlcell: the machine has no variable ZZ[1]\n");
  EXPECT_THAT(told.output, EndsWith("\nVI[2]         7\n"));
}

// The line of the progress is gone before anything else is said; it is shown for every 160 s.
TEST_F(LastWords, ProgressGivesWay) {
  SimulateOptions options;
  options.files = {folder_.Put("a.S", "DELAY 99.\nDELAY 99.\n")};
  options.variables = "ZZ[1]";
  const std::string shown = OnErrors([&] {
    testing::internal::CaptureStdout();
    EXPECT_EQ(Simulate(options), 0);
    testing::internal::GetCapturedStdout();
  });
  EXPECT_THAT(shown, Not(HasSubstr("  16.0 s of virtual time")));
  EXPECT_THAT(
      shown,
      EndsWith("  160.0 s of virtual time\r\x1b[Krmlcell: the machine has no variable ZZ[1]\n"));
}

// Elsewhere than on a terminal nobody looks on.
TEST_F(LastWords, WithoutATerminalThereIsNoProgress) {
  const Told told = Hear([] {
    ProgressLine line;
    line.Show(0.5, "half");
    line.Leave(1.0, "whole");
    return 0;
  });
  EXPECT_EQ(told.errors, "");
}

// Only a title gives way to a narrow terminal.
TEST_F(LastWords, ATableWithoutATitleKeepsItsWidth) {
  const std::vector<std::vector<std::string>> rows = {{"JOB", "MACHINE"}, {"1234567890", "mill-1"}};
  EXPECT_EQ(Table(rows, 5), Table(rows, 0));
  EXPECT_EQ(Table(rows, 5), "JOB         MACHINE\n1234567890  mill-1\n");
}

// What the text was told to be is judged by the run: a finding that makes it BAD says so.
TEST_F(LastWords, FindingsOfTheTextAreJudgedByTheRun) {
  SimulateOptions options;
  options.files = {
      folder_.Put("a.rml", "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\nPD30000,100;PU0,0;!MC0;\n")};
  options.machine.profile = "srm-20";
  const Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, StartsWith(options.files[0] + ":2:1: BAD RML1-E8002: "));
  // Behind a thousand others it is only counted, and judged all the same.
  std::string many = "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\n";
  for (int line = 0; line < 1010; ++line) many += "PU1,1;PU2,2;PU3,3;QQ;\n";
  folder_.Put("a.rml", many + "PD30000,100;\nPD30000,200;PU0,0;!MC0;\n");
  const Told counted = Hear([&] { return Simulate(options); });
  EXPECT_EQ(counted.exit_code, 1);
  EXPECT_THAT(counted.output, HasSubstr("\nBAD RML1-E8002: "));
  EXPECT_THAT(counted.output, HasSubstr(" (2 times, lines 1012 to 1013)\n"));
}

TEST_F(LastWords, TheOverrideIsThatOfTheOption) {
  SimulateOptions options;
  options.override_percent = 62.5;
  const auto message = OptionsMessage(options, *families::FindFamily("optimo"));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->override_percent(), 62.5);
}

// Programs that are wrong are compared no further.
TEST_F(LastWords, ADiffOfWrongProgramsEndsThere) {
  const DiffOptions options{.before = folder_.Put("a.S", "SPEED 101\n"),
                            .after = folder_.Put("b.S", "SPEED 5\n"),
                            .svg = folder_.File("d.svg"),
                            .machine = {}};
  const Told told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(folder_.Names(), Not(testing::Contains("d.svg")));
}

}  // namespace
}  // namespace rmlcell::cli
