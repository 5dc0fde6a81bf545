// Parts of pages that only some programs have: tools seen in space, strokes along the surface, the
// machine of a difference, and that it is not whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "engine/simulation/picture/picture_difference.h"
#include "engine/simulation/picture/picture_page.h"
#include "engine/simulation/picture/picture_panel.h"
#include "engine/simulation/picture/picture_path.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"
#include "tests/engine/simulation/xml_check.h"

namespace rmlcell::simulation {
namespace {

void SketchWay(PathSketch& sketch, const motion::MachinePoint& from, const motion::MachinePoint& to,
               machine::MotionDone done) {
  motion::PlannedMotion planned;
  planned.path = LineFrom(from, to);
  done.motion = &planned;
  done.travelled = planned.path.length();
  sketch.Add(done);
}

// Seen along X, a millimetre a pixel: Y to the right and Z up, both from the middle of 400 by 300.
// What the group of the tools has in it.
std::string ToolsSeen(const PathSketch& sketch) {
  const machine::MachineShape shape = Laser();
  const Panel panel{.frame = FrameOf(PictureView::kDirection, {1.0, 0.0, 0.0}),
                    .rect = {.x = 0.0, .y = 0.0, .width = 400.0, .height = 300.0}};
  std::string page;
  DrawPanel({.sketch = sketch, .shape = shape, .elements_max = 1000}, panel, 1, page);
  const std::size_t begin = page.find("<g stroke=\"#0f8a5f\"");
  if (begin == std::string::npos) return {};
  return page.substr(begin, page.find("</g>", begin) - begin);
}

PathSketch CutsUpTo(int count) {
  PathSketch sketch(Laser(), 1000);
  for (int k = 0; k < count; ++k)
    SketchWay(sketch, {0.0, 1.0 * k, 0.0}, {0.0, 1.0 * k + 1.0, 0.0}, {.beam_on = true});
  return sketch;
}

// The head stands above the tip: 26 px upwards. What lies beside the panel has none.
TEST(PageParts, AToolPointsToItsHead) {
  PathSketch sketch = CutsUpTo(1);
  const std::string_view at_one = "<line x1=\"201\" y1=\"150\" x2=\"201\" y2=\"124\"/>";
  EXPECT_EQ(CountOf(ToolsSeen(sketch), at_one), 1u);
  SketchWay(sketch, {0, 1, 0}, {0, 500, 0}, {.beam_on = true});
  EXPECT_EQ(CountOf(ToolsSeen(sketch), at_one), 1u);
  EXPECT_EQ(CountOf(ToolsSeen(sketch), "<line"), 1u);
}

// Up to 120 tools each one is drawn, from then on each second one.
TEST(PageParts, ManyToolsAreThinned) {
  EXPECT_EQ(CountOf(ToolsSeen(CutsUpTo(120)), "<line"), 120u);
  EXPECT_EQ(CountOf(ToolsSeen(CutsUpTo(121)), "<line"), 61u);
}

// Their line in the legend is 44 px long and of their look; a pen has none, as all of its strokes
// are along the surface. The column begins 282 + 36 px before the end of 1600.
TEST(PageParts, TheLegendHasStrokesAlongTheSurfaceBesideCuts) {
  const machine::MotionDone cut{.use = machine::MotionUse::kCut};
  const machine::MotionDone stroke{.use = machine::MotionUse::kCut, .in_work = false};
  PathSketch sketch({}, 100);
  SketchWay(sketch, {0, 0, 0}, {100, 0, 0}, stroke);
  const std::string pen = PicturePage(sketch, {}, {}, {});
  EXPECT_EQ(CountOf(pen, "along the surface"), 0u);
  SketchWay(sketch, {0, 0, -1}, {100, 80, -1}, cut);
  const std::string page = PicturePage(sketch, {}, {}, {});
  EXPECT_EQ(XmlFault(page), "");
  const std::size_t named = page.find(">along the surface, not cut<");
  ASSERT_NE(named, std::string::npos);
  const std::size_t begin = page.rfind("<line", named);
  const std::string line = page.substr(begin, page.find('>', begin) - begin);
  EXPECT_EQ(CountOf(line, " x1=\"1282\" "), 1u) << line;
  EXPECT_EQ(CountOf(line, " x2=\"1326\" "), 1u) << line;
  EXPECT_EQ(CountOf(line, " class=\"skim\" "), 1u) << line;
}

// Beside cuts those strokes are drawn by themselves and have no part in the depths, here of 1 and 3
// mm; those of a pen are what it cuts.
TEST(PageParts, StrokesAlongTheSurfaceAreDrawnBesideTheCuts) {
  const machine::MotionDone cut{.use = machine::MotionUse::kCut};
  const machine::MotionDone stroke{.use = machine::MotionUse::kCut, .in_work = false};
  PathSketch sketch({}, 100);
  SketchWay(sketch, {0, 0, 0}, {100, 0, 0}, stroke);
  const std::string pen = PicturePage(sketch, {}, {}, {});
  EXPECT_EQ(CountOf(pen, "<path"), 1u);
  EXPECT_EQ(CountOf(pen, "<g class=\"skim\""), 0u);
  SketchWay(sketch, {0, 20, -1}, {100, 20, -1}, cut);
  SketchWay(sketch, {0, 40, -3}, {100, 40, -3}, cut);
  const std::string page = PicturePage(sketch, {}, {}, {});
  const std::size_t begin = page.find("<g class=\"skim\"");
  ASSERT_NE(begin, std::string::npos);
  EXPECT_EQ(CountOf(page.substr(begin, page.find("</g>", begin) - begin), "<path"), 1u);
  EXPECT_EQ(CountOf(page, "<path"), 3u);
  EXPECT_EQ(CountOf(page, ">cut, Z -1.00 to -3.00<"), 1u);
  for (const int shade : {0, kShades - 1}) {
    EXPECT_EQ(CountOf(page, std::string("<path stroke=\"") + kShadeColours[shade] + '"'), 1u)
        << shade;
  }
}

std::string DifferenceOn(const std::string& machine_name) {
  PathSketch sketch({}, 100);
  SketchWay(sketch, {0, 0, 0}, {100, 80, 0}, {.use = machine::MotionUse::kCut});
  return PictureOfDifference({sketch, "old.rml", {}}, {sketch, "new.rml", {}}, {}, {},
                             {.width_px = 720}, kPictureElementsMax, machine_name);
}

// Below both titles, as much of it as the page has room for between its margins of 36 px: a W is
// 0.944 of 12 px wide, and 1.12 times that in the widest font.
TEST(PageParts, ADifferenceNamesItsMachine) {
  const std::string begin = "<text x=\"36\" y=\"86\" font-size=\"12\" ";
  EXPECT_EQ(CountOf(DifferenceOn(""), begin), 0u);
  const std::string page = DifferenceOn("Mill of the workshop");
  EXPECT_EQ(CountOf(page, begin), 1u);
  EXPECT_EQ(CountOf(page, ">Mill of the workshop</text>"), 1u);
  const std::string wide = DifferenceOn(std::string(200, 'W'));
  const std::size_t at = wide.find(begin);
  ASSERT_NE(at, std::string::npos);
  const std::string shown = wide.substr(at, wide.find("</text>", at) - at);
  const auto width_px = 0.944 * 12.0 * 1.12 * static_cast<double>(std::ranges::count(shown, 'W'));
  EXPECT_TRUE(shown.ends_with("…")) << shown;
  EXPECT_LT(width_px, 720.0 - 2 * 36.0);
  EXPECT_GT(width_px, 720.0 - 2 * 36.0 - 45.0);  // the three points, and less than a letter
}

// 4,473 ways that all begin at one place, of each kind: 20,007,729 pairs are more than are looked
// at, and a few are not.
TEST(PageParts, ADifferenceOfTooManyPairsSaysSo) {
  const auto told = [](int count) {
    PathSketch cuts({}, 10'000), travel({}, 10'000);
    for (int k = 0; k < count; ++k) {
      const motion::MachinePoint to{100.0, 10.0 + 0.01 * k, 0.0};
      SketchWay(cuts, {}, to, {.use = machine::MotionUse::kCut});
      SketchWay(travel, {}, to, {.use = machine::MotionUse::kTravel});
    }
    return CountOf(PictureOfDifference({cuts, "a.rml", {}}, {travel, "b.rml", {}}, {}, {}, {}),
                   ">not all of the paths could be compared<");
  };
  EXPECT_EQ(told(10), 0u);
  EXPECT_EQ(told(4473), 1u);
}

// The last tag of its kind before a text of a page, without its end.
std::string TagBefore(const std::string& page, std::string_view tag, std::string_view text) {
  const std::size_t named = page.find(text);
  EXPECT_NE(named, std::string::npos) << text;
  const std::size_t begin = page.rfind(tag, named);
  return page.substr(begin, page.find('>', begin) - begin);
}

// The look of what was lost is 44 px long, too, and how much that is stands below its name, smaller
// and in its colour.
TEST(PageParts, TheLegendHasWhatWasLost) {
  PathSketch sketch({}, 100);
  SketchWay(sketch, {0, 0, 0}, {100, 80, 0}, {.use = machine::MotionUse::kCut});
  sketch.AddLost({.from = {100, 80, 0}, .to = {130, 80, 0}});
  const std::string page = PicturePage(sketch, {}, {}, {});
  const std::string line = TagBefore(page, "<line", ">beyond the travel, not cut<");
  EXPECT_EQ(CountOf(line, " x1=\"1282\" "), 1u) << line;
  EXPECT_EQ(CountOf(line, " x2=\"1326\" "), 1u) << line;
  EXPECT_EQ(CountOf(line, " class=\"lost\" "), 1u) << line;
  const std::string lost = TagBefore(page, "<text", ">30.000 mm lost<");
  EXPECT_EQ(CountOf(lost, " x=\"1340\" "), 1u) << lost;
  EXPECT_EQ(CountOf(lost, std::string(" font-size=\"12\" fill=\"") + kLostColour + '"'), 1u)
      << lost;
}

// Reasons, and how many more there are, stand 12 px within the column.
TEST(PageParts, ReasonsStandWithinTheColumn) {
  RunReport report;
  for (int k = 0; k < 6; ++k) {
    report.judgement.reasons.push_back({.code = ErrorCode::kCellGouge,
                                        .verdict = machine::Verdict::kBad,
                                        .said = "reason " + std::to_string(k)});
  }
  const std::string page = PicturePage(PathSketch({}, 10), {}, report, {});
  for (const char* text : {">reason 0<", ">and 2 more<"}) {
    const std::string tag = TagBefore(page, "<text", text);
    EXPECT_EQ(CountOf(tag, " x=\"1294\" "), 1u) << tag;
    EXPECT_EQ(CountOf(tag, " font-size=\"12\" "), 1u) << tag;
  }
}

// The machine and what was changed of it stand below the title, as far as 110 px before the margin
// of 36, where the time begins: 1418 px of 1600. A W is 0.944 of its size wide, and 1.12 times that
// in the widest font.
TEST(PageParts, AMachineLeavesRoomForTheTime) {
  const std::string wide(300, 'W');
  RunReport report;
  report.family = wide;
  report.machine.changes = {{wide, "1", "2"}};
  const std::string page = PicturePage(PathSketch({}, 10), {}, report, {});
  for (const auto& [tag, size] : {std::pair{"<text x=\"36\" y=\"70\" font-size=\"14\" ", 14.0},
                                  std::pair{"<text x=\"36\" y=\"86\" font-size=\"12\" ", 12.0}}) {
    const std::size_t at = page.find(tag);
    ASSERT_NE(at, std::string::npos) << tag;
    const std::string shown = page.substr(at, page.find("</text>", at) - at);
    const double width_px =
        0.944 * size * 1.12 * static_cast<double>(std::ranges::count(shown, 'W'));
    EXPECT_TRUE(shown.ends_with("…")) << shown;
    EXPECT_LT(width_px, 1418.0);
    EXPECT_GT(width_px, 1418.0 - 120.0);  // a word before it, the three points, part of a letter
  }
}

// Ground that differs by a hundredth of a millimetre is flat, and has no shades.
TEST(PageParts, ShadesBeginAtAHundredth) {
  const auto shaded = [](double depth_mm) {
    PathSketch sketch({}, 100);
    const machine::MotionDone cut{.use = machine::MotionUse::kCut};
    SketchWay(sketch, {0, 20, -1}, {100, 20, -1}, cut);
    SketchWay(sketch, {0, 40, -1.0 - depth_mm}, {100, 40, -1.0 - depth_mm}, cut);
    return CountOf(PicturePage(sketch, {}, {}, {}), ">cut, Z ");
  };
  EXPECT_EQ(shaded(0.005), 0u);
  EXPECT_EQ(shaded(0.015), 1u);
}

}  // namespace
}  // namespace rmlcell::simulation
