#include "engine/motion/geometry/frames.h"

#include <cmath>

namespace rmlcell::motion {

// Written out: products of three rotations would leave 1e-17 where there is a zero.
Rotation RotationZyx(double rz_rad, double ry_rad, double rx_rad) {
  const double cz = std::cos(rz_rad), sz = std::sin(rz_rad);
  const double cy = std::cos(ry_rad), sy = std::sin(ry_rad);
  const double cx = std::cos(rx_rad), sx = std::sin(rx_rad);
  Rotation rotation;
  rotation << cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx,  //
      sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx,          //
      -sy, cy * sx, cy * cx;
  return rotation;
}

Rotation ToolRotation(double a_rad, double b_rad) {
  const double sin_a = std::sin(a_rad);
  const double cos_a = std::cos(a_rad);
  const double sin_b = std::sin(b_rad);
  const double cos_b = std::cos(b_rad);
  Rotation rotation;
  rotation << cos_a, -sin_a * cos_b, sin_a * sin_b,  //
      sin_a, cos_a * cos_b, -cos_a * sin_b,          //
      0.0, sin_b, cos_b;
  return rotation;
}

MachineVector ToolDirection(double a_rad, double b_rad) {
  return ToolRotation(a_rad, b_rad).col(2);
}

RigidMotion RigidMotionOf(const Eigen::Vector3d& translation, double rz_rad, double ry_rad,
                          double rx_rad) {
  RigidMotion motion = RigidMotion::Identity();
  motion.translation() = translation;
  motion.linear() = RotationZyx(rz_rad, ry_rad, rx_rad);
  return motion;
}

}  // namespace rmlcell::motion
