#include "engine/motion/profile/speed_passes.h"

#include <algorithm>
#include <span>

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
  if (size() == final_) return final_;
  // What later knots may still make of the last one: anything from rest to its forward speed.
  // Backward from there the bounds of each knot; where they meet it is final, and so are all before
  // it. The lower bound is not what standing at the end would give: Reach has its least value at a
  // speed above 0 (ReachMinimum).
  Knot& last = knots_.back();
  double low = 0.0;
  double high = last.forward;
  last.speed = 0.0;
  std::size_t k = knots_.size() - 1;
  const std::size_t open = first_ + final_;
  while (low != high && k > open) {
    const Knot& after = knots_[k];
    Knot& knot = knots_[--k];
    const double from_high = Reachable(high, after.length, after.limits, knot.forward);
    const double from_low = Reachable(low, after.length, after.limits, knot.forward);
    const double least = std::min(
        {knot.forward, from_low, from_high, ReachMinimum(low, high, after.length, after.limits)});
    knot.speed = least;  // from here any future can be met: for Accept
    high = std::max(from_low, from_high);
    low = least;
  }
  if (low != high) return final_;
  knots_[k].speed = high;
  final_ = k + 1 - first_;
  while (k > open) {
    const Knot& after = knots_[k];
    Knot& knot = knots_[--k];
    knot.speed = Reachable(after.speed, after.length, after.limits, knot.forward);
  }
  return final_;
}

void SpeedPasses::Accept(std::size_t count) {
  RMLCELL_CHECK(count <= size());
  if (count <= final_) return;
  // The knots after it were planned forward from a faster one.
  Knot& last = knots_[first_ + count - 1];
  last_forward_ = last.speed;
  for (Knot& knot : std::span(knots_).subspan(first_ + count)) {
    knot.forward = Reachable(last_forward_, knot.length, knot.limits, knot.forward);
    last_forward_ = knot.forward;
  }
  last.forward = last.speed;
  final_ = count;
}

void SpeedPasses::DropOpen() {
  knots_.resize(first_ + final_);
  last_forward_ = final_ > 0 ? knots_.back().speed : last_popped_;
}

void SpeedPasses::Pop() {
  RMLCELL_CHECK(final_ > 0);
  last_popped_ = knots_[first_].speed;
  ++first_;
  --final_;
  // Move the open knots to the front when that costs no more than was popped.
  if (2 * first_ >= knots_.size()) {
    knots_.erase(knots_.begin(), knots_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
  }
}

}  // namespace rmlcell::motion
