#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/material/milled_part.h"
#include "engine/simulation/material/milling_recorder.h"
#include "engine/simulation/material/milling_text.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/thread_for.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachineVector;
using motion::PathPiece;

machine::MachineShape MillShape() {
  machine::MachineShape shape;
  shape.has_work_origin = true;
  shape.work_origin = {100.0, 50.0, -20.0};
  return shape;
}

const Milling kSlot{
    .stock = {.x_max = 20.0, .y_max = 12.0, .bottom = -5.0, .top = 0.0, .cell = 0.05},
    .tool = {.shape = MillTool::Shape::kFlat, .radius_mm = 1.5}};

// A straight motion in work coordinates; a feed rate of 0 is travel.
void Tell(MillingRecorder& recorder, const motion::MachinePoint& from,
          const motion::MachinePoint& to, double feed_mm_s, int step) {
  const motion::MachinePoint origin = MillShape().work_origin;
  motion::PlannedMotion planned;
  planned.path = PathPiece::Line({from + origin}, {to + origin});
  recorder.OnMotion({.start = std::chrono::seconds(step),
                     .end = std::chrono::seconds(step + 1),
                     .place = {.program = 7, .step = step},
                     .motion = &planned,
                     .travelled = planned.path.length(),
                     .programmed_mm_s = feed_mm_s});
}

// motion.md 8.2: removed volume. A slot of 10 mm, 3 mm wide and 2 mm deep with round ends.
TEST(MillingRecorder, TakesOffWhatTheToolSweeps) {
  ASSERT_TRUE(CheckMilling(kSlot));
  MillingRecorder recorder(MillShape(), kSlot);
  Tell(recorder, {0, 0, 5}, {5, 6, 5}, 0.0, 1);
  Tell(recorder, {5, 6, 5}, {5, 6, -2}, 2.0, 2);
  Tell(recorder, {5, 6, -2}, {15, 6, -2}, 8.0, 3);
  EXPECT_NEAR(recorder.Figures().removed_mm3, 2.0 * (30.0 + kPi * 2.25), 0.3);
  EXPECT_EQ(recorder.Figures().gouges, 0u);
}

// Motions wait to be cut together, and what is told of them is the same, of each at its place.
TEST(MillingRecorder, TellsTheSameWithThreads) {
  Milling milling = kSlot;
  milling.tool.flutes = 2;
  milling.tool.flute_mm = 1.0;
  milling.tool.shank_radius_mm = 2.0;
  milling.chips = ChipsOf("wax", 3.0).value();
  ThreadFor threads(2);
  MillingRecorder alone(MillShape(), milling);
  MillingRecorder together(MillShape(), milling, &threads);
  for (MillingRecorder* recorder : {&alone, &together}) {
    for (int k = 0; k < 300; ++k) {
      recorder->OnSignal({.signal = machine::Signal::kSpindleSpeed, .value = 6000.0 + 10.0 * k});
      const double y = 1.0 + 0.03 * k;
      const double z = -1.0 - 0.5 * std::sin(k);
      Tell(*recorder, {2, y, z}, {18, y + 1.0, z - 0.3}, k % 50 == 7 ? 0.0 : 8.0 + k % 3, k);
    }
  }
  EXPECT_TRUE(together.material().heights() == alone.material().heights());
  EXPECT_EQ(threads.most(), 2u);
  const MillingFigures one = alone.Figures();
  const MillingFigures two = together.Figures();
  EXPECT_GT(one.gouges, 1u);
  EXPECT_EQ(two.gouges, one.gouges);
  EXPECT_EQ(two.gouge_depth_mm, one.gouge_depth_mm);
  EXPECT_EQ(two.gouge_place, one.gouge_place);
  EXPECT_EQ(two.gouge_at, one.gouge_at);
  EXPECT_GT(one.shank_depth_mm, 0.0);
  EXPECT_EQ(two.shank_depth_mm, one.shank_depth_mm);
  EXPECT_EQ(two.shank_place, one.shank_place);
  EXPECT_EQ(two.deepest_pass_mm, one.deepest_pass_mm);
  EXPECT_EQ(two.pass_place, one.pass_place);
  EXPECT_EQ(two.removed_mm3, one.removed_mm3);
  EXPECT_EQ(two.remaining_mm3, one.remaining_mm3);
  EXPECT_GT(one.chips->thick_percent, 0.0);
  EXPECT_EQ(two.chips->thick_percent, one.chips->thick_percent);
  EXPECT_EQ(two.chips->thick_place, one.chips->thick_place);
  EXPECT_EQ(two.chips->speed_percent, one.chips->speed_percent);
  EXPECT_EQ(two.chips->speed_place, one.chips->speed_place);
}

