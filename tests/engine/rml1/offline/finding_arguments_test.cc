#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "engine/rml1/offline/work_check.h"
#include "tests/engine/core/arguments_text.h"
#include "tests/engine/rml1/offline/made_text.h"
#include "tests/engine/rml1/run_support.h"

// What the tools for streams know besides their texts. T1: X 0 to 200 mm, 100 units in a mm.
namespace rmlcell::rml1 {
namespace {

std::string FirstOfGcode(std::string_view text) {
  const StreamOfGcode made = FromGcode(text, ParametersOf("t1")).value();
  return made.findings.empty() ? "none" : ArgumentsText(made.findings[0].detail);
}

TEST(StreamToolArguments, OfGcode) {
  EXPECT_EQ(FirstOfGcode("G99\n"), "word='G99'");
  EXPECT_EQ(FirstOfGcode("$\n"), "character='$'");
  EXPECT_EQ(FirstOfGcode("G1 F0 X1\n"), "word='F0'");
  EXPECT_EQ(FirstOfGcode("G1 X\n"), "word='X'");
  // From (0, 0) to (10, 0): R is half of it at least.
  EXPECT_EQ(FirstOfGcode("G2 X10 Y0 R2 F60\n"), "radius=2 mm distance=10 mm");
  EXPECT_EQ(FirstOfGcode("G0 X1000000\n"), "axis='X' value=1e+06 mm");
}

// From X 10 to 201 mm: 10 to the left at most, and 1 at least.
TEST(StreamToolArguments, OfWorkBeyondTheTravel) {
  const auto wide =
      CheckWork(machine::Bytes::Borrowed("PU1000,100;\nPD20100,100;PU;"), ParametersOf("t1"))
          .value();
  ASSERT_TRUE(wide);
  EXPECT_EQ(ArgumentsText(wide->detail),
            "length=1 mm beyond=1 mm limit=200 mm axis='X' least=-10 mm most=-1 mm");
}

// 2 by 1 mm.
TEST(StreamToolArguments, OfCopies) {
  constexpr std::string_view kSmall = "PU0,0;PD200,0;PD200,100;PU;";
  const auto told = [&](const TileOptions& options) {
    const auto made = TileStream(kSmall, ParametersOf("t1"), options);
    return made ? std::string("made") : ArgumentsText(made.error().detail);
  };
  EXPECT_EQ(told({.within_mm = {{1.99, 5.0}}, .gap_mm = 1.0}),
            "width=2 mm height=1 mm within_width=1.99 mm within_height=5 mm");
  EXPECT_EQ(told({.columns = 0}), "count=0 most=1000");
  EXPECT_EQ(told({.gap_mm = -1.0}), "gap=-1 mm");
}

TEST(StreamToolArguments, OfScales) {
  const auto scaled = ScaleStream("PU;", ParametersOf("t1"), 0.5, 100.0);
  ASSERT_FALSE(scaled);
  EXPECT_EQ(scaled.error().detail, "0.5 units in a mm; from 1 to 10000 are possible");
  EXPECT_EQ(ArgumentsText(scaled.error().detail), "units=0.5");
}

}  // namespace
}  // namespace rmlcell::rml1
