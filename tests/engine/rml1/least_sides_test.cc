// Where the least is something: an origin at the end of the travel, the first stage of a spindle,
// a run that cuts nothing.
#include <gtest/gtest.h>

#include <string>

#include "engine/rml1/figures.h"
#include "engine/rml1/rml1_family.h"
#include "engine/rml1/work_fit.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

Extent ReachFrom(double low, double high) { return {.low = low, .high = high, .known = true}; }

// Work as long as the travel, from -100 to 100 mm here: there is one place for its origin, at
// either end of the travel.
TEST(LeastFit, AnOriginAtTheEndOfTheTravel) {
  const CuttingRange travel{{-10000.0, 10000.0}, {-10000.0, 10000.0}, {-6000.0, 0.0}};
  const WorkExtent work{ReachFrom(0, 20000), ReachFrom(-20000, 0), ReachFrom(-100, 0)};
  const WorkFit fit = FitOf(work, {}, {}, travel, 0.0, 100.0);
  EXPECT_EQ(fit.x.low, -100.0);
  EXPECT_EQ(fit.x.high, -100.0);
  EXPECT_EQ(fit.x.move, 0.0);
  EXPECT_EQ(fit.y.low, 100.0);
  EXPECT_EQ(fit.y.high, 100.0);
  EXPECT_EQ(fit.y.move, 0.0);
}

// RML1-9.31: 0 is the first of the stages, and an allowed value; -1 is none.
TEST(LeastSpindle, StageZeroIsOne) {
  for (const char* profile : {"t1", "t1s"}) {
    const auto found = [&](std::string_view stream) {
      return Rml1Family()
          .Translate({.name = "a", .bytes = stream}, ParametersOf(profile), {.advice = true})
          .diagnostics.size();
    };
    EXPECT_EQ(found("PU;!RC0;"), 0U) << profile;
    EXPECT_EQ(found("PU;!RC-1;"), 1U) << profile;
  }
}

// A run that only travels cuts nothing, and with no speed that the machine does not have.
TEST(LeastFigures, OfARunThatOnlyTravels) {
  TestRun run(ParametersOf("t1"), "PU100,100;");
  run.AdvanceToEnd();
  const Figures figures = run.figures();
  EXPECT_EQ(figures.at("nothing_cut"), 1.0);
  EXPECT_EQ(figures.at("skimmed_length"), 0.0);
  EXPECT_EQ(figures.at("feed_limited_length"), 0.0);
  for (const char* none :
       {"feed_limited_asked", "feed_limited_used", "rpm_limited_asked", "rpm_limited_used"})
    EXPECT_FALSE(figures.contains(none)) << none;
}

}  // namespace
}  // namespace rmlcell::rml1
