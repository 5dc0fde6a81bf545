#include "engine/machine/verdict.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/engine/core/arguments_text.h"

namespace rmlcell::machine {
namespace {

TEST(Judgement, TheMostSeriousComesFirstAndDecides) {
  Judgement judgement;
  EXPECT_EQ(VerdictText(judgement.verdict), "GOOD");
  const auto add = [&](Verdict verdict, const char* said) {
    judgement.Add({.verdict = verdict, .said = said});
  };
  add(Verdict::kDoubtful, "1");
  EXPECT_EQ(VerdictText(judgement.verdict), "DOUBTFUL");
  add(Verdict::kBad, "2");
  add(Verdict::kDoubtful, "3");
  add(Verdict::kBad, "4");
  EXPECT_EQ(VerdictText(judgement.verdict), "BAD");
  std::string order;
  for (const Reason& reason : judgement.reasons) order += reason.said;
  EXPECT_EQ(order, "2413");
}

// A finding is judged by the worst reason of its code.
TEST(Judgement, FindingsAreJudgedByTheirReasons) {
  constexpr ErrorCode kWorst = ErrorCode::kCellUsage, kDoubtful = ErrorCode::kCellBadText,
                      kOther = ErrorCode::kCellMode;
  Judgement judgement;
  judgement.Add({.code = kWorst, .verdict = Verdict::kDoubtful});
  judgement.Add({.code = kDoubtful, .verdict = Verdict::kDoubtful});
  judgement.Add({.code = kWorst, .verdict = Verdict::kBad});
  std::vector<Diagnostic> findings(3);
  UntoldFindings untold;
  for (std::size_t n = 0; n < findings.size(); ++n) {
    findings[n].code = n == 0 ? kWorst : n == 1 ? kDoubtful : kOther;
    untold.Add(findings[n]);
  }
  MarkJudged(judgement, findings);
  MarkJudged(judgement, untold);
  const Judged judged[] = {Judged::kBad, Judged::kDoubtful, Judged::kNo};
  for (std::size_t n = 0; n < findings.size(); ++n) {
    EXPECT_EQ(JudgedBy(judgement, findings[n].code), judged[n]) << n;
    EXPECT_EQ(findings[n].judged, judged[n]) << n;
    EXPECT_EQ(untold.kinds().at(findings[n].code).judged, judged[n]) << n;
  }
}

// Counts are whole, percent have one decimal, lengths and times three; figures named beside are
// rounded to three and as short as they can be.
TEST(ReasonOf, FiguresStandInTheSentence) {
  const std::vector<Figure> figures = {{"feed", "mm/s", 2.50049},
                                       {"tool", "mm", 3.0},
                                       {"thin", "mm", -0.0012344},
                                       {"thinner", "mm", -0.00012344}};
  const auto said = [&](std::string_view sentence, const char* unit, double value) {
    const VerdictRule rule{.figure = "x", .verdict = Verdict::kBad, .said = sentence};
    const Reason reason = ReasonOf(rule, {"x", unit, value, {}}, figures);
    EXPECT_EQ(reason.verdict, Verdict::kBad);
    EXPECT_EQ(reason.amount, value);
    EXPECT_EQ(reason.unit, unit);
    return reason.said;
  };
  EXPECT_EQ(said("cuts # mm", "mm", 12.3456), "cuts 12.346 mm");
  EXPECT_EQ(said("# %", "%", 12.34), "12.3 %");
  EXPECT_EQ(said("# times", "", 3.0), "3 times");
  EXPECT_EQ(said("# mm/s in place of #{feed}, with #{tool} mm", "mm/s", 1.0),
            "1.000 mm/s in place of 2.5, with 3 mm");
  EXPECT_EQ(said("#{thin} or #{thinner}", "", 1.0), "-0.001 or -0.000123");
  EXPECT_EQ(said("of #{none}.", "", 1.0), "of .");
  EXPECT_EQ(said("no number", "", 1.0), "no number");
  EXPECT_EQ(ArgumentsText(said("# mm/s in place of #{feed}", "mm/s", 1.0)),
            "x=1 mm/s feed=2.5005 mm/s");
  EXPECT_EQ(ArgumentsText(said("# times", "", 3.0)), "x=3");
}

}  // namespace
}  // namespace rmlcell::machine
