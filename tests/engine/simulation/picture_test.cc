#include "engine/simulation/picture/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/picture/path_sketch.h"
#include "engine/simulation/picture/picture_page.h"
#include "engine/simulation/picture/picture_view.h"
#include "tests/engine/motion/standard_machine.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/xml_check.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachineVector;
using motion::PathPiece;

machine::MachineShape DrawnMill() {
  machine::MachineShape shape;
  shape.travel.Add(MachineVector{0, 0, -60});
  shape.travel.Add(MachineVector{200, 150, 0});
  shape.has_work_origin = true;
  shape.work_origin = {10, 10, -20};
  return shape;
}

machine::MachineShape LaserWithTravel() {
  machine::MachineShape shape = Laser();
  shape.travel.Add(MachineVector{-600, -600, -1300});
  shape.travel.Add(MachineVector{3600, 3100, 1100});
  return shape;
}

RunReport Completed() {
  RunReport report;
  report.finished = true;
  report.title = "part";
  return report;
}

std::string SvgOf(const Script& script, const machine::MachineShape& shape,
                  const RunReport& report = Completed(), const PictureOptions& options = {}) {
  PictureRecorder recorder(shape);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  return recorder.Svg(report, options);
}

// All path data of a document, one after the other.
std::string PathsOf(std::string_view svg) {
  std::string data;
  const std::string_view begin = " d=\"";
  for (std::size_t at = svg.find(begin); at != std::string_view::npos;
       at = svg.find(begin, at + 1)) {
    const std::size_t from = at + begin.size();
    data += svg.substr(from, svg.find('"', from) - from);
    data += '\n';
  }
  return data;
}

Script SomeMilling() {
  Script script;
  script.Line({10, 10, -15}, {40, 40, -15})
      .Line({40, 40, -15}, {40, 40, -21}, {.use = MotionUse::kPlunge});
  script.Line({40, 40, -21}, {80, 40, -21}, {.use = MotionUse::kCut});
  script.Line({80, 40, -21}, {80, 70, -22}, {.use = MotionUse::kCut});
  script.Line({80, 70, -22}, {80, 70, -15}, {.use = MotionUse::kRetract});
  return script;
}

Script SomeLaserWork() {
  Script script;
  const MotionOptions cut{
      .use = MotionUse::kCut, .beam_on = true, .power = {.constant_percent = 100}};
  script.Motion(Planned(PathPiece::Line({{21, 2201, -350}}, {{1312, 700, -300}, 0.0, 0.3})));
  script.Signal(machine::Signal::kBeam, 1).Wait(machine::WaitKind::kPierce, 1.0, true, 50);
  script.Motion(Planned(PathPiece::Circle({{1312, 700, -300}, 0.0, 0.3}, {1300, 700, -300},
                                          {0, 0, 1}, kTurn, kTurn, 0.3)),
                cut);
  script.Signal(machine::Signal::kBeam, 0);
  return script;
}

// A standalone document: well-formed, nothing that runs, nothing from outside.
TEST(Picture, IsStandaloneAndWellFormed) {
  for (const std::string& svg :
       {SvgOf(SomeMilling(), DrawnMill()), SvgOf(SomeLaserWork(), LaserWithTravel()),
        SvgOf(Script(), DrawnMill()), SvgOf(Script(), {})}) {
    EXPECT_EQ(XmlFault(svg), "");
    EXPECT_TRUE(svg.starts_with("<?xml"));
    EXPECT_EQ(CountOf(svg, "<svg"), 1u);
    EXPECT_EQ(CountOf(svg, "<script"), 0u);
    EXPECT_EQ(CountOf(svg, "href"), 0u);
    EXPECT_EQ(CountOf(svg, "<image"), 0u);
    EXPECT_EQ(CountOf(svg, "http"), 1u);  // the name space
    EXPECT_EQ(CountOf(svg, "url("), CountOf(svg, "url(#"));
    EXPECT_EQ(CountOf(svg, "nan"), 0u);
    EXPECT_EQ(CountOf(svg, "inf"), 0u);
  }
}

