#pragma once

#include <optional>

#include "engine/motion/geometry/frames.h"
#include "engine/optimo/language/program.h"

namespace rmlcell::optimo {

// The system of SYSDEF, p_machine = T + R p with R = Rz(rz) Ry(ry) Rx(rx), as far as it stands in
// the text (OPT-7.29, OPT-8.23). Without SYSDEF it is that of the machine.
class ProgramFrame {
 public:
  // Takes a SYSDEF; without values there is none. False when one of its rotations is no number: it
  // is 0 then.
  bool Set(const ParsedProgram& program, const Instruction& sysdef);

  // For directions: machine from program.
  const motion::Rotation& rotation() const { return rotation_; }
  motion::ProgramVector DirectionToProgram(const motion::MachineVector& d) const {
    return rotation_.transpose() * d;
  }

  // Nothing where SYSDEF has values that are no numbers.
  std::optional<motion::MachinePoint> PointToMachine(const motion::ProgramPoint& p) const {
    if (!whole_) return std::nullopt;
    return *whole_ * p;
  }
  std::optional<motion::ProgramPoint> PointToProgram(const motion::MachinePoint& p) const {
    if (!whole_) return std::nullopt;
    return whole_->ToProgram(p);
  }

 private:
  motion::Rotation rotation_ = motion::Rotation::Identity();  // known where the place is not, too
  std::optional<motion::MachineFromProgram> whole_ = motion::MachineFromProgram();
};

}  // namespace rmlcell::optimo
