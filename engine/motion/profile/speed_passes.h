#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::motion {

// The two passes of look-ahead over a chain of knots that grows at one end: forward as knots come,
// backward in batches. motion.md 5.3, 5.5. A knot is final when no later knot can lower it: then
// its speed does not depend on when Settle was called. Amortised cost per knot is constant when
// Settle is called after at least as many pushes as there are knots left open.
class SpeedPasses {
 public:
  // The chain begins at this speed instead of at rest. Before the first Push.
  void BeginAt(double speed) { last_forward_ = last_popped_ = speed; }

  // A knot reached over a span of `length` from the knot before it (the chain begins at rest, see
  // BeginAt). It is passed at `cap` at most; 0 is a stop. `limits` are those of the span.
  void Push(double length, const PathLimits& limits, double cap);

  // Backward from the last knot, as if the machine had to stand there. Returns how many knots are
  // final.
  std::size_t Settle();

  // Accepts the speeds that the last Settle found for the first `count` knots although they are not
  // final: legal, but slower than need be.
  void Accept(std::size_t count);

  // Forgets the knots that are not final: others take their place.
  void DropOpen();

  std::size_t size() const { return knots_.size() - first_; }
  std::size_t final_count() const { return final_; }
  std::size_t open_count() const { return size() - final_; }
  bool ends_at_rest() const { return size() > 0 && knots_.back().forward == 0.0; }

  // Of the oldest knot that was not popped, and of those after it. Precondition: it is final.
  double speed() const { return knots_[first_].speed; }
  double speed(std::size_t index) const { return knots_[first_ + index].speed; }
  void Pop();

 private:
  struct Knot {
    double length;
    PathLimits limits;
    double forward;  // lowered by the past alone
    double speed;    // lowered by the future too
  };
  std::vector<Knot> knots_;  // from first_ on
  std::size_t first_ = 0;
  std::size_t final_ = 0;
  double last_forward_ = 0.0;
  double last_popped_ = 0.0;  // the speed of that knot
};

}  // namespace rmlcell::motion
