#include "engine/simulation/material/move_batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/engine/simulation/thread_for.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;

constexpr Stock kBatchBlock{.x_max = 60.0, .y_max = 60.0, .bottom = -20.0, .top = 0.0, .cell = 0.1};

struct BatchMove {
  MachinePoint from;
  MachinePoint to;
};

// Level, sloped, straight down, beside the block and above it.
std::vector<BatchMove> BatchMoves() {
  std::mt19937_64 random(1);  // NOLINT: the same every time
  std::uniform_real_distribution<double> place(-8.0, 68.0), height(-21.0, 3.0);
  std::vector<BatchMove> moves;
  for (MachinePoint at{0, 0, 5}; moves.size() < 60;) {
    MachinePoint to{place(random), place(random), height(random)};
    if (moves.size() % 5 == 1) to.z() = at.z();
    if (moves.size() % 7 == 2) to = {at.x(), at.y(), to.z()};
    moves.push_back({at, to});
    at = to;
  }
  return moves;
}

struct LeftByMoves {
  std::vector<float> heights;
  std::vector<double> most;
  std::vector<double> shank;

  bool operator==(const LeftByMoves&) const = default;
};

LeftByMoves OneByOne(const MillTool& tool) {
  HeightField field = HeightField::Of(kBatchBlock).value();
  LeftByMoves left;
  for (const BatchMove& move : BatchMoves()) {
    left.shank.push_back(field.ShankDepthOf(tool, move.from, move.to));
    left.most.push_back(field.Cut(tool, move.from, move.to));
  }
  left.heights = field.heights();
  return left;
}

LeftByMoves ByBatches(const MillTool& tool, ParallelFor& parallel) {
  HeightField field = HeightField::Of(kBatchBlock).value();
  MoveBatch batch(field, tool);
  LeftByMoves left;
  const auto cut = [&] {
    for (const MoveBatch::Taken& taken : batch.Cut(field, parallel)) {
      left.most.push_back(taken.most_mm);
      left.shank.push_back(taken.shank_depth_mm);
    }
  };
  for (const BatchMove& move : BatchMoves()) {
    batch.Add(move.from, move.to);
    if (batch.full()) cut();
  }
  cut();
  left.heights = field.heights();
  return left;
}

MillTool ToolWithHolder(MillTool::Shape shape) {
  return {.shape = shape,
          .radius_mm = 6.0,
          .half_angle_rad = 0.5,
          .tip_radius_mm = 0.2,
          .flute_mm = 12.0,
          .shank_radius_mm = 8.0,
          .holder_radius_mm = 15.0,
          .holder_from_mm = 15.0};
}

// Row by row the same moves come in the same order: no bit depends on how many threads there are.
TEST(MoveBatch, ThreadsChangeNoBit) {
  using Shape = MillTool::Shape;
  for (const Shape shape : {Shape::kFlat, Shape::kBall, Shape::kVee}) {
    const MillTool tool = ToolWithHolder(shape);
    const LeftByMoves alone = OneByOne(tool);
    EXPECT_GT(*std::ranges::max_element(alone.shank), 1.0);
    SerialFor serial;
    EXPECT_TRUE(ByBatches(tool, serial) == alone);
    for (const std::size_t width : {2u, 3u, 8u}) {
      ThreadFor threads(width);
      EXPECT_TRUE(ByBatches(tool, threads) == alone) << width << " threads";
      EXPECT_EQ(threads.most(), width);
    }
  }
}