// Names come from users.
TEST(Picture, TextIsEscaped) {
  RunReport report = Completed();
  report.title = "</title><script>alert(1)</script>&\xFF\x01\"";
  report.family = "<b>";
  report.inputs_hash = "\"><x";
  report.engine_version = "&";
  report.outcome.kind = machine::OutcomeKind::kFailed;
  report.outcome.code = ErrorCode::kHoleRadiusZero;
  const std::string svg = SvgOf(SomeMilling(), DrawnMill(), report);
  EXPECT_EQ(XmlFault(svg), "");
  EXPECT_EQ(CountOf(svg, "<script"), 0u);
  EXPECT_EQ(CountOf(svg, "<b>"), 0u);
}

// A title that does not fit is cut between characters.
TEST(Picture, LongTitlesAreCut) {
  RunReport report = Completed();
  for (int k = 0; k < 100; ++k) report.title += "ö";
  EXPECT_EQ(XmlFault(SvgOf(SomeMilling(), DrawnMill(), report)), "");
}

// One view for a mill, four panels for five axes, or what is asked for.
TEST(Picture, ViewsOfTheMachine) {
  const std::string mill = SvgOf(SomeMilling(), DrawnMill());
  EXPECT_EQ(CountOf(mill, "<clipPath"), 1u);
  EXPECT_EQ(CountOf(mill, ">XY from above<"), 1u);
  const std::string laser = SvgOf(SomeLaserWork(), LaserWithTravel());
  EXPECT_EQ(CountOf(laser, "<clipPath"), 4u);
  for (const char* view :
       {">XY from above<", ">XZ from the front<", ">YZ from the right<", ">in space<"}) {
    EXPECT_EQ(CountOf(laser, view), 1u) << view;
  }
  const std::string asked = SvgOf(SomeLaserWork(), LaserWithTravel(), Completed(),
                                  {.views = {PictureView::kXZ, PictureView::kYZ}});
  EXPECT_EQ(CountOf(asked, "<clipPath"), 2u);
}

// motion.md 8.1: a dot at each pierce, where the report counts one: WORK 1 with delay, or WORK 0
// followed by DELAY; no other signal makes one of a later DELAY.
TEST(Picture, DotsArePierces) {
  using machine::Signal;
  using machine::WaitKind;
  Script script;
  const auto cut = [&](double from, double to) {
    script.Line({from, 0, 0}, {to, 0, 0}, {.use = MotionUse::kCut, .beam_on = true});
  };
  script.Line({0, 5, 0}, {0, 0, 0});
  script.Signal(Signal::kBeam, 1, 100).Wait(WaitKind::kDwell, 0.5, true, 100.0);  // at 0
  cut(0, 10);
  script.Signal(Signal::kOutput, 1, 0, 16).Wait(WaitKind::kDwell, 0.5, true, 100.0);  // none
  script.Signal(Signal::kBeam, 1, 50).Wait(WaitKind::kDwell, 0.5, true, 100.0);  // it was on: none
  script.Signal(Signal::kBeam, 0).Signal(Signal::kBeam, 1, 100);
  cut(10, 20);
  script.Wait(WaitKind::kCondition, 1.0, true, 50.0);  // none
  script.Signal(Signal::kBeam, 0).Signal(Signal::kBeam, 1, 100);
  script.Wait(WaitKind::kPierce, 1.0, true, 50.0);  // at 20
  script.Wait(WaitKind::kDwell, 1.0, true, 0.0);    // the same one
  script.Signal(Signal::kBeam, 0).Wait(WaitKind::kDwell, 1.0);
  cut(20, 30);
  script.Signal(Signal::kBeam, 1, 100).Wait(WaitKind::kPierce, 0.0, true, 50.0);  // no time: none
  PictureRecorder recorder(Laser());
  FakeRun run(script, recorder);
  run.Advance(kForever);
  std::vector<double> dots;
  for (const SketchDot& dot : recorder.sketch().dots()) {
    EXPECT_TRUE(dot.pierce);
    dots.push_back(dot.at.x());
  }
  EXPECT_EQ(dots, (std::vector<double>{0.0, 20.0}));
  EXPECT_EQ(recorder.elements(), 4u);
  EXPECT_TRUE(recorder.exact());
}

// Cut and travel in different strokes, plunges and pierces as dots; legend, scale, envelope.
TEST(Picture, ShowsWhatTheIssueAsksFor) {
  const std::string mill = SvgOf(SomeMilling(), DrawnMill());
  EXPECT_EQ(CountOf(mill, "<path"), 1u + 2u);  // travel; two depths of cut
  for (const char* word : {">travel<", ">plunge<", ">start<", ">end<", ">travel of the machine<",
                           ">X mm<", ">Y mm<", ">GOOD, completed<"}) {
    EXPECT_GE(CountOf(mill, word), 1u) << word;
  }
  const std::string laser = SvgOf(SomeLaserWork(), LaserWithTravel());
  EXPECT_GE(CountOf(laser, ">pierce<"), 1u);
  EXPECT_GE(CountOf(laser, ">beam on<"), 1u);
  EXPECT_GE(CountOf(laser, ">direction of the head<"), 1u);
}

