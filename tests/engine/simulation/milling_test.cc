#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>

#include "engine/core/units.h"
#include "engine/simulation/material/milling_recorder.h"
#include "engine/simulation/material/milling_text.h"
#include "engine/simulation/material/stl.h"
#include "tests/engine/simulation/fake_run.h"

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;
using motion::MachineVector;
using motion::PathPiece;

machine::MachineShape MillShape() {
  machine::MachineShape shape;
  shape.has_work_origin = true;
  shape.work_origin = {100.0, 50.0, -20.0};
  return shape;
}

const Milling kSlot{
    .stock = {.x_max = 20.0, .y_max = 12.0, .bottom = -5.0, .top = 0.0, .cell = 0.05},
    .tool = {.shape = MillTool::Shape::kFlat, .radius_mm = 1.5}};

// A straight motion in work coordinates; a feed rate of 0 is travel.
void Tell(MillingRecorder& recorder, const motion::MachinePoint& from,
          const motion::MachinePoint& to, double feed_mm_s, int step) {
  const motion::MachinePoint origin = MillShape().work_origin;
  motion::PlannedMotion planned;
  planned.path = PathPiece::Line({from + origin}, {to + origin});
  recorder.OnMotion({.start = std::chrono::seconds(step),
                     .end = std::chrono::seconds(step + 1),
                     .place = {.program = 7, .step = step},
                     .motion = &planned,
                     .travelled = planned.path.length(),
                     .programmed_mm_s = feed_mm_s});
}

// motion.md 8.2: removed volume. A slot of 10 mm, 3 mm wide and 2 mm deep with round ends.
TEST(MillingRecorder, TakesOffWhatTheToolSweeps) {
  ASSERT_TRUE(CheckMilling(kSlot));
  MillingRecorder recorder(MillShape(), kSlot);
  Tell(recorder, {0, 0, 5}, {5, 6, 5}, 0.0, 1);
  Tell(recorder, {5, 6, 5}, {5, 6, -2}, 2.0, 2);
  Tell(recorder, {5, 6, -2}, {15, 6, -2}, 8.0, 3);
  EXPECT_NEAR(recorder.Figures().removed_mm3, 2.0 * (30.0 + kPi * 2.25), 0.3);
  EXPECT_EQ(recorder.Figures().gouges, 0u);
}

// motion.md 9: travel below the surface is a gouge, with step and depth; through a slot it is none.
TEST(MillingRecorder, TellsTravelThroughMaterial) {
  MillingRecorder recorder(MillShape(), kSlot);
  Tell(recorder, {5, 6, -2}, {15, 6, -2}, 8.0, 1);
  Tell(recorder, {15, 6, -2}, {5, 6, -2}, 0.0, 2);
  EXPECT_EQ(recorder.Figures().gouges, 0u);
  Tell(recorder, {5, 2, -0.5}, {15, 2, -0.5}, 0.0, 3);
  Tell(recorder, {5, 10, -1.25}, {15, 10, -1.25}, 0.0, 4);
  Tell(recorder, {5, 10, 1}, {15, 10, 1}, 0.0, 5);
  const MillingFigures figures = recorder.Figures();
  EXPECT_EQ(figures.gouges, 2u);
  EXPECT_NEAR(figures.gouge_depth_mm, 1.25, 1e-5);
  EXPECT_EQ(figures.gouge_place.step, 4);
  EXPECT_EQ(figures.gouge_at, std::chrono::seconds(4));
}

// The deepest gouge is kept with its place, wherever it comes; less than a micrometre is rounding.
TEST(MillingRecorder, KeepsTheDeepestGouge) {
  MillingRecorder recorder(MillShape(), kSlot);
  Tell(recorder, {5, 2, -0.0005}, {15, 2, -0.0005}, 0.0, 1);
  EXPECT_EQ(recorder.Figures().gouges, 0u);
  Tell(recorder, {5, 6, -1.5}, {15, 6, -1.5}, 0.0, 2);
  Tell(recorder, {5, 10, -0.5}, {15, 10, -0.5}, 0.0, 3);
  Tell(recorder, {5, 2, -0.002}, {15, 2, -0.002}, 0.0, 4);
  EXPECT_EQ(recorder.Figures().gouges, 3u);
  EXPECT_NEAR(recorder.Figures().gouge_depth_mm, 1.5, 1e-5);
  EXPECT_EQ(recorder.Figures().gouge_place.step, 2);
  EXPECT_EQ(recorder.Figures().gouge_place.program, 7);
}

