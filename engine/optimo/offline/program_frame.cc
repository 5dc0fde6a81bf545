#include "engine/optimo/offline/program_frame.h"

#include <cmath>

#include "engine/optimo/offline/literal_text.h"

namespace rmlcell::optimo {

std::array<motion::Vec3, 3> RotationColumns(double rz, double ry, double rx) {
  const double cz = std::cos(rz), sz = std::sin(rz), cy = std::cos(ry), sy = std::sin(ry),
               cx = std::cos(rx), sx = std::sin(rx);
  return {motion::Vec3{cz * cy, sz * cy, -sy},
          motion::Vec3{cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx},
          motion::Vec3{cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx}};
}

bool ProgramFrame::Set(const ParsedProgram& program, const Instruction& sysdef) {
  std::array<double, 6> values{};
  bool moved = true, turned = true;  // by plain numbers
  for (std::uint32_t v = 0; v < 6 && sysdef.value_count == 6; ++v) {
    const auto value = PlainNumber(program, sysdef.first_expression + v);
    bool& known = v < 3 ? moved : turned;
    known = known && value.has_value();
    values[v] = value.value_or(0.0);
  }
  columns_ = RotationColumns(values[3], values[4], values[5]);
  translation_.reset();
  if (moved && turned) translation_ = motion::Vec3{values[0], values[1], values[2]};
  return turned;
}

}  // namespace rmlcell::optimo
