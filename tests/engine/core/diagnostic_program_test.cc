// Which program a finding is of, where no file is known.
#include <gtest/gtest.h>

#include "engine/core/diagnostic.h"
#include "engine/core/number_text.h"

namespace rmlcell {
namespace {

TEST(DiagnosticProgram, TheFirstSlotIsAProgramToo) {
  Diagnostic finding;
  finding.code = ErrorCode::kCellBadText;
  finding.detail = "so";
  for (const int slot : {1, 2, 99}) {
    finding.program = slot;
    EXPECT_TRUE(
        FormatDiagnostic(finding, "").starts_with("program " + std::to_string(slot) + ": "));
  }
  finding.program = 0;
  EXPECT_FALSE(FormatDiagnostic(finding, "").starts_with("program"));
  finding.program = 1;
  finding.file = "a.S";
  EXPECT_TRUE(FormatDiagnostic(finding, "").starts_with("a.S: "));
}

// The first line, column and step are told as any other.
TEST(DiagnosticProgram, ThePlaceMayBeTheFirst) {
  Diagnostic finding;
  finding.code = ErrorCode::kCellBadText;
  finding.detail = "so";
  finding.file = "a.S";
  finding.step = 1;
  finding.where.line = 1;
  finding.where.column = 1;
  EXPECT_TRUE(FormatDiagnostic(finding, "").starts_with("a.S:1:1: "));
  EXPECT_NE(FormatDiagnostic(finding, "").find("so (step 1)"), std::string::npos);
}

// Nobody reads more than a hundred decimals, and none are fewer than none.
TEST(DiagnosticProgram, ANumberHasAHundredDecimalsAtMost) {
  EXPECT_EQ(FixedText(1.5, 150), "1.5" + std::string(99, '0'));
  EXPECT_EQ(FixedText(2.25, -3), "2");
}

}  // namespace
}  // namespace rmlcell
