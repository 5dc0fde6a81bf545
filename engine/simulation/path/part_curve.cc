#include "engine/simulation/path/part_curve.h"

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

PartCurve::PartCurve(const PathPart& part) : part_(part), begin_(part.from), end_(part.to) {
  const PathPiece& path = part.path;
  turning_rad_ = (std::abs(path.a_rate()) + std::abs(path.b_rate())) * (part.to - part.from);
  if (path.kind() == PathPiece::Kind::kArc)
    turning_rad_ += (part.to - part.from) / path.radius_mm();
  if (blend()) {
    turning_rad_ += kPi;
    curve_ = path.curve();
    const motion::CornerLength length(curve_);
    begin_ = length.ParameterAt(curve_, path.curve_start() + part.from);
    end_ = length.ParameterAt(curve_, path.curve_start() + part.to);
  }
}

motion::PathPose PartCurve::Pose(double p) const {
  return blend() ? curve_.At(p) : part_.path.At(p);
}

motion::PathDerivatives PartCurve::Rate(double p) const {
  if (part_.path.kind() == PathPiece::Kind::kRotary) {
    return {{}, part_.path.a_rate(), part_.path.b_rate()};
  }
  return blend() ? curve_.Derivative(p, 1) : part_.path.First(p);
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
