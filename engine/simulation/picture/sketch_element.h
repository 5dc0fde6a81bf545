#pragma once

#include <cstdint>
#include <vector>

#include "engine/machine/observer.h"

namespace rmlcell::simulation {

// A line or an arc of a path, as a picture needs it. In the machine frame in mm, or on a page in
// pixels with z = 0.
struct SketchElement {
  motion::MachinePoint from{};
  motion::MachinePoint to{};
  motion::MachinePoint middle{};  // of an arc
  std::int32_t arc = -1;          // index of its circle; -1: a line
  machine::MotionUse use = machine::MotionUse::kTravel;
  bool cuts = false;
  bool skims = false;      // with the tool down, but along the surface of the work
  bool lost = false;       // asked for beyond the travel: the machine left it out
  std::uint8_t shade = 0;  // what else makes it look different

  bool SameLook(const SketchElement& other) const {
    return use == other.use && cuts == other.cuts && skims == other.skims && lost == other.lost &&
           shade == other.shade;
  }
};

// Merges neighbours that go straight on, and takes arcs that fit into the tolerance for lines. No
// point of a merged line is farther off than twice the tolerance.
void MergeStraight(std::vector<SketchElement>& elements, double tolerance);

// Drops elements that look like an earlier one at a resolution of `cell`, from whichever end they
// are drawn.
void DropAlike(std::vector<SketchElement>& elements, double cell);

}  // namespace rmlcell::simulation
