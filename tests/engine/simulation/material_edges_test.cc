// Blocks, targets and their files at their edges.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/simulation/material/cell_picture.h"
#include "engine/simulation/material/chip_load.h"
#include "engine/simulation/material/height_tiles.h"
#include "engine/simulation/material/target_files.h"
#include "engine/simulation/path/motion_peaks.h"
#include "engine/simulation/report/move_speeds.h"
#include "tests/engine/simulation/fake_run.h"
#include "tests/engine/simulation/png_picture.h"
#include "tests/engine/simulation/shape_of.h"

namespace rmlcell::simulation {
namespace {

Stock CellsOf(double columns, double rows) {
  return {.x_max = columns, .y_max = rows, .bottom = -5.0, .top = 0.0, .cell = 1.0};
}

template <class Write>
std::string BytesOf(Write write) {
  std::string bytes;
  EXPECT_TRUE(write([&](std::string_view part) {
    bytes += part;
    return true;
  }));
  return bytes;
}

// As many columns as a picture has at most are a pixel each; one more, and four cells are one.
TEST(MaterialEdges, APixelIsACellAsLongAsTheyFit) {
  constexpr double kMost{kPicturePixelsMax};
  const auto picture = [](double columns, double rows) {
    const HeightField field = HeightField::Of(CellsOf(columns, rows)).value();
    const auto colour = [](std::size_t column, std::size_t row) {
      const int value = static_cast<int>(10 * (column % 2) + 23 * row);
      return Colour{value, 7, 9};
    };
    return PngPicture(
        BytesOf([&](const auto& sink) { return WriteCellPicture(field, colour, sink); }));
  };
  const PngPicture all = picture(kMost, 2.0);
  EXPECT_EQ(all.width, kPicturePixelsMax);
  EXPECT_EQ(all.height, 2u);
  EXPECT_EQ(all.At(0, 1), (Rgb{0, 7, 9}));
  EXPECT_EQ(all.At(1, 0), (Rgb{33, 7, 9}));
  const PngPicture half = picture(kMost + 2.0, 2.0);
  EXPECT_EQ(half.width, kPicturePixelsMax / 2 + 1);
  EXPECT_EQ(half.height, 1u);
  EXPECT_EQ(half.At(5, 0), (Rgb{17, 7, 9}));  // of 0, 10, 23 and 33, 16.5
  const PngPicture three = picture(kMost + 1.0, 1.0);
  EXPECT_EQ(three.width, kPicturePixelsMax / 2 + 1);
  EXPECT_EQ(three.At(0, 0), (Rgb{5, 7, 9}));
  EXPECT_EQ(three.At(kPicturePixelsMax / 2, 0), (Rgb{0, 7, 9}));  // the one that is left over
}

// A ball that goes in by a quarter of a millimetre takes off no more, and so it is told before.
TEST(MaterialEdges, ALittleIsToldAsALittle) {
  HeightField field =
      HeightField::Of({.x_max = 20.0, .y_max = 10.0, .bottom = -5.0, .top = 0.0, .cell = 0.05})
          .value();
  const MillTool ball{.shape = MillTool::Shape::kBall, .radius_mm = 2.0};
  const motion::MachinePoint from{5.025, 5.025, -0.25};
  const motion::MachinePoint to{15.025, 5.025, -0.125};
  EXPECT_NEAR(field.DepthOf(ball, from, to), 0.25, 1e-3);
  EXPECT_NEAR(field.Cut(ball, from, to), 0.25, 1e-3);
  EXPECT_NEAR(field.DepthOf(ball, from, to), 0.0, 1e-6);
  const MillTool flat{.radius_mm = 1.0};
  EXPECT_NEAR(field.Cut(flat, {5, 2, -0.5}, {15, 2, -0.5}), 0.5, 1e-6);
  EXPECT_EQ(field.Cut(flat, {5, 2, 0}, {15, 2, 0}), 0.0);
}

// A body whose edges run through the middles of cells has those cells.
TEST(MaterialEdges, ABodyHasTheCellsUnderItsEdges) {
  const Stock block{.x_max = 5.0, .y_max = 5.0, .bottom = 0.0, .top = 3.0, .cell = 1.0};
  const std::vector<StlTriangle> square{
      {{{{0.5f, 1.5f, 2.0f}, {3.5f, 1.5f, 2.0f}, {3.5f, 3.5f, 2.0f}}}},
      {{{{0.5f, 1.5f, 2.0f}, {3.5f, 3.5f, 2.0f}, {0.5f, 3.5f, 2.0f}}}}};
  for (const bool turned : {false, true}) {
    std::vector<StlTriangle> body = square;
    if (turned) {
      for (StlTriangle& triangle : body) {
        for (auto& corner : triangle.corners) std::swap(corner[0], corner[1]);
      }
    }
    const auto heights = TargetOfBody(body, block, {});
    ASSERT_TRUE(heights);
    for (std::size_t row = 0; row < 5; ++row) {
      for (std::size_t column = 0; column < 5; ++column) {
        const float height = (*heights)[row * 5 + column];
        const std::size_t along = turned ? row : column;
        const std::size_t across = turned ? column : row;
        if (along <= 3 && across >= 1 && across <= 3) {
          EXPECT_EQ(height, 2.0f) << column << ' ' << row;
        } else {
          EXPECT_TRUE(std::isnan(height)) << column << ' ' << row;
        }
      }
    }
  }
}

// A rectangle that ends with a tile is of that tile alone.
TEST(MaterialEdges, ChangesEndWithTheirTile) {
  HeightField field = HeightField::Of(CellsOf(192.0, 192.0)).value();
  const MillTool pin{.radius_mm = 0.1};
  for (const double x : {10.5, 80.5, 150.5}) {
    for (const double y : {10.5, 80.5, 150.5}) field.Cut(pin, {x, y, -1}, {x, y, -1});
  }
  HeightChanges changes(field);
  EXPECT_EQ(changes.Take(field, 100).size(), 9u);
  changes.Note(64.5, 127.5, 64.5, 127.5);
  const std::vector<HeightTile> tiles = changes.Take(field, 100);
  ASSERT_EQ(tiles.size(), 1u);
  EXPECT_EQ(tiles[0].column, 64u);
  EXPECT_EQ(tiles[0].row, 64u);
}

void PutWord(std::string& bytes, std::size_t at, std::uint64_t value, std::size_t size) {
  for (std::size_t k = 0; k < size; ++k) bytes[at + k] = static_cast<char>(value >> (8 * k) & 0xFF);
}

// docs: a grid begins with 64 bytes, has cells, and no more of them than a block may have.
TEST(MaterialEdges, HeadsOfGrids) {
  const HeightField field = HeightField::Of(CellsOf(3.0, 2.0)).value();
  const std::string bytes = BytesOf([&](const auto& sink) { return WriteHeightGrid(field, sink); });
  EXPECT_TRUE(ReadHeightGridHead(bytes));
  const std::string head = bytes.substr(0, kHeightGridHeadBytes);
  EXPECT_TRUE(ReadHeightGridHead(head));
  EXPECT_FALSE(ReadHeightGridHead(head.substr(1)));
  EXPECT_FALSE(ReadHeightGridHead(head.substr(0, head.size() - 1)));
  const auto with = [&](std::uint64_t columns, std::uint64_t rows, double cell) {
    std::string other = head;
    PutWord(other, 12, columns, 4);
    PutWord(other, 16, rows, 4);
    PutWord(other, 40, std::bit_cast<std::uint64_t>(cell), 8);
    return bool(ReadHeightGridHead(other));
  };
  EXPECT_TRUE(with(1, HeightField::kCellsMax, 1.0));
  EXPECT_FALSE(with(1, HeightField::kCellsMax + 1, 1.0));
  EXPECT_FALSE(with(0, 2, 1.0));
  EXPECT_FALSE(with(3, 0, 1.0));
  EXPECT_FALSE(with(3, 2, 0.0));
  EXPECT_TRUE(with(3, 2, 1e-9));
}

TEST(MaterialEdges, CellsHaveASize) {
  Stock block = CellsOf(3.0, 2.0);
  block.cell = 0.0;
  const Status none = CheckStock(block);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().detail, "the cells of the stock have no size");
}

// A material may be as slow as 0.5 m/min.
TEST(MaterialEdges, SlowMaterials) {
  const auto tables = ReadChipTables(
      "[steel]\nsource = 'measured'\ndiameter_mm = [1, 3]\nleast_mm = [0.01, 0.02]\n"
      "most_mm = [0.01, 0.02]\nspeed_most_m_min = 0.5\nplunge_share = 1\n");
  ASSERT_TRUE(tables);
  EXPECT_EQ(tables->front().speed_most_m_min, 0.5);
  EXPECT_EQ(tables->front().plunge_share, 1.0);
}

// A short motion that goes on standing at its end does not end its move again.
TEST(MoveEdges, AShortMotionEndsOnce) {
  motion::PlannedMotion motion;
  motion.path = LineFrom({0, 0, 0}, {0.5, 0, 0});
  motion.ends_move = true;
  EXPECT_TRUE(EndsMove({.motion = &motion, .from = 0.25, .travelled = 0.5}));
  EXPECT_FALSE(EndsMove({.motion = &motion, .from = 0.5, .travelled = 0.5}));
}

// motion.md 8.2: a small corner has its true extremes, too, whichever way it turns back.
TEST(PathEdges, ASmallCornerTurnsWhereItTurns) {
  for (const double size : {1.0, 0.1, -1.0, -0.1}) {
    const auto motions = PlannedCorner({{0, 0, 0}}, {{4 * size, 0, 0}}, {{0, size, 0.5 * size}});
    for (const motion::PlannedMotion& motion : motions) {
      const double length = motion.path.length();
      const PointSweep sweep = TipSweepOf({motion.path, motion.head, 0.0, length});
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double low = HUGE_VAL;
        double high = -HUGE_VAL;
        for (int k = 0; k <= 2000; ++k) {
          const double at = TipAt(motion.path, motion.head, length * k / 2000)[axis];
          low = std::min(low, at);
          high = std::max(high, at);
        }
        EXPECT_NEAR(sweep[axis].minimum, low, 1e-5 * std::abs(size));
        EXPECT_NEAR(sweep[axis].maximum, high, 1e-5 * std::abs(size));
      }
    }
  }
}

