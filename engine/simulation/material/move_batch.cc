#include "engine/simulation/material/move_batch.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

// Some milliseconds of work: handing it to another thread and waiting for it costs some hundredths
// of one.
constexpr double kCellsOfBatch = 1 << 20;
constexpr std::size_t kMovesOfBatch = 4096;
constexpr double kCellsOfBand = 1 << 16;  // less is not worth another thread

}  // namespace

MoveBatch::Taken CutMove(HeightField& field, const MillTool& tool, const motion::MachinePoint& from,
                         const motion::MachinePoint& to, HeightField::Rows rows) {
  const double shank_depth = field.ShankDepthOf(tool, from, to, rows);
  return {.most_mm = field.Cut(tool, from, to, rows), .shank_depth_mm = shank_depth};
}

MoveBatch::MoveBatch(const HeightField& field, const MillTool& tool)
    : tool_(tool),
      widest_mm_(std::max({tool.radius_mm, tool.shank_radius_mm, tool.holder_radius_mm})),
      stock_(field.stock()),
      rows_(static_cast<double>(field.rows())),
      cells_more_(field.rows() + 1) {}

void MoveBatch::Add(const motion::MachinePoint& from, const motion::MachinePoint& to) {
  const double beside = widest_mm_ + stock_.cell;  // rounding, and more
  const auto row_at = [&](double y) {
    return static_cast<std::size_t>(
        std::min(rows_, std::max(0.0, (y - stock_.y_min) / stock_.cell)));
  };
  const HeightField::Rows rows{row_at(std::min(from.y(), to.y()) - beside),
                               row_at(std::max(from.y(), to.y()) + beside)};
  moves_.push_back({from, to, rows});
  if (std::min(from.z(), to.z()) >= stock_.top || rows.begin >= rows.end)
    return;  // over in no time
  const double radius = tool_.radius_mm;
  const double area_mm2 = radius * (2.0 * LengthOf(PlanOf(to - from)) + kPi * radius);
  const double cells = area_mm2 / (stock_.cell * stock_.cell);
  const double of_row = cells / static_cast<double>(rows.end - rows.begin);
  cells_ += cells;
  cells_more_[rows.begin] += of_row;
  cells_more_[rows.end] -= of_row;
}

bool MoveBatch::full() const { return cells_ >= kCellsOfBatch || moves_.size() >= kMovesOfBatch; }

// Of about as many cells each.
std::vector<HeightField::Rows> MoveBatch::Bands(std::size_t count) const {
  std::vector<HeightField::Rows> bands;
  const double of_band = cells_ / static_cast<double>(count);
  double of_row = 0.0;
  double before = 0.0;
  std::size_t begin = 0;
  const std::size_t rows = cells_more_.size() - 1;
  for (std::size_t row = 0; row < rows; ++row) {
    of_row += cells_more_[row];
    before += of_row;
    if (bands.size() + 1 == count || before < of_band * static_cast<double>(bands.size() + 1))
      continue;
    bands.push_back({begin, row + 1});
    begin = row + 1;
  }
  if (begin < rows) bands.push_back({begin, rows});
  return bands;
}

std::span<const MoveBatch::Taken> MoveBatch::Cut(HeightField& field, ParallelFor& parallel) {
  const auto worth = static_cast<std::size_t>(cells_ / kCellsOfBand);
  const std::vector<HeightField::Rows> bands =
      Bands(std::clamp<std::size_t>(worth, 1, parallel.width()));
  const std::size_t count = moves_.size();
  taken_.assign(bands.size() * count, {});
  parallel.Run(bands.size(), [&](std::size_t band) {
    const HeightField::Rows rows = bands[band];
    for (std::size_t k = 0; k < count; ++k) {
      const Move& move = moves_[k];
      if (move.rows.begin >= rows.end || move.rows.end <= rows.begin) continue;
      taken_[band * count + k] = CutMove(field, tool_, move.from, move.to, rows);
    }
  });
  for (std::size_t k = count; k < taken_.size(); ++k) {
    Taken& of_move = taken_[k % count];
    of_move.most_mm = std::max(of_move.most_mm, taken_[k].most_mm);
    of_move.shank_depth_mm = std::max(of_move.shank_depth_mm, taken_[k].shank_depth_mm);
  }
  moves_.clear();
  cells_ = 0.0;
  std::fill(cells_more_.begin(), cells_more_.end(), 0.0);
  return std::span<const Taken>(taken_).first(count);
}

}  // namespace rmlcell::simulation
