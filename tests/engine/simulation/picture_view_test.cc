#include "engine/simulation/picture/picture_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/simulation/picture/picture_panel.h"

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;

machine::Box BoxBetween(const MachineVector& a, const MachineVector& b) {
  machine::Box box;
  box.Add(a);
  box.Add(b);
  return box;
}

// Every frame is right-handed: right x up points to the eye.
TEST(PictureView, FramesAreRightHanded) {
  for (const PictureView view :
       {PictureView::kXY, PictureView::kXZ, PictureView::kYZ, PictureView::kDirection}) {
    for (const MachineVector& direction : {MachineVector{1, -1, 0.8}, MachineVector{0, 0, 5},
                                           MachineVector{0, 0, -1}, MachineVector{}}) {
      const ViewFrame frame = FrameOf(view, direction);
      EXPECT_NEAR((frame.right.cross(frame.up) - frame.towards_eye).norm(), 0.0, 1e-12);
      EXPECT_NEAR(frame.right.norm(), 1.0, 1e-12);
      EXPECT_NEAR(frame.up.norm(), 1.0, 1e-12);
    }
  }
}

// Z stays upright in the view from a direction.
TEST(PictureView, ObliqueViewKeepsZUpright) {
  const ViewFrame frame = FrameOf(PictureView::kDirection, {3, -2, 1});
  EXPECT_NEAR(frame.right.z(), 0.0, 1e-12);
  EXPECT_GT(frame.up.z(), 0.0);
}

// One view: the box fits and touches in one direction at least; its middle is in the middle.
TEST(PictureView, OneViewFits) {
  const machine::Box box = BoxBetween({0, 0, 0}, {100, 50, 10});
  const PanelLayout layout = LayOut({FrameOf(PictureView::kXY, {})}, box, {10, 20, 800});
  ASSERT_EQ(layout.panels.size(), 1u);
  const Panel& panel = layout.panels[0];
  EXPECT_NEAR(panel.scale, std::min(800.0 / 100.0, panel.rect.height / 50.0), 1e-9);
  const ScreenPoint middle = panel.Project({50, 25, 0});
  EXPECT_NEAR(middle.x, 10 + 400.0, 1e-9);
  EXPECT_NEAR(middle.y, 20 + 0.5 * panel.rect.height, 1e-9);
  EXPECT_LT(panel.Project({50, 50, 0}).y, middle.y);  // Y goes up
}

// Both limits of the height of a view: twice 230 px, and 900.
TEST(PictureView, OneViewIsNeitherFlatNorEndless) {
  const auto height = [](double y) {
    const PanelLayout layout =
        LayOut({FrameOf(PictureView::kXY, {})}, BoxBetween({0, 0, 0}, {100, y, 1}), {10, 20, 800});
    EXPECT_EQ(layout.height, layout.panels[0].rect.height);
    return layout.height;
  };
  EXPECT_NEAR(height(1.0), 460.0, 1e-9);
  EXPECT_NEAR(height(60.0), 480.0, 1e-9);
  EXPECT_NEAR(height(112.0), 896.0, 1e-9);
  EXPECT_NEAR(height(500.0), 900.0, 1e-9);
}

