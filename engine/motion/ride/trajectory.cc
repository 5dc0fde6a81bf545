#include "engine/motion/ride/trajectory.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/kinematics/axis_demand.h"

namespace rmlcell::motion {
namespace {

PathDerivatives Scaled(const PathDerivatives& d, double k) {
  return {d.point * k, d.a * k, d.b * k};
}
PathDerivatives Sum(const PathDerivatives& x, const PathDerivatives& y) {
  return {x.point + y.point, x.a + y.a, x.b + y.b};
}

MachineVector ColumnPart(const AxisValues& values) { return {values[0], values[1], values[2]}; }
AxisValues Values(const MachinePoint& column, double a, double b) {
  return {column.x(), column.y(), column.z(), a, b};
}

constexpr int kHalvingsMax = 12;  // of a blend: 4096 chords
constexpr int kChordsMax = 1 << 20;

// Halves [u0, u1] until the middle of each chord is near enough.
void Halve(const CornerCurve& curve, double u0, double u1, const MachinePoint& p0,
           const MachinePoint& p1, double tolerance_mm, int depth,
           std::vector<MachinePoint>& points) {
  const double middle = 0.5 * (u0 + u1);
  const MachinePoint on_curve = curve.At(middle).point;
  // The first cut is always made: an S would hide behind its own chord.
  const bool near = (on_curve - ((p0 + p1) * 0.5)).norm() <= tolerance_mm;
  if (depth >= kHalvingsMax || (near && depth > 1)) {
    points.push_back(p1);
    return;
  }
  Halve(curve, u0, middle, p0, on_curve, tolerance_mm, depth + 1, points);
  Halve(curve, middle, u1, on_curve, p1, tolerance_mm, depth + 1, points);
}

}  // namespace

TrajectoryPoint PointAt(const PathPiece& path, const Head& head, const PathState& state) {
  return PointAt({path.in_axes(), path.At(state.s), path.First(state.s), path.Second(state.s)},
                 head, state);
}

TrajectoryPoint PointAt(const PathPlace& place, const Head& head, const PathState& state) {
  const PathPose& pose = place.pose;
  const PathDerivatives& first = place.first;
  const PathDerivatives& second = place.second;
  const PathDerivatives velocity = Scaled(first, state.speed);
  const PathDerivatives acceleration =
      Sum(Scaled(first, state.acceleration), Scaled(second, state.speed * state.speed));
  const TipRates turning{{}, velocity.a, velocity.b};
  const TipRates turning_more{{}, acceleration.a, acceleration.b};
  // What the head's turning adds to the column over the tip.
  const BothAxisRates by_turning = head.RatesOfBoth(pose.a_rad, pose.b_rad, turning, turning_more);
  const MachineVector swing = ColumnPart(by_turning.first);
  const MachineVector whirl = ColumnPart(by_turning.second);

  TrajectoryPoint point;
  if (place.in_axes) {
    point.tip = head.TipOf(place.axes());
    point.tip_velocity = velocity.point - swing;
    point.tip_acceleration = acceleration.point - whirl;
    point.axes = Values(pose.point, pose.a_rad, pose.b_rad);
    point.axis_velocity = Values(velocity.point, velocity.a, velocity.b);
    point.axis_acceleration = Values(acceleration.point, acceleration.a, acceleration.b);
    return point;
  }
  point.tip = place.tip();
  point.tip_velocity = velocity.point;
  point.tip_acceleration = acceleration.point;
  point.axes = Values(head.ColumnOf(place.tip()).column, pose.a_rad, pose.b_rad);
  point.axis_velocity = Values(velocity.point + swing, velocity.a, velocity.b);
  point.axis_acceleration = Values(acceleration.point + whirl, acceleration.a, acceleration.b);
  return point;
}

TrajectoryPoint MotionView::At(double t_s) const {
  const PathPiece& path = motion_.path;
  PathState state = motion_.speed.At(t_s);
  if (t_s > motion_.speed.duration_s()) state.speed = state.acceleration = 0.0;
  if (!blend_) return PointAt(path, motion_.head, state);
  const CornerCurve& curve = blend_->curve();
  const double u = blend_->ParameterAt(state.s);
  return PointAt({curve.in_axes(), curve.At(u), curve.FirstByLength(u), curve.SecondByLength(u)},
                 motion_.head, state);
}

TipPose MotionView::PoseAt(double t_s) const {
  const double s = motion_.speed.PlaceAt(t_s);
  const PathPose pose = blend_ ? blend_->curve().At(blend_->ParameterAt(s)) : motion_.path.At(s);
  return TipOn(motion_.path, motion_.head, pose);
}

void LongSum::Add(double value) {
  const double total = sum_ + value;
  lost_ += std::abs(sum_) >= std::abs(value) ? (sum_ - total) + value : (value - total) + sum_;
  sum_ = total;
}

void AppendPolyline(const PathPiece& path, double tolerance_mm, std::vector<MachinePoint>& points) {
  if (points.empty() || points.back() != path.from().point) points.push_back(path.from().point);
  if (path.kind() == PathPiece::Kind::kArc) {
    const double radius = path.radius_mm();
    const double step = 2.0 * std::acos(1.0 - std::min(tolerance_mm / radius, 1.0));
    const double wanted = std::ceil(path.sweep_rad() / std::min(step, 0.5 * kPi));
    const int chords = static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(kChordsMax)));
    for (int k = 1; k < chords; ++k) points.push_back(path.At(path.length() * k / chords).point);
  } else if (path.kind() == PathPiece::Kind::kBlend) {
    const BlendCurve blend(path);
    const double from = blend.ParameterAt(0.0);
    const double to = blend.ParameterAt(path.length());
    Halve(blend.curve(), from, to, path.from().point, path.to().point, tolerance_mm, 0, points);
    return;
  }
  if (path.length() > 0.0 && path.kind() != PathPiece::Kind::kRotary)
    points.push_back(path.to().point);
}

}  // namespace rmlcell::motion
