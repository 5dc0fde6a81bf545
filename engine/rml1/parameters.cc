#include <array>

#include "engine/machine/profile_files.h"
#include "engine/rml1/profile.h"

namespace rmlcell::rml1 {
namespace {

using machine::ParameterInfo;

// The defaults are the test profile T1 of rml1.md 0.2: the machine of the specification's examples.
// clang-format off
constexpr std::array kParameters = {
    // name             unit     default  min     max      choices               text                                                     rule
    ParameterInfo{"UNITS_PER_MM",   "",       100.0,   1.0,  10000.0, {}, "coordinate units of a program in one millimetre", "RML1-1.08"},
    ParameterInfo{"X_MIN",          "mm",       0.0, -1e4,      1e4, {}, "lower end of the X travel, from the machine's zero", "RML1-5A.01"},
    ParameterInfo{"X_MAX",          "mm",     200.0, -1e4,      1e4, {}, "upper end of the X travel", "RML1-5A.01"},
    ParameterInfo{"Y_MIN",          "mm",       0.0, -1e4,      1e4, {}, "lower end of the Y travel", "RML1-5A.01"},
    ParameterInfo{"Y_MAX",          "mm",     150.0, -1e4,      1e4, {}, "upper end of the Y travel", "RML1-5A.01"},
    ParameterInfo{"Z_MIN",          "mm",     -60.0, -1e4,      0.0, {}, "bottom of the Z travel; the top is 0", "RML1-9.10"},
    ParameterInfo{"ORIGIN_X",       "mm",       0.0, -1e4,      1e4, {}, "XY work origin as set on the panel, machine X", "RML1-3A.40"},
    ParameterInfo{"ORIGIN_Y",       "mm",       0.0, -1e4,      1e4, {}, "XY work origin as set on the panel, machine Y", "RML1-3A.40"},
    ParameterInfo{"Z0",             "mm",     -20.0, -1e4,      0.0, {}, "work origin of Z at power-on and after !ZO, machine Z", "RML1-9.11"},
    ParameterInfo{"Z1",             "mm",       0.0, -1e4,      0.0, {}, "default tool-down height, from Z0", "RML1-3A.03"},
    ParameterInfo{"Z2",             "mm",       5.0,  0.0,      1e4, {}, "default tool-up height, from Z0", "RML1-3A.03"},
    ParameterInfo{"CLAMP_HEIGHT",   "mm",       0.0,  0.0,      1e4, {}, "how far clamps stand above Z0; 0: none that could be in the way", "RML1-9.11"},
    ParameterInfo{"XY_SPEED_MIN",   "mm/s",     0.5, 0.01,      1e4, {}, "lowest cutting speed in X and Y", "RML1-3A.46"},
    ParameterInfo{"XY_SPEED_MAX",   "mm/s",    60.0, 0.01,      1e4, {}, "highest cutting speed in X and Y", "RML1-3A.46"},
    ParameterInfo{"XY_SPEED",       "mm/s",     2.0, 0.01,      1e4, {}, "cutting speed at power-on and after F, VS, DF, IN", "RML1-9.08"},
    ParameterInfo{"Z_SPEED_MIN",    "mm/s",     0.5, 0.01,      1e4, {}, "lowest speed of Z and of three-axis motion", "RML1-3A.51"},
    ParameterInfo{"Z_SPEED_MAX",    "mm/s",    60.0, 0.01,      1e4, {}, "highest speed of Z and of three-axis motion", "RML1-3A.51"},
    ParameterInfo{"Z_SPEED",        "mm/s",     2.0, 0.01,      1e4, {}, "speed of Z at power-on and after V, !VZ, DF, IN", "RML1-9.08"},
    ParameterInfo{"TRAVEL_SPEED",   "mm/s",    60.0, 0.01,      1e4, {}, "speed with the tool up", "RML1-9.44"},
    ParameterInfo{"ACCELERATION",   "mm/s2",  200.0,  0.1,      1e6, {}, "acceleration along the path", "RML1-9.45"},
    ParameterInfo{"SPEED_JUMP",     "mm/s",     3.0, 0.01,      1e4, {}, "change of speed that an axis can make at once, at the corner of a path", "RML1-9.45"},
    ParameterInfo{"SPINDLE_MIN",    "rpm",   4500.0,  0.0,      1e6, {}, "lowest spindle speed, and the one at power-on", "RML1-9.32"},
    ParameterInfo{"SPINDLE_MAX",    "rpm",  15000.0,  0.0,      1e6, {}, "highest spindle speed", "RML1-3C.15"},
    ParameterInfo{"SPINDLE_STEP",   "rpm",    100.0,  1.0,      1e6, {}, "a speed in rpm is cut down to a multiple of this", "RML1-3C.16"},
    ParameterInfo::OfWord("SPINDLE_CONTROL", "RPM STAGES NONE", "what !RC can do on this model", "RML1-3C.20"),
    ParameterInfo{"SPIN_UP",        "s",        0.0,  0.0,    600.0, {}, "wait of the first motion until the spindle turns steadily", "RML1-9.33"},
    ParameterInfo{"SPIN_DOWN",      "s",        0.0,  0.0,    600.0, {}, "wait after !MC 0 until a turning spindle stands", "RML1-3C.02"},
    ParameterInfo::OfWord("AXES", "XYZ XYZA XZA", "axes of the model; A is the rotary axis", "RML1-3D.10"),
    ParameterInfo::OfWord("Y_WITH_A", "YES NO", "Y and A may move in one group of !ZE", "RML1-3D.13"),
    ParameterInfo{"A_SPEED",        "deg/s",   60.0, 0.01,      1e5, {}, "highest speed of the rotary axis", "RML1-3D.29"},
    ParameterInfo{"A_ACCELERATION", "deg/s2", 200.0,  0.1,      1e7, {}, "acceleration of the rotary axis", "RML1-3D.29"},
    ParameterInfo::OfWord("A_SENSE", "RIGHT LEFT", "sense of rotation of A about X: right-handed or reversed", "RML1-3D.29"),
    ParameterInfo{"A_STEP",         "deg",     0.01, 1e-6,     10.0, {}, "mechanical resolution of the rotary axis", "RML1-3D.29"},
    ParameterInfo{"STEP",           "mm",      0.01, 1e-6,     10.0, {}, "mechanical resolution of X, Y and Z", "RML1-9.22"},
    ParameterInfo::OfWord("PANEL", "PLAIN FULL", "keys of the panel: PLAIN, which nobody has described, pauses, opens the cover and switches power; FULL has VIEW, SPINDLE, Z0, ORIGIN and HOME, too", "RML1-3C.11"),
    ParameterInfo::OfWord("COVER", "PAUSE EMERGENCY NONE", "what opening the cover does to a run: it comes to rest and goes on when somebody resumes it behind a closed cover; an emergency stop; nothing", "DEV-3.12"),
    ParameterInfo{"JOG_STEP",       "mm",      0.01, 1e-4,     10.0, {}, "how far a tap of a jog key goes", "RML1-9.22"},
    ParameterInfo::OfWord("COMMAND", "AUTO MODE1 MODE2", "command set", "RML1-9.01"),
    ParameterInfo::OfWord("AXIS_COMMAND", "YES NO", "the model has !ZE", "RML1-3D.01"),
    ParameterInfo::OfWord("SKIP", "NONE TOOL_CHANGE VPANEL PNC3000", "vendor commands that are skipped with their parameters: J; also !CO !SL !SP !RD; !1 and !0", "RML1-9.48"),
    ParameterInfo::OfWord("OVER_AREA", "CONTINUE PAUSE", "what happens when the tool comes back into the cutting range", "RML1-5A.35"),
    ParameterInfo::OfWord("DATA_BITS", "8 7", "data bits of the link; with 7 the top bit of every byte is cleared", "RML1-1.12"),
    ParameterInfo::OfWord("SEQUENCES", "K ALL", "device control sequences: ESC.K alone, or ESC.M and ESC.T as well, without effect", "RML1-9.37"),
    ParameterInfo{"BUFFER",         "bytes", 65536.0, 256.0, 16777216.0, {}, "receive buffer, filled while the machine is paused", "RML1-4.23"},
};
// clang-format on

}  // namespace

std::span<const ParameterInfo> ParameterTable() { return kParameters; }
// T1 and its kin of rml1.md 0.2, then the machines of rml1-profiles.md. Where a file has no figure
// the default stands. Z0 is 20 mm below the top on all of them, where an operator might put the
// surface of the work: programs lift the tool above it.
std::span<const machine::MachineProfile> MachineProfiles() {
  static const machine::ProfileFiles profiles(ProfileTexts());
  return profiles.all();
}

}  // namespace rmlcell::rml1