// Only the part of a motion that was travelled takes material off.
TEST(MillingRecorder, TakesOffWhatWasTravelled) {
  MillingRecorder recorder(MillShape(), kSlot);
  motion::PlannedMotion planned;
  const motion::MachinePoint origin = MillShape().work_origin;
  planned.path =
      PathPiece::Line({MachineVector{2, 6, -2} + origin}, {MachineVector{18, 6, -2} + origin});
  recorder.OnMotion({.motion = &planned, .from = 3.0, .travelled = 13.0, .programmed_mm_s = 8.0});
  EXPECT_NEAR(recorder.Figures().removed_mm3, 2.0 * (30.0 + kPi * 2.25), 0.3);
}

TEST(MillingText, ReadsBlocks) {
  const Result<Stock> plain = ParseStock("100x80x10");
  ASSERT_TRUE(plain);
  EXPECT_EQ(*plain, (Stock{.x_max = 100.0, .y_max = 80.0, .bottom = -10.0}));
  const Result<Stock> placed = ParseStock("20x10x2.5@-5,-4,1");
  ASSERT_TRUE(placed);
  EXPECT_EQ(
      *placed,
      (Stock{
          .x_min = -5.0, .x_max = 15.0, .y_min = -4.0, .y_max = 6.0, .bottom = -1.5, .top = 1.0}));
  const Result<Stock> flat = ParseStock("20x10x2.5@-5,-4");
  ASSERT_TRUE(flat);
  EXPECT_EQ(*flat,
            (Stock{.x_min = -5.0, .x_max = 15.0, .y_min = -4.0, .y_max = 6.0, .bottom = -2.5}));
  for (const char* wrong :
       {"", "100x80", "100x80x10x2", "axbxc", "100x80x10@", "100x80x10@1", "1x1x1@1,2,3,4"})
    EXPECT_FALSE(ParseStock(wrong)) << wrong;
}

TEST(MillingText, ReadsTools) {
  const Result<MillTool> vee = ParseTool("vee:6:60:0.2");
  ASSERT_TRUE(vee);
  EXPECT_EQ(vee->shape, MillTool::Shape::kVee);
  EXPECT_DOUBLE_EQ(vee->radius_mm, 3.0);
  EXPECT_DOUBLE_EQ(vee->half_angle_rad, kPi / 6);
  EXPECT_DOUBLE_EQ(vee->tip_radius_mm, 0.1);
  const Result<MillTool> pointed = ParseTool("vee:6:60");
  ASSERT_TRUE(pointed);
  EXPECT_EQ(pointed->tip_radius_mm, 0.0);
  EXPECT_EQ(ParseTool("flat:3")->shape, MillTool::Shape::kFlat);
  EXPECT_EQ(ParseTool("ball:3")->shape, MillTool::Shape::kBall);
  EXPECT_EQ(ParseTool("flat:3")->radius_mm, 1.5);
  for (const char* wrong :
       {"", "flat", "flat:", "flat:0", "flat:-1", "flat:3:2", "vee:6", "vee:6:180", "drill:3"})
    EXPECT_FALSE(ParseTool(wrong)) << wrong;
}

// motion.md 9: closed, and its volume that of the surface over the cell centres.
TEST(Stl, IsClosedAndHasItsVolume) {
  HeightField field =
      HeightField::Of({.x_max = 4.0, .y_max = 3.0, .bottom = -2.0, .top = 0.0, .cell = 0.5})
          .value();
  field.Cut({.shape = MillTool::Shape::kBall, .radius_mm = 0.7}, {1, 1, -1}, {3, 2, -0.5});
  std::string bytes;
  ASSERT_TRUE(WriteStl(field, [&](std::string_view part) {
    bytes += part;
    return true;
  }));
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 4; k-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return value;
  };
  const std::uint32_t triangles = number(80);
  EXPECT_EQ(triangles, 2u * 7 * 5 + 4 * (7 + 5) + 2);
  ASSERT_EQ(bytes.size(), 84u + 50u * triangles);
  // By the divergence theorem, from the file's own numbers.
  double six_fold = 0.0;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const auto corner = [&](std::size_t k) {
      const std::size_t at = 84 + 50 * std::size_t{t} + 12 * (k + 1);
      const auto value = [&](std::size_t c) {
        return double{std::bit_cast<float>(number(at + 4 * c))};
      };
      return MachineVector{value(0), value(1), value(2)};
    };
    six_fold += corner(0).dot(corner(1).cross(corner(2)));
  }
  // Over each square between four centres: two triangles, (a + b + c) / 3 each.
  double volume = 0.0;
  for (std::size_t y = 0; y < 5; ++y) {
    for (std::size_t x = 0; x < 7; ++x) {
      const auto h = [&](std::size_t i, std::size_t j) { return field.height(x + i, y + j) + 2.0; };
      volume +=
          0.125 * (h(0, 0) + h(1, 0) + h(1, 1)) / 3.0 + 0.125 * (h(0, 0) + h(1, 1) + h(0, 1)) / 3.0;
    }
  }
  EXPECT_NEAR(six_fold / 6.0, volume, 1e-6 * volume);
}

