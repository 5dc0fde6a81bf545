#include "engine/simulation/picture/picture_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachineVector;

// A panel of 400 x 300 px about the point 0,0 of the page: a millimetre is a pixel, so (x, y, z) of
// the machine stands at (x, -y). What lies up to 20 px beyond its edges is drawn.
Panel FromAbove() {
  return {.frame = FrameOf(PictureView::kXY, {}), .rect = {-200, -150, 400, 300}};
}

struct DrawnPath {
  std::size_t count = 0;
  std::string text;

  std::string Group(std::size_t number) const {
    std::size_t begin = text.find("<g ");
    for (; number > 0; --number) begin = text.find("<g ", begin + 1);
    return text.substr(begin, text.find("</g>", begin) - begin);
  }
  // The data of all paths in a group, in their order.
  static std::string Data(const std::string& group) {
    std::string data;
    for (std::size_t at = group.find(" d=\""); at != std::string::npos;
         at = group.find(" d=\"", at + 1)) {
      data += group.substr(at + 4, group.find('"', at + 4) - at - 4);
    }
    return data;
  }
  std::string travel() const { return Data(Group(0)); }
  std::string cut() const { return Data(Group(1)); }
};

DrawnPath Draw(const std::vector<SketchElement>& elements,
               const std::vector<SketchCircle>& circles = {}, const Panel& panel = FromAbove(),
               std::size_t elements_max = 100'000, const DepthRange& depth = {}) {
  DrawnPath drawn;
  drawn.count =
      DrawPath({.elements = elements, .circles = circles}, panel, depth, elements_max, drawn.text);
  return drawn;
}

SketchElement Cut(const motion::MachinePoint& from, const motion::MachinePoint& to) {
  return {.from = from, .to = to, .use = MotionUse::kCut, .cuts = true};
}

SketchElement Travel(const motion::MachinePoint& from, const motion::MachinePoint& to,
                     MotionUse use = MotionUse::kTravel) {
  return {.from = from, .to = to, .use = use};
}

// The arc that begins at `spoke` from the centre and turns by `sweep` about `normal`.
DrawnPath DrawArc(const motion::MachinePoint& centre, const MachineVector& spoke,
                  const MachineVector& normal, double sweep, const Panel& panel = FromAbove()) {
  const auto at = [&](double angle) -> motion::MachinePoint {
    return centre + spoke * std::cos(angle) + normal.cross(spoke) * std::sin(angle);
  };
  SketchElement arc = Cut(at(0.0), at(sweep));
  arc.middle = at(0.5 * sweep);
  arc.arc = 0;
  return Draw({arc},
              {{.centre = centre, .normal = normal, .radius_mm = spoke.norm(), .sweep_rad = sweep}},
              panel);
}

// Lines are cut off 20 px beyond the panel: at x = -220 and 220, y = -170 and 170.
TEST(PicturePath, LinesAreCutOffOutOfSight) {
  EXPECT_EQ(Draw({Cut({-100, 20, 5}, {-50, -40, 7})}).cut(), "M-100-20l50 60");
  EXPECT_EQ(Draw({Cut({-500, 10, 0}, {500, 10, 0})}).cut(), "M-220-10l440 0");
  EXPECT_EQ(Draw({Cut({500, 10, 0}, {-500, 10, 0})}).cut(), "M220-10l-440 0");
  EXPECT_EQ(Draw({Cut({10, -500, 0}, {10, 500, 0})}).cut(), "M10 170l0-340");
  EXPECT_EQ(Draw({Cut({10, 500, 0}, {10, -500, 0})}).cut(), "M10-170l0 340");
  // One end inside; a slant that enters through one side and leaves through the next.
  EXPECT_EQ(Draw({Cut({0, 0, 0}, {440, 220, 0})}).cut(), "M0 0l220-110");
  EXPECT_EQ(Draw({Cut({-440, 220, 0}, {0, 0, 0})}).cut(), "M-220-110l220 110");
  EXPECT_EQ(Draw({Cut({-320, 0, 0}, {0, 320, 0})}).cut(), "M-220-100l70-70");
}

