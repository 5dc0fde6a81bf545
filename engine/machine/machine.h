#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/units.h"
#include "engine/machine/family.h"
#include "engine/machine/hand_jog.h"
#include "engine/machine/hand_motion.h"
#include "engine/machine/handbox.h"
#include "engine/machine/machine_input.h"
#include "engine/machine/machine_note.h"
#include "engine/machine/machine_states.h"
#include "engine/machine/machine_status.h"
#include "engine/machine/observer.h"
#include "engine/machine/outputs.h"
#include "engine/machine/panel.h"
#include "engine/machine/run.h"
#include "engine/machine/standing.h"
#include "engine/machine/start_preview.h"

namespace rmlcell::machine {

// The programs of a machine and what belongs to them.
struct MachineMemory {
  std::map<int, StoredProgram> programs{};  // by slot 1..99
  // Slots that held a program once and are empty now: deleting counts as altering (OPT-1.13).
  std::set<int> deleted{};
  std::vector<LaserSchedule> schedules{};  // stored; the others are as the machine has them
};

// What runs left in the memory: the executable of an object, at slot + 100 (OPT-1.11).
struct MadeExecutable {
  int slot = 0;
  std::string bytes{};
};

// What a key of the handbox did.
struct KeyAnswer {
  std::optional<ErrorCode> message{};  // what the control says: it did nothing, or warns
  int beeps = 0;
  // A program is to be changed. The caller stores it, then applies StoreProgram with the object, or
  // DeleteProgram; or RefuseEdit, when that cannot be. LIVE-7.08
  std::optional<ProgramEdit> edit{};
};

// A run that is over.
struct RunOver {
  RunNote run{};
  Outcome outcome{};
  SimTime lasted{0};
  SimTime worked{0};  // without what lies before the step where it began, and the way there
  std::uint64_t steps = 0;
  std::vector<Figure> figures{};
  std::unique_ptr<Run> ended{};  // itself, as it ended: for who makes a report of it
};

enum class Progress {
  kReached,   // the time that was asked for
  kMoreWork,  // not yet: call again
};

// A machine that lives between runs, of whatever family: it stands, is started, held and changed by
// inputs, and keeps what a run leaves. Its time goes on in every state; a run inside it is the same
// Run that a simulation drives, in its own time, and no budget ends it. Deterministic: the same
// inputs at the same times give the same, however the caller divides time. One thread at a time.
class Machine {
 public:
  // `state`: of Save; none: a new machine, in REMOTE. `observer` is told of runs, by the time of
  // each; it outlives this. Errors: those of MachineFamily::NewStanding, CellBadText.
  static Result<std::unique_ptr<Machine>> Make(const MachineFamily& family, Parameters parameters,
                                               MachineMemory memory, std::string_view state,
                                               RunObserver& observer);

  // Precondition: not before time().
  Progress Advance(SimTime until);

  // At the present time. Refused, and nothing has changed:
  //   CellMachineState   the state does not allow it; the detail says what is possible
  //   CellMode           the mode or the source does not
  //   NotZeroed          START with axes that have no reference
  //   the alarm's own    START and RESUME while there is one
  //   CellNotLive        it is off, or has no such keys
  //   CellDoorOpen       a jog key or one of the panel that moves something, with the cover open
  //   CellDisplaced      RESUME of a run whose machine keys have moved; the detail has how far
  //   CellStepUnreachable, CellApproach   a start at a step; the detail has the nearest clean steps
  //   CellInvalidArgument, ProgramMissing and the like: what the input names is none
  Status Apply(const MachineInput& input);

  // Of a PressedKey, with what the key did. What the control itself refuses is no error, but a
  // message. Errors: CellInvalidArgument, no such key; CellNotLive, it is off or has no handbox.
  // LIVE-7.10
  Result<KeyAnswer> PressKey(std::string_view key, KeyAction action = KeyAction::kTap);

  const MachineFamily& family() const { return family_; }
  bool has_handbox() const { return handbox_ != nullptr; }
  // What a key asked for is not over: what was taught is being stored, or an axis that was let go
  // does not stand yet. Other keys do nothing until then.
  bool settles() const;
  // Something is half entered at its handbox.
  bool has_open_mask() const { return handbox_ != nullptr && handbox_->has_open_mask(); }
  bool has_gates() const { return has_handbox(); }  // a control of that kind has both
  // Inputs, and variables that may be written.
  bool has_inputs() const { return family_.HasVariable(parameters_, "IL[0]"); }

