#pragma once

#include <algorithm>
#include <chrono>

#include "engine/core/units.h"

namespace rmlcell::server {

// Keeps virtual time in step with real time: `pace` virtual seconds a real second.
class Pacer {
 public:
  using Instant = std::chrono::steady_clock::time_point;

  // Behind by more than this the run goes on from where it is: nobody wants to see a minute in a
  // blink because a store was slow.
  static constexpr std::chrono::milliseconds kLagMax{500};
  static constexpr std::chrono::milliseconds kWait{10};  // between two looks at the clock

  // A pace of 0: as fast as the processor allows.
  explicit Pacer(double pace) : pace_(pace) {}

  bool paced() const { return pace_ > 0.0; }

  // How much virtual time may pass now, at most `slice`. The first call, and one after Stand,
  // begins the count.
  SimTime Due(Instant now, SimTime virtual_now, SimTime slice) {
    if (!paced()) return slice;
    if (!counting_ || Lag(now, virtual_now) > kLagMax * std::max(1.0, pace_)) {
      counting_ = true;
      begin_ = now;
      virtual_begin_ = virtual_now;
    }
    return std::clamp(std::chrono::duration_cast<SimTime>(Lag(now, virtual_now)), SimTime(0),
                      slice);
  }

  // The run stands until someone lets it go on: that time is not caught up.
  void Stand() { counting_ = false; }

 private:
  using Real = std::chrono::duration<double, SimTime::period>;
  Real Lag(Instant now, SimTime virtual_now) const {
    return Real(now - begin_) * pace_ - Real(virtual_now - virtual_begin_);
  }

  double pace_;
  bool counting_ = false;
  Instant begin_{};
  SimTime virtual_begin_{0};
};

}  // namespace rmlcell::server
