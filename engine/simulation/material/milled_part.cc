#include "engine/simulation/material/milled_part.h"

#include <algorithm>

namespace rmlcell::simulation {

MilledPart::MilledPart(const Milling& milling)
    : origin_(motion::MachineVector{}),
      at_(motion::MachineVector{}),
      tool_(milling.tool),
      material_(HeightField::Of(milling.stock).value()) {}

void MilledPart::BeginAt(const motion::MachinePoint& work_origin, const motion::MachinePoint& at) {
  origin_ = work_origin;
  at_ = at;
}

void MilledPart::Cut(const motion::MachinePoint& from, const motion::MachinePoint& to) {
  material_.Cut(tool_, from - origin_, to - origin_);
  at_ = to;
}

void MilledPart::OnMotion(const machine::MotionDone& done) {
  const motion::PathPiece& path = done.motion->path;
  if (path.kind() != motion::PathPiece::Kind::kLine) return;  // the rotary axis alone
  Cut(path.At(done.from).point, path.At(done.travelled).point);
}

double MilledPart::DepthOf(const motion::MachinePoint& from, const motion::MachinePoint& to) const {
  const motion::MachinePoint begin = from - origin_;
  const motion::MachinePoint end = to - origin_;
  const double depth =
      std::max(material_.DepthOf(tool_, begin, end), material_.ShankDepthOf(tool_, begin, end));
  return depth > kGougeLeast_mm ? depth : 0.0;
}

}  // namespace rmlcell::simulation
