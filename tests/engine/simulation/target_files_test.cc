#include "engine/simulation/material/target_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "engine/simulation/material/height_map.h"
#include "engine/simulation/material/stl_reader.h"
#include "engine/simulation/material/target.h"
#include "tests/engine/simulation/stl_mesh.h"

namespace rmlcell::simulation {
namespace {

constexpr Stock kSquare{.x_min = -1.0,
                        .x_max = 5.0,
                        .y_min = 0.0,
                        .y_max = 4.0,
                        .bottom = -3.0,
                        .top = 0.0,
                        .cell = 0.5};

HeightField Scratched() {
  HeightField field = HeightField::Of(kSquare).value();
  std::mt19937 random(9);  // NOLINT: the same every time
  std::uniform_real_distribution<double> x(-1.0, 5.0), y(0.0, 4.0), z(-2.5, 0.0);
  for (int k = 0; k < 8; ++k) {
    field.Cut({.shape = MillTool::Shape::kBall, .radius_mm = 0.6},
              {x(random), y(random), z(random)}, {x(random), y(random), z(random)});
  }
  return field;
}

template <class Write>
std::string Bytes(Write write) {
  std::string bytes;
  EXPECT_TRUE(write([&](std::string_view part) {
    bytes += part;
    return true;
  }));
  return bytes;
}

// What is written as STL comes back as it was over each cell; what comes back of a coarser one
// within its tolerance.
TEST(TargetFiles, BringABodyBack) {
  const HeightField field = Scratched();
  for (const double tolerance : {0.0, 0.05}) {
    const auto heights = ReadTarget(StlOf(field, tolerance), kSquare);
    ASSERT_TRUE(heights);
    ASSERT_EQ(heights->size(), field.heights().size());
    for (std::size_t k = 0; k < heights->size(); ++k)
      EXPECT_NEAR((*heights)[k], field.heights()[k], tolerance + 1e-4) << k;
  }
}

// A map of the same cells brings each height back within half a grey value (3 mm / 65535 / 2); of
// cells beyond its edge it says nothing; coarser or finer cells take what lies under their centres.
TEST(TargetFiles, BringAMapBack) {
  const HeightField field = Scratched();
  const std::string map = Bytes([&](auto sink) { return WriteHeightMap(field, sink); });
  const auto same = ReadTarget(map, kSquare);
  ASSERT_TRUE(same);
  for (std::size_t k = 0; k < same->size(); ++k)
    EXPECT_NEAR((*same)[k], field.heights()[k], 2.3e-5 + 1e-6) << k;
  Stock larger = kSquare;
  larger.x_min = -2.0;  // two columns more, which the map does not have
  larger.y_max = 4.5;   // and a row
  const auto placed = ReadTarget(map, larger);
  ASSERT_TRUE(placed);
  for (std::size_t row = 0; row < 9; ++row) {
    for (std::size_t column = 0; column < 14; ++column) {
      const float height = (*placed)[row * 14 + column];
      const bool there = column >= 2 && row < 8;
      EXPECT_EQ(std::isnan(height), !there) << column << ' ' << row;
      if (there) {
        EXPECT_EQ(height, (*same)[row * 12 + column - 2]);
      }
    }
  }
  Stock fine = kSquare;
  fine.cell = 0.25;
  const auto finer = ReadTarget(map, fine);
  ASSERT_TRUE(finer);
  EXPECT_EQ((*finer)[5 * 24 + 7], (*same)[2 * 12 + 3]);
}

// A pyramid over 0..2 x 1..3 mm of the block, its tip 1 mm above Z -1, as text with all liberties
// of the format. Its heights by the plane of each side; cells inside its extent that it leaves free
// are to be cut through, those beyond say nothing.
TEST(TargetFiles, TheHighestPointOfABodyCounts) {
  const std::string text =
      "solid a pyramid of facets\r\n"
      "facet normal 0 0 1 outer loop vertex 0 1 -1 vertex 2 1 -1 vertex 1 2 0 endloop endfacet\n"
      "facet normal 0 0 1\nouter loop\n\tvertex 2 3 -1\n vertex 0 3 -1 vertex 1 2 0\nendloop\nendfacet\n"
      "facet normal 0 0 0\nouter loop vertex 0 1 -2 vertex 2 1 -2 vertex 1.0e0 2 -2 endloop endfacet\n"
      "endsolid a pyramid of facets\n";
  const auto heights = ReadTarget(text, kSquare);
  ASSERT_TRUE(heights);
  const auto at = [&](double x, double y) {
    return (
        *heights)[static_cast<std::size_t>(y / 0.5) * 12 + static_cast<std::size_t>((x + 1) / 0.5)];
  };
  EXPECT_NEAR(at(0.75, 1.25), -0.75, 1e-6);  // a quarter up the front side, which lies on another
  EXPECT_NEAR(at(0.75, 2.75), -0.75, 1e-6);
  EXPECT_NEAR(at(0.75, 1.75), -0.25, 1e-6);
  EXPECT_EQ(at(0.25, 1.75), -3.0f);  // left and right sides are missing
  EXPECT_TRUE(std::isnan(at(-0.25, 1.75)));
  EXPECT_TRUE(std::isnan(at(0.75, 3.25)));
}

// One byte more or less than the number of triangles says; numbers that are none; too short.
TEST(TargetFiles, RefuseWhatIsNoStl) {
  const auto refused = [](std::string_view bytes, const std::string& detail) {
    const auto heights = ReadTarget(bytes, kSquare);
    ASSERT_FALSE(heights) << detail;
    EXPECT_NE(heights.error().detail.find(detail), std::string::npos) << heights.error().detail;
  };
  std::string binary = StlOf(Scratched(), 0.1);
  refused(binary + "x", "neither begins with 'solid'");
  refused(binary.substr(0, binary.size() - 1), "neither begins with 'solid'");
  refused("", "neither begins with 'solid'");
  refused(std::string(84, '\0'), "no triangle");
  std::string nowhere = binary;
  std::fill_n(nowhere.begin() + 84 + 12, 4, '\xFF');
  refused(nowhere, "triangle 1 has a corner nowhere");
  refused("solid x\n", "no triangle");
  refused("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0", "line 4: ''");
  refused("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero", "line 4: 'zero'");
  refused("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1e99", "line 4: '1e99'");
  refused("solid x\nfacet normal 0 0 1\nvertex 0 0 1\nendfacet",
          "line 4: 'fewer than three vertices'");
  refused("solid x\nfacet normal 0 0 1\nvertex 0 0 1 vertex 0 1 1 vertex 1 0 1 vertex 1 1 1",
          "a fourth vertex");
  refused("solid x\nfacet normal 0 0 1\nvertex 0 0 1", "ends inside a triangle");
  refused("solid x\nfaced n\n", "line 2: 'faced'");
  refused("solid x\nfacet n\n", "line 2: 'n'");
}

// Programs write "solid" and a name into the 80 bytes before binary triangles, too.
TEST(TargetFiles, BinaryTrianglesMayBeginAsText) {
  std::string bytes = StlOf(Scratched(), 0.1);
  const auto plain = ReadStl(bytes);
  bytes.replace(0, 5, "solid");
  const auto named = ReadStl(bytes);
  ASSERT_TRUE(plain);
  ASSERT_TRUE(named);
  ASSERT_EQ(named->size(), plain->size());
  for (std::size_t k = 0; k < plain->size(); ++k)
    EXPECT_EQ((*named)[k].corners, (*plain)[k].corners) << k;
}

// From the tabulator to the carriage return all is blank; of a long word the first 40 bytes are
// told.
TEST(TargetFiles, WordsOfAText) {
  const auto read = ReadStl(
      "solid x\r\nfacet\vnormal\f0 0 1\r\nouter\tloop\r\nvertex 0 0 1\r\nvertex 0 1 1\r\n"
      "vertex 1 0 1\r\nendloop endfacet\r\nendsolid");
  ASSERT_TRUE(read) << read.error().detail;
  EXPECT_EQ(read->size(), 1u);
  for (const char other : {'\x08', '\x0e'}) {
    const auto refused = ReadStl(std::string("solid x\nfacet") + other + "normal 0 0 1\n");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kCellBadText);
  }
  const auto told = ReadStl("solid x\n" + std::string(50, 'a'));
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().detail, "no STL: line 2: '" + std::string(40, 'a') + "'");
}

