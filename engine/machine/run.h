#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/units.h"
#include "engine/machine/outcome.h"
#include "engine/machine/outputs.h"
#include "engine/machine/run_setup.h"
#include "engine/machine/variable.h"
#include "engine/motion/geometry/pose.h"

namespace rmlcell::machine {

class EnterableRun;  // step_entry.h

enum class RunPhase {
  kRunning,   // `until` was reached
  kHalted,    // waits for START; time stands until a key or input comes
  kFinished,  // outcome() tells how
};

// For people who watch: where the run is now.
struct RunState {
  SimTime time{0};
  RunPhase phase = RunPhase::kRunning;
  Place place{};
  std::string_view instruction{};
  motion::TipPose tip{};
  motion::AxisPose axes{};
  double tip_speed_mm_s = 0.0;
  double override_percent = 100.0;
  bool beam_on = false;
  bool spindle_on = false;
  bool zeroed = true;  // the axes have their reference
  bool door_open = false;
  bool dry = false;                       // up to a step: beam and axes stay as they are
  std::int64_t executions = 0;            // times that the program was carried out whole
  bool approaching = false;               // to the step where the run begins (step_entry.h)
  SimTime approached{0};                  // how long that took
  std::optional<HaltReason> halted_by{};  // in kHalted
  // Program zero in the machine frame, where a program has one: what X 0, Y 0, Z 0 mean now.
  std::optional<motion::MachinePoint> work_origin{};
  double progress = -1.0;  // 0..1 where the length of the program is known, else below 0
};

// A value that stays until another one is given, as the language writes it.
struct ModalValue {
  std::string name{};  // "PATH"
  std::string value{};

  bool operator==(const ModalValue&) const = default;
};

// Opaque copy of a run at one instant.
class RunSnapshot {
 public:
  virtual ~RunSnapshot() = default;
};

// One execution of a program in virtual time. Deterministic and resumable: how the caller divides
// time into calls of Advance changes nothing that the observer is told. One thread at a time.
class Run {
 public:
  virtual ~Run() = default;

  // Goes on until virtual time `until`, a halt, or the end, whichever comes first. A motion that
  // spans `until` is left in the middle. Scripted inputs act at their times. After much work in one
  // call it may come back earlier, with kRunning: call again.
  virtual RunPhase Advance(SimTime until) = 0;

  // An input or key at the present time, as if scripted for it.
  virtual void Apply(const InputChange& input) = 0;

  // Halted: time goes by up to `until`, and nothing happens. Else it changes nothing. A run whose
  // halts take no time leaves it out.
  virtual void Stand(SimTime /*until*/) {}

  // Halted: whether it goes on from wherever keys have moved the machine meanwhile. False: it goes
  // on where it was halted.
  virtual bool may_be_moved() const { return false; }
  // Halted: keys have moved the machine, it stands here now. A run that may be moved goes on from
  // here: what was interrupted to where it was to end, or what comes next.
  virtual void MoveTo(const motion::AxisPose& /*axes*/) {}
  // Halted: the axes have found their reference meanwhile.
  virtual void SetZeroed() {}

  // Halted: a key stops the spindle, or lets it turn again. Stopped so it stays, until the program
  // starts it anew or START comes with the value 1. Errors: CellMachineState.
  virtual Status SwitchSpindle() { return {}; }

  // From the end of the present instruction on; one that the machine does not have changes nothing.
  // Precondition: not MANUAL.
  virtual void SetMode(Mode /*mode*/) {}

  // Ends the run at the present time with beam off, shutter closed: CANCELLED, or a budget of the
  // caller.
  virtual void End(OutcomeKind kind, ErrorCode code) = 0;

  // Of a run that is halted: what START would end it with, for who asks before (OPT-B.56).
  virtual Status MayGoOn() const { return {}; }

  virtual RunState state() const = 0;
  virtual const Outcome& outcome() const = 0;  // meaningful after kFinished
  virtual std::uint64_t steps_executed() const = 0;

  // "VR[5]" -> real "7.0"; nothing when the family has no such variable.
  virtual std::optional<VariableValue> ReadVariable(std::string_view /*name*/) const { return {}; }
  virtual MachineOutputs outputs() const { return {}; }
  // While it is dry: up to this step.
  virtual std::optional<ProgramStep> simulation_until() const { return {}; }
  // At the present time. The family says which may be written (MachineFamily::CheckWrite).
  virtual void WriteVariable(std::string_view /*name*/, double /*value*/) {}

  // These and no others; that of a BREAK in the program stays beside them. One that is set on a
  // place that was already read ahead halts the run as soon as it can stand. Precondition:
  // MachineFamily::CheckBreakpoint of each.
  virtual void SetBreakpoints(const std::vector<Breakpoint>& /*breakpoints*/) {}

  // Where each program and subroutine is that called another one; that in execution comes last.
  virtual std::vector<Place> stack() const { return {state().place}; }
  virtual std::vector<ModalValue> modal_values() const { return {}; }

  // It stands at a condition that no motion and no scripted input changes any more.
  virtual bool waits_for_ever() const { return false; }

  virtual std::vector<Figure> figures() const { return {}; }

  // What the machine keeps for the next run: variables, images, offsets, position. Versioned bytes.
  virtual std::string SaveMachine() const { return {}; }

  // Executables that this run made, by slot; the cell stores them at slot + 100 (OPT-1.11).
  virtual std::map<int, std::string> made_executables() const { return {}; }

  virtual std::unique_ptr<RunSnapshot> Save() const = 0;
  // Precondition: the snapshot comes from this run, or one made from an equal setup.
  virtual void Restore(const RunSnapshot& snapshot) = 0;

  // For who lets it begin at a step. Null: the family has no such start.
  virtual EnterableRun* enterable() { return nullptr; }
};

// Those of `names` that the run has, in this order.
std::vector<NamedVariable> ReadVariables(const Run& run, std::span<const std::string> names);

}  // namespace rmlcell::machine