// motion.md 9: travel below the surface is a gouge, with step and depth; through a slot it is none.
TEST(MillingRecorder, TellsTravelThroughMaterial) {
  MillingRecorder recorder(MillShape(), kSlot);
  Tell(recorder, {5, 6, -2}, {15, 6, -2}, 8.0, 1);
  Tell(recorder, {15, 6, -2}, {5, 6, -2}, 0.0, 2);
  EXPECT_EQ(recorder.Figures().gouges, 0u);
  Tell(recorder, {5, 2, -0.5}, {15, 2, -0.5}, 0.0, 3);
  Tell(recorder, {5, 10, -1.25}, {15, 10, -1.25}, 0.0, 4);
  Tell(recorder, {5, 10, 1}, {15, 10, 1}, 0.0, 5);
  const MillingFigures figures = recorder.Figures();
  EXPECT_EQ(figures.gouges, 2u);
  EXPECT_NEAR(figures.gouge_depth_mm, 1.25, 1e-5);
  EXPECT_EQ(figures.gouge_place.step, 4);
  EXPECT_EQ(figures.gouge_at, std::chrono::seconds(4));
}

// The deepest gouge is kept with its place, wherever it comes; less than a micrometre is rounding.
TEST(MillingRecorder, KeepsTheDeepestGouge) {
  MillingRecorder recorder(MillShape(), kSlot);
  Tell(recorder, {5, 2, -0.0005}, {15, 2, -0.0005}, 0.0, 1);
  EXPECT_EQ(recorder.Figures().gouges, 0u);
  Tell(recorder, {5, 6, -1.5}, {15, 6, -1.5}, 0.0, 2);
  Tell(recorder, {5, 10, -0.5}, {15, 10, -0.5}, 0.0, 3);
  Tell(recorder, {5, 2, -0.002}, {15, 2, -0.002}, 0.0, 4);
  EXPECT_EQ(recorder.Figures().gouges, 3u);
  EXPECT_NEAR(recorder.Figures().gouge_depth_mm, 1.5, 1e-5);
  EXPECT_EQ(recorder.Figures().gouge_place.step, 2);
  EXPECT_EQ(recorder.Figures().gouge_place.program, 7);
}

// Only the part of a motion that was travelled takes material off.
TEST(MillingRecorder, TakesOffWhatWasTravelled) {
  MillingRecorder recorder(MillShape(), kSlot);
  motion::PlannedMotion planned;
  const motion::MachinePoint origin = MillShape().work_origin;
  planned.path =
      PathPiece::Line({MachineVector{2, 6, -2} + origin}, {MachineVector{18, 6, -2} + origin});
  recorder.OnMotion({.motion = &planned, .from = 3.0, .travelled = 13.0, .programmed_mm_s = 8.0});
  EXPECT_NEAR(recorder.Figures().removed_mm3, 2.0 * (30.0 + kPi * 2.25), 0.3);
}