// motion.md 8.2: along a circle each axis of its plane comes to the whole speed. Where that of one
// axis alone is not known yet it is seen.
TEST(PathEdges, PeaksOfACircleAreSeenOnEachAxis) {
  const motion::PlannedMotion circle = Planned(motion::PathPiece::Circle(
      {{1.0, 0.0, 0.0}}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 6.0, 0.0, 0.0));
  const double duration = circle.speed.duration_s();
  const MotionPeaks whole = PeaksBetween(circle, false, 0.0, duration);
  const double speed = whole.tip_speed;
  EXPECT_GT(speed, 5.0);
  MotionPeaks far = whole;
  far.tip_speed *= 10.0;
  far.tip_acceleration *= 10.0;
  far.tip_jerk *= 10.0;
  far.axis_speed *= 10.0;
  far.axis_acceleration *= 10.0;
  far.axis_jerk *= 10.0;
  for (int i = 2; i < 5; ++i) far.axis_speed[i] = far.axis_acceleration[i] = far.axis_jerk[i] = 1e9;
  const auto beyond = [&](const MotionPeaks& known) {
    PartShape shape({circle.path, circle.head, 0.0, circle.path.length()});
    return PeaksBeyond(known, circle, shape, false, 0.0, duration);
  };
  EXPECT_EQ(beyond(far).tip_speed, 0.0);  // nothing to be seen
  for (const int axis : {0, 1}) {
    EXPECT_NEAR(whole.axis_speed[axis], speed, 0.01 * speed) << axis;
    for (const double share : {0.6, 0.9, 0.98}) {
      MotionPeaks known = far;
      known.axis_speed[axis] = share * speed;
      EXPECT_NEAR(beyond(known).axis_speed[axis], whole.axis_speed[axis], 1e-9) << axis << share;
    }
  }
}

}  // namespace
}  // namespace rmlcell::simulation
