#include "engine/simulation/material/height_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "engine/core/number_text.h"
#include "engine/simulation/material/tool_sweep.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

// The greatest of what is found over the cells of a row, place by place from its begin and over
// its last four: many places are compared at once, which the cells of a row are not for one result.
class Greatest {
 public:
  explicit Greatest(float least) {
    places_.fill(least);
    last_four_.fill(least);
  }

  // Calls `each` with a cell, a number of cells from there on, and where theirs is noted. In fours,
  // the last of which may lie over the one before: one by one the last three take as long as all
  // others. What is found there is noted apart: the places would wait for each other.
  template <class Each>
  void Over(std::size_t count, Each each) {
    if (count < 4) return each(std::size_t{0}, count, places_.data());
    each(std::size_t{0}, count & ~std::size_t{3}, places_.data());
    each(count - 4, std::size_t{4}, last_four_.data());
  }

  float of_all() const {
    std::array<float, 4> four = last_four_;
    for (std::size_t place = 0; place < places_.size(); place += 4) {
      for (std::size_t k = 0; k < 4; ++k) four[k] = std::max(four[k], places_[place + k]);
    }
    return *std::max_element(four.begin(), four.end());
  }

 private:
  std::array<float, ToolSweep::kPieceCells> places_;
  std::array<float, 4> last_four_;
};

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

double HeightField::Cut(const MillTool& tool, const MachinePoint& from, const MachinePoint& to,
                        Rows rows) {
  if (std::min(from.z(), to.z()) >= stock_.top) return 0.0;
  ToolSweep sweep(*this, tool, from, to, rows);
  if (sweep.is_level()) return CutLevel(sweep);
  const auto bottom = static_cast<float>(stock_.bottom);
  Greatest taken(0.0f);
  for (auto pieces = sweep.Next(); !pieces.empty(); pieces = sweep.Next()) {
    for (const ToolSweep::Piece& piece : pieces) {
      taken.Over(piece.heights.size(), [&](std::size_t first, std::size_t count, float* most) {
        const float* const heights = piece.heights.data() + first;
        float* const cells = heights_.data() + piece.cell + first;
        for (std::size_t k = 0; k < count; ++k) {
          most[k] = std::max(most[k], std::max(cells[k], bottom) - std::max(heights[k], bottom));
          cells[k] = std::min(cells[k], heights[k]);
        }
      });
    }
  }
  return static_cast<double>(taken.of_all());
}

// The most is taken off the highest cell.
double HeightField::CutLevel(ToolSweep& sweep) {
  const auto bottom = static_cast<float>(stock_.bottom);
  const float level = sweep.level();
  Greatest before(bottom);
  for (auto row = sweep.NextLevel(); row.count > 0; row = sweep.NextLevel()) {
    before.Over(row.count, [&](std::size_t first, std::size_t count, float* highest) {
      float* const cells = heights_.data() + row.cell + first;
      for (std::size_t k = 0; k < count; ++k) {
        highest[k] = std::max(highest[k], cells[k]);
        cells[k] = std::min(cells[k], level);
      }
    });
  }
  return static_cast<double>(std::max(0.0f, before.of_all() - std::max(level, bottom)));
}

double HeightField::DepthOf(const MillTool& tool, const MachinePoint& from,
                            const MachinePoint& to) const {
  if (std::min(from.z(), to.z()) >= stock_.top) return 0.0;
  const auto bottom = static_cast<float>(stock_.bottom);
  Greatest depth(0.0f);
  ToolSweep sweep(*this, tool, from, to, all_rows());
  for (auto pieces = sweep.Next(); !pieces.empty(); pieces = sweep.Next()) {
    for (const ToolSweep::Piece& piece : pieces) {
      depth.Over(piece.heights.size(), [&](std::size_t first, std::size_t count, float* most) {
        const float* const heights = piece.heights.data() + first;
        const float* const cells = heights_.data() + piece.cell + first;
        for (std::size_t k = 0; k < count; ++k)
          most[k] = std::max(most[k], std::max(cells[k], bottom) - std::max(heights[k], bottom));
      });
    }
  }
  return static_cast<double>(depth.of_all());
}

double HeightField::ShankDepthOf(const MillTool& tool, const MachinePoint& from,
                                 const MachinePoint& to, Rows rows) const {
  using Collar = ToolSweep::Collar;
  const double shank = tool.shank_radius_mm > 0.0 ? tool.shank_radius_mm : tool.radius_mm;
  double deepest = 0.0;
  for (const Collar& collar : {Collar{tool.flute_mm > 0.0 ? shank : 0.0, tool.flute_mm},
                               Collar{tool.holder_radius_mm, tool.holder_from_mm}}) {
    if (!(collar.radius_mm > 0.0) || std::min(from.z(), to.z()) + collar.raised_mm >= stock_.top)
      continue;
    ToolSweep sweep(*this, collar, tool, from, to, rows);
    for (auto pieces = sweep.Next(); !pieces.empty(); pieces = sweep.Next()) {
      for (const ToolSweep::Piece& piece : pieces) {
        for (std::size_t k = 0; k < piece.heights.size(); ++k) {
          const double end = std::max(static_cast<double>(piece.heights[k]), stock_.bottom);
          deepest = std::max(deepest, static_cast<double>(heights_[piece.cell + k]) - end);
        }
      }
    }
  }
  return deepest;
}

double HeightField::removed_mm3() const {
  // Each row by itself, and some at a time: one sum waits for each of its numbers.
  constexpr std::size_t kRows = 4;
  double sum = 0.0;
  for (std::size_t first = 0; first < rows_; first += kRows) {
    const std::size_t count = std::min(kRows, rows_ - first);
    std::array<const float*, kRows> rows;
    for (std::size_t k = 0; k < kRows; ++k)
      rows[k] = &heights_[(first + std::min(k, count - 1)) * columns_];
    std::array<double, kRows> of_rows{};
    for (std::size_t column = 0; column < columns_; ++column) {
      for (std::size_t k = 0; k < kRows; ++k) {
        const auto height = static_cast<double>(rows[k][column]);
        of_rows[k] += stock_.top - std::max(height, stock_.bottom);
      }
    }
    for (std::size_t k = 0; k < count; ++k) sum += of_rows[k];
  }
  return sum * stock_.cell * stock_.cell;
}

double HeightField::whole_mm3() const {
  const double cells = static_cast<double>(heights_.size());
  return cells * stock_.cell * stock_.cell * (stock_.top - stock_.bottom);
}

double HeightField::deepest_cut_mm() const {
  std::array<float, 64> least;  // of each place in as many
  least.fill(static_cast<float>(stock_.top));
  for (std::size_t cell = 0; cell < heights_.size(); cell += least.size()) {
    const std::size_t count = std::min(least.size(), heights_.size() - cell);
    for (std::size_t k = 0; k < count; ++k) least[k] = std::min(least[k], heights_[cell + k]);
  }
  const double deepest = *std::min_element(least.begin(), least.end());
  return std::max(0.0, stock_.top - std::max(deepest, stock_.bottom));
}

}  // namespace rmlcell::simulation
