// How much of something a page, a trace or a tool takes: both sides of each number.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/picture/picture_difference.h"
#include "engine/simulation/picture/picture_path.h"
#include "engine/simulation/picture/picture_view.h"
#include "engine/simulation/picture/plot.h"
#include "engine/simulation/report/trace.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"

namespace rmlcell::simulation {
namespace {

std::size_t TimesIn(const std::string& page, const std::string& what) {
  std::size_t times = 0;
  for (std::size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1))
    ++times;
  return times;
}

// A line, pierced so many times.
PathSketch PiercedLine(int pierces) {
  PathSketch sketch(Laser(), 100);
  motion::PlannedMotion planned;
  planned.path = LineFrom({0, 0, 0}, {100, 80, 0});
  sketch.Add({.motion = &planned, .travelled = planned.path.length(), .beam_on = true});
  for (int k = 0; k < pierces; ++k) sketch.AddPierce();
  return sketch;
}

std::string DifferenceOf(const PathSketch& before, const PathSketch& after,
                         const PictureOptions& options, const std::string& title = "a.S",
                         const std::string& note = {}) {
  return PictureOfDifference({before, "old.S", {}}, {after, title, note}, {}, {}, options);
}

// Up to 1999 dots of a kind each one is drawn, from 2000 on each second one.
TEST(PageLimits, ThousandsOfDotsAreThinnedInADifference) {
  const auto drawn = [](int pierces) {
    const PathSketch sketch = PiercedLine(pierces);
    return TimesIn(DifferenceOf(sketch, sketch, {}), "<circle");
  };
  const std::size_t none = drawn(0);
  EXPECT_EQ(drawn(1), none + 1U);
  EXPECT_EQ(drawn(1999), none + 1999U);
  EXPECT_EQ(drawn(2000), none + 1000U);
  EXPECT_EQ(drawn(2001), none + 1001U);
}

// Not narrower than 720 px, nor wider than 8192.
TEST(PageLimits, ADifferenceHasItsWidth) {
  const PathSketch sketch = PiercedLine(0);
  for (const auto& [asked, made] : {std::pair{1, 720}, {720, 720}, {721, 721}, {9000, 8192}}) {
    PictureOptions options;
    options.width_px = asked;
    const std::string page = DifferenceOf(sketch, sketch, options);
    EXPECT_EQ(TimesIn(page, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
                                std::to_string(made) + "\" height="),
              1U)
        << asked;
  }
}

// Forty characters of a title stand before what is noted of it.
TEST(PageLimits, NotesBeginWithFortyCharacters) {
  const PathSketch sketch = PiercedLine(0);
  const std::string forty = "a-title-of-forty-characters-to-the-last0";
  ASSERT_EQ(forty.size(), 40U);
  EXPECT_EQ(TimesIn(DifferenceOf(sketch, sketch, {}, forty, "stopped"), ">" + forty + ": stopped<"),
            1U);
  EXPECT_EQ(TimesIn(DifferenceOf(sketch, sketch, {}, forty + "1", "stopped"),
                    ">" + forty + "…: stopped<"),
            1U);
}

// Eighty characters of a reason stand in the heading of a plot that is wide enough.
TEST(PageLimits, APlotTellsEightyCharactersOfItsReason) {
  const auto plotted = [](const std::string& said) {
    RunReport report;
    report.judgement.verdict = machine::Verdict::kBad;
    report.judgement.reasons.push_back(
        {.code = ErrorCode::kCellGouge, .verdict = machine::Verdict::kBad, .said = said});
    return PlotRecorder(Laser()).Svg(report, {.width_px = 4000});
  };
  const std::string eighty(80, 'i');
  EXPECT_EQ(TimesIn(plotted(eighty), ": " + eighty + "<"), 1U);
  EXPECT_EQ(TimesIn(plotted(eighty + "i"), ": " + eighty + "…<"), 1U);
}

// motion.md 8.2: six decimals of times, lengths and angles.
TEST(PageLimits, ATraceHasSixDecimals) {
  TraceRecord record;
  record.kind = TraceKind::kMove;
  record.at = SimTime(1'234'567'890);
  record.text = "LIN";
  record.tip = {{1.23456789, -2.00000049, 0.1234564}, 0.123456789, -1.00000051};
  record.program_point = motion::ProgramPoint::AsMachine({7.1234567, 0, 0});
  record.feed_mm_s = 33.33333333;
  EXPECT_EQ(TraceText(record),
            "1.234568 0/0 move LIN tip 1.234568 -2.0 0.123456 A 0.123457 B -1.000001 point "
            "7.123457 0.0 0.0 feed 33.333333");
  TraceRecord wait;
  wait.kind = TraceKind::kWait;
  wait.at = SimTime(2'000'000'499);
  wait.duration = SimTime(1'000'000'600);
  EXPECT_EQ(TraceText(wait), "2.000000 0/0 wait dwell 1.000001");
}

// A tool has a hundred edges at most.
TEST(PageLimits, AToolHasAHundredEdges) {
  const auto hundred = ParseTool("flat:3:flutes=100");
  ASSERT_TRUE(hundred) << hundred.error().detail;
  EXPECT_EQ(hundred->flutes, 100);
  EXPECT_FALSE(ParseTool("flat:3:flutes=101"));
  EXPECT_TRUE(ParseTool("flat:3:flutes=1"));
  EXPECT_FALSE(ParseTool("flat:3:flutes=0"));
  EXPECT_FALSE(ParseTool("flat:3:flutes=2.5"));
}

// A stroke has a thousand segments, and the next one goes on.
TEST(PageLimits, LongStrokesAreDivided) {
  const auto strokes = [](int segments) {
    PathSketch sketch({}, 10'000);
    const auto at = [](int k) {
      return motion::MachinePoint{-195.0 + 0.3 * k, k % 2 == 0 ? 20.0 : -20.0, 0};
    };
    for (int k = 0; k < segments; ++k) {
      motion::PlannedMotion planned;
      planned.path = LineFrom(at(k), at(k + 1));
      sketch.Add({.use = machine::MotionUse::kCut,
                  .motion = &planned,
                  .travelled = planned.path.length()});
    }
    const Panel panel{.frame = FrameOf(PictureView::kXY, {}), .rect = {-200, -150, 400, 300}};
    std::string out;
    EXPECT_EQ(DrawPath(sketch, panel, {}, 10'000, out), static_cast<std::size_t>(segments));
    return TimesIn(out, "<path");
  };
  EXPECT_EQ(strokes(999), 1U);
  EXPECT_EQ(strokes(1000), 1U);
  EXPECT_EQ(strokes(1001), 2U);
}

// Four thousand ways that were lost are kept as they are; of more so many that the whole is seen,
// and their lengths and their box are those of all.
TEST(PageLimits, LostWaysAreThinned) {
  PathSketch sketch({}, 100);
  for (int k = 0; k < 4000; ++k) {
    const double x = 3.0 * (k % 64), y = 3.0 * (k / 64);
    sketch.AddLost({.from = {x, y, 1}, .to = {x + 1, y + 2, 3}});
  }
  EXPECT_EQ(sketch.lost().size(), 4000U);
  EXPECT_NEAR(sketch.lost_mm(), 4000.0 * 3.0, 1e-6);
  sketch.AddLost({.from = {500, 400, 1}, .to = {500, 430, 41}});
  EXPECT_LE(sketch.lost().size(), 2000U);
  EXPECT_GE(sketch.lost().size(), 200U);
  EXPECT_NEAR(sketch.lost_mm(), 4000.0 * 3.0 + 50.0, 1e-6);
  EXPECT_EQ(sketch.lost_box().min, (motion::MachineVector{0, 0, 1}));
  EXPECT_EQ(sketch.lost_box().max, (motion::MachineVector{500, 430, 41}));
  for (const SketchElement& way : sketch.lost()) EXPECT_TRUE(way.lost);
  EXPECT_TRUE(sketch.elements().empty());
  sketch.AddLost({.from = {HUGE_VAL, 0, 0}, .to = {0, 0, 0}});
  sketch.AddLost({.from = {0, 0, 0}, .to = {0, NAN, 0}});
  EXPECT_NEAR(sketch.lost_mm(), 4000.0 * 3.0 + 50.0, 1e-6);
}

}  // namespace
}  // namespace rmlcell::simulation