// 1000 px less the gap of 64 are shared by need, but a column or row has 230 px at least, and a row
// 648 at most (0.72 of 900); a view that is all but a line counts as 4 % of the largest.
TEST(PictureView, RoomIsSharedByNeed) {
  const std::vector<ViewFrame> four = {
      FrameOf(PictureView::kXY, {}), FrameOf(PictureView::kDirection, {1, -1, 1}),
      FrameOf(PictureView::kXZ, {}), FrameOf(PictureView::kYZ, {})};
  const auto expect = [](const ScreenRect& rect, double x, double y, double width, double height) {
    EXPECT_NEAR(rect.x, x, 1e-9);
    EXPECT_NEAR(rect.y, y, 1e-9);
    EXPECT_NEAR(rect.width, width, 1e-9);
    EXPECT_NEAR(rect.height, height, 1e-9);
  };
  // X takes 1000 of 1001 mm, so 706 of 936 px: 0.706 px a mm, and all rows are below 230 px.
  const PanelLayout flat = LayOut(four, BoxBetween({0, 0, 0}, {1000, 1, 1}), {5, 7, 1000});
  ASSERT_EQ(flat.panels.size(), 4u);
  expect(flat.panels[0].rect, 5, 7, 706, 230);
  expect(flat.panels[1].rect, 5 + 770, 7, 230, 230);
  expect(flat.panels[2].rect, 5, 7 + 294, 706, 230);
  expect(flat.panels[3].rect, 5 + 770, 7 + 294, 230, 230);
  EXPECT_NEAR(flat.height, 524.0, 1e-9);
  EXPECT_NEAR(flat.panels[0].scale, 0.706, 1e-12);
  EXPECT_NEAR(flat.panels[3].scale, 0.706, 1e-12);
  // X and Y alike: 468 px each for 100 mm; 1000 mm of Z would be 4680 px, so Z decides the scale.
  const PanelLayout tall =
      LayOut({four[2], four[3]}, BoxBetween({0, 0, 0}, {100, 100, 1000}), {0, 0, 1000});
  expect(tall.panels[0].rect, 0, 0, 468, 648);
  expect(tall.panels[1].rect, 532, 0, 468, 648);
  EXPECT_NEAR(tall.height, 648.0, 1e-9);
  EXPECT_NEAR(tall.panels[0].scale, 0.648, 1e-12);
  // 300 and 100 mm beside each other: 702 and 234 px, 2.34 px a mm, and so for 100 and 150 mm
  // above.
  const PanelLayout usual = LayOut(four, BoxBetween({0, 0, 0}, {300, 100, 150}), {0, 0, 1000});
  expect(usual.panels[1].rect, 766, 0, 234, 234);
  expect(usual.panels[2].rect, 0, 298, 702, 351);
  EXPECT_NEAR(usual.height, 234.0 + 64.0 + 351.0, 1e-9);
  EXPECT_NEAR(usual.panels[0].scale, 2.34, 1e-12);
  const PanelLayout three =
      LayOut({four[0], four[1], four[2]}, BoxBetween({0, 0, 0}, {300, 100, 150}), {0, 0, 1000});
  // No axial view on the right: 12 mm, 4 % of 300, so it has 230 px and 300 mm the other 706.
  EXPECT_NEAR(three.height, 706.0 / 300.0 * (100.0 + 150.0) + 64.0, 1e-9);
  // Views in space alone are squares.
  const PanelLayout space =
      LayOut({four[1], four[1]}, BoxBetween({0, 0, 0}, {300, 100, 150}), {0, 0, 1000});
  expect(space.panels[0].rect, 0, 0, 468, 468);
  expect(space.panels[1].rect, 532, 0, 468, 468);
}

// What is shown: the whole path, or the cuts where that is more than 1.8 times as large; 6 % of the
// largest side around it. Without a path the travel, without that a point of 0.05 mm.
TEST(PictureView, WhatIsShown) {
  const auto expect = [](const machine::Box& box, const motion::MachinePoint& low,
                         const motion::MachinePoint& high) {
    EXPECT_NEAR((box.min - low).norm(), 0.0, 1e-9);
    EXPECT_NEAR((box.max - high).norm(), 0.0, 1e-9);
  };
  const machine::Box cut = BoxBetween({0, 0, 0}, {100, 0, 0});
  expect(BoxToShow(BoxBetween({0, 0, 0}, {179, 0, 0}), cut, {}), {-10.74, -10.74, -10.74},
         {189.74, 10.74, 10.74});
  expect(BoxToShow(BoxBetween({0, 0, 0}, {180, 0, 0}), cut, {}), {-10.8, -10.8, -10.8},
         {190.8, 10.8, 10.8});
  expect(BoxToShow(BoxBetween({0, 0, 0}, {181, 0, 0}), cut, {}), {-6, -6, -6}, {106, 6, 6});
  expect(BoxToShow(BoxBetween({0, 0, 0}, {900, 50, 10}), {}, cut), {-54, -54, -54}, {954, 104, 64});
  expect(BoxToShow({}, {}, BoxBetween({0, 0, -20}, {100, 50, 0})), {-6, -6, -26}, {106, 56, 6});
  expect(BoxToShow({}, {}, {}), {-0.003, -0.003, -0.003}, {0.003, 0.003, 0.003});
}

