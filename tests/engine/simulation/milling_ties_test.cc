// Which of two equal ones counts, and what nobody told, in the figures of a mill in a block.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "engine/simulation/material/milling_recorder.h"
#include "engine/simulation/material/target.h"
#include "engine/simulation/material/target_files.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/thread_for.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachinePoint;

// 20 x 12 mm and 5 mm thick, its top at Z 5; a tool of 3 mm with two edges.
Milling TiedBlock() {
  return {.stock = {.x_max = 20.0, .y_max = 12.0, .bottom = 0.0, .top = 5.0, .cell = 0.25},
          .tool = {.radius_mm = 1.5, .flutes = 2}};
}

class TiedMilling {
 public:
  explicit TiedMilling(const Milling& milling) : recorder_({}, milling) {}

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
  void Spindle(double rpm) {
    recorder_.OnSignal({.signal = machine::Signal::kSpindleSpeed, .value = rpm});
  }
  MillingFigures Figures() { return recorder_.Figures(); }

 private:
  MillingRecorder recorder_;
  int step_ = 0;
};

// docs/material.md: where nobody told how fast the spindle turns there is no chip, not one of
// nothing, which would be all too thin.
TEST(MillingTies, WithoutASpeedOfTheSpindleThereIsNoChip) {
  Milling milling = TiedBlock();
  milling.chips = ChipRange{
      .least_mm = 0.01, .most_mm = 0.05, .speed_most_m_min = 100.0, .plunge_most_mm = 0.02};
  TiedMilling mill(milling);
  mill.Go({2, 6, 4}, {18, 6, 4}, 8.0);
  mill.Go({10, 10, 9}, {10, 10, 4}, 8.0, MotionUse::kPlunge);
  const ChipFigures none = *mill.Figures().chips;
  EXPECT_EQ(none.plunge_percent, 0.0);
  EXPECT_EQ(none.thin_percent, 0.0);
  EXPECT_EQ(none.thick_percent, 0.0);
  EXPECT_EQ(none.speed_percent, 0.0);
  EXPECT_EQ(none.thin_place.step, 0);
  // However slowly it turns: 8 mm/s at half a turn a minute are 480 mm an edge.
  mill.Spindle(0.5);
  mill.Go({2, 2, 4}, {18, 2, 4}, 8.0);
  EXPECT_NEAR(mill.Figures().chips->thick_percent, 100.0 * 480.0 / 0.05, 1e-6);
}

// Where nobody knows how much is usual straight down, no plunge is too much of it.
TEST(MillingTies, APlungeIsNotJudgedByWhatNobodyKnows) {
  Milling milling = TiedBlock();
  milling.chips = ChipRange{.least_mm = 0.01, .most_mm = 0.05, .speed_most_m_min = 100.0};
  TiedMilling mill(milling);
  mill.Spindle(6000.0);
  mill.Go({10, 6, 9}, {10, 6, 4}, 8.0, MotionUse::kPlunge);
  EXPECT_EQ(mill.Figures().chips->plunge_percent, 0.0);
  EXPECT_EQ(mill.Figures().chips->plunge_place.step, 0);
}

// What the spindle does by hand the program does not know, however slow that is.
TEST(MillingTies, ASpeedByHandStays) {
  Milling milling = TiedBlock();
  milling.rpm = 0.5;
  milling.chips = ChipRange{
      .least_mm = 0.01, .most_mm = 0.05, .speed_most_m_min = 100.0, .plunge_most_mm = 0.02};
  TiedMilling mill(milling);
  mill.Spindle(6000.0);
  mill.Go({2, 2, 4}, {18, 2, 4}, 8.0);
  EXPECT_NEAR(mill.Figures().chips->thick_percent, 100.0 * 480.0 / 0.05, 1e-6);
}

// 8 mm/s at 6000 rpm and two edges: 0.04 mm an edge, 80 % of 0.05; the edge goes at 6000 pi 3 mm a
// minute. The same again at other places changes nothing, a thinner one is another figure.
TEST(MillingTies, TheFirstOfEqualChipsIsTold) {
  Milling milling = TiedBlock();
  milling.chips = ChipRange{
      .least_mm = 0.032, .most_mm = 0.05, .speed_most_m_min = 100.0, .plunge_most_mm = 0.16};
  TiedMilling mill(milling);
  mill.Spindle(6000.0);
  mill.Go({2, 2, 4}, {18, 2, 4}, 8.0);
  mill.Go({2, 9, 4}, {18, 9, 4}, 8.0);
  EXPECT_NEAR(mill.Figures().chips->thick_percent, 80.0, 1e-9);
  EXPECT_EQ(mill.Figures().chips->thick_place.step, 1);
  EXPECT_NEAR(mill.Figures().chips->speed_percent, 18.0 * 3.14159265358979, 1e-9);
  EXPECT_EQ(mill.Figures().chips->speed_place.step, 1);
  mill.Go({2, 2, 3}, {18, 2, 3}, 4.0);
  mill.Go({2, 9, 3}, {18, 9, 3}, 4.0);
  EXPECT_NEAR(mill.Figures().chips->thin_percent, 37.5, 1e-9);
  EXPECT_EQ(mill.Figures().chips->thin_place.step, 3);
  mill.Go({10, 2, 3}, {10, 2, 1}, 8.0, MotionUse::kPlunge);
  mill.Go({10, 9, 3}, {10, 9, 1}, 8.0, MotionUse::kPlunge);
  EXPECT_NEAR(mill.Figures().chips->plunge_percent, 25.0, 1e-9);
  EXPECT_EQ(mill.Figures().chips->plunge_place.step, 5);
  EXPECT_EQ(mill.Figures().chips->thick_place.step, 1);
}

