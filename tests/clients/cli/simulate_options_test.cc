// What `rmlcell simulate` understands of its options: docs/files.md, "Running a program".
#include "clients/cli/simulate_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "clients/cli/local.h"
#include "clients/cli/text_tools.h"
#include "engine/families/families.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const machine::MachineFamily& ALaser() { return *families::FindFamily("optimo"); }

void ExpectUsage(const Error& error, const std::string& detail) {
  EXPECT_EQ(error.code, ErrorCode::kCellUsage);
  EXPECT_THAT(error.detail, HasSubstr(detail));
}

TEST(SimulateOptions, ABudgetIsStepsAndSecondsInAnyOrder) {
  const auto both = ParseBudget("time=1.5,steps=1000");
  ASSERT_TRUE(both);
  EXPECT_EQ(both->steps(), 1000);
  EXPECT_EQ(both->virtual_time_ns(), 1'500'000'000);
  const auto none = ParseBudget("");
  ASSERT_TRUE(none);
  EXPECT_EQ(none->steps(), 0);  // no limit of its own
  EXPECT_EQ(none->virtual_time_ns(), 0);
  EXPECT_EQ(ParseBudget("steps=1")->steps(), 1);
  EXPECT_EQ(ParseBudget("time=1e-9")->virtual_time_ns(), 1);
}

TEST(SimulateOptions, ABudgetOfNothingOfPartsOfStepsOrOfWordsIsRefused) {
  for (const char* text :
       {"steps=0", "steps=-1", "steps=0.5", "steps=1e300", "steps=", "steps", "time=0", "time=-2",
        "time=inf", "time=x", "10", "speed=3", "steps=1,,time=2", "steps=1;time=2"}) {
    const auto budget = ParseBudget(text);
    ASSERT_FALSE(budget) << text;
    ExpectUsage(budget.error(), "write steps=N,time=SECONDS");
  }
}

TEST(SimulateOptions, EveryModeHasItsName) {
  const std::map<std::string, v1::OperatingMode> modes = {{"cycle", v1::OPERATING_MODE_CYCLE},
                                                          {"remote", v1::OPERATING_MODE_REMOTE},
                                                          {"single", v1::OPERATING_MODE_SINGLE},
                                                          {"repeat", v1::OPERATING_MODE_REPEAT}};
  for (const auto& [name, mode] : modes) {
    SimulateOptions options;
    options.mode = name;
    const auto message = OptionsMessage(options, ALaser());
    ASSERT_TRUE(message) << name;
    EXPECT_EQ(message->mode(), mode) << name;
  }
  SimulateOptions options;
  options.mode = "Cycle";
  ExpectUsage(OptionsMessage(options, ALaser()).error(), "cycle, remote, single, repeat");
}

TEST(SimulateOptions, APlaceIsAStepOfTheMainProgramOrOfOneThatIsNamed) {
  SimulateOptions options;
  options.simul = "45/7";
  options.breakpoint = "12";
  const auto message = OptionsMessage(options, ALaser());
  ASSERT_TRUE(message);
  EXPECT_EQ(message->simul().program(), 45);
  EXPECT_EQ(message->simul().step(), 7);
  EXPECT_EQ(message->breakpoints(0).step().program(), 0);  // whichever is started
  EXPECT_EQ(message->breakpoints(0).step().step(), 12);

  options.simul = "1/1";
  const auto first = OptionsMessage(options, ALaser());
  ASSERT_TRUE(first);
  EXPECT_EQ(first->simul().program(), 1);
  EXPECT_EQ(first->simul().step(), 1);
  options.simul = "off";
  options.breakpoint.clear();
  const auto off = OptionsMessage(options, ALaser());
  ASSERT_TRUE(off);
  EXPECT_TRUE(off->has_simul());  // switches off what the machine had
  EXPECT_EQ(off->simul().step(), 0);
  EXPECT_TRUE(off->breakpoints().empty());  // leaves it as it is
}

TEST(SimulateOptions, APlaceThatCannotBeIsRefused) {
  for (const char* text : {"0/7", "100/7", "-1/7", "45/0", "45/-1", "45/", "/7", "45/7/1", "x", "",
                           "0", "45/1000000001", "Off"}) {
    if (*text == '\0') continue;  // not given
    SimulateOptions simul;
    simul.simul = text;
    const auto message = OptionsMessage(simul, ALaser());
    ASSERT_FALSE(message) << text;
    ExpectUsage(message.error(), "write PROGRAM/STEP");
    SimulateOptions breakpoint;
    breakpoint.breakpoint = text;
    EXPECT_FALSE(OptionsMessage(breakpoint, ALaser())) << text;
  }
  SimulateOptions last;
  last.simul = "99/1000000000";
  EXPECT_TRUE(OptionsMessage(last, ALaser()));
}

TEST(SimulateOptions, AnOverrideIsWithinWhatTheMachineHas) {
  SimulateOptions options;
  options.override_percent = ALaser().info().override_max_percent;
  EXPECT_TRUE(OptionsMessage(options, ALaser()));
  options.override_percent += 1.0;
  ExpectUsage(OptionsMessage(options, ALaser()).error(), "--override: ");
}

TEST(SimulateOptions, InputsComeFromTheirFile) {
  const CliFolder folder;
  SimulateOptions options;
  options.inputs_file = folder.File("missing.txt");
  EXPECT_EQ(OptionsMessage(options, ALaser()).error().code, ErrorCode::kCellFileUnreadable);
}

// A place in a program that is not there would never be reached, and nobody would know why.
TEST(SimulateOptions, APlaceNamesAProgramThatIsThere) {
  const std::vector<simulation::MemoryProgram> programs = {{.slot = 45}, {.slot = 7}};
  v1::SimulationOptions options;
  EXPECT_TRUE(CheckPlaces(options, programs).ok());
  options.mutable_simul()->set_program(7);
  options.add_breakpoints()->mutable_step()->set_step(3);  // of the main program
  EXPECT_TRUE(CheckPlaces(options, programs).ok());
  options.mutable_breakpoints(0)->mutable_step()->set_program(8);
  ExpectUsage(CheckPlaces(options, programs).error(), "there is no program 8");
  options.mutable_simul()->set_program(9);
  ExpectUsage(CheckPlaces(options, programs).error(), "there is no program 9");
}

TEST(SimulateOptions, AnExecutableIsMadeOfAProgramThatIsThere) {
  std::vector<simulation::MemoryProgram> programs = {{.slot = 45}, {.slot = 7}};
  const auto to_make = AddExecutables({"7", "45"}, ALaser(), programs);
  ASSERT_TRUE(to_make);
  EXPECT_THAT(*to_make, ElementsAre(7, 45));
  ExpectUsage(AddExecutables({"8"}, ALaser(), programs).error(), "there is no such program");
  EXPECT_EQ(AddExecutables({"100"}, ALaser(), programs).error().code, ErrorCode::kProgramNumber);
}

TEST(SimulateOptions, AnExecutableThatIsBroughtMustBeOne) {
  const CliFolder folder;
  std::vector<simulation::MemoryProgram> programs = {{.slot = 45}};
  const std::string bad = folder.Put("45.exe", "no executable");
  EXPECT_FALSE(AddExecutables({"45=" + bad}, ALaser(), programs));
  EXPECT_EQ(AddExecutables({"45=" + folder.File("none")}, ALaser(), programs).error().code,
            ErrorCode::kCellFileUnreadable);
  EXPECT_TRUE(programs.front().executable->empty());
}

TEST(SimulateOptions, AnExecutableGoesToItsProgram) {
  const CliFolder folder;
  LinkOptions link;
  link.files = {folder.Put("12.S", "FUNCTION 44\n"), folder.Put("44.S", "VR[0] = 1.\n")};
  link.main_slot = 12;
  link.output = folder.File("112.X");
  ASSERT_EQ(Hear([&] { return Link(link); }).exit_code, 0);
  std::vector<simulation::MemoryProgram> programs = {{.slot = 45}};
  ExpectUsage(AddExecutables({"12=" + link.output}, ALaser(), programs).error(),
              "there is no program 12");
  programs.push_back({.slot = 12});
  const auto to_make = AddExecutables({"12=" + link.output}, ALaser(), programs);
  ASSERT_TRUE(to_make);
  EXPECT_TRUE(to_make->empty());  // it is there
  EXPECT_EQ(std::string(*programs.back().executable), folder.Read("112.X"));
  EXPECT_TRUE(programs.front().executable->empty());
}

// A second stream would be loaded and never run.
TEST(Simulating, OneStreamAtATime) {
  const CliFolder folder;
  SimulateOptions options;
  options.files = {folder.Put("a.rml", "PU;"), folder.Put("b.rml", "PU;")};
  const Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_THAT(told.errors, testing::StartsWith("rmlcell: CELL-E9026: 2 programs for a machine"));
}

// OPT-2.35: nothing runs, and there is a verdict all the same, in each form.
TEST(Simulating, AProgramThatCannotRunHasAVerdict) {
  const CliFolder folder;
  SimulateOptions options;
  options.files = {folder.Put("a.S", "SPEED 101\n")};
  options.machine.profile = "pw-1993";
  Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, HasSubstr("a.S:1:7: error OPT-E7004: "));
  EXPECT_THAT(told.output, testing::EndsWith("\n  SPEED 101\n        ^~~\nverdict       BAD\n"));
  options.facts = true;
  told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, testing::StartsWith("family: optimo\nprofile: pw-1993\n"));
  for (const char* fact : {"\noutcome: failed\n", "\noutcome_code: OPT-E7004\n", "\nverdict: BAD\n",
                           "\nverdict_codes: OPT-E7004\n"})
    EXPECT_THAT(told.output, HasSubstr(fact));
  options.facts = false;
  options.json = true;
  told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 1);
  const auto found = nlohmann::json::parse(told.output, nullptr, false);
  EXPECT_EQ(found["ok"], false);
  EXPECT_EQ(found["family"], "optimo");
  EXPECT_EQ(found["profile"], "pw-1993");
  EXPECT_EQ(found["verdict"], "VERDICT_BAD");
  EXPECT_EQ(found["reasons"][0]["code"], "OPT-E7004");
}

