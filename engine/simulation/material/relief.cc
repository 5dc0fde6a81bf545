#include "engine/simulation/material/relief.h"

#include <algorithm>
#include <cmath>

#include "engine/simulation/material/cell_picture.h"

namespace rmlcell::simulation {
namespace {

constexpr Colour kUntouched = {222, 184, 135};
constexpr Colour kMilled = {190, 200, 210};
constexpr Colour kThrough = {24, 48, 104};
constexpr double kDeepest = 0.55;  // how bright milled ground is at the bottom
constexpr double kShade = 0.25;    // how bright a slope in the shade is

// How much light falls on a slope, by what falls on level ground: from the upper left, 45 degrees
// high, which is the direction (-1/2, 1/2, sqrt(1/2)).
double LightOn(double slope_x, double slope_y) {
  const double level = std::sqrt(0.5);
  const double facing = 0.5 * slope_x - 0.5 * slope_y + level;
  const double direct = facing / std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y) / level;
  return kShade + (1.0 - kShade) * std::max(0.0, direct);
}

class Shading {
 public:
  explicit Shading(const HeightField& field) : field_(field), stock_(field.stock()) {}

  Colour At(std::size_t column, std::size_t row) const {
    const double height = field_.height(column, row);
    if (height <= static_cast<float>(stock_.bottom)) return kThrough;
    const double light = LightOn(SlopeX(column, row), SlopeY(column, row));
    if (height >= static_cast<float>(stock_.top)) return Lit(kUntouched, light);
    const double depth = (stock_.top - height) / (stock_.top - stock_.bottom);
    return Lit(kMilled, light * (1.0 - (1.0 - kDeepest) * depth));
  }

 private:
  static Colour Lit(const Colour& colour, double light) {
    Colour lit{};
    for (std::size_t k = 0; k < 3; ++k)
      lit[k] = static_cast<int>(std::clamp(std::round(colour[k] * light), 0.0, 255.0));
    return lit;
  }

  // Between both neighbours; at the edge of the block the cell is its own neighbour.
  double SlopeX(std::size_t column, std::size_t row) const {
    const std::size_t low = column > 0 ? column - 1 : 0;
    const std::size_t high = std::min(column + 1, field_.columns() - 1);
    return Rise(field_.height(low, row), field_.height(high, row), high - low);
  }
  double SlopeY(std::size_t column, std::size_t row) const {
    const std::size_t low = row > 0 ? row - 1 : 0;
    const std::size_t high = std::min(row + 1, field_.rows() - 1);
    return Rise(field_.height(column, low), field_.height(column, high), high - low);
  }
  double Rise(float low, float high, std::size_t cells) const {
    if (cells == 0) return 0.0;
    const double floor = stock_.bottom;
    return (std::max<double>(high, floor) - std::max<double>(low, floor)) /
           (static_cast<double>(cells) * stock_.cell);
  }

  const HeightField& field_;
  const Stock& stock_;
};

}  // namespace

bool WriteRelief(const HeightField& field, const std::function<bool(std::string_view)>& sink) {
  const Shading shading(field);
  return WriteCellPicture(
      field, [&](std::size_t column, std::size_t row) { return shading.At(column, row); }, sink);
}

}  // namespace rmlcell::simulation
