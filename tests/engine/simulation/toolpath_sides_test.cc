// What a toolpath tells of runs that fill a block, of motions of the axes, of angles that no axis
// has, and of ways in each direction. docs/toolpath.md.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/units.h"
#include "engine/simulation/toolpath/toolpath_recorder.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/laser_shape.h"

namespace rmlcell::simulation {
namespace {

using motion::PathPiece;

std::vector<ToolpathBlock> ToolpathBlocksOf(const Script& script) {
  std::vector<ToolpathBlock> blocks;
  ToolpathRecorder recorder(Laser(), {}, [&](std::string_view bytes) {
    auto block = DecodeToolpathBlock(bytes);
    EXPECT_TRUE(block);
    if (block) blocks.push_back(*std::move(block));
    return true;
  });
  FakeRun run(script, recorder);
  run.Advance(kForever);
  recorder.Finish();
  return blocks;
}

// Angles beyond 32 bits of microradians do not come out on the other side.
TEST(ToolpathSides, AnglesThatNoAxisHasDoNotOverflow) {
  Script script;
  script.Step(1, 1).Motion(
      Planned(PathPiece::Line({{0, 0, 0}, -1e30, 1e30}, {{10, 0, 0}, 1e30, -1e30})));
  const std::vector<ToolpathBlock> blocks = ToolpathBlocksOf(script);
  ASSERT_EQ(blocks.size(), 1U);
  ASSERT_EQ(blocks[0].points.size(), 2U);
  constexpr std::int32_t kFar_urad = 1'000'000'000;
  EXPECT_LT(blocks[0].points[0].a_urad, -kFar_urad);
  EXPECT_GT(blocks[0].points[0].b_urad, kFar_urad);
  EXPECT_GT(blocks[0].points[1].a_urad, kFar_urad);
  EXPECT_LT(blocks[0].points[1].b_urad, -kFar_urad);
}

// The highest speed of a run is also that of the motion whose point fills the block: 300 of 500
// mm/s behind ways at 5 mm/s.
TEST(ToolpathSides, TheMotionThatFillsABlockHasItsSpeed) {
  const motion::PathLimits slow{.speed = 5.0, .acceleration = 1e6};
  const motion::PathLimits fast{.speed = 300.0, .acceleration = 1e6};
  Script script;
  script.Step(1, 1);
  motion::MachinePoint at;
  const int ways = static_cast<int>(kToolpathBlockPoints) - 1;
  for (int k = 1; k <= ways; ++k) {
    const motion::MachinePoint next{1.0 * k, k % 2 * 1.0, 0};
    script.Motion(Planned(LineFrom(at, next), k < ways ? slow : fast));
    at = next;
  }
  const std::vector<ToolpathBlock> blocks = ToolpathBlocksOf(script);
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_EQ(blocks[0].points.size(), kToolpathBlockPoints);
  ASSERT_EQ(blocks[0].runs.size(), 1U);
  EXPECT_EQ(blocks[0].runs[0].reached_class, 12);
}

// Who wants no more is told no more, also in the middle of a motion with points for three blocks.
TEST(ToolpathSides, AnArcEndsWhereNobodyWantsMore) {
  const PathPiece circle =
      PathPiece::Circle({{20'000, 0, 0}}, {0, 0, 0}, {0, 0, 1}, kTurn, 0.0, 0.0);
  int offered = 0;
  ToolpathRecorder recorder(Laser(), {.tolerance_mm = 0.001}, [&](std::string_view) {
    ++offered;
    return false;
  });
  FakeRun run(Script().Step(1, 1).Motion(Planned(circle)), recorder);
  run.Advance(kForever);
  recorder.Finish();
  EXPECT_EQ(offered, 1);
  EXPECT_FALSE(recorder.complete());
  EXPECT_EQ(recorder.points(), kToolpathBlockPoints);
  EXPECT_EQ(recorder.OpenBlock(), "");
}

// Of a motion of the axes, and of a head that turns about a standing tip, the speed of the tip is
// not known: the power is that of no speed.
TEST(ToolpathSides, OfMotionsOfTheAxesNoSpeedIsKnown) {
  const machine::PowerBySpeed power{.constant_percent = 50.0, .percent_per_mm_s = 10.0};
  for (const PathPiece& path : {PathPiece::Joint({{0, 0, 300}, 0.0, 0.0}, {{10, 0, 300}, 0.0, 0.5}),
                                PathPiece::Line({{0, 0, 0}, 0.0, 0.0}, {{0, 0, 0}, 0.5, 0.0})}) {
    Script script;
    script.Step(1, 1).Motion(Planned(path, {.speed = 1.0, .acceleration = 10.0}, 0.0,
                                     motion::GantryHead{.length_mm = 300.0}),
                             {.beam_on = true, .power = power});
    const std::vector<ToolpathBlock> blocks = ToolpathBlocksOf(script);
    ASSERT_EQ(blocks.size(), 1U);
    EXPECT_EQ(blocks[0].runs.at(0).reached_class, 0);
    EXPECT_EQ(blocks[0].runs.at(0).power_class, 10);
  }
}

// The bytes of one run, whose points are reached at these times.
std::string BytesOfWay(std::vector<ToolpathPoint> points, std::vector<std::int64_t> reached_us) {
  ToolpathBlock block;
  block.points = std::move(points);
  block.reached_us = std::move(reached_us);
  block.runs = {{.start_us = block.reached_us.front(),
                 .end_us = block.reached_us.back(),
                 .point_count = static_cast<std::uint32_t>(block.points.size())}};
  return EncodeToolpathBlock(block);
}

// A quarter of the way at a quarter of the time need not be told, whichever axis goes first; half
// of the time has to be.
TEST(ToolpathSides, TheWayTellsTheTimeAlongEachAxis) {
  const std::vector<std::int64_t> even{10'000, 20'000, 50'000};
  const std::string x = BytesOfWay({{4000, 0, 0}, {5000, 0, 0}, {5000, 3000, 0}}, even);
  const std::string y = BytesOfWay({{0, 4000, 0}, {0, 5000, 0}, {0, 5000, 3000}}, even);
  const std::string z = BytesOfWay({{0, 0, 4000}, {0, 0, 5000}, {3000, 0, 5000}}, even);
  EXPECT_EQ(y.size(), x.size());
  EXPECT_EQ(z.size(), x.size());
  const std::string late =
      BytesOfWay({{0, 0, 4000}, {0, 0, 5000}, {3000, 0, 5000}}, {10'000, 30'000, 50'000});
  EXPECT_GT(late.size(), z.size());
  for (const std::string& bytes : {x, y, z}) {
    const auto back = DecodeToolpathBlock(bytes);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->reached_us, even);
  }
}

// A micrometre is a way as two are: behind it the tip stands, and is there at the end.
TEST(ToolpathSides, AMicrometreIsAWay) {
  const std::vector<std::int64_t> times{0, 90'000, 90'000};
  const std::string one = BytesOfWay({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, times);
  const std::string two = BytesOfWay({{0, 0, 0}, {2, 0, 0}, {2, 0, 0}}, times);
  EXPECT_EQ(one.size(), two.size());
  const auto back = DecodeToolpathBlock(one);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->reached_us, times);
}

}  // namespace
}  // namespace rmlcell::simulation