TEST(TargetFiles, ABodyBesideTheBlockIsRefused) {
  Stock beside = kSquare;
  beside.x_min += 20.0, beside.x_max += 20.0;
  const auto heights = ReadTarget(StlOf(Scratched(), 0.1), beside);
  ASSERT_FALSE(heights);
  EXPECT_EQ(heights.error().code, ErrorCode::kCellInvalidArgument);
}

// Half a thousandth of a cell is no rounding: centres that far beside a body are not under it.
TEST(TargetFiles, ACentreBesideABodyIsNotUnderIt) {
  const Stock block{.x_max = 5.0, .y_max = 5.0, .bottom = 0.0, .top = 3.0, .cell = 1.0};
  constexpr float kLow = 0.5005f;
  constexpr float kHigh = 3.4995f;
  std::vector<StlTriangle> square(
      1, StlTriangle{{{{kLow, kLow, 2.0f}, {kHigh, kLow, 2.0f}, {kHigh, kHigh, 2.0f}}}});
  square.push_back(StlTriangle{{{{kLow, kLow, 2.0f}, {kHigh, kHigh, 2.0f}, {kLow, kHigh, 2.0f}}}});
  const auto heights = TargetOfBody(square, block);
  ASSERT_TRUE(heights);
  for (std::size_t row = 0; row < 5; ++row) {
    for (std::size_t column = 0; column < 5; ++column) {
      const float height = (*heights)[row * 5 + column];
      if (column >= 1 && column <= 2 && row >= 1 && row <= 2) {
        EXPECT_EQ(height, 2.0f) << column << ' ' << row;
      } else {
        EXPECT_TRUE(std::isnan(height)) << column << ' ' << row;
      }
    }
  }
}

