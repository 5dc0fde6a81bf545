// Inputs that come from outside while the run goes on, not from a script: what waits for them sees
// them at once. OPT-B.30
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "engine/optimo/control/optimo_family.h"
#include "tests/engine/optimo/control/run_text.h"

namespace rmlcell::optimo::testing::live_inputs {
namespace {

using machine::InputKind;
using machine::RunPhase;

// No multiple of the system cycle of 0.048 s.
constexpr double kBetweenTicks_s = 2.51;

// A run of this program that has come to `kBetweenTicks_s`.
std::unique_ptr<machine::Run> RunningOf(const std::string& text) {
  static machine::RunObserver nobody;
  Result<std::unique_ptr<machine::Run>> run = OptimoFamily().NewRun(SetupOf(text), nobody);
  EXPECT_TRUE(bool(run));
  EXPECT_EQ((*run)->Advance(At(kBetweenTicks_s)), RunPhase::kRunning);
  return *std::move(run);
}

void SetInput(machine::Run& run, int index, double value) {
  run.Apply({.at = run.state().time, .kind = InputKind::kLogical, .index = index, .value = value});
  run.Advance(At(kBetweenTicks_s));  // what happens at this instant
}

// OPT-3.38, OPT-B.30: a WORK that waits in the background for its /START.
TEST(LiveInputs, AWorkInTheBackgroundBeginsAtOnce) {
  const auto run = RunningOf("WORK 0,0/ON /START (IL[16]) /NEXT\nDELAY 5\nWORK 0,0/OFF\n");
  SetInput(*run, 17, 1.0);
  EXPECT_FALSE(run->state().beam_on);
  SetInput(*run, 16, 1.0);
  EXPECT_TRUE(run->state().beam_on);
  EXPECT_EQ(run->state().time, At(kBetweenTicks_s));
  EXPECT_EQ(run->state().place.step, 2);
}

// OPT-3.38, OPT-B.30: its /END is looked at each cycle only, from the WORK on: 53 x 0.048 s.
TEST(LiveInputs, AWorkEndsAtItsNextCycle) {
  const auto run = RunningOf("WORK 0,0/ON /END (IL[20])\nDELAY 5\n");
  SetInput(*run, 20, 1.0);
  EXPECT_TRUE(run->state().beam_on);
  run->Advance(At(53 * 0.048) - SimTime(1));
  EXPECT_TRUE(run->state().beam_on);
  run->Advance(At(53 * 0.048));
  EXPECT_FALSE(run->state().beam_on);
}

// OPT-B.30: so do a WAIT and a WORK that the program stands at.
TEST(LiveInputs, TheProgramGoesOnAtOnce) {
  for (const std::string first : {"WAIT IL[16]", "WORK 0,0/ON /START (IL[16])"}) {
    SCOPED_TRACE(first);
    const auto run = RunningOf(first + "\nDELAY 5\nWORK 0,0/OFF\n");
    EXPECT_EQ(run->state().place.step, 1);
    SetInput(*run, 17, 1.0);
    EXPECT_EQ(run->state().place.step, 1);
    SetInput(*run, 16, 1.0);
    EXPECT_EQ(run->state().place.step, 2);
    EXPECT_EQ(run->state().time, At(kBetweenTicks_s));
  }
}

}  // namespace
}  // namespace rmlcell::optimo::testing::live_inputs
