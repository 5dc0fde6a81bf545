// What a run tells beside its figures: its own findings, how far it is, its path, and whose
// parameters it has.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "clients/cli/local.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/rml1_tools.h"
#include "engine/families/families.h"
#include "engine/simulation/toolpath/toolpath.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/framing.h"
#include "tests/clients/cli/cli_folder.h"
#include "tests/clients/cli/on_terminal.h"

namespace rmlcell::cli {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

class ToldRuns : public testing::Test {
 protected:
  ToldRuns() { ::setenv("NO_COLOR", "1", 1); }
  SimulateOptions Of(const std::string& name, const std::string& text) const {
    SimulateOptions options;
    options.files = {folder_.Put(name, text)};
    return options;
  }
  static Told Run(const SimulateOptions& options) {
    return Hear([&] { return Simulate(options); });
  }

  CliFolder folder_;
};

// Beside those of the text, which are told before.
TEST_F(ToldRuns, WhatOnlyTheRunFindsIsTold) {
  const Told told = Run(Of("7.S", "VR[1] = 0.\nVR[0] = 1. / VR[1]\n"));
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, HasSubstr("\nprogram 7:2: error OPT-E7201: "));
}

// Nothing runs, and whoever asked for facts, JSON or a text has a verdict all the same.
TEST_F(ToldRuns, AProgramThatCannotRunHasItsVerdict) {
  SimulateOptions options = Of("12.S", "SPEED 101\n");
  options.machine.profile = "efa-51";
  options.facts = true;
  const Told facts = Run(options);
  EXPECT_EQ(facts.exit_code, 1);
  for (const char* line :
       {"family: optimo\n", "\nprofile: efa-51\n", "\nprofile_named: yes\n", "\noutcome: failed\n",
        "\noutcome_code: OPT-E7004\n", "\nverdict: BAD\n", "\nverdict_codes: OPT-E7004\n"})
    EXPECT_THAT(facts.output, HasSubstr(line));
  options.facts = false;
  options.json = true;
  const Told json = Run(options);
  EXPECT_EQ(json.exit_code, 1);
  const auto found = nlohmann::json::parse(json.output, nullptr, false);
  EXPECT_EQ(found["family"], "optimo");
  EXPECT_EQ(found["profile"], "efa-51");
  EXPECT_EQ(found["verdict"], "VERDICT_BAD");
  EXPECT_EQ(found["diagnostics"][0]["code"], "OPT-E7004");
  // Of one program the line is shown with what is wrong in it.
  options.json = false;
  EXPECT_THAT(Run(options).output, HasSubstr("SPEED 101\n"));
}

// What the text counts of a kind, past the thousand that are kept, the run finds again and does not
// tell again.
TEST_F(ToldRuns, WhatIsOnlyCountedIsToldOnce) {
  std::string stream = "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\n";
  for (int line = 0; line < 1010; ++line) stream += "PU1,1;PU2,2;PU3,3;QQ;\n";
  SimulateOptions options = Of("a.rml", stream + "PD30000,100;\nPD30000,200;PU0,0;!MC0;\n");
  options.machine.profile = "srm-20";
  const Told told = Run(options);
  EXPECT_EQ(told.exit_code, 1);
  const std::string counted = " (2 times, lines 1012 to 1013)\n";
  const std::size_t first = told.output.find(counted);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(told.output.find(counted, first + 1), std::string::npos);
  EXPECT_THAT(told.output, Not(HasSubstr(" more finding")));
}

// Of a run that ends before its text does, what the text counts more of is not told again either.
TEST_F(ToldRuns, WhatARunCountsLessOfIsToldOnce) {
  std::string stream = "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\n";
  for (int line = 0; line < 1500; ++line) stream += "PU1,1;PU2,2;PU3,3;QQ;\n";
  SimulateOptions options = Of("a.rml", stream + "PU0,0;!MC0;\n");
  options.machine.profile = "srm-20";
  options.budget = "steps=4400";
  const Told told = Run(options);
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, HasSubstr("\noutcome       budget exceeded"));
  // Five of the kind are shown, each with its place, and the others counted in one line.
  std::size_t shown = 0;
  for (std::size_t at = 0; (at = told.output.find("RML1-E1: ", at)) != std::string::npos; ++at)
    ++shown;
  EXPECT_EQ(shown, 5U) << told.output;
  EXPECT_THAT(told.output, HasSubstr("\nand 1495 more RML1-E1, lines 7 to 1501\n"));
}

