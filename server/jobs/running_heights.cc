#include "server/jobs/running_heights.h"

#include "engine/simulation/material/height_tiles.h"

namespace rmlcell::server {
namespace {

constexpr int kTile = static_cast<int>(simulation::kTileCells);

bool IsForAScreen(const v1::HeightGrid& grid) {
  constexpr int kMost = static_cast<int>(simulation::kScreenCells);
  return grid.columns() > 0 && grid.columns() <= kMost && grid.rows() > 0 && grid.rows() <= kMost;
}

}  // namespace

RunningHeights::Part RunningHeights::Look(std::uint64_t seen) const {
  const std::lock_guard lock(mutex_);
  Part part{.grid = grid_, .tiles = {}, .seen = seen};
  for (auto change = changes_.upper_bound(seen); change != changes_.end(); ++change) {
    if (part.tiles.size() == kTilesAtOnce) return part;
    part.tiles.push_back(tiles_.at(change->second).tile);
    part.seen = change->first;
  }
  part.ended = ended();
  part.stored = stored();
  return part;
}

void RunningHeights::Add(const v1::WorkerHeights& heights) {
  const std::lock_guard lock(mutex_);
  if (!grid_ && heights.has_grid() && IsForAScreen(heights.grid())) grid_ = heights.grid();
  for (const v1::HeightTile& tile : heights.tiles()) {
    if (!Fits(tile)) continue;
    const std::pair<int, int> place{tile.row(), tile.column()};
    Known& known = tiles_[place];
    if (known.version != 0) changes_.erase(known.version);
    known = {++version_, tile};
    changes_.emplace(version_, place);
  }
  WakeAll();
}

bool RunningHeights::Fits(const v1::HeightTile& tile) const {
  if (!grid_) return false;
  const auto part_of = [](int from, int count, int all) {
    return from >= 0 && from % kTile == 0 && count > 0 && count <= kTile && from <= all - count;
  };
  return part_of(tile.column(), tile.columns(), grid_->columns()) &&
         part_of(tile.row(), tile.rows(), grid_->rows()) &&
         tile.heights().size() ==
             std::size_t{2} * static_cast<std::size_t>(tile.columns() * tile.rows());
}

}  // namespace rmlcell::server
