#include "engine/optimo/machine/optimo_parameters.h"

#include <algorithm>
#include <array>
#include <string>

#include "engine/core/number_text.h"
#include "engine/core/units.h"

namespace rmlcell::optimo {
namespace {

using machine::ParameterInfo;

constexpr ParameterInfo Number(std::string_view name, std::string_view unit, double standard,
                               double low, double high, std::string_view text,
                               std::string_view rule = "OPT-B.01") {
  return {name, unit, standard, low, high, {}, text, rule};
}

constexpr std::array kTable = {
    Number("VMAX", "mm/s", 500, 1, 2000, "tip speed of SPEED 100", "OPT-2.34"),
    Number("AMAX", "mm/s2", 2000, 10, 50'000, "tip acceleration of ACCEL 100", "OPT-2.36"),
    Number("JMAX", "mm/s3", 40'000, 100, 10'000'000, "tip jerk"),
    Number("AXIS_SPEED_X", "mm/s", 500, 1, 5000, "highest speed of the X axis"),
    Number("AXIS_SPEED_Y", "mm/s", 500, 1, 5000, "highest speed of the Y axis"),
    Number("AXIS_SPEED_Z", "mm/s", 500, 1, 5000, "highest speed of the Z axis"),
    Number("AXIS_SPEED_A", "rad/s", kTurn, 0.01, 100, "highest speed of the A axis"),
    Number("AXIS_SPEED_B", "rad/s", kTurn, 0.01, 100, "highest speed of the B axis"),
    Number("AXIS_ACCEL_X", "mm/s2", 2000, 10, 50'000, "highest acceleration of the X axis"),
    Number("AXIS_ACCEL_Y", "mm/s2", 2000, 10, 50'000, "highest acceleration of the Y axis"),
    Number("AXIS_ACCEL_Z", "mm/s2", 2000, 10, 50'000, "highest acceleration of the Z axis"),
    Number("AXIS_ACCEL_A", "rad/s2", 20, 0.1, 1000, "highest acceleration of the A axis"),
    Number("AXIS_ACCEL_B", "rad/s2", 20, 0.1, 1000, "highest acceleration of the B axis"),
    Number("AXIS_JERK_X", "mm/s3", 40'000, 100, 10'000'000, "highest jerk of the X axis"),
    Number("AXIS_JERK_Y", "mm/s3", 40'000, 100, 10'000'000, "highest jerk of the Y axis"),
    Number("AXIS_JERK_Z", "mm/s3", 40'000, 100, 10'000'000, "highest jerk of the Z axis"),
    Number("AXIS_JERK_A", "rad/s3", 400, 1, 100'000, "highest jerk of the A axis"),
    Number("AXIS_JERK_B", "rad/s3", 400, 1, 100'000, "highest jerk of the B axis"),
    Number("HEAD_LENGTH", "mm", 300, 1, 2000,
           "column to calibrated tip, which is 0.8 mm below the nozzle", "OPT-B.04"),
    Number("TRAVEL_X_MIN", "mm", -600, -100'000, 100'000, "least X of the column", "OPT-B.08"),
    Number("TRAVEL_X_MAX", "mm", 3600, -100'000, 100'000, "greatest X of the column", "OPT-B.08"),
    Number("TRAVEL_Y_MIN", "mm", -600, -100'000, 100'000, "least Y of the column", "OPT-B.08"),
    Number("TRAVEL_Y_MAX", "mm", 3100, -100'000, 100'000, "greatest Y of the column", "OPT-B.08"),
    Number("TRAVEL_Z_MIN", "mm", -1300, -100'000, 100'000, "least Z of the column", "OPT-B.08"),
    Number("TRAVEL_Z_MAX", "mm", 1100, -100'000, 100'000, "greatest Z of the column", "OPT-B.08"),
    Number("TRAVEL_A_MIN", "rad", -12.6, -1000, 1000, "least A; never reduced by a turn",
           "OPT-B.06"),
    Number("TRAVEL_A_MAX", "rad", 12.6, -1000, 1000, "greatest A", "OPT-B.06"),
    Number("TRAVEL_B_MIN", "rad", -2.4, -1000, 1000, "least B", "OPT-B.06"),
    Number("TRAVEL_B_MAX", "rad", 2.4, -1000, 1000, "greatest B", "OPT-B.06"),
    Number("HOME_X", "mm", 21.02, -100'000, 100'000, "home: X of the column", "OPT-B.02"),
    Number("HOME_Y", "mm", 2201.2, -100'000, 100'000, "home: Y of the column", "OPT-B.02"),
    Number("HOME_Z", "mm", -50, -100'000, 100'000, "home: Z of the column", "OPT-B.02"),
    Number("HOME_A", "rad", 0, -1000, 1000, "home: angle A", "OPT-B.02"),
    Number("HOME_B", "rad", 0, -1000, 1000, "home: angle B", "OPT-B.02"),
    Number("MECH_ZERO_X", "mm", 0, -100'000, 100'000, "mechanical zero, column X", "OPT-B.60"),
    Number("MECH_ZERO_Y", "mm", 0, -100'000, 100'000, "mechanical zero, column Y", "OPT-B.60"),
    Number("MECH_ZERO_Z", "mm", 0, -100'000, 100'000, "mechanical zero, column Z", "OPT-B.60"),
    Number("MECH_ZERO_A", "rad", 0, -1000, 1000, "mechanical zero, A", "OPT-B.60"),
    Number("MECH_ZERO_B", "rad", 0, -1000, 1000, "mechanical zero, B", "OPT-B.60"),
    Number(
        "SAFE_Z", "mm", -50, -100'000, 100'000,
        "Z of the column above all that stands on the table: a start at a step goes across there",
        "LIVE-6.05"),
    Number("CYCLE", "s", 0.048, 0.001, 1, "system cycle: OA[0], sampling of conditions",
           "OPT-7.69"),
    Number("SETTLE", "s", 0.048, 0, 1, "standstill after a MOVE without /FLY", "OPT-B.20"),
    ParameterInfo::OfWord("COORD_DEFAULT", "ROBOT ABSOL", "COORD at program start", "OPT-2.09"),
    ParameterInfo::OfWord("PATH_DEFAULT", "PTP LIN", "PATH at program start", "OPT-2.10"),
    ParameterInfo::OfWord("LASER", "ARROW EFA51", "kind of laser: how shutter and beam behave",
                          "OPT-3.14"),
    Number("GAS_CHANNELS", "", 2, 2, 3, "assist gases fitted", "OPT-5.41"),
    ParameterInfo::OfWord("TEACH_SIM", "OFF ON",
                          "the old teach simulator: a hole cannot start on its axis", "OPT-2.28"),
    ParameterInfo::OfWord("ROTARY_TABLE", "OFF ON", "FUNCTION 99 turns a rotary table", "OPT-9.19"),
    Number("OBJECT_LIMIT", "characters", 34'000, 100, 10'000'000, "largest object", "OPT-1.08"),
    Number("EXECUTABLE_LIMIT", "bytes", 32'768, 100, 10'000'000, "executables are smaller",
           "OPT-9.10"),
    Number("CMOS_SIZE", "bytes", 1'048'576, 1000, 1e12, "all objects and executables", "OPT-B.73"),
    Number("GOSUB_DEPTH", "", 16, 1, 1000, "GOSUBs inside each other", "OPT-7.21"),
    Number("CALL_TIME", "s", 0, 0, 600, "loading a CALLed program", "OPT-7.11"),
    Number("SCHEDULES", "", 63, 0, 63,
           "laser schedules 1 to this are there, CW with 100 %, where none was stored", "OPT-3.44"),
    Number("LASER_POWER", "W", 1500, 1, 100'000, "rated power, for energy figures", "motion.md 1"),
};

constexpr std::array<std::string_view, motion::kAxisCount> kAxisNames = {"X", "Y", "Z", "A", "B"};

motion::AxisValues PerAxis(const machine::Parameters& parameters, const std::string& before,
                           const std::string& after) {
  motion::AxisValues values{};
  std::transform(kAxisNames.begin(), kAxisNames.end(), values.begin(), [&](std::string_view axis) {
    return parameters.Number(before + std::string(axis) + after);
  });
  return values;
}

motion::AxisPose PoseOf(const motion::AxisValues& v) {
  return {.column = {v[0], v[1], v[2]}, .a_rad = v[3], .b_rad = v[4]};
}

}  // namespace

std::span<const ParameterInfo> OptimoParameterTable() { return kTable; }

const std::vector<machine::MachineProfile>& OptimoProfiles() {
  static const std::vector<machine::MachineProfile> profiles = {
      {"standard", "Optimo of 30 m/min with ARROW laser", {}},
      {"mc-1000ipm", "MC series, 1000 inch/min", {{"VMAX", 423.333}}},
      {"pw-1993",
       "customer machine that starts in COORD ABSOL, PATH LIN",
       {{"COORD_DEFAULT", "ABSOL"}, {"PATH_DEFAULT", "LIN"}}},
      {"efa-51", "Optimo with EFA-51 laser", {{"LASER", "EFA51"}}},
  };
  return profiles;
}

Status CheckFit(const machine::Parameters& parameters) {
  for (const std::string_view axis : kAxisNames) {
    const std::string low = "TRAVEL_" + std::string(axis) + "_MIN";
    const std::string high = "TRAVEL_" + std::string(axis) + "_MAX";
    if (parameters.Number(low) > parameters.Number(high)) {
      return Error{ErrorCode::kCellParameterRange,
                   Told("name", low) + " is " + parameters.ToldNumber("value", low) + ", above " +
                       Told("limit_name", high) + ", which is " +
                       parameters.ToldNumber("limit", high),
                   {}};
    }
  }
  return {};
}

OptimoParameters Resolve(const machine::Parameters& parameters) {
  OptimoParameters made;
  made.limits.tip_speed_mm_s = parameters.Number("VMAX");
  made.limits.tip_acceleration_mm_s2 = parameters.Number("AMAX");
  made.limits.tip_jerk_mm_s3 = parameters.Number("JMAX");
  made.limits.settling_s = parameters.Number("SETTLE");
  made.limits.axes.speed = PerAxis(parameters, "AXIS_SPEED_", "");
  made.limits.axes.acceleration = PerAxis(parameters, "AXIS_ACCEL_", "");
  made.limits.axes.jerk = PerAxis(parameters, "AXIS_JERK_", "");
  made.limits.axes.travel_min = PerAxis(parameters, "TRAVEL_", "_MIN");
  made.limits.axes.travel_max = PerAxis(parameters, "TRAVEL_", "_MAX");
  made.head_length_mm = parameters.Number("HEAD_LENGTH");
  made.home = PoseOf(PerAxis(parameters, "HOME_", ""));
  made.mechanical_zero = PoseOf(PerAxis(parameters, "MECH_ZERO_", ""));
  made.safe_z_mm = parameters.Number("SAFE_Z");
  made.cycle_s = parameters.Number("CYCLE");
  made.coord_default =
      parameters.Word("COORD_DEFAULT") == "ABSOL" ? CoordType::kAbsol : CoordType::kRobot;
  made.path_default = parameters.Word("PATH_DEFAULT") == "LIN" ? PathType::kLin : PathType::kPtp;
  made.laser = parameters.Word("LASER") == "EFA51" ? Laser::kEfa51 : Laser::kArrow;
  made.gas_channels = static_cast<int>(parameters.Number("GAS_CHANNELS"));
  made.teach_simulator = parameters.Word("TEACH_SIM") == "ON";
  made.rotary_table = parameters.Word("ROTARY_TABLE") == "ON";
  made.object_limit = static_cast<int>(parameters.Number("OBJECT_LIMIT"));
  made.executable_limit = static_cast<int>(parameters.Number("EXECUTABLE_LIMIT"));
  made.cmos_bytes = parameters.Number("CMOS_SIZE");
  made.gosub_depth = static_cast<int>(parameters.Number("GOSUB_DEPTH"));
  made.call_time_s = parameters.Number("CALL_TIME");
  made.schedules = static_cast<int>(parameters.Number("SCHEDULES"));
  made.laser_w = parameters.Number("LASER_POWER");
  return made;
}

machine::MachineShape ShapeOf(const OptimoParameters& parameters) {
  machine::MachineShape shape;
  shape.five_axis = true;
  const motion::AxisLimits& axes = parameters.limits.axes;
  shape.travel.Add(
      motion::MachineVector{axes.travel_min[0], axes.travel_min[1], axes.travel_min[2]});
  shape.travel.Add(
      motion::MachineVector{axes.travel_max[0], axes.travel_max[1], axes.travel_max[2]});
  shape.limits = parameters.limits;
  shape.laser_watts = parameters.laser_w;
  return shape;
}

bool HasSchedule(const OptimoParameters& parameters,
                 const std::vector<machine::LaserSchedule>& stored, int number) {
  return number <= parameters.schedules ||
         std::ranges::find(stored, number, &machine::LaserSchedule::number) != stored.end();
}

ContourMachine ContourMachineOf(const OptimoParameters& parameters) {
  return {.limits = parameters.limits,
          .head_length_mm = parameters.head_length_mm,
          .start = {.coord = parameters.coord_default, .path = parameters.path_default}};
}

}  // namespace rmlcell::optimo
