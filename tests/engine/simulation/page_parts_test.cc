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

}  // namespace
}  // namespace rmlcell::simulation