// Slices of ten seconds; every sixteenth is told, with one decimal.
TEST_F(ToldRuns, ALongRunSaysHowFarItIs) {
  const SimulateOptions options = Of("a.S", "DELAY 99.\nDELAY 99.\n");
  std::string output;
  const auto run = [&](const SimulateOptions& asked) {
    return OnErrors([&] {
      testing::internal::CaptureStdout();
      EXPECT_EQ(Simulate(asked), 0);
      output = testing::internal::GetCapturedStdout();
    });
  };
  const std::string shown = run(options);
  EXPECT_THAT(shown, HasSubstr("  160.0 s of virtual time"));
  EXPECT_THAT(shown, Not(HasSubstr("150.0 s")));
  EXPECT_THAT(shown, EndsWith("\r\x1b[K"));
  EXPECT_THAT(output, HasSubstr("\ncycle time    3 min 18.000 s\n"));
  SimulateOptions quiet = options;
  quiet.json = true;
  EXPECT_EQ(run(quiet), "");
}

// docs/toolpath.md: one frame a block, to the end of the path.
TEST_F(ToldRuns, AToolpathIsWholeHoweverLong) {
  constexpr int kPoints = 2 * static_cast<int>(simulation::kToolpathBlockPoints) + 10;
  std::string stream = "PA;!PZ-10,10;PU0,0;";
  for (int k = 1; k <= kPoints; ++k)
    stream += "PD" + std::to_string(k) + "," + std::to_string(k % 2 * 50) + ";\n";
  SimulateOptions options = Of("a.rml", stream);
  options.machine.profile = "t1";
  options.toolpath = folder_.File("path");
  ASSERT_EQ(Run(options).exit_code, 0);
  const std::string bytes = folder_.Read("path");
  std::string_view rest = bytes;
  std::size_t blocks = 0;
  std::int32_t farthest_um = 0;
  while (const auto frame = bridge::TakeFrame(rest)) {
    const auto block = simulation::DecodeToolpathBlock(*frame);
    ASSERT_TRUE(block);
    ++blocks;
    for (const simulation::ToolpathPoint& point : block->points)
      farthest_um = std::max(farthest_um, point.x_um);
  }
  EXPECT_TRUE(rest.empty());
  EXPECT_GE(blocks, 3U);
  EXPECT_EQ(farthest_um, kPoints * 10);  // 100 units in a mm
}

// To standard output, in place of the report: the curves that are asked for and no others.
TEST_F(ToldRuns, CurvesAreThoseThatAreAskedFor) {
  // "speed", "axes": what is drawn of the two.
  const auto drawn = [&](const std::string& curves) {
    SimulateOptions options = Of("7.S", "COORD ABSOL\nSPEED 20\nMOVE (100.,1000.,-400.,0.,0.)\n");
    options.plot = {curves, "-"};
    const std::string svg = Run(options).output;
    std::string all = svg.find(">tip speed<") != std::string::npos ? "speed " : "";
    if (svg.find(">X</text>") != std::string::npos) all += "axes ";
    return all;
  };
  EXPECT_EQ(drawn("speed"), "speed ");
  EXPECT_EQ(drawn("axes"), "axes ");
  EXPECT_EQ(drawn("speed,axes"), "speed axes ");
}

// A picture of the work has other numbers than one of the machine on which it lies elsewhere.
TEST_F(ToldRuns, APictureIsOfTheWorkOrOfTheMachine) {
  SimulateOptions options = Of("a.rml", "PA;!PZ-10,10;PU0,0;PD500,0;PD500,500;PU;");
  options.machine.profile = "srm-20";
  options.svg = "-";
  options.machine_coordinates = true;
  const std::string at_zero_of_machine = Run(options).output;
  options.machine.origin = {50.0, 40.0};
  const std::string of_machine = Run(options).output;
  options.machine_coordinates = false;
  const std::string of_work = Run(options).output;
  EXPECT_TRUE(of_work != of_machine);
  EXPECT_TRUE(of_machine != at_zero_of_machine);
  // As JSON each thing that happened is told where that is wanted, and nowhere else.
  SimulateOptions traced = Of("b.rml", "PA;!PZ-10,10;PU0,0;PD500,0;PU;");
  traced.json = traced.trace = true;
  const auto with = nlohmann::json::parse(Run(traced).output, nullptr, false);
  EXPECT_GT(with["traceRecords"].size(), 3U);
  EXPECT_EQ(with["steps"].size(), 5U);  // each by itself
  traced.trace = false;
  const auto without = nlohmann::json::parse(Run(traced).output, nullptr, false);
  EXPECT_EQ(without["traceRecords"].size(), 0U);
}

