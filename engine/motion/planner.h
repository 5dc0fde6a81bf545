#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "engine/core/result.h"
#include "engine/motion/kinematics.h"
#include "engine/motion/path.h"
#include "engine/motion/speed_profile.h"

namespace rmlcell::motion {

// What the machine can do; motion.md section 1.
struct MachineLimits {
  double tip_speed_mm_s = 500.0;
  double tip_acceleration_mm_s2 = 2000.0;
  double tip_jerk_mm_s3 = 40000.0;
  double curve_normal = 0.8;  // shares of the tip limits on curved pieces
  double curve_tangential = 0.6;
  double curve_jerk = 0.8;
  double settling_s = 0.048;  // after a move without /FLY
  AxisLimits axes;
};

// One commanded motion. Fractions are already resolved from percentages: 0..1.
struct MoveCommand {
  enum class Kind { kContour, kPointToPointTip, kPointToPointAxes };
  Kind kind = Kind::kContour;
  PathPiece path{};             // kPointToPointAxes: a kJoint piece
  Head head{};                  // tool in force, for the axis limits
  double speed_fraction = 1.0;  // SPEED x override, at most 1
  double acceleration_fraction = 1.0;
  double overshoot_fraction = 1.0;  // OVERSH
  bool fly = false;                 // the passage to the next motion may be blended
  bool settles = true;              // false: the inner stop of a hole, which takes no settling time
  std::uint64_t tag = 0;            // given back with the result
};

// A motion with its timing. Emitted in order; each begins where the last one ended.
struct PlannedMotion {
  std::uint64_t tag = 0;
  PathPiece path{};
  Head head{};
  SpeedProfile speed;
  PathLimits limits;         // those in force, for a STOP on the way
  double settling_s = 0.0;   // standstill after the motion
  bool upper_bound = false;  // a /FLY passage was planned as a stop: time is an upper bound
  double duration_s() const { return speed.duration_s() + settling_s; }
};

// Something that takes effect between two motions: outputs, beam. With a blended corner it takes
// effect when the tip is half way through the blend (OPT-2.49, OPT-B.28), else after the motion
// before it.
struct PlannedMark {
  std::uint64_t tag = 0;
};

using PlannedItem = std::variant<PlannedMotion, PlannedMark>;

// Turns commanded motions into timed ones, in bounded memory whatever the length of the program.
// Items are held back until no later motion can change them: call Stop() wherever the machine
// stands before the next motion (a dwell, a wait, the end), and what was appended comes out. This
// version plans from exact stop to exact stop and holds back only a motion with /FLY, which costs
// no settling when another motion follows, and settles when Stop() follows (OPT-2.47).
class Planner {
 public:
  explicit Planner(const MachineLimits& limits);

  // Errors: NoMotion (7307) when speed or acceleration is too low to ever arrive. On error the
  // planner is unchanged; TargetOutOfTravel (7301) when a coordinate is not a finite number. A path
  // of length zero is not an error and adds nothing.
  Status Append(const MoveCommand& move);

  // Something that takes effect after the motions appended so far, see PlannedMark.
  void Mark(std::uint64_t tag);

  // The machine stands after the last motion: its /FLY has no effect and it settles.
  void Stop();

  // The next final item, or nothing when more input is needed.
  std::optional<PlannedItem> Next();

  const MachineLimits& limits() const { return limits_; }

 private:
  void Release(double settling_s);

  MachineLimits limits_;
  std::deque<PlannedItem> final_;
  std::optional<PlannedMotion> passing_;  // the last motion, when it has /FLY
  std::vector<PlannedMark> marks_;        // after it
};

// Stands for "no limit" where a finite figure is needed.
inline constexpr double kLargest = 1e12;

// The limits of one motion by itself: motion.md 5.1 and 3.4, 3.5.
PathLimits LimitsOf(const MoveCommand& move, const MachineLimits& machine);

}  // namespace rmlcell::motion
