#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/rml1/profile.h"

namespace rmlcell::rml1 {

// A speed that the program asked for and the machine does not have, with the one that it took.
struct SpeedLimit {
  double asked = 0.0;
  double used = 0.0;

  // By how much they differ, of the greater one: 0 to 1, and more where less than nothing is asked.
  double off() const {
    const double greater = std::max(asked, used);
    return greater > 0.0 ? std::abs(asked - used) / greater : 0.0;
  }
};

// What commands set and a new command set reads (RML1-7.08). Heights in device units: z0 from the
// machine's zero, z1 and z2 from z0 and as they were given, beyond the range too (RML1-9.23).
// `surface_z` is where Z0 was before the program: there the operator set it, and !ZO moves no
// material. All that is said of depth counts from it.
struct Registers {
  explicit Registers(const Profile& profile)
      : xy_speed(profile.xy_speed),
        z_speed(profile.z_speed),
        z0(profile.z0),
        surface_z(profile.z0),
        z1(profile.z1),
        z2(profile.z2),
        rpm(profile.spindle_min_rpm) {}

  bool absolute = true;
  bool tool_down = false;
  double xy_speed;              // F, VS: mm/s
  double z_speed;               // V, !VZ: mm/s
  bool xy_speed_given = false;  // by the program, and not the default of the machine
  bool z_speed_given = false;
  bool mode_given = false;      // whether coordinates are absolute
  bool heights_given = false;   // z1, z2
  bool rotation_given = false;  // !MC
  bool x_given = false;         // a place, not only a way from where the tool stood
  bool y_given = false;
  std::uint64_t act = 0;             // number of the set or command that is carried out
  std::uint64_t place_given_by = 0;  // that of the act that gave both first; 0: none did
  SpeedLimit xy_limit;               // mm/s; of the speeds above where they were limited
  SpeedLimit z_limit;
  SpeedLimit rpm_limit;
  int dwell_ms = 0;
  double z0;
  double surface_z;
  double z1;
  double z2;
  bool rotation = true;     // !MC
  bool spindle_on = false;  // when the actions that wait are done
  int rpm;

  // Heights are sums of decimal steps in binary: so close to the surface is on it. Device units.
  static constexpr double kSameHeight = 2e-6;
  bool IsBelowSurface(double z) const { return z < surface_z - kSameHeight; }

  // The heights that are really used, from the machine's zero (RML1-3A.07, RML1-3B.18).
  double down_z(const Profile& profile) const { return std::max(z0 + z1, profile.z.low); }
  double up_z(const Profile& profile) const { return std::min(z0 + z2, profile.z.high); }
  double tool_z(const Profile& profile) const {
    return tool_down ? down_z(profile) : up_z(profile);
  }
};

}  // namespace rmlcell::rml1
