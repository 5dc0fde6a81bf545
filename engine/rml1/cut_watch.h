#pragma once

#include <cstdint>

#include "engine/rml1/device.h"

namespace rmlcell::rml1 {

// What a person should know of the way the tool goes through the work. Lengths in mm; the command
// is the first that did it (number 0: none did). The work begins at Z 0: of a plunge from above
// only what lies below counts.
class CutWatch {
 public:
  struct Way {
    double mm = 0.0;
    CommandPlace first{};
  };

  struct Ride {
    Point from;
    Point to;
    double length_mm = 0.0;
    bool in_work = false;      // a cut or a plunge
    bool rapid = false;        // at the travel speed
    bool by_xy_speed = false;  // else by the speed of Z
    bool spindle_turns = false;
  };
  void OnRide(const Ride& ride, const Registers& registers, const CommandPlace& command);

  const Way& spindle_stands() const { return spindle_stands_; }  // in the work
  const Way& no_clearance() const { return no_clearance_; }      // across, not above the surface
  const Way& feed_not_given() const { return feed_not_given_; }  // in the work

 private:
  static void Add(Way& way, double mm, const CommandPlace& command);

  Way spindle_stands_;
  Way no_clearance_;
  Way feed_not_given_;
};

}  // namespace rmlcell::rml1
