#include "engine/optimo/language/silence.h"

#include <gtest/gtest.h>

#include <string>

#include "engine/optimo/language/fixes.h"
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
  // The advice on contours comes from elsewhere.
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 7317\n"), Texts{});
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 7317\n",
                    {.further_advice = [](const ParsedProgram&, Findings&) {}}),
            (Texts{"allow 7317 silences nothing here"}));
  // An axis that holds back is found when the program runs.
  EXPECT_EQ(Details("SPEED 5 ; rmlcell: allow 7321\n"), Texts{});
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

}  // namespace
}  // namespace rmlcell::optimo