TEST(MillingText, ReadsBlocks) {
  const Result<Stock> plain = ParseStock("100x80x10");
  ASSERT_TRUE(plain);
  EXPECT_EQ(*plain, (Stock{.x_max = 100.0, .y_max = 80.0, .bottom = -10.0}));
  const Result<Stock> placed = ParseStock("20x10x2.5@-5,-4,1");
  ASSERT_TRUE(placed);
  EXPECT_EQ(
      *placed,
      (Stock{
          .x_min = -5.0, .x_max = 15.0, .y_min = -4.0, .y_max = 6.0, .bottom = -1.5, .top = 1.0}));
  const Result<Stock> flat = ParseStock("20x10x2.5@-5,-4");
  ASSERT_TRUE(flat);
  EXPECT_EQ(*flat,
            (Stock{.x_min = -5.0, .x_max = 15.0, .y_min = -4.0, .y_max = 6.0, .bottom = -2.5}));
  for (const char* wrong :
       {"", "100x80", "100x80x10x2", "axbxc", "100x80x10@", "100x80x10@1", "1x1x1@1,2,3,4"})
    EXPECT_FALSE(ParseStock(wrong)) << wrong;
}

TEST(MillingText, ReadsTools) {
  const Result<MillTool> vee = ParseTool("vee:6:60:0.2");
  ASSERT_TRUE(vee);
  EXPECT_EQ(vee->shape, MillTool::Shape::kVee);
  EXPECT_DOUBLE_EQ(vee->radius_mm, 3.0);
  EXPECT_DOUBLE_EQ(vee->half_angle_rad, kPi / 6);
  EXPECT_DOUBLE_EQ(vee->tip_radius_mm, 0.1);
  const Result<MillTool> pointed = ParseTool("vee:6:60");
  ASSERT_TRUE(pointed);
  EXPECT_EQ(pointed->tip_radius_mm, 0.0);
  EXPECT_EQ(ParseTool("flat:3")->shape, MillTool::Shape::kFlat);
  EXPECT_EQ(ParseTool("ball:3")->shape, MillTool::Shape::kBall);
  EXPECT_EQ(ParseTool("flat:3")->radius_mm, 1.5);
  for (const char* wrong :
       {"", "flat", "flat:", "flat:0", "flat:-1", "flat:3:2", "vee:6", "vee:6:180", "drill:3"})
    EXPECT_FALSE(ParseTool(wrong)) << wrong;
  EXPECT_EQ(ParseTool("cone:6:60")->shape, MillTool::Shape::kVee);
  EXPECT_EQ(ParseTool("engrave:6:30:0.1")->tip_radius_mm, 0.05);
  EXPECT_EQ(ParseTool("end:3")->shape, MillTool::Shape::kFlat);
}

