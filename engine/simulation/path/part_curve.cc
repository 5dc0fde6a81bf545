#include "engine/simulation/path/part_curve.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"

namespace rmlcell::simulation {

using motion::MachinePoint;
using motion::MachineVector;
using motion::PathPiece;

bool Turns(const PathPiece& path) {
  if (path.a_rate() != 0.0 || path.b_rate() != 0.0) return true;
  if (path.kind() != PathPiece::Kind::kBlend) return false;
  // A corner where the head turns back has the same angles at both ends.
  const motion::CornerCurve curve = path.curve();
  const motion::PathDerivatives in = curve.Derivative(0.0, 1);
  const motion::PathDerivatives out = curve.Derivative(1.0, 1);
  return in.a != 0.0 || in.b != 0.0 || out.a != 0.0 || out.b != 0.0;
}

MachinePoint TipAt(const PathPiece& path, const motion::Head& head, double s) {
  return motion::TipOn(path, head, path.At(s)).tip;
}

double TurningOf(const PathPart& part) {
  const PathPiece& path = part.path;
  double turning = (std::abs(path.a_rate()) + std::abs(path.b_rate())) * (part.to - part.from);
  if (path.kind() == PathPiece::Kind::kArc) turning += (part.to - part.from) / path.radius_mm();
  return path.kind() == PathPiece::Kind::kBlend ? turning + kPi : turning;
}

CurveMeasure::Look CurveMeasure::LookOf(const motion::CornerCurve& curve) {
  Look look;
  const motion::PathPose from = curve.At(0.0);
  const motion::PathPose to = curve.At(1.0);
  look[0] = {from.point, from.a_rad, from.b_rad};
  look[1] = {to.point, to.a_rad, to.b_rad};
  for (std::size_t order = 1; order <= 3; ++order) {
    look[2 * order] = curve.Derivative(0.0, static_cast<int>(order));
    look[2 * order + 1] = curve.Derivative(1.0, static_cast<int>(order));
  }
  return look;
}

const motion::CornerLength& CurveMeasure::Of(const motion::CornerCurve& curve) {
  const Look look = LookOf(curve);
  const bool same =
      length_ && std::equal(look.begin(), look.end(), look_.begin(),
                            [](const motion::PathDerivatives& x, const motion::PathDerivatives& y) {
                              return x.point == y.point && x.a == y.a && x.b == y.b;
                            });
  if (!same) {
    look_ = look;
    length_.emplace(curve);
  }
  return *length_;
}

PartCurve::PartCurve(const PathPart& part, CurveMeasure& measure)
    : part_(part), begin_(part.from), end_(part.to), turning_rad_(TurningOf(part)) {
  if (bends()) {
    curve_ = part.path.curve();
    length_ = &measure.Of(curve_);
    begin_ = ParameterAt(part.from);
    end_ = ParameterAt(part.to);
  }
}

motion::PathPose PartCurve::Pose(double p) const {
  return bends() ? curve_.At(p) : part_.path.At(p);
}

motion::PathDerivatives PartCurve::Rate(double p) const {
  if (part_.path.kind() == PathPiece::Kind::kRotary) {
    return {{}, part_.path.a_rate(), part_.path.b_rate()};
  }
  return bends() ? curve_.Derivative(p, 1) : part_.path.First(p);
}

// What the turning of the head adds to the motion of the column over that of the tip.
MachineVector PartCurve::Swing(double p) const {
  const motion::PathDerivatives rate = Rate(p);
  const motion::PathPose pose = Pose(p);
  const motion::AxisValues swing = part_.head.Rates(pose.a_rad, pose.b_rad, {{}, rate.a, rate.b});
  return {swing[0], swing[1], swing[2]};
}

MachinePoint PartCurve::Tip(double p) const {
  return motion::TipOn(part_.path, part_.head, Pose(p)).tip;
}

MachinePoint PartCurve::Column(double p) const {
  return motion::AxesOn(part_.path, part_.head, Pose(p)).column;
}

MachineVector PartCurve::TipRate(double p) const {
  return part_.path.in_axes() ? Rate(p).point - Swing(p) : Rate(p).point;
}

MachineVector PartCurve::ColumnRate(double p) const {
  return part_.path.in_axes() ? Rate(p).point : Rate(p).point + Swing(p);
}

}  // namespace rmlcell::simulation