  // What a start at a step would do, and why it would be refused. It takes as long as the run to
  // the step does; StartAtStep, too. Errors: as Apply, of what the input names.
  // `part`: what its way is looked at against; null: nobody knows it.
  Result<StartPreview> Preview(const StartAtStep& input, const ReachLimits& limits = {},
                               PartOnTable* part = nullptr, const PartSoFar& so_far = {}) const;

  // Whether it may be begun now, as far as the machine goes. Errors: as Apply.
  Status MayBegin(const StartAtStep& input) const { return MayStartAt(input); }

  // The how manieth pass through its step the run of its base was in at this time. Errors: as
  // Preview.
  Result<std::uint64_t> OccurrenceAt(const StartAtStep& input, SimTime time,
                                     const ReachLimits& limits = {}) const;

  SimTime time() const { return now_; }
  MachineState state() const;
  MachineStatus status() const;
  // When a jog key is let go, at the present override, of axes that are at their speed; `reference`
  // and `fast` as in PressJog. None: it has no keys.
  std::optional<RunOn> run_on(JogReference reference = JogReference::kRobot,
                              bool fast = false) const;
  Panel panel() const;  // what is to be seen at the machine itself
  const MachineMemory& memory() const { return memory_; }
  // Whether a door or cover that opens now brings a run to rest. OPT-B.34, DEV-3.12
  bool DoorStops() const {
    return !family_.info().cover_stops_jog || standing_->cover() == CoverAct::kPause;
  }
  // Slots of the memory that the open run is in: what was started, and what called each other from
  // there.
  std::set<int> loaded_programs() const;
  // What START without a program takes; 0: none. Of a run whose program came along what was
  // selected before.
  int selected_program() const {
    return run_ != nullptr && of_a_job_ ? shown_.program : status().shown.program;
  }

  // Errors: those of WriteVariable.
  Status MayWrite(std::string_view name, double value) const {
    return family_.CheckWrite(parameters_, name, value);
  }

  // "VR[5]" -> "7.0"; nothing for what is no variable of this machine.
  std::optional<VariableValue> ReadVariable(std::string_view name) const;
  MachineOutputs outputs() const;
  const Run* open_run() const { return run_.get(); }  // null: none is open
  // What the open run began with and what came since, so that it can be simulated again; none: no
  // run of a program is open, or more came than is kept.
  const std::optional<StartBase>& base() const { return base_; }
  // What a run would begin with now.
  StartBase BaseOfNow() const;
  SimTime base_time() const;         // where it is, by the time of these inputs
  std::vector<Place> stack() const;  // of the open run, that in execution last; else nothing
  std::vector<ModalValue> modal_values() const;
  // Whether acknowledging it does something: its cause is gone.
  bool MayAcknowledge(const Alarm& alarm) const;
  const std::vector<Breakpoint>& breakpoints() const { return breakpoints_; }
  // Up to where the open run is dry, or the next one will be.
  std::optional<ProgramStep> simulation_until() const;
  const std::array<int, kGates>& gates() const { return gates_; }

  // Runs that ended and executables that were made since the last call.
  std::vector<RunOver> TakeRunsOver() { return std::exchange(over_, {}); }
  std::vector<MadeExecutable> TakeMadeExecutables() { return std::exchange(made_, {}); }

  // What it keeps, whatever it is doing: axes, variables, images, mode, override, alarms. An open
  // run is not in it: it is never continued from its middle. Versioned bytes.
  std::string Save() const;

 private:
  Machine(const MachineFamily& family, Parameters parameters, MachineMemory memory,
          RunObserver& observer);

  // One for each kind of MachineInput.
  Status Act(const StartRun& input);
  Status Act(const ZeroAxes& input);
  Status Act(const ResumeRun& input);  // machine_held.cc
  Status Act(const HoldRun& input);
  Status Act(const StopRun& input);
  Status Act(const AbortRun& input);
  Status Act(const EmergencyStop& input);
  Status Act(const Acknowledge& input);
  Status Act(const ChangeMode& input);
  Status Act(const ChangeOverride& input);
  Status Act(const ChangeInput& input);
  Status Act(const MoveDoor& input);
  Status Act(const SwitchPower& input);
  Status Act(const WriteVariable& input);
  Status Act(const SetBreakpoints& input);
  Status Act(const SetSimulation& input);
  Status Act(const StoreProgram& input);
  Status Act(const DeleteProgram& input);
  Status Act(const SetSchedules& input);
  Status Act(const ClearMessage& input);
  Status Act(const PressJog& input);
  Status Act(const ReleaseJog& input);
  Status Act(const ReleaseJogs& input);
  Status Act(const StartAtStep& input);  // machine_start_at.cc
  Status Act(const PressPanel& input);   // machine_panel.cc
  Status Act(const PressedKey& input);
  Status Act(const RefuseEdit& input);
  Status Act(const SetGates& input);  // machine_gates.cc
  Status Act(const PressGate& input);