// A column is as wide as the widest of its views: X and Y of 100 and 300 mm in the left one, below
// each other, and X in the right one share 936 px as 702 and 234.
TEST(PictureView, AColumnHasRoomForEachOfItsViews) {
  const PanelLayout layout = LayOut(
      {FrameOf(PictureView::kXY, {}), FrameOf(PictureView::kXZ, {}), FrameOf(PictureView::kYZ, {})},
      BoxBetween({0, 0, 0}, {100, 300, 50}), {0, 0, 1000});
  ASSERT_EQ(layout.panels.size(), 3u);
  EXPECT_NEAR(layout.panels[0].rect.width, 702.0, 1e-9);
  EXPECT_NEAR(layout.panels[1].rect.width, 234.0, 1e-9);
  EXPECT_NEAR(layout.panels[2].rect.width, 702.0, 1e-9);
  EXPECT_NEAR(layout.panels[0].rect.height, 648.0, 1e-9);  // 2.34 px a mm were 702
  EXPECT_NEAR(layout.panels[2].rect.height, 230.0, 1e-9);
}

// What was lost is followed to its end where no travel is known, and where nothing was cut that it
// could make a dot of.
TEST(PictureView, LostWaysAreShownWhole) {
  machine::Box travel;
  travel.Add(motion::MachinePoint{0, 0, 0});
  travel.Add(motion::MachinePoint{100, 80, 10});
  for (const bool cuts : {true, false}) {
    PathSketch sketch({}, 100);
    motion::PlannedMotion planned;
    planned.path = motion::PathPiece::Line({{0, 0, 0}}, {{100, 80, 0}});
    sketch.Add({.use = cuts ? machine::MotionUse::kCut : machine::MotionUse::kTravel,
                .motion = &planned,
                .travelled = planned.path.length()});
    sketch.AddLost({.from = {100, 80, 0}, .to = {5000, 80, 0}});
    const machine::Box shown = BoxToShow(sketch, cuts ? machine::Box{} : travel);
    // And 6 % of 5000 mm around it.
    EXPECT_NEAR((shown.min - motion::MachinePoint{-300, -300, -300}).norm(), 0.0, 1e-9) << cuts;
    EXPECT_NEAR((shown.max - motion::MachinePoint{5300, 380, 300}).norm(), 0.0, 1e-9) << cuts;
  }
}

// Four views at most; a mill is seen from above unless something else is asked for.
TEST(PictureView, WhichViews) {
  const auto titles = [](const std::vector<PictureView>& views, bool five_axis) {
    machine::MachineShape shape;
    shape.five_axis = five_axis;
    std::vector<std::string> found;
    for (const ViewFrame& frame : FramesOf({.views = views}, shape)) found.push_back(frame.title);
    return found;
  };
  using Titles = std::vector<std::string>;
  EXPECT_EQ(titles({}, false), (Titles{"XY from above"}));
  EXPECT_EQ(titles({}, true),
            (Titles{"XY from above", "in space", "XZ from the front", "YZ from the right"}));
  EXPECT_EQ(titles(std::vector<PictureView>(5, PictureView::kXZ), false).size(), 4u);
  EXPECT_EQ(titles({PictureView::kYZ}, true), (Titles{"YZ from the right"}));
}

// Several views: one scale, and the same X above each other, the same Z beside each other.
TEST(PictureView, ViewsAreInLine) {
  const machine::Box box = BoxBetween({-20, 0, 0}, {180, 90, 60});
  const PanelLayout layout =
      LayOut({FrameOf(PictureView::kXY, {}), FrameOf(PictureView::kDirection, {1, -1, 1}),
              FrameOf(PictureView::kXZ, {}), FrameOf(PictureView::kYZ, {})},
             box, {0, 0, 1000});
  ASSERT_EQ(layout.panels.size(), 4u);
  const Panel& xy = layout.panels[0];
  const Panel& xz = layout.panels[2];
  const Panel& yz = layout.panels[3];
  EXPECT_EQ(xy.scale, xz.scale);
  EXPECT_EQ(xz.scale, yz.scale);
  const motion::MachinePoint point{33, 44, 55};
  EXPECT_NEAR(xy.Project(point).x, xz.Project(point).x, 1e-9);
  EXPECT_NEAR(xz.Project(point).y, yz.Project(point).y, 1e-9);
  for (const Panel& panel : layout.panels) {
    for (const motion::MachinePoint& corner : {box.min, box.max}) {
      const ScreenPoint p = panel.Project(corner);
      EXPECT_GE(p.x, panel.rect.x - 1e-6);
      EXPECT_LE(p.x, panel.rect.x + panel.rect.width + 1e-6);
      EXPECT_GE(p.y, panel.rect.y - 1e-6);
      EXPECT_LE(p.y, panel.rect.y + panel.rect.height + 1e-6);
    }
    EXPECT_LE(panel.rect.x + panel.rect.width, 1000.0 + 1e-9);
    EXPECT_LE(panel.rect.y + panel.rect.height, layout.height + 1e-9);
  }
}

