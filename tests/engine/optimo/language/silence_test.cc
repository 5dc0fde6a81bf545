#include "engine/optimo/language/silence.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "engine/core/text_fixes.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo {
namespace {

std::vector<std::string> Details(const std::string& text, const CompileOptions& options = {}) {
  std::vector<std::string> details;
  for (const Diagnostic& d : Compile(text, "", options).diagnostics) details.push_back(d.detail);
  return details;
}
using Texts = std::vector<std::string>;

// OPT-7.37, OPT-1.30: a statement is silenced from any of its lines, and from before it.
TEST(Silence, CountsForAllLinesOfAStatement) {
  for (const char* text : {"SYSDEF (0,0,\n0,0,0,0) ; rmlcell: allow 7311\n",
                           "SYSDEF (0,0, ; rmlcell: allow 7311\n0,0,0,0)\n",
                           "SYSDEF (0,0,\n ; rmlcell: allow 7311\n0,0,0,0)\n",
                           "; rmlcell: allow 7311\n\nSYSDEF (0,0,\n0,0,0,0)\n",
                           "10 ; rmlcell: allow 7311\nSYSDEF (0,0,\n0,0,0,0)\n",
                           "; rmlcell: allow 7311 in file\nSPEED 5\nSYSDEF (0,0,0,0,0,0)\n",
                           "SYSDEF (0,0,0,0,0,0) ; RMLCELL: Allow 7033, 7311\nSPEED 5\n"}) {
    for (const std::string& detail : Details(text))
      EXPECT_EQ(detail.find("SYSDEF"), detail.npos) << text;
  }
}

// "in file" stands right behind the numbers: further on it is a remark.
TEST(Silence, TheWholeTextIsAskedForBehindTheNumbers) {
  const std::string text = "OL[20] = ON\nOL[21] = ON\n";
  EXPECT_EQ(Details("; rmlcell: allow 7412 in file\n" + text), Texts{});
  EXPECT_EQ(Details("; rmlcell: allow 7412, in file 12\n" + text), Texts{});
  EXPECT_EQ(Details("; rmlcell: allow 7412 as in file 12\n" + text),
            Texts{"OL[21] is used by the system"});
}

// OPT-1.18: the statement before and the one behind keep their findings.
TEST(Silence, CountsForOneStatementOnly) {
  const std::string text =
      "OL[20] = ON\nOL[21] = ON ; rmlcell: allow 7412\nOL[22] = ON\n; rmlcell: allow 7412\nOL[23] "
      "= ON\nOL[24] = ON\n";
  EXPECT_EQ(Details(text), (Texts{"OL[20] is used by the system", "OL[22] is used by the system",
                                  "OL[24] is used by the system"}));
}

// A comment that cannot be followed is told; a slip of the word is repaired.
TEST(Silence, WhatCannotBeFollowedIsTold) {
  const std::string text = "SPEED 5 ; rmlcell: alow 7412\n";
  const std::vector<Diagnostic> found = Compile(text, "part.S", {}).diagnostics;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, ErrorCode::kPracticeAdvice);
  EXPECT_EQ(found[0].severity, Severity::kAdvice);
  EXPECT_EQ(found[0].where, (SourceSpan{1, 9, 20, 8}));
  EXPECT_EQ(found[0].file, "part.S");
  EXPECT_EQ(ApplyFixes(text, found), "SPEED 5 ; rmlcell: allow 7412\n");
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow\n"), (Texts{"allow needs the numbers of findings"}));
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 7004 71\n"),
            (Texts{"7004 is an error, which no comment allows", "71 is the number of no finding"}));
  EXPECT_EQ(Details("SPEED 5 ; remarks: allow 71\n;\n;:\n"), Texts{});
}

// What silences nothing is told, once the whole program was looked at.
TEST(Silence, WhatSilencesNothingIsTold) {
  EXPECT_EQ(Details("OL[20] = ON ; rmlcell: allow 7412 7413\n"),
            (Texts{"allow 7413 silences nothing here"}));
  EXPECT_EQ(Details("; rmlcell: allow 7033 in file\nSPEED 5\n"),
            (Texts{"allow 7033 silences nothing here"}));
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 7413\n", {.advice = false}), Texts{});
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 7413\nSPEED 101\n"),
            (Texts{"the value must be 0 to 100"}));
  // What the statement allows itself the file need not.
  EXPECT_EQ(Details("; rmlcell: allow 7412 in file\nOL[20] = ON ; rmlcell: allow 7412\n"),
            (Texts{"allow 7412 silences nothing here"}));
  // The advice on contours comes from elsewhere.
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 7317\n"), Texts{});
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 7317\n",
                    {.further_advice = [](const ParsedProgram&, Findings&) {}}),
            (Texts{"allow 7317 silences nothing here"}));
  // An axis that holds back is found when the program runs.
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 7321\n"), Texts{});
}

// Where not all findings are told nobody knows what an allowance would have silenced.
TEST(Silence, OfUntoldFindingsNothingIsIdle) {
  const std::string text = "OL[20] = ON\nOL[21] = ON\nSPEED 5 ; rmlcell: allow 7413\n";
  const std::string idle = "allow 7413 silences nothing here";
  EXPECT_EQ(Details(text, {.diagnostics_max = 1}), Texts{"OL[20] is used by the system"});
  EXPECT_EQ(Details(text, {.diagnostics_max = 2}),
            (Texts{"OL[20] is used by the system", "OL[21] is used by the system", idle}));
}

// A number of many digits is that of no finding: this one is 7412 and ten times 2^32.
TEST(Silence, ALongNumberIsOfNoFinding) {
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 42949680372\n"),
            Texts{"100000 is the number of no finding"});
}

