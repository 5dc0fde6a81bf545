#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "engine/rml1/offline/gcode_findings.h"
#include "engine/rml1/offline/gcode_reader.h"
#include "engine/rml1/offline/gcode_words.h"

namespace rmlcell::rml1 {

// Letters of the axes of arcs and of the way from the start to their centre, the first two in the
// sense in which G3 turns, and the axis that rises.
struct ArcPlane {
  std::array<char, 3> axes{'X', 'Y', 'Z'};
  std::array<char, 2> centre{'I', 'J'};

  bool operator==(const ArcPlane&) const = default;
};

// One line, its words by what they say. What it points to is of its block.
struct Orders {
  std::optional<GcodeUse> motion;  // a motion word of this line
  bool dwell = false;
  bool home = false;
  bool spindle_on = false;
  bool spindle_off = false;
  bool pause = false;
  bool end = false;
  std::optional<double> unit_mm;  // G20 G21
  std::optional<bool> relative;   // G90 G91
  std::optional<ArcPlane> plane;  // G17 G18 G19
  std::optional<double> tool;     // T
  const GcodeWord* tool_change = nullptr;
  std::map<char, const GcodeWord*> values;  // X Y Z I J K R F S P H

  const GcodeWord* Find(char letter) const {
    const auto found = values.find(letter);
    return found == values.end() ? nullptr : found->second;
  }
  const GcodeWord* AxisWord() const;
  bool moves_or_waits() const { return motion || dwell || home; }
};

// Nothing: the line is refused, and the findings say why. Words that say nothing to a mill are
// noted there.
std::optional<Orders> OrdersOf(const GcodeBlock& block, GcodeFindings& findings);

// "G91.1"
Detail WordText(const GcodeWord& word);

}  // namespace rmlcell::rml1