// Rulers and heights count from the work origin, at (10, 10, -20), or from the machine's zero.
TEST(Picture, CountsFromTheWorkOriginUnlessTheMachinesIsWanted) {
  const Script cut = Script()
                         .Line({10, 10, 5}, {10, 10, -21}, {.use = MotionUse::kPlunge})
                         .Line({10, 10, -21}, {60, 10, -21}, {.use = MotionUse::kCut})
                         .Line({60, 10, -21}, {60, 50, -23}, {.use = MotionUse::kCut});
  const std::string work = SvgOf(cut, DrawnMill(), Completed(), {});
  EXPECT_EQ(CountOf(work, ">cut, Z -1.00 to -3.00<"), 1);
  EXPECT_EQ(CountOf(work, "from the work origin, mm"), 1);
  EXPECT_EQ(CountOf(work, ">50</text>"), 1);  // X ends there
  EXPECT_EQ(CountOf(work, ">60</text>"), 0);
  const std::string machine = SvgOf(cut, DrawnMill(), Completed(), {.machine_frame = true});
  EXPECT_EQ(CountOf(machine, ">cut, Z -21.00 to -23.00<"), 1);
  EXPECT_EQ(CountOf(machine, "machine frame, mm"), 1);
  EXPECT_EQ(CountOf(machine, ">60</text>"), 1);
}

// Depth is told by shade where a mill is seen from above alone, and cut more than 0.01 mm deep in
// places: from the highest cut, by its deeper end, to the deepest.
TEST(Picture, DepthsHaveShadesFromAboveOnly) {
  const auto milled = [](double deeper) {
    return Script()
        .Line({0, 0, 5}, {0, 0, -1}, {.use = MotionUse::kPlunge})
        .Line({0, 0, -1}, {50, 0, -1}, {.use = MotionUse::kCut})
        .Line({50, 0, -1}, {50, 40, -1 - deeper}, {.use = MotionUse::kCut});
  };
  const auto shaded = [](const Script& script, const machine::MachineShape& shape,
                         const std::vector<PictureView>& views) {
    const std::string svg = SvgOf(script, shape, Completed(), {.views = views});
    return CountOf(svg, ">cut, Z 19.00 to ") == 1;  // Z 0 of the work is at -20
  };
  EXPECT_TRUE(shaded(milled(2.0), DrawnMill(), {}));
  EXPECT_TRUE(shaded(milled(0.011), DrawnMill(), {PictureView::kXY}));
  EXPECT_FALSE(shaded(milled(0.009), DrawnMill(), {PictureView::kXY}));
  EXPECT_FALSE(shaded(milled(2.0), DrawnMill(), {PictureView::kXZ}));
  EXPECT_FALSE(shaded(milled(2.0), DrawnMill(), {PictureView::kXY, PictureView::kXZ}));
  machine::MachineShape head = DrawnMill();
  head.five_axis = true;
  EXPECT_FALSE(shaded(milled(2.0), head, {PictureView::kXY}));
}

// A failed run says so, with code and place.
TEST(Picture, FailureIsShown) {
  RunReport report = Completed();
  report.outcome = {.kind = machine::OutcomeKind::kFailed,
                    .code = ErrorCode::kHoleRadiusZero,
                    .detail = "",
                    .place = {.program = 45, .step = 7}};
  const std::string svg = SvgOf(SomeMilling(), DrawnMill(), report);
  EXPECT_GE(CountOf(svg, "failed  OPT-E348  at 45/7"), 1u);
  EXPECT_GE(CountOf(svg, ">where it ended<"), 1u);
}