// However little they go across: half a pixel here, of which a half is out of sight.
TEST(PicturePath, SteepLinesAreCutOff) {
  EXPECT_EQ(Draw({Cut({219.75, 0, 0}, {220.25, 100, 0})}).cut(), "M219.75 0l.25-50");
  EXPECT_EQ(Draw({Cut({220.25, 100, 0}, {219.75, 0, 0})}).cut(), "M220-50l-.25 50");
  EXPECT_EQ(Draw({Cut({-219.75, 0, 0}, {-220.25, 100, 0})}).cut(), "M-219.75 0l-.25-50");
  EXPECT_EQ(Draw({Cut({-220.25, 100, 0}, {-219.75, 0, 0})}).cut(), "M-220-50l.25 50");
  EXPECT_EQ(Draw({Cut({0, 169.75, 0}, {100, 170.25, 0})}).cut(), "M0-169.75l50-.25");
  EXPECT_EQ(Draw({Cut({100, 170.25, 0}, {0, 169.75, 0})}).cut(), "M50-170l-50 .25");
  EXPECT_EQ(Draw({Cut({0, -169.75, 0}, {100, -170.25, 0})}).cut(), "M0 169.75l50 .25");
  EXPECT_EQ(Draw({Cut({100, -170.25, 0}, {0, -169.75, 0})}).cut(), "M50 170l-50-.25");
}

// What only touches the edge is drawn, what lies beyond it is not; along each edge, and at a
// corner.
TEST(PicturePath, TheEdgeBelongsToWhatIsDrawn) {
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(Draw({Cut({side * 220, 0, 0}, {side * 220, 50, 0})}).count, 1u);
    EXPECT_EQ(Draw({Cut({side * 220.25, 0, 0}, {side * 220.25, 50, 0})}).count, 0u);
    EXPECT_EQ(Draw({Cut({0, side * 170, 0}, {50, side * 170, 0})}).count, 1u);
    EXPECT_EQ(Draw({Cut({0, side * 170.25, 0}, {50, side * 170.25, 0})}).count, 0u);
    EXPECT_EQ(Draw({Cut({side * 200, 190, 0}, {side * 240, 150, 0})}).count, 1u);
    EXPECT_EQ(Draw({Cut({side * 200, 191, 0}, {side * 240, 151, 0})}).count, 0u);
  }
}

// Of circles, those that reach into the drawn area: 30 px each, at each edge.
TEST(PicturePath, CirclesOutOfSightAreLeftOut) {
  const auto count = [](double x, double y) {
    return DrawArc({x, y, 0}, {30, 0, 0}, {0, 0, 1}, kTurn).count;
  };
  for (const double side : {-1.0, 1.0}) {
    EXPECT_EQ(count(side * 250, 0), 1u);
    EXPECT_EQ(count(side * 250.25, 0), 0u);
    EXPECT_EQ(count(0, side * 200), 1u);
    EXPECT_EQ(count(0, side * 200.25), 0u);
  }
  // In pixels, not in millimetres.
  Panel twice = FromAbove();
  twice.scale = 2.0;
  EXPECT_EQ(DrawArc({139, 0, 0}, {30, 0, 0}, {0, 0, 1}, kTurn, twice).count, 1u);
  EXPECT_EQ(DrawArc({141, 0, 0}, {30, 0, 0}, {0, 0, 1}, kTurn, twice).count, 0u);
}

// A rapid move towards the eye is nothing; a drilled hole is a dot.
TEST(PicturePath, TowardsTheEyeOnlyCutsAreSeen) {
  EXPECT_EQ(Draw({Travel({5, 5, 0}, {5, 5, 9})}).count, 0u);
  EXPECT_EQ(Draw({Travel({5, 5, 0}, {5.04, 5, 9})}).count, 0u);
  EXPECT_EQ(Draw({Travel({5, 5, 0}, {5.06, 5, 9})}).count, 1u);
  EXPECT_EQ(Draw({Cut({5, 5, 0}, {5, 5, 9})}).cut(), "M5-5l0 0");
}

