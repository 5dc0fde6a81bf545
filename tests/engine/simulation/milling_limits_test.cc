// Where the figures of a mill in a block end: one side of each limit, and the other. motion.md 9.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "engine/simulation/material/milling_recorder.h"
#include "engine/simulation/material/milling_text.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachinePoint;

// 20 x 12 mm and 5 mm thick, its top at Z 5; a tool of 3 mm. Its frame is that of the machine.
Milling LimitBlock() {
  return {.stock = {.x_max = 20.0, .y_max = 12.0, .bottom = 0.0, .top = 5.0, .cell = 0.25},
          .tool = {.radius_mm = 1.5}};
}

// Motions of a mill, each of a step of its own; 0 is travel.
class MilledLimits : public testing::Test {
 protected:
  void Go(const MachinePoint& from, const MachinePoint& to, double mm_s,
          MotionUse use = MotionUse::kCut) {
    motion::PlannedMotion planned;
    planned.path = LineFrom(from, to);
    recorder_.OnMotion({.place = {.program = 1, .step = ++step_},
                        .use = use,
                        .motion = &planned,
                        .travelled = planned.path.length(),
                        .programmed_mm_s = mm_s});
  }
  MillingFigures Figures() { return recorder_.Figures(); }

  MillingRecorder recorder_{{}, LimitBlock()};
  int step_ = 0;
};

TEST_F(MilledLimits, NothingIsToldOfNothing) {
  MillingFigures nothing{
      .remaining_mm3 = 20.0 * 12.0 * 5.0, .tool_diameter_mm = 3.0, .cell_mm = 0.25};
  EXPECT_EQ(Figures(), nothing);
  Go({0, 0, 9}, {20, 12, 9}, 0.0, MotionUse::kTravel);
  Go({0, 0, 5}, {20, 12, 5}, 8.0);
  EXPECT_EQ(Figures(), nothing);
}

// With its middle over the block, the edges included, by the part of a way that is.
TEST_F(MilledLimits, ReachCountsOverTheBlock) {
  const auto reach = [&] { return Figures().reach_mm; };
  const MachinePoint outside[][2] = {{{20.01, 2, 1}, {20.01, 9, 1}}, {{-0.01, 2, 1}, {-0.01, 9, 1}},
                                     {{2, 12.01, 1}, {9, 12.01, 1}}, {{2, -0.01, 1}, {9, -0.01, 1}},
                                     {{21, 11.5, 1}, {19.5, 13, 1}}, {{25, 6, 1}, {21, 6, 1}},
                                     {{-25, 6, 1}, {-21, 6, 1}}};
  for (const auto& [from, to] : outside) Go(from, to, 8.0);
  EXPECT_EQ(reach(), 0.0);
  EXPECT_EQ(Figures().reach_width_mm, 0.0);
  Go({20, 2, 4.5}, {20, 9, 4.5}, 8.0);
  EXPECT_EQ(reach(), 0.5);
  EXPECT_EQ(Figures().reach_width_mm, 3.0);
  EXPECT_EQ(Figures().reach_place.step, 8);
  Go({0, 2, 4}, {0, 9, 4}, 8.0);
  EXPECT_EQ(reach(), 1.0);
  Go({2, 12, 3.5}, {9, 12, 3.5}, 8.0);
  EXPECT_EQ(reach(), 1.5);
  Go({2, 0, 3}, {9, 0, 3}, 8.0);
  EXPECT_EQ(reach(), 2.0);
  // Half of the way is over it, and there the tool is half as deep; so it is on the way back.
  Go({10, 6, 5}, {30, 6, 0}, 8.0);
  EXPECT_EQ(reach(), 2.5);
  EXPECT_EQ(Figures().reach_place.step, 12);
  Go({30, 6, 0}, {10, 6, 5}, 8.0);
  EXPECT_EQ(Figures().reach_place.step, 12);
  Go({6, 6, 5}, {6, 18, -1}, 8.0);
  EXPECT_EQ(reach(), 3.0);
  // At a corner, for a moment.
  Go({20, 12, 1.5}, {25, 15, 1.5}, 8.0);
  EXPECT_EQ(reach(), 3.5);
  EXPECT_EQ(Figures().reach_place.step, 15);
  Go({8, 6, 9}, {8, 6, 1}, 8.0);
  EXPECT_EQ(reach(), 4.0);
}

