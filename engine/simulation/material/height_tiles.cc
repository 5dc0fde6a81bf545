#include "engine/simulation/material/height_tiles.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::simulation {
namespace {

std::size_t Squares(std::size_t cells, int level) {
  const std::size_t square = std::size_t{1} << level;
  return (cells + square - 1) / square;
}

std::size_t TilesIn(std::size_t cells) { return (cells + kTileCells - 1) / kTileCells; }

// Cells of the level from `low` to `high` mm of an axis that begins at `from`.
struct Range {
  std::size_t begin = 0;
  std::size_t end = 0;
};
Range CellsBetween(double low, double high, double from, double cell, std::size_t cells) {
  const auto cells_before = [&](double index) {
    return static_cast<std::size_t>(std::clamp(index, 0.0, static_cast<double>(cells)));
  };
  return {cells_before(std::floor((low - from) / cell)),
          cells_before(std::floor((high - from) / cell) + 1.0)};
}

}  // namespace

HeightField::Size SizeAtLevel(HeightField::Size cells, int level) {
  return {Squares(cells.columns, level), Squares(cells.rows, level)};
}

int LevelForScreen(HeightField::Size cells) {
  int level = 0;
  while (std::max(Squares(cells.columns, level), Squares(cells.rows, level)) > kScreenCells)
    ++level;
  return level;
}

LevelRows::LevelRows(std::size_t columns, int level)
    : square_(std::size_t{1} << level),
      columns_(columns),
      sums_(Squares(columns, level)),
      row_(sums_.size()) {}

bool LevelRows::Add(std::span<const std::uint16_t> cells) {
  for (std::size_t at = 0; at < sums_.size(); ++at) {
    const std::size_t end = std::min((at + 1) * square_, columns_);
    for (std::size_t column = at * square_; column < end; ++column) sums_[at] += cells[column];
  }
  return ++added_ == square_ && Finish();
}

bool LevelRows::Finish() {
  if (added_ == 0) return false;
  for (std::size_t at = 0; at < sums_.size(); ++at) {
    const std::size_t wide = std::min((at + 1) * square_, columns_) - at * square_;
    const std::uint64_t cells = wide * added_;
    row_[at] = static_cast<std::uint16_t>((sums_[at] + cells / 2) / cells);
    sums_[at] = 0;
  }
  added_ = 0;
  return true;
}

HeightChanges::HeightChanges(const HeightField& field)
    : stock_(field.stock()),
      level_(LevelForScreen({field.columns(), field.rows()})),
      size_(SizeAtLevel({field.columns(), field.rows()}, level_)),
      tile_columns_(TilesIn(size_.columns)),
      changed_(tile_columns_ * TilesIn(size_.rows), true),
      left_(changed_.size()) {}

void HeightChanges::Note(double x_min, double x_max, double y_min, double y_max) {
  const double cell = stock_.cell * static_cast<double>(std::size_t{1} << level_);
  const Range columns = CellsBetween(x_min, x_max, stock_.x_min, cell, size_.columns);
  const Range rows = CellsBetween(y_min, y_max, stock_.y_min, cell, size_.rows);
  if (columns.begin >= columns.end || rows.begin >= rows.end) return;
  for (std::size_t row = rows.begin / kTileCells; row * kTileCells < rows.end; ++row) {
    const std::size_t first = row * tile_columns_;
    for (std::size_t at = columns.begin / kTileCells; at * kTileCells < columns.end; ++at) {
      if (!changed_[first + at]) ++left_;
      changed_[first + at] = true;
    }
  }
}

std::vector<HeightTile> HeightChanges::Take(const HeightField& field, std::size_t most) {
  std::vector<HeightTile> tiles;
  const std::size_t cells_of_a_tile = (kTileCells * kTileCells) << (2 * level_);
  for (std::size_t cells = 0; left_ > 0 && tiles.size() < most && cells < kCellsAtOnce;) {
    const std::size_t tile = next_;
    next_ = (next_ + 1) % changed_.size();
    if (!changed_[tile]) continue;
    changed_[tile] = false;
    --left_;
    cells += cells_of_a_tile;
    HeightTile made = TileOf(field, tile);
    // The number of the top has all bits.
    if (made.heights.find_first_not_of('\xFF') != std::string::npos)
      tiles.push_back(std::move(made));
  }
  return tiles;
}

