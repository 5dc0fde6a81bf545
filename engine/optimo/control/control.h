#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/optimo/control/control_state.h"
#include "engine/optimo/language/evaluate.h"

namespace rmlcell::optimo {

// The control (CRG): fetches instructions and carries them out in virtual time.
//
// Between two /FLY moves the program runs ahead of the motion, through instructions that need no
// standstill (OPT-2.49); what they change outside is told as an Effect when the tip passes the
// corner. Everything else waits until the motion is over. Time passes in Advance only.
class Control : private VariableAccess {
 public:
  // Instructions that one Advance carries out at most, so that its caller can look around even when
  // a program never lets time pass.
  static constexpr int kStepsPerAdvance = 20'000;

  Control(OptimoParameters parameters, machine::RunSetup setup, machine::RunObserver& observer);

  machine::RunPhase Advance(SimTime until);
  void Apply(const machine::InputChange& input);
  void End(machine::OutcomeKind kind, ErrorCode code);

  machine::RunState Snapshot() const;
  std::optional<std::string> ReadVariable(std::string_view name) const;

  const ControlState& state() const { return s_; }
  void Restore(const ControlState& state) { s_ = state; }

 private:
  // --- control.cc: start, time, inputs, halts ---
  void StartMain();
  bool MayFetch() const;
  void Fetch();
  bool WaitsForEver() const;
  SimTime NextEvent(SimTime until) const;
  void LetTimePass(SimTime to);
  void ActOnTime();
  void ApplyScripted();
  void Halt(std::string_view why);
  void HaltOnPath();
  machine::Place PlaceOfMotion() const;
  void CloseBehindDoor();
  void TellWait();
  SimTime After(double seconds) const;
  SimTime TickAfter(double seconds) const;
  void CountExecution(int slot);
  void Resume();
  void TellHalt();
  void EmergencyStop();
  void BreakOff(machine::OutcomeKind kind, ErrorCode code, std::string detail);
  void Finish(machine::OutcomeKind kind, std::optional<ErrorCode> code, std::string detail);
  SimTime NextTick(SimTime since) const;

  // --- control_motion_time.cc: motions in time ---
  bool Busy() const { return s_.active || !s_.timeline.empty(); }
  void DrainPlanner();
  void StartNextItem();
  void TellMotion(SimTime until);
  void ArriveAtEnd();
  void BeginProfile();
  void GoesOnInBackground(bool background);
  void EndMotionHere();
  bool BringToHalt();
  const MoveNote* NoteOf(std::uint64_t tag) const;
  MoveNote* NoteOf(std::uint64_t tag);
  void StopMotions();
  motion::TipPose TipNow() const;
  motion::AxisPose AxesNow() const;
  double TipSpeedNow() const;
  bool Moving() const;
  bool Watching() const;
  void Unwatch();
  void WatchMove();
  void EndNoMotion();

  // 0: no source is known.
  int LineOf(int slot, std::uint32_t step) const;

  // --- control_override.cc: the feed override changed on the way ---
  struct ChainPlace {
    motion::PlannedMotion motion;
    motion::PathState state;
    bool under_way = false;
  };
  void ChangeOverride(double percent);
  double FractionOf(const MoveNote& note) const;
  void AdaptToOverride(AppendedItem& item);
  // Where a chain that is planned anew goes on: after the way that brings the acceleration to zero,
  // and the speed down where it must.
  struct Onward {
    std::size_t own = 0;         // of s_.appended: the command of that place
    double lead_length = 0.0;    // of that way, by the s of the motion
    double speed = 0.0;          // at its end, by the same s
    double speed_on_move = 0.0;  // by that of the command
    double measure = 1.0;        // s of what is planned anew per s of the motion
    motion::MoveCommand first;   // what is left of the command then
  };
  void AdaptMotions();
  bool ReplanChain();
  std::optional<Onward> OnwardFrom(const ChainPlace& place, const motion::MoveCommand& command,
                                   double speed) const;
  std::optional<motion::Planner> PlanOnward(const Onward& onward,
                                            std::span<const AppendedItem> later) const;
  void GoOnward(const ChainPlace& place, const Onward& onward,
                const std::vector<motion::PlannedItem>& kept);
  bool ReplanFrom(const ChainPlace& place, const std::vector<motion::PlannedItem>& kept);

  // --- control_hold.cc: HOLD inside a chain of passages ---
  const motion::MoveCommand* Appended(std::uint64_t tag) const;
  void EndAtATarget();
  void EndOverManyMoves();
  void HoldBehind(std::uint64_t tag, const std::vector<motion::PlannedItem>& kept);
  void HoldAllBehind(std::uint64_t target);
  void PlanHeld();

  // --- control_motion.cc: what MOVE and its kin do ---
  void Move(const Instruction& i);
  std::optional<motion::TipPose> Target(const Instruction& i, bool via);
  bool AppendMotion(const motion::PathPiece& path, const Instruction& i, const MoveNote& note,
                    bool settles);
  bool NeverMoves() const;
  motion::TipPose FromProgram(const std::array<double, 5>& values) const;
  bool GoesNowhere(const Instruction& i);
  void NotUnderWay(const Instruction& i);
  bool MoveHole(const Instruction& i, const motion::TipPose& from, const motion::TipPose& target,
                MoveNote note);
  void WatchAndGoOn(const Instruction& i, std::uint64_t first_tag, bool ran_ahead);
  void SetCoord(CoordType coord);
  void SetPath(const Instruction& i);
  void SetPercent(const Instruction& i);
  void SetWorkOffset(const Instruction& i);
  void SetTool(const Instruction& i);
  void ZeroAxes();
  void TellZeroed(int group);
  motion::Head HeadNow() const;

