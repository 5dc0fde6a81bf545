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

// What becomes of the ramp that a HOLD has begun, when START or another override comes before it is
// over.
enum class HoldRamp : std::uint8_t {
  kStays,        // the Optimo's ramp to a target: START is ignored, the override waits
  kPlannedAnew,  // a mill's
};

// HOLD, STOP, START and the override on the way, the same for every machine: motion.md section 6.
// How a family plans what they ask for is its own.
//
//   intent, at rest   HOLD     STOP     it rests        START        another override
//   kGo               kHold    kStop    -               -            taken over now
//   kHold             -        kStop    kHold, at rest  kGo *        taken over now *
//   kStop             -        -        kStop, at rest  -            at START
//   kHold, at rest    -        -        -               kGo          at START
//   kStop, at rest    -        -        -               kGo          at START
//
// "-": HOLD, STOP and what comes to rest are not asked for (may_...() tells), START changes
// nothing. * Of HoldRamp::kPlannedAnew; else as kStop has it. Finish: the ride is over, whatever it
// was to do.
class RideProtocol {
 public:
  explicit RideProtocol(HoldRamp ramp) : ramp_(ramp) {}

  RideIntent intent() const { return intent_; }
  bool goes() const { return intent_ == RideIntent::kGo; }
  bool comes_to_rest() const { return !goes() && !rests_; }
  bool may_hold() const { return goes(); }
  bool may_stop() const { return intent_ != RideIntent::kStop && !rests_; }
  bool may_resume() const {
    return !goes() && (rests_ || (intent_ == RideIntent::kHold && ramp_ == HoldRamp::kPlannedAnew));
  }

  // Preconditions: may_hold(), may_stop(), comes_to_rest(); goes() or may_resume().
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
  // START. True: an override that came meanwhile is still to be taken over.
  bool Resume() {
    RMLCELL_CHECK(goes() || may_resume());
    return Restart();
  }

  // Another override. False: it is taken over at Resume.
  bool Override() {
    const bool now = goes() || (!rests_ && may_resume());
    if (!now) overridden_ = true;
    return now;
  }

  // The ride is over. As Resume, for what comes next.
  bool Finish() { return Restart(); }

 private:
  bool Restart() {
    intent_ = RideIntent::kGo;
    rests_ = false;
    return std::exchange(overridden_, false);
  }

  HoldRamp ramp_;
  RideIntent intent_ = RideIntent::kGo;
  bool rests_ = false;
  bool overridden_ = false;
};

}  // namespace rmlcell::motion