// However small a facet is, what lies under it is as high as it: this one has 0.02 um each way.
TEST(TargetFiles, ASmallFacetCounts) {
  const Stock block{.x_max = 5.0, .y_max = 5.0, .bottom = 0.0, .top = 3.0, .cell = 1.0};
  const std::vector<StlTriangle> facet(
      1, StlTriangle{
             {{{0.49999f, 0.49999f, 2.0f}, {0.50001f, 0.49999f, 2.0f}, {0.5f, 0.50001f, 2.0f}}}});
  const auto heights = TargetOfBody(facet, block);
  ASSERT_TRUE(heights);
  EXPECT_EQ((*heights)[0], 2.0f);
  EXPECT_TRUE(std::isnan((*heights)[1]));
}

// 400 x 400 cells under 100,000 triangles that each cover all of them are 16,000 million looks.
TEST(TargetFiles, ABodyThatLiesOverItselfTooOftenIsRefused) {
  const Stock stock{.x_max = 40.0, .y_max = 40.0, .bottom = -1.0, .top = 0.0, .cell = 0.1};
  const std::vector<StlTriangle> body(
      100'000, StlTriangle{{{{-40.0f, 0.0f, 0.0f}, {80.0f, 0.0f, 0.0f}, {20.0f, 90.0f, 0.0f}}}});
  const auto heights = TargetOfBody(body, stock);
  ASSERT_FALSE(heights);
  EXPECT_EQ(heights.error().code, ErrorCode::kCellTooLarge);
  // A layer of 400 rows with 401 looks each: 2^24 looks and 256 for each cell do for 359.9.
  const std::vector<StlTriangle> just(body.begin(), body.begin() + 359);
  EXPECT_TRUE(TargetOfBody(just, stock));
  const std::vector<StlTriangle> more(body.begin(), body.begin() + 360);
  EXPECT_FALSE(TargetOfBody(more, stock));
}

// Each layer is 160,000 looks; asked at the first, and then after 4.2 million: every 27th.
TEST(TargetFiles, ABodyIsGivenUpWhenItIsNotWantedAnyMore) {
  const Stock stock{.x_max = 40.0, .y_max = 40.0, .bottom = -1.0, .top = 0.0, .cell = 0.1};
  const std::vector<StlTriangle> body(
      100, StlTriangle{{{{-40.0f, 0.0f, 0.0f}, {80.0f, 0.0f, 0.0f}, {20.0f, 90.0f, 0.0f}}}});
  int asked = 0;
  EXPECT_TRUE(TargetOfBody(body, stock, [&] {
    ++asked;
    return true;
  }));
  EXPECT_EQ(asked, 4);
  const auto heights = TargetOfBody(body, stock, [&] { return --asked > 1; });
  ASSERT_FALSE(heights);
  EXPECT_EQ(heights.error().code, ErrorCode::kCellCancelled);
  EXPECT_EQ(asked, 1);
}

// docs/material.md: a PNG by its bytes, an STL by its name; any other is a program.
TEST(TargetFiles, AreToldFromPrograms) {
  EXPECT_TRUE(IsTargetFile("\x89PNG", "part.rml"));
  for (const char* name : {"a.stl", "a.b.STL", ".Stl"}) EXPECT_TRUE(IsTargetFile("PA;", name));
  for (const char* name : {"", "stl", "a.stl.rml", "a.stlx", "a."})
    EXPECT_FALSE(IsTargetFile("PA;", name)) << name;
}

}  // namespace
}  // namespace rmlcell::simulation
