// What is told on either side of what decides it: rows of a report, refusals, sizes of a terminal,
// whole files.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "clients/cli/handbox_screen.h"
#include "clients/cli/messages.h"
#include "clients/cli/program_files.h"
#include "clients/cli/remote_call.h"
#include "clients/cli/rml1_tools.h"
#include "clients/cli/terminal.h"
#include "clients/cli/text_tools.h"
#include "clients/cli/verbs.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/findings.h"
#include "tests/clients/cli/cli_folder.h"
#include "tests/engine/core/untold.h"

namespace rmlcell::cli {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::UnorderedElementsAre;

class ToldSides : public testing::Test {
 protected:
  ToldSides() { ::setenv("NO_COLOR", "1", 1); }
  CliFolder folder;
};

// Both differences of a target, each with its own figures and place.
TEST_F(ToldSides, WhatIsLeftTooMuchHasItsPlace) {
  v1::RunReport report;
  report.set_family("rml1");
  report.mutable_total();
  v1::TargetFigures& target = *report.mutable_milling()->mutable_target();
  target.set_deep_mm(0.125);
  target.set_deep_mm3(0.25);
  target.set_deep_x_mm(3.5);
  target.set_deep_y_mm(4.5);
  target.set_left_mm(0.625);
  target.set_left_mm3(7.75);
  target.set_left_x_mm(11.25);
  target.set_left_y_mm(12.875);
  EXPECT_THAT(
      ReportText(report),
      HasSubstr(
          "              too deep by up to 0.125 mm at X 3.500, Y 4.500; 0.250 mm3 in all\n"
          "              too much left, up to 0.625 mm at X 11.250, Y 12.875; 7.750 mm3 in all\n"));
}

// By their kind first, and then by their number.
TEST_F(ToldSides, VariablesOfAKindStandTogether) {
  v1::RunReport report;
  report.mutable_total();
  for (const char* name : {"VR[2]", "VI[10]", "IL[10]", "VL[2]"}) {
    v1::Variable& variable = *report.add_variables();
    variable.set_name(name);
    variable.set_text("0");
  }
  EXPECT_THAT(ReportText(report), HasSubstr("IL[10]        0\nVI[10]        0\n"
                                            "VL[2]         0\nVR[2]         0\n"));
}

// Whatever stands before it on the line.
TEST_F(ToldSides, TheWordAdviceGivesWay) {
  v1::JobEvent event;
  event.set_sequence(5);
  v1::Diagnostic& finding = *event.mutable_diagnostic();
  finding.set_code("RML1-E8002");
  finding.set_severity(v1::SEVERITY_ADVICE);
  finding.set_message("lost");
  finding.mutable_place()->set_file("a-long-name.rml");
  finding.mutable_place()->set_line(12);
  finding.mutable_place()->set_column(3);
  EXPECT_EQ(EventLine(event), "#5  a-long-name.rml:12:3: RML1-E8002: lost");
}

TEST_F(ToldSides, ATimeIsThatOfTheClockOnTheWall) {
  const char* zone = std::getenv("TZ");
  const std::string before = zone == nullptr ? "" : zone;
  ::setenv("TZ", "UTC", 1);
  ::tzset();
  google::protobuf::Timestamp time;
  time.set_seconds(1'764'500'007);
  EXPECT_EQ(When(time), "2025-11-30 10:53:27");
  zone == nullptr ? ::unsetenv("TZ") : ::setenv("TZ", before.c_str(), 1);
  ::tzset();
}

// Errors of two kinds that did not fit, and one finding that refuses nothing: each line whole.
TEST_F(ToldSides, ARefusalTellsEachKindOnItsLine) {
  const std::vector<Diagnostic> findings = {{.code = ErrorCode::kNameUndeclared,
                                             .severity = Severity::kCompile,
                                             .detail = "SPEDE",
                                             .file = "12.S",
                                             .where = {.line = 3, .column = 1}}};
  UntoldFindings untold = Untold(3, ErrorCode::kNameUndeclared, 7);
  untold.Add(Untold(2, ErrorCode::kLiteralRange, 20));
  untold.Add(Untold(1, ErrorCode::kShortFly, 30));
  const google::rpc::Status rich =
      bridge::ToRpcStatus({ErrorCode::kNameUndeclared, "has errors", {}}, findings, untold);
  const grpc::Status status(static_cast<grpc::StatusCode>(rich.code()), rich.message(),
                            rich.SerializeAsString());
  const Told told = Hear([&] { return Refused(status, {.server = "127.0.0.1:1"}); });
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_THAT(told.errors, HasSubstr("\nrmlcell: and 3 more OPT-E7011, lines 7 to 9\nrmlcell: "));
  EXPECT_THAT(told.errors, HasSubstr(" (2 times, lines 20 to 21)\nrmlcell: "));
  EXPECT_THAT(
      told.errors,
      testing::EndsWith("\nrmlcell: and 1 more finding; rmlcell check of the file tells them\n"));
  EXPECT_EQ(std::count(told.errors.begin(), told.errors.end(), '\n'), 4) << told.errors;
}

// A file of one byte, one as large as is written at a time, and one with a byte more.
TEST_F(ToldSides, FilesOfAnySizeAreWrittenWhole) {
  for (const std::size_t size :
       {std::size_t{1}, machine::kReleaseEvery, machine::kReleaseEvery + 1}) {
    const std::string bytes(size, 'x');
    const Status written = WriteWholeFile(folder.File("f"), bytes);
    ASSERT_TRUE(written) << size;
    EXPECT_EQ(folder.Read("f"), bytes);
  }
  EXPECT_THAT(folder.Names(), ElementsAre("f"));
}

// Who has closed his input gets its number for a file.
TEST_F(ToldSides, AFileMayHaveTheNumberZero) {
  const int kept = ::dup(STDIN_FILENO);
  ::close(STDIN_FILENO);
  const Status written = WriteWholeFile(folder.File("f"), "text");
  if (kept >= 0) {
    ::dup2(kept, STDIN_FILENO);
    ::close(kept);
  }
  EXPECT_TRUE(written);
  EXPECT_EQ(folder.Read("f"), "text");
}

// The columns of a terminal; of anything else nothing is known.
TEST_F(ToldSides, TheWidthIsThatOfTheTerminal) {
  int outside = -1;
  int inside = -1;
  const winsize size{.ws_row = 24, .ws_col = 77, .ws_xpixel = 0, .ws_ypixel = 0};
  ASSERT_EQ(::openpty(&outside, &inside, nullptr, nullptr, &size), 0);
  std::fflush(stdout);
  const int kept = ::dup(STDOUT_FILENO);
  ::dup2(inside, STDOUT_FILENO);
  const std::size_t on_terminal = OutputWidth();
  ::dup2(::open(folder.Put("f", "").c_str(), O_WRONLY), STDOUT_FILENO);
  const std::size_t on_file = OutputWidth();
  ::dup2(kept, STDOUT_FILENO);
  for (const int end : {kept, inside, outside}) ::close(end);
  EXPECT_EQ(on_terminal, 77U);
  EXPECT_EQ(on_file, 0U);
}

// Half a millimetre, or half a degree, is a way to go.
TEST_F(ToldSides, HowFarAnAxisRunsOn) {
  const auto shown = [](double mm, double rad) {
    HandboxView view;
    view.marks = false;
    view.panel.set_run_on_mm(mm);
    view.panel.set_run_on_rad(rad);
    std::string text;
    for (const std::string& line : HandboxLines(view)) text += line + "\n";
    return text;
  };
  EXPECT_THAT(shown(0.5, 0.0), HasSubstr("runs on  0.5 mm, 0.0 deg when let go"));
  EXPECT_THAT(shown(0.0, 0.0087266), HasSubstr("runs on  0.0 mm, 0.5 deg when let go"));
  EXPECT_THAT(shown(0.0, 0.0), HasSubstr("runs on  -"));
}

// What of a machine contradicts itself is a wrong call, and nothing of the file.
TEST_F(ToldSides, AMachineThatCannotBeIsAWrongCall) {
  MoveToolOptions move;
  move.file = folder.Put("a.rml", "PU100,100;PD200,100;PU0,0;");
  move.output = folder.File("b.rml");
  move.machine.file = folder.Put("z.toml", "family = \"rml1\"\n[parameters]\nZ_MIN = 0\n");
  move.by_mm = {1.0, 1.0};
  const Told told = Hear([&] { return MoveMillStream(move); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_THAT(told.errors, AllOf(StartsWith("rmlcell: CELL-E9011: "), HasSubstr("Z_MIN")));
}

// Bytes between two commands have no number of one.
TEST_F(ToldSides, WhatIsNoCommandHasNoNumber) {
  MillToolOptions explain;
  explain.file = folder.Put("a.rml", "PU;!! X;PU5,5;");
  explain.machine.profile = "srm-20";
  const Told told = Hear([&] { return ExplainStream(explain); });
  EXPECT_THAT(told.output, HasSubstr("\n        0        1  PU "));
  EXPECT_THAT(told.output, HasSubstr("\n        3        -  !! X "));
  EXPECT_THAT(told.output, HasSubstr("\n        8        2  PU5,5 "));
}

// As many decimals as it takes to tell both apart, up to twelve.
TEST_F(ToldSides, FiguresThatDifferInTheEleventhDecimal) {
  const auto text = [](const std::string& x) {
    return "COORD ABSOL\nPATH LIN\nWORKDEF 1,0 (8.,75.,1.,50.)\nMOVE (0.,1000.,-400.,0.,0.)\n"
           "SPEED 8\nWORK 1,0/ON\nMOVE (" +
           x + ",1000.,-400.,0.,0.)\nWORK 1,0/OFF\n";
  };
  const DiffOptions options{.before = folder.Put("a.S", text("1.0E-5")),
                            .after = folder.Put("b.S", text("1.000001E-5")),
                            .svg = {},
                            .machine = {}};
  const Told told = Hear([&] { return Diff(options); });
  EXPECT_THAT(told.output, HasSubstr("\ncut_length  0.00001 -> 0.00001000001 mm\n"));
}

// What is wrong with either of two programs is told, in their order.
TEST_F(ToldSides, BothProgramsOfADiffMayBeWrong) {
  const DiffOptions options{.before = folder.Put("a.S", "SPEED 101\n"),
                            .after = folder.Put("b.S", "SPEED 102\n"),
                            .svg = {},
                            .machine = {}};
  const Told told = Hear([&] { return Diff(options); });
  EXPECT_EQ(told.exit_code, 1);
  const std::size_t first = told.errors.find("a.S:1:7: error OPT-E7004");
  const std::size_t second = told.errors.find("b.S:1:7: error OPT-E7004");
  ASSERT_NE(first, std::string::npos) << told.errors;
  ASSERT_NE(second, std::string::npos) << told.errors;
  EXPECT_LT(first, second);
}

// Of ten thousand changed steps each is told; of one more it is said that there is one.
TEST_F(ToldSides, ADiffIsToldUpToTenThousandSteps) {
  const auto compared = [&](int steps) {
    const auto stream = [&](const char* y) {
      std::string text = "PA;!PZ-10,10;PU0,0;";
      for (int step = 0; step < steps; ++step)
        text += "PD" + std::to_string(step % 2000) + y + ";\n";
      return text;
    };
    const DiffOptions options{.before = folder.Put("a.rml", stream(",10")),
                              .after = folder.Put("b.rml", stream(",11")),
                              .svg = {},
                              .machine = {}};
    return Hear([&] { return Diff(options); }).output;
  };
  const std::string all = compared(10'000);
  EXPECT_THAT(all, AllOf(HasSubstr("step 10003 -> 10003  "), Not(HasSubstr("more steps"))));
  EXPECT_THAT(compared(10'001), HasSubstr("\nand 1 more steps\n"));
}

// Only what is asked for is written.
TEST_F(ToldSides, ASourceMapIsMadeWhenItIsWanted) {
  const auto say = [&](const std::vector<std::string>& words) {
    return Hear([&] {
      CLI::App app;
      int exit_code = -1;
      AddTextToolVerbs(app, exit_code);
      std::vector<std::string> reversed(words.rbegin(), words.rend());
      app.parse(reversed);
      return exit_code;
    });
  };
  const std::string file = folder.Put("12.S", "SPEED 5\n");
  EXPECT_EQ(say({"compile", file}).exit_code, 0);
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("12.S", "12.O"));
  EXPECT_EQ(say({"compile", file, "--map"}).exit_code, 0);
  EXPECT_THAT(folder.Names(), UnorderedElementsAre("12.S", "12.O", "12.MAP"));
}

}  // namespace
}  // namespace rmlcell::cli
