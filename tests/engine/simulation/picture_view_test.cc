#include "engine/simulation/picture_view.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rmlcell::simulation {
namespace {

using motion::Vec3;

machine::Box BoxFrom(const Vec3& a, const Vec3& b) {
  machine::Box box;
  box.Add(a);
  box.Add(b);
  return box;
}

// Every frame is right-handed: right x up points to the eye.
TEST(PictureView, FramesAreRightHanded) {
  for (const PictureView view :
       {PictureView::kXY, PictureView::kXZ, PictureView::kYZ, PictureView::kDirection}) {
    for (const Vec3& direction : {Vec3{1, -1, 0.8}, Vec3{0, 0, 5}, Vec3{0, 0, -1}, Vec3{}}) {
      const ViewFrame frame = FrameOf(view, direction);
      EXPECT_NEAR(Distance(Cross(frame.right, frame.up), frame.towards_eye), 0.0, 1e-12);
      EXPECT_NEAR(Norm(frame.right), 1.0, 1e-12);
      EXPECT_NEAR(Norm(frame.up), 1.0, 1e-12);
    }
  }
}

// Z stays upright in the view from a direction.
TEST(PictureView, ObliqueViewKeepsZUpright) {
  const ViewFrame frame = FrameOf(PictureView::kDirection, {3, -2, 1});
  EXPECT_NEAR(Dot({0, 0, 1}, frame.right), 0.0, 1e-12);
  EXPECT_GT(Dot({0, 0, 1}, frame.up), 0.0);
}

// One view: the box fits and touches in one direction at least; its middle is in the middle.
TEST(PictureView, OneViewFits) {
  const machine::Box box = BoxFrom({0, 0, 0}, {100, 50, 10});
  const PanelLayout layout = LayOut({FrameOf(PictureView::kXY, {})}, box, {10, 20, 800, 0});
  ASSERT_EQ(layout.panels.size(), 1u);
  const Panel& panel = layout.panels[0];
  EXPECT_NEAR(panel.scale, std::min(800.0 / 100.0, panel.rect.height / 50.0), 1e-9);
  const ScreenPoint middle = panel.Project({50, 25, 0});
  EXPECT_NEAR(middle.x, 10 + 400.0, 1e-9);
  EXPECT_NEAR(middle.y, 20 + 0.5 * panel.rect.height, 1e-9);
  EXPECT_LT(panel.Project({50, 50, 0}).y, middle.y);  // Y goes up
}

// Several views: one scale, and the same X above each other, the same Z beside each other.
TEST(PictureView, ViewsAreInLine) {
  const machine::Box box = BoxFrom({-20, 0, 0}, {180, 90, 60});
  const PanelLayout layout =
      LayOut({FrameOf(PictureView::kXY, {}), FrameOf(PictureView::kDirection, {1, -1, 1}),
              FrameOf(PictureView::kXZ, {}), FrameOf(PictureView::kYZ, {})},
             box, {0, 0, 1000, 0});
  ASSERT_EQ(layout.panels.size(), 4u);
  const Panel& xy = layout.panels[0];
  const Panel& xz = layout.panels[2];
  const Panel& yz = layout.panels[3];
  EXPECT_EQ(xy.scale, xz.scale);
  EXPECT_EQ(xz.scale, yz.scale);
  const Vec3 point{33, 44, 55};
  EXPECT_NEAR(xy.Project(point).x, xz.Project(point).x, 1e-9);
  EXPECT_NEAR(xz.Project(point).y, yz.Project(point).y, 1e-9);
  for (const Panel& panel : layout.panels) {
    for (const Vec3& corner : {box.min, box.max}) {
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
  for (const Vec3& size : {Vec3{2, 1, 0}, Vec3{3000, 1500, 800}, Vec3{0, 0, 0}, Vec3{3000, 0, 0},
                           Vec3{0, 1e-6, 0}, Vec3{1e9, 1, 1}}) {
    PathSketch sketch({}, 100);
    motion::PlannedMotion planned;
    planned.path = motion::PathPiece::Line({{5, 5, 5}}, {Vec3{5, 5, 5} + size});
    sketch.Add({.motion = &planned, .travelled = planned.path.length()});
    const machine::Box box = BoxToShow(sketch, {});
    for (const std::vector<PictureView>& views :
         {std::vector{PictureView::kXY}, std::vector{PictureView::kXZ, PictureView::kYZ},
          std::vector{PictureView::kXY, PictureView::kDirection, PictureView::kXZ,
                      PictureView::kYZ}}) {
      std::vector<ViewFrame> frames;
      for (const PictureView view : views) frames.push_back(FrameOf(view, {1, -1, 1}));
      for (const Panel& panel : LayOut(frames, box, {0, 0, 1000, 0}).panels) {
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

}  // namespace
}  // namespace rmlcell::simulation
