#include "engine/rml1/board/nearest_order.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace rmlcell::rml1 {
namespace {

class Squares {
 public:
  explicit Squares(std::span<const PlanePoint> places) : places_(places) {
    high_ = low_ = places.front();
    for (const PlanePoint& p : places) {
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
      high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
    }
    const double longest = std::max({high_.x - low_.x, high_.y - low_.y, 1e-9});
    side_ = std::max<std::ptrdiff_t>(
        1, static_cast<std::ptrdiff_t>(std::sqrt(static_cast<double>(places.size()))));
    edge_ = longest / static_cast<double>(side_) * (1.0 + 1e-9);
    squares_.resize(static_cast<std::size_t>(side_ * side_));
    for (std::size_t i = 0; i < places.size(); ++i)
      At(Index(places[i].x, low_.x), Index(places[i].y, low_.y)).push_back(i);
  }

  // Takes out and returns the nearest one that is left. Precondition: there is one.
  std::size_t TakeNearest(const PlanePoint& from) {
    const std::ptrdiff_t cx = Index(from.x, low_.x);
    const std::ptrdiff_t cy = Index(from.y, low_.y);
    std::optional<std::size_t> best;
    double least = HUGE_VAL;
    for (std::ptrdiff_t ring = 0; ring < 2 * side_; ++ring) {
      // What lies outside of the squares is still farther from a ring than their nearest square.
      if (best && static_cast<double>(ring - 1) * edge_ > least) break;
      for (std::ptrdiff_t y = cy - ring; y <= cy + ring; ++y) {
        if (y < 0 || y >= side_) continue;
        const bool whole_row = y == cy - ring || y == cy + ring;
        const std::ptrdiff_t step = whole_row ? 1 : 2 * ring;
        for (std::ptrdiff_t x = cx - ring; x <= cx + ring; x += step) {
          if (x < 0 || x >= side_) continue;
          for (const std::size_t i : At(x, y)) {
            const double distance = std::hypot(places_[i].x - from.x, places_[i].y - from.y);
            if (distance < least || (distance == least && i < *best)) {
              least = distance;
              best = i;
            }
          }
        }
      }
    }
    const PlanePoint& p = places_[*best];
    std::erase(At(Index(p.x, low_.x), Index(p.y, low_.y)), *best);
    return *best;
  }

 private:
  std::ptrdiff_t Index(double value, double low) const {
    const double index = std::floor((value - low) / edge_);
    return static_cast<std::ptrdiff_t>(std::clamp(index, 0.0, static_cast<double>(side_ - 1)));
  }
  std::vector<std::size_t>& At(std::ptrdiff_t x, std::ptrdiff_t y) {
    return squares_[static_cast<std::size_t>(y * side_ + x)];
  }

  std::span<const PlanePoint> places_;
  PlanePoint low_;
  PlanePoint high_;
  std::ptrdiff_t side_ = 1;
  double edge_ = 1.0;
  std::vector<std::vector<std::size_t>> squares_;
};

}  // namespace

std::vector<std::size_t> NearestOrder(std::span<const PlanePoint> places, const PlanePoint& from) {
  std::vector<std::size_t> order;
  if (places.empty()) return order;
  order.reserve(places.size());
  Squares squares(places);
  PlanePoint at = from;
  while (order.size() < places.size()) {
    order.push_back(squares.TakeNearest(at));
    at = places[order.back()];
  }
  return order;
}

}  // namespace rmlcell::rml1
