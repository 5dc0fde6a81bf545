#include "engine/simulation/toolpath/toolpath_recorder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/simulation/path/polyline.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

// Of the tolerance, what merging may take: dropped vertices lie at most twice this off the result.
constexpr double kMergeShare = 0.025;

// A point that no machine reaches must not overflow: two kilometres.
constexpr double kFarthest_um = 2e9;
constexpr double kUmPerMm = 1000.0;

std::int32_t Micrometres(double mm) {
  const double um = std::clamp(mm * kUmPerMm, -kFarthest_um, kFarthest_um);  // NaN stays NaN
  return um == um ? static_cast<std::int32_t>(std::llround(um)) : 0;
}

ToolpathPoint PointOf(const MachinePoint& tip) {
  return {Micrometres(tip.x()), Micrometres(tip.y()), Micrometres(tip.z())};
}

std::int64_t Microseconds(SimTime time) {
  return time.count() / 1000 + (time.count() % 1000 >= 500 ? 1 : 0);
}

// The same step, purpose, beam and speed class.
bool AlikeRuns(const ToolpathRun& a, const ToolpathRun& b) {
  return a.program == b.program && a.step == b.step && a.use == b.use && a.beam_on == b.beam_on &&
         a.speed_class == b.speed_class;
}

// When the motion is at `s`: the profile is monotone, so halving finds the nanosecond.
SimTime TimeAt(const machine::MotionDone& done, double s) {
  if (s >= done.travelled) return done.end;
  const auto place_at = [&](std::int64_t ns) {
    return done.motion->speed.At(done.profile_start_s + ToSeconds(SimTime(ns) - done.start)).s;
  };
  std::int64_t before = done.start.count() - 1;  // not there yet, or the start
  std::int64_t reached = done.end.count();
  while (reached - before > 1) {
    const std::int64_t middle = before + (reached - before) / 2;
    (place_at(middle) < s ? before : reached) = middle;
  }
  return SimTime(reached);
}

}  // namespace

ToolpathRecorder::ToolpathRecorder(const machine::MachineShape& shape, ToolpathOptions options,
                                   ToolpathSink sink)
    : speed_max_mm_s_(shape.limits ? shape.limits->tip_speed_mm_s : 0.0),
      writer_(options.bytes_max, std::move(sink)) {
  const double tolerance =
      std::clamp(options.tolerance_mm, kToolpathToleranceMin_mm, kToolpathToleranceMax_mm);
  merge_tolerance_mm_ = kMergeShare * tolerance;
  chord_tolerance_mm_ = tolerance - 2.0 * merge_tolerance_mm_;
}

int ToolpathRecorder::SpeedClassOf(const machine::MotionDone& done) const {
  if (done.programmed_mm_s <= 0.0) return 0;
  if (speed_max_mm_s_ <= 0.0) return kSpeedClasses;
  const double share = std::ceil(done.programmed_mm_s / speed_max_mm_s_ * kSpeedClasses - 1e-9);
  return static_cast<int>(std::clamp(share, 1.0, double{kSpeedClasses}));
}

void ToolpathRecorder::OnMotion(const machine::MotionDone& done) {
  if (writer_.closed()) return;
  const motion::PathPiece& path = done.motion->path;
  const motion::Head& head = done.motion->head;
  const MachineVector first = TipAt(path, head, done.from);
  const ToolpathRun run{.program = done.place.program,
                        .step = done.place.step,
                        .use = done.use,
                        .beam_on = done.beam_on,
                        .speed_class = SpeedClassOf(done),
                        .start_us = Microseconds(done.start)};
  const bool goes_on = writer_.open() && AlikeRuns(run, writer_.run()) &&
                       writer_.run().end_us == run.start_us && writer_.last() == PointOf(first);
  if (!goes_on) {
    writer_.Open(run, PointOf(first));
    stretch_ = {.anchor = first, .direction = {}, .last = first, .open = false};
  }
  ForEachVertex({path, head, done.from, done.travelled}, chord_tolerance_mm_,
                [&](double s, const MachinePoint& tip) {
                  // Only the end of a block needs the time of a vertex on the way.
                  Vertex(tip, writer_.full_with_next() ? TimeAt(done, s) : done.end);
                });
  writer_.EndAt(Microseconds(done.end));
}

bool ToolpathRecorder::Merges(const MachinePoint& tip) {
  if (!stretch_.open) return false;
  if (stretch_.direction.dot(stretch_.direction) == 0.0) {
    const MachineVector along = stretch_.last - stretch_.anchor;
    const double length = along.norm();
    if (length <= merge_tolerance_mm_) return false;  // too short to give a direction
    stretch_.direction = along * (1.0 / length);
  }
  const MachineVector off = tip - stretch_.anchor;
  const double forward = off.dot(stretch_.direction);
  if (forward <= (stretch_.last - stretch_.anchor).dot(stretch_.direction)) return false;
  return (off - stretch_.direction * forward).norm() <= merge_tolerance_mm_;
}

void ToolpathRecorder::Vertex(const MachinePoint& tip, SimTime at) {
  if (writer_.closed()) return;
  const ToolpathPoint point = PointOf(tip);
  if (writer_.run().point_count > 1) {
    if (Merges(tip)) {  // it takes the place of the last vertex
      writer_.MoveLast(point);
      stretch_.last = tip;
      return;
    }
    if (point == writer_.last()) return;  // within a micrometre of it
  }
  if (writer_.Add(point, Microseconds(at))) {
    stretch_ = {.anchor = tip, .direction = {}, .last = tip, .open = false};
  } else {
    stretch_ = {.anchor = stretch_.last, .direction = {}, .last = tip, .open = true};
  }
}

void ToolpathRecorder::Finish() { writer_.Finish(); }

}  // namespace rmlcell::simulation
