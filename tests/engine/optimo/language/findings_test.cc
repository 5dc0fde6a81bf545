#include "engine/optimo/language/findings.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

// The lines begin at 0, 3 and 8.
constexpr std::string_view kThreeLines = "ab\ncdef\ng";

// OPT-1.33: in the order of the text, those of one place as they came; what has no place is first.
TEST(Findings, ComeInTheOrderOfTheText) {
  Findings findings;
  findings.Add(ErrorCode::kSyntax, {7, 1, 2}, "end of a line");
  findings.Add(ErrorCode::kSyntax, {3, 4, 1}, "one");
  findings.Add(ErrorCode::kLiteralRange, {3, 4, 1}, "two", "OPT-2.35");
  findings.Add(ErrorCode::kObjectTooLong, {}, "of the whole");
  findings.Add(ErrorCode::kSyntax, {9, 0, 3}, "end of the text");
  findings.Add(ErrorCode::kSyntax, {0, 2, 1}, "beginning");
  findings.Add(ErrorCode::kSyntax, {8, 1, 3}, "last line");
  EXPECT_EQ(findings.error_count(), 7U);
  struct Row {
    std::string detail;
    SourceSpan where;
    int step;
  };
  const std::vector<Row> rows = {
      {"of the whole", {}, 0},
      {"beginning", {1, 1, 2, 0}, 1},
      {"one", {2, 1, 4, 3}, 1},
      {"two", {2, 1, 4, 3}, 1},
      {"end of a line", {2, 5, 1, 7}, 2},
      {"last line", {3, 1, 1, 8}, 3},
      {"end of the text", {3, 2, 0, 9}, 3},
  };
  const std::vector<Diagnostic> found = findings.Take(kThreeLines, "part.S");
  ASSERT_EQ(found.size(), rows.size());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    EXPECT_EQ(found[n].detail, rows[n].detail);
    EXPECT_EQ(found[n].where, rows[n].where) << rows[n].detail;
    EXPECT_EQ(found[n].step, rows[n].step) << rows[n].detail;
    EXPECT_EQ(found[n].file, "part.S");
  }
  EXPECT_EQ(found[3].rule, "OPT-2.35");
  EXPECT_TRUE(findings.Take(kThreeLines, "part.S").empty());
}

// OPT-1.33: the first error is told, however many warnings stand before it; the next are counted.
TEST(Findings, TheFirstErrorIsKept) {
  Findings findings(2);
  findings.Add(ErrorCode::kWordIgnored, {0, 2, 1}, "first");
  findings.Add(ErrorCode::kWordIgnored, {3, 4, 2}, "second");
  findings.Add(ErrorCode::kWordIgnored, {3, 4, 2}, "third");
  EXPECT_FALSE(findings.full());
  findings.Add(ErrorCode::kNameUndeclared, {8, 1, 3}, "error");
  EXPECT_TRUE(findings.full());
  findings.Add(ErrorCode::kSyntax, {8, 1, 3}, "another");
  const std::vector<Diagnostic> found = findings.Take(kThreeLines, "part.S");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].detail, "first");
  EXPECT_EQ(found[1].detail, "error");
  EXPECT_EQ(findings.error_count(), 2U);
  const auto& untold = findings.dropped().kinds();
  ASSERT_EQ(untold.size(), 2U);
  EXPECT_EQ(untold.at(ErrorCode::kSyntax).count, 1U);
  EXPECT_EQ(untold.at(ErrorCode::kWordIgnored).count, 2U);
  EXPECT_EQ(untold.at(ErrorCode::kWordIgnored).first.step, 2);
}

// The same of a program: 1000 words without effect, and a name that nobody declared.
TEST(Findings, AnErrorBehindAThousandWarnings) {
  std::string text;
  for (int line = 0; line < 1000; ++line) text += "CONT X\n";
  const Compilation made = Compile(text + "VR[1] = NOBODY\n", "", {.advice = false});
  EXPECT_FALSE(made.ok);
  ASSERT_EQ(made.diagnostics.size(), 1000U);
  EXPECT_EQ(made.diagnostics.back().code, ErrorCode::kNameUndeclared);
  EXPECT_EQ(made.diagnostics.back().where.line, 1001);
  EXPECT_NE(made.diagnostics.back().detail.find("NOBODY"), std::string::npos);
}