HeightTile HeightChanges::TileOf(const HeightField& field, std::size_t tile) const {
  HeightTile made{.column = tile % tile_columns_ * kTileCells,
                  .row = tile / tile_columns_ * kTileCells};
  made.columns = std::min(kTileCells, size_.columns - made.column);
  made.rows = std::min(kTileCells, size_.rows - made.row);
  made.heights.reserve(2 * made.columns * made.rows);
  const std::size_t square = std::size_t{1} << level_;
  const std::size_t left = made.column * square;
  const std::size_t right = std::min(left + made.columns * square, field.columns());
  const std::size_t end = std::min((made.row + made.rows) * square, field.rows());
  LevelRows rows(right - left, level_);
  std::vector<std::uint16_t> cells(right - left);
  for (std::size_t row = made.row * square; row < end; ++row) {
    for (std::size_t column = left; column < right; ++column)
      cells[column - left] = HeightNumber(stock_, field.height(column, row));
    if (!rows.Add(cells) && (row + 1 < end || !rows.Finish())) continue;
    for (const std::uint16_t number : rows.row()) AddHeight(number, made.heights);
  }
  return made;
}

HeightGridTiles::HeightGridTiles(const HeightGridHead& head, int level, std::optional<Area> area)
    : cells_(head.size),
      size_(SizeAtLevel(head.size, level)),
      area_(area),
      level_rows_(head.size.columns, level),
      cells_row_(head.size.columns) {}

std::vector<HeightTile> HeightGridTiles::Add(std::string_view bytes) {
  std::vector<HeightTile> tiles;
  const std::size_t row_bytes = 2 * cells_.columns;
  while (!bytes.empty() && rows_read_ < cells_.rows) {
    const std::size_t taken = std::min(row_bytes - part_.size(), bytes.size());
    part_ += bytes.substr(0, taken);
    bytes.remove_prefix(taken);
    if (part_.size() < row_bytes) break;
    for (std::size_t column = 0; column < cells_.columns; ++column)
      cells_row_[column] = HeightAt(part_, column);
    part_.clear();
    AddRow(tiles);
  }
  return tiles;
}

void HeightGridTiles::AddRow(std::vector<HeightTile>& tiles) {
  const bool full = level_rows_.Add(cells_row_);
  const bool last = ++rows_read_ == cells_.rows;
  if (full || (last && level_rows_.Finish())) AddLevelRow(tiles);
}

void HeightGridTiles::AddLevelRow(std::vector<HeightTile>& tiles) {
  const std::span<const std::uint16_t> row = level_rows_.row();
  band_.insert(band_.end(), row.begin(), row.end());
  const std::size_t rows = band_.size() / size_.columns;
  if (rows == kTileCells || rows_cut_ + rows == size_.rows) CutTiles(tiles);
}

void HeightGridTiles::CutTiles(std::vector<HeightTile>& tiles) {
  const std::size_t rows = band_.size() / size_.columns;
  for (std::size_t column = 0; column < size_.columns; column += kTileCells) {
    HeightTile tile{.column = column,
                    .row = rows_cut_,
                    .columns = std::min(kTileCells, size_.columns - column),
                    .rows = rows};
    if (!Wanted(tile)) continue;
    tile.heights.reserve(2 * tile.columns * rows);
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t at = 0; at < tile.columns; ++at)
        AddHeight(band_[row * size_.columns + column + at], tile.heights);
    }
    tiles.push_back(std::move(tile));
  }
  rows_cut_ += rows;
  band_.clear();
}

bool HeightGridTiles::done() const {
  const std::size_t wanted = area_ ? std::min(area_->row + area_->rows, size_.rows) : size_.rows;
  return rows_cut_ >= wanted;
}

bool HeightGridTiles::Wanted(const HeightTile& tile) const {
  if (!area_) return true;
  return tile.column < area_->column + area_->columns &&
         area_->column < tile.column + tile.columns && tile.row < area_->row + area_->rows &&
         area_->row < tile.row + tile.rows;
}

}  // namespace rmlcell::simulation
