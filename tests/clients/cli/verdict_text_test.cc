#include "clients/cli/verdict_text.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "clients/cli/terminal.h"

namespace rmlcell::cli {
namespace {

v1::Outcome Ended(v1::Outcome::Kind kind, v1::Verdict verdict) {
  v1::Outcome outcome;
  outcome.set_kind(kind);
  outcome.set_verdict(verdict);
  return outcome;
}

// docs/verdict.md: BAD 1; DOUBTFUL 1 where it is strict; whatever the outcome is.
TEST(ExitCodes, FollowTheVerdict) {
  for (const auto kind : {v1::Outcome::KIND_COMPLETED, v1::Outcome::KIND_FAILED}) {
    EXPECT_EQ(ExitOf(Ended(kind, v1::VERDICT_GOOD), false), kGood);
    EXPECT_EQ(ExitOf(Ended(kind, v1::VERDICT_GOOD), true), kGood);
    EXPECT_EQ(ExitOf(Ended(kind, v1::VERDICT_DOUBTFUL), false), kGood);
    EXPECT_EQ(ExitOf(Ended(kind, v1::VERDICT_DOUBTFUL), true), kProgramErrors);
    EXPECT_EQ(ExitOf(Ended(kind, v1::VERDICT_BAD), false), kProgramErrors);
    EXPECT_EQ(ExitOf(Ended(kind, v1::VERDICT_BAD), true), kProgramErrors);
  }
}

// Jobs that nothing was judged of: refused, lost with their worker, run by an older server.
TEST(ExitCodes, FollowTheOutcomeWhereNothingWasJudged) {
  const auto exit_of = [](v1::Outcome::Kind kind) {
    return ExitOf(Ended(kind, v1::VERDICT_UNSPECIFIED), true);
  };
  EXPECT_EQ(exit_of(v1::Outcome::KIND_COMPLETED), kGood);
  EXPECT_EQ(exit_of(v1::Outcome::KIND_STOPPED), kProgramErrors);
  EXPECT_EQ(exit_of(v1::Outcome::KIND_FAILED), kProgramErrors);
  EXPECT_EQ(exit_of(v1::Outcome::KIND_CANCELLED), kProgramErrors);
  EXPECT_EQ(exit_of(v1::Outcome::KIND_BUDGET_EXCEEDED), kProgramErrors);
}

TEST(VerdictLines, TellTheFirstReasonAndCountTheOthers) {
  ASSERT_EQ(setenv("NO_COLOR", "1", 1), 0);
  v1::Outcome outcome;
  EXPECT_EQ(VerdictLine(v1::VERDICT_GOOD, outcome.reasons()), "GOOD");
  v1::VerdictReason& reason = *outcome.add_reasons();
  reason.set_message("cut \x1b deep");
  EXPECT_EQ(VerdictLine(v1::VERDICT_BAD, outcome.reasons()), "BAD, cut \\x1B deep");
  outcome.add_reasons();
  EXPECT_EQ(VerdictLine(v1::VERDICT_BAD, outcome.reasons()), "BAD, cut \\x1B deep (and 1 more)");
  outcome.add_reasons();
  EXPECT_EQ(VerdictLine(v1::VERDICT_BAD, outcome.reasons()), "BAD, cut \\x1B deep (and 2 more)");
}

TEST(Places, NameWhatIsKnown) {
  v1::SourcePlace place;
  EXPECT_EQ(PlaceText(place), "");
  place.set_line(7);
  EXPECT_EQ(PlaceText(place), "line 7");
  place.set_program(1);
  EXPECT_EQ(PlaceText(place), "program 1 line 7");
  place.set_program(45);
  place.set_step(3);
  EXPECT_EQ(PlaceText(place), "program 45 step 3 line 7");
  place.clear_program();
  place.set_step(1);
  place.set_line(1);
  EXPECT_EQ(PlaceText(place), "step 1 line 1");
}

TEST(VerdictLines, CountWhatWasFound) {
  v1::Findings found;
  EXPECT_EQ(CountText(found), "");
  found.add_diagnostics();
  EXPECT_EQ(CountText(found), ", 1 finding");
  found.set_diagnostics_dropped(1);
  EXPECT_EQ(CountText(found), ", 2 findings");
  // What is not ok fails, whatever its verdict says.
  found.set_verdict(v1::VERDICT_GOOD);
  EXPECT_EQ(ExitOf(found, false), kProgramErrors);
  found.set_ok(true);
  EXPECT_EQ(ExitOf(found, false), kGood);
  found.set_verdict(v1::VERDICT_DOUBTFUL);
  EXPECT_EQ(ExitOf(found, false), kGood);
  EXPECT_EQ(ExitOf(found, true), kProgramErrors);
}

TEST(VerdictLines, AReasonSaysWhereAndWhatToDo) {
  v1::VerdictReason reason;
  reason.set_message("cut \x1b deep");
  reason.set_code("CELL-E1");
  EXPECT_EQ(ReasonLine(reason), "cut \\x1B deep (CELL-E1)");
  reason.mutable_first()->set_step(3);
  reason.set_advice("lift it");
  EXPECT_EQ(ReasonLine(reason), "cut \\x1B deep (CELL-E1, step 3); lift it");
}

}  // namespace
}  // namespace rmlcell::cli