// Neighbours that stay within 0.05 px of a straight line are one; strokes in the same raster of
// 0.2 px are drawn once, in whichever direction.
TEST(PicturePath, WhatCannotBeToldApartIsDrawnOnce) {
  const auto bend = [](double off) {
    return Draw({Cut({0, 0, 0}, {10, 0, 0}), Cut({10, 0, 0}, {20, off, 0})}).count;
  };
  EXPECT_EQ(bend(0.04), 1u);
  EXPECT_EQ(bend(0.06), 2u);
  const auto beside = [](double apart) {
    return Draw({Cut({0, 0, 0}, {50, 0, 0}), Cut({50, apart, 0}, {0, apart, 0})}).count;
  };
  EXPECT_EQ(beside(0.09), 1u);
  EXPECT_EQ(beside(0.11), 2u);
}

// Too many elements: precision and raster get 1.6 times coarser at a time, until they fit.
TEST(PicturePath, TooManyElementsGetCoarserStepByStep) {
  // In a raster of 0.32 px the second line falls on the first; the third does at 0.82 px.
  const std::vector<SketchElement> beside = {Cut({0, 0, 0}, {50, 0, 0}),
                                             Cut({0, 0.15, 0}, {50, 0.15, 0}),
                                             Cut({0, 0.31, 0}, {50, 0.31, 0})};
  EXPECT_EQ(Draw(beside, {}, FromAbove(), 3).count, 3u);
  EXPECT_EQ(Draw(beside, {}, FromAbove(), 2).count, 2u);
  EXPECT_EQ(Draw(beside, {}, FromAbove(), 1).count, 1u);
  // Straight within 0.08 px is what follows the first, but not what follows the second.
  const std::vector<SketchElement> bent = {Cut({0, 0, 0}, {10, 0, 0}),
                                           Cut({10, 0, 0}, {20, 0.07, 0}),
                                           Cut({20, 0.07, 0}, {30, -0.1, 0})};
  EXPECT_EQ(Draw(bent, {}, FromAbove(), 3).count, 3u);
  EXPECT_EQ(Draw(bent, {}, FromAbove(), 2).count, 2u);
  EXPECT_EQ(Draw(bent, {}, FromAbove(), 1).count, 1u);
}

// An arc is an arc of the picture in pieces of at most 2.5 rad, so that its ends stay well apart.
// Counter-clockwise from +X, the page's Y goes down.
TEST(PicturePath, ArcsAreInPiecesThatAreNotTooLong) {
  const MachineVector spoke{100, 0, 0};
  const auto pieces = [&](double sweep) {
    const std::string data = DrawArc({}, spoke, {0, 0, 1}, sweep).cut();
    return std::count(data.begin(), data.end(), 'a');
  };
  EXPECT_EQ(pieces(2.4), 1);
  EXPECT_EQ(pieces(2.6), 2);
  EXPECT_EQ(pieces(5.1), 3);
  EXPECT_EQ(DrawArc({}, spoke, {0, 0, 1}, kPi / 2).cut(), "M100 0a100 100 0 0 0 -100-100");
  EXPECT_EQ(DrawArc({}, spoke, {0, 0, -1}, kPi / 2).cut(), "M100 0a100 100 0 0 1 -100 100");
  // Three thirds of a turn: at 120 degrees 50 px to the left of the centre and 86.6 above it.
  EXPECT_EQ(DrawArc({}, spoke, {0, 0, 1}, kTurn).cut(),
            "M100 0a100 100 0 0 0 -150-86.6a100 100 0 0 0 0 173.2a100 100 0 0 0 150-86.6");
}

// A circle whose normal leans by 60 degrees is half as high as wide; its long axis lies across the
// way that the normal leans to. From below it turns the other way.
TEST(PicturePath, LeaningCirclesAreEllipsesAcrossTheLean) {
  const double sine = std::sqrt(0.75);
  const auto data = [](const MachineVector& spoke, const MachineVector& normal) {
    return DrawArc({}, spoke, normal, 0.5).cut();
  };
  EXPECT_NE(data({100, 0, 0}, {0, sine, 0.5}).find("a100 50 0 0 0 "), std::string::npos);
  EXPECT_NE(data({0, 100, 0}, {sine, 0, 0.5}).find("a100 50 90 0 0 "), std::string::npos);
  const double slant = sine * std::sqrt(0.5);
  const MachineVector spoke{100 * std::sqrt(0.5), -100 * std::sqrt(0.5), 0};
  EXPECT_NE(data(spoke, {slant, slant, 0.5}).find("a100 50 45 0 0 "), std::string::npos);
  EXPECT_NE(data(spoke, {slant, slant, -0.5}).find("a100 50 45 0 1 "), std::string::npos);
  // A normal that is off by rounding does not lean.
  EXPECT_NE(data({100, 0, 0}, {1e-12, 0, 1}).find("a100 100 0 0 0 "), std::string::npos);
}

