#pragma once

#include <span>
#include <vector>

#include "engine/core/result.h"
#include "engine/machine/parameters.h"
#include "engine/machine/run_setup.h"
#include "engine/machine/shape.h"
#include "engine/motion/planner/planner.h"
#include "engine/optimo/language/ast.h"
#include "engine/optimo/offline/contour_advice.h"

namespace rmlcell::optimo {

enum class Laser { kArrow, kEfa51 };  // OPT-3.14, OPT-3.15

// The machine parameters of optimo.md B.1, as values. OPT-B.01
struct OptimoParameters {
  motion::MachineLimits limits;
  double head_length_mm = 300.0;
  motion::AxisPose home;
  motion::AxisPose mechanical_zero;
  double safe_z_mm = -50.0;  // of the column; LIVE-6.05
  double cycle_s = 0.048;
  CoordType coord_default = CoordType::kRobot;
  PathType path_default = PathType::kPtp;
  Laser laser = Laser::kArrow;
  int gas_channels = 2;
  bool teach_simulator = false;
  bool rotary_table = false;
  int object_limit = 34'000;
  int executable_limit = 32'768;
  double cmos_bytes = 1'048'576.0;
  int gosub_depth = 16;
  double call_time_s = 0.0;
  int schedules = 63;  // laser schedules 1 to this are there without being stored; OPT-3.44
  double laser_w = 1500.0;
};

std::span<const machine::ParameterInfo> OptimoParameterTable();
const std::vector<machine::MachineProfile>& OptimoProfiles();

// Error: CellParameterRange when the least travel of an axis is above its greatest; one that cannot
// move at all is clamped and no error (OPT-B.06, OPT-B.08).
Status CheckFit(const machine::Parameters& parameters);

// Precondition: `parameters` are of OptimoParameterTable, and fit together.
OptimoParameters Resolve(const machine::Parameters& parameters);
machine::MachineShape ShapeOf(const OptimoParameters& parameters);
// Whether a program may select it: one that was stored, or that the machine has by default.
// OPT-3.44
bool HasSchedule(const OptimoParameters& parameters,
                 const std::vector<machine::LaserSchedule>& stored, int number);
// What the advice on paths needs to know of it.
ContourMachine ContourMachineOf(const OptimoParameters& parameters);

}  // namespace rmlcell::optimo