// What is above the cutting end follows by name, in any order.
TEST(MillingText, ReadsShanksAndHolders) {
  const Result<MillTool> tool = ParseTool("flat:3:flute=12:shank=6:holder=20@25");
  ASSERT_TRUE(tool);
  EXPECT_EQ(tool->radius_mm, 1.5);
  EXPECT_EQ(tool->flute_mm, 12.0);
  EXPECT_EQ(tool->shank_radius_mm, 3.0);
  EXPECT_EQ(tool->holder_radius_mm, 10.0);
  EXPECT_EQ(tool->holder_from_mm, 25.0);
  const Result<MillTool> vee = ParseTool("vee:6:90:0.2:holder=20@9:flute=4");
  ASSERT_TRUE(vee);
  EXPECT_EQ(vee->tip_radius_mm, 0.1);
  EXPECT_EQ(vee->flute_mm, 4.0);
  EXPECT_EQ(vee->holder_from_mm, 9.0);
  EXPECT_EQ(ParseTool("flat:3")->flute_mm, 0.0);
  EXPECT_TRUE(ParseTool("ball:3:flute=1.5"));  // as high as its end
  EXPECT_TRUE(ParseTool("flat:3:flute=5:holder=9@5"));
  EXPECT_EQ(ParseTool("flat:3:flutes=100")->flutes, 100);
  EXPECT_EQ(ParseTool("flat:3:flutes=1")->flutes, 1);
  const std::pair<const char*, const char*> refused[] = {
      {"flat:3:flute=2:flute=3", ": at 16, 'flute=3' gives flute again: write flat:3"},
      {"flat:3:flutes=2:holder=20@9:flutes=2", ": at 29, 'flutes=2' gives flutes again"},
      {"flatt:3", ": at 1, 'flatt' is no shape; did you mean flat?"},
      {"bal:3", "'bal' is no shape; did you mean ball?"},
      {"vea:6:60", "'vea' is no shape; did you mean vee?"},
      {"falt:3:flute=9", "'falt' is no shape; did you mean flat?"},
      {"ve:6:60", "'ve' is no shape; did you mean vee?"},
      {"fl:3", "'fl:3' is no tool: write"},
      {"flta:3", "'flta' is no shape; did you mean flat?"},
      {"falx:3", "'falx:3' is no tool: write"},
      {"drill:3", "'drill:3' is no tool: write"},
      {"x:3", "'x:3' is no tool: write"},
      {"flat:3:flute=9:shnk=6", ": at 16, 'shnk=6' is no part of a tool; did you mean shank?"},
      {"flat:3:fluets=2", "did you mean flutes?"},
      {"flat:3:lenght=4", ": at 8, 'lenght=4' is no part of a tool; did you mean flute=LENGTH?"},
      {"flat:3:teeth=4", "did you mean flutes=NUMBER?"},
      {"flat:3:flutes", "is no tool"},
      {"flat:3:flute=9:=6", ": at 16, '=6' is no part of a tool"},
      {"vee:6:60:0.2:1", "is no tool"},
      {"flat:3:flute=9:shank", ": at 16, 'shank' has no value"},
      {"flat:3:flutes=1.5", "at 8, 'flutes=1.5': write a whole number from 1 to 100"},
      {"flat:3:holder=20", "at 8, 'holder=20': write its width and where it begins, holder=20@25"},
      {"flat:3:flute=9:shank=0", "at 16, 'shank=0': write a number above 0"},
      {"flat:3:flute", "is no tool"},
      {"flat:3:flute=", "is no tool"},
      {"flat:3:flute=0", "is no tool"},
      {"flat:3:flute=long", "is no tool"},
      {"flat:3:neck=2", "is no tool"},
      {"flat:3:flute=5:2", "is no tool"},
      {"flute=5", "is no tool"},
      {"flat:flute=5", "is no tool"},
      {"flat:3:holder=20", "is no tool"},
      {"flat:3:holder=0@20", "is no tool"},
      {"flat:3:holder=20@20@20", "is no tool"},
      {"flat:3:shank=6", "say flute=LENGTH"},
      {"flat:3:flutes=1.5", "is no tool"},
      {"flat:3:flutes=0", "is no tool"},
      {"flat:3:flutes=101", "is no tool"},
      {"ball:3:flute=1.4", "its end alone is 1.5 mm high"},
      {"vee:6:90:flute=2.9", "its end alone is 3.0 mm high"},
      {"flat:3:flute=9:holder=20@8", "begins below the end of what cuts"},
      {"flat:3:holder=20@-1", "above 0 mm"}};
  for (const auto& [text, why] : refused) {
    const Result<MillTool> wrong = ParseTool(text);
    ASSERT_FALSE(wrong) << text;
    EXPECT_NE(wrong.error().detail.find(why), std::string::npos) << wrong.error().detail;
  }
}

