#pragma once

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

// The tip at `s`.
motion::MachinePoint TipAt(const motion::PathPiece& path, const motion::Head& head, double s);

// A part as a function of a parameter p that grows along it: s itself, but on the curve of a blend
// its own variable u, since finding a place by s means to measure the curve.
class PartCurve {
 public:
  // `part` must outlive this.
  explicit PartCurve(const PathPart& part);

  double begin() const { return begin_; }
  double end() const { return end_; }

  // Angle that head and tangent turn through along the part, at most: how finely to look at it.
  double turning_rad() const { return turning_rad_; }

  motion::MachinePoint Tip(double p) const;
  motion::MachinePoint Column(double p) const;
  motion::MachineVector TipRate(double p) const;     // by p
  motion::MachineVector ColumnRate(double p) const;  // by p
  motion::PathPose Pose(double p) const;
  motion::PathDerivatives Rate(double p) const;

 private:
  bool blend() const { return part_.path.kind() == motion::PathPiece::Kind::kBlend; }
  motion::MachineVector Swing(double p) const;

  const PathPart& part_;
  motion::CornerCurve curve_;  // of a blend
  double begin_ = 0.0;
  double end_ = 0.0;
  double turning_rad_ = 0.0;
};

}  // namespace rmlcell::simulation
