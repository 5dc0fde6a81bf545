#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/machine/run.h"
#include "engine/machine/step_entry.h"
#include "engine/motion/ride/path_ride.h"
#include "engine/rml1/device.h"
#include "engine/rml1/look_ahead.h"
#include "engine/rml1/physical.h"
#include "engine/rml1/scout.h"
#include "engine/rml1/sender.h"
#include "engine/rml1/timing.h"

namespace rmlcell::rml1 {

// One stream through one device in virtual time. The sender hands over a byte whenever the device
// has nothing to do, and while it is paused as many as its buffer takes; so nothing of the program
// is held but the byte in hand (RML1-9.06).
//
// The device acts in virtual time: a command is told, and changes what there is to see, when its
// turn comes, while the tool may pass from one motion to the next without standing. How fast it
// passes is known from a second device that reads the same stream ahead (scout.h, look_ahead.h).
//
// Keys: START resumes !NR, a pause at the edge of the range, HOLD and STOP. HOLD lets the motion or
// wait in progress end, and where the tool is too fast for that as many motions as it takes; STOP
// brakes on the path at once and goes on from there; an emergency stop freezes the run, which then
// ends as STOPPED. Errors of the program never end it (RML1-6.08).
class MillRun final : public machine::Run, public machine::EnterableRun {
 public:
  // Errors: CellUnimplemented for a dry run up to a step or mode REPEAT, which a mill does not
  // have; CellParameterRange; CellBadText for a machine state that is none.
  static Result<std::unique_ptr<MillRun>> Make(machine::RunSetup setup,
                                               machine::RunObserver& observer);

  machine::RunPhase Advance(SimTime until) override;
  void Apply(const machine::InputChange& input) override;
  void Stand(SimTime until) override;
  void MoveTo(const motion::AxisPose& axes) override;
  Status SwitchSpindle() override;
  void SetMode(machine::Mode mode) override;
  void End(machine::OutcomeKind kind, ErrorCode code) override;
  machine::RunState state() const override;
  const machine::Outcome& outcome() const override { return state_.outcome; }
  std::uint64_t steps_executed() const override { return state_.device.commands_done(); }
  std::optional<machine::VariableValue> ReadVariable(std::string_view name) const override;
  void SetBreakpoints(const std::vector<machine::Breakpoint>& breakpoints) override;
  std::vector<machine::Place> stack() const override { return {state_.place}; }
  std::vector<machine::ModalValue> modal_values() const override;
  std::vector<machine::Figure> figures() const override;
  std::string SaveMachine() const override;
  std::unique_ptr<machine::RunSnapshot> Save() const override;
  void Restore(const machine::RunSnapshot& snapshot) override;

  // run_entry.cc
  machine::EnterableRun* enterable() override { return this; }
  Status HaltBefore(const machine::StepTarget& target) override;
  void ForgetTarget() override;
  const std::optional<machine::StepFacts>& reached() const override { return state_.reached; }
  void WatchSteps(machine::StepWatcher* watcher) override { step_watcher_ = watcher; }
  std::vector<machine::StateItem> items() const override;
  std::vector<machine::ApproachMotion> PlanApproach(std::string_view machine_state,
                                                    machine::ApproachWay way) const override;
  void Enter(const machine::EntryOrder& order) override;

 private:
  // Bytes of the stream that one call of Advance reads at most, whatever time they take, and reads
  // ahead at most, so that whoever runs a file of nonsense hears of it every tenth of a second.
  static constexpr std::size_t kBytesPerAdvance = std::size_t{1} << 20;

  // Of a stream that still comes: so many are waited for, then what they make it do is done.
  static constexpr std::size_t kBytesAwaited = std::size_t{1} << 14;

  // Commands, likewise: whoever drives a machine that lives looks at its inputs between. LIVE-3.12
  static constexpr std::uint64_t kCommandsPerAdvance = 20'000;

  enum class Busy : std::uint8_t { kNothing, kMotion, kWait };
  enum class HaltCause : std::uint8_t { kNone, kPause, kHold, kStop, kSingle, kBreakpoint, kEntry };

  // The motion in progress. It is ridden in legs: one, but for a STOP or an override on the way.
  // Between two legs, and until the first is known, none is under way: the tool passes there.
  struct Motion {
    Action action;
    Point from;
    bool first_leg = true;
    bool approach = false;
    LookAhead::Leg leg;
  };

  // Everything that changes: a snapshot is a copy.
  struct State {
    explicit State(std::shared_ptr<const Profile> machine_profile)
        : profile(std::move(machine_profile)),
          device(*profile),
          physical(*profile),
          scout(device),
          ahead(*profile, device.carriage().physical(), 100.0) {}

