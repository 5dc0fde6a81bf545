#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "engine/optimo/control/data_access.h"
#include "engine/optimo/control/program_counter.h"
#include "engine/optimo/control/waits.h"
#include "engine/optimo/ride/ride.h"

namespace rmlcell::optimo {

// How far the MOVE with /END or /TIME is that is watched.
enum class WatchStage : std::uint8_t {
  kIdle,     // none is
  kArmed,    // it is being carried out, or waits for its /START: its /TIME runs
  kComes,    // its motions are behind a /FLY passage
  kWatches,  // they are under way, or begin at once
  kRanOut,   // its /TIME is over: it comes to rest
  kStands,   // it could never end (SPEED 0): it stands until its /TIME or /END. OPT-B.22
};

struct WatchState {
  struct Time {
    double limit_s = 0.0;
    SimTime due{0};
    DueGosub gosub{};
  };

  WatchStage stage = WatchStage::kIdle;
  std::uint64_t first = 0;  // tags of its motions: kComes, kWatches, kRanOut
  std::uint64_t last = 0;
  std::optional<Condition> end{};  // /END; not of kIdle
  std::optional<Time> time{};      // /TIME; not of kIdle
  SimTime since{0};                // of which the ticks are counted: kComes and on
};

// /END and /TIME of a MOVE: at its start, at each tick, when time runs out. With /NEXT the program
// goes on meanwhile. OPT-2.54 to 2.58
//
//   kIdle     Arm       kArmed: the MOVE has /TIME
//             Watch     kWatches; kComes, where the program has run ahead: with /END alone
//   kArmed    Watch     kWatches; kComes, where the program has run ahead
//             Stand     kStands
//             Disarm    kIdle: its /END was true at once
//             time out  kIdle, and the GOSUB: no motion is made
//   kComes    begins    kWatches, and its time runs from here
//   kWatches  /END      stays, and the motion ends where it is
//             time out  kRanOut, and the motion ends where it is
//             arrives   kIdle
//   kRanOut   arrives   kIdle, and the GOSUB
//   kStands   /END      kIdle
//             time out  kIdle, and the GOSUB
//   any       Clear     kIdle: the MOVE is over, came to nothing, or an error ended it
class MoveWatch {
 public:
  MoveWatch(WatchState& state, const Situation& situation, SystemCycle cycle,
            ProgramCounter& counter, Ride& ride, DataAccess& data, Waits& waits)
      : s_(state),
        situation_(situation),
        cycle_(cycle),
        counter_(counter),
        ride_(ride),
        data_(data),
        waits_(waits) {}

  // --- a MOVE is carried out ---
  void Arm(int time_label, double seconds);  // its /TIME
  void Disarm();                             // its /END was true at once: no motion at all
  void SetEnd(const Condition& end) { s_.end = end; }
  void Watch(std::uint64_t first, std::uint64_t last, bool ran_ahead);
  void Stand();  // it never moves
  void Clear();

  // --- time passes ---
  // Nothing of a MOVE is to be watched: no time and no condition ends anything.
  bool idle() const { return s_.stage == WatchStage::kIdle && !s_.time && !s_.end; }
  bool stands() const { return s_.stage == WatchStage::kStands; }
  // A motion of it is under way, and nothing has ended it yet.
  bool watches() const;
  // A MOVE that waits for its /START ends by its /TIME.
  bool times_out() const { return waits_.pending().of_move && s_.time; }
  // Precondition: it has a /TIME.
  SimTime time_due() const { return std::max(situation_.now, s_.time->due); }
  SimTime NextEvent(bool last_input) const;
  // Ends what is to end now. Errors: of /END.
  Status Look();
  // A MOVE takes over from one that stands, or its time or condition ends it.
  void EndStanding();

  // The machine stood halted so long.
  void Shift(SimTime stood);

  // --- the ride tells ---
  void OnMotionBegins(std::uint64_t tag);
  void OnMoveOver(std::uint64_t tag);

 private:
  bool time_runs() const { return s_.time && s_.stage != WatchStage::kRanOut; }
  bool TimeOut();
  // Precondition: it has a /TIME.
  void MakeGosubDue() { counter_.MakeDue(s_.time->gosub); }

  WatchState& s_;
  const Situation& situation_;
  const SystemCycle cycle_;
  ProgramCounter& counter_;
  Ride& ride_;
  DataAccess& data_;
  Waits& waits_;
};

}  // namespace rmlcell::optimo
