// The least of what is told, and the ends of what is taken: of tables, screens, checks, runs and
// jobs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "clients/cli/findings_text.h"
#include "clients/cli/handbox_screen.h"
#include "clients/cli/local.h"
#include "clients/cli/messages.h"
#include "clients/cli/remote_call.h"
#include "clients/cli/rml1_tools.h"
#include "clients/cli/terminal.h"
#include "clients/cli/text_tools.h"
#include "clients/cli/tool_answer.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/job.pb.h"
#include "tests/clients/cli/cli_folder.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class LeastValues : public testing::Test {
 protected:
  LeastValues() { ::setenv("NO_COLOR", "1", 1); }
  CliFolder folder;
};

std::size_t TimesIn(const std::string& text, const std::string& part) {
  std::size_t times = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++times;
  return times;
}

// Less than one of anything is told as well.
TEST_F(LeastValues, HalvesAreToldInAReport) {
  v1::RunReport report;
  report.set_family("rml1");
  report.mutable_total();
  report.mutable_shortfall()->set_moves(2);
  v1::SlowMove& slow = *report.add_slow_moves();
  slow.mutable_place()->set_step(3);
  slow.set_count(2);
  report.add_contours()->set_pierce_energy_j(0.75);
  report.mutable_contours(0)->set_slow_length_mm(0.25);
  v1::MillingFigures& milling = *report.mutable_milling();
  milling.set_remaining_mm3(0.5);
  milling.set_deepest_cut_mm(0.25);
  const std::string text = ReportText(report);
  EXPECT_THAT(text, HasSubstr(" (2 times)\n"));
  EXPECT_THAT(text, HasSubstr(", 1 of them while it stands, 0.250 mm slow\n"));
  EXPECT_THAT(text, HasSubstr("0.500 mm3 left, the deepest cut 0.250 mm below the top\n"));
}

TEST_F(LeastValues, ATargetMovedByHalfAMillimetre) {
  const DiffOptions options{
      .before = folder.Put("a.S", "COORD ABSOL\nPATH LIN\nMOVE (1000,900,-500,0,0)\n"),
      .after = folder.Put("b.S", "COORD ABSOL\nPATH LIN\nMOVE (1000.5,900,-500,0,0)\n"),
      .svg = {},
      .machine = {}};
  EXPECT_THAT(Hear([&] { return Diff(options); }).output,
              HasSubstr("\n    target moved by 0.500 mm\n"));
}

// Those that are not shown may all be on the first line.
TEST_F(LeastValues, FindingsOfTheFirstLine) {
  v1::RunReport report;
  for (int finding = 0; finding < 7; ++finding) {
    v1::Diagnostic& made = *report.add_diagnostics();
    made.set_code("RML1-E1");
    made.mutable_place()->set_line(1);
  }
  EXPECT_THAT(ReportText(report), HasSubstr("\nand 2 more RML1-E1, line 1\n"));
}

TEST_F(LeastValues, ColumnsOfATableThatAreEmptyOrFirst) {
  EXPECT_EQ(Table({{"A", "", "C"}, {"b", "", "d"}}), "A    C\nb    d\n");
  EXPECT_EQ(Table({{"TITLE", "X"}, {std::string(20, 'x'), "1"}}, 12),
            "TITLE      X\n" + std::string(8, 'x') + "…  1\n");
}

// The first program of a machine, and a value as wide as its place.
TEST_F(LeastValues, AHandboxShowsProgramOneAndWideValues) {
  HandboxView view;
  view.marks = false;
  v1::MachineRun& run = *view.status.mutable_run();
  run.set_run(7);
  run.set_program(45);
  run.mutable_place()->set_program(1);
  run.mutable_place()->set_step(3);
  const auto axis = [&](const char* name, double value) {
    v1::AxisValue& made = *view.status.add_axes();
    made.set_axis(name);
    made.set_value(value);
  };
  axis("X", 12345.678);
  axis("Y", -12345.678);
  axis("Z", 1.5);
  std::string text;
  for (const std::string& line : HandboxLines(view)) text += line + "\n";
  EXPECT_THAT(text, HasSubstr("run 7, program 1, step 3"));
  EXPECT_THAT(text, HasSubstr("12345.678"));
  EXPECT_THAT(text, HasSubstr("-12345.678"));
  EXPECT_THAT(text, HasSubstr("    1.500"));
}