// A circle of less than 0.05 px in height is a line, an arc that bows by less than 0.02 px, too.
TEST(PicturePath, FlatArcsAreLines) {
  const auto is_arc = [](const DrawnPath& drawn) {
    return drawn.cut().find('a') != std::string::npos;
  };
  const auto leaning = [](double lean) {
    return DrawArc({}, {100, 0, 0}, {0, std::sqrt(1.0 - lean * lean), lean}, 2.0);
  };
  EXPECT_FALSE(is_arc(leaning(0.0004)));
  EXPECT_TRUE(is_arc(leaning(0.0006)));
  const auto bowing = [](double bow) {
    return DrawArc({}, {100, 0, 0}, {0, 0, 1}, 2.0 * std::acos(1.0 - bow / 100.0));
  };
  EXPECT_FALSE(is_arc(bowing(0.019)));
  EXPECT_TRUE(is_arc(bowing(0.021)));
}

// A circle seen from its edge is a line to and fro, as far as the circle reaches. About +Y from
// (30, 0, 40) x is 30 cos t + 40 sin t: 50 at the farthest.
TEST(PicturePath, CirclesFromTheirEdgeAreLinesToAndFro) {
  const auto data = [](const MachineVector& spoke, double sweep) {
    return DrawArc({}, spoke, {0, 1, 0}, sweep).cut();
  };
  EXPECT_EQ(data({30, 0, 40}, 0.9), "M30 0l" + std::string("19.98 0"));  // 30 cos 0.9 + 40 sin 0.9
  EXPECT_EQ(data({30, 0, 40}, kPi), "M30 0l20 0-80 0");
  EXPECT_EQ(data({30, 0, 40}, 1.5 * kPi), "M30 0l20 0-100 0 10 0");
  EXPECT_EQ(data({30, 0, 40}, kTurn), "M30 0l20 0-100 0 80 0");
  EXPECT_EQ(data({-30, 0, -40}, kPi), "M-30 0l-20 0 80 0");
  // Here its middle stands over the middle of its ends, and yet it reaches beyond them.
  EXPECT_EQ(data({40, 0, 30}, kPi + 2.0 * std::atan2(3.0, 4.0)), "M40 0l10 0-100 0 10 0");
}

// Cuts are as bold as half of the panel's area shared by their length, 0.35 to 2 px: here
// 0.5 * 120 000 px2. Travel does not count.
TEST(PicturePath, ManyCutsAreThin) {
  const auto width = [](int lines, double length) {
    std::vector<SketchElement> elements;
    for (int k = 0; k < lines; ++k) {
      const double y = -150.0 + 0.5 * k;
      elements.push_back(Cut({-150, y, 0}, {-150 + length, y, 0}));
      elements.push_back(Travel({-150 + length, y, 0}, {-150, y + 0.5, 0}));
    }
    const std::string group = Draw(elements).Group(1);
    const std::string name = "stroke-width=\"";
    const std::size_t at = group.find(name) + name.size();
    return group.substr(at, group.find('"', at) - at);
  };
  EXPECT_EQ(width(0, 0.0), "2");
  EXPECT_EQ(width(99, 300.0), "2");
  EXPECT_EQ(width(200, 300.0), "1");
  EXPECT_EQ(width(400, 300.0), ".5");
  EXPECT_EQ(width(600, 300.0), ".35");
}

