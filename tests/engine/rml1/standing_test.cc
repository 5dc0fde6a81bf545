// A mill that nothing runs on: how its axes go by hand, and where its keys lead.
#include "engine/machine/standing.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "engine/core/units.h"
#include "engine/rml1/rml1_family.h"
#include "tests/engine/rml1/run_support.h"

namespace rmlcell::rml1 {
namespace {

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

std::unique_ptr<machine::Standing> Stand(const machine::Parameters& parameters) {
  return Rml1Family().NewStanding(parameters, {}).value();
}

void ExpectAxes(const motion::AxisValues& got, const std::array<double, 5>& wanted) {
  for (std::size_t i = 0; i < wanted.size(); ++i)
    EXPECT_DOUBLE_EQ(got[static_cast<Eigen::Index>(i)], wanted[i]) << i;
}

// LIVE-8.01, LIVE-8.03: slowly at 1 mm/s and 1 degree a second, fast as the axes can; a tap goes
// 0.01 mm and 0.01 degrees. The rotary axis turns without end, and B there is none.
TEST(StandingMill, ItsAxesByHand) {
  machine::Parameters parameters = ParametersOf("mdx-40a-rotary");
  ASSERT_TRUE(parameters.Set("JOG_STEP", 0.05).ok());
  const auto mill = Stand(parameters);
  const double a = 60.0 * kRadPerDegree;
  const auto fast = mill->ByHand(100.0, true);
  ASSERT_TRUE(fast);
  ExpectAxes(fast->plus, {50.0, 50.0, 30.0, a, 0.0});
  ExpectAxes(fast->minus, {50.0, 50.0, 30.0, a, 0.0});
  ExpectAxes(fast->least, {0.05, 0.05, 0.05, 0.01 * kRadPerDegree, 0.0});
  const motion::AxisLimits& axes = fast->machine.axes;
  ExpectAxes(axes.speed, {50.0, 50.0, 30.0, a, 0.0});
  ExpectAxes(axes.acceleration, {200.0, 200.0, 200.0, 200.0 * kRadPerDegree, 0.0});
  ExpectAxes(axes.jerk, {kNoEnd, kNoEnd, kNoEnd, kNoEnd, kNoEnd});
  ExpectAxes(axes.travel_min, {34.0, 0.0, -68.0, -kNoEnd, 0.0});
  ExpectAxes(axes.travel_max, {305.0, 305.0, 0.0, kNoEnd, 0.0});
  EXPECT_EQ(fast->machine.tip_acceleration_mm_s2, 200.0);
  EXPECT_EQ(fast->machine.tip_jerk_mm_s3, kNoEnd);
  EXPECT_FALSE(fast->tool_z_down);
  const auto slow = mill->ByHand(100.0, false);
  ASSERT_TRUE(slow);
  ExpectAxes(slow->plus, {1.0, 1.0, 1.0, 1.0 * kRadPerDegree, 0.0});
  ExpectAxes(slow->minus, {1.0, 1.0, 1.0, 1.0 * kRadPerDegree, 0.0});
}

// Axes that it does not have do not move: T1 has no rotary one, T1n no Y.
TEST(StandingMill, HasTheAxesOfItsModel) {
  ExpectAxes(Stand(ParametersOf("t1"))->ByHand(100.0, true)->plus, {60.0, 60.0, 60.0, 0.0, 0.0});
  ExpectAxes(Stand(ParametersOf("t1n"))->ByHand(100.0, true)->plus,
             {60.0, 0.0, 60.0, 60.0 * kRadPerDegree, 0.0});
}

// RML1-3A.40: HOME leads up and to the work origin, VIEW up and to the corner where the table is
// farthest out; A stays.
TEST(StandingMill, ItsKeysLeadUpAndAcross) {
  machine::Parameters parameters = ParametersOf("mdx-40a-rotary");
  ASSERT_TRUE(parameters.Set("ORIGIN_X", 100.0).ok());
  ASSERT_TRUE(parameters.Set("ORIGIN_Y", 20.0).ok());
  ASSERT_TRUE(parameters.Set("A_SENSE", std::string_view("LEFT")).ok());
  const auto mill = Stand(parameters);
  mill->MoveTo({.column = {50.0, 60.0, -30.0}, .a_rad = 0.5, .b_rad = 0.0});
  EXPECT_NEAR(mill->state().axes.a_rad, 0.5, 1e-12);
  EXPECT_EQ(mill->state().axes.b_rad, 0.0);
  EXPECT_EQ(mill->ReadVariable("A")->text.substr(0, 6), "-28.64");  // it turns to the left
  const auto end_of = [&](machine::PanelKey key) {
    const std::vector<motion::AxisPose> way = mill->WayOf(key);
    EXPECT_EQ(way.size(), 2U);
    EXPECT_NEAR((way[0].column - motion::MachinePoint(50.0, 60.0, 0.0)).norm(), 0.0, 1e-9);
    EXPECT_NEAR(way[0].a_rad, 0.5, 1e-12);
    EXPECT_NEAR(way[1].a_rad, 0.5, 1e-12);
    return way[1].column;
  };
  EXPECT_NEAR((end_of(machine::PanelKey::kHome) - motion::MachinePoint(100.0, 20.0, 0.0)).norm(),
              0.0, 1e-9);
  EXPECT_NEAR((end_of(machine::PanelKey::kView) - motion::MachinePoint(34.0, 305.0, 0.0)).norm(),
              0.0, 1e-9);
}

// LIVE-2.13, RML1-9.11: Z0 and ORIGIN are set where the tool stands, each by its own key.
TEST(StandingMill, EachKeySetsWhatItSays) {
  const auto pressed = [](machine::PanelKey key) {
    const auto mill = Stand(ParametersOf("t1"));
    mill->MoveTo({.column = {50.0, 60.0, -30.0}, .a_rad = 0.0, .b_rad = 0.0});
    mill->PressPanel(key);
    return mill->state().work_origin.value_or(motion::MachinePoint(0.0, 0.0, 0.0));
  };
  const motion::MachinePoint height(0.0, 0.0, -30.0);
  EXPECT_NEAR((pressed(machine::PanelKey::kZ0) - height).norm(), 0.0, 1e-9);
  const motion::MachinePoint corner(50.0, 60.0, -20.0);
  EXPECT_NEAR((pressed(machine::PanelKey::kOrigin) - corner).norm(), 0.0, 1e-9);
}

// standing.h: it is at time 0, and no run goes on; a spindle that its last run left on turns until
// it rests, and stays off then, where the tool stands.
TEST(StandingMill, ASpindleThatWasLeftOnStopsWhereItRests) {
  TestRun run(ParametersOf("t1"), "!MC1;PD1000,0;");
  ASSERT_EQ(run.AdvanceToEnd(), machine::RunPhase::kFinished);
  const auto mill = Rml1Family().NewStanding(ParametersOf("t1"), run->SaveMachine()).value();
  EXPECT_EQ(mill->state().phase, machine::RunPhase::kFinished);
  EXPECT_EQ(mill->state().time, SimTime::zero());
  EXPECT_TRUE(mill->state().spindle_on);
  mill->Rest();
  EXPECT_FALSE(mill->state().spindle_on);
  EXPECT_NE(mill->Save().find("\nspindle_on 0\n"), std::string::npos);
  EXPECT_NEAR((mill->state().tip.tip - motion::MachinePoint(10.0, 0.0, -20.0)).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace rmlcell::rml1
