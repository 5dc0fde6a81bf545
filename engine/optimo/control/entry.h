#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "engine/machine/step_entry.h"
#include "engine/optimo/control/works.h"
#include "engine/optimo/language/ast.h"
#include "engine/optimo/machine/machine_state.h"

namespace rmlcell::optimo {

// A motion of the approach, from where the one before ended.
struct ApproachLeg {
  PathType path = PathType::kPtp;  // kPtp: of the axes, as in COORD ROBOT; kLin: of the tip
  motion::AxisPose to{};
  double speed_percent = 0.0;
};

// A run that halts before a step, and one that begins with it. LIVE-6
//
//   target   halted   arrival                                      by
//   set      -        -         it goes to the step                HaltBefore
//   set      set      -         it stands before it                HaltsBefore (control_entry.cc)
//   -        -        set       it approaches from where the       Enter
//                               machine stands
//   -        -        -         as any other run                   ForgetTarget, ArriveAtEntry
struct EntryState {
  std::optional<machine::StepTarget> target{};
  std::uint64_t passes = 0;                     // how often its step was begun
  std::optional<machine::StepFacts> reached{};  // it comes to rest before it
  std::optional<machine::StepFacts> halted{};

  // A GOSUB that a timer made: open while control is as deep as that.
  struct TimedGosub {
    std::size_t calls = 0;
    std::size_t level = 0;
    std::size_t depth = 0;
  };
  std::vector<TimedGosub> timed_gosubs{};  // while somebody wants to know

  struct Arrival {
    SimTime begun{0};
    Outputs outputs{};  // what they are there
    int gas_refused = 0;
    std::vector<WorkTask> works{};  // that go on there: not on the way
    bool halts = false;
  };
  std::optional<Arrival> arrival{};
  std::deque<ApproachLeg> legs{};  // to come
  SimTime approached{0};           // how long the way took
};

}  // namespace rmlcell::optimo
