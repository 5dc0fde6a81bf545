#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/core/check.h"
#include "engine/motion/geometry/blend_curve.h"
#include "engine/motion/planner/planner.h"

namespace rmlcell::motion {

// The state of the machine at one instant.
struct TrajectoryPoint {
  TipPose tip;
  MachineVector tip_velocity;
  MachineVector tip_acceleration;
  AxisValues axes{};  // X Y Z of the column, A, B
  AxisValues axis_velocity{};
  AxisValues axis_acceleration{};

  double tip_speed() const { return tip_velocity.norm(); }
};

// The state of a path with these derivatives by s, where it is passed as `state` says.
// motion.md 2.4.
struct PathPlace {
  bool in_axes = false;  // pose and derivatives are those of the axes
  PathPose pose;
  PathDerivatives first;
  PathDerivatives second;

  // Preconditions, checked: not in_axes; in_axes.
  TipPose tip() const {
    RMLCELL_CHECK(!in_axes);
    return pose.tip();
  }
  AxisPose axes() const {
    RMLCELL_CHECK(in_axes);
    return pose.axes();
  }
};
TrajectoryPoint PointAt(const PathPlace& place, const Head& head, const PathState& state);
TrajectoryPoint PointAt(const PathPiece& path, const Head& head, const PathState& state);

// One motion, ready to be looked at many times. The motion must outlive the view.
class MotionView {
 public:
  explicit MotionView(const PlannedMotion& motion)
      : motion_(motion), duration_s_(motion.duration_s()) {
    if (motion.path.kind() == PathPiece::Kind::kBlend) blend_.emplace(motion.path);
  }
  explicit MotionView(PlannedMotion&&) = delete;

  // 0 <= t <= duration_s(); the settling at the end stands still.
  TrajectoryPoint At(double t_s) const;
  TipPose PoseAt(double t_s) const;
  double duration_s() const { return duration_s_; }

 private:
  const PlannedMotion& motion_;
  std::optional<BlendCurve> blend_;
  double duration_s_;
};

// Sums many small times without losing digits (Neumaier).
class LongSum {
 public:
  void Add(double value);
  double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0.0;
  double lost_ = 0.0;
};

// Places on the time axis at k / rate, exactly and not accumulated, whatever the motions'
// durations. `first` and `end` are the k whose times lie in [start, start + duration).
class SampleTimes {
 public:
  explicit SampleTimes(double rate_hz) : rate_hz_(rate_hz) {}

  // The samples within the next motion, as times from its start.
  template <class Visit>
  void Through(double duration_s, Visit visit) {
    const double start = elapsed_.value();
    elapsed_.Add(duration_s);
    const double end = elapsed_.value();
    for (;; ++next_) {
      const double time = static_cast<double>(next_) / rate_hz_;
      if (!(time < end)) return;
      visit(time, time < start ? 0.0 : time - start);
    }
  }
  // Whether there is one: a motion of a millisecond may have none and need not be looked at.
  bool NextWithin(double duration_s) const {
    LongSum end = elapsed_;
    end.Add(duration_s);
    return static_cast<double>(next_) / rate_hz_ < end.value();
  }
  double elapsed_s() const { return elapsed_.value(); }

 private:
  double rate_hz_;
  std::uint64_t next_ = 0;
  LongSum elapsed_;
};

// Corner points of a polyline that stays within `tolerance_mm` of the tip path, both ends included;
// the first is left out when `points` already ends there. Of pieces in_axes() the column is drawn.
// motion.md section 9.
void AppendPolyline(const PathPiece& path, double tolerance_mm, std::vector<MachinePoint>& points);

}  // namespace rmlcell::motion
