#include "engine/simulation/path_extent.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"
#include "engine/motion/axis_demand.h"

namespace rmlcell::simulation {
namespace {

using motion::Head;
using motion::PathPiece;
using motion::Vec3;

constexpr std::array kCoordinates = {&Vec3::x, &Vec3::y, &Vec3::z};

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
  std::array<double, kTurningPointsMax> s{};
  std::size_t count = 0;

  void Add(double at) {
    if (count < s.size()) s[count++] = at;
  }
};

double RotaryAngle(const PathPart& part) {
  return (std::abs(part.path.a_rate()) + std::abs(part.path.b_rate())) * (part.to - part.from);
}

int Intervals(const PathPart& part) {
  double angle = RotaryAngle(part);
  if (part.path.kind() == PathPiece::Kind::kArc)
    angle += (part.to - part.from) / part.path.radius_mm();
  const double wanted = std::ceil(angle / kSampleAngle_rad);
  return static_cast<int>(std::clamp(wanted, double{kIntervalsMin}, double{kIntervalsMax}));
}

// A straight way between two points.
PointSweep Straight(const Vec3& from, const Vec3& to) {
  PointSweep sweep;
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = from.*kCoordinates[i];
    const double b = to.*kCoordinates[i];
    const int sign = b > a ? 1 : b < a ? -1 : 0;
    sweep[i] = {std::min(a, b), std::max(a, b), std::abs(b - a), 0, sign, sign};
  }
  return sweep;
}

// Arcs have closed forms: the derivative of a coordinate is t cos x + c sin x.
TurningPoints ArcTurns(const PathPart& part, double Vec3::*coordinate) {
  TurningPoints turning;
  const double radius = part.path.radius_mm();
  const double along = part.path.Tangent(0.0).*coordinate;
  const double inward = part.path.Curvature(0.0).*coordinate * radius;
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
TurningPoints SampledTurns(const PathPart& part, double Vec3::*coordinate, Rate rate) {
  TurningPoints turning;
  const int intervals = Intervals(part);
  const double step = (part.to - part.from) / intervals;
  double s = part.from;
  double here = rate(s).*coordinate;
  for (int k = 1; k <= intervals; ++k) {
    const double next_s = k == intervals ? part.to : part.from + step * k;
    const double next = rate(next_s).*coordinate;
    if ((here < 0.0 && next > 0.0) || (here > 0.0 && next < 0.0)) {
      double low = s;
      double high = next_s;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = 0.5 * (low + high);
        const double value = rate(middle).*coordinate;
        ((value > 0.0) == (here > 0.0) ? low : high) = middle;
      }
      turning.Add(0.5 * (low + high));
    }
    s = next_s;
    if (next != 0.0) here = next;
  }
  return turning;
}

