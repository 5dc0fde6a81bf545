#pragma once

#include <array>
#include <cstddef>
#include <functional>

#include "engine/machine/observer.h"

namespace rmlcell::simulation {

// Sees to it that every nanosecond of virtual time is counted once, whoever tells about it and in
// whatever order: a motion that goes on behind a DELAY (/NEXT) is told after it.
class TimeLedger {
 public:
  // A stretch that nobody told about yet, and what was going on when it began.
  struct Gap {
    SimTime start{0};
    SimTime end{0};
    machine::Place place{};
    bool beam_on = false;
    bool halted = false;
    SimTime length() const { return end - start; }
  };
  using TakeGap = std::function<void(const Gap&)>;

  // `count` is given the gaps that nobody will claim any more: all at Close, the oldest when more
  // than kGapsMax are open.
  explicit TimeLedger(TakeGap count) : count_(std::move(count)) {}

  // What lies before is not counted.
  void BeginAt(SimTime time) {
    begun_ = reached_ = time;
    open_ = 0;
  }

  // Time goes on to `until` without a word; `now` describes what goes on.
  void Leave(SimTime until, const Gap& now);

  // The length of [start, end] that was not counted before, gaps included.
  SimTime Claim(SimTime start, SimTime end, const Gap& now);

  void Close();

  SimTime reached() const { return reached_; }
  SimTime counted() const { return reached_ - begun_; }

 private:
  // Waits behind one motion follow each other without gaps, nearly.
  static constexpr std::size_t kGapsMax = 16;
  void Open(const Gap& gap);

  TakeGap count_;
  SimTime begun_{0};
  SimTime reached_{0};  // everything before is counted, or in a gap
  std::array<Gap, kGapsMax> gaps_{};
  std::size_t open_ = 0;
};

}  // namespace rmlcell::simulation