// From a part of 2 mm to one of 3 m, flat, thin or a point: always a scale that can be drawn.
TEST(PictureView, AnyExtentCanBeDrawn) {
  for (const MachineVector& size :
       {MachineVector{2, 1, 0}, MachineVector{3000, 1500, 800}, MachineVector{0, 0, 0},
        MachineVector{3000, 0, 0}, MachineVector{0, 1e-6, 0}, MachineVector{1e9, 1, 1}}) {
    PathSketch sketch({}, 100);
    motion::PlannedMotion planned;
    planned.path = motion::PathPiece::Line({{5, 5, 5}}, {MachineVector{5, 5, 5} + size});
    sketch.Add({.motion = &planned, .travelled = planned.path.length()});
    const machine::Box box = BoxToShow(sketch, {});
    for (const std::vector<PictureView>& views :
         {std::vector{PictureView::kXY}, std::vector{PictureView::kXZ, PictureView::kYZ},
          std::vector{PictureView::kXY, PictureView::kDirection, PictureView::kXZ,
                      PictureView::kYZ}}) {
      std::vector<ViewFrame> frames;
      for (const PictureView view : views) frames.push_back(FrameOf(view, {1, -1, 1}));
      for (const Panel& panel : LayOut(frames, box, {0, 0, 1000}).panels) {
        EXPECT_TRUE(std::isfinite(panel.scale) && panel.scale > 0.0);
        EXPECT_GE(panel.rect.width, 100.0);
        EXPECT_GE(panel.rect.height, 100.0);
        EXPECT_LE(panel.rect.height, 1000.0);
      }
    }
  }
}

TEST(NiceStep, OneTwoFive) {
  EXPECT_NEAR(NiceStep(0.9), 1.0, 1e-12);
  EXPECT_NEAR(NiceStep(1.1), 2.0, 1e-12);
  EXPECT_NEAR(NiceStep(2.0), 2.0, 1e-12);
  EXPECT_NEAR(NiceStep(3.0), 5.0, 1e-12);
  EXPECT_NEAR(NiceStep(51.0), 100.0, 1e-9);
  EXPECT_NEAR(NiceStep(0.0021), 0.005, 1e-12);
  EXPECT_EQ(NiceStep(0.0), 1.0);
  EXPECT_EQ(NiceStep(std::nan("")), 1.0);
}

TEST(TickText, AsManyDecimalsAsTheStepNeeds) {
  EXPECT_EQ(TickText(1150.0, 50.0), "1150");
  EXPECT_EQ(TickText(0.30000000000000004, 0.1), "0.3");
  EXPECT_EQ(TickText(-0.0, 0.05), "0.00");
}

// Marks of the rulers stand at whole steps, those at both edges too: 800 mm by 400 mm at 1 px/mm,
// with 78 px between two marks at least, has one every 100 mm.
TEST(PictureView, RulersReachBothEdges) {
  const Panel panel{.frame = FrameOf(PictureView::kXY, {}),
                    .rect = {.x = 60.0, .y = 40.0, .width = 800.0, .height = 400.0},
                    .middle_right = 400.0,
                    .middle_up = 200.0};
  std::string drawn;
  BeginPanel({}, panel, 1, drawn);
  for (const char* mark : {">0<", ">100<", ">400<", ">500<", ">800<"}) {
    EXPECT_NE(drawn.find(mark), std::string::npos) << mark;
  }
  EXPECT_NE(drawn.find(">400<"), drawn.rfind(">400<"));  // along both rulers
  EXPECT_EQ(drawn.find(">900<"), std::string::npos);
  EXPECT_EQ(drawn.find(">500<"), drawn.rfind(">500<"));
}

}  // namespace
}  // namespace rmlcell::simulation
