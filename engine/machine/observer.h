#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>

#include "engine/core/diagnostic.h"
#include "engine/core/units.h"
#include "engine/machine/inputs.h"
#include "engine/machine/outcome.h"
#include "engine/motion/planner/planner.h"

namespace rmlcell::machine {

// What a motion is for. Families map their own notions onto it; pictures and lengths depend on it.
enum class MotionUse { kTravel, kCut, kPlunge, kRetract };

// How the power of a laser follows the tip speed, in percent of its rated power (motion.md 8.1):
// P = clamp(constant + per_mm_s * v, 0, 100). WORKDEF 0 and 2: a constant. WORKDEF 1: a line
// through zero.
struct PowerBySpeed {
  double constant_percent = 0.0;
  double percent_per_mm_s = 0.0;

  double PercentAt(double tip_speed_mm_s) const {
    return std::clamp(constant_percent + percent_per_mm_s * tip_speed_mm_s, 0.0, 100.0);
  }
  bool operator==(const PowerBySpeed&) const = default;
};

// One timed motion, when it is over, or a part of one. Whoever runs a motion tells it in parts
// where something happens on the way: a STOP (the part before, then the ramp to rest as a profile
// of its own), the beam switched during the motion. Parts, motions and waits never overlap in time;
// what none of them covers is standstill.
struct MotionDone {
  SimTime start{0};
  SimTime end{0};
  Place place{};
  MotionUse use = MotionUse::kTravel;
  const motion::PlannedMotion* motion = nullptr;  // valid during the call
  double from = 0.0;                              // along motion->path, at `start`
  double travelled = 0.0;        // along motion->path, at `end`; short of its length when stopped
  double profile_start_s = 0.0;  // time within motion->speed at `start`
  double programmed_mm_s =
      0.0;              // feed rate asked for, override included; 0: as fast as the axes can
  bool in_work = true;  // false: a cut or plunge of a tool that nowhere takes material off
  bool beam_on = false;
  PowerBySpeed power{};   // laser: in force while the beam is on
  bool approach = false;  // to the step where the run begins: of no program, and never a cut
};

// A MOVE (or coordinate set) carried out: where the tool now is.
struct MoveDone {
  SimTime at{0};
  Place place{};
  motion::TipPose tip{};  // machine frame; work units of a mill are in the family's figures
  motion::AxisPose axes{};
  motion::ProgramPoint
      program_point{};      // as programmed: program frame, or device units of a stream
  double rotary_a = 0.0;    // as programmed: rad, or degrees of a stream
  double feed_mm_s = 0.0;   // speed limit of the motion
  std::string_view path{};  // "LIN", "CIR", "ZERO_Z", "PU" ...
  bool programmed = true;   // false: the machine went there by a procedure of its own
  bool approach = false;    // that of a run which begins at a step
};

// A state that outsiders can see: an output, the beam, a spindle.
enum class Signal {
  kOutput,        // OL[index]
  kAnalogue,      // OA[index]
  kShutter,       // 1 open
  kBeam,          // 1 on; detail in percent of power
  kSchedule,      // number of the active laser schedule
  kGas,           // 1..3
  kSensor,        // C-axis sensor
  kSpindle,       // 1 turning; detail in rpm
  kSpindleSpeed,  // rpm, while turning or standing
  kRotaryTable,   // degrees
};
struct SignalChange {
  SimTime at{0};
  Place place{};
  Signal signal = Signal::kOutput;
  int index = 0;
  double value = 0.0;
  double detail = 0.0;
};

enum class WaitKind { kDwell, kPierce, kSpinUp, kCondition, kOperator, kLoad };
struct Wait {
  SimTime start{0};
  SimTime end{0};
  Place place{};
  WaitKind kind = WaitKind::kDwell;
  bool beam_on = false;
  double power_percent = 0.0;  // laser: while the beam is on
};

// An axis that a motion takes out of its travel (OPT-B.08, motion.md 2.6): one for each such axis.
// In a forecast the motion begins at `at`; else the run ends there.
struct TravelViolation {
  SimTime at{0};
  Place place{};
  int axis = 0;                 // 0..4: X Y Z A B
  double excess = 0.0;          // the worst of the motion, mm or rad
  bool at_target = false;       // the target itself lies outside; else the path on the way
  bool by_work_offset = false;  // where the axis goes hangs on the work offset in force
  motion::AxisPose axes{};      // where it is worst
  motion::TipPose tip{};
};

// A straight way in the work that the program asks for and the machine leaves out, because it lies
// beyond the travel. Told when the instruction is read: the motions before it may still be under
// way.
struct LostWay {
  SimTime at{0};
  Place place{};
  motion::MachinePoint from{};
  motion::MachinePoint to{};
};

// A halt of the run.
struct Halt {
  SimTime at{0};
  Place place{};
  HaltReason reason = HaltReason::kHold;
  std::string_view why{};  // "STOP"
};

// What OnProgram tells of a program whose executable is being made; any other word: it is loaded.
inline constexpr std::string_view kCompiling = "compiling";

// What a run goes by although nothing of it has set it: a variable, an input, a parameter of a
// subroutine. Another time it may be another.
struct Assumed {
  std::string_view group{};  // "VR"
  int index = 0;
  double value = 0.0;
  bool on_off = false;               // a truth, no number
  std::optional<InputKind> input{};  // that a script of inputs sets it by, where one can
};

struct RunNote;  // machine_status.h

// Told everything that a run does, in order of virtual time. Structs are valid during the call
// only. Default bodies do nothing: override what you need. No method may call back into the run.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  // Of a machine that lives: this run begins, and those before it are over. Once, first.
  virtual void OnRunBegun(const RunNote&) {}
  virtual void OnStep(SimTime /*at*/, const Place&, std::string_view /*instruction*/) {}
  virtual void OnMotion(const MotionDone&) {}
  virtual void OnMove(const MoveDone&) {}
  virtual void OnSignal(const SignalChange&) {}
  virtual void OnWait(const Wait&) {}
  virtual void OnHalt(const Halt&) {}
  virtual void OnResume(SimTime /*at*/, const Place&) {}
  // Of a run that begins at a step: its approach is over. LIVE-6.09
  virtual void OnEntered(SimTime /*at*/) {}
  virtual void OnProgram(SimTime /*at*/, const Place&, std::string_view /*what*/, int /*program*/) {
  }
  virtual void OnMessage(SimTime /*at*/, const Place&, std::string_view /*text*/) {}
  virtual void OnViolation(const TravelViolation&) {}
  virtual void OnLost(const LostWay&) {}
  virtual void OnDiagnostic(SimTime /*at*/, const Diagnostic&) {}
  // One more of a kind that was told a thousand times: code, severity and place alone are known.
  virtual void OnCounted(SimTime /*at*/, const Diagnostic&) {}
  virtual void OnAssumed(const Assumed&) {}  // each time that it is looked at
};

}  // namespace rmlcell::machine
