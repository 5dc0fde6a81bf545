#include "engine/simulation/material/tool_sweep.h"

#include <algorithm>
#include <cstdint>

namespace rmlcell::simulation {

using motion::MachinePoint;

namespace {

std::size_t ColumnAt(const HeightField& field, double x) {
  const double cells = (x - field.stock().x_min) / field.stock().cell;
  return static_cast<std::size_t>(
      std::min(static_cast<double>(field.columns()), std::max(0.0, cells)));
}

}  // namespace

ToolSweep::Surface ToolSweep::SurfaceOf(const MillTool& tool, const ToolPass& pass) {
  switch (tool.shape) {
    case MillTool::Shape::kFlat:
      return pass.is_level() ? Surface::kLevel
             : pass.rises()  ? Surface::kFlatUp
                             : Surface::kFlatDown;
    case MillTool::Shape::kBall:
      return pass.plunges()    ? Surface::kPlungedBall
             : pass.is_level() ? Surface::kLevelBall
                               : Surface::kBall;
    case MillTool::Shape::kVee:
      return pass.is_level() ? Surface::kLevelVee : Surface::kVee;
  }
  return Surface::kLevel;
}

ToolSweep::ToolSweep(const HeightField& field, const ToolPass& pass, Surface surface,
                     HeightField::Rows rows)
    : field_(field),
      pass_(pass),
      surface_(surface),
      leftmost_(ColumnAt(field, std::min(pass.from().x(), pass.to().x()) - pass.radius_mm())),
      rightmost_(ColumnAt(field, std::max(pass.from().x(), pass.to().x()) + pass.radius_mm()) + 1),
      swept_(field, pass.from(), pass.to(), pass.radius_mm()),
      row_(std::max(rows.begin, swept_.rows().begin)),
      end_row_(std::min(rows.end, swept_.rows().end)) {
  if (surface == Surface::kFlatUp || surface == Surface::kFlatDown) {
    // Not the very edge: there the place of the tool counts.
    stood_.emplace(field, pass.lower_end(), pass.lower_end(), pass.radius_mm() - 2.0 * kOnEdge_mm);
  }
  if (stood_ || surface == Surface::kLevel) level_.fill(static_cast<float>(pass.least_height()));
}

ToolSweep::ToolSweep(const HeightField& field, const MillTool& tool, const ToolPass& pass,
                     HeightField::Rows rows)
    : ToolSweep(field, pass, SurfaceOf(tool, pass), rows) {}

ToolSweep::ToolSweep(const HeightField& field, const MillTool& tool, const MachinePoint& from,
                     const MachinePoint& to, HeightField::Rows rows)
    : ToolSweep(field, tool, ToolPass(tool, from, to), rows) {}

ToolSweep::ToolSweep(const HeightField& field, const Collar& collar, const MillTool& tool,
                     const MachinePoint& from, const MachinePoint& to, HeightField::Rows rows)
    : ToolSweep(field, ToolPass({.radius_mm = collar.radius_mm}, from, to), Surface::kCollar,
                rows) {
  collar_ = collar;
  cutter_radius_mm_ = tool.radius_mm;
}

std::span<const ToolSweep::Piece> ToolSweep::Next() {
  switch (surface_) {
    case Surface::kLevel:
      return NextBy([this](double, double) { return pass_.least_height(); });
    case Surface::kFlatUp:
      return NextBy(
          [this](double along, double across) { return pass_.LeastOfFlatUp(along, across); });
    case Surface::kFlatDown:
      return NextBy(
          [this](double along, double across) { return pass_.LeastOfFlatDown(along, across); });
    case Surface::kBall:
      return NextBy(
          [this](double along, double across) { return pass_.LeastOfBall(along, across); });
    case Surface::kLevelBall:
      return NextBy(
          [this](double along, double across) { return pass_.LeastOfLevelBall(along, across); });
    case Surface::kPlungedBall:
      return NextBy(
          [this](double along, double across) { return pass_.LeastOfPlungedBall(along, across); });
    case Surface::kVee:
      return NextBy(
          [this](double along, double across) { return pass_.LeastOfVee(along, across); });
    case Surface::kLevelVee:
      return NextBy(
          [this](double along, double across) { return pass_.LeastOfLevelVee(along, across); });
    case Surface::kCollar:
      return NextBy([this](double along, double across) {
        return pass_.LeastBefore(along, across, cutter_radius_mm_) + collar_.raised_mm;
      });
  }
  return {};
}

// False: there is none. A row may have no cells of the field.
bool ToolSweep::ToNextRow() {
  if (next_found_ == found_rows_) {
    row_ += found_rows_;
    if (row_ >= end_row_) return false;
    next_found_ = 0;
    found_rows_ = std::min(SweptRows::kAtOnce, end_row_ - row_);
    swept_.Find(row_, found_rows_, columns_);
    if (stood_) stood_->Find(row_, found_rows_, level_columns_);
  }
  const std::size_t k = next_found_++;
  column_ = static_cast<std::size_t>(columns_.begin[k]);
  end_ = std::max(column_, static_cast<std::size_t>(columns_.end[k]));
  level_begin_ = level_end_ = end_;
  if (stood_) {
    level_begin_ = std::clamp(static_cast<std::size_t>(level_columns_.begin[k]), column_, end_);
    level_end_ = std::clamp(static_cast<std::size_t>(level_columns_.end[k]), level_begin_, end_);
  }
  return true;
}

ToolSweep::LevelPiece ToolSweep::NextLevel() {
  while (column_ == end_) {
    if (!ToNextRow()) return {};
  }
  const std::size_t first = column_;
  column_ = std::min(end_, column_ + kPieceCells);
  return {(row_ + next_found_ - 1) * field_.columns() + first, column_ - first};
}

template <class Least>
std::span<const ToolSweep::Piece> ToolSweep::NextBy(Least least) {
  std::size_t told = 0;
  while (told < kPieces && (column_ < end_ || ToNextRow())) {
    const std::size_t count = std::min(kPieceCells, end_ - column_);
    if (count == 0) continue;
    const std::size_t row = row_ + next_found_ - 1;
    const std::size_t end = column_ + count;
    pieces_[told].cell = row * field_.columns() + column_;
    pieces_[told].heights = std::span<const float>(level_).first(count);
    if (surface_ != Surface::kLevel) {
      PieceHeights& heights = heights_[told];
      pieces_[told].heights = std::span<const float>(heights).first(count);
      const std::size_t level_begin = std::clamp(level_begin_, column_, end);
      const std::size_t level_end = std::clamp(level_end_, column_, end);
      // In this order: of each some more are written than are asked for.
      WorkOut(row, column_, level_begin, least, heights.data());
      std::copy_n(level_.data(), level_end - level_begin, heights.data() + (level_begin - column_));
      WorkOut(row, level_end, end, least, heights.data() + (level_end - column_));
    }
    column_ = end;
    ++told;
  }
  return std::span<const Piece>(pieces_).first(told);
}

// Of some columns of a piece, with those that are worked out besides, and more of them on both
// sides: the rows of a disc begin further left and end further right than its first one.
const double* ToolSweep::PlacesOf(std::size_t begin, std::size_t end) {
  constexpr std::size_t kLeft = 32;
  static_assert(kLeft + kPieceCells + kMoreWorkedOut <= kPlaces);
  if (begin < first_place_ || end + kMoreWorkedOut > end_place_) {
    const bool all_fit = end + kMoreWorkedOut <= leftmost_ + kPlaces;
    first_place_ = std::min(begin, all_fit ? leftmost_ : std::max(begin, kLeft) - kLeft);
    end_place_ = std::min(first_place_ + kPlaces, std::max(end, rightmost_) + kMoreWorkedOut);
    const Stock& stock = field_.stock();
    const auto first = static_cast<std::int32_t>(first_place_);
    const auto count = static_cast<std::int32_t>(end_place_ - first_place_);
    for (std::int32_t k = 0; k < count; ++k) {
      places_[static_cast<std::size_t>(k)] =
          stock.x_min + (static_cast<double>(first + k) + 0.5) * stock.cell - pass_.from().x();
    }
  }
  return &places_[begin - first_place_];
}

// Up to kMoreWorkedOut more than are asked for: the last ones by themselves would take as long as
// all others.
template <class Least>
void ToolSweep::WorkOut(std::size_t row, std::size_t begin, std::size_t end, Least least,
                        float* heights) {
  if (begin == end) return;
  const Stock& stock = field_.stock();
  const double y = stock.y_min + (static_cast<double>(row) + 0.5) * stock.cell - pass_.from().y();
  const double* const x = PlacesOf(begin, end);
  const std::size_t count = (end - begin + kMoreWorkedOut) & ~kMoreWorkedOut;
  for (std::size_t k = 0; k < count; ++k)
    heights[k] = static_cast<float>(least(pass_.AlongOf(x[k], y), pass_.AcrossOf(x[k], y)));
}

}  // namespace rmlcell::simulation
