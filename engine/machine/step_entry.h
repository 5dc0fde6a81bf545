#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/units.h"
#include "engine/machine/outcome.h"
#include "engine/machine/run_setup.h"
#include "engine/motion/geometry/pose.h"

// What a family does so that a run can be entered at a step. LIVE-6
namespace rmlcell::machine {

// The n-th time that control comes to a step. A stream has commands in place of steps and comes to
// each of them once.
struct StepTarget {
  ProgramStep at{};
  std::uint64_t occurrence = 1;
  // Of a stream, in place of the step: the first byte of a command. -1: the step counts.
  std::int64_t byte_offset = -1;

  bool operator==(const StepTarget&) const = default;
};

// How it is when a step is about to begin, where a run would begin with it.
struct StepFacts {
  Place place{};
  bool stands = true;           // nothing moves, and no motion is held back
  bool passes = false;          // a /FLY before it is open: who starts here stops at its target
  bool work_active = false;     // a WORK is ON; never of a mill
  bool tool_down = false;       // of a mill: or the tool is below the surface of the work
  bool beside = false;          // a motion or a WORK of /NEXT goes on
  bool in_timed_gosub = false;  // control is in a GOSUB that a timer made
  bool inside_command = false;  // of a stream: a call or an ESC sequence is unfinished
  // Of a run that halted here: it may be that it would have passed, and nobody can tell from it.
  bool may_pass = false;
  bool may_be_entered() const { return !beside && !in_timed_gosub && !inside_command; }
  // A run may begin here without anything that the part would show. LIVE-6.04
  bool clean() const { return stands && !work_active && !tool_down && may_be_entered(); }
};

// What becomes of a value that is another one there than now. LIVE-6.03
enum class StartAction : std::uint8_t {
  kSet,     // set to the value there
  kMove,    // the machine moves there
  kSwitch,  // an output: switched where the approach is over
  kAsk,     // a person sees to it, and acknowledges it
  kNone,    // nothing: it stays as it is now
};

// A value of a machine at one instant, by a name that never changes meaning: "VR[3]", "pose".
struct StateItem {
  std::string name{};
  std::string value{};
  StartAction action = StartAction::kSet;

  bool operator==(const StateItem&) const = default;
};

// How a run comes to the step where it begins. LIVE-6.05, LIVE-6.06
enum class ApproachWay : std::uint8_t {
  kSafe,    // up, across, down
  kDirect,  // not at all: its first motion begins where the machine stands
};

// An axis that a motion takes out of its travel.
struct OutOfTravel {
  int axis = 0;         // 0..4: X Y Z A B
  double excess = 0.0;  // the worst of the motion, mm or rad
  bool at_target = false;

  bool operator==(const OutOfTravel&) const = default;
};

struct ApproachMotion {
  std::string_view path{};  // "PTP", "LIN"; of a mill "PU", "PD"
  motion::AxisPose to{};
  double feed_mm_s = 0.0;             // without the override; 0: as fast as the axes can
  std::vector<OutOfTravel> beyond{};  // none: it stays inside
  double into_part_mm = 0.0;          // how deep it goes into the part, where that is known
};

// How a run is entered.
struct EntryOrder {
  std::string machine_state{};  // of the machine that stands there now, as Standing::Save gives it
  double override_percent = 100.0;
  ApproachWay way = ApproachWay::kSafe;
  bool halt_at_entry = false;  // before the step is begun, until START
};

// Told by a run right before each step, and before OnStep.
class StepWatcher {
 public:
  virtual ~StepWatcher() = default;
  virtual void OnStepDue(const StepFacts& facts) = 0;
};

// The side of a Run that lets it be entered at a step: one run goes there with nobody looking and
// halts; another one of an equal setup is given its snapshot, and is entered (Enter) where the
// machine stands. The time of a run goes on from there, so that timers have what they had left.
class EnterableRun {
 public:
  virtual ~EnterableRun() = default;

  // The run halts before it, where the machine stands: at the target of the move before, which no
  // /FLY passes then. reached() tells of it. Before the first Advance. Errors: CellStepUnreachable
  // for what a program of this kind never comes to.
  virtual Status HaltBefore(const StepTarget& target) = 0;
  // It goes on as if nobody had asked for that.
  virtual void ForgetTarget() = 0;
  virtual const std::optional<StepFacts>& reached() const = 0;

  // `watcher` outlives the run; null: none. No part of a snapshot.
  virtual void WatchSteps(StepWatcher* watcher) = 0;

  // All that it is at, for people and to be compared, by the names of Standing::items.
  virtual std::vector<StateItem> items() const = 0;

  // The way from where that machine stands to where this run does. Precondition: the state is one
  // of this machine; reached().
  virtual std::vector<ApproachMotion> PlanApproach(std::string_view machine_state,
                                                   ApproachWay way) const = 0;

  // Whether ApproachWay::kDirect is one of this machine.
  virtual bool may_enter_directly() const { return false; }

  // The machine stands where the order says, with its inputs, its door and its outputs; all else is
  // as this run has it. It approaches as a phase of the run (RunState::approaching), then outputs
  // are switched to what they are there, and the step begins. Precondition: as PlanApproach, whose
  // motions stay inside their travel.
  virtual void Enter(const EntryOrder& order) = 0;
};

}  // namespace rmlcell::machine
