#include "engine/simulation/material/target_files.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rmlcell::simulation {
namespace {

constexpr float kSaysNothing = std::numeric_limits<float>::quiet_NaN();

// How often a cell may be looked at on average: bodies lie over themselves some times, not
// hundreds.
constexpr std::uint64_t kLayersMax = 256;
constexpr std::uint64_t kLooksFree = 1u << 24;
constexpr std::uint64_t kLooksUnasked = 1u << 22;  // about 20 ms

class TargetRaster {
 public:
  explicit TargetRaster(const Stock& stock) : stock_(stock), size_(HeightField::SizeOf(stock)) {
    heights_.assign(size_.columns * size_.rows, kSaysNothing);
    looks_left_ = kLooksFree + kLayersMax * heights_.size();
  }

  // The cells whose centres lie in a rectangle, seen from above.
  struct Cells {
    std::size_t left, right, front, back;  // the ends not included
    bool none() const { return left >= right || front >= back; }
  };
  Cells CellsIn(double x_low, double x_high, double y_low, double y_high) const {
    return {First(x_low, stock_.x_min, size_.columns), End(x_high, stock_.x_min, size_.columns),
            First(y_low, stock_.y_min, size_.rows), End(y_high, stock_.y_min, size_.rows)};
  }

  void Fill(const Cells& cells, float height) {
    for (std::size_t row = cells.front; row < cells.back; ++row) {
      for (std::size_t column = cells.left; column < cells.right; ++column)
        heights_[row * size_.columns + column] = height;
    }
  }

  // Raises the cells under a triangle to it. False: that was too much work.
  bool Raise(const StlTriangle& triangle);
  std::uint64_t looks_left() const { return looks_left_; }

  std::vector<float> Take() { return std::move(heights_); }

 private:
  // Corners and centres of cells are the same places but for the last digits.
  static constexpr double kLastDigits = 1e-6;

  std::size_t First(double place, double begin, std::size_t count) const {
    return Clamped(std::ceil((place - begin) / stock_.cell - 0.5 - kLastDigits), count);
  }
  std::size_t End(double place, double begin, std::size_t count) const {
    return Clamped(std::floor((place - begin) / stock_.cell - 0.5 + kLastDigits) + 1.0, count);
  }
  static std::size_t Clamped(double index, std::size_t count) {
    return static_cast<std::size_t>(std::clamp(index, 0.0, static_cast<double>(count)));
  }

  Stock stock_;
  HeightField::Size size_;
  std::vector<float> heights_;
  std::uint64_t looks_left_;
};

bool TargetRaster::Raise(const StlTriangle& triangle) {
  const auto& [a, b, c] = triangle.corners;
  const auto edge_to = [&a = a](const std::array<float, 3>& corner) -> motion::MachineVector {
    return {double{corner[0]} - a[0], double{corner[1]} - a[1], double{corner[2]} - a[2]};
  };
  const motion::MachineVector normal = edge_to(b).cross(edge_to(c));
  // Upright ones have no area from above: their upper edges belong to others, too.
  if (std::abs(normal.z()) < 1e-12) return true;
  const double slope_x = -normal.x() / normal.z();
  const double slope_y = -normal.y() / normal.z();
  const auto [z_low, z_high] = std::minmax({a[2], b[2], c[2]});
  const auto [y_low, y_high] = std::minmax({a[1], b[1], c[1]});
  const Cells rows = CellsIn(0.0, 0.0, y_low, y_high);
  for (std::size_t row = rows.front; row < rows.back; ++row) {
    const double y = std::clamp(stock_.y_min + (static_cast<double>(row) + 0.5) * stock_.cell,
                                double{y_low}, double{y_high});
    double x_low = HUGE_VAL;
    double x_high = -HUGE_VAL;
    for (const auto& [p, q] : {std::pair{&a, &b}, std::pair{&b, &c}, std::pair{&c, &a}}) {
      const double from = (*p)[1], to = (*q)[1];
      if (y < std::min(from, to) || y > std::max(from, to)) continue;
      const double share = from == to ? 0.0 : (y - from) / (to - from);
      const double x = (*p)[0] + share * (double{(*q)[0]} - (*p)[0]);
      x_low = std::min({x_low, x, from == to ? double{(*q)[0]} : x});
      x_high = std::max({x_high, x, from == to ? double{(*q)[0]} : x});
    }
    const std::size_t left = First(x_low, stock_.x_min, size_.columns);
    const std::size_t right = End(x_high, stock_.x_min, size_.columns);
    const std::uint64_t looks = 1 + (right > left ? right - left : 0);
    if (looks > looks_left_) return false;
    looks_left_ -= looks;
    for (std::size_t column = left; column < right; ++column) {
      const double x = stock_.x_min + (static_cast<double>(column) + 0.5) * stock_.cell;
      const double z = a[2] + slope_x * (x - a[0]) + slope_y * (y - a[1]);
      float& height = heights_[row * size_.columns + column];
      height = std::max(height, static_cast<float>(std::clamp<double>(z, z_low, z_high)));
    }
  }
  return true;
}

}  // namespace