    std::shared_ptr<const Profile>
        profile;  // of device and physical: a snapshot may outlive the run
    Device device;
    Physical physical;
    Sender sender;
    Scout scout;
    LookAhead ahead;
    motion::PathRide ride{motion::HoldRamp::kPlannedAnew};  // the leg under way
    std::size_t next_input = 0;
    VirtualClock clock;
    SimTime now{0};
    machine::RunPhase phase = machine::RunPhase::kRunning;
    machine::Outcome outcome;
    machine::Place place;
    LineCounter lines;
    double override_percent = 100.0;

    Busy busy = Busy::kNothing;
    SimTime busy_from{0};
    SimTime busy_until{0};
    Motion motion;
    bool rest_left = false;  // of a motion that STOP interrupted: it goes on at the next START
    machine::WaitKind wait_kind = machine::WaitKind::kDwell;
    Point tool;  // where it stands, or the leg began

    CommandHalts halts;
    HaltCause halt = HaltCause::kNone;
    SimTime halted_at{0};
    HaltCause halt_wanted = HaltCause::kNone;  // at the next standstill
    SimTime wait_left{0};                      // of a wait that STOP interrupted
    std::uint64_t commands_seen = 0;
    SimTime instant{-1};                // when a command was over last
    std::uint64_t commands_before = 0;  // done before that instant
    bool time_stands = false;           // too many at one instant: it fails where it comes to rest
    int command_over = 0;               // the last one that is over

    std::optional<machine::StepFacts> reached;  // it halted before the command of halts.entry
    // The way to the command where the run begins, while approaching: what is to come of it.
    bool approaching = false;
    SimTime approach_begun{0};
    SimTime approached{0};  // how long it took
    std::deque<Action> approach;
    bool halts_at_entry = false;
    bool step_over = false;        // a motion of it, after which SINGLE halts
    bool spindle_to_come = false;  // the device has it turning, and it does not yet
    bool spindle_stopped = false;  // likewise, and a person has stopped it, or the cover
    bool stopped_by_cover = false;
    bool cover_open = false;    // of a mill whose cover stops its runs
    std::optional<Point> away;  // halted: where VIEW has taken the tool
  };
  class Snapshot;
  class Listener;

  MillRun(machine::RunSetup setup, std::shared_ptr<const Profile> profile,
          machine::RunObserver& observer);

  void PutTool();

  // run_entry.cc
  machine::StepFacts FactsBefore(const machine::Place& place) const;
  void HaltAtTarget();
  void GoOnApproaching();

  // run.cc: the course of time.
  SimTime NextInputTime() const;
  void Proceed(std::size_t sent_max);
  bool TimeStands() const;
  bool MayYetHalt() const;
  void Interpret(std::size_t sent_max);
  void Finish();
  void Handle(const machine::InputChange& input);
  void Freeze();
  void PressStart(bool spindle);
  void PressHold();
  void HaltBehindMotion(HaltCause cause);
  void PressStop();
  void ChangeOverride(double percent);
  static machine::HaltReason ReasonOf(HaltCause cause);
  void BeginHalt(HaltCause cause);
  void EndHalt(bool spindle);
  void TurnSpindle();
  void MoveCover(bool open);
  void StopBehindCover();
  void CloseWith(machine::OutcomeKind kind, std::optional<ErrorCode> code, Detail detail);
  std::string_view stream() const;
  std::size_t Await();

  // run_motion.cc: one action after the other.
  void Begin(const Action& action);
  void BeginMotion(const Action& action);
  void BeginWait(machine::WaitKind kind, double seconds);
  bool PlanLeg(std::size_t sent_max);
  void StartLeg();
  void EndBusy();
  void EndLeg();
  void LeaveLeg(const motion::PathState& along);
  void EndMotion(double speed);
  void ReportLeg(double travelled);
  void EndWait();
  void PlanAnew();
  void ResumeMotion();
  bool Moves() const { return state_.busy == Busy::kMotion || state_.ahead.speed() > 0.0; }
  Point ToolAt(const motion::TipPose& pose) const;
  motion::TipPose TipNow() const;
  void EmitSignal(machine::Signal signal, double value, double detail);

  const Profile& profile() const { return *state_.profile; }
  bool SpindleTurns() const;

  const machine::RunSetup setup_;
  machine::Bytes program_;
  std::size_t released_ = 0;  // bytes that were read up to the last release
  machine::RunObserver& observer_;
  machine::StepWatcher* step_watcher_ = nullptr;
  State state_;
};

}  // namespace rmlcell::rml1
