#include "engine/simulation/material/target.h"

#include <algorithm>
#include <cmath>

#include "engine/simulation/material/cell_picture.h"

namespace rmlcell::simulation {
namespace {

// Heights are in single precision, and in a picture in 65535 steps: less is no difference.
constexpr double kSameHeight_mm = 5e-4;

// As a verdict has it: what is told as the tolerance is within it.
bool IsBeyond(double difference_mm, double tolerance_mm) {
  return difference_mm > tolerance_mm + 1e-5;
}

constexpr Colour kGood = {214, 214, 214};
constexpr Colour kSilent = {255, 255, 255};
constexpr Colour kTooDeep = {190, 0, 0};
constexpr Colour kTooMuch = {0, 60, 200};

struct Difference {
  double left_mm = 0.0;
  double deep_mm = 0.0;
  bool compared = false;
};

class TargetComparison {
 public:
  TargetComparison(const HeightField& field, const Target& target)
      : field_(field),
        heights_(*target.heights),
        bottom_(static_cast<float>(field.stock().bottom)) {}

  Difference At(std::size_t column, std::size_t row) const {
    if (std::isnan(heights_[row * field_.columns() + column])) return {};
    float low = HUGE_VALF;
    float high = -HUGE_VALF;
    const std::size_t row_end = std::min(row + 2, field_.rows());
    const std::size_t column_end = std::min(column + 2, field_.columns());
    for (std::size_t r = row > 0 ? row - 1 : 0; r < row_end; ++r) {
      for (std::size_t c = column > 0 ? column - 1 : 0; c < column_end; ++c) {
        // Nothing can be left below the bottom; what is no number leaves both as they are.
        const float height = heights_[r * field_.columns() + c];
        low = std::min(low, height);
        high = std::max(high, height);
      }
    }
    const double here = std::max(field_.height(column, row), bottom_);
    const double left = here - std::max(high, bottom_);
    const double deep = std::max(low, bottom_) - here;
    return {.left_mm = left > kSameHeight_mm ? left : 0.0,
            .deep_mm = deep > kSameHeight_mm ? deep : 0.0,
            .compared = true};
  }

 private:
  const HeightField& field_;
  const std::vector<float>& heights_;
  float bottom_;
};

// From grey to the full colour at ten times the tolerance, and never so pale that it is overlooked.
Colour Strong(const Colour& colour, double difference_mm, double tolerance_mm) {
  const double most = std::max(10.0 * tolerance_mm, 1e-3);
  const double share = 0.3 + 0.7 * std::min(1.0, difference_mm / most);
  Colour mixed{};
  for (std::size_t k = 0; k < 3; ++k) {
    mixed[k] = static_cast<int>(std::lround(kGood[k] + share * (colour[k] - kGood[k])));
  }
  return mixed;
}

}  // namespace

TargetFigures CompareWithTarget(const HeightField& field, const Target& target) {
  const TargetComparison comparison(field, target);
  const Stock& stock = field.stock();
  TargetFigures figures{.tolerance_mm = target.tolerance_mm};
  const auto place = [&](std::size_t column, std::size_t row) {
    return PlanePlace{stock.x_min + (static_cast<double>(column) + 0.5) * stock.cell,
                      stock.y_min + (static_cast<double>(row) + 0.5) * stock.cell};
  };
  std::size_t compared = 0;
  std::size_t good = 0;
  for (std::size_t row = 0; row < field.rows(); ++row) {
    for (std::size_t column = 0; column < field.columns(); ++column) {
      const Difference difference = comparison.At(column, row);
      if (!difference.compared) continue;
      ++compared;
      if (!IsBeyond(std::max(difference.left_mm, difference.deep_mm), target.tolerance_mm)) ++good;
      figures.left_mm3 += difference.left_mm;
      figures.deep_mm3 += difference.deep_mm;
      if (difference.left_mm > figures.left_mm) {
        figures.left_mm = difference.left_mm;
        figures.left_at = place(column, row);
      }
      if (difference.deep_mm > figures.deep_mm) {
        figures.deep_mm = difference.deep_mm;
        figures.deep_at = place(column, row);
      }
    }
  }
  const double area = stock.cell * stock.cell;
  figures.left_mm3 *= area;
  figures.deep_mm3 *= area;
  figures.compared_mm2 = static_cast<double>(compared) * area;
  if (compared > 0)
    figures.good_percent = 100.0 * static_cast<double>(good) / static_cast<double>(compared);
  return figures;
}

bool WriteDifference(const HeightField& field, const Target& target,
                     const std::function<bool(std::string_view)>& sink) {
  const TargetComparison comparison(field, target);
  return WriteCellPicture(
      field,
      [&](std::size_t column, std::size_t row) {
        const Difference difference = comparison.At(column, row);
        if (!difference.compared) return kSilent;
        if (IsBeyond(difference.deep_mm, target.tolerance_mm))
          return Strong(kTooDeep, difference.deep_mm, target.tolerance_mm);
        if (IsBeyond(difference.left_mm, target.tolerance_mm))
          return Strong(kTooMuch, difference.left_mm, target.tolerance_mm);
        return kGood;
      },
      sink);
}

}  // namespace rmlcell::simulation
