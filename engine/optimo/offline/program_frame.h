#pragma once

#include <array>
#include <optional>

#include "engine/motion/vec3.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// The system of SYSDEF, p_machine = T + R p with R = Rz(rz) Ry(ry) Rx(rx), as far as it stands in
// the text (OPT-7.29, OPT-8.23). Without SYSDEF it is that of the machine.
class ProgramFrame {
 public:
  // Takes a SYSDEF; without values there is none. False when one of its rotations is no number: it
  // is 0 then.
  bool Set(const ParsedProgram& program, const Instruction& sysdef);

  // A direction of the machine in program coordinates.
  motion::Vec3 DirectionToProgram(const motion::Vec3& d) const {
    return {motion::Dot(columns_[0], d), motion::Dot(columns_[1], d), motion::Dot(columns_[2], d)};
  }
  motion::Vec3 DirectionToMachine(const motion::Vec3& d) const {
    return columns_[0] * d.x + columns_[1] * d.y + columns_[2] * d.z;
  }

  // Nothing where SYSDEF has values that are no numbers.
  std::optional<motion::Vec3> PointToMachine(const motion::Vec3& p) const {
    if (!translation_) return std::nullopt;
    return *translation_ + DirectionToMachine(p);
  }
  std::optional<motion::Vec3> PointToProgram(const motion::Vec3& p) const {
    if (!translation_) return std::nullopt;
    return DirectionToProgram(p - *translation_);
  }

 private:
  std::array<motion::Vec3, 3> columns_ = {motion::Vec3{1, 0, 0}, motion::Vec3{0, 1, 0},
                                          motion::Vec3{0, 0, 1}};
  std::optional<motion::Vec3> translation_ = motion::Vec3{};  // only while all six are numbers
};

// The columns of Rz(rz) Ry(ry) Rx(rx), rad.
std::array<motion::Vec3, 3> RotationColumns(double rz, double ry, double rx);

}  // namespace rmlcell::optimo
