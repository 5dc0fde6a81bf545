#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "engine/core/result.h"
#include "engine/motion/corner/corner.h"
#include "engine/motion/geometry/path.h"
#include "engine/motion/kinematics/kinematics.h"
#include "engine/motion/kinematics/machine_limits.h"
#include "engine/motion/profile/speed_profile.h"

namespace rmlcell::motion {

// One commanded motion. Fractions are already resolved from percentages: 0..1.
struct MoveCommand {
  enum class Kind { kContour, kPointToPointTip, kPointToPointAxes };
  Kind kind = Kind::kContour;
  PathPiece path{};  // kPointToPointAxes: a kJoint piece, which comes out measured by time
  Head head{};       // tool in force, for the axis limits
  double speed_fraction = 1.0;  // SPEED x override, at most 1
  double acceleration_fraction = 1.0;
  double overshoot_fraction = 1.0;  // OVERSH
  // Limits that the caller knows, in place of fractions of the machine's: a mill, whose programs
  // give mm/s. Every figure above zero.
  std::optional<PathLimits> limits{};
  // Mills: how fast the passage behind it may be, besides what the limits and the vertex allow.
  double passage_speed_mm_s = kLargest;
  bool fly = false;       // the passage to the next motion may be blended
  bool settles = true;    // false: the inner stop of a hole, which takes no settling time
  std::uint64_t tag = 0;  // given back with the result
};

// How a move ended, for reports and warnings. Between moves in COORD ROBOT speeds are shares of the
// full one, and the cut is in seconds at full speed (motion.md 4.5).
struct CornerReport {
  Passage passage = Passage::kStop;
  double cut_mm = 0.0;        // a blend begins this far before the corner
  double deviation_mm = 0.0;  // distance of the path from the target
  double wanted_speed = 0.0;  // OVERSH x the lower running speed, as far as it can be reached
  double speed = 0.0;         // at the passage
};

// A motion with its timing. Emitted in order; each begins where the last one ended. A commanded
// move comes out as one motion, or as several with the same tag: what is left of its path between
// two blends, and the halves of the blends (split at half of their arc length).
struct PlannedMotion {
  std::uint64_t tag = 0;
  PathPiece path{};
  Head head{};
  SpeedProfile speed;
  PathLimits limits;        // those in force, for a STOP on the way
  double settling_s = 0.0;  // standstill after the motion
  // In a bend that is fast at some places and slow at others: the highest speed that is allowed at
  // all of them, for a START on the way. Else no limit besides limits.speed.
  double restart_speed = kLargest;
  bool ends_move = true;  // the last motion of its move
  CornerReport corner;    // when ends_move
  double duration_s() const { return speed.duration_s() + settling_s; }

  // The same motion of the axes (COORD ROBOT), with `factor` of s for each s.
  void MeasureBy(double factor);
};

// Something that takes effect between two motions: outputs, beam. With a blended corner it takes
// effect when the tip is half way through the blend (OPT-2.49, OPT-B.28), else after the motion
// before it.
struct PlannedMark {
  std::uint64_t tag = 0;
};

using PlannedItem = std::variant<PlannedMotion, PlannedMark>;

class MotionChain;

// Turns commanded motions into timed ones with look-ahead over /FLY passages: motion.md sections 4
// and 5, level 2, or level 1 where MachineLimits::ramps_across_passages is off. Memory is bounded
// whatever the length of the program, and the result depends neither on when Next is called nor on
// the inner batches, as long as look-ahead needs no more than kWindow knots. Items are held back
// until no later motion can change them: call Stop() wherever the machine stands before the next
// motion (a dwell, a wait, the end), and what was appended comes out.
class Planner {
 public:
  // Knots that may wait for a decision: 75 mm of braking distance in steps of 1 um (motion.md 5.5).
  static constexpr std::size_t kWindow = 65536;

  // `window` below kWindow only in tests.
  explicit Planner(const MachineLimits& limits, std::size_t window = kWindow);
  ~Planner();
  Planner(const Planner& other);  // a copy goes on by itself: snapshots of a run
  Planner& operator=(const Planner& other);
  Planner(Planner&&) noexcept;
  Planner& operator=(Planner&&) noexcept;

  // Errors: CellNoMotion when speed or acceleration is too low to ever arrive; CellTargetUnusable
  // when a coordinate is not a number or beyond 1e12. On error the planner is unchanged. A path of
  // length zero is not an error and adds nothing; without /FLY it makes the passage before it a
  // stop.
  Status Append(const MoveCommand& move);

  // The machine passes the start of the first move at this speed, with acceleration zero, instead
  // of standing there: a chain that is planned anew on the way (motion.md section 6). By the s of
  // that move: mm/s, or what its sigma does in COORD ROBOT.
  // Before the first Append. When what follows cannot be met from that speed, starts_too_fast()
  // says so once the first items are taken, and they are of no use.
  void BeginMoving(double speed);
  bool starts_too_fast() const;

  // Something that takes effect after the motions appended so far, see PlannedMark.
  void Mark(std::uint64_t tag);

  // The machine stands after the last motion: its /FLY has no effect and it settles.
  void Stop();

  // The next final item, or nothing when more input is needed.
  std::optional<PlannedItem> Next();

  // The same without a copy, for who takes millions: the item is good until the planner is called
  // again; null when more input is needed.
  const PlannedItem* NextInPlace();

  const MachineLimits& limits() const;

  // How often the window was full and knots had to be decided too early: slower than need be,
  // legal.
  std::uint64_t lookahead_starved() const;

 private:
  std::unique_ptr<MotionChain> chain_;
};

// The limits of one motion by itself: motion.md 5.1 and 3.4, 3.5.
PathLimits LimitsOf(const MoveCommand& move, const MachineLimits& machine);

// What is programmed for the tip, whatever the path: the first two lines of motion.md 5.1.
inline PathLimits TipLimits(const MoveCommand& move, const MachineLimits& machine) {
  const double share = std::clamp(move.acceleration_fraction, 0.0, 1.0);
  return {std::clamp(move.speed_fraction, 0.0, 1.0) * machine.tip_speed_mm_s,
          share * machine.tip_acceleration_mm_s2, share * machine.tip_jerk_mm_s3};
}

// Whether no axis is ever asked for more than it can on a line with a steady head: then the limits
// of the tip are all there are.
bool LinesFollowTip(const MachineLimits& machine);

}  // namespace rmlcell::motion
