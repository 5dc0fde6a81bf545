#include "engine/simulation/material/height_field.h"

#include <algorithm>
#include <cmath>

#include "engine/core/number_text.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

struct Span {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
  void Include(double a, double b) {
    low = std::min(low, a);
    high = std::max(high, b);
  }
};

// Where a row at `y` meets the way of a disc of `radius`: the hull of what it has in common with
// the disc at both ends and with the strip between.
Span SweptPart(const MachinePoint& from, const MachinePoint& to, double radius, double y) {
  Span span;
  for (const MachinePoint& centre : {from, to}) {
    const double half_2 = radius * radius - (y - centre.y()) * (y - centre.y());
    if (half_2 < 0.0) continue;
    span.Include(centre.x() - std::sqrt(half_2), centre.x() + std::sqrt(half_2));
  }
  const PlanVector way = PlanOf(to - from);
  if (std::abs(way.y()) * radius <= 0.0) return span;
  // The strip is bounded by lines along the way, `radius` off it; the row meets both.
  const PlanVector off = PlanVector(-way.y(), way.x()) / LengthOf(way) * radius;
  for (const double side : {-1.0, 1.0}) {
    const double share = (y - (from.y() + side * off.y())) / way.y();
    if (share < 0.0 || share > 1.0) continue;
    const double x = from.x() + side * off.x() + share * way.x();
    span.Include(x, x);
  }
  return span;
}

bool IsFiniteBlock(const Stock& s) {
  for (const double v : {s.x_min, s.x_max, s.y_min, s.y_max, s.bottom, s.top, s.cell}) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

double CellsAlong(double low, double high, double cell) {
  constexpr double kLastDigits = 1e-9;  // 3 mm are thirty cells of 0.1
  return std::max(1.0, std::ceil((high - low) / cell - kLastDigits));
}

}  // namespace

Status CheckStock(const Stock& stock) {
  if (!IsFiniteBlock(stock) || !(stock.x_min < stock.x_max) || !(stock.y_min < stock.y_max) ||
      !(stock.bottom < stock.top)) {
    return InvalidArgument("the stock ends before it begins");
  }
  if (!(stock.cell > 0.0)) return InvalidArgument("the cells of the stock have no size");
  const double columns = CellsAlong(stock.x_min, stock.x_max, stock.cell);
  const double rows = CellsAlong(stock.y_min, stock.y_max, stock.cell);
  if (columns * rows <= static_cast<double>(HeightField::kCellsMax)) return {};
  return InvalidArgument("the stock has " + Told("columns", columns, {}, FixedText(columns, 0)) +
                         " by " + Told("rows", rows, {}, FixedText(rows, 0)) +
                         " cells, more than " + Told("most", HeightField::kCellsMax) +
                         ": make the cells larger");
}

HeightField::Size HeightField::SizeOf(const Stock& stock) {
  return {static_cast<std::size_t>(CellsAlong(stock.x_min, stock.x_max, stock.cell)),
          static_cast<std::size_t>(CellsAlong(stock.y_min, stock.y_max, stock.cell))};
}

Result<HeightField> HeightField::Of(const Stock& stock) {
  if (const Status sound = CheckStock(stock); !sound) return sound.error();
  const Size size = SizeOf(stock);
  return HeightField(stock, size.columns, size.rows);
}

HeightField::HeightField(const Stock& stock, std::size_t columns, std::size_t rows)
    : stock_(stock),
      columns_(columns),
      rows_(rows),
      heights_(columns * rows, static_cast<float>(stock.top)) {}

// Visits the cells whose centres the tool comes over, with the least height of its surface there.
template <class Visit>
void HeightField::ForEachSwept(const MillTool& tool, const MachinePoint& from,
                               const MachinePoint& to, Rows rows, Visit visit) const {
  if (std::min(from.z(), to.z()) >= stock_.top) return;
  const ToolPass pass(tool, from, to);
  switch (tool.shape) {
    case MillTool::Shape::kFlat:
      return ForEachUnder(
          pass, rows,
          [&pass](double along, double across) { return pass.LeastOfFlat(along, across); }, visit);
    case MillTool::Shape::kBall:
      return ForEachUnder(
          pass, rows,
          [&pass](double along, double across) { return pass.LeastOfBall(along, across); }, visit);
    case MillTool::Shape::kVee:
      return ForEachUnder(
          pass, rows,
          [&pass](double along, double across) { return pass.LeastOfVee(along, across); }, visit);
  }
}

