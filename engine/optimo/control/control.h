#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/optimo/control/control_state.h"
#include "engine/optimo/control/flow.h"
#include "engine/optimo/control/plain_steps.h"
#include "engine/optimo/machine/system_cycle.h"
#include "engine/optimo/machine/telling.h"

namespace rmlcell::optimo {

// The control (CRG): fetches instructions and orders the parts that carry them out in virtual time.
//
// Between two /FLY moves the program runs ahead of the motion, through instructions that need no
// standstill (OPT-2.49); what they change outside happens when the tip passes the corner.
// Everything else waits until the motion is over. Time passes in Advance only.
class Control final : private RideListener {
 public:
  // Instructions that one Advance carries out at most, so that its caller can look around even when
  // a program never lets time pass.
  static constexpr int kStepsPerAdvance = 20'000;

  Control(OptimoParameters parameters, machine::RunSetup setup, machine::RunObserver& observer);
  Control(const Control&) = delete;
  Control& operator=(const Control&) = delete;

  machine::RunPhase Advance(SimTime until);
  void Apply(const machine::InputChange& input);
  void End(machine::OutcomeKind kind, ErrorCode code);
  void Stand(SimTime until);
  // On its way to a step it may not: that way is the one that was looked at.
  Status MayGoOn() const {
    if (now().phase != machine::RunPhase::kHalted || !actuators_.door_blocks_start()) return {};
    return Error{ErrorCode::kShutterInterlock, "close the operator door first", {}};
  }
  bool may_be_moved() const {
    return now().phase == machine::RunPhase::kHalted && !s_.entry.arrival && ride_.may_be_moved();
  }
  void MoveTo(const motion::AxisPose& axes);
  void SetZeroed() { s_.moves.zeroed = s_.actuators.zeroed = true; }
  void SetMode(machine::Mode mode);
  // Of one that is not Writable nothing.
  void WriteVariable(std::string_view name, double value);
  // Precondition: their conditions can be read.
  void SetBreakpoints(const std::vector<machine::Breakpoint>& breakpoints);

  machine::RunState Snapshot() const;
  std::vector<machine::Place> Stack() const;
  std::vector<machine::ModalValue> ModalValues() const;
  // Nothing outside can change the condition that it stands at any more, and no motion either.
  bool WaitsForEver() const;

  const ControlState& state() const { return s_; }
  // What the machine keeps of it, where it is now: in the middle of a motion, too.
  MachineState Kept() const;
  machine::MachineOutputs outputs() const;
  std::vector<machine::Figure> figures() const;
  void Restore(const ControlState& state) { s_ = state; }

  // --- control_entry.cc: a run that begins at a step; machine::EnterableRun has what each does ---
  Status HaltBefore(const machine::StepTarget& target);
  void ForgetTarget();
  void WatchSteps(machine::StepWatcher* watcher) { step_watcher_ = watcher; }
  std::vector<machine::StateItem> Items() const;
  std::vector<machine::ApproachMotion> PlanApproach(const MachineState& now,
                                                    machine::ApproachWay way) const;
  void Enter(const MachineState& now, const machine::EntryOrder& order);

 private:
  // --- control.cc: the course of time ---
  bool MayFetch() const;
  SimTime NextEvent(SimTime until) const;
  SimTime NextOwnEvent(SimTime until) const;
  bool MoveOn();
  void ActOnTime();
  void ActOnPending();
  bool ScriptedIsDue() const;
  void ApplyScripted();
  void PressStart();
  void ChangeOutside();
  void Raise(const Error& error, Alarms::Where where = Alarms::Where::kInstruction);
  void Finish(machine::OutcomeKind kind, std::optional<ErrorCode> code, Detail detail);
  void OnMark(std::uint64_t tag) override { effects_.OnMark(tag); }
  void OnMotionBegins(std::uint64_t tag) override { watch_.OnMotionBegins(tag); }
  void OnMoveOver(std::uint64_t tag) override { watch_.OnMoveOver(tag); }
  void OnMotionTold(const machine::MotionDone& done) override {
    if (!done.approach) process_watch_.OnMotion(done);
  }

  // --- control_fetch.cc: one instruction after the other ---
  int FetchPlain(int most);
  bool OnlyProgram() const;
  void Fetch();
  bool StandFirst();
  void NoteInstant();
  std::uint64_t StepsToGo() const;
  bool MayCarryOut(const Instruction& i);
  bool NeedsStandstill(const Instruction& i);
  void EndSimulation(const machine::Place& here);
  Status Execute(const Instruction& i);
  Status GoTo(const Instruction& i);
  void BeginMain(const Loaded& main, int slot);
  void EndModule();
  void TellLeftOn(const Processes& processes);

  // --- control_entry.cc ---
  machine::StepFacts FactsAt(const machine::Place& here) const;
  bool HaltsBefore(const Instruction& i, const machine::Place& here);
  void NoteStep(const machine::Place& here);
  void NoteTimedGosub();
  void GoOnApproaching();
  Status Append(const ApproachLeg& leg);
  void ArriveAtEntry();

  Situation& now() { return s_.situation; }
  const Situation& now() const { return s_.situation; }

  const OptimoParameters parameters_;
  const machine::RunSetup setup_;
  const SystemCycle cycle_;
  ControlState s_;
  machine::StepWatcher* step_watcher_ = nullptr;

  // From the machine up: each knows those before it.
  Telling telling_;
  Travel travel_;
  Ride ride_;
  Actuators actuators_;
  PassageEffects effects_;
  ProgramCounter counter_;
  DataAccess data_;
  PlainSteps plain_;
  Waits waits_;
  MoveWatch watch_;
  ProcessWatch process_watch_;
  Works works_;
  Halts halts_;
  Moves moves_;
  Flow flow_;
  Alarms alarms_;
};

}  // namespace rmlcell::optimo
