#include "engine/simulation/toolpath/toolpath_level.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rmlcell::simulation {
namespace {

using motion::MachineVector;

constexpr double kUmPerMillimetre = 1000.0;

MachineVector Way(const ToolpathPoint& from, const ToolpathPoint& to) {
  return {static_cast<double>(to.x_um) - from.x_um, static_cast<double>(to.y_um) - from.y_um,
          static_cast<double>(to.z_um) - from.z_um};
}

// Of two unit vectors; precise for small ones, too.
double AngleBetween(const MachineVector& a, const MachineVector& b) {
  return 2.0 * std::atan2((a - b).norm(), (a + b).norm());
}

bool JoinsTo(const ToolpathRun& before, const ToolpathRun& run) {
  return before.program == run.program && before.use == run.use && before.beam_on == run.beam_on &&
         before.speed_class == run.speed_class && before.power_class == run.power_class &&
         before.end_us == run.start_us;
}

}  // namespace

double LevelTolerance(double stored_mm, int level) {
  return stored_mm * std::pow(kToolpathLevelFactor, level);
}

ToolpathLevel::ToolpathLevel(double tolerance_mm, ToolpathSink sink)
    : tolerance_um_(tolerance_mm * kUmPerMillimetre),
      writer_(std::numeric_limits<std::uint64_t>::max(), std::move(sink)) {}

void ToolpathLevel::Take(const ToolpathBlock& block) {
  for (const ToolpathRun& run : block.runs) {
    if (writer_.closed()) return;
    Follow(run, block);
  }
}

void ToolpathLevel::Finish() {
  Close();
  writer_.Finish();
}

void ToolpathLevel::Follow(const ToolpathRun& run, const ToolpathBlock& block) {
  const ToolpathPoint* points = &block.points[run.first_point];
  if (!open_ || !JoinsTo(run_, run) || !(last_.point == points[0])) {
    Close();
    writer_.Open(run, points[0]);
    anchor_ = points[0];
    moved_ = false;
    half_angle_rad_ = -1.0;
    farthest_um_ = 0.0;
    open_ = true;
  }
  run_ = run;
  if (!writer_.closed()) writer_.Reach(run.reached_class);
  for (std::uint32_t k = 1; k < run.point_count; ++k) {
    Add({points[k], TimeOf(block, run, k)});
    // A block that is full goes on in the next one with the run as it was opened.
    if (!writer_.closed() && writer_.open()) writer_.Reach(run.reached_class);
  }
  last_.at_us = run.end_us;
}

// A line from the anchor to the end of `way` passes everything left out, and does not end short of
// it.
bool ToolpathLevel::Reaches(const MachineVector& way) const {
  const double distance = way.norm();
  if (distance < farthest_um_) return false;
  if (half_angle_rad_ < 0.0) return true;
  return AngleBetween(axis_, way * (1.0 / distance)) <= half_angle_rad_;
}

// The end of `way` is left out, too: lines have to pass it within the tolerance. Of what two cones
// share the largest cone is taken, so that the cost of a point is the same for ever.
void ToolpathLevel::Narrow(const MachineVector& way) {
  const double distance = way.norm();
  if (distance <= tolerance_um_) return;  // the anchor is near enough
  farthest_um_ = std::max(farthest_um_, distance);
  const MachineVector direction = way * (1.0 / distance);
  const double half = std::asin(tolerance_um_ / distance);
  if (half_angle_rad_ < 0.0) {
    axis_ = direction;
    half_angle_rad_ = half;
    return;
  }
  const double between = AngleBetween(axis_, direction);
  if (between + half <= half_angle_rad_) {
    axis_ = direction;
    half_angle_rad_ = half;
  } else if (between + half_angle_rad_ > half) {
    const double shared = 0.5 * (half_angle_rad_ + half - between);
    const double turn = half_angle_rad_ - shared;  // of the axis, towards `direction`
    const MachineVector across = direction - axis_ * axis_.dot(direction);
    const double sideways = across.norm();
    if (sideways > 0.0) axis_ = axis_ * std::cos(turn) + across * (std::sin(turn) / sideways);
    half_angle_rad_ = std::max(0.0, shared);
  }
}

void ToolpathLevel::Add(const Vertex& next) {
  const MachineVector way = Way(anchor_, next.point);
  if (moved_) {
    Narrow(Way(anchor_, last_.point));
    if (!Reaches(way)) Keep();
  }
  last_ = next;
  moved_ = !(next.point == anchor_);
}

// A run that stays within the tolerance, such as a small hole, is seen as a point: two alike.
void ToolpathLevel::Close() {
  if (!open_ || writer_.closed()) return;
  moved_ = moved_ || writer_.run().point_count < 2;
  Keep();
}

// The last point of the way becomes a point of the polyline, and what follows is seen from there.
void ToolpathLevel::Keep() {
  if (moved_ && !writer_.closed()) writer_.Add(last_.point, last_.at_us);
  writer_.EndAt(last_.at_us);
  anchor_ = last_.point;
  moved_ = false;
  half_angle_rad_ = -1.0;
  farthest_um_ = 0.0;
}

}  // namespace rmlcell::simulation
