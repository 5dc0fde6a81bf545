// What comes first counts: the first step, the first axis, the first move, the first letter.
#include <gtest/gtest.h>

#include <string>

#include "proto/bridge/findings.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/report.h"
#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/report.pb.h"

namespace rmlcell::bridge {
namespace {

constexpr machine::FamilyInfo kFiveAxes = {.axes = "X Y Z A B"};

// run_event.proto AppliedInput.simulation_until: step 0 is none, step 1 is one.
TEST(FirstOfAll, ADryRunMayEndAtTheFirstStep) {
  const auto until = [](int step) {
    v1::AppliedInput applied;
    applied.mutable_simulation_until()->set_program(12);
    applied.mutable_simulation_until()->set_step(step);
    const auto input = InputOf(applied);
    EXPECT_TRUE(input && *input);
    return std::get<machine::SetSimulation>(**input).until;
  };
  EXPECT_FALSE(until(0));
  ASSERT_TRUE(until(1));
  EXPECT_EQ(until(1)->program, 12);
  EXPECT_EQ(until(1)->step, 1);
  ASSERT_TRUE(until(2));
  EXPECT_EQ(until(2)->step, 2);
}

TEST(FirstOfAll, OneShortMoveAndTheFirstAxisAreTold) {
  simulation::RunReport report;
  report.shortfall.moves = 1;
  report.cut_figures.contours = 1;
  report.cut_figures.near_end[0].value = 0.5;
  report.cut_figures.near_end[4].value = 0.25;
  const v1::RunReport message = ToProto(kFiveAxes, report, {});
  EXPECT_TRUE(message.has_shortfall());
  ASSERT_EQ(message.cut().near_ends_size(), 2);
  EXPECT_EQ(message.cut().near_ends(0).axis(), "X");
  EXPECT_EQ(message.cut().near_ends(0).depth(), 0.5);
  EXPECT_FALSE(message.cut().near_ends(0).rotary());
  EXPECT_EQ(message.cut().near_ends(1).axis(), "B");
  EXPECT_TRUE(message.cut().near_ends(1).rotary());
}

// A report says on which machine it was: all of it, and once.
TEST(FirstOfAll, AReportHasItsMachine) {
  simulation::RunReport report;
  report.machine.profile = "srm-20";
  report.machine.named = true;
  report.machine.changed_by = "mine.toml";
  report.machine.own_name = "the small one";
  report.machine.changes.push_back(
      {.name = "VMAX", .value = "20", .of_profile = "15", .source = "measured"});
  v1::RunReport message = ToProto(kFiveAxes, report, {});
  EXPECT_EQ(message.profile(), "srm-20");
  SetMachine(report.machine, message);
  EXPECT_EQ(message.profile(), "srm-20");
  EXPECT_TRUE(message.profile_named());
  EXPECT_EQ(message.profile_changed_by(), "mine.toml");
  EXPECT_EQ(message.machine_name(), "the small one");
  ASSERT_EQ(message.profile_changes_size(), 1);
  EXPECT_EQ(message.profile_changes(0).name(), "VMAX");
  EXPECT_EQ(message.profile_changes(0).value(), "20");
  EXPECT_EQ(message.profile_changes(0).of_profile(), "15");
  EXPECT_EQ(message.profile_changes(0).source(), "measured");
}

// Where the tip stands in the frame of the work: from its origin.
TEST(FirstOfAll, TheTipIsToldFromTheOriginOfTheWork) {
  machine::RunState state;
  state.tip.tip = motion::MachinePoint(10.0, 20.0, 30.0);
  state.work_origin = motion::MachinePoint(1.0, 2.0, 4.0);
  const v1::JobProgress progress = ToProto(kFiveAxes, state, 5);
  EXPECT_EQ(progress.work_tip().x(), 9.0);
  EXPECT_EQ(progress.work_tip().y(), 18.0);
  EXPECT_EQ(progress.work_tip().z(), 26.0);
}

// RunReport.work_origin: where it is known, and nothing where it is not.
TEST(FirstOfAll, AReportHasTheOriginOfItsWork) {
  simulation::RunReport report;
  EXPECT_FALSE(ToProto(kFiveAxes, report, {}).has_work_origin());
  report.work_origin = motion::MachinePoint(1.0, 2.0, 4.0);
  const v1::RunReport message = ToProto(kFiveAxes, report, {});
  EXPECT_EQ(message.work_origin().x(), 1.0);
  EXPECT_EQ(message.work_origin().y(), 2.0);
  EXPECT_EQ(message.work_origin().z(), 4.0);
}

// Above 0, up to the most, which belongs to it.
TEST(FirstOfAll, ASmallOverrideIsOne) {
  EXPECT_TRUE(CheckOverride(0.5, 100.0));
  EXPECT_TRUE(CheckOverride(1.0, 100.0));
  EXPECT_TRUE(CheckOverride(100.0, 100.0));
  EXPECT_FALSE(CheckOverride(0.0, 100.0));
  EXPECT_FALSE(CheckOverride(100.5, 100.0));
}

// A value may stand right behind its sign.
TEST(FirstOfAll, NoBlankIsNeededAroundAnEqualsSign) {
  v1::SimulationOptions options;
  ASSERT_TRUE(ParseInputFile("0.5 OVERRIDE=75\n1 IA[3]=2.5\n", "in.txt", 100.0, options));
  ASSERT_EQ(options.inputs_size(), 2);
  EXPECT_EQ(options.inputs(0).input().override_percent(), 75.0);
  EXPECT_EQ(options.inputs(0).virtual_time_ns(), 500'000'000);
  const auto inputs = InputsOf(options);
  ASSERT_TRUE(inputs);
  EXPECT_EQ(inputs->at(1).index, 3);
  EXPECT_EQ(inputs->at(1).value, 2.5);
}

}  // namespace
}  // namespace rmlcell::bridge
