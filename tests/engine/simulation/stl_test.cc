#include "engine/simulation/material/stl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "engine/core/units.h"
#include "tests/engine/simulation/stl_mesh.h"
#include "tests/engine/simulation/thread_for.h"

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;

constexpr double kFloat_mm = 1e-5;  // heights and places of some ten mm are kept as float

HeightField Plate(double cell) {
  return HeightField::Of({.x_max = 60.0, .y_max = 30.0, .bottom = -5.0, .top = 0.0, .cell = cell})
      .value();
}

// A block that begins anywhere, with what each kind of tool leaves: slopes, walls, scallops.
HeightField Milled(unsigned seed) {
  HeightField field = HeightField::Of({.x_min = -3.0,
                                       .x_max = 10.0,
                                       .y_min = 5.0,
                                       .y_max = 12.1,
                                       .bottom = -4.0,
                                       .top = 1.0,
                                       .cell = 0.2})
                          .value();
  std::mt19937 random(seed);  // NOLINT: the same every time
  std::uniform_real_distribution<double> x(-4.0, 11.0), y(4.0, 13.0), z(-3.0, 1.5);
  const MillTool tools[] = {{.radius_mm = 0.7},
                            {.shape = MillTool::Shape::kBall, .radius_mm = 1.5},
                            {.shape = MillTool::Shape::kVee,
                             .radius_mm = 2.0,
                             .half_angle_rad = kPi / 6,
                             .tip_radius_mm = 0.1}};
  for (int k = 0; k < 12; ++k) {
    const double level = z(random);
    const double end = k % 2 == 0 ? level : z(random);
    field.Cut(tools[k % 3], {x(random), y(random), level}, {x(random), y(random), end});
  }
  return field;
}

// The grid of vertices, by the rule and not by the code: over each cell its centre, around them the
// edges of the block, as high as the cell beside them.
struct Grid {
  explicit Grid(const HeightField& of) : field(of) {}
  double Along(std::size_t i, double begin, std::size_t cells) const {
    const double cell = field.stock().cell;
    if (i == 0) return begin;
    if (i == cells + 1) return begin + static_cast<double>(cells) * cell;
    return begin + (static_cast<double>(i) - 0.5) * cell;
  }
  double x(std::size_t i) const { return Along(i, field.stock().x_min, field.columns()); }
  double y(std::size_t j) const { return Along(j, field.stock().y_min, field.rows()); }
  double z(std::size_t i, std::size_t j) const {
    const std::size_t column = i == 0 ? 0 : std::min(i - 1, field.columns() - 1);
    const std::size_t row = j == 0 ? 0 : std::min(j - 1, field.rows() - 1);
    return std::max(double{field.height(column, row)}, field.stock().bottom);
  }
  const HeightField& field;
};

// The height of a triangle over a point; nothing where it does not lie over it.
std::optional<double> HeightAt(const Triangle& t, double x, double y) {
  const auto cross = [](double ax, double ay, double bx, double by) { return ax * by - ay * bx; };
  const double area =
      cross(t[1].x() - t[0].x(), t[1].y() - t[0].y(), t[2].x() - t[0].x(), t[2].y() - t[0].y());
  double height = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const MachineVector& b = t[(k + 1) % 3];
    const MachineVector& c = t[(k + 2) % 3];
    const double share = cross(b.x() - x, b.y() - y, c.x() - x, c.y() - y) / area;
    if (share < -1e-9) return std::nullopt;
    height += share * t[k].z();
  }
  return height;
}

bool IsGround(const StlMesh& mesh, std::size_t k) { return mesh.normals[k].z() > 1e-6; }

// The vertex of the grid that a corner of the mesh is, without the rounding of its float.
MachineVector OnGrid(const Grid& grid, const MachineVector& corner) {
  const auto nearest = [](double place, std::size_t count, const auto& at) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < count; ++i) {
      if (std::abs(at(i) - place) < std::abs(at(best) - place)) best = i;
    }
    EXPECT_NEAR(at(best), place, kFloat_mm);
    return at(best);
  };
  return {nearest(corner.x(), grid.field.columns() + 2, [&](std::size_t i) { return grid.x(i); }),
          nearest(corner.y(), grid.field.rows() + 2, [&](std::size_t j) { return grid.y(j); }),
          corner.z()};
}

