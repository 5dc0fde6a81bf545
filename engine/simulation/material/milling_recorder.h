#pragma once

#include <optional>
#include <vector>

#include "engine/machine/observer.h"
#include "engine/machine/shape.h"
#include "engine/simulation/material/chip_load.h"
#include "engine/simulation/material/height_field.h"
#include "engine/simulation/material/height_tiles.h"
#include "engine/simulation/material/move_batch.h"
#include "engine/simulation/material/parallel_for.h"
#include "engine/simulation/material/target.h"
#include "engine/simulation/report/report.h"

namespace rmlcell::simulation {

// A block on the table of a mill and the tool that mills it. The block is given from the work
// origin as it is when the run begins.
struct Milling {
  Stock stock;
  MillTool tool;
  std::optional<Target> target{};    // what should be left, on the same cells
  std::optional<ChipRange> chips{};  // usual for tool and material; the tool has flutes then
  double rpm = 0.0;                  // of a spindle that is set by hand; 0: as the machine tells
};
// Errors: CellInvalidArgument, as CheckTool and CheckStock have them, for a target of other cells
// or with a tolerance below 0, and for a range of chips without the flutes of the tool.
Status CheckMilling(const Milling& milling);

// Takes the material away that the motions of a run sweep, and tells where the tool went into it at
// travel speed, where shank or holder did, how deep the deepest pass is, and what lies beside it.
// motion.md section 9.
class MillingRecorder final : public machine::RunObserver {
 public:
  // Precondition: CheckMilling is well. `parallel` cuts moves, many at a time; null: each is cut as
  // it comes. Outlives this.
  MillingRecorder(const machine::MachineShape& shape, const Milling& milling,
                  ParallelFor* parallel = nullptr);

  // Where the work origin of the machine is, before the first motion: it may have been set since.
  void BeginAt(const motion::MachinePoint& work_origin) { origin_ = work_origin; }

  void OnMotion(const machine::MotionDone& done) override;
  void OnSignal(const machine::SignalChange& change) override;

  // Of all motions up to now: those that wait to be cut are cut first.
  MillingFigures Figures();
  const HeightField& material();
  // For who looks on while it mills: at most `most` tiles that have changed since they were taken
  // last. From the first call on it is noted where something is taken off.
  std::vector<HeightTile> TakeChanges(std::size_t most);
  bool any_change_left() const { return changes_ && changes_->any_left(); }
  const std::optional<Target>& target() const { return target_; }

 private:
  // A motion that was cut, or waits to be.
  struct Passed {
    motion::MachinePoint from;
    motion::MachinePoint to;
    machine::Place place;
    SimTime start;
    double programmed_mm_s;  // not above 0: at travel speed
    double rpm;              // as it was then
  };

  void CutWaiting();
  void Note(const Passed& passed, const MoveBatch::Taken& taken);
  void NoteChange(const motion::MachinePoint& from, const motion::MachinePoint& to);
  void NoteBelow(const motion::MachinePoint& from, const motion::MachinePoint& to,
                 const machine::Place& place);
  void NoteReach(const motion::MachinePoint& from, const motion::MachinePoint& to,
                 const machine::Place& place);
  void NoteBeside(const motion::MachinePoint& from, const motion::MachinePoint& to,
                  const machine::Place& place);
  double ChipOf(const Passed& passed) const;
  void NotePlunge(const Passed& passed, double taken_mm);
  void NoteChip(const Passed& passed);

  motion::MachinePoint origin_;  // of the block's frame, machine frame
  MillTool tool_;
  HeightField material_;
  ParallelFor* parallel_;
  MoveBatch batch_;
  std::vector<Passed> waiting_;  // those of the batch
  std::optional<HeightChanges> changes_;
  std::optional<Target> target_;
  std::optional<ChipRange> chips_;
  double fast_z_mm_s_ = 0.0;  // a way down this fast is no feed
  bool rpm_by_hand_ = false;
  double rpm_ = 0.0;  // 0: not known yet
  MillingFigures figures_;
};

}  // namespace rmlcell::simulation
