// Rules that share a code or a figure, and figures of very small tools. docs/verdict.md lists them.
#include <gtest/gtest.h>

#include <string>

#include "engine/simulation/verdict/verdict.h"
#include "tests/engine/simulation/verdict_text.h"

namespace rmlcell::simulation {
namespace {

// OPT-B.08: each axis is told with its own figure.
TEST(VerdictSides, EachAxisHasItsOwnEnd) {
  const std::string into[] = {
      "3.000 mm into the last 5 mm of X", "3.000 mm into the last 5 mm of Y",
      "3.000 mm into the last 5 mm of Z", "3.000 rad into the last degree of A",
      "3.000 rad into the last degree of B"};
  for (std::size_t axis = 0; axis < motion::kAxisCount; ++axis) {
    RunReport report;
    report.cut_figures.near_end[axis] = {.value = 3.0, .place = {.program = 1, .step = 7}};
    EXPECT_EQ(TextOf(Judge(report)), "DOUBTFUL; CELL-E9627 a contour goes " + into[axis] + " @7");
  }
}

// Chips across and straight down are two figures with one code: neither hides the other.
TEST(VerdictSides, TwoFiguresOfOneCodeAreBothTold) {
  RunReport report;
  report.milling = MillingFigures{.removed_mm3 = 1.0};
  report.milling->chips = ChipFigures{.thick_percent = 300.0,
                                      .thick_place = {.program = 1, .step = 3},
                                      .plunge_percent = 250.0,
                                      .plunge_place = {.program = 1, .step = 4}};
  EXPECT_EQ(TextOf(Judge(report)),
            "DOUBTFUL; CELL-E9615 an edge takes off 300.0 % of the most that is usual @3; "
            "CELL-E9615 an edge takes off 250.0 % of the most that is usual straight down @4");
}

// A tool of half a millimetre goes as deep as it is wide, like any other.
TEST(VerdictSides, AThinToolHasADeepPass) {
  RunReport report;
  report.milling = MillingFigures{.removed_mm3 = 0.5,
                                  .tool_diameter_mm = 0.5,
                                  .deepest_pass_mm = 0.5,
                                  .pass_place = {.program = 1, .step = 5}};
  EXPECT_EQ(TextOf(Judge(report)), "GOOD");
  report.milling->deepest_pass_mm = 0.6;
  EXPECT_EQ(TextOf(Judge(report)),
            "DOUBTFUL; CELL-E9612 one pass is as deep as 120.0 % of the width of the tool @5");
}

// A third of the width in whole micrometres, and never more than a third; in whole nanometres where
// that is less than one.
TEST(VerdictSides, TheCellToGiveIsNotRoundedUp) {
  const auto fitting = [](double width_mm) {
    RunReport report;
    report.milling = MillingFigures{.removed_mm3 = 1.0, .cell_mm = 0.1};
    report.milling->reach_width_mm = width_mm;
    const std::string said = TextOf(Judge(report));
    const std::string give = "give --cell ";
    const std::size_t at = said.find(give);
    return at == std::string::npos ? said : said.substr(at + give.size());
  };
  EXPECT_EQ(fitting(0.018), "0.006");
  EXPECT_EQ(fitting(0.0179985), "0.005");     // 5.9995 um
  EXPECT_EQ(fitting(0.0016383), "0.000546");  // 546.1 nm
}

// How much it is stands in the reason as it does in the facts.
TEST(VerdictSides, AnUntouchedBlockIsOne) {
  RunReport report;
  report.milling = MillingFigures{};
  const machine::Judgement judgement = Judge(report);
  ASSERT_EQ(judgement.reasons.size(), 1U);
  EXPECT_EQ(judgement.reasons[0].code, ErrorCode::kCellBlockUntouched);
  EXPECT_EQ(judgement.reasons[0].amount, 1.0);
  EXPECT_EQ(judgement.reasons[0].limit, 0.0);
}

// Of an end that nobody says more about the catalogue says what it means.
TEST(VerdictSides, AnEndWithoutAWordHasThatOfItsCode) {
  EXPECT_EQ(TextOf(JudgeOutcome({.kind = machine::OutcomeKind::kCancelled,
                                 .code = ErrorCode::kCellCancelled,
                                 .place = {.program = 1, .step = 7}})),
            "BAD; CELL-E9307 it was cancelled @7");
}

}  // namespace
}  // namespace rmlcell::simulation