// Two slots far apart, each in the rows of one thread: what each takes off is told, whoever cut it.
TEST(MoveBatch, TellsTheMostOfAllRows) {
  HeightField field = HeightField::Of(kBatchBlock).value();
  MoveBatch batch(field, {.radius_mm = 1.5});
  ThreadFor threads(2);
  for (int k = 0; k < 200; ++k) {
    batch.Add({5, 10, -2}, {55, 10, -2});
    batch.Add({5, 50, -3}, {55, 50, -3});
  }
  const auto taken = batch.Cut(field, threads);
  ASSERT_EQ(threads.most(), 2u);
  ASSERT_EQ(taken.size(), 400u);
  EXPECT_EQ(taken[0].most_mm, 2.0);
  EXPECT_EQ(taken[1].most_mm, 3.0);
  EXPECT_EQ(taken[2].most_mm, 0.0);
  EXPECT_EQ(taken[399].most_mm, 0.0);
  EXPECT_EQ(field.height(300, 100), -2.0f);
  EXPECT_EQ(field.height(300, 500), -3.0f);
}

// Threads have about as much work each, wherever the moves are: three cuts in rows behind those of
// the first, which the first half of the work ends in the second of.
TEST(MoveBatch, ThreadsHaveAboutAsMuchEach) {
  class Halves final : public ParallelFor {
   public:
    explicit Halves(const HeightField& field) : field_(field) {}
    std::size_t width() const override { return 2; }
    void Run(std::size_t count, const std::function<void(std::size_t)>& piece) override {
      for (std::size_t k = 0; k < count; ++k) {
        piece(k);
        const auto& heights = field_.heights();
        cut.push_back(std::ranges::count_if(heights, [](float height) { return height < 0.0F; }));
      }
    }
    std::vector<std::ptrdiff_t> cut;  // cells, after each piece

   private:
    const HeightField& field_;
  };
  HeightField field = HeightField::Of(kBatchBlock).value();
  MoveBatch batch(field, {.radius_mm = 3.5});
  for (const double y : {5.0, 30.0, 40.0, 50.0}) batch.Add({5, y, -1}, {55, y, -1});
  Halves halves(field);
  batch.Cut(field, halves);
  ASSERT_EQ(halves.cut.size(), 2U);
  const double share = static_cast<double>(halves.cut[0]) / static_cast<double>(halves.cut[1]);
  EXPECT_NEAR(share, 0.5, 0.05);
}

// A batch is handed over when there is work of some milliseconds: a million cells, or thousands of
// moves. Each of these comes over 60 x 120 cells and a disc of 11,310.
TEST(MoveBatch, IsFullWithAMillionCells) {
  HeightField field = HeightField::Of(kBatchBlock).value();
  MoveBatch batch(field, {.radius_mm = 6.0});
  for (int k = 0; k < 56; ++k) batch.Add({27, 30, -1}, {33, 30, -1});
  EXPECT_FALSE(batch.full());
  batch.Add({27, 30, -1}, {33, 30, -1});
  EXPECT_TRUE(batch.full());
  SerialFor serial;
  EXPECT_EQ(batch.Cut(field, serial).size(), 57u);
  EXPECT_FALSE(batch.full());
  EXPECT_EQ(batch.Cut(field, serial).size(), 0u);
}

// Moves beside the block, or not below its top, are over in no time: thousands of them are as many
// as are kept.
TEST(MoveBatch, IsFullWithThousandsOfMoves) {
  HeightField field = HeightField::Of(kBatchBlock).value();
  MoveBatch batch(field, {.radius_mm = 6.0});
  for (int k = 0; k < 4095; ++k) {
    const double y = k % 3 == 0 ? -9.0 : k % 3 == 1 ? 69.0 : 30.0;
    const double z = k % 3 == 2 ? 0.0 : -1.0;
    batch.Add({0, y, z}, {60, y, z});
  }
  EXPECT_FALSE(batch.full());
  batch.Add({0, -9, -1}, {60, -9, -1});
  EXPECT_TRUE(batch.full());
  ThreadFor threads(2);
  const auto taken = batch.Cut(field, threads);
  EXPECT_EQ(taken.size(), 4096u);
  for (const MoveBatch::Taken& of_move : taken) ASSERT_EQ(of_move.most_mm, 0.0);
  EXPECT_EQ(field.removed_mm3(), 0.0);
}

}  // namespace
}  // namespace rmlcell::simulation
