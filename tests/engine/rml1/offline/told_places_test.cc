#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/core/catalogue.h"
#include "engine/rml1/offline/explain.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// Where the tools say that something is, and when they say nothing.
namespace rmlcell::rml1 {
namespace {

// A cut is told at the name of its command, what is torn where it begins, and a spindle that turns
// behind the last byte.
TEST(ToldPlaces, WhatGcodeCannotSayHasItsPlace) {
  const Result<GcodeText> made =
      ToGcode("!MC1;!VZ2;!PZ-50,200;PU100,100;\nPD200,100;PU;\nPD5", ParametersOf("t1"));
  ASSERT_TRUE(made);
  ASSERT_EQ(made->findings.size(), 3U);
  EXPECT_EQ(made->findings[0].code, ErrorCode::kRml1FeedNotGiven);
  EXPECT_EQ(made->findings[0].where,
            (SourceSpan{.line = 2, .column = 1, .length = 1, .byte_offset = 32}));
  EXPECT_EQ(made->findings[1].code, ErrorCode::kRml1IncompleteCommand);
  EXPECT_EQ(made->findings[1].where,
            (SourceSpan{.line = 3, .column = 1, .length = 1, .byte_offset = 46}));
  EXPECT_EQ(made->findings[2].code, ErrorCode::kRml1SpindleLeftOn);
  EXPECT_EQ(made->findings[2].where,
            (SourceSpan{.line = 3, .column = 4, .length = 1, .byte_offset = 49}));
  for (const Diagnostic& finding : made->findings) {
    EXPECT_EQ(finding.severity, Lookup(finding.code).severity) << finding.detail;
  }
}

// At Z0 the tool touches the work and takes nothing off: a unit below it does.
TEST(ToldPlaces, AlongTheSurfaceNoFeedRateIsMissed) {
  const auto codes = [](const std::string& stream) {
    std::vector<ErrorCode> told;
    const Result<GcodeText> made = ToGcode(stream, ParametersOf("t1"));
    for (const Diagnostic& finding : made.value().findings) told.push_back(finding.code);
    return told;
  };
  EXPECT_EQ(codes("!MC0;PU100,100;PD200,100;PU;"), std::vector<ErrorCode>{});
  EXPECT_EQ(codes("!MC0;!PZ-1,200;PU100,100;PD200,100;PU;"),
            std::vector{ErrorCode::kRml1FeedNotGiven});
  // Where the operator set Z0 the work begins: !ZO moves the heights, and no material.
  EXPECT_EQ(codes("!MC0;!PZ0,200;!ZO-2500;PU100,100;PD200,100;PU;"),
            std::vector{ErrorCode::kRml1FeedNotGiven});
  EXPECT_EQ(codes("!MC0;!PZ0,200;!ZO-1500;PU100,100;PD200,100;PU;"), std::vector<ErrorCode>{});
}

// RML1-9.42
TEST(ToldPlaces, ATornCommandIsExplainedByItsRule) {
  std::vector<Diagnostic> findings;
  ASSERT_TRUE(Explain("H;\nPU1", ParametersOf("t1"), [&](const ExplainedPhrase& phrase) {
    for (const Diagnostic& finding : phrase.findings) findings.push_back(finding);
    return true;
  }));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, Severity::kAdvice);
  EXPECT_EQ(findings[0].rule, "RML1-9.42");
  EXPECT_EQ(findings[0].detail, "incomplete command at end of data");
  EXPECT_EQ(findings[0].where, (SourceSpan{.line = 2, .column = 1, .length = 1, .byte_offset = 3}));
}

// docs/gcode.md: a comment ends with its bracket, so that none may stand within it: what is made is
// read again.
TEST(ToldPlaces, ABracketEndsNoComment) {
  for (const auto& [stream, comment] :
       {std::pair("PU;)", "(RML1-E1 in the stream: ']' begins no command)\n"),
        {"PU;(", "(RML1-E1 in the stream: '[' begins no command)\n"}}) {
    const Result<GcodeText> made = ToGcode(stream, ParametersOf("t1"));
    ASSERT_TRUE(made) << stream;
    EXPECT_NE(made->text.find(comment), std::string::npos) << made->text;
    const Result<StreamOfGcode> again = FromGcode(made->text, ParametersOf("t1"));
    ASSERT_TRUE(again) << stream;
    EXPECT_TRUE(again->ok) << made->text;
  }
}

}  // namespace
}  // namespace rmlcell::rml1
