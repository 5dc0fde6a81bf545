#include "engine/simulation/toolpath/toolpath.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <string>

namespace rmlcell::simulation {
namespace {

ToolpathBlock SmallBlock() {
  ToolpathBlock block;
  block.points = {{1000, 0, -500}, {2000, 0, -500}, {2000, 300, -500}, {-7, 8, 9}, {-7, 8, 10}};
  block.runs = {{.program = 45,
                 .step = 12,
                 .use = machine::MotionUse::kCut,
                 .beam_on = true,
                 .speed_class = 3,
                 .start_us = 1'000'000,
                 .end_us = 1'250'000,
                 .first_point = 0,
                 .point_count = 3},
                {.program = 45,
                 .step = 13,
                 .use = machine::MotionUse::kPlunge,
                 .beam_on = false,
                 .speed_class = 0,
                 .start_us = 1'300'000,  // after a pause, and after a jump
                 .end_us = 1'300'001,
                 .first_point = 3,
                 .point_count = 2}};
  return block;
}

void ExpectEqual(const ToolpathBlock& a, const ToolpathBlock& b) {
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.runs, b.runs);
}

// docs/toolpath.md, byte by byte.
TEST(ToolpathBlock, BytesAreAsDocumented) {
  ToolpathBlock block;
  block.points = {{1, -1, 0}, {3, -1, 0}};
  block.runs = {{.program = 2,
                 .step = 5,
                 .use = machine::MotionUse::kCut,
                 .beam_on = true,
                 .speed_class = 4,
                 .start_us = 300,
                 .end_us = 310,
                 .first_point = 0,
                 .point_count = 2}};
  const std::string expected(
      "T\x01"          // magic, version
      "\x01\x02"       // one run, two points
      "\xAC\x02"       // start 300
      "\x02\x01\x00"   // (1, -1, 0)
      "\x6D"           // 1 cut + 4 beam + 8 joined + 32 no pause + 64 one point
      "\x04\x0A\x04"   // program +2, step +5, class 4
      "\x0A"           // 10 us
      "\x04\x00\x00",  // (+2, 0, 0)
      17);
  EXPECT_EQ(EncodeToolpathBlock(block), expected);
}

TEST(ToolpathBlock, ReadsBackWhatWasWritten) {
  const ToolpathBlock block = SmallBlock();
  const Result<ToolpathBlock> back = DecodeToolpathBlock(EncodeToolpathBlock(block));
  ASSERT_TRUE(back);
  ExpectEqual(*back, block);
}

TEST(ToolpathBlock, ReadsBackTheFullestBlockAndTheFarthestPoints) {
  ToolpathBlock block;
  constexpr std::int32_t kFar = 2'000'000'000;
  for (std::size_t k = 0; k < kToolpathBlockPoints; ++k) {
    block.points.push_back(k % 2 == 0 ? ToolpathPoint{kFar, -kFar, 0}
                                      : ToolpathPoint{-kFar, kFar, 1});
  }
  block.runs = {{.program = 99,
                 .step = std::numeric_limits<std::int32_t>::max(),
                 .speed_class = kSpeedClasses,
                 .start_us = 0,
                 .end_us = std::int64_t{1} << 50,
                 .first_point = 0,
                 .point_count = kToolpathBlockPoints}};
  const Result<ToolpathBlock> back = DecodeToolpathBlock(EncodeToolpathBlock(block));
  ASSERT_TRUE(back);
  ExpectEqual(*back, block);
}

// Hostile bytes: every cut of a good block is refused with CELL-E9027.
TEST(ToolpathBlock, TruncatedBytesAreRefused) {
  const std::string bytes = EncodeToolpathBlock(SmallBlock());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const Result<ToolpathBlock> back =
        DecodeToolpathBlock(std::string_view(bytes).substr(0, length));
    ASSERT_FALSE(back) << length;
    EXPECT_EQ(back.error().code, ErrorCode::kCellToolpathCorrupt);
  }
  EXPECT_FALSE(DecodeToolpathBlock(bytes + '\0'));
}

// Any change of bytes gives an error or a block within its bounds, and what is a block encodes to a
// block that is the same.
TEST(ToolpathBlock, ChangedBytesNeverBreakTheBounds) {
  const std::string good = EncodeToolpathBlock(SmallBlock());
  std::mt19937 random(20240601);  // NOLINT: fixed seed, so that a failure can be repeated
  int read = 0;
  for (int round = 0; round < 50'000; ++round) {
    std::string bytes = good;
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) {
      bytes[random() % bytes.size()] = static_cast<char>(random() & 0xFFu);
    }
    const Result<ToolpathBlock> block = DecodeToolpathBlock(bytes);
    if (!block) continue;
    ++read;
    ASSERT_LE(block->points.size(), kToolpathBlockPoints);
    for (const ToolpathRun& run : block->runs) {
      ASSERT_GE(run.point_count, 2u);
      ASSERT_LE(run.first_point + run.point_count, block->points.size());
      ASSERT_LE(run.start_us, run.end_us);
      ASSERT_LE(run.speed_class, kSpeedClasses);
    }
    if (block->runs.empty()) continue;
    const Result<ToolpathBlock> again = DecodeToolpathBlock(EncodeToolpathBlock(*block));
    ASSERT_TRUE(again);
    ExpectEqual(*again, *block);
  }
  EXPECT_GT(read, 100);
}

// Counts that promise more than a block holds are refused before anything is reserved.
TEST(ToolpathBlock, HugeCountsAreRefused) {
  const std::string runs = std::string("T\x01", 2) + std::string(9, '\xFF') + '\x01';
  EXPECT_FALSE(DecodeToolpathBlock(runs));
  const std::string points("T\x01\x01\x81\x20\x00\x00\x00\x00", 9);  // 4097 points
  EXPECT_FALSE(DecodeToolpathBlock(points));
}

}  // namespace
}  // namespace rmlcell::simulation