std::vector<float> TargetOfMap(const HeightMap& map, const Stock& stock) {
  const HeightField::Size size = HeightField::SizeOf(stock);
  std::vector<float> heights;
  heights.reserve(size.columns * size.rows);
  // Which cell of the map a place lies in; none: beyond it.
  const auto cell_of = [&](double place, double begin, std::size_t count) {
    const double index = std::floor((place - begin) / map.stock.cell);
    return index >= 0.0 && index < static_cast<double>(count) ? static_cast<std::size_t>(index)
                                                              : count;
  };
  for (std::size_t row = 0; row < size.rows; ++row) {
    const double y = stock.y_min + (static_cast<double>(row) + 0.5) * stock.cell;
    const std::size_t map_row = cell_of(y, map.stock.y_min, map.rows);
    for (std::size_t column = 0; column < size.columns; ++column) {
      const double x = stock.x_min + (static_cast<double>(column) + 0.5) * stock.cell;
      const std::size_t map_column = cell_of(x, map.stock.x_min, map.columns);
      const bool there = map_row < map.rows && map_column < map.columns;
      heights.push_back(there ? map.heights[map_row * map.columns + map_column] : kSaysNothing);
    }
  }
  return heights;
}

Result<std::vector<float>> TargetOfBody(const std::vector<StlTriangle>& body, const Stock& stock,
                                        const StillWanted& wanted) {
  double x_low = HUGE_VAL, x_high = -HUGE_VAL, y_low = HUGE_VAL, y_high = -HUGE_VAL;
  for (const StlTriangle& triangle : body) {
    for (const auto& corner : triangle.corners) {
      x_low = std::min(x_low, double{corner[0]});
      x_high = std::max(x_high, double{corner[0]});
      y_low = std::min(y_low, double{corner[1]});
      y_high = std::max(y_high, double{corner[1]});
    }
  }
  TargetRaster raster(stock);
  const TargetRaster::Cells extent = raster.CellsIn(x_low, x_high, y_low, y_high);
  if (extent.none())
    return InvalidArgument("the target lies beside the block: its origin is the work origin, mm");
  raster.Fill(extent, static_cast<float>(stock.bottom));
  std::uint64_t ask_at = raster.looks_left();
  for (const StlTriangle& triangle : body) {
    if (raster.looks_left() <= ask_at) {
      if (wanted && !wanted()) return Error{ErrorCode::kCellCancelled, {}, {}};
      ask_at = raster.looks_left() - std::min(raster.looks_left(), kLooksUnasked);
    }
    if (!raster.Raise(triangle)) {
      return Error{
          ErrorCode::kCellTooLarge, "the STL lies over itself hundreds of times; simplify it", {}};
    }
  }
  return raster.Take();
}

bool IsPng(std::string_view bytes) { return bytes.substr(0, 4) == "\x89PNG"; }

bool IsTargetFile(std::string_view bytes, std::string_view file_name) {
  if (IsPng(bytes)) return true;
  const std::string_view end = file_name.substr(std::min(file_name.rfind('.'), file_name.size()));
  return end == ".stl" || end == ".STL" || end == ".Stl";
}

Result<std::vector<float>> ReadTarget(std::string_view bytes, const Stock& stock,
                                      const StillWanted& wanted) {
  if (IsPng(bytes)) {
    const Result<HeightMap> map = ReadHeightMap(bytes);
    if (!map) return map.error();
    return TargetOfMap(*map, stock);
  }
  const Result<std::vector<StlTriangle>> body = ReadStl(bytes);
  if (!body) return body.error();
  return TargetOfBody(*body, stock, wanted);
}

}  // namespace rmlcell::simulation
