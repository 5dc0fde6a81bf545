#include "engine/simulation/path/path_extent.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;
using motion::PathPiece;

// Turning points kept of one coordinate and part. A turn of an arc has two; the head of the widest
// rotary axis (4 turns) swings the column eight times.
constexpr std::size_t kTurningPointsMax = 64;

// Sampling of the derivative between turning points: they lie at least half a turn of some angle
// apart, nearly, so a fifth of a radian finds each by itself.
constexpr double kSampleAngle_rad = 0.2;
constexpr int kIntervalsMin = 8;
constexpr int kIntervalsMax = 1024;
constexpr int kBisections = 40;  // halves an interval until the extreme is exact to the last digit

// Below this share of the path's speed a coordinate counts as standing: rounding, not motion.
constexpr double kStanding = 1e-12;

struct TurningPoints {
  std::array<double, kTurningPointsMax> p{};
  std::size_t count = 0;

  void Add(double at) {
    if (count < p.size()) p[count++] = at;
  }
};

int Intervals(const PartCurve& curve) {
  const double wanted = std::ceil(curve.turning_rad() / kSampleAngle_rad);
  return static_cast<int>(std::clamp(wanted, double{kIntervalsMin}, double{kIntervalsMax}));
}

CoordinateSweep Straight(double from, double to) {
  const int sign = to > from ? 1 : to < from ? -1 : 0;
  return {std::min(from, to), std::max(from, to), std::abs(to - from), 0, sign, sign};
}

PointSweep Straight(const MachinePoint& from, const MachinePoint& to) {
  return {Straight(from.x(), to.x()), Straight(from.y(), to.y()), Straight(from.z(), to.z())};
}

// Arcs have closed forms: the derivative of a coordinate is t cos x + c sin x.
TurningPoints ArcTurns(const PathPart& part, std::size_t coordinate) {
  TurningPoints turning;
  const double radius = part.path.radius_mm();
  const double along = part.path.Tangent(0.0)[coordinate];
  const double inward = part.path.Curvature(0.0)[coordinate] * radius;
  if (std::hypot(along, inward) < kStanding) return turning;
  const double begin = part.from / radius;
  const double end = part.to / radius;
  double angle = std::atan2(-along, inward);
  angle += kPi * std::ceil((begin - angle) / kPi);
  for (; angle < end && turning.count < kTurningPointsMax; angle += kPi) {
    if (angle > begin) turning.Add(angle * radius);
  }
  return turning;
}

// Everything else: sign changes of the derivative, bisected.
template <class Rate>
TurningPoints SampledTurns(const PartCurve& curve, Rate rate) {
  TurningPoints turning;
  const int intervals = Intervals(curve);
  const double step = (curve.end() - curve.begin()) / intervals;
  double p = curve.begin();
  double here = rate(p);
  for (int k = 1; k <= intervals; ++k) {
    const double next_p = k == intervals ? curve.end() : curve.begin() + step * k;
    const double next = rate(next_p);
    if ((here < 0.0 && next > 0.0) || (here > 0.0 && next < 0.0)) {
      double low = p;
      double high = next_p;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = 0.5 * (low + high);
        ((rate(middle) > 0.0) == (here > 0.0) ? low : high) = middle;
      }
      turning.Add(0.5 * (low + high));
    }
    p = next_p;
    if (next != 0.0) here = next;
  }
  return turning;
}

// From `begin` over the turning points to `end`.
template <class Value>
CoordinateSweep SweepOver(double begin, const TurningPoints& turning, double end, Value value) {
  CoordinateSweep sweep;
  double last = value(begin);
  sweep.minimum = sweep.maximum = last;
  for (std::size_t k = 0; k <= turning.count; ++k) {
    const double next = value(k < turning.count ? turning.p[k] : end);
    const int sign = next > last ? 1 : next < last ? -1 : 0;
    if (sign != 0) {
      if (sweep.first_sign == 0) sweep.first_sign = sign;
      if (sweep.last_sign == -sign) ++sweep.turns;
      sweep.last_sign = sign;
    }
    sweep.travel += std::abs(next - last);
    sweep.minimum = std::min(sweep.minimum, next);
    sweep.maximum = std::max(sweep.maximum, next);
    last = next;
  }
  return sweep;
}

template <class Position, class Rate>
PointSweep Sampled(const PartCurve& curve, Position position, Rate rate) {
  PointSweep sweep;
  for (std::size_t i = 0; i < 3; ++i) {
    const TurningPoints turning = SampledTurns(curve, [&](double p) { return rate(p)[i]; });
    sweep[i] =
        SweepOver(curve.begin(), turning, curve.end(), [&](double p) { return position(p)[i]; });
  }
  return sweep;
}

