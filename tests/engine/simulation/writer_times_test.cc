// Each point of a toolpath keeps its time, over runs that went nowhere and over full blocks.
#include <gtest/gtest.h>

#include <vector>

#include "engine/simulation/toolpath/toolpath_writer.h"

namespace rmlcell::simulation {
namespace {

class WriterTimes : public testing::Test {
 protected:
  ToolpathWriter Writer(std::size_t blocks_max = 99) {
    return ToolpathWriter(1 << 24, [this, blocks_max](std::string_view bytes) {
      const auto block = DecodeToolpathBlock(bytes);
      EXPECT_TRUE(block);
      if (block) blocks_.push_back(*block);
      return blocks_.size() < blocks_max;
    });
  }
  std::vector<ToolpathBlock> blocks_;
};

TEST_F(WriterTimes, ARunThatWentNowhereTakesItsTimeAlong) {
  ToolpathWriter writer = Writer();
  writer.Open({.step = 1, .start_us = 0}, {0, 0, 0});
  writer.Open({.step = 2, .start_us = 100'000}, {50, 0, 0});
  writer.Add({60, 0, 0}, 110'000);
  writer.Add({70, 0, 0}, 400'000);
  writer.EndAt(500'000);
  writer.Open({.step = 3, .start_us = 600'000}, {900, 0, 0});
  writer.Open({.step = 4, .start_us = 700'000}, {800, 0, 0});
  writer.Add({810, 0, 0}, 720'000);
  writer.Add({820, 0, 0}, 900'000);
  writer.EndAt(900'000);
  writer.Finish();
  ASSERT_EQ(blocks_.size(), 1u);
  ASSERT_EQ(blocks_[0].runs.size(), 2u);
  EXPECT_EQ(blocks_[0].runs[0].step, 2);
  EXPECT_EQ(blocks_[0].runs[0].end_us, 500'000);
  EXPECT_EQ(blocks_[0].runs[1].step, 4);
  EXPECT_EQ(blocks_[0].points.size(), 6u);
  EXPECT_EQ(blocks_[0].reached_us,
            (std::vector<std::int64_t>{100'000, 110'000, 500'000, 700'000, 720'000, 900'000}));
}

// A block that is full goes on in the next one, whose times are its own.
TEST_F(WriterTimes, AFullBlockGoesOnInTheNextOne) {
  ToolpathWriter writer = Writer();
  const auto at_us = [](int k) { return std::int64_t{k} * 10'000 + (k % 3 == 0 ? 4'000 : 0); };
  const int count = static_cast<int>(kToolpathBlockPoints) + 50;
  writer.Open({.step = 1}, {0, 0, 0});
  for (int k = 1; k <= count; ++k) {
    const bool went_on = writer.Add({10 * k, 0, 0}, at_us(k));
    EXPECT_EQ(went_on, k + 1 == static_cast<int>(kToolpathBlockPoints)) << k;
  }
  EXPECT_EQ(writer.blocks(), 1u);
  writer.EndAt(at_us(count));
  writer.Finish();
  EXPECT_EQ(writer.blocks(), 2u);
  ASSERT_EQ(blocks_.size(), 2u);
  ASSERT_EQ(blocks_[0].points.size(), kToolpathBlockPoints);
  ASSERT_EQ(blocks_[1].points.size(), 52u);
  EXPECT_EQ(blocks_[0].runs[0].end_us, blocks_[1].runs[0].start_us);
  const int first = static_cast<int>(kToolpathBlockPoints) - 1;
  for (int k = 0; k < 52; ++k) {
    EXPECT_EQ(blocks_[1].points[static_cast<std::size_t>(k)].x_um, 10 * (first + k));
    EXPECT_EQ(blocks_[1].reached_us[static_cast<std::size_t>(k)], at_us(first + k)) << k;
  }
}

// Who wants no more is told no more, whatever comes; and nothing of it counts.
TEST_F(WriterTimes, NothingIsToldToWhoWantsNoMore) {
  ToolpathWriter writer = Writer(1);
  const int count = static_cast<int>(kToolpathBlockPoints);
  writer.Open({.step = 1}, {0, 0, 0});
  for (int k = 1; k < count; ++k) EXPECT_FALSE(writer.Add({k, 0, 0}, k)) << k;
  EXPECT_TRUE(writer.closed());
  EXPECT_FALSE(writer.open());
  writer.EndAt(99'999);
  writer.Finish();
  EXPECT_EQ(blocks_.size(), 1u);
  EXPECT_EQ(writer.blocks(), 0u);
  EXPECT_EQ(writer.bytes(), 0u);
}

}  // namespace
}  // namespace rmlcell::simulation