// Every vertex of the grid lies within the tolerance of the mesh; between them the mesh goes
// nowhere above or below the corners of the square by more.
void ExpectWithin(const HeightField& field, const StlMesh& mesh, double tolerance) {
  const Grid grid(field);
  std::vector<int> met((field.columns() + 2) * (field.rows() + 2), 0);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    if (!IsGround(mesh, k)) continue;
    const auto& [a, b, c] = mesh.triangles[k];
    const Triangle t{OnGrid(grid, a), OnGrid(grid, b), OnGrid(grid, c)};
    const auto [x_low, x_high] = std::minmax({t[0].x(), t[1].x(), t[2].x()});
    const auto [y_low, y_high] = std::minmax({t[0].y(), t[1].y(), t[2].y()});
    for (std::size_t j = 0; j < field.rows() + 2; ++j) {
      if (grid.y(j) < y_low - kFloat_mm || grid.y(j) > y_high + kFloat_mm) continue;
      for (std::size_t i = 0; i < field.columns() + 2; ++i) {
        if (grid.x(i) < x_low - kFloat_mm || grid.x(i) > x_high + kFloat_mm) continue;
        const auto height = HeightAt(t, grid.x(i), grid.y(j));
        if (!height) continue;
        ++met[j * (field.columns() + 2) + i];
        ASSERT_NEAR(*height, grid.z(i, j), tolerance + 10 * kFloat_mm) << i << ' ' << j;
      }
    }
    for (const auto& [u, v] :
         {std::pair{0.31, 0.42}, std::pair{0.11, 0.05}, std::pair{0.5, 0.49}}) {
      const MachineVector point = t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
      std::size_t i = 0, j = 0;
      while (i + 2 < field.columns() + 2 && grid.x(i + 1) < point.x()) ++i;
      while (j + 2 < field.rows() + 2 && grid.y(j + 1) < point.y()) ++j;
      const auto [low, high] =
          std::minmax({grid.z(i, j), grid.z(i + 1, j), grid.z(i, j + 1), grid.z(i + 1, j + 1)});
      ASSERT_GE(point.z(), low - tolerance - 10 * kFloat_mm) << i << ' ' << j;
      ASSERT_LE(point.z(), high + tolerance + 10 * kFloat_mm) << i << ' ' << j;
    }
  }
  EXPECT_TRUE(std::ranges::all_of(met, [](int count) { return count > 0; }));
}

// motion.md 9: plane ground is two triangles; with walls and base a box of twelve.
TEST(Stl, APlateIsABox) {
  const HeightField plate = Plate(0.1);
  const std::string bytes = StlOf(plate, kStlTolerance_mm);
  EXPECT_EQ(bytes.size(), 84u + 50u * 12u);
  EXPECT_EQ(bytes.substr(0, 80), "what is left of the block, mm" + std::string(51, ' '));
  const StlMesh mesh = ReadBack(bytes);
  EXPECT_EQ(mesh.stated, 12u);
  std::size_t ground = 0;
  for (std::size_t k = 0; k < 12; ++k) ground += IsGround(mesh, k) ? 1 : 0;
  EXPECT_EQ(ground, 2u);
  EXPECT_NEAR(VolumeOf(mesh), 60.0 * 30.0 * 5.0, 0.01);
}

// A slope is as plane as a floor: 1 mm on 460. The ring beside the outer cells is level, which is
// half a cell of it, 0.0005 mm, and the round front of the tool lags 0.56 mm at the edges: 0.0012.
TEST(Stl, ASlopeIsAsPlaneAsAFloor) {
  HeightField plate = Plate(0.5);
  plate.Cut({.radius_mm = 200.0}, {-200, 15, -1}, {260, 15, -2});
  const StlMesh mesh = ReadBack(StlOf(plate, 0.003));
  EXPECT_EQ(mesh.stated, 12u);
  EXPECT_NEAR(VolumeOf(mesh), 60.0 * 30.0 * 5.0 - plate.removed_mm3(), 0.003 * 60 * 30);
}