// The most that one motion across takes off: not a plunge, not travel, not what was cut before; a
// ramp of 45 degrees is a pass, a steeper one none.
TEST(MillingRecorder, TellsTheDeepestPass) {
  MillingRecorder recorder(MillShape(), kSlot);
  Tell(recorder, {5, 6, 5}, {5, 6, -4}, 2.0, 1);
  Tell(recorder, {10, 9, 1}, {12, 9, -1.25}, 2.0, 2);
  Tell(recorder, {2, 2, -3}, {8, 2, -3}, 0.0, 3);
  EXPECT_EQ(recorder.Figures().deepest_pass_mm, 0.0);
  Tell(recorder, {15, 10, 0}, {16.5, 10, -1.5}, 2.0, 4);
  EXPECT_NEAR(recorder.Figures().deepest_pass_mm, 1.5, 1e-6);
  EXPECT_EQ(recorder.Figures().pass_place.step, 4);
  Tell(recorder, {5, 6, -2.5}, {12, 6, -2.5}, 2.0, 5);
  Tell(recorder, {5, 6, -4}, {12, 6, -4}, 2.0, 6);
  const MillingFigures figures = recorder.Figures();
  EXPECT_NEAR(figures.deepest_pass_mm, 2.5, 1e-6);
  EXPECT_EQ(figures.pass_place.step, 5);
  EXPECT_EQ(figures.tool_diameter_mm, 3.0);
  EXPECT_NEAR(figures.deepest_cut_mm, 4.0, 1e-6);
  EXPECT_NEAR(figures.remaining_mm3 + figures.removed_mm3, 20.0 * 12.0 * 5.0, 1e-6);
}

// A shank of 3 mm above 2 mm that cut, 3 mm deep: 1 mm of it in material, once.
TEST(MillingRecorder, TellsTheShankInMaterial) {
  Milling milling = kSlot;
  milling.tool = *ParseTool("flat:3:flute=2");
  MillingRecorder recorder(MillShape(), milling);
  Tell(recorder, {5, 6, 5}, {5, 6, -3}, 2.0, 1);
  EXPECT_EQ(recorder.Figures().shank_depth_mm, 0.0);
  Tell(recorder, {5, 6, -3}, {9, 6, -3}, 2.0, 2);
  Tell(recorder, {9, 6, -3}, {12, 6, -2.5}, 2.0, 3);
  EXPECT_NEAR(recorder.Figures().shank_depth_mm, 1.0, 1e-6);
  EXPECT_EQ(recorder.Figures().shank_place.step, 2);
}

// motion.md 9: the way down that takes off most at 80 % of the speed of Z or more is told with its
// speed and its place; of two that take off as much the first, and none that is slower or rises.
TEST(MillingRecorder, TellsTheFirstOfTheDeepestFastPlunges) {
  machine::MachineShape shape = MillShape();
  shape.limits.emplace();
  shape.limits->axes.speed.z() = 10.0;
  MillingRecorder recorder(shape, kSlot);
  Tell(recorder, {2, 2, 1}, {2, 2, -3}, 7.9, 1);
  EXPECT_EQ(recorder.Figures().fast_plunge_mm, 0.0);
  Tell(recorder, {8, 2, 1}, {8, 2, -1}, 10.0, 2);
  Tell(recorder, {14, 2, 1}, {14, 2, -2}, 9.0, 3);
  Tell(recorder, {2, 9, 1}, {2, 9, -2}, 10.0, 4);
  Tell(recorder, {8, 9, 1}, {8, 9, -1.5}, 10.0, 5);
  Tell(recorder, {14, 9, -2.5}, {14, 9, 1}, 10.0, 6);
  const MillingFigures figures = recorder.Figures();
  EXPECT_NEAR(figures.fast_plunge_mm, 2.0, 1e-6);
  EXPECT_EQ(figures.fast_plunge_mm_s, 9.0);
  EXPECT_EQ(figures.fast_plunge_place.step, 3);
}

// 80 % of 10 mm/s is fast, a little less is not.
TEST(MillingRecorder, EightyPercentOfTheSpeedOfZIsFast) {
  machine::MachineShape shape = MillShape();
  shape.limits.emplace();
  shape.limits->axes.speed.z() = 10.0;
  const auto fast = [&](double mm_s) {
    MillingRecorder recorder(shape, kSlot);
    Tell(recorder, {2, 2, 1}, {2, 2, -3}, mm_s, 1);
    return recorder.Figures().fast_plunge_mm;
  };
  EXPECT_NEAR(fast(8.0), 3.0, 1e-6);
  EXPECT_EQ(fast(7.999), 0.0);
}

