#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "engine/core/diagnostic.h"
#include "engine/core/result.h"
#include "engine/core/units.h"

namespace rmlcell {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Units, SecondsBecomeTheNearestNanosecond) {
  EXPECT_EQ(FromSeconds(0.0), SimTime(0));
  EXPECT_EQ(FromSeconds(1.5), SimTime(1'500'000'000));
  EXPECT_EQ(FromSeconds(-1.5), SimTime(-1'500'000'000));
  EXPECT_EQ(FromSeconds(4e-10), SimTime(0));
  EXPECT_EQ(FromSeconds(6e-10), SimTime(1));
  EXPECT_EQ(ToSeconds(SimTime(2'500'000'000)), 2.5);
}

TEST(Units, WhatCannotBeRepresentedSaturates) {
  EXPECT_EQ(FromSeconds(9.0e9), kForever);
  EXPECT_EQ(FromSeconds(1e300), kForever);
  EXPECT_EQ(FromSeconds(kInfinity), kForever);
  EXPECT_EQ(FromSeconds(std::numeric_limits<double>::quiet_NaN()), kForever);
  EXPECT_EQ(FromSeconds(8.9e9), SimTime(8'900'000'000'000'000'000));
  EXPECT_EQ(FromSeconds(-1e300), -kForever);
  EXPECT_EQ(FromSeconds(-kInfinity), -kForever);
}

// OPT-1.10, OPT-1.11
TEST(Units, SlotsAreOneToNinetyNineAndExecutablesLieAHundredAbove) {
  EXPECT_FALSE(IsSlot(0));
  EXPECT_TRUE(IsSlot(1));
  EXPECT_TRUE(IsSlot(99));
  EXPECT_FALSE(IsSlot(100));
  EXPECT_FALSE(IsSlot(-1));
  EXPECT_EQ(45 + kExecutableOffset, 145);
}

// OPT-8.30: 25.4 mm an inch.
TEST(Units, Conversions) {
  EXPECT_EQ(kMmPerInch, 25.4);
  EXPECT_DOUBLE_EQ(180.0 * kRadPerDegree, kPi);
  EXPECT_DOUBLE_EQ(kTurn, 360.0 * kRadPerDegree);
}

TEST(Result, HoldsAValueOrAnError) {
  const Result<std::string> good = std::string("value");
  ASSERT_TRUE(good);
  EXPECT_EQ(*good, "value");
  EXPECT_EQ(good->size(), 5U);
  const Result<std::string> bad = Error{ErrorCode::kHoleRadiusZero, "radius is 0", {}};
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().code, ErrorCode::kHoleRadiusZero);
  EXPECT_EQ(bad.error().detail, "radius is 0");
}

TEST(Result, GivesAwayWhatCannotBeCopied) {
  Result<std::unique_ptr<int>> made = std::make_unique<int>(7);
  const std::unique_ptr<int> taken = *std::move(made);
  EXPECT_EQ(*taken, 7);
}

TEST(ResultDeathTest, ReadingTheWrongSideStops) {
  const Result<int> bad = Error{ErrorCode::kHoleRadiusZero, {}, {}};
  EXPECT_DEATH((void)*bad, "check failed");
  const Result<int> good = 1;
  EXPECT_DEATH((void)good.error(), "check failed");
  EXPECT_DEATH((void)Status().error(), "check failed");
}

TEST(Status, IsGoodUnlessItHasAnError) {
  EXPECT_TRUE(Status());
  const Status bad = Error{ErrorCode::kHoleRadiusZero, {}, {}};
  EXPECT_FALSE(bad);
  EXPECT_FALSE(bad.ok());
}

Diagnostic At(int line, int column, int length = 0) {
  return {.code = ErrorCode::kArgumentCount,
          .severity = Severity::kCompile,
          .detail = "MOVE has 4 values, needs 5",
          .rule = "OPT-2.01",
          .file = "part.S",
          .where = {.line = line, .column = column, .length = length}};
}

TEST(Diagnostic, IsOneLineAndTheProgramTextWithACaret) {
  const std::string source = "SPEED 5\n\tMOVE (1,2,3,4)\r\nSTOP\n";
  const std::string advice(Lookup(ErrorCode::kArgumentCount).advice);
  const std::string head =
      "part.S:2:2: error OPT-E7019: MOVE has 4 values, needs 5 [OPT-2.01]; " + advice;
  EXPECT_EQ(FormatDiagnostic(At(2, 2, 4), {}), head);
  EXPECT_EQ(FormatDiagnostic(At(2, 2, 4), source), head + "\n  \tMOVE (1,2,3,4)\n  \t^~~~");
}

TEST(Diagnostic, TellsTheSeverityOfWhatIsNoError) {
  Diagnostic advice = At(0, 0);
  advice.severity = Severity::kWarning;
  advice.file.clear();
  advice.program = 45;
  advice.step = 7;
  EXPECT_EQ(FormatDiagnostic(advice, {}),
            "program 45: warning OPT-E7019: MOVE has 4 values, needs 5 (step 7) [OPT-2.01]");
  advice.detail.clear();
  EXPECT_THAT(FormatDiagnostic(advice, {}),
              HasSubstr(std::string(Lookup(ErrorCode::kArgumentCount).when)));
}

// One error among warnings is enough; none, or no findings at all, are none.
TEST(Diagnostic, AListHasErrorsWhenOneOfThemIs) {
  Diagnostic warning = At(1, 1);
  warning.severity = Severity::kWarning;
  EXPECT_FALSE(HasErrors({}));
  EXPECT_FALSE(HasErrors(std::vector{warning, warning}));
  EXPECT_TRUE(HasErrors(std::vector{warning, At(2, 2)}));
}

TEST(Diagnostic, PlacesOutsideTheTextShowNoLine) {
  for (const auto& [line, column] :
       {std::pair{4, 1}, std::pair{1, 500}, std::pair{1'000'000, 1}, std::pair{3, 0}}) {
    const std::string text = FormatDiagnostic(At(line, column), "SPEED 5\nSTOP\n");
    EXPECT_EQ(text.find('\n'), std::string::npos) << line;
  }
  EXPECT_THAT(FormatDiagnostic(At(0, 1), "SPEED 5\n"), Not(HasSubstr("\n")));
  EXPECT_THAT(FormatDiagnostic(At(1, 8, 1000), "SPEED 5\n"),
              testing::EndsWith("\n  SPEED 5\n         ^"));
}

// A terminal must not act on what stands in a program.
TEST(Diagnostic, ControlCharactersAreShownAsQuestionMarks) {
  const std::string text = FormatDiagnostic(At(1, 5), "A\x1B[2J\x7F\x01 B\n");
  EXPECT_THAT(text, HasSubstr("A?[2J?? B"));
  EXPECT_THAT(text, Not(HasSubstr("\x1B")));
}

// A generated file may be one line of megabytes.
TEST(Diagnostic, OfALongLineOnlyTheSurroundingsAreShown) {
  std::string source(1 << 20, 'x');
  source[500'000] = '!';
  const std::string text = FormatDiagnostic(At(1, 500'001), source);
  EXPECT_LT(text.size(), 400U);
  const std::size_t mark = text.find('!', text.find('\n'));
  const std::size_t caret = text.rfind('^');
  EXPECT_EQ(mark - text.find('\n'), caret - text.rfind('\n'));  // it stands below it
}

// A hundred bytes about the caret: up to column 51 they begin with the line, behind it fifty
// before.
TEST(Diagnostic, ShowsAHundredBytesOfALongLine) {
  std::string source;
  for (int k = 0; k < 400; ++k) source += static_cast<char>('a' + k % 26);
  for (const int column : {1, 50, 51, 52, 53, 200, 301, 399, 400}) {
    const std::string text = FormatDiagnostic(At(1, column), source);
    const std::size_t from = column > 51 ? static_cast<std::size_t>(column) - 51 : 0;
    const std::string shown = source.substr(from, 100);
    const std::string caret(static_cast<std::size_t>(column) - 1 - from, ' ');
    EXPECT_TRUE(text.ends_with("\n  " + shown + "\n  " + caret + "^")) << column << text;
  }
}

// The tildes end with the length of what is meant, with the line, or with what is shown of it.
TEST(Diagnostic, UnderlinesNoMoreThanThereIs) {
  using testing::EndsWith;
  EXPECT_THAT(FormatDiagnostic(At(1, 1, 1), "SPEED 5"), EndsWith("\n  SPEED 5\n  ^"));
  EXPECT_THAT(FormatDiagnostic(At(1, 1, 5), "SPEED 5"), EndsWith("\n  SPEED 5\n  ^~~~~"));
  EXPECT_THAT(FormatDiagnostic(At(1, 1, 7), "SPEED 5"), EndsWith("\n  SPEED 5\n  ^~~~~~~"));
  EXPECT_THAT(FormatDiagnostic(At(1, 3, 99), "SPEED 5"), EndsWith("\n  SPEED 5\n    ^~~~~"));
  EXPECT_THAT(FormatDiagnostic(At(1, 1, 500), std::string(300, 'x')),
              EndsWith("\n  " + std::string(100, 'x') + "\n  ^" + std::string(99, '~')));
  // A place behind the last column of its line still has its caret; a line end of two bytes is
  // none.
  EXPECT_THAT(FormatDiagnostic(At(2, 5), "A\r\nSTOP\r\n"), EndsWith("\n  STOP\n      ^"));
}

// Fifty bytes before a place that lies beyond its line, as far as there are any.
TEST(Diagnostic, BeyondALineItsLastBytesAreShown) {
  const std::string line(50, 'x');
  EXPECT_THAT(FormatDiagnostic(At(1, 100), line), testing::EndsWith("\n  x\n   ^"));
  EXPECT_THAT(FormatDiagnostic(At(1, 101), line), Not(HasSubstr("\n")));
}

// Bytes below 0x20 but the tabulator, and 0x7F; 0x20, 0x7E and those of other alphabets are shown.
TEST(Diagnostic, ShowsWhatATerminalDoesNotActOn) {
  EXPECT_THAT(FormatDiagnostic(At(1, 1), "\x1F \x1E\t~\x7F\xC3\xA4"),
              HasSubstr("\n  ? ?\t~?\xC3\xA4\n"));
}

// Line without column, column without line, the file before the program, the time of a run.
TEST(Diagnostic, TellsThePlaceAsFarAsItIsKnown) {
  const std::string rest = "error OPT-E7019: MOVE has 4 values, needs 5";
  Diagnostic finding = At(3, 0);
  finding.program = 45;
  EXPECT_THAT(FormatDiagnostic(finding, {}),
              testing::StartsWith("part.S:3: " + rest + " [OPT-2.01]; "));
  finding.where = {.line = 0, .column = 7};
  EXPECT_THAT(FormatDiagnostic(finding, {}), testing::StartsWith("part.S: " + rest));
  finding.file.clear();
  EXPECT_THAT(FormatDiagnostic(finding, {}), testing::StartsWith("program 45: " + rest));
  finding.program = 0;
  finding.rule.clear();
  finding.step = 3;
  finding.at = FromSeconds(1.5);
  EXPECT_EQ(
      FormatDiagnostic(finding, {}),
      rest + " (step 3, at 1.500 s); " + std::string(Lookup(ErrorCode::kArgumentCount).advice));
  finding.step = 0;  // a time without a step says nothing
  finding.severity = Severity::kDevice;
  EXPECT_EQ(FormatDiagnostic(finding, {}),
            "device error OPT-E7019: MOVE has 4 values, needs 5; " +
                std::string(Lookup(ErrorCode::kArgumentCount).advice));
  finding.severity = Severity::kMessage;
  EXPECT_EQ(FormatDiagnostic(finding, {}),
            "operator message OPT-E7019: MOVE has 4 values, needs 5");
}

// Findings, places and errors are equal when all of them is.
TEST(Result, ErrorsAreComparedWhole) {
  const Error error = InvalidArgument("slot is 0");
  EXPECT_EQ(error.code, ErrorCode::kCellInvalidArgument);
  EXPECT_EQ(error.detail, "slot is 0");
  EXPECT_FALSE(error.where);
  EXPECT_EQ(error, InvalidArgument("slot is 0"));
  EXPECT_NE(error, InvalidArgument("slot is 1"));
  EXPECT_EQ(SourceSpan().byte_offset, -1);
  EXPECT_DEATH(RMLCELL_CHECK(1 == 2), "core_test.cc:[0-9]+: check failed: 1 == 2");
  RMLCELL_CHECK(1 == 1);
}

// Both ends of what fits.
TEST(Units, LongestTimes) {
  EXPECT_EQ(FromSeconds(-9.0e9), -kForever);
  EXPECT_EQ(FromSeconds(-8.999e9), SimTime(-8'999'000'000'000'000'000));
  EXPECT_EQ(FromSeconds(8.999e9), SimTime(8'999'000'000'000'000'000));
  EXPECT_EQ(ToSeconds(SimTime(1)), 1e-9);
}

TEST(Diagnostic, ErrorsStopAProgramAndTheRestDoesNot) {
  for (const Severity severity :
       {Severity::kCompile, Severity::kProgram, Severity::kFatal, Severity::kAlarm, Severity::kTool,
        Severity::kBudget, Severity::kRequest}) {
    EXPECT_TRUE(IsError(severity)) << SeverityName(severity);
  }
  for (const Severity severity :
       {Severity::kAdvice, Severity::kWarning, Severity::kMessage, Severity::kDevice}) {
    EXPECT_FALSE(IsError(severity)) << SeverityName(severity);
  }
}

}  // namespace
}  // namespace rmlcell