// A micrometre is rounding, and a tool beside the block by more than its radius may go anywhere.
TEST_F(MilledLimits, BelowTheBlock) {
  const auto down = [&](double x, double y, double z) { Go({x, y, 9}, {x, y, z}, 8.0); };
  down(5, 5, -0.001);
  down(21.51, 5, -9);
  down(-1.51, 5, -9);
  down(5, 13.51, -9);
  down(5, -1.51, -9);
  EXPECT_EQ(Figures().below_mm, 0.0);
  EXPECT_EQ(Figures().below_place.step, 0);
  down(21.5, 5, -0.25);
  EXPECT_EQ(Figures().below_mm, 0.25);
  down(-1.5, 5, -0.5);
  EXPECT_EQ(Figures().below_mm, 0.5);
  down(5, 13.5, -0.75);
  EXPECT_EQ(Figures().below_mm, 0.75);
  down(5, -1.5, -1);
  down(5, 5, -0.5);
  EXPECT_EQ(Figures().below_mm, 1.0);
  EXPECT_EQ(Figures().below_place.step, 6);  // where it did first
  // Through below it, from one side to the other.
  Go({-9, 5, -2}, {30, 5, -2}, 8.0);
  EXPECT_EQ(Figures().below_mm, 2.0);
}

// Work runs on beyond an edge by the diameter, 3 mm; what is further out lies beside the block, by
// the way that is lower than its top, and only of what cuts at a speed of its own.
TEST_F(MilledLimits, BesideTheBlock) {
  Go({5, 6, 4}, {23, 6, 4}, 8.0);
  Go({5, 6, 4}, {-3, 6, 4}, 8.0);
  Go({5, 6, 4}, {5, 15, 4}, 8.0);
  Go({5, 6, 4}, {5, -3, 4}, 8.0);
  Go({23, 0, 4}, {23, 12, 4}, 8.0);
  Go({30, 0, 5}, {40, 0, 5.5}, 8.0);                    // above
  Go({30, 0, 5}, {40, 0, 5}, 8.0);                      // along its top
  Go({30, 0, 4}, {40, 0, 4}, 0.0);                      // travel
  Go({30, 0, 4}, {40, 0, 4}, 8.0, MotionUse::kTravel);  // no work
  Go({30, 0, 4}, {30, 0, 9}, 8.0, MotionUse::kRetract);
  MillingFigures figures = Figures();
  EXPECT_EQ(figures.beside_mm, 0.0);
  EXPECT_EQ(figures.beside_place.step, 0);
  EXPECT_EQ(figures.beside_x_high_mm, 0.0);
  Go({21, 6, 4}, {28, 6, 4}, 8.0);
  figures = Figures();
  EXPECT_DOUBLE_EQ(figures.beside_mm, 5.0);
  EXPECT_EQ(figures.beside_place.step, 11);
  EXPECT_EQ(figures.beside_x_high_mm, 8.0);
  EXPECT_EQ(figures.beside_x_low_mm, 0.0);
  EXPECT_EQ(figures.beside_y_low_mm, 0.0);
  EXPECT_EQ(figures.beside_y_high_mm, 0.0);
  Go({-7, 6, 4}, {5, 6, 4}, 8.0);
  Go({5, 6, 4}, {5, 18, 4}, 8.0);
  Go({5, 6, 4}, {5, -8, 4}, 8.0);
  figures = Figures();
  EXPECT_DOUBLE_EQ(figures.beside_mm, 5.0 + 4.0 + 3.0 + 5.0);
  EXPECT_EQ(figures.beside_place.step, 11);
  EXPECT_EQ(figures.beside_x_low_mm, 7.0);
  EXPECT_EQ(figures.beside_y_high_mm, 6.0);
  EXPECT_EQ(figures.beside_y_low_mm, 8.0);
  // A plunge beside it from 4 mm above: 2 of 6 mm are lower than its top.
  Go({-9, 6, 9}, {-9, 6, 3}, 8.0, MotionUse::kPlunge);
  figures = Figures();
  EXPECT_DOUBLE_EQ(figures.beside_mm, 19.0);
  EXPECT_EQ(figures.beside_x_low_mm, 9.0);
  // Rising to above its top half way: 5 of 10 mm, with as much up.
  Go({30, 6, 4}, {40, 6, 6}, 8.0);
  figures = Figures();
  EXPECT_NEAR(figures.beside_mm, 19.0 + 0.5 * std::hypot(10.0, 2.0), 1e-12);
  EXPECT_EQ(figures.beside_x_high_mm, 15.0);
}

// Travel is a gouge from more than a micrometre on; the deepest one counts, the first of those.
TEST_F(MilledLimits, Gouges) {
  Go({5, 6, 4}, {15, 6, 4}, 0.0);
  Go({5, 10, 4}, {15, 10, 4}, 0.0);
  Go({5, 2, 4.25}, {15, 2, 4.25}, 0.0);
  const MillingFigures figures = Figures();
  EXPECT_EQ(figures.gouges, 3u);
  EXPECT_EQ(figures.gouge_depth_mm, 1.0);
  EXPECT_EQ(figures.gouge_place.step, 1);
  EXPECT_EQ(figures.deepest_pass_mm, 0.0);
  EXPECT_EQ(figures.pass_mm_s, 0.0);
}

