// What `rmlcell check` tells of a program beside its findings, as text and as JSON.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "clients/cli/local.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// Turns A so fast that a contour is held back; what is wrong with it is no error.
constexpr const char* kHeldBack =
    "COORD ABSOL\nPATH LIN\nSPEED 60\nMOVE (1000.,1000.,-400.,0.,0.)\nWORKDEF 1,0 (8.,75.,1.,50.)\n"
    "WORK 1,0/ON\nMOVE (1010.,1000.,-400.,1.5,0.)\nMOVE (1020.,1010.,-400.,0.,0.)\nWORK 1,0/OFF\n";
constexpr const char* kStandard =
    "machine       Optimo of 30 m/min with ARROW laser (standard): no profile was named\n";

class CheckTold : public testing::Test {
 protected:
  CheckTold() { ::setenv("NO_COLOR", "1", 1); }
  Told Checked(const std::vector<std::string>& files, CheckOptions options = {}) const {
    options.files = files;
    return Hear([&] { return Check(options); });
  }
  static std::vector<nlohmann::json> LinesOf(const Told& told) {
    std::vector<nlohmann::json> lines;
    std::istringstream text(told.output);
    for (std::string line; std::getline(text, line);)
      lines.push_back(nlohmann::json::parse(line, nullptr, false));
    return lines;
  }

  CliFolder folder_;
};

// With errors alone the advice goes, of the text and of the motion; the verdict stays.
TEST_F(CheckTold, ErrorsAloneAreWithoutAdvice) {
  const std::string file = folder_.Put("1.S", kHeldBack);
  const Told all = Checked({file});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_THAT(all.output, AllOf(HasSubstr("1.S:7: advice OPT-E7321: "),
                                HasSubstr("\n" + file + ": DOUBTFUL, 7 findings\n")));
  const Told errors =
      Checked({file}, {.files = {}, .machine = {}, .inputs_file = {}, .errors_only = true});
  EXPECT_EQ(errors.exit_code, 0);
  EXPECT_THAT(errors.output, StartsWith(file + ": DOUBTFUL\n  100.0 % of a contour is cut below "));
  EXPECT_THAT(errors.output, Not(HasSubstr("OPT-E7321")));
}

// Where it fails it is told how far it was looked at, and which machine it was for.
TEST_F(CheckTold, HowFarAMotionWasFollowed) {
  const std::string file = folder_.Put(
      "1.S", "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\nWAIT (IL[16])\nMOVE (9000.,0.,0.,0.,0.)\n");
  const Told told = Checked({file});
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(
      told.output,
      HasSubstr("\n" + file + ": BAD, 1 finding\n  motion checked only up to step 3, line 3: "));
  EXPECT_THAT(told.output, HasSubstr(kStandard));
  EXPECT_THAT(told.output, HasSubstr("\n  steps 4, source_bytes 76, "));
}

// A family's rows, each once, in place of a line of all its figures.
TEST_F(CheckTold, FiguresOfAMillAreRows) {
  const Told told = Checked({folder_.Put("a.rml", "PA;!PZ-10,10;PU0,0;PD500,0;PU;")});
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.output, HasSubstr("\ncommands      5\nmotions       4\npath          cut "));
  EXPECT_THAT(told.output, Not(HasSubstr("cut_length")));
}

TEST_F(CheckTold, WhoseMachineItIs) {
  CheckOptions options;
  options.machine.file =
      folder_.Put("mine.toml",
                  "family = \"optimo\"\nname = \"Hall 3\"\n[parameters]\nVMAX = 300\n"
                  "[sources]\nVMAX = \"its plate\"\n");
  const Told told = Checked({folder_.Put("1.S", "SPEED 5\n")}, options);
  EXPECT_THAT(told.output, HasSubstr("\nmachine       Hall 3"));
  EXPECT_THAT(told.output,
              HasSubstr("\nchanged       VMAX 300 (profile: 500; source: its plate); by " +
                        options.machine.file + "\n"));
}

