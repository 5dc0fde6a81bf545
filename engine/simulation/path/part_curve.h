#pragma once

#include <array>
#include <optional>

#include "engine/motion/geometry/path.h"
#include "engine/motion/kinematics/kinematics.h"

namespace rmlcell::simulation {

// A part of a path piece, 0 <= from <= to <= path.length(), with the tool that it is for.
struct PathPart {
  const motion::PathPiece& path;
  const motion::Head& head;
  double from = 0.0;
  double to = 0.0;
};

// Whether A or B turn somewhere along the piece.
bool Turns(const motion::PathPiece& path);

// Angle that head and tangent turn through along the part, at most: how finely to look at it.
double TurningOf(const PathPart& part);

// The tip at `s`.
motion::MachinePoint TipAt(const motion::PathPiece& path, const motion::Head& head, double s);

// The measure of a corner's curve, kept from one part to the next: a corner is ridden in two
// halves, one behind the other.
class CurveMeasure {
 public:
  const motion::CornerLength& Of(const motion::CornerCurve& curve);

 private:
  // A curve by its values and derivatives at both ends, which tell all of it.
  using Look = std::array<motion::PathDerivatives, 8>;
  static Look LookOf(const motion::CornerCurve& curve);

  Look look_;
  std::optional<motion::CornerLength> length_;
};

// A part as a function of a parameter p that grows along it: s itself, but on the curve of a blend
// its own variable u, since finding a place by s means to measure the curve.
class PartCurve {
 public:
  // `part` must outlive this, and `measure` be used for no other curve meanwhile.
  PartCurve(const PathPart& part, CurveMeasure& measure);

  double begin() const { return begin_; }
  double end() const { return end_; }

  double turning_rad() const { return turning_rad_; }

  motion::MachinePoint Tip(double p) const;
  motion::MachinePoint Column(double p) const;
  motion::MachineVector TipRate(double p) const;     // by p
  motion::MachineVector ColumnRate(double p) const;  // by p
  motion::PathPose Pose(double p) const;
  motion::PathDerivatives Rate(double p) const;

  // Whether it is the curve of a blend, which alone has higher derivatives here: order 1 to 3.
  bool bends() const { return part_.path.kind() == motion::PathPiece::Kind::kBlend; }
  motion::PathDerivatives Derivative(double p, int order) const {
    return curve_.Derivative(p, order);
  }
  const motion::CornerCurve& curve() const { return curve_; }
  const motion::Head& head() const { return part_.head; }
  // Of a blend: p at `s` of the path.
  double ParameterAt(double s) const {
    return length_->ParameterAt(curve_, part_.path.curve_start() + s);
  }

 private:
  motion::MachineVector Swing(double p) const;

  const PathPart& part_;
  motion::CornerCurve curve_;                     // of a blend
  const motion::CornerLength* length_ = nullptr;  // its
  double begin_ = 0.0;
  double end_ = 0.0;
  double turning_rad_ = 0.0;
};

}  // namespace rmlcell::simulation