  StateGuards guards() const;
  Error Refusal(ErrorCode code) const;
  Status MayStart(const StartRun& input) const;
  Status Begin(const StartRun& input, Mode mode, std::optional<HandRun> hand = {});
  Status MayStartAt(const StartAtStep& input) const;
  RunSetup SetupTo(const StartAtStep& input) const;
  Status Enter(const StartAtStep& input, const StartPreview& preview);
  void EndByHand(const Outcome& outcome);
  Place OfMemory(const Place& place) const;
  Status MayJog(const JogKey& key) const;
  std::unique_ptr<Standing> StandingOfRun() const;
  std::optional<HandMotion> ByHand(bool fast) const;
  void MoveTo(const motion::AxisPose& axes);
  Status MayGoOn(const ResumeRun& input) const;
  Status SendByHand(const RunByHand& asked);
  Status MayPress(PanelKey key) const;
  void SendTo(PanelKey key);
  void AskJog();
  void AdvanceJog(SimTime until);
  Status MaySource(StartSource source) const;
  void ToRun(InputKind kind, int index = 0, double value = 0.0);
  void KeepForBase(const InputChange& change);
  void Hold();
  void Halt(InputKind key);
  bool CoverStops() const;
  void Raise(ErrorCode code, Detail detail, const Place& place);
  void Show(ErrorCode code);
  void Settle();
  void CloseRun();
  Status Take(MachineNote note);
  MachineView View() const;
  void Select(ShownStep shown);
  void SelectProgram();
  Status MayMoveByHand(bool manual) const;
  Status BeginByHand(const RunByHand& asked);
  bool Pauses() const { return note_.by_hand && note_.hand == HandRun::kFunction; }
  double OverrideOf(std::optional<HandRun> hand) const;
  bool EndEdit(int slot, std::string_view object);
  void ShowAgain(int slot);

  const MachineFamily& family_;
  const Parameters parameters_;
  MachineMemory memory_;
  RunObserver& observer_;

  SimTime now_{0};
  bool on_ = true;
  bool emergency_ = false;   // the key is down
  bool cover_open_ = false;  // of a machine whose cover stops the jog keys
  Mode mode_ = Mode::kRemote;
  double override_percent_ = 100.0;
  std::vector<Breakpoint> breakpoints_;
  std::optional<ProgramStep> simulation_;
  std::vector<Alarm> alarms_;
  std::int64_t last_alarm_ = 0;
  ShownStep shown_{};                   // what the last run left, or was selected since
  bool selected_ = false;               // while the open run stands
  bool selected_program_ = false;       // likewise, and a program
  bool comes_along_ = false;            // the program of the open run is not of the memory
  bool of_a_job_ = false;               // the open run is: nobody here has selected its program
  std::optional<ErrorCode> message_;    // not cleared yet
  RunNote note_{};                      // of the run that was begun last
  std::optional<StartBase> base_{};     // of the open run
  std::optional<SimTime> halted_at_{};  // in its time; it stands since
  SimTime not_in_base_{0};              // of halts that whoever simulates it does not come to
  std::array<int, kGates> gates_{};     // programs that they start
  std::unique_ptr<Standing> standing_;
  std::unique_ptr<Handbox> handbox_;         // null: it has none
  HandJog jog_;                              // moves nothing while a run goes on
  std::unique_ptr<Run> run_;                 // open
  bool stopping_ = false;                    // a HOLD or STOP of this run has not halted it yet
  bool resume_behind_ = false;               // it was taken back meanwhile: START follows the halt
  bool abort_behind_ = false;                // the run is over once it stands
  bool goes_home_ = false;                   // behind ZERO
  std::optional<motion::AxisPose> held_at_;  // of the run, and keys have moved it since
  std::optional<motion::AxisPose> viewed_from_;  // by VIEW, which goes back there
  std::set<int> changed_;  // slots whose programs were changed while a run is open
  std::vector<RunOver> over_;
  std::vector<MadeExecutable> made_;
};

}  // namespace rmlcell::machine
