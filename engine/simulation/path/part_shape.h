#pragma once

#include <optional>

#include "engine/simulation/path/axis_pieces.h"
#include "engine/simulation/path/curve_cutter.h"
#include "engine/simulation/path/path_extent.h"

namespace rmlcell::simulation {

// A part of a path, and what several of those who are told of a motion want of it: each is worked
// out when it is first asked for, and once. The path must outlive this, and the measure, which is
// used for no other part meanwhile.
class PartShape {
 public:
  explicit PartShape(const PathPart& part) : part_(part) {}
  PartShape(const PathPart& part, CurveMeasure& measure) : part_(part), measure_(&measure) {}
  PartShape(const PartShape&) = delete;  // its curve looks into it
  PartShape& operator=(const PartShape&) = delete;

  const PathPart& part() const { return part_; }

  const PartCurve& curve() {
    if (!curve_) curve_.emplace(part_, measure_ != nullptr ? *measure_ : own_measure_.emplace());
    return *curve_;
  }
  // The tip at both ends.
  const motion::MachinePoint& tip_from() {
    if (!tip_from_) tip_from_ = TipAt(part_.path, part_.head, part_.from);
    return *tip_from_;
  }
  const motion::MachinePoint& tip_to() {
    if (!tip_to_) tip_to_ = TipAt(part_.path, part_.head, part_.to);
    return *tip_to_;
  }
  ChordList& chords() { return chords_ ? *chords_ : chords_.emplace(); }
  bool turns() {
    if (!turns_) turns_ = Turns(part_.path);
    return *turns_;
  }
  // The tip along it.
  const PointSweep& tip() {
    if (!tip_) tip_ = TipSweep(*this);
    return *tip_;
  }
  // Null where AxisPieces are not for it.
  const AxisPieces* pieces() {
    if (!pieces_sought_ && AxisPieces::AreFor(part_.path))
      pieces_.emplace(curve(), AxisPieces::kFew);
    pieces_sought_ = true;
    return pieces_ ? &*pieces_ : nullptr;
  }

 private:
  PathPart part_;
  CurveMeasure* measure_ = nullptr;  // null: it has its own
  std::optional<CurveMeasure> own_measure_;
  std::optional<PartCurve> curve_;
  std::optional<ChordList> chords_;
  std::optional<bool> turns_;
  std::optional<motion::MachinePoint> tip_from_;
  std::optional<motion::MachinePoint> tip_to_;
  std::optional<PointSweep> tip_;
  std::optional<AxisPieces> pieces_;
  bool pieces_sought_ = false;
};

}  // namespace rmlcell::simulation
