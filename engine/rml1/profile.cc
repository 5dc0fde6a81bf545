#include "engine/rml1/profile.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/number_text.h"

namespace rmlcell::rml1 {
namespace {

machine::CoverAct CoverOf(std::string_view word) {
  if (word == "NONE") return machine::CoverAct::kNone;
  return word == "EMERGENCY" ? machine::CoverAct::kEmergency : machine::CoverAct::kPause;
}

// "X_MIN is 100, not below X_MAX, which is 50".
Error Misfit(const machine::Parameters& parameters, const std::string& what,
             std::string_view against) {
  const std::string low = what + "_MIN";
  const std::string high = what + "_MAX";
  return {ErrorCode::kCellParameterRange,
          Told("name", low) + " is " + parameters.ToldNumber("value", low) + ", " + against + " " +
              Told("limit_name", high) + ", which is " + parameters.ToldNumber("limit", high),
          {}};
}

// Device units; 203.2 mm are 20320 of them and not a rounding error less.
double Units(double mm, double units_per_mm) { return std::round(mm * units_per_mm * 1e6) * 1e-6; }

std::uint8_t SkippedNames(std::string_view word) {
  if (word == "TOOL_CHANGE") return kSkipToolChange;
  if (word == "VPANEL") return kSkipToolChange | kSkipVPanel;
  if (word == "PNC3000") return kSkipPnc3000;
  return kSkipNothing;
}

CommandSetting SettingOf(std::string_view word) {
  if (word == "MODE1") return CommandSetting::kMode1;
  if (word == "MODE2") return CommandSetting::kMode2;
  return CommandSetting::kAuto;
}

SpindleControl SpindleControlOf(std::string_view word) {
  if (word == "STAGES") return SpindleControl::kStages;
  if (word == "NONE") return SpindleControl::kNone;
  return SpindleControl::kRpm;
}

void ReadFigures(const machine::Parameters& from, Profile& profile) {
  const double units = from.Number("UNITS_PER_MM");
  const auto units_of = [&](std::string_view name) { return Units(from.Number(name), units); };
  profile.units_per_mm = units;
  profile.x = {units_of("X_MIN"), units_of("X_MAX")};
  profile.y = {units_of("Y_MIN"), units_of("Y_MAX")};
  profile.z = {units_of("Z_MIN"), 0.0};
  profile.origin_x = units_of("ORIGIN_X");
  profile.origin_y = units_of("ORIGIN_Y");
  profile.z0 = std::clamp(units_of("Z0"), profile.z.low, 0.0);
  profile.z1 = units_of("Z1");
  profile.z2 = units_of("Z2");
  profile.clamps_height = units_of("CLAMP_HEIGHT");
  profile.xy_speeds.minimum_mm_s = from.Number("XY_SPEED_MIN");
  profile.xy_speeds.maximum_mm_s = from.Number("XY_SPEED_MAX");
  profile.z_speeds.minimum_mm_s = from.Number("Z_SPEED_MIN");
  profile.z_speeds.maximum_mm_s = from.Number("Z_SPEED_MAX");
  profile.xy_speed = profile.xy_speeds.Nearest(from.Number("XY_SPEED"));
  profile.z_speed = profile.z_speeds.Nearest(from.Number("Z_SPEED"));
  profile.travel_speed = from.Number("TRAVEL_SPEED");
  profile.acceleration_mm_s2 = from.Number("ACCELERATION");
  profile.speed_jump_mm_s = from.Number("SPEED_JUMP");
  profile.spindle_min_rpm = static_cast<int>(from.Number("SPINDLE_MIN"));
  profile.spindle_max_rpm = static_cast<int>(from.Number("SPINDLE_MAX"));
  profile.spindle_step_rpm = static_cast<int>(from.Number("SPINDLE_STEP"));
  profile.spin_up_s = from.Number("SPIN_UP");
  profile.spin_down_s = from.Number("SPIN_DOWN");
  profile.rotary_speed_deg_s = from.Number("A_SPEED");
  profile.rotary_acceleration_deg_s2 = from.Number("A_ACCELERATION");
  profile.rotary_step_deg = from.Number("A_STEP");
  profile.step_mm = from.Number("STEP");
  profile.jog_step_mm = from.Number("JOG_STEP");
  profile.buffer_bytes = static_cast<std::size_t>(from.Number("BUFFER"));
}

void ReadWords(const machine::Parameters& from, Profile& profile) {
  profile.spindle_control = SpindleControlOf(from.Word("SPINDLE_CONTROL"));
  profile.has_y = from.Word("AXES") != "XZA";
  profile.has_rotary = from.Word("AXES") != "XYZ";
  profile.y_with_rotary = from.Word("Y_WITH_A") == "YES";
  profile.rotary_reversed = from.Word("A_SENSE") == "LEFT";
  profile.commands.setting = SettingOf(from.Word("COMMAND"));
  profile.commands.axis_command = from.Word("AXIS_COMMAND") == "YES";
  profile.commands.skipped = SkippedNames(from.Word("SKIP"));
  profile.panel_described = from.Word("PANEL") == "FULL";
  profile.cover = CoverOf(from.Word("COVER"));
  profile.pause_outside = from.Word("OVER_AREA") == "PAUSE";
  profile.seven_bits = from.Word("DATA_BITS") == "7";
  profile.all_sequences = from.Word("SEQUENCES") == "ALL";
}

}  // namespace

Status CheckFit(const machine::Parameters& parameters) {
  for (const std::string axis : {"X", "Y"}) {
    if (!(parameters.Number(axis + "_MIN") < parameters.Number(axis + "_MAX"))) {
      return Misfit(parameters, axis, "not below");
    }
  }
  if (!(parameters.Number("Z_MIN") < 0.0)) {
    return Error{ErrorCode::kCellParameterRange, "Z_MIN is not below 0, the top", {}};
  }
  for (const std::string what : {"XY_SPEED", "Z_SPEED", "SPINDLE"}) {
    if (parameters.Number(what + "_MIN") > parameters.Number(what + "_MAX")) {
      return Misfit(parameters, what, "above");
    }
  }
  return {};
}

Result<Profile> MakeProfile(const machine::Parameters& parameters) {
  if (const Status fit = CheckFit(parameters); !fit) return fit.error();
  Profile profile;
  ReadFigures(parameters, profile);
  ReadWords(parameters, profile);
  return profile;
}

}  // namespace rmlcell::rml1