// The message of a call says what its findings do not.
TEST_F(LeastValues, ARefusalWithoutAnErrorAmongItsFindings) {
  const std::vector<Diagnostic> findings = {{.code = ErrorCode::kShortFly,
                                             .severity = Severity::kAdvice,
                                             .file = "12.S",
                                             .where = {.line = 3, .column = 1}}};
  const google::rpc::Status rich =
      bridge::ToRpcStatus({ErrorCode::kNameUndeclared, "has errors", {}}, findings, {});
  const grpc::Status status(static_cast<grpc::StatusCode>(rich.code()), "all in all",
                            rich.SerializeAsString());
  const Told told = Hear([&] { return Refused(status, {.server = "127.0.0.1:1"}); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_EQ(told.errors,
            "rmlcell: all in all\n"
            "rmlcell: and 1 more finding; rmlcell check of the file tells them\n");
}

// A server that says why it cannot is one that answers.
TEST_F(LeastValues, OneDetailIsEnoughForAnAnswer) {
  google::rpc::Status rich;
  rich.set_code(14);
  v1::ErrorDetail detail;
  detail.set_code("CELL-E9002");
  rich.add_details()->PackFrom(detail);
  const grpc::Status status(grpc::StatusCode::UNAVAILABLE, "it stops", rich.SerializeAsString());
  const Told told = Hear([&] { return Refused(status, {.server = "127.0.0.1:1"}); });
  EXPECT_EQ(told.exit_code, 3);
  EXPECT_EQ(told.errors, "rmlcell: it stops\n");
}

// By how much in each of three directions.
TEST_F(LeastValues, AMoveTellsItsThirdNumber) {
  MoveToolOptions move;
  move.file = folder.Put("a.rml", "PA;!PZ-50,200;PU100,100;PD200,100;PU0,0;");
  move.output = folder.File("b.rml");
  move.machine.profile = "srm-20";
  move.by_mm = {1.0, 2.0, -0.25};
  EXPECT_EQ(Hear([&] { return MoveMillStream(move); }).output,
            folder.File("b.rml") + ": moved by 1.000,2.000,-0.250 mm\n");
}

// A program has the number that its file names.
TEST_F(LeastValues, AProgramOfADiffKeepsItsNumber) {
  const std::string text = "COORD ROBOT\nPATH LIN\nMOVE (1.,0.,0.,0.,0.)\n";
  const DiffOptions options{.before = folder.Put("12.S", text),
                            .after = folder.Put("b.S", text + "SPEED 5\n"),
                            .svg = {},
                            .machine = {}};
  EXPECT_THAT(Hear([&] { return Diff(options); }).errors,
              AllOf(HasSubstr("12.S: failed at 12/3"), HasSubstr("b.S: failed at 1/3")));
}

// An origin beyond the travel, each number with three decimals at most.
TEST_F(LeastValues, ATravelHasThreeDecimals) {
  CheckOptions options;
  options.files = {folder.Put("a.rml", "PU;")};
  options.machine.file =
      folder.Put("m.toml", "family = \"rml1\"\n[parameters]\nX_MIN = -1.23456\nX_MAX = 98.76543\n");
  options.machine.origin = {123.45678, 0.0};
  const Told told = Hear([&] { return Check(options); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, HasSubstr("X 123.457 is beyond the travel, which is from -1.235 to "
                                     "98.765 mm"));
}

// A file whose name is no number may stand in any slot, and takes that of no other file.
TEST_F(LeastValues, AFileWithoutANumberTakesNoSlot) {
  CheckOptions options;
  options.files = {folder.Put("part.S", "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\n"),
                   folder.Put("1.S", "SPEED 5\n"), folder.Put("45.S", "CALL 1\n")};
  const Told told = Hear([&] { return Check(options); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.output, HasSubstr(folder.File("part.S") + ":2: error OPT-E7301: "));
  EXPECT_THAT(told.output, HasSubstr("\n" + folder.File("1.S") + ": GOOD\n"));
  EXPECT_THAT(told.output, HasSubstr("\n" + folder.File("45.S") + ": GOOD\n"));
}

// Each of several programs is followed.
TEST_F(LeastValues, EachFileOfACheckIsFollowed) {
  const std::string far = "COORD ROBOT\nMOVE (9000.,0.,0.,0.,0.)\n";
  CheckOptions options;
  options.files = {folder.Put("1.S", far), folder.Put("2.S", far), folder.Put("3.S", far)};
  const Told told = Hear([&] { return Check(options); });
  for (const char* name : {"1.S", "2.S", "3.S"})
    EXPECT_THAT(told.output, HasSubstr(folder.File(name) + ":2: error OPT-E7301: "));
}

// What goes to standard output goes there whole, however much it is.
TEST_F(LeastValues, LongResultsComeWhole) {
  std::string bytes;
  while (bytes.size() < 2 * machine::kReleaseEvery + 5)
    bytes += std::to_string(bytes.size()) + "\n";
  ToolAnswer answer("a.rml", false);
  const Told told = Hear([&] { return answer.Deliver(bytes, "-", "text"); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_TRUE(told.output == bytes) << told.output.size();
}

// Figures of a family that gives them no rows: all but those that are nothing.
TEST_F(LeastValues, AFigureOfOneIsTold) {
  CheckOptions options;
  options.files = {folder.Put("a.S", "SPEED 5\n")};
  const Told told = Hear([&] { return Check(options); });
  EXPECT_THAT(told.output, HasSubstr("\n  steps 1, source_bytes 8, object_bytes "));
  EXPECT_THAT(told.output, Not(HasSubstr("names")));
}

// What is found on the first line of a text is not told again when it runs.
TEST_F(LeastValues, AFindingOfTheFirstLineIsToldOnce) {
  SimulateOptions options;
  options.files = {folder.Put("a.rml", "QQ;PU0,0;!PZ-10,10;PD5,5;PU;")};
  options.machine.profile = "srm-20";
  const Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(TimesIn(told.output, " RML1-E1: "), 1U) << told.output;
}

// A run that takes longer than is looked at in one piece goes on to its end.
TEST_F(LeastValues, ARunOfManySlicesIsWhole) {
  SimulateOptions options;
  options.files = {folder.Put("a.S", "DELAY 25.\nVI[2] = 7\n")};
  options.variables = "VI[2]";
  const Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.output,
              AllOf(HasSubstr("\ncycle time    25.000 s\n"), HasSubstr("\nVI[2]         7\n"),
                    HasSubstr("\noutcome       completed\n")));
}

// Each product in its own file, and those that were not asked for nowhere.
TEST_F(LeastValues, ProductsOfARunGoToTheirFiles) {
  const std::string stream = "PA;!PZ-10,10;PU0,0;PD500,0;PD500,500;PU;";
  SimulateOptions options;
  options.files = {folder.Put("a.rml", stream)};
  options.machine.profile = "srm-20";
  options.svg = folder.File("p.svg");
  options.plot = {"speed,axes", folder.File("c.svg")};
  options.samples = {"10", folder.File("s.csv")};
  options.toolpath = folder.File("t.bin");
  options.state_out = folder.File("state");
  const Told told = Hear([&] { return Simulate(options); });
  EXPECT_EQ(told.errors, "");
  EXPECT_THAT(folder.Names(),
              testing::UnorderedElementsAre("a.rml", "p.svg", "c.svg", "s.csv", "t.bin", "state"));
  EXPECT_THAT(folder.Read("c.svg"), HasSubstr("tip speed"));
  EXPECT_THAT(folder.Read("p.svg"), AllOf(HasSubstr("<svg"), Not(HasSubstr("tip speed"))));
  EXPECT_THAT(folder.Read("s.csv"), testing::StartsWith("t_s,"));
  EXPECT_THAT(folder.Read("t.bin"), Not(IsEmpty()));
  EXPECT_THAT(folder.Read("state"), Not(IsEmpty()));
  // To standard output in place of the report, and to no file.
  options.samples.clear();
  options.toolpath.clear();
  options.state_out.clear();
  options.svg = "-";
  options.plot.clear();
  EXPECT_EQ(Hear([&] { return Simulate(options); }).output, folder.Read("p.svg"));
  options.svg.clear();
  options.plot = {"speed,axes", "-"};
  EXPECT_EQ(Hear([&] { return Simulate(options); }).output, folder.Read("c.svg"));
  EXPECT_EQ(folder.Names().size(), 6U);
}

// OPT-9.02: what is wrong with a called program is told, and not that it is missing as well.
TEST_F(LeastValues, LinkSaysWhyAndNoMore) {
  const std::string main = folder.Put("12.S", "FUNCTION 44\n");
  folder.Put("44.S", "SPEED 101\n");
  LinkOptions options{.files = {main, folder.path()}, .slots = {}, .main_slot = 12};
  Told told = Hear([&] { return Link(options); });
  EXPECT_THAT(told.errors, AllOf(HasSubstr("OPT-E7004"), Not(HasSubstr("OPT-E7103"))));
  folder.Put("44.S", "");
  told = Hear([&] { return Link(options); });
  EXPECT_THAT(told.errors, AllOf(HasSubstr("CELL-E9017"), Not(HasSubstr("OPT-E7103"))));
  // A program with something to advise, which keeps nobody from linking it.
  folder.Put("44.S", "VR[0] = VR[1]\nENDTASK\n");
  told = Hear([&] { return Link(options); });
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.errors, "");
}

}  // namespace
}  // namespace rmlcell::cli
