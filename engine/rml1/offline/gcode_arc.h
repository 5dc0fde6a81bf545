#pragma once

#include <optional>

#include "engine/core/result.h"
#include "engine/motion/geometry/frames.h"

namespace rmlcell::rml1 {

// An arc in X and Y as G2 and G3 give it, mm.
struct ArcWords {
  motion::PlanVector from{};
  motion::PlanVector to{};
  bool clockwise = false;  // G2
  std::optional<double> i;
  std::optional<double> j;
  std::optional<double> r;
};

struct Arc {
  motion::PlanVector centre{};
  double radius_mm = 0.0;
  double start_rad = 0.0;
  double sweep_rad = 0.0;  // counterclockwise is positive

  // How many chords stay within the tolerance of it: a chord of an angle a is radius * (1 - cos(a /
  // 2)) away from its arc. At least 1.
  double Chords(double tolerance_mm) const;
  motion::PlanVector At(double share) const;
};

// I and J: from the start to the centre; an end that is the start is a full turn. R: its sign tells
// the shorter arc (above 0) from the longer one.
// Error: Rml1GcodeArc (8103), without place: no radius, ends that are not as far from the centre
// (more than kRadiusError_mm and 0.1 % of the radius), an R too small for the ends or without any.
inline constexpr double kRadiusError_mm = 0.02;
Result<Arc> ArcOf(const ArcWords& words);

}  // namespace rmlcell::rml1
