// A toolpath at its levels of detail: by how much each may differ, and that none of it is left out
// (motion.md 9).
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine/simulation/toolpath/toolpath_writer.h"
#include "proto/bridge/framing.h"
#include "server/records/toolpath_levels.h"

namespace rmlcell::server {
namespace {

using simulation::ToolpathPoint;

// Goes from point to point of one run, a millisecond each.
std::string FramesThrough(const std::vector<ToolpathPoint>& points) {
  std::string frames;
  simulation::ToolpathWriter writer(1 << 30, [&frames](std::string_view block) {
    bridge::AddFrame(block, frames);
    return true;
  });
  writer.Open({.program = 1, .step = 1, .use = machine::MotionUse::kCut}, points.front());
  for (std::size_t i = 1; i < points.size(); ++i)
    writer.Add(points[i], 1000 * static_cast<std::int64_t>(i));
  writer.EndAt(1000 * static_cast<std::int64_t>(points.size() - 1));
  writer.Finish();
  return frames;
}

// Those of all blocks; one that ends a block and begins the next is one.
std::vector<ToolpathPoint> PointsOf(std::string_view frames) {
  std::vector<ToolpathPoint> points;
  while (const auto frame = bridge::TakeFrame(frames)) {
    const auto block = simulation::DecodeToolpathBlock(*frame);
    EXPECT_TRUE(block);
    if (!block) return points;
    for (const ToolpathPoint& point : block->points) {
      if (points.empty() || !(points.back() == point)) points.push_back(point);
    }
  }
  return points;
}

// Kept to 0.01 mm a corner of 0.5 mm is seen at level 1, to 0.08 mm, and not at level 2, to
// 0.64 mm; one of 100 mm not at level 5, to 328 mm, and at level 4.
TEST(LevelsOfPaths, EachIsEightTimesAsCoarse) {
  const auto corners_at = [](int height_um, int level) {
    const std::string frames =
        FramesThrough({{0, 0, 0}, {10'000'000, height_um, 0}, {20'000'000, 0, 0}});
    return PointsOf(ToolpathAtLevel(frames, 0.01, level)).size() - 2;
  };
  EXPECT_EQ(corners_at(500, 0), 1U);
  EXPECT_EQ(corners_at(500, 1), 1U);
  EXPECT_EQ(corners_at(500, 2), 0U);
  // What is kept is off by 0.01 mm already: 0.07 mm are left of the 0.08 mm of level 1.
  EXPECT_EQ(corners_at(75, 1), 1U);
  EXPECT_EQ(corners_at(65, 1), 0U);
  EXPECT_EQ(corners_at(100'000, 4), 1U);
  EXPECT_EQ(corners_at(100'000, 5), 0U);
}

// Level 0 is what is kept, to the last byte: nothing is joined that was told apart.
TEST(LevelsOfPaths, TheFinestIsAsItIsKept) {
  const std::string frames = FramesThrough({{0, 0, 0}, {1'000, 0, 0}, {2'000, 0, 0}});
  EXPECT_EQ(ToolpathAtLevel(frames, 0.01, 0), frames);
  EXPECT_EQ(PointsOf(ToolpathAtLevel(frames, 0.01, 1)).size(), 2U);
}

// Each level is told with the bytes that it has.
TEST(LevelsOfPaths, EachIsAsLargeAsItIsTold) {
  const std::string frames = FramesThrough({{0, 0, 0}, {10'000'000, 65, 0}, {20'000'000, 0, 0}});
  v1::ToolpathHeader header;
  AddLevels(frames, 0.01, header);
  ASSERT_GT(header.levels_size(), 1);
  EXPECT_EQ(header.levels(0).bytes(), static_cast<std::int64_t>(frames.size()));
  EXPECT_LT(header.levels(1).bytes(), header.levels(0).bytes());
  for (const v1::ToolpathLevel& one : header.levels()) {
    const std::size_t bytes = ToolpathAtLevel(frames, 0.01, one.level()).size();
    EXPECT_EQ(one.bytes(), static_cast<std::int64_t>(bytes)) << one.level();
  }
}

// Of a path of several blocks none is left out.
TEST(LevelsOfPaths, AllBlocksAreThere) {
  std::vector<ToolpathPoint> points;
  for (int i = 0; i < 3 * static_cast<int>(simulation::kToolpathBlockPoints); ++i)
    points.push_back({i * 1'000, i % 2 * 1'000'000, 0});
  const std::string frames = FramesThrough(points);
  EXPECT_EQ(PointsOf(frames), points);
  EXPECT_EQ(PointsOf(ToolpathAtLevel(frames, 0.01, 1)), points);
}

// A path ends where it is damaged: what stands before is told at each level.
TEST(LevelsOfPaths, EndsWhereItIsDamaged) {
  const std::vector<ToolpathPoint> points = {{0, 0, 0}, {10'000'000, 0, 0}};
  const std::string whole = FramesThrough(points);
  std::string damaged = whole;
  bridge::AddFrame("no block", damaged);
  EXPECT_EQ(ToolpathAtLevel(damaged + whole, 0.01, 1), ToolpathAtLevel(whole, 0.01, 1));
  EXPECT_EQ(PointsOf(ToolpathAtLevel(damaged, 0.01, 1)), points);
}

}  // namespace
}  // namespace rmlcell::server
