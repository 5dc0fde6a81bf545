#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/simulation/material/height_field.h"
#include "engine/simulation/material/height_grid.h"

// The heights of a block in tiles, for who looks at it on a screen: as it is milled, or afterwards
// from a height grid. At level n a square of 2^n by 2^n cells is one, with the mean of their
// numbers (HeightNumber); at the ends of rows and columns of as many as there are.
namespace rmlcell::simulation {

inline constexpr std::size_t kTileCells = 64;      // columns and rows of a tile; fewer at the ends
inline constexpr std::size_t kScreenCells = 1024;  // columns or rows, at most, of LevelForScreen
inline constexpr int kHeightLevelMax = 16;

HeightField::Size SizeAtLevel(HeightField::Size cells, int level);
// The least level of at most kScreenCells columns and rows.
int LevelForScreen(HeightField::Size cells);

struct HeightTile {
  std::size_t column = 0;  // of its first cell, at its level; so are the others
  std::size_t row = 0;
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::string heights{};  // 2 bytes each, least significant first, row by row from the least Y on

  bool operator==(const HeightTile&) const = default;
};

// Rows of cells into rows of a level.
class LevelRows {
 public:
  LevelRows(std::size_t columns, int level);

  // One more row; true: one of the level is full, and is in row().
  bool Add(std::span<const std::uint16_t> cells);
  // What the rows since the last full one come to; false: there are none.
  bool Finish();
  std::span<const std::uint16_t> row() const { return row_; }

 private:
  std::size_t square_;
  std::size_t columns_;
  std::size_t added_ = 0;
  std::vector<std::uint64_t> sums_;
  std::vector<std::uint16_t> row_;
};

// Which tiles of a block that is milled have changed.
class HeightChanges {
 public:
  // At first all have.
  explicit HeightChanges(const HeightField& field);

  // Something was taken off in this rectangle of the block's frame, mm.
  void Note(double x_min, double x_max, double y_min, double y_max);

  // At most `most` of those that have changed, by turns, and from then on they have not. One that
  // nothing was ever taken off is none. No more than kCellsAtOnce are looked at.
  std::vector<HeightTile> Take(const HeightField& field, std::size_t most);
  static constexpr std::size_t kCellsAtOnce = std::size_t{1} << 22;
  // Whether Take() would look at more.
  bool any_left() const { return left_ > 0; }

  int level() const { return level_; }
  HeightField::Size size() const { return size_; }  // at this level

 private:
  HeightTile TileOf(const HeightField& field, std::size_t tile) const;

  Stock stock_;
  int level_;
  HeightField::Size size_;
  std::size_t tile_columns_;
  std::size_t next_ = 0;  // tile that is looked at next
  std::vector<bool> changed_;
  std::size_t left_;  // that have
};

// A height grid, as its bytes come, into the tiles of a level.
class HeightGridTiles {
 public:
  // Of the level; behind the end of it there is nothing.
  struct Area {
    std::size_t column = 0;
    std::size_t row = 0;
    std::size_t columns = 0;
    std::size_t rows = 0;
  };
  // A row of cells is in memory: no more of them than this.
  static constexpr std::size_t kColumnsMax = std::size_t{1} << 20;

  // Tiles that have no cell in the area are left out. Precondition: kColumnsMax.
  HeightGridTiles(const HeightGridHead& head, int level, std::optional<Area> area);

  // Whether all that is wanted has come: what follows need not be read.
  bool done() const;

  // Bytes behind the head, in parts of any size. The tiles that are full now, row by row.
  std::vector<HeightTile> Add(std::string_view bytes);

 private:
  void AddRow(std::vector<HeightTile>& tiles);
  void AddLevelRow(std::vector<HeightTile>& tiles);
  void CutTiles(std::vector<HeightTile>& tiles);
  bool Wanted(const HeightTile& tile) const;

  HeightField::Size cells_;
  HeightField::Size size_;  // at the level
  std::optional<Area> area_;
  LevelRows level_rows_;
  std::string part_{};  // of a row that is not whole yet
  std::vector<std::uint16_t> cells_row_;
  std::size_t rows_read_ = 0;          // of cells
  std::size_t rows_cut_ = 0;           // of the level, that are in tiles
  std::vector<std::uint16_t> band_{};  // rows of the level that wait for theirs to be full
};

}  // namespace rmlcell::simulation
