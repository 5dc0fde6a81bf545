// By how much a stream was moved, and speeds that are nearly those of the machine.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

// rewrite.h: as far as whole units allow, each axis by itself: of T1 0.01 mm, of an MDX-20 0.025.
TEST(ToldMoves, AreWholeUnits) {
  const auto moved = [](const std::array<double, 3>& by_mm, std::string_view profile) {
    return MoveStream("!PZ-50,200;PU100,100;PD200,200;", ParametersOf(profile), by_mm)
        .value()
        .moved_mm;
  };
  EXPECT_EQ(moved({0.014, -0.016, 0.0}, "t1"), (std::array{0.01, -0.02, 0.0}));
  EXPECT_EQ(moved({0.0, 3.0, 0.123}, "t1"), (std::array{0.0, 3.0, 0.12}));
  EXPECT_EQ(moved({0.03, 0.0, -0.01}, "mdx-20"), (std::array{0.025, 0.0, 0.0}));
}

// docs/gcode.md: 240 mm/min are 4 mm/s, which T1 has; a little beside that it has not, and what it
// takes is told.
TEST(ToldMoves, AFeedThatIsNearlyOne) {
  const auto findings = [](const std::string& feed) {
    const auto made = FromGcode("G1 X5 F" + feed + "\n", ParametersOf("t1")).value();
    EXPECT_TRUE(made.ok);
    for (const Diagnostic& finding : made.findings)
      EXPECT_EQ(finding.code, ErrorCode::kRml1SpeedRounded);
    return made.findings.size();
  };
  EXPECT_EQ(findings("240"), 0U);
  EXPECT_EQ(findings("240.00002"), 1U);
  EXPECT_EQ(findings("239.99998"), 1U);
}

}  // namespace
}  // namespace rmlcell::rml1
