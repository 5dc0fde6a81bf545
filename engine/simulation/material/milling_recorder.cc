#include "engine/simulation/material/milling_recorder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rmlcell::simulation {
namespace {

using machine::MotionUse;

// The part of a straight move that keeps within limits, by shares of its way.
struct PartOfMove {
  double low = 0.0;
  double high = 1.0;
  void KeepBelow(double at_start, double change, double limit) {
    if (at_start > limit && !(change < 0.0)) high = -1.0;
    if (change > 0.0) high = std::min(high, (limit - at_start) / change);
    if (change < 0.0) low = std::max(low, (limit - at_start) / change);
  }
  // Over the block and no further than `beyond_mm` beside it.
  void KeepOver(const Stock& block, double beyond_mm, const motion::MachinePoint& from,
                const motion::MachineVector& way) {
    KeepBelow(from.x(), way.x(), block.x_max + beyond_mm);
    KeepBelow(-from.x(), -way.x(), beyond_mm - block.x_min);
    KeepBelow(from.y(), way.y(), block.y_max + beyond_mm);
    KeepBelow(-from.y(), -way.y(), beyond_mm - block.y_min);
  }
  double length() const { return std::max(0.0, high - low); }
};

}  // namespace

Status CheckMilling(const Milling& milling) {
  if (const Status sound = CheckTool(milling.tool); !sound) return sound.error();
  if (const Status sound = CheckStock(milling.stock); !sound) return sound.error();
  if (milling.chips && milling.tool.flutes == 0)
    return InvalidArgument("what an edge takes off needs the edges of the tool: flutes=2");
  if (!(milling.rpm >= 0.0) || !std::isfinite(milling.rpm))
    return InvalidArgument("a spindle speed is not below 0 rpm");
  if (!milling.target) return {};
  if (!(milling.target->tolerance_mm >= 0.0) || !std::isfinite(milling.target->tolerance_mm))
    return InvalidArgument("the tolerance of a target is not below 0 mm");
  const HeightField::Size size = HeightField::SizeOf(milling.stock);
  if (milling.target->heights->size() != size.columns * size.rows)
    return InvalidArgument("the target has other cells than the block");
  return {};
}

MillingRecorder::MillingRecorder(const machine::MachineShape& shape, const Milling& milling,
                                 ParallelFor* parallel)
    : origin_(shape.has_work_origin ? shape.work_origin : motion::MachineVector{}),
      tool_(milling.tool),
      material_(HeightField::Of(milling.stock).value()),
      parallel_(parallel != nullptr && parallel->width() > 1 ? parallel : nullptr),
      batch_(material_, tool_),
      target_(milling.target),
      chips_(milling.chips),
      fast_z_mm_s_(shape.limits ? machine::kTravelShareOfZ * shape.limits->axes.speed.z()
                                : std::numeric_limits<double>::infinity()),
      rpm_by_hand_(milling.rpm > 0.0),
      rpm_(milling.rpm) {
  if (chips_) figures_.chips.emplace();
}

void MillingRecorder::OnSignal(const machine::SignalChange& change) {
  if (rpm_by_hand_) return;
  if (change.signal == machine::Signal::kSpindle && change.value > 0.0) rpm_ = change.detail;
  if (change.signal == machine::Signal::kSpindleSpeed) rpm_ = change.value;
}

void MillingRecorder::OnMotion(const machine::MotionDone& done) {
  const motion::PathPiece& path = done.motion->path;
  if (path.kind() != motion::PathPiece::Kind::kLine) return;  // the rotary axis alone
  const motion::MachinePoint from = path.At(done.from).point - origin_;
  const motion::MachinePoint to = path.At(done.travelled).point - origin_;
  NoteReach(from, to, done.place);
  NoteBelow(from, to, done.place);
  const bool cuts = done.use == MotionUse::kCut || done.use == MotionUse::kPlunge;
  if (cuts && done.programmed_mm_s > 0.0) NoteBeside(from, to, done.place);
  const Passed passed{from, to, done.place, done.start, done.programmed_mm_s, rpm_};
  if (parallel_ == nullptr)
    return Note(passed, CutMove(material_, tool_, from, to, material_.all_rows()));
  batch_.Add(from, to);
  waiting_.push_back(passed);
  if (batch_.full()) CutWaiting();
}