// A shank as deep, a pass as deep, a gouge as deep as one before: that one is told.
TEST(MillingTies, TheFirstOfEqualDepthsIsTold) {
  Milling milling = TiedBlock();
  milling.tool.flute_mm = 1.0;
  milling.tool.shank_radius_mm = 2.5;
  TiedMilling mill(milling);
  mill.Go({2, 3, 3}, {18, 3, 3}, 8.0);
  mill.Go({2, 9, 3}, {18, 9, 3}, 8.0);
  const MillingFigures passes = mill.Figures();
  EXPECT_EQ(passes.shank_depth_mm, 1.0);
  EXPECT_EQ(passes.shank_place.step, 1);
  EXPECT_EQ(passes.deepest_pass_mm, 2.0);
  EXPECT_EQ(passes.pass_place.step, 1);
  EXPECT_EQ(passes.reach_mm, 2.0);
  EXPECT_EQ(passes.reach_place.step, 1);
  mill.Go({4, 3, 2}, {8, 3, 2}, 0.0, MotionUse::kTravel);
  mill.Go({4, 9, 2}, {8, 9, 2}, 0.0, MotionUse::kTravel);
  const MillingFigures gouges = mill.Figures();
  EXPECT_EQ(gouges.gouges, 2U);
  EXPECT_EQ(gouges.gouge_depth_mm, 1.0);
  EXPECT_EQ(gouges.gouge_place.step, 3);
}

// Outlines run on beyond an edge by the diameter: just as far is nothing, along that axis alone.
TEST(MillingTies, JustTheDiameterBesideIsRunningOn) {
  TiedMilling mill(TiedBlock());
  mill.Go({23, 6, 4}, {23, 30, 4}, 8.0);
  const MillingFigures figures = mill.Figures();
  EXPECT_EQ(figures.beside_mm, 15.0);
  EXPECT_EQ(figures.beside_y_high_mm, 18.0);
  EXPECT_EQ(figures.beside_x_high_mm, 0.0);
  mill.Go({-3, -15, 4}, {-3, -16, 4}, 8.0);
  EXPECT_EQ(mill.Figures().beside_y_low_mm, 16.0);
  EXPECT_EQ(mill.Figures().beside_x_low_mm, 0.0);
  EXPECT_EQ(mill.Figures().beside_mm, 16.0);
}

// The place is that of the first way beside the block, however short it was.
TEST(MillingTies, TheFirstWayBesideIsTold) {
  TiedMilling mill(TiedBlock());
  mill.Go({10, 6, 4}, {23.25, 6, 4}, 8.0);
  mill.Go({30, 6, 4}, {40, 6, 4}, 8.0);
  EXPECT_EQ(mill.Figures().beside_mm, 10.25);
  EXPECT_EQ(mill.Figures().beside_place.step, 1);
  TiedMilling below(TiedBlock());
  below.Go({10, 6, 4}, {10, 6, -0.25}, 8.0);
  below.Go({12, 6, 4}, {12, 6, -2.5}, 8.0);
  EXPECT_EQ(below.Figures().below_mm, 2.5);
  EXPECT_EQ(below.Figures().below_place.step, 1);
}

// motion.md 9: a wall may stand off by a cell. In the first row and column, too, which have no
// neighbour on that side but are their own.
TEST(MillingTies, TheFirstCellsOfATargetAreTheirOwnNeighbours) {
  constexpr Stock block{.x_min = 1.0,
                        .x_max = 6.0,
                        .y_min = -2.0,
                        .y_max = 2.0,
                        .bottom = -2.0,
                        .top = 0.0,
                        .cell = 0.5};
  for (const bool along_x : {false, true}) {
    HeightField field = HeightField::Of(block).value();
    std::vector<float> heights(80, -1.0f);
    for (std::size_t k = 0; k < 80; ++k) {
      if ((along_x ? k / 10 : k % 10) == 0) heights[k] = 0.0f;
    }
    // All but the first two: the second one is near enough to the first.
    for (double at = along_x ? 0.0 : 3.0; at < 6.0; at += 1.0) {
      if (along_x) {
        field.Cut({.radius_mm = 1.0}, {-9, at, -1}, {19, at, -1});
      } else {
        field.Cut({.radius_mm = 1.0}, {at, -9, -1}, {at, 9, -1});
      }
    }
    const TargetFigures figures = CompareWithTarget(
        field, {.heights = std::make_shared<const std::vector<float>>(std::move(heights))});
    EXPECT_EQ(figures.left_mm, 0.0) << along_x;
    EXPECT_EQ(figures.deep_mm, 0.0) << along_x;
    EXPECT_EQ(figures.good_percent, 100.0) << along_x;
  }
}