// Travel is drawn below the cuts, whatever it is for, and looks the same.
TEST(PicturePath, TravelOfAnyUseIsOne) {
  const DrawnPath drawn =
      Draw({Cut({0, 0, 0}, {9, 0, 0}), Travel({9, 0, 0}, {20, 0, 0}, MotionUse::kRetract),
            Travel({20, 0, 0}, {30, 0, 0}), Cut({30, 0, 0}, {30, 8, 0})});
  EXPECT_EQ(drawn.count, 3u);
  EXPECT_EQ(drawn.travel(), "M9 0l21 0");
  EXPECT_EQ(drawn.cut(), "M0 0l9 0m21 0l0-8");
}

TEST(PicturePath, ColoursAndDashesAreThoseOfTheStrokes) {
  const std::vector<SketchElement> elements = {Cut({0, 0, 0}, {9, 0, 0})};
  std::string text;
  DrawPath({.elements = elements,
            .circles = {},
            .cut = "#123456",
            .cut_dashes = "4 2",
            .travel = "#654321"},
           FromAbove(), {}, 10, text);
  const DrawnPath drawn{.count = 1, .text = text};
  EXPECT_NE(drawn.Group(0).find("stroke=\"#654321\""), std::string::npos);
  EXPECT_NE(drawn.Group(1).find("stroke=\"#123456\" stroke-dasharray=\"4 2\""), std::string::npos);
  EXPECT_EQ(Draw(elements).Group(1).find("dasharray"), std::string::npos);
}

// Eight shades from the highest to the deepest, by the deeper end; what lies outside has the first
// or the last. Travel has none, and without depths nothing has one.
TEST(PicturePath, DepthsAreShades) {
  const DepthRange depth{.low_mm = -16.0, .high_mm = 0.0, .shaded = true};
  EXPECT_EQ(depth.ShadeOf(3.0), 0);
  EXPECT_EQ(depth.ShadeOf(-1.75), 0);
  EXPECT_EQ(depth.ShadeOf(-2.0), 1);
  EXPECT_EQ(depth.ShadeOf(-13.75), 6);
  EXPECT_EQ(depth.ShadeOf(-14.0), 7);
  EXPECT_EQ(depth.ShadeOf(-16.0), 7);
  EXPECT_EQ(depth.ShadeOf(-99.0), 7);
  const std::vector<SketchElement> elements = {
      Cut({0, 9, -1}, {9, 9, -5}), Cut({0, 0, -15}, {9, 0, -1}), Travel({0, 5, -15}, {9, 5, -15})};
  const DrawnPath drawn = Draw(elements, {}, FromAbove(), 10, depth);
  EXPECT_NE(drawn.Group(1).find("<path stroke=\"#2f8bb5\" d=\"M0-9l9 0\"/>"), std::string::npos);
  EXPECT_NE(drawn.Group(1).find("<path stroke=\"#1f1653\" d=\"M0 0l9 0\"/>"), std::string::npos);
  EXPECT_EQ(drawn.travel(), "M0-5l9 0");
  EXPECT_EQ(drawn.Group(0).find("<path stroke"), std::string::npos);
  EXPECT_EQ(Draw(elements).Group(1).find("<path stroke"), std::string::npos);
}

// Strokes along the surface have a group of their own, between travel and cuts; where a pen draws
// them they are its strokes.
TEST(DrawPath, StrokesAlongTheSurfaceLookDifferentBesideCuts) {
  SketchElement skim = Cut({0, 50, 0}, {100, 50, 0});
  skim.skims = true;
  const std::vector<SketchElement> elements = {skim, Cut({0, 0, -1}, {100, 0, -1})};
  DrawnPath drawn;
  DrawPath({.elements = elements, .circles = {}, .skims = true}, FromAbove(),
           {.low_mm = -2.0, .high_mm = 0.0, .shaded = true}, 100, drawn.text);
  EXPECT_EQ(drawn.Group(1).substr(0, 16), "<g class=\"skim\" ");
  EXPECT_EQ(DrawnPath::Data(drawn.Group(1)), "M0-50l100 0");
  EXPECT_EQ(DrawnPath::Data(drawn.Group(2)), "M0 0l100 0");
  EXPECT_EQ(Draw(elements).cut(), "M0-50l100 0m-100 50l100 0");
}

}  // namespace
}  // namespace rmlcell::simulation
