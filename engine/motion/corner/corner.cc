#include "engine/motion/corner/corner.h"

#include <algorithm>
#include <cmath>

#include "engine/core/indices.h"
#include "engine/motion/geometry/corner_table.h"
#include "engine/motion/kinematics/axes.h"

namespace rmlcell::motion {
namespace {

constexpr double kStraightHalfSine = 0.5e-6;               // a turn of 1e-6 rad
constexpr double kReversalHalfCosine = 0.043619387365336;  // a turn of 175 degrees
constexpr double kEqual = 1e-9;    // relative, for curvatures and rates that meet
constexpr double kNoRate = 1e-12;  // rad/mm

bool Same(const MachineVector& a, const MachineVector& b) {
  return (a - b).norm() <= kEqual * std::max(a.norm(), b.norm());
}
bool Same(double a, double b) {
  return std::abs(a - b) <= std::max(kEqual * std::max(std::abs(a), std::abs(b)), kNoRate);
}

}  // namespace

void Corner::Assign(const PathPiece& before, const PathPiece& after) {
  const PathDerivatives in = before.First(before.length());
  const PathDerivatives out = after.First(0.0);
  half_sine_ = std::min(0.5 * (in.point - out.point).norm(), 1.0);
  half_cosine_ = std::sqrt(std::max(0.0, 0.5 * (1.0 + in.point.dot(out.point))));
  lines_ = before.kind() == PathPiece::Kind::kLine && after.kind() == PathPiece::Kind::kLine;
  const bool turns = in.a != 0.0 || in.b != 0.0 || out.a != 0.0 || out.b != 0.0;
  plain_ = lines_ && !turns;
  cut_max_mm_ = HUGE_VAL;
  curvature_jump_ = a_jump_ = b_jump_ = 0.0;
  straight_ = half_sine_ <= kStraightHalfSine;
  if (half_cosine_ < kReversalHalfCosine) {
    passage_ = Passage::kStopReversal;
    return;
  }
  bool smooth = true;
  if (!plain_) {
    straight_ = straight_ && Same(in.a, out.a) && Same(in.b, out.b);
    a_jump_ = std::abs(out.a - in.a);
    b_jump_ = std::abs(out.b - in.b);
  }
  if (!lines_) {
    const MachineVector curvature_in = before.Second(before.length()).point;
    const MachineVector curvature_out = after.Second(0.0).point;
    smooth = Same(curvature_in, curvature_out);
    curvature_jump_ = (curvature_in - curvature_out).norm();
    for (const PathPiece* piece : {&before, &after}) {
      if (piece->kind() != PathPiece::Kind::kArc) continue;
      cut_max_mm_ = std::min(cut_max_mm_, 0.5 * piece->radius_mm());
    }
  }
  passage_ = straight_ && smooth ? Passage::kThrough : Passage::kBlend;
  if (passage_ == Passage::kThrough) return;
  rho_ = CornerRho(half_cosine_);
  curvature_ = CornerCurvature(half_sine_, half_cosine_, rho_);
  jerk_ = CornerJerk(half_sine_, half_cosine_, curvature_);
}

double Corner::CutFor(double w, const MachineLimits& machine) const {
  const double square = w * w;
  const double cube = square * w;
  const double jerk = machine.normal_jerk();
  double cut = std::max({curvature_ * square / machine.normal_acceleration(),
                         std::sqrt(jerk_ * cube / jerk), 1.2 * curvature_jump_ * cube / jerk});
  // Trapezoids have no limit on the jerk of the axes either: docs/decisions/0015.
  const bool jerk_limited = std::isfinite(jerk);
  const auto widen = [&](double jump, std::size_t axis) {
    if (!(jump > 0.0)) return;
    cut = std::max(cut, 0.75 * jump * square / machine.axes.acceleration[axis]);
    if (jerk_limited) cut = std::max(cut, std::sqrt(1.5 * jump * cube / machine.axes.jerk[axis]));
  };
  widen(a_jump_, 3);
  widen(b_jump_, 4);
  return cut;
}

double Corner::PlainLength(double cut_mm) const { return cut_mm * CornerArcLength(rho_); }

double Corner::PlainDeviation(double cut_mm) const {
  return cut_mm * half_sine_ * (1.0 - 5.0 * rho_ / 16.0);
}

double Corner::PlainBow(double cut_mm) const { return cut_mm * (0.5 - 5.0 * rho_ / 32.0); }

double Corner::PlainSpeed(double cut_mm, const MachineLimits& machine) const {
  const double by_acceleration = std::sqrt(machine.normal_acceleration() * cut_mm / curvature_);
  if (std::isinf(machine.tip_jerk_mm_s3)) return by_acceleration;
  const double jerk = CornerJerkPeak(half_sine_, half_cosine_, curvature_);
  return std::min(by_acceleration, std::cbrt(machine.normal_jerk() * cut_mm * cut_mm / jerk));
}

BendSpeeds Corner::PlainSpeeds(double cut, double top, const MachineLimits& machine) const {
  // Plans look at these places only, and ramps bend a little between them.
  constexpr double kBetween = 1.0 - 3e-3;
  const HalfCorner half = CornerHalf(half_sine_, half_cosine_);
  const double by_curvature = std::sqrt(machine.normal_acceleration() * cut / curvature_);
  const double by_jerk = std::cbrt(machine.normal_jerk() * cut * cut / curvature_);
  const double least = PlainSpeed(cut, machine);  // holds everywhere
  BendSpeeds speeds;
  for (const std::size_t k : IndicesOf(speeds.most)) {
    const double here =
        kBetween * std::min(by_curvature * half.by_curvature[k], by_jerk * half.by_jerk[k]);
    speeds.most[k] = std::min(std::max(here, least), top);
  }
  return speeds;
}

double JunctionSpeed(const MachineVector& tangent_in, const MachineVector& tangent_out,
                     double jump_mm_s) {
  const MachineVector turn = tangent_out - tangent_in;
  return jump_mm_s / std::max({std::abs(turn.x()), std::abs(turn.y()), std::abs(turn.z())});
}

CurveEnd EndAt(const PathPiece& path, double s) {
  const PathDerivatives first = path.First(s);
  return {.pose = path.At(s),
          .tangent = first.point,
          .curvature = path.Second(s).point,
          .a_rate = first.a,
          .b_rate = first.b};
}

bool AxesFollow(const CornerCurve& curve, const Head& head, const MachineLimits& machine,
                double speed, double curvature_per_mm) {
  const CornerCurve::Bounds by_u = curve.DerivativeBounds();
  if (!(by_u.slowest > 0.0)) return false;
  const double per_mm = 1.0 / by_u.slowest;
  const double stretch = by_u.tip_second * per_mm;  // of (p' p'') / |p'|
  const double a = by_u.a_first * per_mm;
  const double b = by_u.b_first * per_mm;
  const double aa = (by_u.a_second + by_u.a_first * stretch) * per_mm * per_mm;
  const double bb = (by_u.b_second + by_u.b_first * stretch) * per_mm * per_mm;
  const double arm = head.reach_mm();
  const double first = 1.0 + arm * (a + b);
  const double second = curvature_per_mm + arm * (aa + bb + (a + b) * (a + b));
  const AxisLimits& axes = machine.axes;
  const double square = speed * speed;
  bool enough = a * speed <= axes.speed[3] && b * speed <= axes.speed[4] &&
                aa * square <= axes.acceleration[3] && bb * square <= axes.acceleration[4];
  for (const std::size_t i : kLinearAxes) {
    enough = enough && first * speed <= axes.speed[i] && second * square <= axes.acceleration[i];
  }
  return enough;
}

}  // namespace rmlcell::motion
