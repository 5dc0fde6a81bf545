#include "engine/simulation/path/polyline.h"

#include <algorithm>
#include <cmath>

#include "engine/core/units.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

// Halvings of a part before a chord is taken as it is: 1/65536 of a swing is far below any
// tolerance.
constexpr int kHalvingsMax = 16;
// The first guess: a curve that turns to and fro within less cannot be told from its middle points.
constexpr double kFirstChord_rad = 0.5;

double DistanceToSegment(const MachinePoint& point, const MachineVector& a,
                         const MachineVector& b) {
  const MachineVector along = b - a;
  const double squared = along.dot(along);
  const double share = squared > 0.0 ? std::clamp((point - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (point - (a + along * share)).norm();
}

}  // namespace

int ChordCount(double radius_mm, double sweep_rad, double tolerance_mm) {
  // acos(1 - x) = 2 asin(sqrt(x / 2)), which keeps its digits when x is small.
  const double share = std::min(0.5, 0.5 * tolerance_mm / radius_mm);
  const double chord_rad = 4.0 * std::asin(std::sqrt(share));
  const double wanted = std::ceil(sweep_rad / chord_rad - 1e-9);
  return static_cast<int>(std::clamp(wanted, 1.0, double{kChordsMax}));
}

double CurveCutter::NextCut(double p) const {
  const double whole = curve_.end() - curve_.begin();
  double step = whole;
  if (curve_.turning_rad() > kFirstChord_rad) step *= kFirstChord_rad / curve_.turning_rad();
  const double shortest = whole / (1 << kHalvingsMax);
  const MachinePoint from = curve_.Tip(p);
  for (;; step *= 0.5) {
    const double end = p + step >= curve_.end() - 0.5 * shortest ? curve_.end() : p + step;
    if (step <= shortest) return end;
    const MachinePoint to = curve_.Tip(end);
    const auto off = [&](double share) {
      return DistanceToSegment(curve_.Tip(p + (end - p) * share), from, to);
    };
    // Three points tell a bow from an S; a quarter more for what lies between them.
    if (1.25 * std::max({off(0.25), off(0.5), off(0.75)}) <= tolerance_mm_) return end;
  }
}

}  // namespace rmlcell::simulation
