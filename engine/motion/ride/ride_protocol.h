#pragma once

#include <cstdint>
#include <utility>

#include "engine/core/check.h"

namespace rmlcell::motion {

// What a machine is to do on its planned path.
enum class RideIntent : std::uint8_t {
  kGo,
  kHold,  // HOLD: stand at the next end of a motion where that is possible
  kStop,  // STOP: brake at once, on the path
};

// HOLD, STOP, START and the override on the way, the same for every machine: motion.md section 6.
// How a family plans what they ask for is its own.
//
//   intent, at rest   HOLD     STOP     it rests        START        another override
//   kGo               kHold    kStop    -               -            taken over now
//   kHold             -        kStop    kHold, at rest  kGo; *       *
//   kStop             -        -        kStop, at rest  -            at START
//   kHold, at rest    -        -        -               kGo          at START
//   kStop, at rest    -        -        -               kGo          at START
//
// "-" changes nothing. * The Optimo's ramp to a target stays what it is: START is ignored until it
// rests, and the override waits. A mill plans it anew.
class RideProtocol {
 public:
  RideIntent intent() const { return intent_; }
  bool goes() const { return intent_ == RideIntent::kGo; }
  bool comes_to_rest() const { return !goes() && !rests_; }
  bool may_hold() const { return goes(); }
  bool may_stop() const { return intent_ != RideIntent::kStop && !rests_; }

  // Preconditions: may_hold(), may_stop(), comes_to_rest().
  void Hold() {
    RMLCELL_CHECK(may_hold());
    intent_ = RideIntent::kHold;
  }
  void Stop() {
    RMLCELL_CHECK(may_stop());
    intent_ = RideIntent::kStop;
  }
  void Rest() {
    RMLCELL_CHECK(comes_to_rest());
    rests_ = true;
  }

  // Another override. False: it is taken over at Resume.
  bool TakesOverride() {
    if (!goes()) overridden_ = true;
    return goes();
  }

  // START; where the table has "-" for it, the caller does not ask. True: an override that came
  // meanwhile is still to be taken over.
  bool Resume() {
    intent_ = RideIntent::kGo;
    rests_ = false;
    return std::exchange(overridden_, false);
  }

 private:
  RideIntent intent_ = RideIntent::kGo;
  bool rests_ = false;
  bool overridden_ = false;
};

}  // namespace rmlcell::motion
