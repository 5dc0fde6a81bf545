// Chains that end when nothing of them is left, and turns that are nearly over.
#include "engine/rml1/look_ahead.h"

#include <gtest/gtest.h>

#include <string>

#include "engine/core/units.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

using machine::InputKind;
using machine::RunPhase;
using namespace std::chrono_literals;

// With the tool down at Z0 of T1.
Action CutAlongX(double x) {
  Action cut;
  cut.to = {.x = x, .z = -2000.0};
  cut.speed_mm_s = 10.0;
  cut.use = machine::MotionUse::kCut;
  cut.chain = Chain::kToolDown;
  return cut;
}

// motion.md section 6: a HOLD lets the motion end whatever comes behind it. What ends the chain
// may be read when all of it is ridden, and the next motion begins from rest.
TEST(MillLookAhead, AChainMayEndWhenAllOfItIsRidden) {
  const Profile profile = MakeProfile(ParametersOf("t1")).value();
  LookAhead ahead(profile, {.z = -2000.0}, 100.0);
  motion::PlannedMotion ride;
  LookAhead::Leg leg;
  ahead.Add(CutAlongX(1000.0));
  ahead.Replan(motion::RideIntent::kHold, 100.0);
  ASSERT_TRUE(ahead.NextLeg(ride, leg));
  EXPECT_TRUE(ride.ends_move);
  EXPECT_EQ(ride.speed.end().speed, 0.0);
  ahead.Finish(0.0);
  ahead.Replan(motion::RideIntent::kGo, 100.0);
  ahead.EndChain();
  EXPECT_FALSE(ahead.NextLeg(ride, leg));
  ahead.Add(CutAlongX(3000.0));
  ahead.EndChain();
  ASSERT_TRUE(ahead.NextLeg(ride, leg));
  EXPECT_TRUE(ride.ends_move);
  EXPECT_NEAR(ride.path.length(), 20.0, 1e-9);
  EXPECT_EQ(ride.speed.end().speed, 0.0);
  EXPECT_EQ(leg.feed_mm_s, 10.0);
}

// The same of a run: HOLD comes while only a part of the separators behind the motion was read.
TEST(MillLookAhead, AHoldBeforeTheNextCommandIsRead) {
  const std::string separators(std::size_t{3} << 20, ';');
  TestRun run(ParametersOf("t1"), "!MC0;VS10;PD1000,0;" + separators + "!MC1;PD2000,0;!MC0;");
  while (run.seen().moves().empty()) ASSERT_EQ(run->Advance(kForever), RunPhase::kRunning);
  ASSERT_EQ(run.seen().moves().size(), 1U);  // down: how the cut ends is not known yet
  run.Press(InputKind::kHold);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kHalted);
  EXPECT_EQ(run.seen().Events().back(), "halt HOLD");
  EXPECT_EQ(run.variable("X"), "1000");
  run.Press(InputKind::kStart);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_EQ(run.variable("X"), "2000");
  EXPECT_EQ(run.seen().moves().size(), 3U);
}

// A turn has no mm/s that an override could change: one that is pressed in its last half degree,
// at 14 degrees a second and braking by 200 of them, changes nothing of its time.
TEST(MillLookAhead, ATurnKeepsItsSpeedToItsLastDegree) {
  const std::string stream = "!MC0;Z0,0,0;!ZE A90:A30;";
  TestRun untouched(ParametersOf("t1a"), stream);
  ASSERT_EQ(untouched.AdvanceToEnd(), RunPhase::kFinished);
  TestRun run(ParametersOf("t1a"), stream);
  const auto a_deg = [&] { return run->state().tip.a_rad / kRadPerDegree; };
  while (a_deg() < 90.0 - 1e-6) run->Advance(run->state().time + 10ms);
  while (a_deg() > 30.5) run->Advance(run->state().time + 1ms);
  ASSERT_GT(a_deg(), 30.2);
  run.Press(InputKind::kOverride, 50.0);
  ASSERT_EQ(run.AdvanceToEnd(), RunPhase::kFinished);
  EXPECT_NEAR(a_deg(), 30.0, 1e-6);
  EXPECT_NEAR(run.time_s(), untouched.time_s(), 1e-4);
}

}  // namespace
}  // namespace rmlcell::rml1