// The fastest pass in material; above it, or in a groove that is there, a speed says nothing.
TEST_F(MilledLimits, TheFastestPass) {
  Go({5, 6, 4}, {15, 6, 4}, 8.0);
  Go({5, 6, 4}, {15, 6, 4}, 20.0);
  Go({5, 6, 9}, {15, 6, 9}, 30.0);
  EXPECT_EQ(Figures().pass_mm_s, 8.0);
  Go({5, 6, 3}, {15, 6, 3}, 7.0);
  EXPECT_EQ(Figures().pass_mm_s, 8.0);
  Go({5, 6, 2}, {15, 6, 2}, 9.0);
  EXPECT_EQ(Figures().pass_mm_s, 9.0);
  EXPECT_EQ(Figures().deepest_pass_mm, 1.0);
  EXPECT_EQ(Figures().pass_place.step, 1);  // of passes as deep the first
}

// A way of less than a millimetre is a way: from 22.5 to 23.25 mm a quarter lies further out than
// the diameter beside the edge at 20.
TEST_F(MilledLimits, AShortWayBesideTheBlockIsTold) {
  Go({22.5, 6, 4}, {23.25, 6, 4}, 8.0);
  EXPECT_NEAR(Figures().beside_mm, 0.25, 1e-12);
  EXPECT_EQ(Figures().beside_x_high_mm, 3.25);
}

// What turns the spindle: its speed, told while it stands or turns, and not one that was set by
// hand. Two edges at 6000 rpm and 10 mm/s take 0.05 mm each; nobody knows at 0 rpm.
TEST(MillingSpindle, ChipsGoByItsSpeed) {
  const auto thick = [](double by_hand, auto signals) {
    Milling milling = LimitBlock();
    milling.tool.flutes = 2;
    milling.chips = ChipRange{.least_mm = 0.01, .most_mm = 0.05, .speed_most_m_min = 100.0};
    milling.rpm = by_hand;
    MillingRecorder recorder({}, milling);
    signals(recorder);
    motion::PlannedMotion planned;
    planned.path = LineFrom({5, 6, 4}, {15, 6, 4});
    recorder.OnMotion(
        {.use = MotionUse::kCut, .motion = &planned, .travelled = 10.0, .programmed_mm_s = 10.0});
    return recorder.Figures().chips->thick_percent;
  };
  using machine::Signal;
  const auto turns = [](MillingRecorder& to, double on, double rpm) {
    to.OnSignal({.signal = Signal::kSpindle, .value = on, .detail = rpm});
  };
  EXPECT_EQ(thick(0.0, [](MillingRecorder&) {}), 0.0);
  EXPECT_NEAR(thick(6000.0, [](MillingRecorder&) {}), 100.0, 1e-9);
  EXPECT_NEAR(thick(0.0, [&](MillingRecorder& to) { turns(to, 1.0, 6000.0); }), 100.0, 1e-9);
  EXPECT_NEAR(thick(0.0,
                    [&](MillingRecorder& to) {
                      turns(to, 1.0, 6000.0);
                      turns(to, 0.0, 9000.0);
                    }),
              100.0, 1e-9);
  EXPECT_NEAR(thick(3000.0, [&](MillingRecorder& to) { turns(to, 1.0, 6000.0); }), 200.0, 1e-9);
  EXPECT_NEAR(thick(0.0,
                    [](MillingRecorder& to) {
                      to.OnSignal({.signal = Signal::kSpindleSpeed, .value = 3000.0});
                    }),
              200.0, 1e-9);
  EXPECT_EQ(thick(0.0,
                  [](MillingRecorder& to) {
                    to.OnSignal({.signal = Signal::kBeam, .value = 1.0, .detail = 6000.0});
                  }),
            0.0);
}

// Both sides of what can be.
TEST(MillingLimits, WhatIsChecked) {
  Milling milling = LimitBlock();
  EXPECT_TRUE(CheckMilling(milling));
  const auto refused = [&] {
    const Status status = CheckMilling(milling);
    return status ? std::string() : std::string(status.error().detail);
  };
  milling.rpm = -1.0;
  EXPECT_EQ(refused(), "a spindle speed is not below 0 rpm");
  milling.rpm = HUGE_VAL;
  EXPECT_EQ(refused(), "a spindle speed is not below 0 rpm");
  milling.rpm = 0.0;
  milling.chips = ChipRange{.least_mm = 0.01, .most_mm = 0.05, .speed_most_m_min = 100.0};
  EXPECT_EQ(refused(), "what an edge takes off needs the edges of the tool: flutes=2");
  milling.tool.flutes = 1;
  EXPECT_EQ(refused(), "");
  milling.target = Target{.heights = std::make_shared<const std::vector<float>>(80 * 48, 0.0f),
                          .tolerance_mm = 0.0};
  EXPECT_EQ(refused(), "");
  milling.target->tolerance_mm = HUGE_VAL;
  EXPECT_EQ(refused(), "the tolerance of a target is not below 0 mm");
  milling.target->tolerance_mm = 0.1;
  milling.target->heights = std::make_shared<const std::vector<float>>(80 * 47, 0.0f);
  EXPECT_EQ(refused(), "the target has other cells than the block");
  milling.tool.radius_mm = 0.0;
  EXPECT_EQ(refused(), "the radius of a tool is above 0 mm");
}

