#include "engine/simulation/run/trial_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "engine/families/families.h"
#include "tests/engine/simulation/fake_family.h"

namespace rmlcell::simulation {
namespace {

Result<TrialRun> RunTrial(const std::string& text, SimulationOptions options = {}) {
  const machine::MachineFamily& family = *families::FindFamily("optimo");
  machine::RunSetup setup{machine::Parameters(family.parameters())};
  machine::Translation made =
      family.Translate({.name = "test.S", .bytes = text}, setup.parameters, {});
  EXPECT_TRUE(made.ok);
  setup.programs[1].object = machine::Bytes::Of(std::move(made.object));
  setup.main_program = 1;
  return RunForComparison(family, std::move(setup), std::move(options));
}

// At 50 mm/s, 100 mm without the beam and 50 mm with it, which pierced for a second; ramps take
// sqrt(50 / 40000) s twice in all, settling 0.048 s. The beam has 1500 W.
TEST(TrialRun, HasTheFiguresThatAreCompared) {
  const Result<TrialRun> run = RunTrial(
      "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (121.02,2201.2,-350.,0.,0.)\nWORK 0,0/ON\nDELAY 1\n"
      "MOVE (171.02,2201.2,-350.,0.,0.)\nWORK 0,0/OFF\n");
  ASSERT_TRUE(run);
  EXPECT_EQ(run->outcome.kind, machine::OutcomeKind::kCompleted);
  const double more_s = 2.0 * std::sqrt(50.0 / 40'000.0) + 0.048;
  const double beam_s = 1.0 + 1.0 + more_s;
  const struct {
    const char* name;
    const char* unit;
    double value;
  } expected[] = {{"cycle_time", "s", beam_s + 2.0 + more_s},
                  {"cut_length", "mm", 50.0},
                  {"travel_length", "mm", 100.0},
                  {"beam_on_time", "s", beam_s},
                  {"pierces", "", 1.0},
                  {"beam_energy", "J", 1500.0 * beam_s}};
  ASSERT_EQ(run->figures.size(), std::size(expected));
  for (std::size_t n = 0; n < std::size(expected); ++n) {
    EXPECT_EQ(run->figures[n].name, expected[n].name);
    EXPECT_EQ(run->figures[n].unit, expected[n].unit);
    EXPECT_NEAR(run->figures[n].value, expected[n].value, 1e-3) << expected[n].name;
  }
}

// A program that does not run to its end by itself has no figures, but the path as far as it came.
TEST(TrialRun, OfAFailureHasThePathOnly) {
  const Result<TrialRun> run =
      RunTrial("COORD ABSOL\nPATH LIN\nMOVE (121.02,2201.2,-350.,0.,0.)\nVR[0]=1/0\n");
  ASSERT_TRUE(run);
  EXPECT_EQ(run->outcome.kind, machine::OutcomeKind::kFailed);
  EXPECT_TRUE(run->figures.empty());
  ASSERT_NE(run->path, nullptr);
  EXPECT_EQ(run->path->elements(), 1u);
}

// What the verdict on it hangs on is told beside the outcome: whoever compares two runs asks why
// one of them is bad.
TEST(TrialRun, HasTheReasonsOfItsVerdict) {
  const Result<TrialRun> failed = RunTrial("VR[0]=1/0\n");
  ASSERT_TRUE(failed);
  ASSERT_FALSE(failed->reasons.empty());
  EXPECT_EQ(failed->reasons.front().code, failed->outcome.code);
  EXPECT_EQ(failed->reasons.front().verdict, machine::Verdict::kBad);
}

// It is driven as its caller says: where the program halts it ends, or is started.
TEST(TrialRun, IsDrivenAsAskedFor) {
  const std::string halts = "STOP\nDELAY 1.\n";
  const Result<TrialRun> ended = RunTrial(halts);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->outcome.kind, machine::OutcomeKind::kStopped);
  EXPECT_EQ(ended->outcome.code, ErrorCode::kCellWaitsForever);
  SimulationOptions options;
  options.at_halt = AtHalt::kStart;
  const Result<TrialRun> started = RunTrial(halts, options);
  ASSERT_TRUE(started);
  EXPECT_EQ(started->outcome.kind, machine::OutcomeKind::kCompleted);
}

TEST(TrialRun, OfASetupThatMakesNoSenseIsRefused) {
  machine::RunSetup setup = FakeFamily::Setup();
  setup.main_program = 99;
  EXPECT_FALSE(RunForComparison(FakeFamily(), std::move(setup), {}));
}

}  // namespace
}  // namespace rmlcell::simulation