// A pocket of 40 x 16 mm, along the axes: its walls are long narrow patches.
TEST(Stl, AStraightWallHasFewTriangles) {
  HeightField plate = Plate(0.1);
  for (double y = 8.0; y <= 22.0; y += 1.0) plate.Cut({.radius_mm = 1.0}, {11, y, -2}, {49, y, -2});
  const StlMesh mesh = ReadBack(StlOf(plate, kStlTolerance_mm));
  EXPECT_LT(mesh.stated, 6000u);  // 2 * 601 * 301 were 362,000
  EXPECT_NEAR(VolumeOf(mesh), 60.0 * 30.0 * 5.0 - plate.removed_mm3(), 0.01 * 60 * 30);
}

// Closed: each edge has two triangles, which run along it in opposite directions; outward: the
// volume is above 0 and normals of length 1 belong to their triangles.
TEST(Stl, IsAClosedBodyWithinItsTolerance) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const HeightField field = Milled(seed);
    std::uint32_t finest = 0;
    for (const double tolerance : {0.0, 0.01, 0.3}) {
      const StlMesh mesh = ReadBack(StlOf(field, tolerance));
      ASSERT_EQ(mesh.stated, mesh.triangles.size());
      const auto edges = EdgesOf(mesh);
      for (const auto& [edge, count] : edges) {
        const auto back = edges.find({edge.second, edge.first});
        ASSERT_EQ(count, 1);
        ASSERT_TRUE(back != edges.end() && back->second == 1);
      }
      for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
        const auto& [a, b, c] = mesh.triangles[k];
        const MachineVector across = (b - a).cross(c - a);
        ASSERT_GT(across.norm(), 0.0);
        ASSERT_NEAR((mesh.normals[k] - across.normalized()).norm(), 0.0, 1e-3);
      }
      ExpectWithin(field, mesh, tolerance);
      const double area = static_cast<double>(field.columns() * field.rows()) * 0.04;
      EXPECT_NEAR(VolumeOf(mesh), VolumeOf(ReadBack(StlOf(field, 0.0))), tolerance * area + 1e-3);
      if (tolerance == 0.0) finest = mesh.stated;
      if (tolerance == 0.3) {
        EXPECT_LT(mesh.stated, finest / 2);
      }
    }
  }
}

// motion.md 9: the volume is that of the surface over the centres of the cells. With a cell of 1 mm
// and one of four cells 1 mm deep: 3 x 1 x 1 mm stand, and the ring makes the quarter of the deep
// cell at the corner level; its other parts rise to the neighbours, by half a cell on each side.
TEST(Stl, HasTheVolumeOfItsSurface) {
  HeightField field =
      HeightField::Of({.x_max = 2.0, .y_max = 2.0, .bottom = -1.0, .top = 0.0, .cell = 1.0})
          .value();
  field.Cut({.radius_mm = 0.1}, {0.5, 0.5, -0.5}, {0.5, 0.5, -0.5});
  ASSERT_EQ(field.height(0, 0), -0.5f);
  // Missing of 2 x 2 x 1 mm: over 0..0.5 in both directions 0.25 x 0.5; over 0.5..1.5 in one of
  // them 0.5 x 1 x 0.25, twice; the square of the four centres: either 0.5 / 3 or 0.5 / 6 by its
  // diagonal.
  const double missing = 0.125 + 2 * 0.125;
  const double volume = VolumeOf(ReadBack(StlOf(field, 0.0)));
  EXPECT_TRUE(std::abs(volume - (4.0 - missing - 0.5 / 3.0)) < 1e-6 ||
              std::abs(volume - (4.0 - missing - 0.5 / 6.0)) < 1e-6)
      << volume;
}

