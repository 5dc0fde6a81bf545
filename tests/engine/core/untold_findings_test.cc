#include "engine/core/untold_findings.h"

#include <gtest/gtest.h>

#include "tests/engine/core/untold.h"

namespace rmlcell {
namespace {

Diagnostic At(ErrorCode code, int line, int program = 0) {
  return {.code = code,
          .severity = Severity::kAdvice,
          .detail = "its text is not kept",
          .where = {.line = line, .column = 2, .byte_offset = 10 * line},
          .program = program};
}

// Of each code how many, and from where to where in the text, in whatever order they come.
TEST(UntoldFindings, EachKindHasItsNumberAndItsExtent) {
  UntoldFindings untold;
  EXPECT_TRUE(untold.empty());
  for (const int line : {7, 3, 9, 5}) untold.Add(At(ErrorCode::kRml1Clipped, line), SimTime(line));
  untold.Add(At(ErrorCode::kRml1LogCut, 4));
  EXPECT_FALSE(untold.empty());
  EXPECT_EQ(untold.count(), 5U);
  ASSERT_EQ(untold.kinds().size(), 2U);
  const GatheredFindings& clipped = untold.kinds().at(ErrorCode::kRml1Clipped);
  EXPECT_EQ(clipped.code, ErrorCode::kRml1Clipped);
  EXPECT_EQ(clipped.severity, Severity::kAdvice);
  EXPECT_EQ(clipped.count, 4U);
  EXPECT_EQ(clipped.first.where.line, 3);
  EXPECT_EQ(clipped.last.where.line, 9);
  EXPECT_EQ(clipped.last_at, SimTime(9));
  EXPECT_EQ(clipped.first.detail, "");
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1LogCut).count, 1U);
}

// What is kept of a place: code, severity, file, program, step and span.
TEST(UntoldFindings, APlaceIsKeptWithoutItsTexts) {
  Diagnostic finding = At(ErrorCode::kRml1Clipped, 7, 12);
  finding.file = "part.rml";
  finding.rule = "RML1-4.20";
  finding.step = 3;
  finding.judged = Judged::kDoubtful;
  finding.at = SimTime(5);
  UntoldFindings untold;
  untold.Add(finding, SimTime(5));
  Diagnostic place = finding;
  place.detail = {};
  place.rule = {};
  place.judged = Judged::kNo;
  place.at = {};
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1Clipped),
            (GatheredFindings{.code = ErrorCode::kRml1Clipped,
                              .severity = Severity::kAdvice,
                              .judged = Judged::kDoubtful,
                              .count = 1,
                              .first = place,
                              .last = place,
                              .last_at = SimTime(5)}));
}

// Of several at one place the first is the first one and the last the last one.
TEST(UntoldFindings, OfOnePlaceInTheOrderInWhichTheyCome) {
  UntoldFindings untold;
  for (const int length : {1, 2, 3}) {
    Diagnostic finding = At(ErrorCode::kRml1Clipped, 7);
    finding.where.length = length;
    untold.Add(finding);
  }
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1Clipped).first.where.length, 1);
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1Clipped).last.where.length, 3);
}

TEST(UntoldFindings, NoFindingsAddNoKind) {
  UntoldFindings untold;
  untold.Add(GatheredFindings{.code = ErrorCode::kRml1Clipped});
  EXPECT_EQ(untold, UntoldFindings());
}

// A program with a lower slot comes first, then the line, then the byte: a stream may be one line.
TEST(UntoldFindings, PlacesAreInOrderOfProgramLineAndByte) {
  UntoldFindings untold;
  Diagnostic later = At(ErrorCode::kRml1Clipped, 1, 8);
  later.where.byte_offset = 500;
  untold.Add(later);
  untold.Add(At(ErrorCode::kRml1Clipped, 1, 8));
  untold.Add(At(ErrorCode::kRml1Clipped, 90, 7));
  const GatheredFindings& kind = untold.kinds().at(ErrorCode::kRml1Clipped);
  EXPECT_EQ(kind.first.program, 7);
  EXPECT_EQ(kind.last.program, 8);
  EXPECT_EQ(kind.last.where.byte_offset, 500);
}

