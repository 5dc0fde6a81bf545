#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace rmlcell::rml1 {

// What this reader does with each G and M word; docs/gcode.md is this table for people, and a test
// compares the two.
enum class GcodeUse {
  kRapid,         // G0
  kLine,          // G1
  kArcClockwise,  // G2
  kArcCounter,    // G3
  kDwell,         // G4
  kHome,          // G28
  kPlaneXY,       // G17
  kPlaneZX,       // G18
  kPlaneYZ,       // G19
  kInch,          // G20
  kMetric,        // G21
  kAbsolute,      // G90
  kRelative,      // G91
  kDefault,       // what holds anyway: taken without a word
  kIgnored,       // says nothing to a mill: left out, with a note
  kToolChange,    // M6: left out before the first cut, an error behind it for another tool
  kPause,         // M0 M1
  kEnd,           // M2 M30
  kSpindleOn,     // M3
  kSpindleOff,    // M5
};

struct GcodeRow {
  char letter;
  int tenths;  // 911: G91.1
  GcodeUse use;
  std::string_view text;
};

inline constexpr std::array kGcodeRows = {
    GcodeRow{'G', 0, GcodeUse::kRapid, "rapid, in a straight line"},
    GcodeRow{'G', 10, GcodeUse::kLine, "cut in a straight line at F"},
    GcodeRow{'G', 20, GcodeUse::kArcClockwise, "clockwise arc, with its centre or R"},
    GcodeRow{'G', 30, GcodeUse::kArcCounter, "counterclockwise arc, with its centre or R"},
    GcodeRow{'G', 40, GcodeUse::kDwell, "wait P seconds before the next motion"},
    GcodeRow{'G', 170, GcodeUse::kPlaneXY, "arcs in X and Y, centre by I J"},
    GcodeRow{'G', 180, GcodeUse::kPlaneZX, "arcs in Z and X, centre by I K"},
    GcodeRow{'G', 190, GcodeUse::kPlaneYZ, "arcs in Y and Z, centre by J K"},
    GcodeRow{'G', 200, GcodeUse::kInch, "inches"},
    GcodeRow{'G', 210, GcodeUse::kMetric, "millimetres"},
    GcodeRow{'G', 280, GcodeUse::kHome, "with G91 and zeros: up to the top, then to X0 Y0"},
    GcodeRow{'G', 400, GcodeUse::kIgnored, "no cutter compensation"},
    GcodeRow{'G', 430, GcodeUse::kIgnored, "tool length: Z0 is set with the tool that is in"},
    GcodeRow{'G', 490, GcodeUse::kIgnored, "no tool length offset"},
    GcodeRow{'G', 540, GcodeUse::kIgnored, "first work offset: the origin set on the panel"},
    GcodeRow{'G', 610, GcodeUse::kIgnored, "exact path"},
    GcodeRow{'G', 640, GcodeUse::kIgnored, "path with tolerance"},
    GcodeRow{'G', 800, GcodeUse::kIgnored, "no cycle"},
    GcodeRow{'G', 900, GcodeUse::kAbsolute, "absolute coordinates"},
    GcodeRow{'G', 910, GcodeUse::kRelative, "for G28 alone, until the next G90"},
    GcodeRow{'G', 911, GcodeUse::kDefault, "I and J from the start of the arc"},
    GcodeRow{'G', 940, GcodeUse::kDefault, "F in a minute"},
    GcodeRow{'M', 0, GcodeUse::kPause, "pause until resumed"},
    GcodeRow{'M', 10, GcodeUse::kPause, "pause until resumed"},
    GcodeRow{'M', 20, GcodeUse::kEnd, "end of the program"},
    GcodeRow{'M', 30, GcodeUse::kSpindleOn, "spindle on"},
    GcodeRow{'M', 50, GcodeUse::kSpindleOff, "spindle off"},
    GcodeRow{'M', 60, GcodeUse::kToolChange, "tool change, before the first cut"},
    GcodeRow{'M', 70, GcodeUse::kIgnored, "coolant"},
    GcodeRow{'M', 80, GcodeUse::kIgnored, "coolant"},
    GcodeRow{'M', 90, GcodeUse::kIgnored, "coolant"},
    GcodeRow{'M', 300, GcodeUse::kEnd, "end of the program"},
};

}  // namespace rmlcell::rml1
