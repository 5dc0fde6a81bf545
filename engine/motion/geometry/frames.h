#pragma once

// What is not written is zero, as everywhere in this house.
#define EIGEN_INITIALIZE_MATRICES_BY_ZERO
#define EIGEN_NO_MALLOC  // fixed sizes only

#include <Eigen/Geometry>
#include <cmath>

// Points and directions, by the frame that they are told in; mm for points. motion.md section 2.
// Never `auto` for an expression: it would refer to operands that are gone.
namespace rmlcell::motion {

// The frame of the machine.
using MachinePoint = Eigen::Vector3d;
using MachineVector = Eigen::Vector3d;  // directions, differences and derivatives of points

// X and Y of either frame: places and directions as they are seen from above.
using PlanVector = Eigen::Vector2d;
inline PlanVector PlanOf(const Eigen::Vector3d& v) { return v.head<2>(); }
// By hypot of the C library, whose last digit is not that of norm().
inline double LengthOf(const PlanVector& v) { return std::hypot(v.x(), v.y()); }

// The frame of the part program: that of the machine, moved and turned by SYSDEF, or the units of a
// stream from its origin. Directions, and places as vectors from its origin where one program is
// worked on by itself.
using ProgramVector = Eigen::Vector3d;

// A place in that frame, where both frames meet: nothing takes it for one in the machine.
class ProgramPoint {
 public:
  ProgramPoint() = default;
  ProgramPoint(double x, double y, double z) : from_origin_(x, y, z) {}
  // By name, for vectors of both frames are one type.
  static ProgramPoint FromOrigin(const ProgramVector& from_origin) {
    return {from_origin.x(), from_origin.y(), from_origin.z()};
  }
  // Where the program speaks in the frame of the machine: a machine without another one, or axes.
  static ProgramPoint AsMachine(const MachinePoint& point) {
    return {point.x(), point.y(), point.z()};
  }

  double x() const { return from_origin_.x(); }
  double y() const { return from_origin_.y(); }
  double z() const { return from_origin_.z(); }
  const ProgramVector& from_origin() const { return from_origin_; }

  bool operator==(const ProgramPoint&) const = default;

 private:
  ProgramVector from_origin_;
};

inline constexpr int kAxisCount = 5;  // X Y Z of the column, A, B: mm and rad
using AxisValues = Eigen::Matrix<double, kAxisCount, 1>;

// Its columns are the axes of one frame, told in another.
using Rotation = Eigen::Matrix3d;

// Rz(rz) Ry(ry) Rx(rx), the order of SYSDEF. motion.md 2.3.
Rotation RotationZyx(double rz_rad, double ry_rad, double rx_rad);

// Rz(A) Rx(B): X, Y and Z of the tool in the frame of the machine; Z points from the tip towards
// the head. motion.md 2.1.
Rotation ToolRotation(double a_rad, double b_rad);
MachineVector ToolDirection(double a_rad, double b_rad);  // its Z

// p' = R p + t, mm; m.linear() for directions.
using RigidMotion = Eigen::Isometry3d;

// By numbers as SYSDEF has them: R = Rz(rz) Ry(ry) Rx(rx).
RigidMotion RigidMotionOf(const Eigen::Vector3d& translation, double rz_rad, double ry_rad,
                          double rx_rad);

// Where the frame of the part program lies in that of the machine; new: in the same place. Angles
// of the head stay those of the machine. motion.md 2.3.
class MachineFromProgram {
 public:
  MachineFromProgram() = default;
  explicit MachineFromProgram(const RigidMotion& motion) : motion_(motion) {}

  MachinePoint operator*(const ProgramPoint& point) const { return motion_ * point.from_origin(); }
  ProgramPoint ToProgram(const MachinePoint& point) const {
    return ProgramPoint::FromOrigin(motion_.inverse() * point);
  }
  // Its columns are the axes of the program.
  Rotation axes() const { return motion_.linear(); }

 private:
  RigidMotion motion_ = RigidMotion::Identity();
};

}  // namespace rmlcell::motion
