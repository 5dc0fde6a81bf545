#include "engine/simulation/material/height_tiles.h"

#include <gtest/gtest.h>

#include <map>

namespace rmlcell::simulation {
namespace {

using Size = HeightField::Size;

// 150 x 130 cells, three tiles by three; the top is 0, the bottom 65.535 mm below: 0.001 mm a
// number.
constexpr Stock kTiledBlock{.x_min = 10.0,
                            .x_max = 160.0,
                            .y_min = -20.0,
                            .y_max = 110.0,
                            .bottom = -65.535,
                            .top = 0.0,
                            .cell = 1.0};
constexpr MillTool kPinTool{.radius_mm = 0.1};  // one cell, at its centre

void CutCell(HeightField& field, double column, double row, double z) {
  const motion::MachinePoint at{10.5 + column, -19.5 + row, z};
  field.Cut(kPinTool, at, at);
}

std::string GridOf(const HeightField& field) {
  std::string bytes;
  WriteHeightGrid(field, [&](std::string_view part) {
    bytes += part;
    return true;
  });
  return bytes;
}

std::uint16_t At(const HeightTile& tile, std::size_t column, std::size_t row) {
  return HeightAt(tile.heights, (row - tile.row) * tile.columns + column - tile.column);
}

TEST(HeightTiles, LevelsOfAScreen) {
  EXPECT_EQ(LevelForScreen({1024, 1024}), 0);
  EXPECT_EQ(LevelForScreen({1, 1025}), 1);
  EXPECT_EQ(LevelForScreen({2048, 10}), 1);
  EXPECT_EQ(LevelForScreen({2049, 10}), 2);
  EXPECT_EQ(SizeAtLevel({150, 130}, 0), (Size{150, 130}));
  EXPECT_EQ(SizeAtLevel({150, 130}, 2), (Size{38, 33}));  // 37.5, 32.5
}

// The mean of a square, half a number up; the last one has what is left of the row.
TEST(HeightTiles, RowsOfALevel) {
  LevelRows rows(3, 1);
  const std::uint16_t first[] = {10, 20, 7};
  const std::uint16_t second[] = {30, 42, 8};
  EXPECT_FALSE(rows.Add(first));
  ASSERT_TRUE(rows.Add(second));
  EXPECT_EQ(rows.row()[0], 26);  // 25.5
  EXPECT_EQ(rows.row()[1], 8);   // 7.5
  EXPECT_FALSE(rows.Finish());
  EXPECT_FALSE(rows.Add(first));
  ASSERT_TRUE(rows.Finish());
  EXPECT_EQ(rows.row()[0], 15);
  EXPECT_EQ(rows.row()[1], 7);
}

TEST(HeightTiles, OfABlockThatNothingTouchedThereAreNone) {
  const HeightField field = HeightField::Of(kTiledBlock).value();
  EXPECT_TRUE(HeightChanges(field).Take(field, 100).empty());
}

// Who begins to look gets what was cut before; then only where something was noted.
TEST(HeightTiles, ChangesAreTaken) {
  HeightField field = HeightField::Of(kTiledBlock).value();
  CutCell(field, 149, 0, -1.0);  // in the tile of the greatest X
  HeightChanges changes(field);
  EXPECT_EQ(changes.size(), (Size{150, 130}));
  std::vector<HeightTile> tiles = changes.Take(field, 100);
  ASSERT_EQ(tiles.size(), 1U);
  EXPECT_EQ(tiles[0].column, 128U);
  EXPECT_EQ(tiles[0].row, 0U);
  EXPECT_EQ(tiles[0].columns, 22U);
  EXPECT_EQ(tiles[0].rows, 64U);
  EXPECT_EQ(tiles[0].heights.size(), 2U * 22 * 64);
  EXPECT_EQ(At(tiles[0], 149, 0), 64'535);
  EXPECT_EQ(At(tiles[0], 148, 0), 65'535);
  EXPECT_TRUE(changes.Take(field, 100).empty());

  CutCell(field, 70, 129, -2.0);
  EXPECT_TRUE(changes.Take(field, 100).empty());  // nobody noted it
  changes.Note(80.4, 80.6, 109.4, 109.6);
  tiles = changes.Take(field, 100);
  ASSERT_EQ(tiles.size(), 1U);
  EXPECT_EQ(tiles[0].column, 64U);
  EXPECT_EQ(tiles[0].row, 128U);
  EXPECT_EQ(tiles[0].rows, 2U);
  EXPECT_EQ(At(tiles[0], 70, 129), 63'535);
}

// A rectangle over the whole block and beyond is of all tiles; those beside it of none.
TEST(HeightTiles, WhatIsNotedMayLieBesideTheBlock) {
  HeightField field = HeightField::Of(kTiledBlock).value();
  for (const double column : {0, 70, 140}) {
    for (const double row : {0, 70, 129}) CutCell(field, column, row, -1.0);
  }
  HeightChanges changes(field);
  EXPECT_EQ(changes.Take(field, 100).size(), 9U);
  changes.Note(-1e9, 9.0, -1e9, -21.0);
  EXPECT_LE(changes.Take(field, 100).size(), 1U);  // the nearest, at most
  changes.Note(161.0, 1e9, 0.0, 1.0);
  changes.Note(20.0, 21.0, 111.0, 1e9);
  EXPECT_TRUE(changes.Take(field, 100).empty());
  changes.Note(-1e9, 1e9, -1e9, 1e9);
  EXPECT_EQ(changes.Take(field, 100).size(), 9U);
}

// What lies within the first column, or the first row, alone is of their tiles.
TEST(HeightTiles, TheFirstCellsAreNoted) {
  HeightField field = HeightField::Of(kTiledBlock).value();
  HeightChanges changes(field);
  EXPECT_TRUE(changes.Take(field, 100).empty());
  CutCell(field, 0, 70, -1.0);
  changes.Note(10.25, 10.75, 50.25, 50.75);
  std::vector<HeightTile> tiles = changes.Take(field, 100);
  ASSERT_EQ(tiles.size(), 1U);
  EXPECT_EQ(tiles[0].column, 0U);
  EXPECT_EQ(tiles[0].row, 64U);
  CutCell(field, 70, 0, -1.0);
  changes.Note(80.25, 80.75, -19.75, -19.25);
  tiles = changes.Take(field, 100);
  ASSERT_EQ(tiles.size(), 1U);
  EXPECT_EQ(tiles[0].column, 64U);
  EXPECT_EQ(tiles[0].row, 0U);
}

// A few at a time, each once, whatever changes again meanwhile.
TEST(HeightTiles, TheyAreTakenByTurns) {
  HeightField field = HeightField::Of(kTiledBlock).value();
  for (const double column : {0, 70, 140}) {
    for (const double row : {0, 70, 129}) CutCell(field, column, row, -1.0);
  }
  HeightChanges changes(field);
  std::map<std::pair<std::size_t, std::size_t>, int> seen;
  for (int i = 0; i < 3; ++i) {
    changes.Note(10.0, 11.0, -20.0, -19.0);  // the first tile, again and again
    const std::vector<HeightTile> taken = changes.Take(field, 3);
    EXPECT_EQ(taken.size(), 3U);
    for (const HeightTile& tile : taken) ++seen[{tile.column, tile.row}];
  }
  EXPECT_EQ(seen.size(), 9U);
}

// A look at a large block is bounded: 4,096 by 4,096 cells are four looks, though nothing was cut.
TEST(HeightTiles, ALookAtALargeBlockIsBounded) {
  const Stock large{.x_max = 4096.0, .y_max = 4096.0, .bottom = -1.0, .cell = 1.0};
  const HeightField field = HeightField::Of(large).value();
  HeightChanges changes(field);
  ASSERT_EQ(changes.level(), 2);
  int looks = 0;
  for (; changes.any_left(); ++looks) EXPECT_TRUE(changes.Take(field, 1000).empty());
  EXPECT_EQ(looks, 4);
}

// Of tiles with 65,536 cells each a look has 64: of this block the first four rows of tiles.
TEST(HeightTiles, ALookHasSoManyTiles) {
  const Stock large{.x_max = 4096.0, .y_max = 4096.0, .bottom = -1.0, .cell = 1.0};
  HeightField field = HeightField::Of(large).value();
  for (const auto& [x, y] : {std::pair{4090.5, 1020.5}, {2.5, 1030.5}})
    field.Cut(kPinTool, {x, y, -0.5}, {x, y, -0.5});
  HeightChanges changes(field);
  for (const std::size_t row : {192U, 256U}) {
    const std::vector<HeightTile> tiles = changes.Take(field, 1000);
    ASSERT_EQ(tiles.size(), 1U);
    EXPECT_EQ(tiles[0].row, row);
  }
}

// As one looks on, and afterwards: the same tiles, at each level, in parts of any size.
TEST(HeightTiles, AGridHasTheSameTiles) {
  const Stock wide{.x_min = 0.0,
                   .x_max = 1100.0,
                   .y_min = 0.0,
                   .y_max = 70.0,
                   .bottom = -65.535,
                   .top = 0.0,
                   .cell = 1.0};
  HeightField field = HeightField::Of(wide).value();
  for (int i = 0; i < 1100; i += 3) {
    const motion::MachinePoint at{i + 0.5, i % 70 + 0.5, -0.001 * (i % 400)};
    field.Cut(kPinTool, at, at);
  }
  const std::string bytes = GridOf(field);
  const HeightGridHead head = ReadHeightGridHead(bytes).value();
  EXPECT_EQ(head, HeadOf(field));
  const auto stored = [&](int level, std::size_t part) {
    HeightGridTiles grid(head, level, std::nullopt);
    std::vector<HeightTile> tiles;
    for (std::size_t at = kHeightGridHeadBytes; at < bytes.size(); at += part) {
      for (HeightTile& tile : grid.Add(std::string_view(bytes).substr(at, part)))
        tiles.push_back(std::move(tile));
    }
    return tiles;
  };
  HeightChanges changes(field);
  ASSERT_EQ(changes.level(), 1);
  const std::vector<HeightTile> live = changes.Take(field, 1000);
  EXPECT_EQ(live.size(), 9U);  // 550 columns, 35 rows
  EXPECT_EQ(stored(1, 1'000'000), live);
  EXPECT_EQ(stored(1, 777), live);
  // At level 0 each cell is its own number.
  std::size_t cells = 0;
  for (const HeightTile& tile : stored(0, 4096)) {
    for (std::size_t row = tile.row; row < tile.row + tile.rows; ++row) {
      for (std::size_t column = tile.column; column < tile.column + tile.columns; ++column, ++cells)
        ASSERT_EQ(At(tile, column, row), HeightNumber(wide, field.height(column, row)));
    }
  }
  EXPECT_EQ(cells, 1100U * 70);
  // So coarse that one tile has all.
  const std::vector<HeightTile> one = stored(16, 4096);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].heights.size(), 2U);
}

TEST(HeightTiles, OnlyThoseOfAnArea) {
  const HeightField field = HeightField::Of(kTiledBlock).value();
  const std::string bytes = GridOf(field);
  const HeightGridHead head = ReadHeightGridHead(bytes).value();
  const auto places = [&](const HeightGridTiles::Area& area) {
    HeightGridTiles grid(head, 0, area);
    std::vector<std::pair<std::size_t, std::size_t>> found;
    for (const HeightTile& tile : grid.Add(std::string_view(bytes).substr(kHeightGridHeadBytes)))
      found.emplace_back(tile.column, tile.row);
    return found;
  };
  using Places = std::vector<std::pair<std::size_t, std::size_t>>;
  EXPECT_EQ(places({.column = 64, .row = 64, .columns = 1, .rows = 1}), (Places{{64, 64}}));
  EXPECT_EQ(places({.column = 63, .row = 64, .columns = 2, .rows = 64}),
            (Places{{0, 64}, {64, 64}}));
  EXPECT_EQ(places({.column = 149, .row = 127, .columns = 9, .rows = 2}),
            (Places{{128, 64}, {128, 128}}));
  EXPECT_EQ(places({.column = 192, .row = 0, .columns = 1, .rows = 1}), Places{});
  EXPECT_EQ(places({.column = 0, .row = 0, .columns = 64, .rows = 64}), (Places{{0, 0}}));
  EXPECT_EQ(places({.column = 64, .row = 64, .columns = 64, .rows = 64}), (Places{{64, 64}}));
}

// All that is wanted has come with the last row of tiles that has some of it; behind the last row
// of the grid nothing is read.
TEST(HeightTiles, WhatIsWantedHasComeWhenItsRowsHave) {
  const HeightField field = HeightField::Of(kTiledBlock).value();
  const std::string bytes = GridOf(field).substr(kHeightGridHeadBytes);
  const HeightGridHead head = HeadOf(field);
  const auto rows_until_done = [&](std::optional<HeightGridTiles::Area> area) {
    HeightGridTiles grid(head, 0, area);
    for (std::size_t row = 0; row < 130; ++row) {
      if (grid.done()) return row;
      grid.Add(std::string_view(bytes).substr(row * 300, 300));
    }
    return grid.done() ? std::size_t{130} : std::size_t{999};
  };
  EXPECT_EQ(rows_until_done(std::nullopt), 130U);
  EXPECT_EQ(rows_until_done({{.column = 0, .row = 0, .columns = 9, .rows = 64}}), 64U);
  EXPECT_EQ(rows_until_done({{.column = 0, .row = 0, .columns = 9, .rows = 65}}), 128U);
  EXPECT_EQ(rows_until_done({{.column = 0, .row = 60, .columns = 9, .rows = 900}}), 130U);
  HeightGridTiles grid(head, 0, std::nullopt);
  EXPECT_EQ(grid.Add(bytes + std::string(300 * 64, '\0')).size(), 9U);
  EXPECT_TRUE(grid.Add(std::string(300 * 64, '\0')).empty());
}

TEST(HeightTiles, WhatIsNoGridIsRefused) {
  const std::string good =
      GridOf(HeightField::Of(kTiledBlock).value()).substr(0, kHeightGridHeadBytes);
  ASSERT_TRUE(ReadHeightGridHead(good));
  const auto refused = [&](std::size_t at, std::string_view bytes) {
    std::string bad = good;
    bad.replace(at, bytes.size(), bytes);
    const auto head = ReadHeightGridHead(bad);
    return !head && head.error().code == ErrorCode::kCellBadText;
  };
  EXPECT_FALSE(ReadHeightGridHead(good.substr(0, 63)));
  EXPECT_TRUE(refused(0, "X"));
  EXPECT_TRUE(refused(8, "\x02"));                            // another version
  EXPECT_TRUE(refused(12, std::string_view("\0\0\0\0", 4)));  // no columns
  EXPECT_TRUE(refused(16, std::string_view("\0\0\0\0", 4)));  // no rows
  EXPECT_TRUE(refused(16, "\xFF\xFF\xFF\xFF"));               // too many
  EXPECT_TRUE(refused(47, "\xC0"));                           // a cell below 0
  EXPECT_TRUE(refused(40, std::string(8, '\0')));             // a cell of 0
  // 1 << 26 cells are as many as there may be, one row more is too many.
  const auto of_size = [&](std::string_view columns, std::string_view rows) {
    std::string grid = good;
    grid.replace(12, 4, columns).replace(16, 4, rows);
    return bool(ReadHeightGridHead(grid));
  };
  EXPECT_TRUE(of_size({"\0\x20\0\0", 4}, {"\0\x20\0\0", 4}));
  EXPECT_FALSE(of_size({"\0\x20\0\0", 4}, {"\x01\x20\0\0", 4}));
  EXPECT_TRUE(of_size({"\0\0\0\x04", 4}, {"\x01\0\0\0", 4}));
  EXPECT_FALSE(of_size({"\x01\0\0\x04", 4}, {"\x01\0\0\0", 4}));
}

// Of 3 rows of cells at level 1 the second row has the last one alone: (2, 2) is 1 mm deep, and its
// neighbour is at the top.
TEST(HeightTiles, TheLastRowMayBeOfFewerCells) {
  const Stock odd{.x_max = 1025.0, .y_max = 3.0, .bottom = -65.535, .cell = 1.0};
  HeightField field = HeightField::Of(odd).value();
  field.Cut(kPinTool, {2.5, 2.5, -1.0}, {2.5, 2.5, -1.0});
  HeightChanges changes(field);
  ASSERT_EQ(changes.level(), 1);
  EXPECT_EQ(changes.size(), (Size{513, 2}));
  const std::vector<HeightTile> tiles = changes.Take(field, 100);
  ASSERT_EQ(tiles.size(), 1U);
  EXPECT_EQ(tiles[0].rows, 2U);
  ASSERT_EQ(tiles[0].heights.size(), 2U * 64 * 2);
  EXPECT_EQ(At(tiles[0], 1, 1), 65'035);
  EXPECT_EQ(At(tiles[0], 1, 0), 65'535);
  EXPECT_EQ(At(tiles[0], 2, 1), 65'535);
}

}  // namespace
}  // namespace rmlcell::simulation
