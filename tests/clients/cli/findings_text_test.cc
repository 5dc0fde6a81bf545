#include "clients/cli/findings_text.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "clients/cli/terminal.h"
#include "proto/bridge/findings.h"
#include "rmlcell/v1/program.pb.h"
#include "rmlcell/v1/report.pb.h"
#include "tests/clients/cli/cli_folder.h"
#include "tests/engine/core/untold.h"

namespace rmlcell::cli {
namespace {

constexpr std::string_view kSource = "COORD ABSOL\r\n\tSPEED 200\nSTOP\n";

Diagnostic Advice(SourceSpan where) {
  return {.code = ErrorCode::kNameUndeclared,
          .severity = Severity::kAdvice,
          .detail = "look here",
          .rule = "OPT-2.01",
          .file = "a.S",
          .where = where};
}

std::string Printed(const std::vector<Diagnostic>& findings, const UntoldFindings& dropped,
                    std::string_view source) {
  const Told told = Hear([&] {
    PrintFindings(findings, dropped, source);
    return 0;
  });
  EXPECT_EQ(told.errors, "");
  return told.output;
}

// clients/cli/findings_text.h: with the source line of each and a caret below it.
TEST(FindingsText, ACaretStandsBelowThePlace) {
  EXPECT_EQ(Printed({Advice({.line = 2, .column = 8, .length = 3})}, {}, kSource),
            "a.S:2:8: advice OPT-E7011: look here [OPT-2.01]\n"
            "  \tSPEED 200\n"
            "  \t      ^~~\n");
  EXPECT_EQ(Printed({Advice({.line = 1, .column = 1, .length = 5})}, {}, kSource),
            "a.S:1:1: advice OPT-E7011: look here [OPT-2.01]\n"
            "  COORD ABSOL\n"
            "  ^~~~~\n");
}

// Bytes that are no UTF-8 are question marks, one each: the caret stays in its column.
TEST(FindingsText, BytesThatAreNoTextAreNotPrinted) {
  EXPECT_EQ(Printed({Advice({.line = 1, .column = 5, .length = 1})}, {}, "\xAB\xFF\x80 Q\n"),
            "a.S:1:5: advice OPT-E7011: look here [OPT-2.01]\n"
            "  ??? Q\n"
            "      ^\n");
}

// That which makes a verdict is no mere advice.
TEST(FindingsText, WhatMakesAVerdictSaysSo) {
  Diagnostic bad = Advice({});
  bad.judged = Judged::kBad;
  EXPECT_EQ(Printed({bad}, {}, {}), "a.S: BAD OPT-E7011: look here [OPT-2.01]\n");
  bad.judged = Judged::kDoubtful;
  EXPECT_EQ(Printed({bad}, {}, {}), "a.S: DOUBTFUL OPT-E7011: look here [OPT-2.01]\n");
}

TEST(FindingsText, WithoutALineThereIsNoCaret) {
  const std::string line = "a.S:2:8: advice OPT-E7011: look here [OPT-2.01]\n";
  EXPECT_EQ(Printed({Advice({.line = 2, .column = 8, .length = 3})}, {}, {}), line);
  EXPECT_EQ(Printed({Advice({.line = 9, .column = 1})}, {}, kSource),
            "a.S:9:1: advice OPT-E7011: look here [OPT-2.01]\n");
  EXPECT_EQ(Printed({Advice({})}, {}, kSource), "a.S: advice OPT-E7011: look here [OPT-2.01]\n");
}

TEST(FindingsText, EachHasItsOwnLineAndThoseLeftOutAreCounted) {
  Diagnostic error = Advice({.line = 3, .column = 1, .length = 4});
  error.severity = Severity::kCompile;
  EXPECT_EQ(Printed({Advice({.line = 1, .column = 7}), error},
                    Untold(12, ErrorCode::kNameUndeclared, 9), kSource),
            "a.S:1:7: advice OPT-E7011: look here [OPT-2.01]\n"
            "  COORD ABSOL\n"
            "        ^\n"
            "a.S:3:1: error OPT-E7011: look here [OPT-2.01]; declare the name before its first "
            "use, or correct the word\n"
            "  STOP\n"
            "  ^~~~\n"
            "and 12 more OPT-E7011, lines 9 to 20\n");
  EXPECT_EQ(Printed({}, {}, kSource), "");
}

// Those of a kind that were kept and not shown, and those that were not kept, are one number and
// one extent.
TEST(FindingsText, WhatWasKeptAndWhatWasNotAreToldTogether) {
  std::vector<Diagnostic> findings;
  for (int line = 1; line <= 7; ++line) findings.push_back(Advice({.line = line}));
  std::string told;
  for (int line = 1; line <= 5; ++line)
    told += "a.S:" + std::to_string(line) + ": advice OPT-E7011: look here [OPT-2.01]\n";
  EXPECT_EQ(Printed(findings, Untold(1000, ErrorCode::kNameUndeclared, 8), {}),
            told + "and 1002 more OPT-E7011, lines 6 to 1007\n");
}

// A kind of which none was kept is told in a word, with the verdict that rests on it.
TEST(FindingsText, AKindThatNobodyShowedIsNamed) {
  UntoldFindings clipped = Untold(3, ErrorCode::kRml1Clipped, 5);
  const std::string when(Lookup(ErrorCode::kRml1Clipped).when);
  EXPECT_EQ(Printed({}, clipped, {}), "advice RML1-E8002: " + when + " (3 times, lines 5 to 7)\n");
  clipped.Mark([](ErrorCode) { return Judged::kBad; });
  EXPECT_EQ(Printed({}, clipped, {}), "BAD RML1-E8002: " + when + " (3 times, lines 5 to 7)\n");
}

// As the findings of a server: gathered by the same rule. One that does not tell the kinds of what
// it left out tells their number.
TEST(FindingsText, MessagesAreGatheredAlike) {
  v1::Findings found;
  for (int line = 1; line <= 7; ++line)
    *found.add_diagnostics() = bridge::ToProto(Advice({.line = line}));
  bridge::SetUntold(Untold(3, ErrorCode::kNameUndeclared, 8), found);
  const auto ends_with = [](const std::string& text, const std::string& end) {
    EXPECT_TRUE(text.ends_with(end)) << text;
    EXPECT_EQ(std::ranges::count(text, '\n'), 5 + std::ranges::count(end, '\n')) << text;
  };
  ends_with(FindingsText(found), "and 5 more OPT-E7011, lines 6 to 10\n");
  found.set_diagnostics_dropped(5);
  ends_with(FindingsText(found), "and 5 more OPT-E7011, lines 6 to 10\nand 2 more findings\n");
  v1::RunReport report;
  *report.mutable_diagnostics() = found.diagnostics();
  report.set_diagnostics_dropped(1);
  ends_with(FindingsText(report), "and 2 more OPT-E7011, lines 6 to 7\nand 1 more finding\n");
}

// One that was left out without its line keeps those of the others.
TEST(FindingsText, WhereTheLeftOutStand) {
  EXPECT_EQ(ExtentText(0, 0), "");
  EXPECT_EQ(ExtentText(1, 1), ", line 1");
  EXPECT_EQ(ExtentText(1, 2), ", lines 1 to 2");
  KindsShown kinds;
  for (const int line : {1, 2, 3, 4, 5, 9, 8, 0}) kinds.Show("OPT-E1", line);
  EXPECT_EQ(kinds.Rest(), "and 3 more OPT-E1, lines 8 to 9\n");
  KindsShown unplaced;
  for (int count = 0; count < 6; ++count) unplaced.Show("OPT-E1", 0);
  EXPECT_EQ(unplaced.Rest(), "and 1 more OPT-E1\n");
}

TEST(FindingsText, ComplaintsGoToStandardError) {
  const std::vector<Diagnostic> findings = {Advice({.line = 2, .column = 2, .length = 5})};
  const Told told = Hear([&] {
    ComplainOf(findings, Untold(3, ErrorCode::kNameUndeclared, 9), kSource);
    return 0;
  });
  EXPECT_EQ(told.output, "");
  EXPECT_EQ(told.errors,
            "a.S:2:2: advice OPT-E7011: look here [OPT-2.01]\n"
            "  \tSPEED 200\n"
            "  \t^~~~~\n"
            "and 3 more OPT-E7011, lines 9 to 11\n");
}

TEST(FindingsText, ARefusalSaysWhyAndGivesTheCodeOfWrongUse) {
  const Told told = Hear([] { return Refuse({ErrorCode::kCellUsage, "no program", {}}); });
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_EQ(told.output, "");
  EXPECT_EQ(told.errors, "rmlcell: CELL-E9026: no program; see --help\n");
  // So of every wrong request: the detail alone, without what wrong requests are in general. Where
  // there is no detail, that is all there is to say.
  const auto refused = [](ErrorCode code, const std::string& detail) {
    return Hear([&] { return Refuse({code, detail, {}}); }).errors;
  };
  const CatalogueEntry& entry = Lookup(ErrorCode::kCellInvalidArgument);
  const std::string advice =
      entry.advice.empty() ? std::string() : "; " + std::string(entry.advice);
  EXPECT_EQ(refused(ErrorCode::kCellInvalidArgument, "'foo' is no tool"),
            "rmlcell: CELL-E9003: 'foo' is no tool\n");
  EXPECT_EQ(refused(ErrorCode::kCellInvalidArgument, ""),
            "rmlcell: CELL-E9003: " + std::string(entry.when) + advice + "\n");
}

TEST(FindingsText, ARefusalOfAnotherKindSaysWhatHappenedToo) {
  const CatalogueEntry& entry = Lookup(ErrorCode::kCellEmptyProgram);
  const Told told = Hear([] { return Refuse({ErrorCode::kCellEmptyProgram, "a.S", {}}); });
  EXPECT_TRUE(told.errors.starts_with("rmlcell: CELL-E9017: " + std::string(entry.when) + ": a.S"))
      << told.errors;
}

}  // namespace
}  // namespace rmlcell::cli
