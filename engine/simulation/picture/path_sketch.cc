#include "engine/simulation/picture/path_sketch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/simulation/path/polyline.h"

namespace rmlcell::simulation {
namespace {

using motion::MachinePoint;
using motion::MachineVector;

// More dots than this run together in any picture.
constexpr std::size_t kDotsMax = 20'000;
// Tool directions kept; a picture shows some of them.
constexpr std::size_t kToolsMax = 4096;
// Curves that are neither line nor arc, as chords: below a pixel on the largest screen for parts up
// to 40 m.
constexpr double kCurveTolerance_mm = 0.01;
// The first tolerance, as a share of the size: a tenth of a pixel of a large picture.
constexpr double kFirstShare = 5e-5;
constexpr double kCoarserSketch = 2.0;

// Lines of what was lost: enough to see where it lies.
constexpr std::size_t kLostMax = 4'000;

// Makes what lies in `box` coarser, until it has at most `elements_max` elements.
void ThinTo(std::size_t elements_max, const machine::Box& box, std::vector<SketchElement>& elements,
            double& tolerance_mm) {
  tolerance_mm = std::max({box.diagonal_mm() * kFirstShare, 1e-9, tolerance_mm});
  // With a tolerance of the whole size everything is alike: this ends.
  for (;; tolerance_mm *= kCoarserSketch) {
    MergeStraight(elements, tolerance_mm);
    DropAlike(elements, tolerance_mm);
    if (elements.size() <= elements_max) return;
  }
}

bool IsFinite(const MachinePoint& p) {
  return std::isfinite(p.x()) && std::isfinite(p.y()) && std::isfinite(p.z());
}

}  // namespace

PathSketch::PathSketch(const machine::MachineShape& shape, std::size_t elements_max)
    : shape_(shape), elements_max_(elements_max) {
  // What is not used of it is no memory yet, and a list that grows is there twice while it does.
  elements_.reserve(elements_max + 1);
}

void PathSketch::Add(const machine::MotionDone& done) {
  PartShape shape({done.motion->path, done.motion->head, done.from, done.travelled});
  Add(done, shape);
}

void PathSketch::Add(const machine::MotionDone& done, PartShape& shape) {
  const motion::PathPiece& path = done.motion->path;
  const PathPart& part = shape.part();
  const MachinePoint from = shape.tip_from();
  const MachinePoint to = shape.tip_to();
  if (!IsFinite(from) || !IsFinite(to)) return;
  if (!moved_) start_ = from;
  moved_ = true;
  end_ = to;

  const bool tool_in = shape_.laser_watts <= 0.0 && (done.use == machine::MotionUse::kCut ||
                                                     done.use == machine::MotionUse::kPlunge);
  SketchElement element{.from = from,
                        .to = to,
                        .use = done.use,
                        .cuts = done.beam_on || tool_in,
                        .skims = tool_in && !done.in_work};
  skims_ = skims_ || element.skims;
  cuts_ = cuts_ || (element.cuts && !element.skims);
  const machine::Box box = BoxOf(shape.tip());
  box_.Add(box);
  if (element.cuts) cut_box_.Add(box);
  if (done.use == machine::MotionUse::kPlunge && done.in_work) {
    if (!plunging_) AddDot({.at = to});
    plunging_ = true;
  } else {
    plunging_ = false;
  }
  if (element.cuts && shape_.five_axis) AddTool(done);

  if (path.kind() == motion::PathPiece::Kind::kArc) {
    element.arc = static_cast<std::int32_t>(circles_.size());
    element.middle = path.At(0.5 * (part.from + part.to)).point;
    circles_.push_back({.centre = path.centre(),
                        .normal = path.normal(),
                        .radius_mm = path.radius_mm(),
                        .sweep_rad = (part.to - part.from) / path.radius_mm()});
    Push(element);
  } else {
    PushCurve(shape, element);
  }
}

void PathSketch::PushCurve(PartShape& shape, SketchElement element) {
  ForEachVertex(shape, kCurveTolerance_mm, [&](double /*s*/, const MachinePoint& tip) {
    element.to = tip;
    if (element.from != element.to) Push(element);
    element.from = tip;
  });
}

void PathSketch::Push(const SketchElement& element) {
  elements_.push_back(element);
  if (elements_.size() > elements_max_) Coarsen();
}

void PathSketch::AddDot(const SketchDot& dot) {
  if (dots_.size() < kDotsMax) dots_.push_back(dot);
}

void PathSketch::AddPierce() { AddDot({.at = end_, .pierce = true}); }

// It counts for no other figure: the tip was never there.
void PathSketch::AddLost(const machine::LostWay& way) {
  if (!IsFinite(way.from) || !IsFinite(way.to)) return;
  lost_mm_ += (way.to - way.from).norm();
  lost_box_.Add(way.from);
  lost_box_.Add(way.to);
  if (lost_.empty()) lost_.reserve(kLostMax + 1);
  lost_.push_back({.from = way.from, .to = way.to, .lost = true});
  if (lost_.size() > kLostMax) ThinTo(kLostMax / 2, lost_box_, lost_, lost_tolerance_mm_);
}

void PathSketch::AddTool(const machine::MotionDone& done) {
  if (tool_count_++ % tool_stride_ != 0) return;
  const motion::PathPiece& path = done.motion->path;
  const motion::PathPose pose = path.At(done.travelled);
  tools_.push_back({TipAt(path, done.motion->head, done.travelled),
                    motion::ToolDirection(pose.a_rad, pose.b_rad)});
  if (tools_.size() < kToolsMax) return;
  for (std::size_t i = 0; 2 * i < tools_.size(); ++i) tools_[i] = tools_[2 * i];
  tools_.resize((tools_.size() + 1) / 2);
  tool_stride_ *= 2;
}

void PathSketch::Coarsen() {
  ThinTo(elements_max_ / 2, box_, elements_, tolerance_mm_);
  PackCircles();
}

void PathSketch::PackCircles() {
  std::vector<SketchCircle> kept;
  for (SketchElement& element : elements_) {
    if (element.arc < 0) continue;
    kept.push_back(circle(element.arc));
    element.arc = static_cast<std::int32_t>(kept.size() - 1);
  }
  circles_ = std::move(kept);
}

}  // namespace rmlcell::simulation
