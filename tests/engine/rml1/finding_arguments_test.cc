#include <gtest/gtest.h>

#include <string>

#include "engine/machine/family.h"
#include "engine/rml1/finding.h"
#include "engine/rml1/rml1_family.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/rml1/run_support.h"

// What findings about a stream know besides their texts.
namespace rmlcell::rml1 {
namespace {

std::string FirstArguments(std::string_view stream) {
  const machine::Translation translation =
      Rml1Family().Translate({.name = "a", .bytes = stream}, ParametersOf("t1"), {.advice = true});
  return translation.diagnostics.empty() ? "none"
                                         : ArgumentsText(translation.diagnostics[0].detail);
}

TEST(MillArguments, OfCommandErrors) {
  EXPECT_EQ(FirstArguments("PU;$"), "character='$'");
  EXPECT_EQ(FirstArguments("PU;\xa5"), "byte=165");
  EXPECT_EQ(FirstArguments("PU;PD1;"), "command='PD'");
  EXPECT_EQ(FirstArguments("PU;PD0,9000000;"), "command='PD' value=9e+06");
  EXPECT_EQ(FirstArguments("PU;@1;"), "value=1 least=-4000 most=0");
  EXPECT_EQ(FirstArguments("PU;W-1;"), "command='W' value=-1");
  EXPECT_EQ(FirstArguments("PU;!ZM1;"), "command='!ZM' value=1");
  EXPECT_EQ(FirstArguments("PU;F99;"), "command='F' value=99");
}

// 16 of 19 bytes: blanks stand between commands.
TEST(MillArguments, OfWhatIsNoStream) {
  EXPECT_EQ(FirstArguments("xxxx xxxx xxxx xxxx"), "share=84.2105 %");
}

// What a run tells is what a check tells.
TEST(MillArguments, OfARun) {
  TestRun run(ParametersOf("t1"), "PU;PD0,9000000;");
  run.AdvanceToEnd();
  ASSERT_FALSE(run.seen().diagnostics().empty());
  EXPECT_EQ(ArgumentsText(run.seen().diagnostics()[0].detail), "command='PD' value=9e+06");
  machine::RunSetup empty = SetupOf(ParametersOf("t1"), "PU;");
  empty.main_program = 7;
  TestRun missing(std::move(empty));
  EXPECT_EQ(missing->outcome().detail, "no program in slot 7");
  EXPECT_EQ(ArgumentsText(missing->outcome().detail), "program=7");
  EXPECT_EQ(missing->state().progress, 1.0);  // of nothing, all
}

TEST(MillArguments, OfParameters) {
  const auto made = machine::MakeParameters(Rml1Family(), "srm-20", {{"X_MIN", "500"}});
  ASSERT_FALSE(made);
  const Detail& detail = made.error().detail;
  EXPECT_TRUE(detail.starts_with("X_MIN is 500, not below X_MAX, which is ")) << detail;
  ASSERT_EQ(detail.arguments().size(), 4U);
  EXPECT_EQ(detail.arguments()[0], (Argument{"name", std::string("X_MIN"), ""}));
  EXPECT_EQ(detail.arguments()[1], (Argument{"value", 500.0, "mm"}));
  EXPECT_EQ(detail.arguments()[2], (Argument{"limit_name", std::string("X_MAX"), ""}));
  EXPECT_EQ(detail.arguments()[3].unit, "mm");
}

}  // namespace
}  // namespace rmlcell::rml1
