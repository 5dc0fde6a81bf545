#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/machine/run.h"
#include "engine/rml1/cut_watch.h"
#include "engine/rml1/device.h"
#include "engine/rml1/work_fit.h"

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
    bool first = true;     // of its motion; false: the rest of one that was cut
    bool in_work = false;  // the motion: IsInWork
    bool rapid = false;
    Chain chain = Chain::kAlone;
    bool spindle_turns = false;
  };
  // Cut length is that of cuts and plunges that lead below the surface, as in every report of the
  // cell; travel length is the rest.
  void OnRide(const Ride& ride, const Registers& registers, const CommandPlace& command);

  void OnDwell(double time_s, const Registers& registers);
  void OnSpindleWait(double time_s, const Registers& registers);
  void OnHalt(double time_s) { totals_.halted_s += time_s; }

  struct Totals {
    std::uint64_t motions = 0;
    std::uint64_t plunges = 0;  // that follow each other are one
    double cut_mm = 0.0;
    double drawn_mm = 0.0;  // with the tool down along the surface and no spindle: of a pen
    double travel_mm = 0.0;
    double up_s = 0.0;  // motions and waits: down in the work and in tool state down, else up
    double down_s = 0.0;
    double motion_s = 0.0;
    double dwell_s = 0.0;
    double spindle_s = 0.0;
    double halted_s = 0.0;
    Extent x;  // work coordinates, device units
    Extent y;
    Extent z;
    Extent a;  // degrees
    WorkExtent work;
  };
  // What was done so far was done by nobody. LIVE-6.09
  void ForgetTotals() { totals_ = {}; }
  const Totals& totals() const { return totals_; }
  const CutWatch& watch() const { return watch_; }
  const Profile& profile() const { return *profile_; }

  // Whether a motion with the tool down takes material off: `use` tells only what it is for.
  static bool IsInWork(machine::MotionUse use, const Point& from, const Point& to,
                       const Registers& registers) {
    const bool tool_in = use == machine::MotionUse::kCut || use == machine::MotionUse::kPlunge;
    return tool_in && registers.IsBelowSurface(std::min(from.z, to.z));
  }

 private:
  void AddToState(double time_s, bool down);

  const Profile* profile_;
  Totals totals_;
  bool plunging_ = false;
  double depth_ = 0.0;  // of the tool below the surface, device units
  CutWatch watch_;
};

}  // namespace rmlcell::rml1
