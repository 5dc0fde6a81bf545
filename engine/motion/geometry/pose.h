#pragma once

#include "engine/motion/geometry/frames.h"

namespace rmlcell::motion {

struct TipPose;
struct AxisPose;
class PathPiece;
struct PathPlace;

// A place on a path: of the tip, or of the axes where the path is in_axes(). Which one it is only
// its path can say: PathPiece::TipOf and AxesOf; who has the head asks TipOn or AxesOn
// (kinematics.h).
struct PathPose {
  MachinePoint point;
  double a_rad = 0.0;
  double b_rad = 0.0;

  bool operator==(const PathPose& other) const {
    return point.x() == other.point.x() && point.y() == other.point.y() &&
           point.z() == other.point.z() && a_rad == other.a_rad && b_rad == other.b_rad;
  }

 private:
  friend PathPiece;
  friend PathPlace;
  TipPose tip() const;
  AxisPose axes() const;
};

// Tool tip in the machine frame (mm) and the two head angles (rad). Mills use the tip alone, and
// a_rad for their rotary axis.
struct TipPose {
  MachinePoint tip;
  double a_rad = 0.0;
  double b_rad = 0.0;

  operator PathPose() const { return {tip, a_rad, b_rad}; }  // NOLINT: implicit by design
  bool operator==(const TipPose& other) const { return PathPose(*this) == PathPose(other); }
};

// Column position (crossing of the A and B axes) and head angles: what the five axes of the gantry
// do.
struct AxisPose {
  MachinePoint column;
  double a_rad = 0.0;
  double b_rad = 0.0;

  operator PathPose() const { return {column, a_rad, b_rad}; }  // NOLINT: implicit by design
  bool operator==(const AxisPose& other) const { return PathPose(*this) == PathPose(other); }
};

inline TipPose PathPose::tip() const { return {point, a_rad, b_rad}; }
inline AxisPose PathPose::axes() const { return {point, a_rad, b_rad}; }

}  // namespace rmlcell::motion
