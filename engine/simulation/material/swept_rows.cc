#include "engine/simulation/material/swept_rows.h"

#include <algorithm>
#include <cmath>

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;

// How many centres of cells lie before a place that is `cells` beyond the first one, and one cell.
// What is no number is none.
double CountBefore(double cells, double most) { return std::min(most, std::max(0.0, cells)); }

}  // namespace

SweptRows::SweptRows(const HeightField& field, const MachinePoint& from, const MachinePoint& to,
                     double radius_mm) {
  const Stock& stock = field.stock();
  const MachinePoint& low = from.y() <= to.y() ? from : to;
  const MachinePoint& high = from.y() <= to.y() ? to : from;
  const double radius = radius_mm + kOnEdge_mm;
  const PlanVector way = PlanOf(high - low);
  cells_to_mm_ = stock.cell;
  mm_to_cells_ = 1.0 / stock.cell;
  up_to_first_row_ = stock.y_min + 0.5 * stock.cell - low.y();
  first_column_ = (low.x() - stock.x_min) / stock.cell + 0.5;
  columns_ = static_cast<double>(field.columns());
  radius_2_ = radius * radius;
  length_ = std::sqrt(way.x() * way.x() + way.y() * way.y());
  way_x_ = length_ > 0.0 ? way.x() / length_ : 0.0;
  way_y_ = length_ > 0.0 ? way.y() / length_ : 0.0;
  // Level ways and plunges: all rows above the tangent are at one end, all below at the other.
  steps_of_up_ = 1.0 / std::max(way_y_, 1e-300);
  tangent_ = radius * way_x_;
  const auto rows_before = [&](double up) {
    const double cells = (up - up_to_first_row_) * mm_to_cells_ + 1.0;
    return static_cast<std::size_t>(CountBefore(cells, static_cast<double>(field.rows())));
  };
  rows_ = {rows_before(-radius), rows_before(high.y() - low.y() + radius)};
}

// A row is left where some place of the disc on its way is left the most, and that place is known:
// the one whose side runs along the way there, or an end.
void SweptRows::Find(std::size_t first, std::size_t count, Columns& columns) const {
  const auto begin_row = static_cast<std::int32_t>(first);
  const auto rows = static_cast<std::int32_t>(count);
  for (std::int32_t k = 0; k < rows; ++k) {
    const double up = static_cast<double>(begin_row + k) * cells_to_mm_ + up_to_first_row_;
    const auto half_2 = [&](double along) {
      const double beside = up - along * way_y_;
      return std::max(0.0, radius_2_ - beside * beside);
    };
    const double left = std::min(length_, std::max(0.0, (up - tangent_) * steps_of_up_));
    const double right = std::min(length_, std::max(0.0, (up + tangent_) * steps_of_up_));
    const double x_left = left * way_x_ - std::sqrt(half_2(left));
    const double x_right = right * way_x_ + std::sqrt(half_2(right));
    const auto index = static_cast<std::size_t>(k);
    columns.begin[index] =
        static_cast<std::int32_t>(CountBefore(x_left * mm_to_cells_ + first_column_, columns_));
    columns.end[index] =
        static_cast<std::int32_t>(CountBefore(x_right * mm_to_cells_ + first_column_, columns_));
  }
}

}  // namespace rmlcell::simulation
