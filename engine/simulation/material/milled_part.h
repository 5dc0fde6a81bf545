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

  void BeginAt(const motion::MachinePoint& work_origin) override { origin_ = work_origin; }
  void OnMotion(const machine::MotionDone& done) override;
  double DepthOf(const motion::MachinePoint& from, const motion::MachinePoint& to) const override;

 private:
  motion::MachinePoint origin_;  // of the block's frame, machine frame
  MillTool tool_;
  HeightField material_;
};

}  // namespace rmlcell::simulation