// How wide a tool is at a height, up to where it is as wide as its shaft, and how high that is.
TEST(MillTool, WidthsAndHeights) {
  const MillTool flat{.radius_mm = 1.5};
  EXPECT_EQ(ShapeHeight(flat), 0.0);
  EXPECT_EQ(WidthAt(flat, 0.0), 3.0);
  EXPECT_EQ(WidthAt(flat, 9.0), 3.0);
  const MillTool ball{.shape = MillTool::Shape::kBall, .radius_mm = 5.0};
  EXPECT_EQ(ShapeHeight(ball), 5.0);
  EXPECT_EQ(WidthAt(ball, 0.0), 0.0);
  EXPECT_EQ(WidthAt(ball, 1.0), 6.0);  // 3, 4, 5
  EXPECT_EQ(WidthAt(ball, 2.0), 8.0);
  EXPECT_EQ(WidthAt(ball, 5.0), 10.0);
  EXPECT_EQ(WidthAt(ball, 9.0), 10.0);
  const MillTool vee = *ParseTool("vee:6:90:1");
  EXPECT_NEAR(ShapeHeight(vee), 2.5, 1e-12);
  EXPECT_NEAR(WidthAt(vee, 0.0), 1.0, 1e-12);
  EXPECT_NEAR(WidthAt(vee, 1.0), 3.0, 1e-12);
  EXPECT_NEAR(WidthAt(vee, 9.0), 6.0, 1e-12);
}

// What is above the cutting end, at each limit.
TEST(MillTool, LimitsOfTheShank) {
  const auto refused = [](const MillTool& tool) {
    const Status status = CheckTool(tool);
    return status ? std::string() : std::string(status.error().detail);
  };
  for (double MillTool::*const measure : {&MillTool::flute_mm, &MillTool::shank_radius_mm,
                                          &MillTool::holder_radius_mm, &MillTool::holder_from_mm}) {
    for (const double wrong : {-0.001, HUGE_VAL}) {
      MillTool tool{.radius_mm = 1.5, .flute_mm = 5.0, .holder_from_mm = 9.0};
      tool.*measure = wrong;
      EXPECT_EQ(refused(tool), "measures of a tool are above 0 mm");
    }
  }
  const MillTool ball{.shape = MillTool::Shape::kBall, .radius_mm = 1.5, .flute_mm = 1.5};
  EXPECT_EQ(refused(ball), "");
  const MillTool short_ball{
      .shape = MillTool::Shape::kBall, .radius_mm = 1.5, .flute_mm = 1.4999999};
  EXPECT_EQ(refused(short_ball),
            "the tool cuts for 1.4999999 mm, and its end alone is 1.5 mm high: make flute longer");
  EXPECT_EQ(refused({.radius_mm = 1.5, .shank_radius_mm = 3.0}),
            "a shank begins where the tool ceases to cut: say flute=LENGTH, too");
  EXPECT_EQ(
      refused({.radius_mm = 1.5, .flute_mm = 5.0, .holder_radius_mm = 9.0, .holder_from_mm = 5.0}),
      "");
  EXPECT_EQ(
      refused(
          {.radius_mm = 1.5, .flute_mm = 5.0, .holder_radius_mm = 9.0, .holder_from_mm = 4.999}),
      "the holder begins below the end of what cuts");
  EXPECT_EQ(refused({.radius_mm = 1.5, .flute_mm = 5.0}), "");  // no holder, wherever it begins
}

// A cone of 60 degrees and 6 mm is 3 sqrt(3) mm high, and a holder may be as narrow as it likes.
TEST(MillTool, MeasuresAreToldInMicrometres) {
  const Result<MillTool> cone = ParseTool("vee:6:60:flute=5");
  ASSERT_FALSE(cone);
  EXPECT_EQ(std::string(cone.error().detail),
            "the tool cuts for 5 mm, and its end alone is 5.196 mm high: make flute longer");
  const Result<MillTool> held = ParseTool("flat:0.3:holder=1@25");
  ASSERT_TRUE(held);
  EXPECT_EQ(held->holder_radius_mm, 0.5);
}

}  // namespace
}  // namespace rmlcell::simulation