// The same depth again is none that is deeper, though from 0.1 mm down to -0.3 the last digit says
// so.
TEST(MillingTies, AReachThatComesAgainIsTheFirst) {
  Milling milling = TiedBlock();
  milling.stock.bottom = -5.0;
  milling.stock.top = 0.0;
  TiedMilling mill(milling);
  mill.Go({2, 6, -0.3}, {18, 6, -0.3}, 8.0);
  mill.Go({10, 9, 0.1}, {10, 9, -0.3}, 8.0, MotionUse::kPlunge);
  EXPECT_EQ(mill.Figures().reach_mm, 0.3);
  EXPECT_EQ(mill.Figures().reach_place.step, 1);
}

// One cell that is compared is all of what is compared.
TEST(MillingTies, ATargetOfOneCell) {
  constexpr Stock block{.x_max = 2.0, .y_max = 2.0, .bottom = -2.0, .top = 0.0, .cell = 1.0};
  const float none = std::numeric_limits<float>::quiet_NaN();
  const HeightField field = HeightField::Of(block).value();
  const auto good = [&](float height) {
    const std::vector<float> heights{none, none, height, none};
    return CompareWithTarget(field,
                             {.heights = std::make_shared<const std::vector<float>>(heights)})
        .good_percent;
  };
  EXPECT_EQ(good(0.0f), 100.0);
  EXPECT_EQ(good(-1.0f), 0.0);
}

// With several threads the moves wait for each other, and each counts, the first one, too.
TEST(MillingTies, AMoveAloneCountsInManyThreads) {
  ThreadFor threads(3);
  MillingRecorder recorder({}, TiedBlock(), &threads);
  motion::PlannedMotion planned;
  planned.path = LineFrom({2, 6, 3}, {18, 6, 3});
  recorder.OnMotion({.place = {.program = 1, .step = 7},
                     .use = MotionUse::kCut,
                     .motion = &planned,
                     .travelled = planned.path.length(),
                     .programmed_mm_s = 8.0});
  EXPECT_EQ(recorder.Figures().deepest_pass_mm, 2.0);
  EXPECT_EQ(recorder.Figures().pass_place.step, 7);
}

// On the way down a shank as wide as its tool follows it; on the way up it comes first to what the
// tool has not cut. Down by a quarter of the way through a block of 10 mm, over whose last column
// the tool stands 8.125 mm behind the lower end: there the shank is sqrt(1.5^2 - 0.125^2) mm early,
// whoever cuts.
TEST(MillingTies, AShankIsToldByTheWayItGoes) {
  Milling milling = TiedBlock();
  milling.stock.x_max = 10.0;
  milling.tool.flute_mm = 2.0;
  milling.tool.shank_radius_mm = 1.5;
  ThreadFor threads(3);
  const auto shank = [&](const MachinePoint& from, const MachinePoint& to, ParallelFor* parallel) {
    MillingRecorder recorder({}, milling, parallel);
    motion::PlannedMotion planned;
    planned.path = LineFrom(from, to);
    recorder.OnMotion({.use = MotionUse::kCut,
                       .motion = &planned,
                       .travelled = planned.path.length(),
                       .programmed_mm_s = 8.0});
    return recorder.Figures().shank_depth_mm;
  };
  const MachinePoint high{2, 6, 5}, low{18, 6, 1};
  const double early = std::sqrt(1.5 * 1.5 - 0.125 * 0.125);
  for (ParallelFor* parallel :
       {static_cast<ParallelFor*>(nullptr), static_cast<ParallelFor*>(&threads)}) {
    EXPECT_EQ(shank(high, low, parallel), 0.0);
    EXPECT_NEAR(shank(low, high, parallel), 2.0 - 0.25 * (8.125 - early), 1e-5);
  }
}

// Nobody wants it any more: that is asked before the first triangle, however few there are.
TEST(MillingTies, ATargetNobodyWantsIsGivenUpAtOnce) {
  const Stock stock{.x_max = 4.0, .y_max = 4.0, .bottom = -1.0, .top = 0.0, .cell = 1.0};
  const std::vector<StlTriangle> body(
      1, StlTriangle{{{{0.0f, 0.0f, 0.0f}, {4.0f, 0.0f, 0.0f}, {0.0f, 4.0f, 0.0f}}}});
  const auto given_up = TargetOfBody(body, stock, [] { return false; });
  ASSERT_FALSE(given_up);
  EXPECT_EQ(given_up.error().code, ErrorCode::kCellCancelled);
  EXPECT_TRUE(TargetOfBody(body, stock, [] { return true; }));
}

}  // namespace
}  // namespace rmlcell::simulation