// OPT-7.91: a name that is none is counted as such when nothing more is told.
TEST(Findings, AnUnknownWordBehindAThousand) {
  std::string text;
  for (int line = 0; line < 1001; ++line) text += "NOBODY\n";
  const Compilation made = Compile(text, "", {.advice = false});
  EXPECT_EQ(made.diagnostics.size(), 1000U);
  const auto& untold = made.diagnostics_dropped.kinds();
  ASSERT_EQ(untold.size(), 1U);
  EXPECT_EQ(untold.at(ErrorCode::kNameUndeclared).count, 1U);
}

// What the list has no room for is counted, with its first and last place.
TEST(Findings, TheRestKeepsItsExtent) {
  Findings findings(1);
  EXPECT_FALSE(findings.full());
  findings.Add(ErrorCode::kSyntax, {4, 1, 1}, "told");
  EXPECT_TRUE(findings.full());
  findings.Add(ErrorCode::kSyntax, {8, 1, 3}, "not told");
  findings.Add(ErrorCode::kSyntax, {0, 2, 1}, "not told");
  findings.Add(ErrorCode::kSyntax, {5, 1, 2}, "not told");
  findings.Add(ErrorCode::kObjectTooLong, {}, "not told");
  EXPECT_EQ(findings.error_count(), 5U);
  EXPECT_EQ(findings.Take(kThreeLines, "part.S").size(), 1U);
  const auto& kinds = findings.dropped().kinds();
  ASSERT_EQ(kinds.size(), 2U);
  const GatheredFindings& syntax = kinds.at(ErrorCode::kSyntax);
  EXPECT_EQ(syntax.count, 3U);
  EXPECT_EQ(syntax.severity, Lookup(ErrorCode::kSyntax).severity);
  EXPECT_EQ(syntax.first.where, (SourceSpan{1, 1, 2, 0}));
  EXPECT_EQ(syntax.first.step, 1);
  EXPECT_EQ(syntax.last.where, (SourceSpan{3, 1, 1, 8}));
  EXPECT_EQ(syntax.last.step, 3);
  EXPECT_EQ(syntax.last.file, "part.S");
  EXPECT_EQ(kinds.at(ErrorCode::kObjectTooLong).first.where, SourceSpan{});
}

// OPT-1.33: also where a finding is about a part of its statement, or a name.
TEST(Findings, UntoldFindingsOfPartsHaveTheirLines) {
  const Compilation compiled = Compile(
      "SPEED 5\nSPEED 101\nVR[0] = QQ\nSPEED 101\nVR[0] = QQ\nVR[0] = QQ\nSPEED 101\nSPEED 5\n", "",
      {.advice = false, .diagnostics_max = 0});
  EXPECT_TRUE(compiled.diagnostics.empty());
  const auto lines = [&](ErrorCode code) {
    const GatheredFindings& kind = compiled.diagnostics_dropped.kinds().at(code);
    EXPECT_EQ(kind.count, 3U);
    return std::vector<int>{kind.first.where.line, kind.last.where.line};
  };
  EXPECT_EQ(lines(ErrorCode::kLiteralRange), (std::vector<int>{2, 7}));
  EXPECT_EQ(lines(ErrorCode::kNameUndeclared), (std::vector<int>{3, 6}));
}

// A finding of the whole program stands at no line of it. OPT-1.08, OPT-2.04
TEST(Findings, OfTheWholeProgramHaveNoLine) {
  for (const CompileOptions& options :
       {CompileOptions{.object_limit = 5, .advice = false}, CompileOptions{.inch = true}}) {
    const Compilation compiled = Compile("SPEED 5\n", "part.S", options);
    ASSERT_EQ(compiled.diagnostics.size(), 1U);
    EXPECT_EQ(compiled.diagnostics[0].where, SourceSpan{});
    EXPECT_EQ(compiled.diagnostics[0].file, "part.S");
  }
}

}  // namespace
}  // namespace rmlcell::optimo