void MillingRecorder::CutWaiting() {
  if (waiting_.empty()) return;
  const std::span<const MoveBatch::Taken> taken = batch_.Cut(material_, *parallel_);
  for (std::size_t k = 0; k < waiting_.size(); ++k) Note(waiting_[k], taken[k]);
  waiting_.clear();
}

void MillingRecorder::Note(const Passed& passed, const MoveBatch::Taken& of_move) {
  const auto& [from, to, place, start, programmed_mm_s, rpm] = passed;
  if (of_move.shank_depth_mm > std::max(figures_.shank_depth_mm, kGougeLeast_mm)) {
    figures_.shank_depth_mm = of_move.shank_depth_mm;
    figures_.shank_place = place;
  }
  const double taken = of_move.most_mm;
  if (programmed_mm_s <= 0.0 && taken > kGougeLeast_mm) {
    ++figures_.gouges;
    if (taken > figures_.gouge_depth_mm) {
      figures_.gouge_depth_mm = taken;
      figures_.gouge_place = place;
      figures_.gouge_at = start;
    }
  }
  if (changes_ && taken > 0.0) NoteChange(from, to);
  // A plunge, or a ramp of more than 45 degrees, is no pass; at travel speed it is a gouge.
  const double across = LengthOf(PlanOf(to - from));
  const bool is_pass = programmed_mm_s > 0.0 && across >= std::abs(to.z() - from.z());
  if (is_pass && taken > figures_.deepest_pass_mm) {
    figures_.deepest_pass_mm = taken;
    figures_.pass_place = place;
  }
  if (programmed_mm_s <= 0.0 || taken <= kGougeLeast_mm) return;
  if (is_pass) {
    figures_.pass_mm_s = std::max(figures_.pass_mm_s, programmed_mm_s);
    NoteChip(passed);
  } else if (to.z() < from.z()) {
    NotePlunge(passed, taken);
  }
}

void MillingRecorder::NoteChange(const motion::MachinePoint& from, const motion::MachinePoint& to) {
  const double radius = tool_.radius_mm;
  changes_->Note(std::min(from.x(), to.x()) - radius, std::max(from.x(), to.x()) + radius,
                 std::min(from.y(), to.y()) - radius, std::max(from.y(), to.y()) + radius);
}

std::vector<HeightTile> MillingRecorder::TakeChanges(std::size_t most) {
  CutWaiting();
  if (!changes_) changes_.emplace(material_);
  return changes_->Take(material_, most);
}

const HeightField& MillingRecorder::material() {
  CutWaiting();
  return material_;
}

// What an edge takes off at one turn; 0: nobody told how fast the spindle turns.
double MillingRecorder::ChipOf(const Passed& passed) const {
  return passed.rpm > 0.0 ? passed.programmed_mm_s / (passed.rpm / 60.0 * tool_.flutes) : 0.0;
}

void MillingRecorder::NotePlunge(const Passed& passed, double taken_mm) {
  if (passed.programmed_mm_s >= fast_z_mm_s_ && taken_mm > figures_.fast_plunge_mm) {
    figures_.fast_plunge_mm = taken_mm;
    figures_.fast_plunge_mm_s = passed.programmed_mm_s;
    figures_.fast_plunge_place = passed.place;
  }
  if (!chips_ || !(chips_->plunge_most_mm > 0.0)) return;
  const double percent = 100.0 * ChipOf(passed) / chips_->plunge_most_mm;
  if (percent <= figures_.chips->plunge_percent) return;
  figures_.chips->plunge_percent = percent;
  figures_.chips->plunge_place = passed.place;
}

// At the feed rate asked for: on ramps and in corners an edge takes less for a moment.
void MillingRecorder::NoteChip(const Passed& passed) {
  if (!chips_ || !(passed.rpm > 0.0)) return;
  const double chip_mm = ChipOf(passed);
  const double edge_mm_s = passed.rpm / 60.0 * 2.0 * kPi * tool_.radius_mm;
  const auto note = [&](double percent, double& most, machine::Place& where) {
    if (percent <= most) return;
    most = percent;
    where = passed.place;
  };
  ChipFigures& figures = *figures_.chips;
  note(100.0 * chip_mm / chips_->most_mm, figures.thick_percent, figures.thick_place);
  note(100.0 * (1.0 - chip_mm / chips_->least_mm), figures.thin_percent, figures.thin_place);
  note(100.0 * edge_mm_s * 0.06 / chips_->speed_most_m_min, figures.speed_percent,
       figures.speed_place);
}

