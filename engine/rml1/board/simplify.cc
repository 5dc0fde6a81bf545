#include "engine/rml1/board/simplify.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rmlcell::rml1 {
namespace {

// From a point to a line between two others, its ends included.
double DistanceToLine(const PlanePoint& p, const PlanePoint& a, const PlanePoint& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double square = dx * dx + dy * dy;
  const double share =
      square > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - share * dx, p.y - a.y - share * dy);
}

}  // namespace

Loop Simplified(const Loop& loop, double tolerance) {
  if (loop.size() < 4) return loop;
  const auto at = [&](std::size_t i) -> const PlanePoint& { return loop[i % loop.size()]; };
  std::vector<bool> kept(loop.size());
  // A closed line is two open ones, between its first point and the one furthest from it.
  std::size_t furthest = 0;
  double most = -1.0;
  for (std::size_t i = 1; i < loop.size(); ++i) {
    const double distance = std::hypot(loop[i].x - loop[0].x, loop[i].y - loop[0].y);
    if (distance > most) {
      most = distance;
      furthest = i;
    }
  }
  // And at most so many points of each, so that the time is linear in all of them.
  constexpr std::size_t kSpanMax = 4096;
  std::vector<std::pair<std::size_t, std::size_t>> open;
  const auto add = [&](std::size_t first, std::size_t last) {
    for (; first < last; first = std::min(first + kSpanMax, last)) {
      kept[first] = true;
      open.emplace_back(first, std::min(first + kSpanMax, last));
    }
  };
  add(0, furthest);
  add(furthest, loop.size());
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double worst = tolerance;
    std::size_t split = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance = DistanceToLine(at(i), at(first), at(last));
      if (distance > worst) {
        worst = distance;
        split = i;
      }
    }
    if (split == 0) continue;
    kept[split] = true;
    open.emplace_back(first, split);
    open.emplace_back(split, last);
  }
  Loop simple;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    if (kept[i]) simple.push_back(loop[i]);
  }
  return simple;
}

}  // namespace rmlcell::rml1