// What the travel cut off has lines and a place in the legend of its own, with its length: 60 mm
// beyond X 200 and 25 mm beyond Y 150.
TEST(Picture, WhatIsLostIsDrawn) {
  Script script = SomeMilling();
  EXPECT_EQ(CountOf(SvgOf(script, DrawnMill()), "class=\"lost\""), 0u);
  EXPECT_EQ(CountOf(SvgOf(script, DrawnMill()), "beyond the travel"), 0u);
  script.Lost({200, 40, -21}, {260, 40, -21}).Lost({40, 150, -21}, {40, 175, -21});
  const std::string svg = SvgOf(script, DrawnMill());
  EXPECT_EQ(XmlFault(svg), "");
  EXPECT_EQ(CountOf(svg, "<g class=\"lost\""), 1u);
  EXPECT_EQ(CountOf(svg, "class=\"lost\""), 2u);  // the other one in the legend
  EXPECT_EQ(CountOf(svg, ">beyond the travel, not cut<"), 1u);
  EXPECT_EQ(CountOf(svg, ">85.000 mm lost<"), 1u);
  // Two lines, of which the longer is 60 mm and the other 25 mm.
  const std::size_t group = svg.find("<g class=\"lost\"");
  const std::string data = PathsOf(svg.substr(group, svg.find("</g>", group) - group));
  double across = 0.0, up = 0.0;
  ASSERT_EQ(std::sscanf(data.c_str() + data.find('l'), "l%lf", &across), 1) << data;
  ASSERT_EQ(std::sscanf(data.c_str() + data.rfind('l'), "l0%lf", &up), 1) << data;
  EXPECT_NEAR(across / -up, 60.0 / 25.0, 0.01);
}

