#pragma once

#include <span>

#include "engine/core/result.h"
#include "engine/machine/panel.h"
#include "engine/machine/parameters.h"
#include "engine/machine/profile_files.h"
#include "engine/motion/planner/feed_steps.h"
#include "engine/rml1/command_reader.h"

namespace rmlcell::rml1 {

// How the spindle speed can be set (RML1-3C.15 to 3C.20).
enum class SpindleControl : std::uint8_t {
  kRpm,     // stages and revolutions per minute
  kStages,  // stages only
  kNone,    // not by command
};

struct Travel {
  double low = 0.0;
  double high = 0.0;
};

// What one model of machine is, in the units of its streams: device units (1/100 mm, on older
// machines 1/40 mm, RML1-1.08) from the machine's zero, Z 0 at the top and negative downwards
// (RML1-9.10). Speeds in mm/s, angles in degrees.
struct Profile {
  double units_per_mm = 100.0;
  Travel x;
  Travel y;
  Travel z;
  double origin_x = 0.0;  // XY work origin as set on the panel
  double origin_y = 0.0;
  double z0 = 0.0;  // work origin of Z at power-on
  double z1 = 0.0;  // default tool heights, from Z0
  double z2 = 0.0;
  double clamps_height = 0.0;  // of what holds the work, above Z0; 0: not known

  motion::FeedSteps xy_speeds;
  motion::FeedSteps z_speeds;
  double xy_speed = 2.0;  // defaults of F, VS and V, !VZ
  double z_speed = 2.0;
  double travel_speed = 60.0;
  double acceleration_mm_s2 = 200.0;
  double speed_jump_mm_s = 3.0;  // of an axis at the vertex of a polyline; motion.md section 7

  int spindle_min_rpm = 0;
  int spindle_max_rpm = 0;
  int spindle_step_rpm = 1;  // digits below are dropped
  SpindleControl spindle_control = SpindleControl::kRpm;
  double spin_up_s = 0.0;
  double spin_down_s = 0.0;

  bool has_y = true;
  bool has_rotary = false;
  bool y_with_rotary = true;  // Y and A may move in one group of !ZE (RML1-3D.13)
  double rotary_speed_deg_s = 0.0;
  double rotary_acceleration_deg_s2 = 0.0;
  bool rotary_reversed = false;
  double step_mm = 0.0;  // mechanical resolution, for step counts (RML1-9.22)
  double rotary_step_deg = 0.0;

  CommandSet commands;
  bool panel_described = false;  // its keys are known: LIVE-2.13
  machine::CoverAct cover = machine::CoverAct::kPause;
  bool origin_by_panel = false;  // ORIGIN has set it: kept beside the registers
  double jog_step_mm = 0.01;     // of a jog key that is tapped

  bool pause_outside = false;  // OVER_AREA (RML1-5A.35)
  bool seven_bits = false;
  bool all_sequences = false;
  std::size_t buffer_bytes = 0;
};

// The machine parameters of the family; their defaults are the test profile T1 of rml1.md 0.2.
std::span<const machine::ParameterInfo> ParameterTable();

// The files of engine/rml1/profiles, in the order of engine/rml1/CMakeLists.txt.
std::span<const machine::ProfileText> ProfileTexts();

// The same, read: the test profiles and the machines of rml1-profiles.md.
std::span<const machine::MachineProfile> MachineProfiles();

// Error: CellParameterRange when two parameters do not fit together (a travel of nothing, a lowest
// speed above the highest).
Status CheckFit(const machine::Parameters& parameters);

// Error: as CheckFit.
Result<Profile> MakeProfile(const machine::Parameters& parameters);

}  // namespace rmlcell::rml1