// Where the tool goes through, the surface lies on the base; the walls end there, too.
TEST(Stl, WhatIsCutThroughHasNoWall) {
  HeightField field =
      HeightField::Of({.x_max = 6.0, .y_max = 4.0, .bottom = -1.0, .top = 0.0, .cell = 0.5})
          .value();
  field.Cut({.radius_mm = 1.0}, {0, 2, -3}, {3, 2, -3});
  const StlMesh mesh = ReadBack(StlOf(field, 0.0));
  double lowest = 0.0;
  for (const Triangle& t : mesh.triangles) {
    for (const MachineVector& corner : t) lowest = std::min(lowest, corner.z());
    EXPECT_GT((t[1] - t[0]).cross(t[2] - t[0]).norm(), 0.0);
  }
  EXPECT_EQ(lowest, -1.0);
  const auto edges = EdgesOf(mesh);
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    ASSERT_TRUE(back != edges.end());
    EXPECT_EQ(back->second, count);
  }
  // The round of the tool falls on cells and half cells around it: 6 to 7 mm2.
  EXPECT_NEAR(VolumeOf(mesh), 24.0 - (3.0 * 2.0 + kPi / 2), 1.5);
}

TEST(Stl, OneCellIsABox) {
  const HeightField field =
      HeightField::Of({.x_max = 0.5, .y_max = 0.5, .bottom = -1.0, .top = 0.0, .cell = 1.0})
          .value();
  const StlMesh mesh = ReadBack(StlOf(field, 0.01));
  EXPECT_EQ(mesh.stated, 12u);
  EXPECT_NEAR(VolumeOf(mesh), 1.0, 1e-9);  // of the whole cell
}

TEST(Stl, TheSameBytesEachTime) { EXPECT_EQ(StlOf(Milled(3), 0.01), StlOf(Milled(3), 0.01)); }

// Sections of the surface are divided and written each by itself: threads change no byte of it.
TEST(Stl, TheSameBytesWithSeveralThreads) {
  HeightField field =
      HeightField::Of({.x_max = 60.0, .y_max = 40.0, .bottom = -9.0, .top = 0.0, .cell = 0.1})
          .value();
  for (int k = 0; k < 60; ++k) {  // waves, and slots across them
    const motion::MachinePoint at{k * 1.0, 3.0 + k % 7, -2.0 - std::sin(0.3 * k)};
    field.Cut({.shape = MillTool::Shape::kBall, .radius_mm = 1.5}, at, {at.x() + 1.0, 36.0, -3.0});
    if (k % 9 == 0) field.Cut({.radius_mm = 0.7}, {at.x(), 0, -6}, {at.x(), 40, -6});
  }
  const std::string alone = StlOf(field, 0.01);
  EXPECT_GT(alone.size(), std::size_t{1} << 20);
  for (const std::size_t width : {2u, 3u, 8u}) {
    ThreadFor threads(width);
    std::string bytes;
    EXPECT_TRUE(WriteStl(
        field, 0.01,
        [&](std::string_view part) {
          bytes += part;
          return true;
        },
        &threads));
    EXPECT_TRUE(bytes == alone) << width << " threads";
    EXPECT_GT(threads.most(), 1u);
  }
}

// A large body is handed over in portions; nothing more once nobody wants it.
TEST(Stl, LargeBodiesComeInPortions) {
  HeightField field =
      HeightField::Of({.x_max = 200.0, .y_max = 100.0, .bottom = -2.0, .top = 0.0, .cell = 1.0})
          .value();
  for (double x = 0.5; x < 200.0; x += 2.0) {  // every other cell of every other row
    for (double y = 0.5; y < 100.0; y += 2.0) field.Cut({.radius_mm = 0.3}, {x, y, -1}, {x, y, -1});
  }
  std::size_t sum = 0;
  int portions = 0;
  EXPECT_TRUE(WriteStl(field, 0.0, [&](std::string_view part) {
    sum += part.size();
    ++portions;
    EXPECT_LE(part.size(), (1u << 20) + 134u);
    return true;
  }));
  EXPECT_GT(sum, 1u << 20);
  EXPECT_GE(portions, 2);
  portions = 0;
  EXPECT_FALSE(WriteStl(field, 0.0, [&](std::string_view) {
    ++portions;
    return false;
  }));
  EXPECT_EQ(portions, 1);
}