// Only over the block: beside it the table may be lower.
void MillingRecorder::NoteBelow(const motion::MachinePoint& from, const motion::MachinePoint& to,
                                const machine::Place& place) {
  const Stock& block = material_.stock();
  const double below = block.bottom - std::min(from.z(), to.z());
  if (below <= kGougeLeast_mm) return;
  const auto beside = [&](double a, double b, double low, double high) {
    return std::max(a, b) < low - tool_.radius_mm || std::min(a, b) > high + tool_.radius_mm;
  };
  if (beside(from.x(), to.x(), block.x_min, block.x_max) ||
      beside(from.y(), to.y(), block.y_min, block.y_max))
    return;
  if (!(figures_.below_mm > 0.0)) figures_.below_place = place;
  figures_.below_mm = std::max(figures_.below_mm, below);
}

// With the middle of the tool over the block: whether a cell notices, or not.
void MillingRecorder::NoteReach(const motion::MachinePoint& from, const motion::MachinePoint& to,
                                const machine::Place& place) {
  const Stock& block = material_.stock();
  if (block.top - std::min(from.z(), to.z()) <= std::max(figures_.reach_mm, kGougeLeast_mm)) return;
  const motion::MachineVector way = to - from;
  PartOfMove over;
  over.KeepOver(block, 0.0, from, way);
  if (over.low > over.high) return;
  const double least = from.z() + std::min(way.z() * over.low, way.z() * over.high);
  if (block.top - least <= std::max(figures_.reach_mm, kGougeLeast_mm)) return;
  figures_.reach_mm = block.top - least;
  figures_.reach_place = place;
}

// Below the top of the block. Outlines and facing run on beyond an edge by about the diameter of
// the tool, which stands beside the block then; what lies further out is meant for a larger block,
// or for another place of it.
void MillingRecorder::NoteBeside(const motion::MachinePoint& from, const motion::MachinePoint& to,
                                 const machine::Place& place) {
  const Stock& block = material_.stock();
  if (std::min(from.z(), to.z()) >= block.top) return;
  const double run_on = 2.0 * tool_.radius_mm;
  const motion::MachineVector way = to - from;
  PartOfMove deep;
  deep.KeepBelow(from.z(), way.z(), block.top);
  PartOfMove inside = deep;
  inside.KeepOver(block, run_on, from, way);
  const double beside = (deep.length() - inside.length()) * way.norm();
  if (beside <= kGougeLeast_mm) return;
  if (!(figures_.beside_mm > 0.0)) figures_.beside_place = place;
  figures_.beside_mm += beside;
  const auto note = [&](double beyond, double& most) {
    if (beyond > run_on) most = std::max(most, beyond);
  };
  for (const double share : {deep.low, deep.high}) {
    const motion::MachinePoint p = from + way * share;
    note(block.x_min - p.x(), figures_.beside_x_low_mm);
    note(p.x() - block.x_max, figures_.beside_x_high_mm);
    note(block.y_min - p.y(), figures_.beside_y_low_mm);
    note(p.y() - block.y_max, figures_.beside_y_high_mm);
  }
}

MillingFigures MillingRecorder::Figures() {
  CutWaiting();
  MillingFigures figures = figures_;
  figures.removed_mm3 = material_.removed_mm3();
  figures.remaining_mm3 = material_.whole_mm3() - figures.removed_mm3;
  figures.deepest_cut_mm = material_.deepest_cut_mm();
  figures.tool_diameter_mm = 2.0 * tool_.radius_mm;
  figures.cell_mm = material_.stock().cell;
  figures.reach_width_mm = figures.reach_mm > 0.0 ? WidthAt(tool_, figures.reach_mm) : 0.0;
  if (target_) figures.target = CompareWithTarget(material_, *target_);
  return figures;
}

}  // namespace rmlcell::simulation