// Files without a number are programs 1, 2 and so on, past those that have one.
TEST_F(ToldRuns, ProgramsWithoutANumberGetTheFirstFreeOnes) {
  const std::string main = folder_.Put("main.S", "VI[2] = 1\n");
  const std::string two = folder_.Put("2.S", "VI[2] = 2\n");
  const std::string other = folder_.Put("other.S", "VI[2] = 3\n");
  const auto slots = [](const Result<LoadedFiles>& loaded) {
    std::vector<int> found;
    for (const simulation::MemoryProgram& program : loaded->programs) found.push_back(program.slot);
    return found;
  };
  const auto alone = LoadFiles({main}, {}, 0, "");
  ASSERT_TRUE(alone);
  EXPECT_EQ(slots(alone), std::vector<int>{1});
  EXPECT_EQ(alone->main_slot, 1);
  const auto three = LoadFiles({main, two, other}, {}, 0, "");
  ASSERT_TRUE(three);
  EXPECT_EQ(slots(three), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(three->main_slot, 1);
  const auto chosen = LoadFiles({main, other}, {}, 7, "");
  ASSERT_TRUE(chosen);
  EXPECT_EQ(slots(chosen), (std::vector<int>{7, 1}));
  EXPECT_EQ(chosen->main_slot, 7);
}

// Each figure of a profile with where it is from, as people and as scripts read it.
TEST_F(ToldRuns, ParametersSayWhereTheyAreFrom) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  const auto profile = std::ranges::find(mill.profiles(), "srm-20", &machine::MachineProfile::id);
  ASSERT_NE(profile, mill.profiles().end());
  const Told text = Hear([] { return ListParameters("rml1", "srm-20", false); });
  const Told json = Hear([] { return ListParameters("rml1", "srm-20", true); });
  const auto listed = nlohmann::json::parse(json.output, nullptr, false)["parameters"];
  std::size_t sources = 0;
  for (const machine::ParameterValue& value : profile->values) {
    if (value.source.empty()) continue;
    ++sources;
    const std::string name(value.name);
    EXPECT_THAT(text.output,
                HasSubstr("\n# source: " + std::string(value.source) + "\n" + name + " = "));
    const auto row =
        std::ranges::find_if(listed, [&](const auto& one) { return one["name"] == name; });
    ASSERT_NE(row, listed.end()) << name;
    EXPECT_EQ((*row)["source"], std::string(value.source)) << name;
  }
  EXPECT_GT(sources, 3U);
}

// The places of the work are of the machine where that is asked for.
TEST_F(ToldRuns, FiguresOfACheckMayBeThoseOfTheMachine) {
  const machine::MachineFamily& mill = *families::FindFamily("rml1");
  const std::vector<machine::Figure> figures = {{.name = "machine_mm.xmin", .value = 1.5},
                                                {.name = "machine_mm.xmax", .value = 2.25},
                                                {.name = "commands", .value = 3.0}};
  EXPECT_THAT(FigureRows(mill, figures, Zero::kMachine),
              EndsWith("machine X     from 1.500 mm, to 2.250 mm\n"));
  EXPECT_THAT(FigureRows(mill, figures, Zero::kWork), Not(HasSubstr("machine X")));
  EXPECT_THAT(FigureRows(mill, figures, Zero::kWork), HasSubstr("commands      3\n"));
}

TEST_F(ToldRuns, AnInterruptedRunSaysSo) {
  v1::Outcome outcome;
  outcome.set_kind(v1::Outcome::KIND_INTERRUPTED);
  EXPECT_EQ(OutcomeLine(outcome), "interrupted");
}

// A line of JSON comes of it all the same, the last one of what is printed.
TEST_F(ToldRuns, AnErrorOfAnUnknownKindIsStillALine) {
  google::rpc::Status status;
  status.set_code(3);
  status.set_message("no");
  EXPECT_EQ(Hear([&] { return PrintJson(status), 0; }).output,
            "{\"code\":3,\"message\":\"no\",\"details\":[]}\n");
  status.add_details()->set_type_url("type.googleapis.com/of.another.World");
  status.mutable_details(0)->set_value("\x08\x01");
  EXPECT_EQ(Json(status), "{}");
  EXPECT_THAT(Hear([&] { return PrintJson(status), 0; }).output, EndsWith("{}\n"));
}

// Of a stream whose lines are those of the file, and its columns are not: the line alone.
TEST_F(ToldRuns, AMovedStreamIsRefusedAtItsLine) {
  MoveToolOptions move;
  move.file = folder_.Put(
      "a.rml", "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\nPU5,5; PD30000,100;PU0,0;!MC0;\n");
  move.output = folder_.File("b.rml");
  move.machine.profile = "srm-20";
  move.by_mm = {1.0, 1.0};
  move.json = true;
  const Told told = Hear([&] { return MoveMillStream(move); });
  EXPECT_EQ(told.exit_code, 1);
  const auto found = nlohmann::json::parse(told.output, nullptr, false)["findings"]["diagnostics"];
  ASSERT_EQ(found.size(), 1U) << told.output;
  EXPECT_EQ(found[0]["place"]["line"], 2);
  EXPECT_EQ(found[0]["place"]["column"], 1);
  EXPECT_EQ(found[0]["place"]["length"], 1);
}

}  // namespace
}  // namespace rmlcell::cli
