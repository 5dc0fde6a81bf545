#include "engine/simulation/toolpath/toolpath_writer.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rmlcell::simulation {
namespace {

class ToolpathWriterTest : public testing::Test {
 protected:
  ToolpathWriter Writer(std::uint64_t bytes_max = 1 << 20) {
    return ToolpathWriter(bytes_max, [this](std::string_view bytes) {
      sizes_.push_back(bytes.size());
      blocks_.push_back(DecodeToolpathBlock(bytes).value());
      return true;
    });
  }
  // Points of a zigzag, the first of a run excepted, one a microsecond.
  static void Fill(ToolpathWriter& writer, int count) {
    for (int k = 1; k <= count; ++k) writer.Add({k, k % 2, 0}, k);
  }

  std::vector<std::size_t> sizes_;
  std::vector<ToolpathBlock> blocks_;
};

// Two runs that begin at places of their own, one that goes on from there.
TEST_F(ToolpathWriterTest, RunsShareThePointWhereTheyMeet) {
  ToolpathWriter writer = Writer();
  writer.Open({.step = 1, .start_us = 5}, {0, 0, 0});
  writer.Add({10, 0, 0}, 7);
  writer.EndAt(9);
  writer.Open({.step = 2, .start_us = 9}, {10, 0, 0});
  writer.Add({20, 0, 0}, 11);
  writer.EndAt(11);
  writer.Open({.step = 3, .start_us = 20}, {0, 50, 0});
  writer.Add({0, 60, 0}, 30);
  writer.EndAt(30);
  EXPECT_TRUE(blocks_.empty());
  writer.Finish();
  ASSERT_EQ(blocks_.size(), 1u);
  const ToolpathBlock& block = blocks_[0];
  EXPECT_EQ(block.points, (std::vector<ToolpathPoint>{
                              {0, 0, 0}, {10, 0, 0}, {20, 0, 0}, {0, 50, 0}, {0, 60, 0}}));
  EXPECT_EQ(block.reached_us, (std::vector<std::int64_t>{5, 9, 11, 20, 30}));
  ASSERT_EQ(block.runs.size(), 3u);
  EXPECT_EQ(block.runs[1].first_point, 1u);
  EXPECT_EQ(block.runs[2].first_point, 3u);
  EXPECT_EQ(writer.points(), 5u);
  EXPECT_EQ(writer.bytes(), sizes_[0]);
}

// A run that was opened and went nowhere is taken back: with its point, where that is its own.
TEST_F(ToolpathWriterTest, ARunThatGoesNowhereIsNone) {
  ToolpathWriter writer = Writer();
  writer.Open({.step = 1}, {0, 0, 0});
  writer.Add({10, 0, 0}, 7);
  writer.EndAt(7);
  writer.Open({.step = 2, .start_us = 7}, {50, 0, 0});
  writer.Open({.step = 3, .start_us = 7}, {10, 0, 0});
  writer.Open({.step = 4, .start_us = 7}, {10, 0, 0});
  writer.Add({20, 0, 0}, 9);
  writer.EndAt(9);
  writer.Open({.step = 5, .start_us = 9}, {20, 0, 0});
  const ToolpathBlock open = DecodeToolpathBlock(writer.OpenBlock()).value();
  writer.Finish();
  ASSERT_EQ(blocks_.size(), 1u);
  for (const ToolpathBlock& block : {open, blocks_[0]}) {
    EXPECT_EQ(block.points, (std::vector<ToolpathPoint>{{0, 0, 0}, {10, 0, 0}, {20, 0, 0}}));
    EXPECT_EQ(block.reached_us, (std::vector<std::int64_t>{0, 7, 9}));
    ASSERT_EQ(block.runs.size(), 2u);
    EXPECT_EQ(block.runs[0].step, 1);
    EXPECT_EQ(block.runs[1].step, 4);
  }
}

TEST_F(ToolpathWriterTest, NothingIsNoBlock) {
  ToolpathWriter writer = Writer();
  writer.EndAt(5);  // there is no run that could end
  writer.Finish();
  writer.Open({}, {0, 0, 0});
  EXPECT_EQ(writer.OpenBlock(), "");
  writer.Finish();
  EXPECT_TRUE(blocks_.empty());
  EXPECT_EQ(writer.bytes(), 0u);
}

// A run needs room for two points: with 4094 there another one fits, and fills the block.
TEST_F(ToolpathWriterTest, TheLastTwoPlacesOfABlockAreARun) {
  ToolpathWriter writer = Writer();
  writer.Open({.step = 1}, {0, 0, 0});
  Fill(writer, 4093);
  writer.EndAt(4093);
  writer.Open({.step = 2, .start_us = 4093}, {0, 0, 7});
  EXPECT_TRUE(blocks_.empty());
  EXPECT_TRUE(writer.Add({0, 0, 9}, 4095));
  ASSERT_EQ(blocks_.size(), 1u);
  EXPECT_EQ(blocks_[0].points.size(), kToolpathBlockPoints);
  EXPECT_EQ(blocks_[0].runs.size(), 2u);
  EXPECT_EQ(blocks_[0].runs[1].end_us, 4095);
  // The run goes on where the block ended.
  EXPECT_FALSE(writer.Add({0, 0, 12}, 4099));
  writer.EndAt(4100);
  writer.Finish();
  ASSERT_EQ(blocks_.size(), 2u);
  EXPECT_EQ(blocks_[1].points, (std::vector<ToolpathPoint>{{0, 0, 9}, {0, 0, 12}}));
  EXPECT_EQ(blocks_[1].reached_us, (std::vector<std::int64_t>{4095, 4100}));
  EXPECT_EQ(blocks_[1].runs[0].step, 2);
  EXPECT_EQ(blocks_[1].runs[0].start_us, 4095);
}

TEST_F(ToolpathWriterTest, WithOnePlaceLeftARunBeginsTheNextBlock) {
  ToolpathWriter writer = Writer();
  writer.Open({.step = 1}, {0, 0, 0});
  Fill(writer, 4094);
  writer.EndAt(4094);
  writer.Open({.step = 2, .start_us = 4094}, {0, 0, 7});
  ASSERT_EQ(blocks_.size(), 1u);
  EXPECT_EQ(blocks_[0].points.size(), 4095u);
  EXPECT_EQ(blocks_[0].runs.size(), 1u);
  writer.Add({0, 0, 9}, 4095);
  writer.EndAt(4095);
  writer.Finish();
  ASSERT_EQ(blocks_.size(), 2u);
  EXPECT_EQ(blocks_[1].points, (std::vector<ToolpathPoint>{{0, 0, 7}, {0, 0, 9}}));
}

// A budget that is used to the last byte is kept; one byte less, and the block is left out.
TEST_F(ToolpathWriterTest, TheBudgetIsExact) {
  const auto write = [](ToolpathWriter& writer) {
    writer.Open({.step = 1}, {0, 0, 0});
    writer.Add({10, 0, 0}, 7);
    writer.EndAt(7);
    writer.Finish();
  };
  ToolpathWriter free = Writer();
  write(free);
  const std::uint64_t size = sizes_.at(0);
  ToolpathWriter exact = Writer(size);
  write(exact);
  EXPECT_FALSE(exact.closed());
  EXPECT_EQ(exact.bytes(), size);
  EXPECT_EQ(blocks_.size(), 2u);
  ToolpathWriter tight = Writer(size - 1);
  write(tight);
  EXPECT_TRUE(tight.closed());
  EXPECT_EQ(tight.bytes(), 0u);
  EXPECT_EQ(blocks_.size(), 2u);
  tight.EndAt(9);  // nothing more comes of it
  tight.Finish();
  EXPECT_EQ(blocks_.size(), 2u);
}

}  // namespace
}  // namespace rmlcell::simulation