// LIVE-6.07: what goes into a part by less than a micrometre goes along it.
TEST(MilledPart, LessThanAMicrometreIsNoDepth) {
  MilledPart part(kSlot);
  part.BeginAt({0, 0, 0}, {5, 6, 5});
  const auto depth = [&](double z) { return part.DepthOf({5, 6, z}, {9, 6, z}); };
  EXPECT_EQ(depth(0.5), 0.0);
  EXPECT_EQ(depth(-0.0005), 0.0);
  EXPECT_NEAR(depth(-0.002), 0.002, 1e-6);
}

// What is cut off before the end of its first motion cut from where it began, and what is cut off
// next from there on.
TEST(MilledPart, WhatIsCutOffCutsFromWhereItStood) {
  MilledPart part(kSlot);
  part.BeginAt({0, 0, 0}, {5, 6, 5});
  part.EndAt({5, 6, -2});
  EXPECT_EQ(part.DepthOf({5, 6, -2}, {5, 6, -2}), 0.0);
  EXPECT_NEAR(part.DepthOf({2.5, 3, -0.5}, {2.5, 3, -0.5}), 0.5, 1e-6);
  part.EndAt({5, 10, -2});
  EXPECT_EQ(part.DepthOf({5, 6, -2}, {5, 10, -2}), 0.0);
}

// For who looks on: the tiles in which something was taken off since, a radius beyond each end of
// the way, also of what waits to be cut; a way above the block is none.
TEST(MillingRecorder, TellsWhichTilesHaveChanged) {
  const Milling wide{
      .stock = {.x_max = 192.0, .y_max = 192.0, .bottom = -5.0, .top = 0.0, .cell = 1.0},
      .tool = {.shape = MillTool::Shape::kFlat, .radius_mm = 2.0}};
  using Tiles = std::vector<std::pair<std::size_t, std::size_t>>;  // column and row
  ThreadFor threads(2);
  for (ParallelFor* parallel :
       {static_cast<ParallelFor*>(nullptr), static_cast<ParallelFor*>(&threads)}) {
    const auto changed = [&](const motion::MachinePoint& from, const motion::MachinePoint& to) {
      MillingRecorder recorder(MillShape(), wide, parallel);
      EXPECT_TRUE(recorder.TakeChanges(100).empty());
      EXPECT_FALSE(recorder.any_change_left());
      Tell(recorder, from, to, 8.0, 1);
      Tiles tiles;
      for (const HeightTile& tile : recorder.TakeChanges(100))
        tiles.emplace_back(tile.column, tile.row);
      EXPECT_TRUE(recorder.TakeChanges(100).empty());
      return tiles;
    };
    // Tiles are 64 mm wide; 63 and 2 mm of radius are beyond the first one.
    EXPECT_EQ(changed({10, 10, -1}, {61, 10, -1}), (Tiles{{0, 0}}));
    EXPECT_EQ(changed({10, 10, -1}, {63, 10, -1}), (Tiles{{0, 0}, {64, 0}}));
    EXPECT_EQ(changed({110, 10, -1}, {65, 10, -1}), (Tiles{{0, 0}, {64, 0}}));
    EXPECT_EQ(changed({10, 10, -1}, {10, 63, -1}), (Tiles{{0, 0}, {0, 64}}));
    EXPECT_EQ(changed({10, 110, -1}, {10, 65, -1}), (Tiles{{0, 0}, {0, 64}}));
    EXPECT_EQ(changed({10, 10, 1}, {63, 63, 1}), Tiles{});
  }
}

