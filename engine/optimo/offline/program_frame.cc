#include "engine/optimo/offline/program_frame.h"

#include <array>

#include "engine/optimo/offline/literal_text.h"

namespace rmlcell::optimo {

bool ProgramFrame::Set(const ParsedProgram& program, const Instruction& sysdef) {
  std::array<double, 6> values{};
  bool moved = true, turned = true;  // by plain numbers
  for (std::uint32_t v = 0; v < 6 && sysdef.value_count == 6; ++v) {
    const auto value = PlainNumber(program, sysdef.first_expression + v);
    bool& known = v < 3 ? moved : turned;
    known = known && value.has_value();
    values[v] = value.value_or(0.0);
  }
  rotation_ = motion::RotationZyx(values[3], values[4], values[5]);
  whole_.reset();
  if (moved && turned) {
    const motion::MachineVector at(values[0], values[1], values[2]);
    whole_.emplace(motion::RigidMotionOf(at, values[3], values[4], values[5]));
  }
  return turned;
}

}  // namespace rmlcell::optimo
