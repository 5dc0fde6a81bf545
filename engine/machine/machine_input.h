#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/core/catalogue.h"
#include "engine/machine/inputs.h"
#include "engine/machine/run_setup.h"
#include "engine/machine/step_entry.h"
#include "engine/motion/kinematics/kinematics.h"

namespace rmlcell::machine {

struct StartPreview;  // start_preview.h

// Whoever starts a run. LIVE-2.11
enum class StartSource {
  kConsole,  // a person at a computer
  kQueue,    // the queue, for a job
  kPanel,    // the keys at the machine
  kGate1,    // an input that starts a program of its own
  kGate2,
};

// What acts on a machine from outside, one kind each.
struct StartRun {
  int program = 0;
  StartSource source = StartSource::kConsole;
  bool unzeroed = false;  // the program zeroes the axes itself
  // In the slot of the program, for this run alone; none: what is stored there.
  std::optional<StoredProgram> brought{};
};
// The axes find their reference; in REMOTE the machine then goes home. STOP and HOLD end it.
struct ZeroAxes {};
struct ResumeRun {
  StartSource source = StartSource::kConsole;
  bool accept_displaced = false;  // keys moved it in the hold, and it goes on from where it stands
  bool restore_process = false;   // a spindle that a person stopped in the hold turns again
};
struct HoldRun {};   // behind what is in progress
struct StopRun {};   // at once, on the path
struct AbortRun {};  // the run is over where it is: CANCELLED
struct EmergencyStop {
  bool pressed = true;  // false: released
};
struct Acknowledge {
  std::int64_t alarm = 0;
};
struct ChangeMode {
  Mode mode = Mode::kRemote;
};
struct ChangeOverride {
  double percent = 100.0;
};
struct ChangeInput {  // IL, IA
  InputKind kind = InputKind::kLogical;
  int index = 0;
  double value = 0.0;
};
struct MoveDoor {
  bool open = false;
};
struct SwitchPower {
  bool on = false;
};
struct WriteVariable {
  std::string name{};
  double value = 0.0;
};
struct SetBreakpoints {
  std::vector<Breakpoint> breakpoints{};  // these and no others
};
struct SetSimulation {
  std::optional<ProgramStep> until{};  // none: the next run is no dry run
};
// What is stored acts at the next start; a run that is open has what it began with. OPT-B.65
struct StoreProgram {
  int slot = 0;
  StoredProgram program{};
};
struct DeleteProgram {
  int slot = 0;
};
struct SetSchedules {
  std::vector<LaserSchedule> schedules{};  // stored; the others are as the machine has them
};

// The key that clears the display and not its cause: ERR of a handbox. It acts in every mode.
// OPT-4.06, 4.29
struct ClearMessage {};

// A key that moves an axis as long as it is down. C does nothing. OPT-4.20, LIVE-8.03
enum class JogAxis : std::uint8_t { kX, kY, kZ, kA, kB, kC };
struct JogKey {
  JogAxis axis = JogAxis::kX;
  bool plus = true;

  bool operator==(const JogKey&) const = default;
};
std::string Name(const JogKey& key);   // "X+", as it stands on the key
using JogReference = motion::JogMode;  // ROB, ABS, TCP: OPT-4.21
struct PressJog {
  JogKey key{};
  JogReference reference = JogReference::kRobot;  // a mill has none
  bool fast = false;                              // of a mill
};
struct ReleaseJog {
  JogKey key{};
};
// As if every key were released: whoever holds them is not heard any more. LIVE-7.05
struct ReleaseJogs {};

// A key of a mill's panel besides those that pause, go on, stop, open the cover and jog. VIEW takes
// the tool out of the way, and the second time back; SPINDLE stops it in a hold, and lets it turn
// again; Z0 and ORIGIN set registers where the tool stands; HOME goes where H does. LIVE-2.13
enum class PanelKey : std::uint8_t { kView, kSpindle, kZ0, kOrigin, kHome };
std::string_view Name(PanelKey key);  // "VIEW", as it stands on the key
struct PressPanel {
  PanelKey key = PanelKey::kView;
};

// As RunSetup has them: what a run began with, and what came while it ran.
struct StartBase {
  std::string machine_state{};
  InputScript inputs{};
  Mode mode = Mode::kRemote;
  double override_percent = 100.0;
};

// A run that begins at a step: the machine goes there first. LIVE-6
struct StartAtStep {
  int program = 0;  // the main program
  StartSource source = StartSource::kConsole;
  StepTarget target{};
  ApproachWay way = ApproachWay::kSafe;
  bool off_until_work_on = false;  // a WORK is ON there: the beam stays off until the next one
  bool halt_at_entry = false;      // before the step, until RESUME
  // What the run to the step begins with: that of a run that was cut off. None: the machine as it
  // stands, with its inputs as they are.
  std::optional<StartBase> base{};
  std::set<std::string> acknowledged{};    // items that a person has seen to
  std::optional<StoredProgram> brought{};  // as StartRun
  // Of Machine::Preview, of this input on this machine, where nothing has changed since: then
  // nothing is simulated again. None, in a replay: it is, with the same result.
  std::shared_ptr<const StartPreview> prepared{};
};

// A key of the handbox, by its name: "REC". LIVE-7.03
enum class KeyAction : std::uint8_t { kTap, kPress, kRelease };
struct PressedKey {
  std::string key{};
  KeyAction action = KeyAction::kTap;
};
// The change of a program that a key asked for cannot be stored; its StoreProgram or DeleteProgram
// is the answer when it can. LIVE-7.08
struct RefuseEdit {
  ErrorCode code{};
};

// Gate 1 and gate 2: two inputs that start a program each, in REMOTE. How a gate is wired is not
// known; the program of each is set. LIVE-2.11
inline constexpr int kGates = 2;
struct SetGates {
  std::array<int, kGates> programs{};  // slots; 0: it starts none
};
struct PressGate {
  int gate = 1;
};

using MachineInput =
    std::variant<StartRun, ZeroAxes, ResumeRun, HoldRun, StopRun, AbortRun, EmergencyStop,
                 Acknowledge, ChangeMode, ChangeOverride, ChangeInput, MoveDoor, SwitchPower,
                 WriteVariable, SetBreakpoints, SetSimulation, StoreProgram, DeleteProgram,
                 SetSchedules, ClearMessage, StartAtStep, PressJog, ReleaseJog, ReleaseJogs,
                 PressedKey, RefuseEdit, SetGates, PressGate, PressPanel>;

// Whether a run of a program begins with it.
inline bool BeginsRun(const MachineInput& input) {
  return std::holds_alternative<StartRun>(input) || std::holds_alternative<StartAtStep>(input) ||
         std::holds_alternative<PressGate>(input);
}

}  // namespace rmlcell::machine
