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

constexpr double kFarthest_urad = 2e9;
constexpr double kUradPerRad = 1e6;

std::int32_t Microradians(double rad) {
  const double urad = std::clamp(rad * kUradPerRad, -kFarthest_urad, kFarthest_urad);
  return urad == urad ? static_cast<std::int32_t>(std::llround(urad)) : 0;
}

// At `s` of a path, whose rotary axes are linear in s.
ToolpathPoint PointOf(const motion::PathPiece& path, double s, const MachinePoint& tip) {
  return {Micrometres(tip.x()), Micrometres(tip.y()), Micrometres(tip.z()),
          Microradians(path.from().a_rad + path.a_rate() * s),
          Microradians(path.from().b_rad + path.b_rate() * s)};
}

std::int64_t Microseconds(SimTime time) {
  return time.count() / 1000 + (time.count() % 1000 >= 500 ? 1 : 0);
}

// The same step, purpose, beam, speed and power class.
bool AlikeRuns(const ToolpathRun& a, const ToolpathRun& b) {
  return a.program == b.program && a.step == b.step && a.use == b.use && a.beam_on == b.beam_on &&
         a.speed_class == b.speed_class && a.power_class == b.power_class;
}

// When the motion is at `s`, to the nanosecond, not before `since`. The profile is monotone: the
// tangent leads there in a few steps, and where it does not, halving does.
SimTime TimeAt(const machine::MotionDone& done, double s, SimTime since) {
  constexpr int kTangents = 8;
  constexpr double kNsPerS = 1e9;
  if (s >= done.travelled) return done.end;
  std::int64_t before = since.count() - 1;  // not there yet, or the start
  std::int64_t reached = done.end.count();
  std::int64_t next = before + (reached - before) / 2;
  for (int step = 0; reached - before > 1; ++step) {
    next = std::max(before + 1, std::min(next, reached - 1));
    const motion::PathState state =
        done.motion->speed.At(done.profile_start_s + ToSeconds(SimTime(next) - done.start));
    (state.s < s ? before : reached) = next;
    const double ahead_ns = (s - state.s) / state.speed * kNsPerS;
    const bool near = step < kTangents && state.speed > 0.0 &&
                      std::abs(ahead_ns) < static_cast<double>(done.end.count() - since.count());
    next = near ? next + std::llround(ahead_ns) : before + (reached - before) / 2;
  }
  return SimTime(reached);
}

double PowerPercent(const machine::MotionDone& done, double speed_mm_s) {
  if (!done.beam_on) return 0.0;
  return std::clamp(done.power.constant_percent + done.power.percent_per_mm_s * speed_mm_s, 0.0,
                    100.0);
}

}  // namespace

double ToolpathTolerance_mm(double wanted_mm) {
  return std::clamp(wanted_mm, kToolpathToleranceMin_mm, kToolpathToleranceMax_mm);
}

ToolpathRecorder::ToolpathRecorder(const machine::MachineShape& shape, ToolpathOptions options,
                                   ToolpathSink sink)
    : speed_max_mm_s_(shape.limits ? shape.limits->tip_speed_mm_s : 0.0),
      writer_(options.bytes_max, std::move(sink)) {
  const double tolerance = ToolpathTolerance_mm(options.tolerance_mm);
  merge_tolerance_mm_ = kMergeShare * tolerance;
  chord_tolerance_mm_ = tolerance - 2.0 * merge_tolerance_mm_;
}

int ToolpathRecorder::SpeedClassOf(double mm_s) const {
  if (mm_s <= 0.0) return 0;
  // Infinite, of a machine whose highest speed is not known: that is the last class.
  const double share = std::ceil(mm_s / speed_max_mm_s_ * kSpeedClasses - 1e-9);
  return static_cast<int>(std::clamp(share, 1.0, double{kSpeedClasses}));
}

void ToolpathRecorder::OnMotion(const machine::MotionDone& done) {
  PartShape shape({done.motion->path, done.motion->head, done.from, done.travelled});
  Add(done, shape);
}

void ToolpathRecorder::Add(const machine::MotionDone& done, PartShape& shape) {
  if (writer_.closed()) return;
  const motion::PathPiece& path = done.motion->path;
  const MachinePoint& first = shape.tip_from();
  const ToolpathPoint first_point = PointOf(path, done.from, first);
  // Along a way that is not that of the tip its speed is not known here.
  const double peak_mm_s = path.by_sigma() ? 0.0 : done.motion->speed.peak_speed();
  const ToolpathRun run{.program = done.place.program,
                        .step = done.place.step,
                        .use = done.use,
                        .beam_on = done.beam_on,
                        .speed_class = SpeedClassOf(done.programmed_mm_s),
                        .power_class = static_cast<int>(
                            std::ceil(PowerPercent(done, peak_mm_s) / 100.0 * kPowerClasses)),
                        .start_us = Microseconds(done.start)};
  const bool goes_on = writer_.open() && AlikeRuns(run, writer_.run()) &&
                       writer_.run().end_us == run.start_us && writer_.last() == first_point;
  if (!goes_on) {
    writer_.Open(run, first_point);
    stretch_ = {.anchor = first, .direction = {}, .last = first, .open = false};
  }
  const int reached_class = SpeedClassOf(peak_mm_s);
  SimTime at = done.start;
  writer_.Reach(reached_class);
  ForEachVertex(shape, chord_tolerance_mm_, [&](double s, const MachinePoint& tip) {
    at = TimeAt(done, s, at);
    Vertex(tip, PointOf(path, s, tip), at);
    if (writer_.open()) writer_.Reach(reached_class);
  });
  writer_.EndAt(Microseconds(done.end));
}

bool ToolpathRecorder::Merges(const MachinePoint& tip, const ToolpathPoint& point) {
  if (!stretch_.open) return false;
  // A head that turns keeps its vertices.
  const ToolpathPoint& last = writer_.last();
  if (point.a_urad != last.a_urad || point.b_urad != last.b_urad || stretch_.turns) return false;
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

void ToolpathRecorder::Vertex(const MachinePoint& tip, const ToolpathPoint& point, SimTime at) {
  if (writer_.closed()) return;
  const std::int64_t at_us = Microseconds(at);
  if (writer_.run().point_count > 1) {
    if (Merges(tip, point)) {  // it takes the place of the last vertex
      writer_.MoveLast(point, at_us);
      stretch_.last = tip;
      return;
    }
    if (point == writer_.last()) return writer_.MoveLast(point, at_us);  // within a micrometre
  }
  const bool turns = point.a_urad != writer_.last().a_urad || point.b_urad != writer_.last().b_urad;
  if (writer_.Add(point, at_us)) {
    stretch_ = {.anchor = tip, .direction = {}, .last = tip, .open = false};
  } else {
    stretch_ = {
        .anchor = stretch_.last, .direction = {}, .last = tip, .open = true, .turns = turns};
  }
}

void ToolpathRecorder::Finish() { writer_.Finish(); }

}  // namespace rmlcell::simulation