// The body of a block that begins anywhere: every edge of a triangle is there once in each
// direction, normals point outwards and are 1 mm long, and its corners are the centres of the
// corner cells. What is cut below the bottom ends there.
TEST(Stl, EachEdgeHasItsNeighbour) {
  HeightField field = HeightField::Of({.x_min = -3.0,
                                       .x_max = 1.0,
                                       .y_min = 5.0,
                                       .y_max = 8.0,
                                       .bottom = -2.0,
                                       .top = 1.0,
                                       .cell = 0.5})
                          .value();
  field.Cut({.radius_mm = 0.7}, {-2, 6, -9}, {0, 6.5, -0.5});
  std::string bytes;
  ASSERT_TRUE(WriteStl(field, [&](std::string_view part) {
    bytes += part;
    return true;
  }));
  EXPECT_EQ(bytes.substr(0, 80), "what is left of the block, mm" + std::string(51, ' '));
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 4; k-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return double{std::bit_cast<float>(value)};
  };
  const auto vector = [&](std::size_t at) {
    return MachineVector{number(at), number(at + 4), number(at + 8)};
  };
  using Corner = std::tuple<double, double, double>;
  const auto key = [](const MachineVector& v) { return Corner{v.x(), v.y(), v.z()}; };
  std::map<std::pair<Corner, Corner>, int> edges;
  machine::Box box;
  for (std::size_t at = 84; at + 50 <= bytes.size(); at += 50) {
    const motion::MachinePoint corners[] = {vector(at + 12), vector(at + 24), vector(at + 36)};
    const MachineVector across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const MachineVector normal = vector(at);
    EXPECT_EQ(bytes.substr(at + 48, 2), std::string(2, '\0'));
    if (across.norm() > 0.0) {
      EXPECT_NEAR((normal - (across * (1.0 / across.norm()))).norm(), 0.0, 1e-5);
    } else {
      EXPECT_EQ(normal, MachineVector{});
    }
    for (std::size_t k = 0; k < 3; ++k) {
      box.Add(corners[k]);
      ++edges[{key(corners[k]), key(corners[(k + 1) % 3])}];
    }
  }
  EXPECT_EQ(box.min, (MachineVector{-2.75, 5.25, -2.0}));
  EXPECT_EQ(box.max, (MachineVector{0.75, 7.75, 1.0}));
  // The bottom is two triangles, so the lower edges of the sides are parts of its sides; above them
  // each edge has its neighbour.
  for (const auto& [edge, count] : edges) {
    const auto& [from, to] = edge;
    if (std::get<2>(from) == -2.0 && std::get<2>(to) == -2.0) continue;
    const auto back = edges.find({to, from});
    EXPECT_EQ(back != edges.end() ? back->second : 0, count);
  }
}

// A large body is handed over in portions; nothing more once nobody wants it.
TEST(Stl, LargeBodiesComeInPortions) {
  const HeightField field =
      HeightField::Of({.x_max = 200.0, .y_max = 100.0, .bottom = -2.0, .top = 0.0, .cell = 1.0})
          .value();
  std::size_t sum = 0;
  int portions = 0;
  EXPECT_TRUE(WriteStl(field, [&](std::string_view part) {
    sum += part.size();
    ++portions;
    EXPECT_LE(part.size(), (1u << 20) + 134u);
    return true;
  }));
  EXPECT_EQ(sum, 84u + 50u * (2u * 199 * 99 + 4 * (199 + 99) + 2));
  EXPECT_EQ(portions, 2);
  portions = 0;
  EXPECT_FALSE(WriteStl(field, [&](std::string_view) {
    ++portions;
    return false;
  }));
  EXPECT_EQ(portions, 1);
}

TEST(Stl, EndsWhenNobodyWantsMore) {
  const HeightField field = HeightField::Of(kSlot.stock).value();
  EXPECT_FALSE(WriteStl(field, [](std::string_view) { return false; }));
}

}  // namespace
}  // namespace rmlcell::simulation