// A way through what is gone already changes no tile.
TEST(MillingRecorder, AWayThroughAGrooveChangesNothing) {
  const Milling wide{
      .stock = {.x_max = 192.0, .y_max = 192.0, .bottom = -5.0, .top = 0.0, .cell = 1.0},
      .tool = {.shape = MillTool::Shape::kFlat, .radius_mm = 2.0}};
  MillingRecorder recorder(MillShape(), wide);
  EXPECT_TRUE(recorder.TakeChanges(100).empty());
  Tell(recorder, {10, 10, -1}, {50, 10, -1}, 8.0, 1);
  EXPECT_EQ(recorder.TakeChanges(100).size(), 1u);
  Tell(recorder, {50, 10, -1}, {10, 10, -1}, 8.0, 2);
  EXPECT_FALSE(recorder.any_change_left());
  EXPECT_TRUE(recorder.TakeChanges(100).empty());
}

// A turn of the rotary axis alone takes nothing off, wherever the tool stands.
TEST(MillingRecorder, ATurnOfTheRotaryAxisTakesNothingOff) {
  const motion::MachinePoint origin = MillShape().work_origin;
  const motion::MachinePoint inside = MachineVector{5, 6, -2} + origin;
  motion::PlannedMotion turn;
  turn.path = PathPiece::Line({inside, 0.0, 0.0}, {inside, 1.0, 0.0});
  ASSERT_EQ(turn.path.kind(), PathPiece::Kind::kRotary);
  motion::PlannedMotion plunge;
  plunge.path = PathPiece::Line({MachineVector{5, 6, 5} + origin}, {inside});
  MillingRecorder recorder(MillShape(), kSlot);
  MilledPart part(kSlot);
  part.BeginAt(origin, MachineVector{5, 6, 5} + origin);
  const auto tell = [&](const motion::PlannedMotion& planned) {
    const machine::MotionDone done{
        .motion = &planned, .travelled = planned.path.length(), .programmed_mm_s = 8.0};
    recorder.OnMotion(done);
    part.OnMotion(done);
  };
  tell(turn);
  EXPECT_EQ(recorder.Figures().removed_mm3, 0.0);
  EXPECT_NEAR(part.DepthOf(inside, inside), 2.0, 1e-6);
  tell(plunge);
  EXPECT_GT(recorder.Figures().removed_mm3, 13.0);  // 2 mm of a circle of 3 mm are 14.1 mm3
  EXPECT_EQ(part.DepthOf(inside, inside), 0.0);
}

// motion.md 9: what should be left is compared with what is left at any time.
TEST(MillingRecorder, ComparesWithItsTarget) {
  const HeightField::Size size = HeightField::SizeOf(kSlot.stock);
  const std::vector<float> untouched(size.columns * size.rows, 0.0f);
  Milling milling = kSlot;
  milling.target = Target{.heights = std::make_shared<const std::vector<float>>(untouched)};
  ASSERT_TRUE(CheckMilling(milling));
  MillingRecorder recorder(MillShape(), milling);
  ASSERT_TRUE(recorder.Figures().target);
  EXPECT_EQ(recorder.Figures().target->good_percent, 100.0);
  Tell(recorder, {5, 6, -2}, {15, 6, -2}, 8.0, 1);
  EXPECT_NEAR(recorder.Figures().target->deep_mm, 2.0, 1e-6);
  MillingRecorder without(MillShape(), kSlot);
  EXPECT_FALSE(without.Figures().target);
}

// Neither a tool nor a block that cannot be is milled with.
TEST(MillingRecorder, RefusesToolsAndBlocksThatCannotBe) {
  Milling milling = kSlot;
  milling.tool.radius_mm = 0.0;
  const Status tool = CheckMilling(milling);
  ASSERT_FALSE(tool);
  EXPECT_EQ(tool.error().code, ErrorCode::kCellInvalidArgument);
  milling = kSlot;
  milling.stock.bottom = 1.0;
  const Status block = CheckMilling(milling);
  ASSERT_FALSE(block);
  EXPECT_EQ(block.error().code, ErrorCode::kCellInvalidArgument);
}

}  // namespace
}  // namespace rmlcell::simulation