template <class Position>
CoordinateSweep SweepOver(const PathPart& part, const TurningPoints& turning,
                          double Vec3::*coordinate, Position position) {
  CoordinateSweep sweep;
  double last = position(part.from).*coordinate;
  sweep.minimum = sweep.maximum = last;
  for (std::size_t k = 0; k <= turning.count; ++k) {
    const double next = position(k < turning.count ? turning.s[k] : part.to).*coordinate;
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
PointSweep Curved(const PathPart& part, bool plain_arc, Position position, Rate rate) {
  PointSweep sweep;
  for (std::size_t i = 0; i < 3; ++i) {
    const TurningPoints turning =
        plain_arc ? ArcTurns(part, kCoordinates[i]) : SampledTurns(part, kCoordinates[i], rate);
    sweep[i] = SweepOver(part, turning, kCoordinates[i], position);
  }
  return sweep;
}

Vec3 ColumnAt(const PathPiece& path, const Head& head, double s) {
  const motion::TipPose pose = path.At(s);
  return path.kind() == PathPiece::Kind::kJoint ? pose.tip : head.ColumnOf(pose).column;
}

}  // namespace

machine::Box BoxOf(const PointSweep& sweep) {
  machine::Box box;
  box.Add(Vec3{sweep[0].minimum, sweep[1].minimum, sweep[2].minimum});
  box.Add(Vec3{sweep[0].maximum, sweep[1].maximum, sweep[2].maximum});
  return box;
}

bool Turns(const PathPiece& path) { return path.a_rate() != 0.0 || path.b_rate() != 0.0; }

Vec3 TipAt(const PathPiece& path, const Head& head, double s) {
  const motion::TipPose pose = path.At(s);
  if (path.kind() != PathPiece::Kind::kJoint) return pose.tip;
  return head.TipOf({pose.tip, pose.a_rad, pose.b_rad}).tip;
}

Vec3 TipRate(const PathPiece& path, const Head& head, double s) {
  if (path.kind() == PathPiece::Kind::kRotary) return {};
  const Vec3 rate = path.Tangent(s);
  if (path.kind() != PathPiece::Kind::kJoint) return rate;
  const motion::TipPose pose = path.At(s);
  const motion::AxisValues swing =
      motion::AxisRates(head, pose.a_rad, pose.b_rad, {{}, path.a_rate(), path.b_rate()});
  return rate - Vec3{swing[0], swing[1], swing[2]};
}

PointSweep TipSweep(const PathPart& part) {
  const PathPiece& path = part.path;
  const auto position = [&](double s) { return TipAt(path, part.head, s); };
  switch (path.kind()) {
    case PathPiece::Kind::kLine:
    case PathPiece::Kind::kRotary:
      return Straight(position(part.from), position(part.to));
    case PathPiece::Kind::kJoint:
      if (!Turns(path)) return Straight(position(part.from), position(part.to));
      break;
    case PathPiece::Kind::kArc:
    case PathPiece::Kind::kBlend:
      break;
  }
  return Curved(part, path.kind() == PathPiece::Kind::kArc, position,
                [&](double s) { return TipRate(path, part.head, s); });
}

PointSweep ColumnSweep(const PathPart& part) {
  const PathPiece& path = part.path;
  const auto position = [&](double s) { return ColumnAt(path, part.head, s); };
  if (path.kind() == PathPiece::Kind::kJoint) {
    return Straight(position(part.from), position(part.to));
  }
  if (!Turns(path)) {  // as the tip goes, somewhere above it
    const Vec3 arm = position(0.0) - path.from().tip;
    PointSweep sweep = TipSweep(part);
    for (std::size_t i = 0; i < 3; ++i) {
      sweep[i].minimum += arm.*kCoordinates[i];
      sweep[i].maximum += arm.*kCoordinates[i];
    }
    return sweep;
  }
  return Curved(part, false, position, [&](double s) {
    const auto rate = motion::DerivativesAt(path, part.head, s).first;
    return Vec3{rate[0], rate[1], rate[2]};
  });
}

double TipLength(const PathPart& part) {
  const PathPiece& path = part.path;
  if (path.kind() == PathPiece::Kind::kRotary) return 0.0;
  if (path.kind() != PathPiece::Kind::kJoint) return part.to - part.from;
  if (!Turns(path)) return Norm(path.to().tip - path.from().tip) * (part.to - part.from);
  // Gauss-Legendre with five nodes on panels of at most kSampleAngle_rad: error below 1e-12 of the
  // length, unless the tip all but stands somewhere.
  constexpr std::array kNodes = {0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array kWeights = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const int panels = Intervals(part);
  const double half = 0.5 * (part.to - part.from) / panels;
  double length = 0.0;
  for (int k = 0; k < panels; ++k) {
    const double middle = part.from + half * (2.0 * k + 1.0);
    const auto speed = [&](double node) {
      return Norm(TipRate(path, part.head, middle + half * node));
    };
    length += half * kWeights[0] * speed(0.0);
    for (std::size_t i = 1; i < kNodes.size(); ++i) {
      length += half * kWeights[i] * (speed(kNodes[i]) + speed(-kNodes[i]));
    }
  }
  return length;
}

}  // namespace rmlcell::simulation
