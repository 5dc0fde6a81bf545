#pragma once

#include <array>

#include "engine/motion/vec3.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// The rotation of SYSDEF, R = Rz(rz) Ry(ry) Rx(rx), as far as it stands in the text (OPT-7.29,
// OPT-8.23).
class ProgramFrame {
 public:
  // Takes the rotation of a SYSDEF; without values there is none. False when one is no number: it
  // is 0 then.
  bool Set(const ParsedProgram& program, const Instruction& sysdef);

  // A direction of the machine in program coordinates.
  motion::Vec3 DirectionToProgram(const motion::Vec3& d) const {
    return {motion::Dot(columns_[0], d), motion::Dot(columns_[1], d), motion::Dot(columns_[2], d)};
  }
  motion::Vec3 DirectionToMachine(const motion::Vec3& d) const {
    return columns_[0] * d.x + columns_[1] * d.y + columns_[2] * d.z;
  }

 private:
  std::array<motion::Vec3, 3> columns_ = {motion::Vec3{1, 0, 0}, motion::Vec3{0, 1, 0},
                                          motion::Vec3{0, 0, 1}};
};

// The columns of Rz(rz) Ry(ry) Rx(rx), rad.
std::array<motion::Vec3, 3> RotationColumns(double rz, double ry, double rx);

}  // namespace rmlcell::optimo