// Work that leads metres away does not make the rest a dot: 200 mm of travel in X are shown beyond
// it. Where nothing was cut all of it is shown, with the way of the tip.
TEST(Picture, WhatIsLostFarAwayIsCut) {
  const auto shown = [](double lost_from, double lost_to, MotionUse use) {
    PathSketch sketch(DrawnMill(), 1000);
    motion::PlannedMotion planned;
    planned.path = LineFrom({0, 10, -21}, {100, 10, -21});
    sketch.Add({.use = use, .motion = &planned, .travelled = 100.0});
    sketch.AddLost({.from = {lost_from, 10, -21}, .to = {lost_to, 10, -21}});
    EXPECT_EQ(sketch.lost_mm(), lost_to - lost_from);
    EXPECT_EQ(sketch.box().max.x(), 100.0);  // the tip was never there
    return BoxToShow(sketch, DrawnMill().travel);
  };
  const double margin = 1.06;  // of the extent from X 0
  EXPECT_NEAR(shown(200, 250, MotionUse::kCut).max.x(), 250.0 * margin, 1e-9);
  EXPECT_NEAR(shown(200, 90'000, MotionUse::kCut).max.x(), 400.0 * margin, 1e-9);
  EXPECT_NEAR(shown(500, 900, MotionUse::kTravel).max.x(), 900.0 * margin, 1e-9);
}

// Memory stays bounded however much is lost.
TEST(Picture, ManyLostLinesAreThinned) {
  PathSketch sketch(DrawnMill(), 1000);
  double length = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double y = 0.001 * i;
    sketch.AddLost({.from = {200, y, -21}, .to = {230, y, -21}});
    length += 30.0;
  }
  EXPECT_LE(sketch.lost().size(), 4'000u);
  EXPECT_GT(sketch.lost().size(), 100u);
  EXPECT_NEAR(sketch.lost_mm(), length, 1e-3);
  EXPECT_EQ(sketch.elements().size(), 0u);
}

// A picture that goes from hand to hand says which machine it is of, and what was changed.
TEST(Picture, NamesTheProfile) {
  RunReport report = Completed();
  report.family = "rml1";
  report.machine = {.profile = "mdx-15", .named = true};
  std::string svg = SvgOf(SomeMilling(), DrawnMill(), report);
  EXPECT_EQ(CountOf(svg, " (mdx-15)<"), 1u);
  EXPECT_EQ(CountOf(svg, "changed"), 0u);
  report.machine = {.profile = "srm-20",
                    .named = false,
                    .changes = {{"X_MAX", "100", "203.2"}},
                    .changed_by = "a<b.toml"};
  svg = SvgOf(SomeMilling(), DrawnMill(), report);
  EXPECT_EQ(XmlFault(svg), "");
  EXPECT_EQ(CountOf(svg, ">Roland monoFab SRM-20 (srm-20): no profile was named<"), 1u);
  EXPECT_EQ(CountOf(svg, ">changed: X_MAX 100 (profile: 203.2); by a&lt;b.toml<"), 1u);
}

// An arc that bows less than a fiftieth of a pixel is drawn as a line: 6 um in a picture of a
// metre, over a chord of 10 mm; one that bows 0.6 mm is an arc.
TEST(Picture, AnArcThatBowsTooLittleIsALine) {
  const auto drawn = [](double radius) {
    const PathPiece flat =
        PathPiece::Circle({{500, 0, 0}}, {505, -std::sqrt(radius * radius - 25.0), 0}, {0, 0, -1},
                          2.0 * std::asin(5.0 / radius), 0.0, 0.0);
    Script script;
    script.Line({0, 0, 0}, {500, 0, 0}, {.use = MotionUse::kCut});
    script.Motion(Planned(flat), {.use = MotionUse::kCut});
    script.Line({510, 0, 0}, {1000, 0, 0}, {.use = MotionUse::kCut});
    return PathsOf(SvgOf(script, {}));
  };
  EXPECT_EQ(drawn(2000.0).find('a'), std::string::npos);
  EXPECT_NE(drawn(20.0).find('a'), std::string::npos);
}

// motion.md 9: a program without blends gives real arcs. A full circle seen from above is arcs of
// equal radii, and they end where they began; no line is drawn for it.
TEST(Picture, ArcsAreArcs) {
  Script script;
  script.Motion(Planned(PathPiece::Circle({{112, 50, 0}}, {100, 50, 0}, {0, 0, 1}, kTurn, 0, 0)),
                {.use = MotionUse::kCut});
  const std::string paths = PathsOf(SvgOf(script, {}));
  EXPECT_EQ(CountOf(paths, "a"), 3u);  // pieces of at most 2.5 rad
  EXPECT_EQ(CountOf(paths, "l"), 0u);
  const std::size_t arc = paths.find('a') + 1;
  const std::size_t blank = paths.find(' ', arc);
  const double rx = std::stod(paths.substr(arc, blank - arc));
  const double ry = std::stod(paths.substr(blank + 1));
  EXPECT_EQ(rx, ry);
  EXPECT_GT(rx, 100.0);  // a good part of the picture
}

// The scale bar is as long as it says: its millimetres have as many pixels as those of the circle.
TEST(Picture, ScaleBarIsTrue) {
  Script script;
  script.Motion(Planned(PathPiece::Circle({{112, 50, 0}}, {100, 50, 0}, {0, 0, 1}, kTurn, 0, 0)),
                {.use = MotionUse::kCut});
  const std::string svg = SvgOf(script, {});
  const std::string paths = PathsOf(svg);
  const double pixels_per_mm = std::stod(paths.substr(paths.find('a') + 1)) / 12.0;
  const std::size_t label = svg.find("font-size=\"11.5\"");
  const std::size_t text = svg.find('>', label) + 1;
  const double label_mm = std::stod(svg.substr(text));
  const auto attribute = [&](const char* name) {
    const std::size_t line = svg.rfind(name, svg.rfind("<line", svg.rfind("<line", label) - 1));
    return std::stod(svg.substr(line + 4));
  };
  EXPECT_NEAR((attribute("x2=\"") - attribute("x1=\"")) / label_mm, pixels_per_mm, 0.01);
}

// A circle that leans by 60 degrees is seen as an ellipse, half as high as it is wide; one that is
// seen from its edge is a line to and fro.
TEST(Picture, LeaningCirclesAreEllipses) {
  Script script;
  const double sine = std::sqrt(0.75);
  script.Motion(Planned(PathPiece::Circle({{12, 0, 0}}, {0, 0, 0}, {0, -sine, 0.5}, kTurn, 0, 0)),
                {.use = MotionUse::kCut});
  const std::string paths = PathsOf(SvgOf(script, {}, Completed(), {.views = {PictureView::kXY}}));
  const std::size_t arc = paths.find('a') + 1;
  const std::size_t blank = paths.find(' ', arc);
  const double rx = std::stod(paths.substr(arc, blank - arc));
  const double ry = std::stod(paths.substr(blank + 1));
  EXPECT_NEAR(ry / rx, 0.5, 1e-3);

  Script flat;
  flat.Motion(Planned(PathPiece::Circle({{12, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0, 0)),
              {.use = MotionUse::kCut});
  const std::string edge = PathsOf(SvgOf(flat, {}, Completed(), {.views = {PictureView::kXZ}}));
  EXPECT_EQ(CountOf(edge, "a"), 0u);
  EXPECT_GE(CountOf(edge, "l"), 1u);
}

// The same picture, whatever else is drawn: an arc of the page passes through the projected middle
// of the arc of the path. Checked from the numbers in the document.
TEST(Picture, ArcTurnsTheRightWay) {
  Script script;  // a quarter from +X to +Y about +Z: counter-clockwise on the page, flag 0
  script.Motion(Planned(PathPiece::Circle({{10, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kPi / 2, 0, 0)),
                {.use = MotionUse::kCut});
  EXPECT_EQ(CountOf(PathsOf(SvgOf(script, {})), " 0 0 0 "), 1u);
  Script back;
  back.Motion(Planned(PathPiece::Circle({{10, 0, 0}}, {0, 0, 0}, {0, 0, -1}, kPi / 2, 0, 0)),
              {.use = MotionUse::kCut});
  EXPECT_EQ(CountOf(PathsOf(SvgOf(back, {})), " 0 0 1 "), 1u);
}

// Bounded: a million moves give a picture of bounded size that says it is coarser, in bounded
// memory.
TEST(Picture, MillionMovesGiveABoundedPicture) {
  PictureRecorder recorder(DrawnMill());
  motion::PlannedMotion planned;
  motion::MachinePoint at{0, 0, -21};
  // Scattered lines that cannot be merged: the worst case.
  std::uint64_t state = 1;
  const auto next = [&state](double range) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return range * static_cast<double>(state >> 40) / static_cast<double>(1 << 24);
  };
  for (int k = 0; k < 1'000'000; ++k) {
    const motion::MachinePoint to{next(200.0), next(150.0), -21.0 - next(5.0)};
    planned.path = LineFrom(at, to);
    recorder.OnMotion({.use = k % 3 == 0 ? MotionUse::kTravel : MotionUse::kCut,
                       .motion = &planned,
                       .travelled = planned.path.length()});
    at = to;
  }
  EXPECT_LE(recorder.elements(), kSketchElementsMax);
  EXPECT_FALSE(recorder.exact());
  const std::string svg = recorder.Svg(Completed(), {});
  EXPECT_LT(svg.size(), 24 * kPictureElementsMax);
  EXPECT_GE(CountOf(svg, "drawn coarser"), 1u);
  EXPECT_EQ(XmlFault(svg), "");
}

// Nothing moved: the travel of the machine, and a word; there is no part whose place could be
// shown.
TEST(Picture, NothingMoved) {
  const std::string svg = SvgOf(Script(), DrawnMill());
  EXPECT_EQ(CountOf(svg, ">nothing moved<"), 1u);
  EXPECT_EQ(CountOf(svg, ">Place on the machine<"), 0u);
  EXPECT_EQ(CountOf(SvgOf(SomeMilling(), DrawnMill()), ">Place on the machine<"), 1u);
  EXPECT_EQ(CountOf(SvgOf(SomeMilling(), {}), ">Place on the machine<"), 0u);
}

// The map has the part where it lies on the machine, however small that is; without an extent in X
// or Y there is none.
TEST(Picture, TheMapNeedsAnExtent) {
  const auto maps = [](double x, double y) {
    machine::MachineShape shape;
    shape.travel.Add(MachineVector{0, 0, 0});
    shape.travel.Add(MachineVector{x, y, 1});
    const std::string svg = SvgOf(Script().Line({0, 0, 0}, {0.5 * x, 0.5 * y, 1}), shape);
    return CountOf(svg, "fill-opacity=\"0.25\"");
  };
  EXPECT_EQ(maps(200, 150), 1u);
  EXPECT_EQ(maps(0.5, 0.5), 1u);
  EXPECT_EQ(maps(0.0, 100), 0u);
  EXPECT_EQ(maps(100, 0.0), 0u);
}

// More than 300 dots are drawn small: both sides. Those at the same place are one.
TEST(Picture, ManyDotsAreSmall) {
  const auto drawn = [](int count, double apart) {
    Script script;
    for (int k = 0; k < count; ++k) {
      const double x = apart * (k % 20), y = 4.0 * (k / 20);
      script.Line({x, y, 0}, {x, y, -1}, {.use = MotionUse::kPlunge});
      script.Line({x, y, -1}, {x, y, 0}, {.use = MotionUse::kRetract});
    }
    return SvgOf(script, {});
  };
  const std::string few = drawn(300, 4.0);
  EXPECT_EQ(CountOf(few, "r=\"2.4\" fill=\"#ffffff\" stroke=\"#e8590c\" stroke-width=\"1.2\""),
            300u + 1u);
  const std::string many = drawn(301, 4.0);
  EXPECT_EQ(CountOf(many, "r=\"1.1\" fill=\"#ffffff\" stroke=\"#e8590c\" stroke-width=\".6\""),
            301u);
  EXPECT_EQ(CountOf(many, "r=\"2.4\""), 1u);  // of the legend
  EXPECT_EQ(CountOf(drawn(40, 0.0), "r=\"2.4\""), 2u + 1u);
}

// At most 120 directions of the head: of 120 cuts all, of 121 each second one.
TEST(Picture, SomeDirectionsOfTheHeadAreShown) {
  const auto shown = [](int cuts) {
    Script script;
    for (int k = 0; k < cuts; ++k) {
      script.Line({1.0 * k, 0, 0}, {k + 1.0, 0, 0}, {.use = MotionUse::kCut, .beam_on = true});
    }
    const std::string svg =
        SvgOf(script, Laser(), Completed(), {.views = {PictureView::kDirection}});
    const std::size_t begin = svg.find("<g stroke=\"#0f8a5f\"");
    return CountOf(svg.substr(begin, svg.find("</g>", begin) - begin), "<line");
  };
  EXPECT_EQ(shown(120), 120u);
  EXPECT_EQ(shown(121), 61u);
}

// Laid out neither narrower than 640 px nor wider than 8192; a narrower one is made smaller as a
// whole.
TEST(Picture, WidthIsLimited) {
  struct Case {
    int asked, made, shown;
  };
  for (const auto& [asked, made, shown] : {Case{1, 640, 640},
                                           {63, 640, 640},
                                           {64, 640, 64},
                                           {320, 640, 320},
                                           {640, 640, 640},
                                           {641, 641, 641},
                                           {8191, 8191, 8191},
                                           {9000, 8192, 8192}}) {
    const std::string svg = SvgOf(Script(), DrawnMill(), Completed(), {.width_px = asked});
    EXPECT_EQ(CountOf(svg, "viewBox=\"0 0 " + std::to_string(made) + " "), 1u) << asked;
    EXPECT_EQ(CountOf(svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
                               std::to_string(shown) + "\" "),
              1u)
        << asked;
  }
}

// Browsers draw long paths slowly: a thousand segments in one.
TEST(Picture, LongPathsAreDivided) {
  const auto paths = [](int lines) {
    Script script;
    for (int k = 0; k < lines; ++k) {
      script.Line({2.0 * k, k % 2 * 900.0, 0}, {2.0 * k + 2.0, (k + 1) % 2 * 900.0, 0},
                  {.use = MotionUse::kCut});
    }
    return CountOf(SvgOf(script, {}), "<path");
  };
  EXPECT_EQ(paths(1000), 1u);
  EXPECT_EQ(paths(1001), 2u);
}

TEST(DurationText, ForPeople) {
  EXPECT_EQ(DurationText(FromSeconds(59.999)), "59.999 s");
  EXPECT_EQ(DurationText(FromSeconds(69.96)), "1 min 10.0 s");
  EXPECT_EQ(DurationText(FromSeconds(3599.9)), "59 min 59.9 s");
  EXPECT_EQ(DurationText(FromSeconds(3600.0)), "1 h 00 min 00 s");
  EXPECT_EQ(DurationText(FromSeconds(59.9994)), "59.999 s");
  EXPECT_EQ(DurationText(FromSeconds(59.9996)), "1 min 00.0 s");
  EXPECT_EQ(DurationText(FromSeconds(3599.94)), "59 min 59.9 s");
  EXPECT_EQ(DurationText(FromSeconds(3599.96)), "1 h 00 min 00 s");
  EXPECT_EQ(DurationText(FromSeconds(36610.6)), "10 h 10 min 11 s");
  EXPECT_EQ(DurationText(FromSeconds(12.3456)), "12.346 s");
  EXPECT_EQ(DurationText(FromSeconds(245.17)), "4 min 05.2 s");
  EXPECT_EQ(DurationText(FromSeconds(60.0)), "1 min 00.0 s");
  EXPECT_EQ(DurationText(FromSeconds(7384.0)), "2 h 03 min 04 s");
}

}  // namespace
}  // namespace rmlcell::simulation