// One that cannot be read keeps nobody from hearing of the others, in either form.
TEST_F(CheckTold, AFileThatIsNotThereIsOneOfThem) {
  const std::string none = folder_.File("none.S");
  const std::string good = folder_.Put("1.S", "SPEED 5\n");
  const Told text = Checked({none, good});
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_THAT(text.output, StartsWith(good + ": GOOD\n"));
  EXPECT_THAT(text.output, Not(HasSubstr("{")));
  EXPECT_THAT(text.errors, AllOf(StartsWith("rmlcell: CELL-E9022: "), HasSubstr(none)));
  const Told told =
      Checked({none, good}, {.files = {}, .machine = {}, .inputs_file = {}, .json = true});
  EXPECT_EQ(told.exit_code, 1);
  const std::vector<nlohmann::json> lines = LinesOf(told);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0]["file"], none);
  EXPECT_EQ(lines[0]["ok"], false);
  EXPECT_EQ(lines[0]["family"], "optimo");
  EXPECT_EQ(lines[0]["diagnostics"][0]["code"], "CELL-E9022");
  EXPECT_EQ(lines[0]["diagnostics"][0]["message"], none);
  EXPECT_EQ(lines[0]["diagnostics"][0]["place"]["file"], none);
  EXPECT_EQ(lines[1]["file"], good);
  EXPECT_EQ(lines[1]["ok"], true);
}

// A file that is a wrong call ends it: those behind it stay as they are.
TEST_F(CheckTold, NothingIsRepairedBehindAWrongCall) {
  CheckOptions options;
  options.fix = true;
  const std::string object = folder_.Put("1.S", std::string("OB\0\x01\xff", 5));
  const std::string text = "SPEDE 20\nSPEED 101\n";
  const std::string later = folder_.Put("2.S", text);
  EXPECT_EQ(Checked({object, later}, options).exit_code, 2);
  EXPECT_EQ(folder_.Read("2.S"), text);
  const Told told = Checked({later}, options);
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(folder_.Read("2.S"), "SPEED 20\nSPEED 101\n");
  // What was repaired is told first, then what is left, with its place.
  EXPECT_THAT(told.output, StartsWith("fixed  " + later + ":1:1: error OPT-E7011: 'SPEDE' is no "));
  EXPECT_THAT(told.output, HasSubstr("\n" + later + ":2:7: error OPT-E7004: "));
  EXPECT_THAT(told.output,
              HasSubstr("\n  SPEED 101\n        ^~~\n" + later + ": 1 fixed, BAD, 1 finding\n"));
}

// By its number or by its name.
TEST_F(CheckTold, CodesThatMayBeMeantAreNamed) {
  const Told told = Hear([] { return Explain({"OPT-E34X", "HOLE_RADIUS_ZER"}, false); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, StartsWith("rmlcell: no error 'OPT-E34X'; did you mean OPT-E348"));
  EXPECT_THAT(told.errors,
              HasSubstr("\nrmlcell: no error 'HOLE_RADIUS_ZER'; did you mean HOLE_RADIUS_ZERO?"));
}

// An override is within what one of the machines takes; inputs act at their times.
TEST_F(CheckTold, InputsAreThoseOfAnyMachine) {
  const std::string waits =
      folder_.Put("1.S", "COORD ROBOT\nWAIT (IL[16])\nMOVE (9000.,0.,0.,0.,0.)\n");
  CheckOptions options;
  options.inputs_file = folder_.Put("keys.txt", "0.5 OVERRIDE = 145\n1.5 IL[16] = 1\n");
  const Told told = Checked({waits}, options);
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, HasSubstr("(step 3, at 1.500 s)"));
  options.inputs_file = folder_.Put("keys.txt", "0.5 OVERRIDE = 146\n");
  EXPECT_THAT(Checked({waits}, options).errors, HasSubstr("allowed are above 0 to 145 %"));
}

// What a repair leaves is told as a check tells it, the advice of the motion with it.
TEST_F(CheckTold, ARepairTellsAdviceOfTheMotionUnlessErrorsAreWanted) {
  const std::string file = folder_.Put("1.S", kHeldBack);
  CheckOptions options;
  options.fix = true;
  const Told all = Checked({file}, options);
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_THAT(all.output, HasSubstr("1.S:7: advice OPT-E7321: "));
  options.errors_only = true;
  const Told errors = Checked({file}, options);
  EXPECT_EQ(errors.exit_code, 0);
  EXPECT_THAT(errors.output, StartsWith(file + ": 0 fixed, DOUBTFUL\n"));
  EXPECT_THAT(errors.output, Not(HasSubstr("OPT-E7321")));
}

}  // namespace
}  // namespace rmlcell::cli
