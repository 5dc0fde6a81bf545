#include "engine/simulation/toolpath_recorder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/check.h"
#include "engine/simulation/polyline.h"

namespace rmlcell::simulation {
namespace {

using motion::Vec3;

// Of the tolerance, what merging may take: dropped vertices lie at most twice this off the result.
constexpr double kMergeShare = 0.025;

// A point that no machine reaches must not overflow: two kilometres.
constexpr double kFarthest_um = 2e9;
constexpr double kUmPerMm = 1000.0;

std::int32_t Micrometres(double mm) {
  const double um = std::clamp(mm * kUmPerMm, -kFarthest_um, kFarthest_um);  // NaN stays NaN
  return um == um ? static_cast<std::int32_t>(std::llround(um)) : 0;
}

ToolpathPoint PointOf(const Vec3& tip) {
  return {Micrometres(tip.x), Micrometres(tip.y), Micrometres(tip.z)};
}

std::int64_t Microseconds(SimTime time) {
  return time.count() / 1000 + (time.count() % 1000 >= 500 ? 1 : 0);
}

// When the motion is at `s`: the profile is monotone, so halving finds it.
SimTime TimeAt(const machine::MotionDone& done, double s) {
  if (s >= done.travelled) return done.end;
  double low = done.profile_start_s;
  double high = done.motion->speed.duration_s();
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (done.motion->speed.At(middle).s < s ? low : high) = middle;
  }
  return std::min(done.end, done.start + FromSeconds(high - done.profile_start_s));
}

}  // namespace

ToolpathRecorder::ToolpathRecorder(const machine::MachineShape& shape, ToolpathOptions options,
                                   ToolpathSink sink)
    : speed_max_mm_s_(shape.limits ? shape.limits->tip_speed_mm_s : 0.0),
      bytes_max_(options.bytes_max),
      sink_(std::move(sink)) {
  RMLCELL_CHECK(sink_);
  const double tolerance =
      std::clamp(options.tolerance_mm, kToolpathToleranceMin_mm, kToolpathToleranceMax_mm);
  merge_tolerance_mm_ = kMergeShare * tolerance;
  chord_tolerance_mm_ = tolerance - 2.0 * merge_tolerance_mm_;
  block_.points.reserve(kToolpathBlockPoints);
}

int ToolpathRecorder::SpeedClassOf(const machine::MotionDone& done) const {
  if (done.programmed_mm_s <= 0.0) return 0;
  if (speed_max_mm_s_ <= 0.0) return kSpeedClasses;
  const double share = std::ceil(done.programmed_mm_s / speed_max_mm_s_ * kSpeedClasses - 1e-9);
  return static_cast<int>(std::clamp(share, 1.0, double{kSpeedClasses}));
}

void ToolpathRecorder::OnMotion(const machine::MotionDone& done) {
  if (closed_) return;
  const motion::PathPiece& path = done.motion->path;
  const motion::Head& head = done.motion->head;
  const Vec3 first = TipAt(path, head, done.from);
  const Key key{.program = done.place.program,
                .step = done.place.step,
                .use = done.use,
                .beam_on = done.beam_on,
                .speed_class = SpeedClassOf(done)};
  const std::int64_t start_us = Microseconds(done.start);
  const bool goes_on = run_open_ && key == key_ && block_.runs.back().end_us == start_us &&
                       PointOf(first) == block_.points.back();
  if (!goes_on) OpenRun(key, first, start_us);
  ForEachVertex({path, head, done.from, done.travelled}, chord_tolerance_mm_,
                [&](double s, const Vec3& tip) {
                  // Only the end of a block needs the time of a vertex on the way.
                  const bool full = block_.points.size() + 1 >= kToolpathBlockPoints;
                  Vertex(tip, full ? TimeAt(done, s) : done.end);
                });
  if (run_open_) block_.runs.back().end_us = Microseconds(done.end);
}

// A run that was opened where a block began, and then went nowhere: takes it back, with its point
// unless that is the last one of the run before.
void ToolpathRecorder::DropEmptyRun() {
  if (block_.runs.empty() || block_.runs.back().point_count > 1) return;
  const std::uint32_t point = block_.runs.back().first_point;
  block_.runs.pop_back();
  const bool shared = !block_.runs.empty() &&
                      block_.runs.back().first_point + block_.runs.back().point_count > point;
  if (!shared) block_.points.pop_back();
}

void ToolpathRecorder::OpenRun(const Key& key, const Vec3& first, std::int64_t start_us) {
  DropEmptyRun();
  // A run needs two points: its first one and one more.
  if (block_.points.size() + 2 > kToolpathBlockPoints) Flush();
  const ToolpathPoint point = PointOf(first);
  const bool joined = !block_.points.empty() && block_.points.back() == point;
  if (!joined) {
    block_.points.push_back(point);
    ++points_;
  }
  ToolpathRun run{.program = key.program,
                  .step = key.step,
                  .use = key.use,
                  .beam_on = key.beam_on,
                  .speed_class = key.speed_class,
                  .start_us = start_us,
                  .end_us = start_us};
  run.first_point = static_cast<std::uint32_t>(block_.points.size() - 1);
  run.point_count = 1;
  block_.runs.push_back(run);
  key_ = key;
  run_open_ = true;
  stretch_ = {.anchor = first, .direction = {}, .last = first, .open = false};
}

bool ToolpathRecorder::Merges(const Vec3& tip) {
  if (!stretch_.open) return false;
  if (Dot(stretch_.direction, stretch_.direction) == 0.0) {
    const Vec3 along = stretch_.last - stretch_.anchor;
    const double length = Norm(along);
    if (length <= merge_tolerance_mm_) return false;  // too short to give a direction
    stretch_.direction = along * (1.0 / length);
  }
  const Vec3 off = tip - stretch_.anchor;
  const double forward = Dot(off, stretch_.direction);
  if (forward <= Dot(stretch_.last - stretch_.anchor, stretch_.direction)) return false;
  return Norm(off - stretch_.direction * forward) <= merge_tolerance_mm_;
}

void ToolpathRecorder::Vertex(const Vec3& tip, SimTime at) {
  if (closed_) return;
  ToolpathRun& run = block_.runs.back();
  const ToolpathPoint point = PointOf(tip);
  if (run.point_count > 1) {
    if (Merges(tip)) {  // it takes the place of the last vertex
      block_.points.back() = point;
      stretch_.last = tip;
      return;
    }
    if (point == block_.points.back()) return;  // within a micrometre of it
  }
  block_.points.push_back(point);
  ++points_;
  ++run.point_count;
  stretch_ = {.anchor = stretch_.last, .direction = {}, .last = tip, .open = true};
  if (block_.points.size() < kToolpathBlockPoints) return;

  // The block is full in the middle of a run: the run goes on in the next block.
  run.end_us = Microseconds(at);
  const std::int64_t end_us = run.end_us;
  Flush();
  if (!closed_) OpenRun(key_, tip, end_us);
}

void ToolpathRecorder::Flush() {
  run_open_ = false;
  DropEmptyRun();
  if (!block_.runs.empty()) {
    const std::string bytes = EncodeToolpathBlock(block_);
    if (bytes_ + bytes.size() > bytes_max_ || !sink_(bytes)) {
      closed_ = true;
    } else {
      bytes_ += bytes.size();
      ++blocks_;
    }
  }
  block_.points.clear();
  block_.runs.clear();
}

void ToolpathRecorder::Finish() {
  if (closed_) return;
  Flush();
}

}  // namespace rmlcell::simulation