// Those that the machine has are shown all the same.
TEST(Simulating, AVariableThatIsNoneIsNamed) {
  const CliFolder folder;
  SimulateOptions options;
  options.files = {folder.Put("a.S", "VI[2] = 7\n")};
  options.variables = "ZZ[1],VI[2]";
  const Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.errors, "rmlcell: the machine has no variable ZZ[1]\n");
  EXPECT_THAT(told.output, HasSubstr("\nVI[2]         7\n"));
}

// RML1-2.09: what is no command is found in the text and again when it runs, and told once: five of
// them, and how many more, though a thousand are kept and the others counted.
TEST(Simulating, WhatWasFoundBeforeIsNotToldAgain) {
  const CliFolder folder;
  std::string stream = "PU0,0;\n";
  for (int line = 0; line < 1010; ++line) stream += "PU1,1;PU2,2;PU3,3;QQ;\n";
  SimulateOptions options;
  options.files = {folder.Put("a.rml", stream)};
  options.machine.profile = "srm-20";
  const Told told = Hear([&] { return Simulate(options); });
  const auto count = [&](const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = told.output.find(part); at != std::string::npos;
         at = told.output.find(part, at + 1))
      ++found;
    return found;
  };
  EXPECT_EQ(count(" RML1-E1: "), 5U);
  EXPECT_EQ(count("and 1005 more RML1-E1, lines 7 to 1011\n"), 1U);
  EXPECT_EQ(count("\nand "), 1U) << told.output;
}

// RML1-2.09: a run that is cut short counts fewer than the text does; those are told by the text.
TEST(Simulating, WhatARunThatIsCutShortCountsIsNotToldAgain) {
  const CliFolder folder;
  std::string stream = "PU0,0;\n";
  for (int line = 0; line < 2000; ++line) stream += "PU1,1;PU2,2;PU3,3;QQ;\n";
  SimulateOptions options;
  options.files = {folder.Put("a.rml", stream)};
  options.machine.profile = "srm-20";
  options.budget = "steps=4100";  // behind a thousand of them, and before the last one
  const Told told = Hear([&] { return Simulate(options); });
  const auto count = [&](const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = told.output.find(part); at != std::string::npos;
         at = told.output.find(part, at + 1))
      ++found;
    return found;
  };
  EXPECT_EQ(count(" RML1-E1: "), 5U);
  EXPECT_EQ(count("and 1995 more RML1-E1, lines 7 to 2001\n"), 1U) << told.output;
  EXPECT_EQ(count(" more RML1-E1"), 1U) << told.output;
}

}  // namespace
}  // namespace rmlcell::cli
