#include "engine/motion/speed_passes.h"

#include <algorithm>

#include "engine/core/check.h"

namespace rmlcell::motion {
namespace {

// The speed at the far end of a span: `cap`, or what can be reached from `from`.
double Reachable(double from, double length, const PathLimits& limits, double cap) {
  if (cap <= from) return cap;
  if (RampLength(from, cap, limits) <= length) return cap;
  return std::min(cap, Reach(from, length, limits));
}

}  // namespace

void SpeedPasses::Push(double length, const PathLimits& limits, double cap) {
  last_forward_ = Reachable(last_forward_, length, limits, cap);
  knots_.push_back({length, limits, last_forward_, last_forward_});
}

std::size_t SpeedPasses::Settle() {
  double next = 0.0;
  for (std::size_t k = knots_.size(); k > first_ + final_; --k) {
    Knot& knot = knots_[k - 1];
    const bool last = k == knots_.size();
    knot.speed = last ? std::min(knot.forward, next)
                      : Reachable(next, knots_[k].length, knots_[k].limits, knot.forward);
    next = knot.speed;
  }
  // Whatever comes later can only raise what this pass assumed: a knot that keeps its forward speed
  // even so is final, and so are all before it.
  for (std::size_t k = knots_.size(); k > first_ + final_; --k) {
    if (knots_[k - 1].speed == knots_[k - 1].forward) {
      final_ = k - first_;
      break;
    }
  }
  return final_;
}

void SpeedPasses::Accept(std::size_t count) {
  RMLCELL_CHECK(count <= size());
  if (count <= final_ || count == 0) return;
  // The knots after it were planned forward from a faster one.
  Knot& last = knots_[first_ + count - 1];
  last_forward_ = last.speed;
  for (std::size_t k = first_ + count; k < knots_.size(); ++k) {
    knots_[k].forward =
        Reachable(last_forward_, knots_[k].length, knots_[k].limits, knots_[k].forward);
    last_forward_ = knots_[k].forward;
  }
  last.forward = last.speed;
  final_ = count;
}

void SpeedPasses::Pop() {
  RMLCELL_CHECK(final_ > 0);
  ++first_;
  --final_;
  // Move the open knots to the front when that costs no more than was popped.
  if (2 * first_ >= knots_.size()) {
    knots_.erase(knots_.begin(), knots_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
  }
}

}  // namespace rmlcell::motion
