#pragma once

#include <cstdint>
#include <vector>

#include "engine/machine/run.h"
#include "engine/rml1/device.h"

namespace rmlcell::rml1 {

// What the physical tool did: lengths in mm, times in s. Fed by whoever carries out the actions of
// a device, one motion (or part of one) after the other.
class Physical {
 public:
  explicit Physical(const Profile& profile) : profile_(&profile) {}

  struct Ride {
    Point from;
    Point to;
    machine::MotionUse use = machine::MotionUse::kTravel;
    double length_mm = 0.0;
    double time_s = 0.0;
    bool first = true;  // of its motion; false: the rest of one that was cut
  };
  // Cut length is what the tool did in the work, cuts and plunges, as in every report of the cell;
  // travel length is the rest.
  void OnRide(const Ride& ride, const Registers& registers);

  void OnDwell(double time_s, const Registers& registers);
  void OnSpindleWait(double time_s, const Registers& registers);
  void OnHalt(double time_s) { halted_s_ += time_s; }

  // All figures of a run: these, the registers and counts of the device, and the programmed ones.
  std::vector<machine::Figure> Figures(const Device& device) const;

 private:
  void AddToState(double time_s, const Registers& registers);

  const Profile* profile_;
  std::uint64_t motions_ = 0;
  std::uint64_t plunges_ = 0;
  double cut_mm_ = 0.0;
  double travel_mm_ = 0.0;
  double up_s_ = 0.0;
  double down_s_ = 0.0;
  double motion_s_ = 0.0;
  double dwell_s_ = 0.0;
  double spindle_s_ = 0.0;
  double halted_s_ = 0.0;
  Extent x_;  // work coordinates, device units
  Extent y_;
  Extent z_;
  Extent a_;
};

}  // namespace rmlcell::rml1