PointSweep ArcSweep(const PathPart& part) {
  PointSweep sweep;
  for (std::size_t i = 0; i < 3; ++i) {
    sweep[i] = SweepOver(part.from, ArcTurns(part, i), part.to,
                         [&](double s) { return part.path.At(s).point[i]; });
  }
  return sweep;
}

}  // namespace

machine::Box BoxOf(const PointSweep& sweep) {
  machine::Box box;
  box.Add(MachineVector{sweep[0].minimum, sweep[1].minimum, sweep[2].minimum});
  box.Add(MachineVector{sweep[0].maximum, sweep[1].maximum, sweep[2].maximum});
  return box;
}

PointSweep TipSweep(const PathPart& part) {
  const PathPiece::Kind kind = part.path.kind();
  if (kind == PathPiece::Kind::kArc) return ArcSweep(part);
  const bool bows = part.path.in_axes() && Turns(part.path);
  if (!bows && kind != PathPiece::Kind::kBlend) {
    return Straight(TipAt(part.path, part.head, part.from), TipAt(part.path, part.head, part.to));
  }
  const PartCurve curve(part);
  return Sampled(
      curve, [&](double p) { return curve.Tip(p); }, [&](double p) { return curve.TipRate(p); });
}

PointSweep ColumnSweep(const PathPart& part) {
  const PathPiece& path = part.path;
  if (path.kind() == PathPiece::Kind::kJoint) {
    return Straight(path.At(part.from).point, path.At(part.to).point);
  }
  if (!Turns(path) && !path.in_axes()) {  // as the tip goes, somewhere above it
    const MachineVector arm = part.head.ColumnOf(path.tip_from()).column - path.from().point;
    PointSweep sweep = TipSweep(part);
    for (std::size_t i = 0; i < 3; ++i) {
      sweep[i].minimum += arm[i];
      sweep[i].maximum += arm[i];
    }
    return sweep;
  }
  const PartCurve curve(part);
  return Sampled(
      curve, [&](double p) { return curve.Column(p); },
      [&](double p) { return curve.ColumnRate(p); });
}

std::array<CoordinateSweep, 2> RotarySweep(const PathPart& part) {
  if (part.path.kind() != PathPiece::Kind::kBlend || !Turns(part.path)) {
    const motion::PathPose from = part.path.At(part.from);
    const motion::PathPose to = part.path.At(part.to);
    return {Straight(from.a_rad, to.a_rad), Straight(from.b_rad, to.b_rad)};
  }
  const PartCurve curve(part);
  const TurningPoints a = SampledTurns(curve, [&](double p) { return curve.Rate(p).a; });
  const TurningPoints b = SampledTurns(curve, [&](double p) { return curve.Rate(p).b; });
  return {SweepOver(curve.begin(), a, curve.end(), [&](double p) { return curve.Pose(p).a_rad; }),
          SweepOver(curve.begin(), b, curve.end(), [&](double p) { return curve.Pose(p).b_rad; })};
}

double TipLength(const PathPart& part) {
  const PathPiece& path = part.path;
  if (path.kind() == PathPiece::Kind::kRotary || !(path.length() > 0.0)) return 0.0;
  if (!path.in_axes()) return part.to - part.from;
  if (path.kind() == PathPiece::Kind::kJoint && !Turns(path)) {
    return (path.to().point - path.from().point).norm() * (part.to - part.from) / path.length();
  }
  // Gauss-Legendre with five nodes on panels of at most kSampleAngle_rad: error below 1e-12 of the
  // length, unless the tip all but stands somewhere.
  constexpr std::array kNodes = {0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array kWeights = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const PartCurve curve(part);
  const int panels = Intervals(curve);
  const double half = 0.5 * (curve.end() - curve.begin()) / panels;
  double length = 0.0;
  for (int k = 0; k < panels; ++k) {
    const double middle = curve.begin() + half * (2.0 * k + 1.0);
    const auto speed = [&](double node) { return curve.TipRate(middle + half * node).norm(); };
    length += half * kWeights[0] * speed(0.0);
    for (std::size_t i = 1; i < kNodes.size(); ++i) {
      length += half * kWeights[i] * (speed(kNodes[i]) + speed(-kNodes[i]));
    }
  }
  return length;
}

}  // namespace rmlcell::simulation
