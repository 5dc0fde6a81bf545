#pragma once

// What is not written is zero, as everywhere in this house.
#define EIGEN_INITIALIZE_MATRICES_BY_ZERO
#define EIGEN_NO_MALLOC  // fixed sizes only

#include <Eigen/Geometry>

// Points and directions, by the frame that they are told in; mm for points. motion.md section 2.
// Never `auto` for an expression: it would refer to operands that are gone.
namespace rmlcell::motion {

// The frame of the machine.
using MachinePoint = Eigen::Vector3d;
using MachineVector = Eigen::Vector3d;  // directions, differences and derivatives of points

// The frame of the part program: that of the machine, moved and turned by SYSDEF.
using ProgramPoint = Eigen::Vector3d;
using ProgramVector = Eigen::Vector3d;

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

// Where the frame of the part program lies in that of the machine: p_machine = m * p_program.
// Angles of the head stay those of the machine. motion.md 2.3.
using MachineFromProgram = RigidMotion;

}  // namespace rmlcell::motion