  // --- control_travel.cc: what the axes cannot do ---
  bool InTravel(const motion::PathPiece& path, MoveNote& note);
  std::vector<BeyondTravel> BeyondTravelOf(const motion::PathPiece& path) const;
  void TellViolations(const machine::Place& place, const std::vector<BeyondTravel>& beyond);
  void FailOfViolations();
  void TellSpeedHeld(const motion::PlannedMotion& motion, const MoveNote& note);

  // --- control_work.cc: WORK, also while the program goes on ---
  // At the passage that the program has run ahead to, or now: a WORK that goes on in the
  // background.
  enum class When { kPassage, kNow };
  void DefineWork(const Instruction& i);
  void Work(const Instruction& i);
  void SwitchWork(WorkTask task, bool dwell_in_background, When when);
  bool WorkOn(const WorkTask& task, bool dwell_in_background, When when);
  void WorkOff(int kind, int process, When when);
  void DropTasks(int kind, int process);
  SimTime NextTask() const;
  void RunTasks();
  bool RunTask(std::size_t n);
  void MarkTasks();

  // --- control_process.cc: laser, outputs ---
  bool SelectSchedule(int number, When when);
  double SchedulePower() const;
  void Show(PassageEffect effect, When when = When::kPassage);
  void Carry(const PassageEffect& effect);
  void TakeEffect(const PassageEffect& effect);
  void BeamOn(const machine::PowerBySpeed& power);
  void BeamOff();
  void OpenShutter();
  void CloseShutter();
  void SuspendBeam();
  bool SetOutput(int index, bool on);
  void ConnectOutputs(std::uint8_t groups);
  void TellSignal(machine::Signal signal, int index, double value, double detail = 0.0);

  // --- control_flow.cc: instructions and jumps; control_calls.cc; control_errors.cc ---
  void Execute(const Instruction& i);
  bool NeedsStandstill(const Instruction& i);
  static bool WaitsForNext(const Instruction& i, bool main);
  bool MakeDueGosub();
  bool LetPollingTakeTime(const Instruction& i, std::uint32_t at);
  void Jump(int label);
  void Gosub(int label);
  void Return();
  void EndModule();
  void EndProgram();
  void RepeatMain();
  void CallFunction(const Instruction& i);
  void CallProgram(const Instruction& i);
  void GoTo(const Instruction& i);
  std::optional<Loaded> Acquire(int slot, bool must_be_executable);
  bool HasRoomFor(std::size_t bytes) const;
  void Begin(Loaded program, const std::array<float, kParameterCount>& parameters);
  std::optional<int> ProgramNumber(Expression expression);
  bool PassParameters(const Instruction& i, const Module& callee,
                      std::array<float, kParameterCount>& out);
  void Pause(std::string_view name);
  void SetTimer(const Instruction& i);
  void Wait(Pending pending);
  void Raise(ErrorCode code, std::string detail = {});
  void HandleError(const Error& error);
  void FailWithoutHandler(int label);
  void Tell(const Diagnostic& finding);
  bool Allowed(const Diagnostic& finding) const;
  void Warn(ErrorCode code, std::string detail, std::string_view rule);
  void WarnAt(const machine::Place& place, ErrorCode code, std::string detail,
              std::string_view rule);

  // --- control_data.cc: variables ---
  float Read(Variable variable) override;
  bool Write(Variable variable, float number);
  void Let(const Instruction& i);
  void Assign(const Instruction& i);
  void SetGroups(const Instruction& i);
  std::optional<Value> Eval(Expression expression);
  std::optional<double> Real(Expression expression);
  std::optional<bool> Truth(ExprRange expression);
  std::optional<bool> Truth(const Condition& condition);
  ExprRange RangeOf(Expression expression) const;
  Condition ConditionOf(Expression expression) const;
  double InputNow(VariableGroup group, int index) const;
  bool Connected(std::uint8_t group) const;

  ProgramContext& program() { return s_.programs.back(); }
  const ProgramContext& program() const { return s_.programs.back(); }
  Frame& frame() { return program().frames.back(); }
  const Frame& frame() const { return program().frames.back(); }
  const LinkedModule& linked() const {
    return program().program->executable.modules[static_cast<std::size_t>(frame().module)];
  }
  const Module& module() const { return linked().module; }
  const ModuleIndex& index() const {
    return program().program->index[static_cast<std::size_t>(frame().module)];
  }
  Modal& modal() { return program().modal; }
  const Modal& modal() const { return program().modal; }
  bool simulating() const { return s_.simulated.active; }

  OptimoParameters parameters_;
  machine::RunSetup setup_;
  std::array<const machine::SourceNotes*, kSlotMax + 1> sources_{};  // null: not known
  machine::RunObserver& observer_;
  ControlState s_;
};

}  // namespace rmlcell::optimo
