#include "engine/simulation/path/path_extent.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"
#include "engine/simulation/path/part_shape.h"

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
constexpr double kAimShare = 0x1p-36;  // of an interval: how near to an extreme is aimed before
constexpr int kAims = 10;              // at it, at most
constexpr double kSureRate = 1e-3;     // of the highest: an end of the interval that surely moves

// Below this share of the path's speed a coordinate counts as standing: rounding, not motion.
constexpr double kStanding = 1e-12;

struct TurningPoints {
  std::array<double, kTurningPointsMax> p;  // the first `count`
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

// Where a derivative changes its sign: at `low` it still has that of the beginning, at `high` not
// any more.
struct Bracket {
  double low;
  double high;
};
struct RateAt {
  double p;
  double rate;
};

// Secants that keep the change between them (the Illinois method), then a look at both sides of
// where they lead. What a bisection asks outside of that is known: it decides, as before, so that
// the place is the same to the last digit. Not where an end is so near to standing that rounding
// may change signs beside the place: `scale` is the highest rate that is about.
template <class Rate>
Bracket AimAt(RateAt low, RateAt high, double scale, Rate rate) {
  Bracket bracket{low.p, high.p};
  if (std::min(std::abs(low.rate), std::abs(high.rate)) < kSureRate * scale) return bracket;
  const double near = kAimShare * (high.p - low.p);
  const bool positive = low.rate > 0.0;
  const auto look = [&](double at) {
    const double there = rate(at);
    ((there > 0.0) == positive ? bracket.low : bracket.high) = at;
    return there;
  };
  double at = low.p;
  for (int aim = 0; aim < kAims; ++aim) {
    const double last = at;
    at = low.p - low.rate * (high.p - low.p) / (high.rate - low.rate);
    if (!(at > bracket.low && at < bracket.high)) return bracket;
    const double there = look(at);
    const bool before = bracket.low == at;
    if (before == (low.p == last)) (before ? high : low).rate *= 0.5;  // the other end stays
    (before ? low : high) = {at, there};
    if (std::abs(at - last) < near) break;
  }
  for (const double beside : {at - near, at + near}) {
    if (beside > bracket.low && beside < bracket.high) look(beside);
  }
  return bracket;
}

// Everything else: sign changes of the derivatives, bisected. `rates(p)` gives N of them; those of
// which `one_way` says that they keep their sign are not looked at.
template <std::size_t N, class Rates>
std::array<TurningPoints, N> SampledTurns(const PartCurve& curve,
                                          const std::array<bool, N>& one_way, Rates rates) {
  std::array<TurningPoints, N> turning;
  if (std::all_of(one_way.begin(), one_way.end(), [](bool keeps) { return keeps; })) return turning;
  const int intervals = Intervals(curve);
  const double step = (curve.end() - curve.begin()) / intervals;
  double p = curve.begin();
  std::array<double, N> here = rates(p);
  for (int k = 1; k <= intervals; ++k) {
    const double next_p = k == intervals ? curve.end() : curve.begin() + step * k;
    const std::array<double, N> next = rates(next_p);
    for (std::size_t i = 0; i < N; ++i) {
      if (one_way[i]) continue;
      if ((here[i] < 0.0 && next[i] > 0.0) || (here[i] > 0.0 && next[i] < 0.0)) {
        const bool rises = here[i] > 0.0;
        double scale = 0.0;
        for (std::size_t n = 0; n < N; ++n)
          scale = std::max({scale, std::abs(here[n]), std::abs(next[n])});
        const auto rate = [&](double at) { return rates(at)[i]; };
        const Bracket around = AimAt({p, here[i]}, {next_p, next[i]}, scale, rate);
        double low = p;
        double high = next_p;
        for (int halving = 0; halving < kBisections; ++halving) {
          const double middle = 0.5 * (low + high);
          const bool before = middle <= around.low    ? true
                              : middle >= around.high ? false
                                                      : (rate(middle) > 0.0) == rises;
          (before ? low : high) = middle;
        }
        turning[i].Add(0.5 * (low + high));
      }
      if (next[i] != 0.0) here[i] = next[i];
    }
    p = next_p;
  }
  return turning;
}

// From the value at the start over those at the turning points to that at the end.
template <class Value>
CoordinateSweep SweepOver(double begin, const TurningPoints& turning, double end, Value value) {
  CoordinateSweep sweep;
  double last = begin;
  sweep.minimum = sweep.maximum = last;
  for (std::size_t k = 0; k <= turning.count; ++k) {
    const double next = k < turning.count ? value(turning.p[k]) : end;
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

std::array<double, 3> Values(const MachineVector& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

template <class Position, class Rate>
PointSweep Sampled(const PartCurve& curve, const std::array<bool, 3>& one_way, Position position,
                   Rate rate) {
  const auto turning = SampledTurns<3>(curve, one_way, [&](double p) { return Values(rate(p)); });
  const MachinePoint begin = position(curve.begin());
  const MachinePoint end = position(curve.end());
  PointSweep sweep;
  for (std::size_t i = 0; i < 3; ++i) {
    sweep[i] = SweepOver(begin[i], turning[i], end[i], [&](double p) { return position(p)[i]; });
  }
  return sweep;
}

// The rate of a blend in Bernstein's form over the part, which it cannot leave: where all five
// coefficients of an axis have one sign, well beyond rounding, or are nothing at all, the axis goes
// one way. X Y Z of the pose, A, B.
std::array<bool, motion::kAxisCount> OneWayOfBlend(const PartCurve& curve) {
  constexpr double kSureShare = 1e-12;
  const double whole = curve.end() - curve.begin();
  std::array<motion::PathDerivatives, 3> begin;
  std::array<motion::PathDerivatives, 2> end;
  for (int k = 0; k < 3; ++k) {
    begin[static_cast<std::size_t>(k)] = curve.Derivative(curve.begin(), k + 1);
    if (k < 2) end[static_cast<std::size_t>(k)] = curve.Derivative(curve.end(), k + 1);
  }
  const auto of = [](const motion::PathDerivatives& d, std::size_t axis) {
    return axis == 3 ? d.a : axis == 4 ? d.b : d.point[axis];
  };
  std::array<bool, motion::kAxisCount> one_way{};
  for (std::size_t i = 0; i < one_way.size(); ++i) {
    std::array<double, 5> c;
    c[0] = of(begin[0], i);
    c[1] = c[0] + 0.25 * whole * of(begin[1], i);
    c[2] = 2.0 * c[1] - c[0] + whole * whole / 12.0 * of(begin[2], i);
    c[4] = of(end[0], i);
    c[3] = c[4] - 0.25 * whole * of(end[1], i);
    const auto [least, most] = std::minmax_element(c.begin(), c.end());
    const double sure = kSureShare * std::max(-*least, *most);
    one_way[i] = sure == 0.0 || *least > sure || *most < -sure;
  }
  return one_way;
}

// Which of X, Y and Z of the column go one way all along, as far as can be told for less than it
// takes to look.
std::array<bool, 3> OneWayOfColumn(PartShape& shape) {
  std::array<bool, 3> one_way{};
  const AxisPieces* pieces = shape.pieces();
  if (pieces == nullptr) return one_way;
  for (std::size_t i = 0; i < 3; ++i) one_way[i] = pieces->GoesOneWay(static_cast<int>(i));
  return one_way;
}

PointSweep ArcSweep(const PathPart& part) {
  const MachinePoint begin = part.path.At(part.from).point;
  const MachinePoint end = part.path.At(part.to).point;
  PointSweep sweep;
  for (std::size_t i = 0; i < 3; ++i) {
    sweep[i] = SweepOver(begin[i], ArcTurns(part, i), end[i],
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

PointSweep TipSweep(PartShape& shape) {
  const PathPart& part = shape.part();
  const PathPiece::Kind kind = part.path.kind();
  if (kind == PathPiece::Kind::kArc) return ArcSweep(part);
  const bool bows = part.path.in_axes() && shape.turns();
  if (!bows && kind != PathPiece::Kind::kBlend) {
    return Straight(shape.tip_from(), shape.tip_to());
  }
  const PartCurve& curve = shape.curve();
  std::array<bool, 3> one_way{};
  if (!part.path.in_axes()) {
    const auto of_pose = OneWayOfBlend(curve);
    std::copy_n(of_pose.begin(), one_way.size(), one_way.begin());
  }
  return Sampled(
      curve, one_way, [&](double p) { return curve.Tip(p); },
      [&](double p) { return curve.TipRate(p); });
}

PointSweep ColumnSweep(PartShape& shape) {
  const PathPart& part = shape.part();
  const PathPiece& path = part.path;
  if (path.kind() == PathPiece::Kind::kJoint) {
    return Straight(path.At(part.from).point, path.At(part.to).point);
  }
  if (!path.in_axes() && !shape.turns()) {  // as the tip goes, somewhere above it
    const MachineVector arm = part.head.ColumnOf(path.tip_from()).column - path.from().point;
    PointSweep sweep = shape.tip();
    for (std::size_t i = 0; i < 3; ++i) {
      sweep[i].minimum += arm[i];
      sweep[i].maximum += arm[i];
    }
    return sweep;
  }
  const PartCurve& curve = shape.curve();
  return Sampled(
      curve, OneWayOfColumn(shape), [&](double p) { return curve.Column(p); },
      [&](double p) { return curve.ColumnRate(p); });
}

std::array<CoordinateSweep, 2> RotarySweep(PartShape& shape) {
  const PathPart& part = shape.part();
  if (part.path.kind() != PathPiece::Kind::kBlend || !shape.turns()) {
    const motion::PathPose from = part.path.At(part.from);
    const motion::PathPose to = part.path.At(part.to);
    return {Straight(from.a_rad, to.a_rad), Straight(from.b_rad, to.b_rad)};
  }
  const PartCurve& curve = shape.curve();
  const auto of_pose = OneWayOfBlend(curve);
  const auto turning = SampledTurns<2>(curve, {of_pose[3], of_pose[4]}, [&](double p) {
    const motion::PathDerivatives rate = curve.Rate(p);
    return std::array<double, 2>{rate.a, rate.b};
  });
  const motion::PathPose begin = curve.Pose(curve.begin());
  const motion::PathPose end = curve.Pose(curve.end());
  return {
      SweepOver(begin.a_rad, turning[0], end.a_rad, [&](double p) { return curve.Pose(p).a_rad; }),
      SweepOver(begin.b_rad, turning[1], end.b_rad, [&](double p) { return curve.Pose(p).b_rad; })};
}

double TipLength(PartShape& shape) {
  const PathPart& part = shape.part();
  const PathPiece& path = part.path;
  if (path.kind() == PathPiece::Kind::kRotary || !(path.length() > 0.0)) return 0.0;
  if (!path.in_axes()) return part.to - part.from;
  if (path.kind() == PathPiece::Kind::kJoint && !shape.turns()) {
    return (path.to().point - path.from().point).norm() * (part.to - part.from) / path.length();
  }
  // Gauss-Legendre with five nodes on panels of at most kSampleAngle_rad: error below 1e-12 of the
  // length, unless the tip all but stands somewhere.
  constexpr std::array kNodes = {0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array kWeights = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const PartCurve& curve = shape.curve();
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
