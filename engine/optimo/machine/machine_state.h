#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"
#include "engine/machine/run.h"
#include "engine/motion/geometry/frames.h"
#include "engine/motion/kinematics/kinematics.h"
#include "engine/optimo/language/ast.h"
#include "engine/optimo/machine/optimo_parameters.h"

namespace rmlcell::optimo {

inline constexpr int kVariableCount = kVariableIndexMax + 1;
inline constexpr int kGas2 = 8;  // numbers of OL, OPT-5.39
inline constexpr int kGas3 = 9;
using Numbers = std::array<float, kVariableCount>;
using Bits = std::array<bool, kVariableCount>;

// Variables, the images of inputs and outputs, and the inputs. OPT-7.59 to 7.64, OPT-7.96 to 7.101
struct DataArea {
  Numbers vr{};
  Numbers vi{};  // whole numbers
  Bits vl{};
  Bits il{};  // images
  Bits ol{};
  Numbers ia{};
  Numbers oa{};
  Bits il_physical{};  // as the script of inputs sets them
  Numbers ia_physical{};
};

// What the machine holds on to outside: outputs, the laser schedule in force, the rotary table.
struct Outputs {
  Bits logical{};
  Numbers analogue{};
  int schedule = 0;        // 0: none was selected, OPT-3.26
  double table_deg = 0.0;  // of FUNCTION 99
};

// "VR[5]", the groups in either case. Nothing for what names no variable; PAR is none of a machine.
std::optional<Variable> VariableNamed(std::string_view name);
// "VR[5]" -> "7.0". Nothing for what names no variable.
std::optional<machine::VariableValue> ReadByName(const DataArea& data, std::string_view name);

// What the variable holds when it is given this value; outputs: their images. Errors:
// CellInvalidArgument: what only the machine writes (OPT-7.66), or a value that it cannot hold;
// Gas3NotFitted.
Result<float> Writable(Variable variable, double value, const OptimoParameters& parameters);

// SYSDEF in force. OPT-7.28 to 7.40
struct WorkOffsetState {
  bool active = false;
  std::array<double, 6> values{};  // dx dy dz, rz ry rx

  motion::MachineFromProgram frame() const {
    if (!active) return {};
    return motion::MachineFromProgram(
        motion::RigidMotionOf({values[0], values[1], values[2]}, values[3], values[4], values[5]));
  }
};

// TCP in force: tool offset, and the reference point that decides the jog direction. OPT-4.64
struct ToolState {
  motion::ToolOffset offset{};
  std::array<double, 3> reference{0.0, 0.0, -5.0};  // OPT-4.68
};

// All that a machine keeps from one run to the next: a run begins with it and leaves another one.
// While it goes on each part of the control has its own (control_state.h). A value.
struct MachineState {
  DataArea data{};
  Outputs outputs{};
  motion::AxisPose axes{};
  ToolState tool{};
  WorkOffsetState work_offset{};
  bool zeroed = true;
  bool door_open = false;
  int selected = 0;  // program whose executions VI[98] counts, OPT-B.63
  std::optional<machine::ProgramStep> breakpoint{};  // of the instruction BREAK, OPT-6.08
  std::optional<machine::ProgramStep> simul{};       // of SIMUL: arms the next start, OPT-6.16
};

// Its terminals, as people are shown them; what the beam does is not in it.
machine::MachineOutputs OutputsOf(const Outputs& outputs);

// As it leaves the factory. OPT-B.02
MachineState NewMachine(const OptimoParameters& parameters);

std::string EncodeMachineState(const MachineState& state);
// Errors: CellBadText: not bytes of EncodeMachineState, or of a newer version.
Result<MachineState> DecodeMachineState(std::string_view bytes);

}  // namespace rmlcell::optimo
