#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/core/check.h"
#include "engine/machine/observer.h"

namespace rmlcell::rml1 {

// A place of the tool in device units from the machine's zero; A in degrees.
struct Point {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double a = 0.0;

  bool operator==(const Point&) const = default;
};

// Motions that a planner with look-ahead joins without a stop when nothing comes between them:
// motion.md section 7, corners. Motions of Z alone for a height, and of a recovery, stand alone.
enum class Chain : std::uint8_t { kAlone, kToolUp, kToolDown, kThreeAxis };

// One thing that the device does, in its place in the command order.
struct Action {
  enum class Kind : std::uint8_t {
    kMotion,
    kSpindleStart,  // at `rpm`
    kSpindleStop,
    kSpindleSpeed,  // of a turning spindle, to `rpm`
    kDwell,         // `dwell_ms`
    kPause,         // until the resume key
  };
  Kind kind = Kind::kMotion;
  Point to{};
  double speed_mm_s = 0.0;
  bool rapid = false;  // at the travel speed, which no override changes
  machine::MotionUse use = machine::MotionUse::kTravel;
  Chain chain = Chain::kAlone;
  bool waits = false;    // kSpindleStop of !MC 0: for the spindle to stand; motion.md section 7
  bool outside = false;  // kPause: of the option "pause outside", not !NR
  int rpm = 0;
  int dwell_ms = 0;
};

// What one byte of a stream makes the device do; it is carried out before the next byte is looked
// at. The longest is a three-axis set that passes in and out of the range: a start of the spindle,
// a dwell, and at most six pieces of path with a recovery of three motions and a pause each.
class ActionQueue {
 public:
  static constexpr std::size_t kCapacity = 40;

  bool empty() const { return end_ == 0; }
  const Action& front() const { return actions_[head_]; }
  std::span<const Action> all() const { return {actions_.data() + head_, end_ - head_}; }
  void Pop() {
    if (++head_ == end_) head_ = end_ = 0;
  }
  Action& Push(Action::Kind kind) {
    RMLCELL_CHECK(end_ < kCapacity);
    Action& action = actions_[end_++];
    action = Action();
    action.kind = kind;
    return action;
  }

 private:
  std::array<Action, kCapacity> actions_;
  std::size_t head_ = 0;
  std::size_t end_ = 0;
};

}  // namespace rmlcell::rml1