// On one byte by column, then by step: a line may be passed many times.
TEST(UntoldFindings, PlacesOfOneByteAreInOrderOfColumnAndStep) {
  UntoldFindings untold;
  for (const auto& [column, step] : {std::pair{3, 5}, {3, 2}, {4, 1}, {4, 9}, {4, 3}}) {
    Diagnostic finding = At(ErrorCode::kRml1Clipped, 1);
    finding.where.column = column;
    finding.step = step;
    untold.Add(finding);
  }
  const GatheredFindings& kind = untold.kinds().at(ErrorCode::kRml1Clipped);
  EXPECT_EQ(kind.first.where.column, 3);
  EXPECT_EQ(kind.first.step, 2);
  EXPECT_EQ(kind.last.where.column, 4);
  EXPECT_EQ(kind.last.step, 9);
}

// Two lists together are as if one list had had no room for all of them.
TEST(UntoldFindings, ListsAddUp) {
  UntoldFindings both = Untold(3, ErrorCode::kRml1Clipped, 10);  // 10, 11, 12
  both.Add(Untold(2, ErrorCode::kRml1Clipped, 4));               // 4, 5
  both.Add(Untold(1, ErrorCode::kRml1LogCut, 6));
  both.Add(UntoldFindings());
  UntoldFindings one;
  for (const int line : {10, 11, 12, 4, 5}) one.Add(Untold(1, ErrorCode::kRml1Clipped, line));
  one.Add(Untold(1, ErrorCode::kRml1LogCut, 6));
  EXPECT_EQ(both, one);
  EXPECT_EQ(both.count(), 6U);
  EXPECT_EQ(both.kinds().at(ErrorCode::kRml1Clipped).first.where.line, 4);
  EXPECT_EQ(both.kinds().at(ErrorCode::kRml1Clipped).last.where.line, 12);
}

// The time of the last one is the latest of both, whichever list is added to the other.
TEST(UntoldFindings, TheLatestTimeOfTwoLists) {
  UntoldFindings early;
  early.Add(At(ErrorCode::kRml1Clipped, 1), SimTime(5));
  UntoldFindings late;
  late.Add(At(ErrorCode::kRml1Clipped, 2), SimTime(8));
  UntoldFindings both = early;
  both.Add(late);
  EXPECT_EQ(both.kinds().at(ErrorCode::kRml1Clipped).last_at, SimTime(8));
  late.Add(early);
  EXPECT_EQ(late.kinds().at(ErrorCode::kRml1Clipped).last_at, SimTime(8));
}

// One error among them makes the kind one that stops a program.
TEST(UntoldFindings, AnErrorIsNotHiddenByAdvice) {
  UntoldFindings untold = Untold(2, ErrorCode::kRml1Clipped);
  Diagnostic error = At(ErrorCode::kRml1Clipped, 9);
  error.severity = Severity::kProgram;
  untold.Add(error);
  untold.Add(At(ErrorCode::kRml1Clipped, 10));
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1Clipped).severity, Severity::kProgram);
  UntoldFindings other = Untold(1, ErrorCode::kRml1Clipped);
  other.Add(untold);
  EXPECT_EQ(other.kinds().at(ErrorCode::kRml1Clipped).severity, Severity::kProgram);
}

// Of what is no error the more serious is not hidden by what comes later, either way of adding.
TEST(UntoldFindings, AWarningIsNotHiddenByAdvice) {
  Diagnostic warning = At(ErrorCode::kRml1Clipped, 1);
  warning.severity = Severity::kWarning;
  UntoldFindings untold;
  untold.Add(warning);
  untold.Add(At(ErrorCode::kRml1Clipped, 2));
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1Clipped).severity, Severity::kWarning);
  untold.Add(Untold(1, ErrorCode::kRml1Clipped, 3));
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1Clipped).severity, Severity::kWarning);
  EXPECT_EQ(untold.count(), 3U);
}

TEST(UntoldFindings, AreMarkedAndPlacedAsFindingsAre) {
  UntoldFindings untold = Untold(2, ErrorCode::kRml1Clipped);
  untold.Add(Untold(1, ErrorCode::kRml1LogCut));
  untold.ForEachPlace([](Diagnostic& place) { place.program = 12; });
  untold.Mark(
      [](ErrorCode code) { return code == ErrorCode::kRml1Clipped ? Judged::kBad : Judged::kNo; });
  const GatheredFindings& clipped = untold.kinds().at(ErrorCode::kRml1Clipped);
  EXPECT_EQ(clipped.judged, Judged::kBad);
  EXPECT_EQ(clipped.first.program, 12);
  EXPECT_EQ(clipped.last.program, 12);
  EXPECT_EQ(untold.kinds().at(ErrorCode::kRml1LogCut).judged, Judged::kNo);
}

}  // namespace
}  // namespace rmlcell
