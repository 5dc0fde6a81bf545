// What a check does not count, and what stands in no order.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

// T1: 100 units in a mm, Z0 20 mm below the top and 40 mm above the bottom.
namespace rmlcell::rml1 {
namespace {

machine::Translation QuietlyChecked(std::string_view stream, bool advice) {
  return Rml1Family().Translate({.name = "part.rml", .bytes = stream}, ParametersOf("t1"),
                                {.advice = advice});
}
Figures QuietFigures(std::string_view stream) {
  return ByName(QuietlyChecked(stream, false).figures);
}

// RML1-9.06: of one kind of advice a thousand are told and the rest is counted; where none is
// wanted nothing is.
TEST(QuietChecks, AdviceThatIsNotWantedIsNotCounted) {
  std::string stream;
  for (int n = 0; n < 1005; ++n) stream += "F99;";
  const machine::Translation wanted = QuietlyChecked(stream, true);
  EXPECT_EQ(wanted.diagnostics.size(), 1000U);
  EXPECT_EQ(wanted.diagnostics_dropped.count(), 5U);
  const machine::Translation unwanted = QuietlyChecked(stream, false);
  EXPECT_TRUE(unwanted.diagnostics.empty());
  EXPECT_TRUE(unwanted.diagnostics_dropped.empty());
}

// RML1-9.31, RML1-3C.08: nobody waits for another speed of the spindle, and how long a pause is
// nobody knows: of the least time they take nothing.
TEST(QuietChecks, SpindleSpeedsAndPausesTakeNoTime) {
  const double plain = QuietFigures("!MC1;PU1000,0;PU2000,0;").at("least_time");
  EXPECT_GT(plain, 0.0);
  EXPECT_EQ(QuietFigures("!MC1;PU1000,0;!RC15;PU2000,0;").at("least_time"), plain);
  EXPECT_EQ(QuietFigures("!MC1;PU1000,0;!NR;PU2000,0;").at("least_time"), plain);
}

// RML1-9.10: 60 mm of travel. 50 mm deep the work leads 10 mm below it and fits from a higher Z0;
// 60.5 mm deep it fits from none, and nobody is told to raise it.
TEST(QuietChecks, WorkThatIsTooDeepIsNotToldToRise) {
  const Figures fits = QuietFigures("!MC1;V10;Z1000,1000,-5000;");
  EXPECT_EQ(fits.at("oversize_z"), 0.0);
  EXPECT_NEAR(fits.at("clipped_z_low"), 10.0, 1e-9);
  const Figures deeper = QuietFigures("!MC1;V10;Z1000,1000,-6050;");
  EXPECT_NEAR(deeper.at("oversize_z"), 0.5, 1e-9);
  EXPECT_FALSE(deeper.contains("clipped_z_low"));
}

// run.h: breakpoints come in any order, and those of another program are none.
TEST(QuietChecks, BreakpointsComeInAnyOrder) {
  TestRun run(ParametersOf("t1"), "PU1,1;PU2,2;PU3,3;PU4,4;");
  const std::vector<machine::Breakpoint> breakpoints = {
      {.at = {1, 3}}, {.at = {2, 4}}, {.at = {1, 2}}};
  run->SetBreakpoints(breakpoints);
  for (const int step : {2, 3}) {
    ASSERT_EQ(run.AdvanceToEnd(), machine::RunPhase::kHalted) << step;
    EXPECT_EQ(run->state().place.step, step);
    run.Press(machine::InputKind::kStart);
  }
  EXPECT_EQ(run.AdvanceToEnd(), machine::RunPhase::kFinished);
}

// RML1-3D.23, RML1-3D.25: a number out of its range drops its group and all up to the terminator.
TEST(QuietChecks, ANumberOutOfRangeDropsTheGroupsBehindIt) {
  TestRun run(ParametersOf("t1a"), "!MC0;!ZE X9000000Y500:Z-100:A90;PU7,8;");
  ASSERT_EQ(run.AdvanceToEnd(), machine::RunPhase::kFinished);
  EXPECT_EQ(run.figures().at("errors"), 1.0);
  EXPECT_EQ(run.figures().at("errors.3"), 1.0);
  EXPECT_EQ(run.seen().moves().size(), 2U);  // of PU: its height, and across
  EXPECT_EQ(run.variable("X"), "7");
  EXPECT_EQ(run.variable("Y"), "8");
  EXPECT_EQ(run.variable("A"), "0");
}

}  // namespace
}  // namespace rmlcell::rml1
