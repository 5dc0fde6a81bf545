#include "engine/rml1/offline/gcode_arc.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/rml1/offline/phrase_words.h"

namespace rmlcell::rml1 {
namespace {

using motion::LengthOf, motion::PlanVector;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kSamePlace_mm = 1e-6;  // noise of decimals and of inches

Error NoArc(const Detail& detail) { return {ErrorCode::kRml1GcodeArc, detail, {}}; }

// The centre of an arc with R: on the line across the middle of the ends.
Result<Arc> CentreByRadius(const ArcWords& words) {
  const PlanVector chord = words.to - words.from;
  const double distance = LengthOf(chord);
  if (distance <= kSamePlace_mm) return NoArc("R with an end that is the start: give I and J");
  const double radius = std::abs(*words.r);
  const double half = distance / 2.0;
  if (radius < half - kRadiusError_mm) {
    return NoArc("R is " + ToldShort("radius", *words.r, "mm") + " mm, the ends are " +
                 ToldShort("distance", distance, "mm") + " mm apart");
  }
  const double height = std::sqrt(std::max(0.0, radius * radius - half * half));
  const bool to_the_left = words.clockwise == (*words.r < 0.0);
  const double side = to_the_left ? height : -height;
  Arc arc;
  const PlanVector left(-chord.y(), chord.x());
  arc.centre = words.from + chord / 2.0 + side * left / distance;
  return arc;
}

}  // namespace

double Arc::Chords(double tolerance_mm) const {
  const double share = std::min(1.0, tolerance_mm / radius_mm);
  const double angle = 2.0 * std::acos(1.0 - share);
  return std::max(1.0, std::ceil(std::abs(sweep_rad) / angle - 1e-9));
}

PlanVector Arc::At(double share) const {
  const double angle = start_rad + sweep_rad * share;
  return centre + radius_mm * PlanVector(std::cos(angle), std::sin(angle));
}

Result<Arc> ArcOf(const ArcWords& words) {
  if (words.r && (words.i || words.j)) return NoArc("both R and a centre");
  if (!words.r && !words.i && !words.j) return NoArc("neither R nor a centre");
  Arc arc;
  if (words.r) {
    const Result<Arc> made = CentreByRadius(words);
    if (!made) return made.error();
    arc = *made;
  } else {
    arc.centre = words.from + PlanVector(words.i.value_or(0.0), words.j.value_or(0.0));
  }
  const PlanVector from = words.from - arc.centre;
  const PlanVector to = words.to - arc.centre;
  arc.radius_mm = LengthOf(from);
  if (!(arc.radius_mm > kSamePlace_mm)) return NoArc("the centre is the start");
  const double other = LengthOf(to);
  const double error = std::abs(other - arc.radius_mm);
  if (error > kRadiusError_mm && error > 1e-3 * arc.radius_mm) {
    return NoArc("the start is " + ToldShort("first", arc.radius_mm, "mm") +
                 " mm from the centre, the end " + ToldShort("second", other, "mm") + " mm");
  }
  arc.start_rad = std::atan2(from.y(), from.x());
  arc.sweep_rad = std::atan2(to.y(), to.x()) - arc.start_rad;
  const bool full = LengthOf(words.to - words.from) <= kSamePlace_mm;
  if (full) arc.sweep_rad = 0.0;
  if (words.clockwise && arc.sweep_rad >= 0.0) arc.sweep_rad -= kTurn_rad;
  if (!words.clockwise && arc.sweep_rad <= 0.0) arc.sweep_rad += kTurn_rad;
  return arc;
}

}  // namespace rmlcell::rml1
