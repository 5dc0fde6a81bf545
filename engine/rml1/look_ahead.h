#pragma once

#include <cstdint>

#include "engine/core/ring.h"
#include "engine/motion/planner/planner.h"
#include "engine/motion/ride/ride_protocol.h"
#include "engine/rml1/action.h"
#include "engine/rml1/profile.h"

namespace rmlcell::rml1 {

// The motions ahead of the tool, and how fast it passes from one to the next: motion.md section 7,
// corners, and section 6 while it runs. Motions come in at one end as the stream is read ahead, and
// out at the other as legs with their times. Those of one chain are joined at their vertices; the
// tool stands before and behind every chain. It knows motions from the oldest, which the tool is on
// or begins next, to the last that was read; as many as the planner looks ahead (Planner::kWindow).
//
// Whatever comes in between (a STOP, a HOLD, another override) plans the same path anew from where
// the tool is, at the speed it has. Nothing is planned that the old plan could not have braked for.
class LookAhead {
 public:
  // A way, or a share of a turn, that is only rounding.
  static constexpr double kNothing_mm = 1e-9;

  LookAhead(const Profile& profile, const Point& tool, double override_percent);

  // A motion read ahead, from where the one before it ended.
  void Add(const Action& motion);
  // Something stands behind the last motion that the tool must stand for.
  void EndChain();

  // A part of the oldest motion, or all of it, besides its path and timing (motion::PlannedMotion;
  // ends_move there: no other leg follows, nor a halt).
  struct Leg {
    double feed_mm_s = 0.0;  // speed of the motion, override included
    bool halts = false;      // the tool comes to rest on the way: STOP
  };
  // The next leg of the oldest motion, which begins where the last one ended. False: what comes
  // behind must be read first.
  bool NextLeg(motion::PlannedMotion& ride, Leg& leg);

  // Speed of the tool where the next leg begins, along its path.
  double speed() const { return speed_; }

  // The tool has ridden so far along the leg and is there, at this speed; the motion is not over.
  struct Ridden {
    double length = 0.0;
    double speed = 0.0;
    Point tool;
  };
  void Ride(const Ridden& part);
  // Whether what is left of the oldest motion is only rounding: then it is over.
  bool NothingLeft();
  // It has ridden the oldest motion to its end, and passes there at this speed.
  void Finish(double speed);

  // From here on with this intent and override. What NextLeg gave before is void.
  void Replan(motion::RideIntent intent, double override_percent);
  // An override that changes no motion begun: for the next one.
  void SetOverride(double percent) { override_percent_ = percent; }

  std::uint64_t starved() const { return starved_ + planner_.lookahead_starved(); }

 private:
  using Number = std::uint64_t;
  struct Motion {
    Action action;
    Point from;
    double feed_mm_s = 0.0;
    bool ends_chain = false;
  };

  void Feed();
  void Append(const motion::PathPiece& path, const motion::PathLimits& limits, bool ends_motion,
              double passage_speed);
  void Brake(motion::PlannedMotion& ride, Leg& leg);
  motion::PathPiece RestOf(const motion::PathPiece& path, bool oldest) const;

  const Profile* profile_;
  motion::MachineLimits limits_;
  Ring<Motion> motions_;
  Point end_;                    // of the last of them
  Chain chain_ = Chain::kAlone;  // that the last of them leaves open
  double override_percent_;
  motion::RideIntent intent_ = motion::RideIntent::kGo;

  double speed_ = 0.0;
  double ridden_ = 0.0;  // of the oldest motion

  motion::Planner planner_;
  Number fed_ = 0;            // the motion that the planner is given next
  bool held_ = false;         // the planner has the stop that a HOLD asks for
  double brake_speed_ = 0.0;  // that full braking from now on would leave where it begins
  std::uint64_t starved_ = 0;
};

}  // namespace rmlcell::rml1