TEST(Stl, EndsWhenNobodyWantsMore) {
  EXPECT_FALSE(WriteStl(Plate(1.0), 0.0, [](std::string_view) { return false; }));
}

// 2400 x 2000 cells are 4.8 million, and whoever waits is asked after each 4.2 million.
HeightField WideField() {
  return HeightField::Of({.x_max = 240.0, .y_max = 200.0, .bottom = -2.0, .top = 0.0, .cell = 0.1})
      .value();
}

struct AskedStl {
  bool whole = false;
  int asked = 0;
  std::size_t bytes = 0;
};

// Of one who waits so many times.
AskedStl StlOfOneWhoWaits(const HeightField& field, int most, double tolerance_mm = 0.01) {
  AskedStl made;
  made.whole = WriteStl(field, tolerance_mm, [&](std::string_view part) {
    made.bytes += part.size();
    if (part.empty()) ++made.asked;
    return made.asked <= most;
  });
  return made;
}

// Before the first triangle there is much to look at.
TEST(Stl, WhoeverWaitsIsAskedWhileNothingIsReady) {
  const HeightField field = WideField();
  const AskedStl whole = StlOfOneWhoWaits(field, 1);
  EXPECT_TRUE(whole.whole);
  EXPECT_EQ(whole.asked, 1);
  EXPECT_EQ(whole.bytes, 84U + 50U * 12U);  // a plate is a box
  const AskedStl none = StlOfOneWhoWaits(field, 0);
  EXPECT_FALSE(none.whole);
  EXPECT_EQ(none.bytes, 0U);
}

// What a table knows of a slope does not tell that it is plane: each vertex is looked at once more,
// and whoever waits is asked a second time.
TEST(Stl, WhoeverWaitsIsAskedAgainOfASlope) {
  HeightField field = WideField();
  field.Cut({.radius_mm = 20'000.0}, {-20'000, 100, 0}, {20'240, 100, -1});
  const AskedStl whole = StlOfOneWhoWaits(field, 2);
  EXPECT_TRUE(whole.whole);
  EXPECT_EQ(whole.asked, 2);
  EXPECT_EQ(whole.bytes, 84U + 50U * 12U);  // the slope is plane
  const AskedStl less = StlOfOneWhoWaits(field, 1);
  EXPECT_FALSE(less.whole);
  EXPECT_EQ(less.asked, 2);
  EXPECT_EQ(less.bytes, 0U);
}

// Of a bowl no vertex can be left out: 750 x 750 cells have more than a million triangles, and
// whoever waits is asked once more while they are counted, before the first of them comes.
TEST(Stl, WhoeverWaitsIsAskedWhileTrianglesAreCounted) {
  HeightField field =
      HeightField::Of({.x_max = 750.0, .y_max = 750.0, .bottom = -400.0, .top = 0.0, .cell = 1.0})
          .value();
  field.Cut({.shape = MillTool::Shape::kBall, .radius_mm = 1000.0}, {375, 375, -350},
            {375, 375, -350});
  const AskedStl whole = StlOfOneWhoWaits(field, 1000, 0.0);
  EXPECT_TRUE(whole.whole);
  EXPECT_GT(whole.bytes, 84U + (std::size_t{50} << 20));
  ASSERT_GE(whole.asked, 1);
  const AskedStl less = StlOfOneWhoWaits(field, whole.asked - 1, 0.0);
  EXPECT_FALSE(less.whole);
  EXPECT_EQ(less.asked, whole.asked);
  EXPECT_EQ(less.bytes, 0U);
}

}  // namespace
}  // namespace rmlcell::simulation
