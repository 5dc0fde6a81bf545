#pragma once

#include <cstdint>
#include <limits>

#include "engine/rml1/device.h"

namespace rmlcell::rml1 {

// What a person should know of the way the tool goes through the work. Lengths in mm; the command
// is the first that did it (number 0: none did). The work begins at its surface, where Z0 was
// before the program: of a plunge from above only what lies below counts.
class CutWatch {
 public:
  struct Way {
    double mm = 0.0;
    CommandPlace first{};
  };
  // In the work at a speed that the machine has in place of the one asked for.
  struct LimitedWay : Way {
    SpeedLimit worst{};
  };

  struct Ride {
    Point from;
    Point to;
    double length_mm = 0.0;
    bool in_work = false;        // a cut or a plunge
    bool along_surface = false;  // a cut that takes nothing off
    bool rapid = false;          // at the travel speed
    bool by_xy_speed = false;    // else by the speed of Z
    bool spindle_turns = false;
    bool plunge = false;          // straight down into the work
    double speed_mm_s = 0.0;      // of a cut or a plunge
    double fastest_z_mm_s = 0.0;  // that Z travels
    double clamps_height = 0.0;   // of the clamps above Z 0, device units; 0: none are known
  };
  void OnRide(const Ride& ride, const Registers& registers, const CommandPlace& command);

  const Way& spindle_stands() const { return spindle_stands_; }  // in the work
  // Across at travel speed, not above the surface; or along it by V, nearly as fast as Z travels,
  // where the cuts before and behind, as far as there are any, take half of that or less.
  Way no_clearance() const;
  const Way& feed_not_given() const { return feed_not_given_; }  // in the work
  // In the work, from a place that no command gave before: it hangs on where the tool stood.
  const Way& place_not_given() const { return place_not_given_; }
  // In the work, before a command said whether the spindle may turn.
  const Way& rotation_not_given() const { return rotation_not_given_; }
  // Down below the surface, straight or steeply, nearly as fast as Z travels, to where the tool
  // cuts slower than that, or turns back in a program that cuts slower everywhere: on a machine
  // with a slow Z that is the speed of every plunge. CAM tools go down fast where
  // a pass before has cleared the way, and slow down before they reach the material: such a way is
  // no plunge. A step down on the way of a cut is part of the cut.
  Way fast_plunge() const;
  // Of such a way what lies deeper than all that this program cut before: it takes for granted that
  // another one has cleared it.
  const Way& taken_for_cleared() const { return taken_for_cleared_; }
  // Across below the surface by V, nearly as fast as Z travels, between cuts at half of that or
  // less, or in a visit to the work that goes down as fast while such cuts are elsewhere. A
  // way that leads down slowly is no slow cut: ramps are slow before a fast pass.
  Way fast_across() const;
  // More than 1 % beside what the program asked for. A plunge that is slower harms nothing.
  const LimitedWay& feed_limited() const { return feed_limited_; }  // mm/s
  const LimitedWay& rpm_limited() const { return rpm_limited_; }
  // With the tool down (Z1) and the spindle on along the surface, where nothing is cut.
  const Way& skims() const { return skims_; }
  // Across, lower than the clamps, on the way to the first cut and from the last one on.
  Way below_clamps() const;

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  // From where the tool goes below the surface to where it is above again.
  struct Visit {
    Way fast;
    double fast_mm_s = kNone;     // the least of these
    double slowest_mm_s = kNone;  // of the others, unless they lead down
    bool entered = false;
    bool enters_fast = false;  // by the last way down before it crosses
    bool crosses = false;
  };

  static void Add(Way& way, double mm, const CommandPlace& command);
  static void AddLimited(LimitedWay& way, const SpeedLimit& limit, double mm,
                         const CommandPlace& command);
  static void Join(Way& way, const Way& other);
  void OnVisit(const Ride& ride, const Registers& registers, const CommandPlace& command,
               bool down);
  void OnWayDown(const Ride& ride, const Registers& registers, const CommandPlace& command);
  void OnCrossing(const Ride& ride, double mm, const CommandPlace& command);
  void EndVisit();
  void EndWayDown(const Ride& next);
  void OnCut(const Ride& ride, const Registers& registers, const CommandPlace& command);
  void OnTravel(const Ride& ride, const Registers& registers, const CommandPlace& command);
  void OnPlace(const Ride& ride, const Registers& registers, const CommandPlace& command);
  void EndAlong(double next_mm_s);

  Way spindle_stands_;
  Way no_clearance_;
  Way along_;                  // the surface, since the last cut, as fast as lifts
  double along_mm_s_ = kNone;  // the least of these
  double before_mm_s_ = 0.0;   // of the last cut or slow plunge; 0: there was none
  Way feed_not_given_;
  Way place_not_given_;
  Way rotation_not_given_;
  bool place_known_ = false;
  Way fast_plunge_;
  Way fast_hole_;    // of ways down that turn back
  Way fast_so_far_;  // of a way down that may go on slower
  double fast_mm_s_ = 0.0;
  double cut_mm_s_ = 0.0;  // the fastest across
  Visit visit_;
  Way fast_among_slow_;              // of visits that are over
  Way fast_visits_;                  // of those that may be as fast as they should
  double fast_visits_mm_s_ = kNone;  // the least of these
  double slowest_mm_s_ = kNone;
  Way uncleared_;         // of a fast way down, so far: deeper than what was cut before
  double slow_mm_ = 0.0;  // of the way down since then
  Way taken_for_cleared_;
  double deepest_ = kNone;  // that the tool has cut, device units
  Way skims_;
  LimitedWay feed_limited_;
  LimitedWay rpm_limited_;
  bool has_cut_ = false;
  bool cutting_ = false;  // across, without having left the work since
  Way to_work_;           // lower than the clamps: before the first cut
  Way from_work_;         // since the last one
};

}  // namespace rmlcell::rml1
