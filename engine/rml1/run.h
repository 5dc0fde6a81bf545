#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "engine/machine/run.h"
#include "engine/rml1/device.h"
#include "engine/rml1/physical.h"
#include "engine/rml1/timing.h"

namespace rmlcell::rml1 {

// One stream through one device in virtual time. The sender hands over a byte whenever the device
// has nothing to do, and while it is paused as many as its buffer takes; so nothing of the program
// is held but the byte in hand (RML1-9.06).
//
// Keys: START resumes !NR, a pause at the edge of the range, HOLD and STOP. HOLD lets the motion or
// wait in progress end; STOP brakes on the path at once and goes on from there; an emergency stop
// freezes the run, which then ends as STOPPED. Errors of the program never end it (RML1-6.08).
class MillRun final : public machine::Run {
 public:
  // Errors: CellUnimplemented for a dry run up to a step or mode REPEAT, which a mill does not
  // have; CellParameterRange; CellBadText for a machine state that is none.
  static Result<std::unique_ptr<MillRun>> Make(machine::RunSetup setup,
                                               machine::RunObserver& observer);

  machine::RunPhase Advance(SimTime until) override;
  void Apply(const machine::InputChange& input) override;
  void End(machine::OutcomeKind kind, ErrorCode code) override;
  machine::RunState state() const override;
  const machine::Outcome& outcome() const override { return state_.outcome; }
  std::uint64_t steps_executed() const override { return state_.device.commands_done(); }
  std::optional<std::string> ReadVariable(std::string_view name) const override;
  std::vector<machine::Figure> figures() const override;
  std::string SaveMachine() const override;
  std::unique_ptr<machine::RunSnapshot> Save() const override;
  void Restore(const machine::RunSnapshot& snapshot) override;

 private:
  // Bytes of the stream that one call of Advance reads at most, whatever time they take, so that
  // whoever runs a file of nonsense hears of it every tenth of a second.
  static constexpr std::size_t kBytesPerAdvance = std::size_t{1} << 20;

  enum class Busy : std::uint8_t { kNothing, kMotion, kWait };
  enum class HaltCause : std::uint8_t { kNone, kPause, kHold, kStop, kSingle, kBreakpoint };

  // A motion under way. A STOP or an override cuts it into legs: the one that runs now and up to
  // one more behind it.
  struct Motion {
    Action action;
    Point from;
    bool first_leg = true;
    double feed_mm_s = 0.0;
    motion::PlannedMotion leg;
    bool stopping = false;  // the leg is a ramp to rest, and something is left behind it
    bool joins = false;     // a planner with look-ahead would not have stopped before it
  };

  // Everything that changes: a snapshot is a copy.
  struct State {
    explicit State(std::shared_ptr<const Profile> machine_profile)
        : profile(std::move(machine_profile)), device(*profile), physical(*profile) {}

    std::shared_ptr<const Profile>
        profile;  // of device and physical: a snapshot may outlive the run
    Device device;
    Physical physical;
    std::size_t cursor = 0;  // bytes handed to the device
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
    Point tool;                   // where it stands, or the motion began
    Chain chain = Chain::kAlone;  // of the last motion, when nothing came after it

    HaltCause halt = HaltCause::kNone;
    SimTime halted_at{0};
    HaltCause halt_wanted = HaltCause::kNone;  // at the next standstill
    SimTime wait_left{0};                      // of a wait that STOP interrupted
    std::uint64_t commands_seen = 0;
  };
  class Snapshot;
  class Listener;

  MillRun(machine::RunSetup setup, std::shared_ptr<const Profile> profile,
          machine::RunObserver& observer);

  // run.cc: the course of time.
  SimTime NextInputTime() const;
  void Proceed(std::size_t bytes_max);
  void Interpret(std::size_t bytes_max);
  void FeedOneByte(DeviceListener& listener);
  void Finish();
  void Handle(const machine::InputChange& input);
  void Freeze();
  void PressStart();
  void PressStop();
  void BeginHalt(HaltCause cause);
  void EndHalt();
  void CloseWith(machine::OutcomeKind kind, std::optional<ErrorCode> code, std::string detail);
  void FillBuffer();
  std::string_view stream() const;

  // run_motion.cc: one action after the other.
  void Begin(const Action& action);
  void BeginMotion(const Action& action);
  void BeginWait(machine::WaitKind kind, double seconds);
  void StartLeg();
  void EndBusy();
  void EndLeg();
  void ReportLeg(double travelled);
  void EndWait();
  void CutMotion(bool stop);
  void ResumeMotion();
  double ElapsedInLeg() const;
  Point ToolAt(const motion::TipPose& pose) const;
  motion::TipPose TipNow() const;
  void EmitSignal(machine::Signal signal, double value, double detail);

  const Profile& profile() const { return *state_.profile; }
  bool SpindleTurns() const;

  const machine::RunSetup setup_;
  machine::Bytes program_;
  machine::RunObserver& observer_;
  State state_;
};

}  // namespace rmlcell::rml1