template <class Least, class Visit>
void HeightField::ForEachUnder(const ToolPass& pass, Rows rows, Least least, Visit visit) const {
  const auto cell_at = [&](double place, double begin, std::size_t count) {
    const double index = std::ceil((place - begin) / stock_.cell - 0.5);
    return static_cast<std::size_t>(std::clamp(index, 0.0, static_cast<double>(count)));
  };
  const MachinePoint& from = pass.from();
  const MachinePoint& to = pass.to();
  const double y_low = std::min(from.y(), to.y()) - pass.radius_mm();
  const double y_high = std::max(from.y(), to.y()) + pass.radius_mm();
  const std::size_t end_row =
      std::min(std::min(rows.end, rows_), cell_at(y_high, stock_.y_min, rows_) + 1);
  for (std::size_t row = std::max(rows.begin, cell_at(y_low, stock_.y_min, rows_)); row < end_row;
       ++row) {
    const double y = stock_.y_min + (static_cast<double>(row) + 0.5) * stock_.cell;
    const Span span = SweptPart(from, to, pass.radius_mm(), y);
    if (!(span.low <= span.high)) continue;
    const std::size_t first = cell_at(span.low, stock_.x_min, columns_);
    const std::size_t end = std::min(columns_, cell_at(span.high, stock_.x_min, columns_) + 1);
    for (std::size_t column = first; column < end; ++column) {
      const double x = stock_.x_min + (static_cast<double>(column) + 0.5) * stock_.cell - from.x();
      visit(row * columns_ + column, static_cast<float>(least(pass.AlongOf(x, y - from.y()),
                                                              pass.AcrossOf(x, y - from.y()))));
    }
  }
}

double HeightField::Cut(const MillTool& tool, const MachinePoint& from, const MachinePoint& to,
                        Rows rows) {
  const auto bottom = static_cast<float>(stock_.bottom);
  float most = 0.0f;
  ForEachSwept(tool, from, to, rows, [&](std::size_t cell, float height) {
    const float before = heights_[cell];
    most = std::max(most, std::max(before, bottom) - std::max(height, bottom));
    heights_[cell] = std::min(before, height);
  });
  return static_cast<double>(most);
}

double HeightField::ShankDepthOf(const MillTool& tool, const MachinePoint& from,
                                 const MachinePoint& to) const {
  struct Collar {
    double radius_mm;
    double from_mm;
  };
  const double shank = tool.shank_radius_mm > 0.0 ? tool.shank_radius_mm : tool.radius_mm;
  double deepest = 0.0;
  for (const Collar& collar : {Collar{tool.flute_mm > 0.0 ? shank : 0.0, tool.flute_mm},
                               Collar{tool.holder_radius_mm, tool.holder_from_mm}}) {
    if (!(collar.radius_mm > 0.0) || std::min(from.z(), to.z()) + collar.from_mm >= stock_.top)
      continue;
    const ToolPass pass({.radius_mm = collar.radius_mm}, from, to);
    ForEachUnder(
        pass, all_rows(),
        [&](double along, double across) {
          return pass.LeastBefore(along, across, tool.radius_mm) + collar.from_mm;
        },
        [&](std::size_t cell, float height) {
          const double end = std::max(static_cast<double>(height), stock_.bottom);
          deepest = std::max(deepest, static_cast<double>(heights_[cell]) - end);
        });
  }
  return deepest;
}

double HeightField::DepthOf(const MillTool& tool, const MachinePoint& from,
                            const MachinePoint& to) const {
  const auto bottom = static_cast<float>(stock_.bottom);
  float deepest = 0.0f;
  ForEachSwept(tool, from, to, all_rows(), [&](std::size_t cell, float height) {
    if (heights_[cell] > bottom)
      deepest = std::max(deepest, heights_[cell] - std::max(height, bottom));
  });
  return static_cast<double>(deepest);
}

double HeightField::removed_mm3() const {
  double sum = 0.0;
  for (std::size_t row = 0; row < rows_; ++row) {
    double of_row = 0.0;
    for (std::size_t column = 0; column < columns_; ++column) {
      const double height =
          std::max(static_cast<double>(heights_[row * columns_ + column]), stock_.bottom);
      of_row += stock_.top - height;
    }
    sum += of_row;
  }
  return sum * stock_.cell * stock_.cell;
}

double HeightField::remaining_mm3() const {
  const double cells = static_cast<double>(heights_.size());
  return cells * stock_.cell * stock_.cell * (stock_.top - stock_.bottom) - removed_mm3();
}

double HeightField::deepest_cut_mm() const {
  const double least = *std::min_element(heights_.begin(), heights_.end());
  return std::max(0.0, stock_.top - std::max(least, stock_.bottom));
}

}  // namespace rmlcell::simulation
