#pragma once

#include "engine/machine/part_on_table.h"
#include "engine/simulation/material/milling_recorder.h"

namespace rmlcell::simulation {

// A block on the table of a mill as runs leave it, so that a way across it can be looked at.
// LIVE-6.07, motion.md section 9.
class MilledPart final : public machine::PartOnTable {
 public:
  // Precondition: CheckMilling is well.
  explicit MilledPart(const Milling& milling);

  void BeginAt(const motion::MachinePoint& work_origin, const motion::MachinePoint& at) override;
  void OnMotion(const machine::MotionDone& done) override;
  void EndAt(const motion::MachinePoint& at) override { Cut(at_, at); }
  double DepthOf(const motion::MachinePoint& from, const motion::MachinePoint& to) const override;

 private:
  void Cut(const motion::MachinePoint& from, const motion::MachinePoint& to);

  motion::MachinePoint origin_;  // of the block's frame, machine frame
  motion::MachinePoint at_;      // the end of the last motion that was told
  MillTool tool_;
  HeightField material_;
};

}  // namespace rmlcell::simulation
