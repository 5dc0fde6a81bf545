#include "clients/cli/findings_text.h"

#include <gtest/gtest.h>

#include "clients/cli/terminal.h"
#include "tests/clients/cli/cli_folder.h"

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

std::string Printed(const std::vector<Diagnostic>& findings, std::uint64_t dropped,
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
  EXPECT_EQ(Printed({Advice({.line = 2, .column = 8, .length = 3})}, 0, kSource),
            "a.S:2:8: advice OPT-E7011: look here [OPT-2.01]\n"
            "  \tSPEED 200\n"
            "  \t      ^~~\n");
  EXPECT_EQ(Printed({Advice({.line = 1, .column = 1, .length = 5})}, 0, kSource),
            "a.S:1:1: advice OPT-E7011: look here [OPT-2.01]\n"
            "  COORD ABSOL\n"
            "  ^~~~~\n");
}

// Bytes that are no UTF-8 are question marks, one each: the caret stays in its column.
TEST(FindingsText, BytesThatAreNoTextAreNotPrinted) {
  EXPECT_EQ(Printed({Advice({.line = 1, .column = 5, .length = 1})}, 0, "\xAB\xFF\x80 Q\n"),
            "a.S:1:5: advice OPT-E7011: look here [OPT-2.01]\n"
            "  ??? Q\n"
            "      ^\n");
}

// That which makes a verdict is no mere advice.
TEST(FindingsText, WhatMakesAVerdictSaysSo) {
  Diagnostic bad = Advice({});
  bad.judged = Judged::kBad;
  EXPECT_EQ(Printed({bad}, 0, {}), "a.S: BAD OPT-E7011: look here [OPT-2.01]\n");
  bad.judged = Judged::kDoubtful;
  EXPECT_EQ(Printed({bad}, 0, {}), "a.S: DOUBTFUL OPT-E7011: look here [OPT-2.01]\n");
}

TEST(FindingsText, WithoutALineThereIsNoCaret) {
  const std::string line = "a.S:2:8: advice OPT-E7011: look here [OPT-2.01]\n";
  EXPECT_EQ(Printed({Advice({.line = 2, .column = 8, .length = 3})}, 0, {}), line);
  EXPECT_EQ(Printed({Advice({.line = 9, .column = 1})}, 0, kSource),
            "a.S:9:1: advice OPT-E7011: look here [OPT-2.01]\n");
  EXPECT_EQ(Printed({Advice({})}, 0, kSource), "a.S: advice OPT-E7011: look here [OPT-2.01]\n");
}

TEST(FindingsText, EachHasItsOwnLineAndThoseLeftOutAreCounted) {
  Diagnostic error = Advice({.line = 3, .column = 1, .length = 4});
  error.severity = Severity::kCompile;
  EXPECT_EQ(Printed({Advice({.line = 1, .column = 7}), error}, 12, kSource),
            "a.S:1:7: advice OPT-E7011: look here [OPT-2.01]\n"
            "  COORD ABSOL\n"
            "        ^\n"
            "a.S:3:1: error OPT-E7011: look here [OPT-2.01]; declare the name before its first "
            "use, or correct the word\n"
            "  STOP\n"
            "  ^~~~\n"
            "and 12 more findings\n");
  EXPECT_EQ(Printed({}, 0, kSource), "");
  EXPECT_EQ(Printed({}, 1, kSource), "and 1 more findings\n");
}

TEST(FindingsText, ComplaintsGoToStandardError) {
  const std::vector<Diagnostic> findings = {Advice({.line = 2, .column = 2, .length = 5})};
  const Told told = Hear([&] {
    ComplainOf(findings, 3, kSource);
    return 0;
  });
  EXPECT_EQ(told.output, "");
  EXPECT_EQ(told.errors,
            "a.S:2:2: advice OPT-E7011: look here [OPT-2.01]\n"
            "  \tSPEED 200\n"
            "  \t^~~~~\n"
            "and 3 more findings\n");
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
