// Pictures, plots, toolpaths and checks at their edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "engine/families/families.h"
#include "engine/simulation/picture/picture.h"
#include "engine/simulation/picture/picture_page.h"
#include "engine/simulation/picture/picture_panel.h"
#include "engine/simulation/picture/plot.h"
#include "engine/simulation/run/motion_check.h"
#include "engine/simulation/toolpath/toolpath_recorder.h"
#include "tests/engine/simulation/fake_family.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/xml_check.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachinePoint;

bool Has(const std::string& text, std::string_view what) {
  return text.find(what) != std::string::npos;
}

void SketchLine(PathSketch& sketch, const MachinePoint& from, const MachinePoint& to) {
  motion::PlannedMotion planned;
  planned.path = LineFrom(from, to);
  sketch.Add({.use = MotionUse::kCut, .motion = &planned, .travelled = planned.path.length()});
}

// From a minute on in minutes, from an hour on in hours.
TEST(PageEdges, DurationsChangeTheirUnits) {
  using std::chrono::milliseconds;
  using std::chrono::seconds;
  EXPECT_EQ(DurationText(milliseconds(59'999)), "59.999 s");
  EXPECT_EQ(DurationText(seconds(60)), "1 min 00.0 s");
  EXPECT_EQ(DurationText(milliseconds(3'599'900)), "59 min 59.9 s");
  EXPECT_EQ(DurationText(seconds(3'600)), "1 h 00 min 00 s");
  EXPECT_EQ(DurationText(seconds(2 * 3'600 + 3 * 60 + 4)), "2 h 03 min 04 s");
}

// Three decimals below 100 mm, one from there on, none of nothing.
TEST(PageEdges, LengthsChangeTheirDecimals) {
  const PathSketch sketch({}, 10);
  const auto page = [&](double cut_mm, double travel_mm) {
    RunReport report;
    report.total.cut_mm = cut_mm;
    report.total.travel_mm = travel_mm;
    return PicturePage(sketch, {}, report, {});
  };
  EXPECT_TRUE(Has(page(100.0, 99.5), ", cut 100.0 mm, travel 99.500 mm</desc>"));
  EXPECT_TRUE(Has(page(99.9996, 99.9994), ", cut 100.0 mm, travel 99.999 mm</desc>"));
  EXPECT_TRUE(Has(page(0.0, 1234.0), ", cut 0 mm, travel 1234.0 mm</desc>"));
}

// Four reasons are drawn; of more it is said how many there are.
TEST(PageEdges, MoreThanFourReasonsAreCounted) {
  const PathSketch sketch({}, 10);
  const auto page = [&](int reasons) {
    RunReport report;
    for (int k = 1; k <= reasons; ++k) {
      std::string said = "reason ";
      said += std::to_string(k);
      report.judgement.reasons.push_back(
          {.code = ErrorCode::kCellGouge, .verdict = machine::Verdict::kBad, .said = said});
    }
    return PicturePage(sketch, {}, report, {});
  };
  const std::string four = page(4);
  EXPECT_TRUE(Has(four, ">reason 4<"));
  EXPECT_FALSE(Has(four, " more<"));
  const std::string six = page(6);
  EXPECT_FALSE(Has(six, ">reason 5<"));
  EXPECT_TRUE(Has(six, ">and 2 more<"));
}

// 800 mm by 400 mm at 1 px a mm.
Panel MillimetrePanel(double width) {
  return {.frame = FrameOf(PictureView::kXY, {}),
          .rect = {.x = 60.0, .y = 40.0, .width = width, .height = 400.0},
          .scale = 1.0,
          .middle_right = 0.5 * width,
          .middle_up = 200.0};
}

// What lies on the edge of a panel is seen in it.
TEST(PageEdges, DotsOnTheEdgesAreDrawn) {
  const machine::MachineShape shape;
  const auto pierces = [&](const std::vector<MachinePoint>& places) {
    PathSketch sketch(shape, 100);
    for (const MachinePoint& place : places) {
      SketchLine(sketch, place - motion::MachineVector{0, 0, 1}, place);
      sketch.AddPierce();
    }
    std::string drawn;
    DrawPanel({.sketch = sketch, .shape = shape, .elements_max = 100}, MillimetrePanel(800.0), 1,
              drawn);
    return CountOf(drawn, "fill=\"#e8590c\"");
  };
  EXPECT_EQ(pierces({{0, 200, 0}, {800, 200, 0}, {400, 0, 0}, {400, 400, 0}}), 4u);
  EXPECT_EQ(pierces({{-0.5, 200, 0}, {800.5, 200, 0}, {400, -0.5, 0}, {400, 400.5, 0}}), 0u);
}

// Where there are more than 300 pierces, each is small; those less than a pixel apart are one.
TEST(PageEdges, ManyPiercesAreSmall) {
  const machine::MachineShape shape;
  const auto drawn = [&](int count, double apart) {
    PathSketch sketch(shape, 1000);
    for (int k = 0; k < count; ++k) {
      const MachinePoint place{42.0 + apart * (k % 30), 100.0 + 20.0 * (k / 30), 0.0};
      SketchLine(sketch, place - motion::MachineVector{0, 0, 1}, place);
      sketch.AddPierce();
    }
    std::string panel;
    DrawPanel({.sketch = sketch, .shape = shape, .elements_max = 1000}, MillimetrePanel(800.0), 1,
              panel);
    return std::pair(CountOf(panel, "r=\"4.2\" fill=\"#e8590c\""),
                     CountOf(panel, "r=\"2.2\" fill=\"#e8590c\""));
  };
  EXPECT_EQ(drawn(300, 20.0), std::pair(std::size_t{300}, std::size_t{0}));
  EXPECT_EQ(drawn(301, 20.0), std::pair(std::size_t{0}, std::size_t{301}));
  EXPECT_EQ(drawn(2, 3.0).first, 2u);
  EXPECT_EQ(drawn(2, 0.5).first, 1u);
}

// The scale bar of 90 px at least, with 60 for its figure and 44 for the name of the axis: 100 mm
// where that has room, else a quarter as long at least.
TEST(PageEdges, TheScaleBarHasRoom) {
  const auto drawn = [](double width) {
    std::string out;
    EndPanel(MillimetrePanel(width), false, out);
    return out;
  };
  EXPECT_TRUE(Has(drawn(204.0), ">100 mm<"));
  EXPECT_TRUE(Has(drawn(203.0), ">50 mm<"));
}

// motion.md 8.2: ways that were lost are shown as far beyond the travel as that is large, on either
// side of each axis.
TEST(PageEdges, LostWaysAreFollowedNotTooFar) {
  machine::Box travel;
  travel.Add(MachinePoint{0, 0, -10});
  travel.Add(MachinePoint{100, 80, 0});
  const machine::MachineShape shape;
  const MachinePoint low{-100, -80, -20};
  const MachinePoint high{200, 160, 10};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double far : {-5000.0, 5000.0}) {
      PathSketch sketch(shape, 100);
      SketchLine(sketch, {0, 0, -5}, {100, 80, -4});
      MachinePoint to{50, 40, -5};
      to[axis] = far;
      sketch.AddLost({.from = {50, 40, -5}, .to = to});
      const machine::Box shown = BoxToShow(sketch, travel);
      const machine::Box cut = sketch.cut_box();
      MachinePoint least = cut.min;
      MachinePoint most = cut.max;
      (far < 0.0 ? least : most)[axis] = far < 0.0 ? low[axis] : high[axis];
      const double margin = 0.06 * (most - least).maxCoeff();
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(shown.min[i], least[i] - margin, 1e-9) << axis << ' ' << far;
        EXPECT_NEAR(shown.max[i], most[i] + margin, 1e-9) << axis << ' ' << far;
      }
    }
  }
}

std::string PlotOf(const Script& script, std::vector<PlotCurve> curves, SimTime duration) {
  PlotRecorder recorder(Laser());
  FakeRun run(script, recorder);
  run.Advance(kForever);
  RunReport report;
  report.cycle_time = duration;
  return recorder.Svg(report, {.curves = std::move(curves)});
}

// Positions of A and B are angles.
TEST(PlotEdges, RotaryAxesAreInRadians) {
  Script script;
  script.Motion(
      Planned(motion::PathPiece::Line({{0, 0, 0}, 0.0, 0.5}, {{40, 0, 0}, 1.0, 0.5}), kSlowLimits));
  const std::string svg = PlotOf(script, {PlotCurve::kAxes}, std::chrono::seconds(2));
  EXPECT_EQ(CountOf(svg, ">A<"), 1u);
  EXPECT_EQ(CountOf(svg, ">rad<"), 1u);
  EXPECT_EQ(CountOf(svg, ">X<"), 1u);
  EXPECT_EQ(CountOf(svg, ">B<"), 0u);
}

// The last mark of an axis is drawn, too: 10 s, and 100 %.
TEST(PlotEdges, TheLastMarksAreDrawn) {
  Script script;
  script.Step(1, 1).Wait(machine::WaitKind::kPierce, 10.0, true, 40.0);
  const std::string svg = PlotOf(script, {PlotCurve::kPower}, std::chrono::seconds(10));
  EXPECT_EQ(XmlFault(svg), "");
  EXPECT_TRUE(Has(svg, ">0<"));
  EXPECT_TRUE(Has(svg, ">10<"));
  EXPECT_TRUE(Has(svg, ">100<"));
  EXPECT_FALSE(Has(svg, ">11<"));
}

// A speed that is 0 all the time has a scale all the same, from 0 to 1.
TEST(PlotEdges, NothingButZeroHasAScale) {
  Script script;
  script.Step(1, 1).Wait(machine::WaitKind::kDwell, 100.0);
  const std::string svg = PlotOf(script, {PlotCurve::kSpeed}, std::chrono::seconds(100));
  EXPECT_TRUE(Has(svg, ">0.8<"));
  EXPECT_TRUE(Has(svg, ">1.0<"));
}

// A wait of so many microseconds, and the power of the beam meanwhile.
struct ShortPierce {
  int microseconds;
  double power_percent;
};

// The curve of the power: its begin, and the step from each of its points to the next one.
std::vector<double> PlottedPower(PlotRecorder& recorder, const std::vector<ShortPierce>& pierces) {
  RunReport report;
  for (const ShortPierce& pierce : pierces) {
    const SimTime end = report.cycle_time + std::chrono::microseconds(pierce.microseconds);
    recorder.OnWait({.start = report.cycle_time,
                     .end = end,
                     .kind = machine::WaitKind::kPierce,
                     .beam_on = true,
                     .power_percent = pierce.power_percent});
    report.cycle_time = end;
  }
  const std::string svg = recorder.Svg(report, {.curves = {PlotCurve::kPower}});
  const std::size_t begin = svg.find("<path d=\"") + 9;
  const std::string data = svg.substr(begin, svg.find('"', begin) - begin);
  std::vector<double> numbers;
  for (const char* at = data.c_str(); *at != 0;) {
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end != at) numbers.push_back(number);
    at = end != at ? end : at + 1;
  }
  return numbers;
}

// What goes up, or down, within one step of the plot does so on one straight line over that step.
TEST(PlotEdges, ARiseIsAStraightLine) {
  for (const bool up : {true, false}) {
    PlotRecorder recorder(Laser());
    const std::vector<double> numbers =
        PlottedPower(recorder, {{200, up ? 20.0 : 80.0}, {200, up ? 80.0 : 20.0}});
    ASSERT_EQ(numbers.size(), 8u) << up;  // a begin, and three steps: level, up or down, level
    EXPECT_EQ(numbers[3], 0.0);
    EXPECT_EQ(numbers[5] < 0.0, up);
    EXPECT_NE(numbers[5], 0.0);
    EXPECT_EQ(numbers[7], 0.0);
    const double step_s = ToSeconds(recorder.Values(std::chrono::microseconds(400)).width());
    EXPECT_NEAR(numbers[4] / (numbers[2] + numbers[4] + numbers[6]), step_s / 0.0004, 1e-3);
  }
}

// What is over within one step of the plot is back at the end of that step, however long nothing
// happens behind it: up, or down, in the middle of the step.
TEST(PlotEdges, APeakWithinAStepEndsWithIt) {
  for (const bool up : {true, false}) {
    PlotRecorder recorder(Laser());
    const double level = up ? 20.0 : 80.0, peak = up ? 80.0 : 20.0;
    const std::vector<double> numbers =
        PlottedPower(recorder, {{20, level}, {10, peak}, {9'970, level}});
    // A begin, nothing, the way there, the way back, and the rest.
    ASSERT_EQ(numbers.size(), 10u) << up;
    EXPECT_EQ(numbers[2], 0.0);
    EXPECT_EQ(numbers[3], 0.0);
    EXPECT_EQ(numbers[5] < 0.0, up);
    EXPECT_NEAR(numbers[7], -numbers[5], 0.011);
    EXPECT_NEAR(numbers[6], numbers[4], 0.021);
    EXPECT_GT(numbers[8], 100.0 * numbers[6]);
    EXPECT_EQ(numbers[9], 0.0);
  }
}

// The beam is off in a wait without it, whatever power is set.
TEST(PlotEdges, AWaitWithoutTheBeamHasNoPower) {
  PlotRecorder recorder(Laser());
  const machine::Place here{.program = 1, .step = 1};
  recorder.OnWait({.start = SimTime(0),
                   .end = std::chrono::seconds(1),
                   .place = here,
                   .beam_on = false,
                   .power_percent = 60.0});
  for (const TimeEnvelope::Bucket& bucket : recorder.Values(std::chrono::seconds(1)).buckets()) {
    EXPECT_EQ(bucket.ranges[PlotSeries::kPower].high, 0.0);
    EXPECT_EQ(bucket.ranges[PlotSeries::kPower].low, 0.0);
  }
}

// A tip that came there at its speed stands as soon as it waits, and nothing is asked of it.
TEST(PlotEdges, AWaitBehindAMotionStands) {
  using std::chrono::seconds;
  PlotRecorder recorder(Laser());
  motion::PlannedMotion planned;
  planned.path = LineFrom({}, {50, 0, 0});
  planned.speed = motion::SpeedProfile::Steady(50.0, 50.0);
  recorder.OnMotion({.start = SimTime(0),
                     .end = seconds(1),
                     .motion = &planned,
                     .travelled = 50.0,
                     .programmed_mm_s = 60.0});
  recorder.OnWait({.start = seconds(1), .end = seconds(2)});
  const TimeEnvelope& values = recorder.Values(seconds(2));
  for (const std::size_t series : {PlotSeries::kSpeed, PlotSeries::kFeed}) {
    EXPECT_GT(values.buckets().front().ranges[series].low, 0.0);
    EXPECT_EQ(values.buckets().back().ranges[series].high, 0.0);
  }
}

// Neither of one that is not told nor of one that ends before it begins.
TEST(PlotEdges, OfNoMotionNothingIsKnown) {
  using std::chrono::seconds;
  PlotRecorder recorder(Laser());
  motion::PlannedMotion planned;
  planned.path = LineFrom({}, {100, 0, 0});
  planned.speed = motion::SpeedProfile::Steady(100.0, 50.0);
  recorder.OnMotion({.start = SimTime(0), .end = seconds(1)});
  recorder.OnMotion(
      {.start = seconds(2), .end = seconds(1), .motion = &planned, .travelled = 100.0});
  EXPECT_TRUE(recorder.Values(seconds(3)).buckets().empty());
}

// With a tolerance of 1 mm straight ways are joined within 0.025 mm.
std::vector<ToolpathPoint> ToolpathOf(const std::vector<MachinePoint>& places) {
  std::vector<ToolpathPoint> points;
  ToolpathRecorder recorder({}, {.tolerance_mm = 1.0}, [&](std::string_view bytes) {
    const auto block = DecodeToolpathBlock(bytes);
    EXPECT_TRUE(block);
    if (block) points.insert(points.end(), block->points.begin(), block->points.end());
    return true;
  });
  Script script;
  script.Step(1, 1);
  for (std::size_t k = 1; k < places.size(); ++k) script.Line(places[k - 1], places[k]);
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.Finish();
  return points;
}

TEST(ToolpathEdges, StraightWaysAreJoinedWithinALimit) {
  using Points = std::vector<ToolpathPoint>;
  // As far beside the way as the limit, and a little more.
  EXPECT_EQ(ToolpathOf({{0, 0, 0}, {10, 0, 0}, {20, 0.025, 0}}),
            (Points{{0, 0, 0}, {20'000, 25, 0}}));
  EXPECT_EQ(ToolpathOf({{0, 0, 0}, {10, 0, 0}, {20, 0.026, 0}}),
            (Points{{0, 0, 0}, {10'000, 0, 0}, {20'000, 26, 0}}));
  // A way as short as the limit gives no direction; one a little longer does.
  EXPECT_EQ(ToolpathOf({{0, 0, 0}, {0.025, 0, 0}, {10, 0.02, 0}}),
            (Points{{0, 0, 0}, {25, 0, 0}, {10'000, 20, 0}}));
  EXPECT_EQ(ToolpathOf({{0, 0, 0}, {0.026, 0, 0}, {10, 0.02, 0}}),
            (Points{{0, 0, 0}, {10'000, 20, 0}}));
  // Aside is not forward.
  EXPECT_EQ(ToolpathOf({{0, 0, 0}, {10, 0, 0}, {10, 0.02, 0}}),
            (Points{{0, 0, 0}, {10'000, 0, 0}, {10'000, 20, 0}}));
  // A way of less than a micrometre has two points alike.
  EXPECT_EQ(ToolpathOf({{5, 5, 5}, {5.0001, 5, 5}}),
            (Points{{5'000, 5'000, 5'000}, {5'000, 5'000, 5'000}}));
}

// How far a program was followed: not at all, to a step, or to a step of a line.
TEST(CheckEdges, HowFarAProgramWasFollowed) {
  const auto told = [](Script script) {
    script.Ends(machine::OutcomeKind::kStopped, ErrorCode::kCellNotLive, "why");
    const auto check = CheckMotion(FakeFamily(script, true), FakeFamily::Setup(), {1});
    EXPECT_TRUE(check);
    return std::string(check->cut_short.at(1).text);
  };
  EXPECT_EQ(told(Script()).find("not at all: "), 0u);
  Script step;
  step.Step(1, 3);
  EXPECT_EQ(told(step).find("only up to step 3: "), 0u);
  Script line;
  line.Step(1, 3, 7);
  EXPECT_EQ(told(line).find("only up to step 3, line 7: "), 0u);
}

// Names as people write them: one letter in a folder is a name, too, and a folder is none.
TEST(FamilyEdges, ShortNamesInFolders) {
  EXPECT_TRUE(families::IsObjectFileName("d/a.O"));
  EXPECT_TRUE(families::IsObjectFileName("d\\a.o"));
  EXPECT_FALSE(families::IsObjectFileName("d/"));
  EXPECT_EQ(families::FamilyOfFileName("d/"), nullptr);
  EXPECT_EQ(families::FamilyOfFileName("d/a.rml"), families::FindFamily("rml1"));
}

// A stream has no tools, but two of them can be compared; a text has both.
TEST(FamilyEdges, WhoCompares) {
  const machine::MachineFamily* mill = families::FindFamily("rml1");
  const machine::MachineFamily* laser = families::FindFamily("optimo");
  EXPECT_EQ(*families::FamilyThatCompares("a.rml"), mill);
  EXPECT_EQ(*families::FamilyThatCompares("a.S"), laser);
  EXPECT_EQ(*families::FamilyThatCompares("a"), laser);
  EXPECT_EQ(families::FamilyWithTools("a.rml").error().detail,
            "a.rml is a program for Roland mill or engraver, RML-1: there are no tools for its "
            "streams");
  const auto streams =
      families::Diff(*mill, {.object = ";;^IN;!MC0;PA0,0;"}, {.object = ";;^IN;!MC0;PA0,0;"},
                     machine::Parameters(mill->parameters()));
  ASSERT_TRUE(streams);
  EXPECT_TRUE(streams->steps.empty());
  const auto longer = families::Diff(*mill, {.object = "!MC0;"}, {.object = "!MC0;PU100,200;"},
                                     machine::Parameters(mill->parameters()));
  ASSERT_TRUE(longer);
  ASSERT_FALSE(longer->steps.empty());
  for (const machine::StepChange& step : longer->steps) {
    EXPECT_EQ(step.before, "");
    EXPECT_NE(step.after, "");
  }
  const auto compiled = [&](std::string_view text) {
    return laser->tools()
        ->Compile({.name = "a.S", .bytes = text}, machine::Parameters(laser->parameters()), {})
        .object;
  };
  const std::string one = compiled("SPEED 20\nSTOP\n");
  const std::string two = compiled("SPEED 20\nDELAY 2.0\nSTOP\n");
  const auto added = families::Diff(*laser, {.object = one}, {.object = two},
                                    machine::Parameters(laser->parameters()));
  ASSERT_TRUE(added);
  ASSERT_FALSE(added->steps.empty());
  EXPECT_TRUE(std::ranges::any_of(added->steps, [](const machine::StepChange& step) {
    return step.kind == machine::StepChange::Kind::kAdded;
  }));
  EXPECT_FALSE(std::ranges::any_of(added->steps, [](const machine::StepChange& step) {
    return step.kind == machine::StepChange::Kind::kRemoved;
  }));
}

}  // namespace
}  // namespace rmlcell::simulation
