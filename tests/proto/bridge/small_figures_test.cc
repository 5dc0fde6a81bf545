// Figures between 0 and 1 and counts of one: what is little is told like what is much.
#include <gtest/gtest.h>

#include "proto/bridge/findings.h"
#include "proto/bridge/milling.h"
#include "proto/bridge/report.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/milling.pb.h"
#include "rmlcell/v1/report.pb.h"

namespace rmlcell::bridge {
namespace {

constexpr machine::FamilyInfo kSmallMill = {.axes = "X Y Z A B"};

// An axis that turns has limits in rad/s, which may be below 1.
TEST(SmallFigures, ASmallLimitHasItsShare) {
  simulation::RunReport report;
  report.tip_figures = {.name = "tip",
                        .peak_speed = 0.25,
                        .peak_acceleration = 0.125,
                        .speed_limit = 0.5,
                        .acceleration_limit = 0.625};
  const v1::RunReport message = ToProto(kSmallMill, report, {});
  EXPECT_DOUBLE_EQ(message.axes(0).peak_speed_share(), 0.5);
  EXPECT_DOUBLE_EQ(message.axes(0).peak_acceleration_share(), 0.2);
}

TEST(SmallFigures, ASmallDepthHasItsPlace) {
  simulation::RunReport report;
  report.milling = {.gouges = 1,
                    .gouge_place = {.program = 1, .step = 5},
                    .below_mm = 0.25,
                    .below_place = {.program = 2, .step = 6},
                    .deepest_pass_mm = 0.5,
                    .pass_place = {.program = 3, .step = 7},
                    .shank_depth_mm = 0.75,
                    .shank_place = {.program = 4, .step = 8}};
  const v1::MillingFigures milling = ToProto(kSmallMill, report, {}).milling();
  EXPECT_EQ(milling.gouge_place().program(), 1);
  EXPECT_EQ(milling.gouge_place().step(), 5);
  EXPECT_EQ(milling.below_place().program(), 2);
  EXPECT_EQ(milling.below_place().step(), 6);
  EXPECT_EQ(milling.pass_place().program(), 3);
  EXPECT_EQ(milling.pass_place().step(), 7);
  EXPECT_EQ(milling.shank_place().program(), 4);
  EXPECT_EQ(milling.shank_place().step(), 8);
}

TEST(SmallFigures, ASmallDeviationIsTold) {
  simulation::RunReport report;
  report.corners = {.deviation_mm_max = 0.125, .deviation_place = {.program = 2, .step = 3}};
  const v1::CornerFigures corners = ToProto(kSmallMill, report, {}).corners();
  EXPECT_EQ(corners.deviation_mm_max(), 0.125);
  EXPECT_EQ(corners.deviation_place().step(), 3);
}

// The first line of a text is a place, too.
TEST(SmallFigures, AFindingOfTheFirstLineIsToldOnce) {
  const Diagnostic first{.code = ErrorCode::kRml1Clipped,
                         .severity = Severity::kAdvice,
                         .where = {.line = 1, .column = 2}};
  const Diagnostic beside{.code = ErrorCode::kRml1Clipped,
                          .severity = Severity::kAdvice,
                          .where = {.line = 1, .column = 3}};
  v1::RunReport report;
  *report.add_diagnostics() = ToProto(first);
  AddFindingsOfText({first, beside}, {}, report);
  ASSERT_EQ(report.diagnostics_size(), 2);
  EXPECT_EQ(report.diagnostics(1).place().column(), 3);
}

TEST(SmallFigures, ABudgetOfOneIsOne) {
  v1::Budget budget;
  budget.set_steps(1);
  budget.set_virtual_time_ns(1);
  const auto run = RunOptionsOf({}, budget, 12, machine::Mode::kCycle);
  ASSERT_TRUE(run);
  EXPECT_EQ(run->budget.steps, 1U);
  EXPECT_EQ(run->budget.virtual_time, SimTime(1));
  budget.set_steps(2);
  budget.set_virtual_time_ns(3);
  const auto longer = RunOptionsOf({}, budget, 12, machine::Mode::kCycle);
  ASSERT_TRUE(longer);
  EXPECT_EQ(longer->budget.steps, 2U);
  EXPECT_EQ(longer->budget.virtual_time, SimTime(3));
}

// An engraver has one edge, which takes off all.
TEST(SmallFigures, AToolOfOneEdgeIsATool) {
  v1::Milling milling;
  v1::Stock& stock = *milling.mutable_stock();
  stock.set_size_x_mm(0.75);
  stock.set_size_y_mm(0.5);
  stock.set_size_z_mm(0.25);
  v1::MillTool& tool = *milling.mutable_tool();
  tool.set_shape(v1::MillTool::SHAPE_FLAT);
  tool.set_diameter_mm(0.5);
  tool.set_flutes(1);
  milling.set_material("wax");
  const auto made = FromProto(milling);
  ASSERT_TRUE(made) << made.error().detail;
  EXPECT_EQ(made->tool.flutes, 1);
  EXPECT_EQ(made->tool.radius_mm, 0.25);
  EXPECT_EQ(made->stock.x_max, 0.75);
  EXPECT_EQ(made->stock.bottom, -0.25);
  for (const double tolerance_mm : {0.5, 1000.0}) {  // the ends are allowed
    milling.set_stl_tolerance_mm(tolerance_mm);
    EXPECT_TRUE(FromProto(milling)) << tolerance_mm;
  }
  milling.set_stl_tolerance_mm(1000.5);
  EXPECT_FALSE(FromProto(milling));
}

}  // namespace
}  // namespace rmlcell::bridge