// What only a run can find is no idle allowance: all others are told.
TEST(Silence, WhatRunsFindIsNotIdle) {
  const std::set<int> of_runs = {7110, 7304, 7306, 7316, 7320, 7321, 7408, 7409, 7411};
  const std::set<int> of_contours = {7317, 7318, 7319};
  int told = 0;
  for (int number = 1; number < 8000; ++number) {
    const auto code = FindError(ErrorFamily::kOptimo, number);
    if (!code || IsError(Lookup(*code).severity)) continue;
    const std::string text = "SPEED 5 ; rmlcell: allow " + std::to_string(number) + "\n";
    const bool silent = of_runs.contains(number) || of_contours.contains(number);
    const std::string idle = "allow " + std::to_string(number) + " silences nothing here";
    EXPECT_EQ(Details(text), silent ? Texts{} : Texts{idle}) << number;
    const bool of_run = of_runs.contains(number);
    EXPECT_EQ(Details(text, {.further_advice = [](const ParsedProgram&, Findings&) {}}),
              of_run ? Texts{} : Texts{idle})
        << number;
    told += silent ? 0 : 1;
  }
  EXPECT_GT(told, 10);
}

// OPT-1.18: only what is written as one is taken for an allowance, with numbers up to its first
// word.
TEST(Silence, NumbersEndAtTheFirstWord) {
  const auto silenced = [](const std::string& comment) {
    return Details("OL[20] = ON" + comment + "\n").empty();
  };
  EXPECT_TRUE(silenced(";rmlcell:allow 7412"));
  EXPECT_TRUE(silenced(" ;;  RmlCell:  ALLOW\t7412, it is ours since 1993"));
  EXPECT_TRUE(silenced(" ; rmlcell: allow ,7412"));
  for (const char* comment :
       {"; rmlcell allow 7412", "; see rmlcell: allow 7412", "; rmlcell: allow our 7412",
        "; rmlcell: allow 74120", "; rmlcell: allow 741", "; rmlcell: allowed 7412"}) {
    EXPECT_FALSE(silenced(comment)) << comment;
  }
  // Nor with words of the lines behind it.
  EXPECT_EQ(Details("OL[20] = ON ; rmlcell: allow 7412\nOL[21] = ON ; in file\n"),
            (Texts{"OL[21] is used by the system"}));
  EXPECT_EQ(Details("SPEED 5 ; rmlcell:\n"),
            (Texts{"no word stands behind rmlcell:; write rmlcell: allow and the numbers of "
                   "findings"}));
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: abcdefghijklmnopqrstuvwxyz\n"),
            (Texts{"'abcdefghijklmnopqrst' is no word for rmlcell:; write rmlcell: allow and the "
                   "numbers of findings"}));
}

// Complaints are bounded, have their places and stand among the findings in the order of the text.
TEST(Silence, ComplaintsStandAtTheirComments) {
  std::string text;
  for (int n = 0; n < 101; ++n) text += "  STOP ; rmlcell: allow\n";
  const std::vector<Diagnostic> found = Compile(text, "", {}).diagnostics;
  ASSERT_EQ(found.size(), 100U);
  for (int n = 0; n < 100; ++n) {
    EXPECT_EQ(found[static_cast<std::size_t>(n)].where, (SourceSpan{n + 1, 8, 16, 7 + n * 24}));
  }
  EXPECT_EQ(Details("; rmlcell: allow\nOL[20] = ON\nSTOP ; rmlcell: allow\n"),
            (Texts{"allow needs the numbers of findings", "OL[20] is used by the system",
                   "allow needs the numbers of findings"}));
}

// Behind the last statement there is nothing that it could silence, and it is none for the file.
TEST(Silence, AnAllowanceAtTheEndSilencesNothing) {
  EXPECT_EQ(Details("OL[20] = ON\n; rmlcell: allow 7412\n"),
            (Texts{"OL[20] is used by the system"}));
  const std::vector<Diagnostic> found = Compile("\n; rmlcell: allow\n", "", {}).diagnostics;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].where, (SourceSpan{2, 1, 16, 1}));
}

// What is allowed comes along with the object, for the run.
TEST(Silence, AllowancesComeWithTheSource) {
  const std::string text =
      "; rmlcell: allow 7316 in file\nSPEED 5\nPATH LIN ; rmlcell: allow 7321 7304\n"
      "; rmlcell: allow 7321\nMOVE (1.,\n2.,3.,0.,0.)\n";
  EXPECT_EQ(Compile(text, "", {.source = true}).allowed,
            (std::vector<AllowedFinding>{{0, 7316}, {3, 7321}, {3, 7304}, {5, 7321}}));
  EXPECT_TRUE(Compile(text, "", {}).allowed.empty());
}

// The numbers of findings begin at 1, whether there is one of that number or not.
TEST(Silence, OneIsANumberAndNothingIsNone) {
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 1\n"), Texts{"1 is the number of no finding"});
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 0\n"), Texts{"allow needs the numbers of findings"});
}

// Of more complaints than are told those of the first comments are, whatever they are about.
TEST(Silence, TheFirstComplaintsAreTold) {
  std::string text = "SPEED 5 ; rmlcell: allow 7413\n";
  for (int n = 0; n < 100; ++n) text += "STOP ; rmlcell: allow\n";
  const std::vector<Diagnostic> found = Compile(text, "", {}).diagnostics;
  ASSERT_EQ(found.size(), 100U);
  EXPECT_EQ(found.front().detail, "allow 7413 silences nothing here");
  EXPECT_EQ(found.back().where.line, 100);
}

}  // namespace
}  // namespace rmlcell::optimo
