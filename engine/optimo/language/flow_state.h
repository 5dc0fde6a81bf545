#pragma once

#include <bitset>
#include <cstdint>
#include <optional>

#include "engine/motion/geometry/frames.h"
#include "engine/optimo/language/ast.h"
#include "engine/optimo/language/dwells.h"
#include "engine/optimo/language/flow_field.h"

// What is known about the machine at a point of the program, over all paths that lead there.
// Private to the folder.
namespace rmlcell::optimo {

// kFresh: on, with no dwell yet and no motion; kFreshRamp: by a WORK 1 whose delay is 0. kJustOff:
// off, and the next MOVE leaves the part.
enum class BeamThere : std::uint8_t { kOff, kJustOff, kFresh, kFreshRamp, kOn, kUnknown };
enum class Output : std::uint8_t { kOff, kOn, kUnknown };
// kOffSeen: off, and a WORK ON or a MOVE came since.
enum class Sensor : std::uint8_t { kOff, kOffSeen, kOn, kUnknown };
// Whether SYSDEF turns the program's coordinates.
enum class Turned : std::uint8_t { kNo, kUnknown };
// Whether the GOSUB of a TIMER may come.
enum class Armed : std::uint8_t { kNo, kYes };
// /FLY moves below 0.01 mm in a row.
enum class TinyMoves : std::uint8_t { kNone, kOne, kTwo, kMore };

using ProcessSet = std::uint32_t;  // bit n * 10 + p
inline ProcessSet ProcessBit(const Instruction& i) {
  return 1U << (i.numbers[0] * 10U + i.numbers[1]);
}
// Beside the processes: another program may have changed them.
inline constexpr ProcessSet kNotFollowed = 1U << 30;
inline constexpr ProcessSet kAllProcesses = kNotFollowed - 1;
inline constexpr ProcessSet kBeamProcesses = (1U << 20) - 1;  // WORK 0 and 1

// VR, VI, VL in this order, a hundred each.
inline constexpr std::size_t kOwnVariables = 300;
using VariableSet = std::bitset<kOwnVariables>;
std::optional<std::size_t> OwnVariable(const ExprNode& node);
// The variables that a LET or ASSIGN sets; none for other instructions.
VariableSet VariablesSetBy(const Module& module, const Instruction& instruction);

struct FlowState {
  bool reached = false;
  Modes modes;
  Choice<BeamThere> beam;
  Choice<Output> gas_2, gas_3;
  Choice<Sensor> sensor;
  Choice<Turned> turned;
  Choice<Armed> timer;
  Choice<TinyMoves> tiny_moves;
  Facts<ProcessSet> on, off;             // may be ON, may be OFF
  Facts<ProcessSet> defined, undefined;  // a WORKDEF may have been executed, may not
  Facts<VariableSet> unset;              // may not have been assigned by this program
  Single<float> speed;
  Single<motion::ProgramPoint> target;  // of the last MOVE in ABSOL, as programmed
  Single<std::uint32_t> short_fly;      // the MOVE before, when it was short and had /FLY

  bool operator==(const FlowState&) const = default;

  // What holds at the start of a program (OPT-B.53).
  static FlowState AtStart();
  static FlowState Unknown();         // reached, but nothing is known
  static FlowState InErrorHandler();  // beam off, all processes off (OPT-3.58)
  static FlowState Kept();            // as before, whatever that is

  bool BeamIsOn() const;
  bool KnowsProcesses() const { return (on.made & kNotFollowed) == 0; }
  bool KnowsWorkdefs() const { return (defined.made & kNotFollowed) == 0; }

  // `next` is executed behind what led here. Precondition: both are reached.
  void Then(const FlowState& next);
  // What `other` has otherwise is not known any more: it may have come at any time, or not yet.
  void ForgetDifferences(const FlowState& other);
  // Makes it hold on both paths. True when it changed.
  bool Join(const FlowState& other);
};

// Carries the state over one instruction. `at` is its index.
void Step(const Module& module, const Dwells& dwells, std::uint32_t at, FlowState& state);

// What a LET or ASSIGN makes of an output; nothing when it does not write it.
std::optional<Output> OutputSetBy(const Module& module, const Instruction& instruction, int output);
inline constexpr int kGas2Output = 8, kGas3Output = 9, kSensorOutput = 11;  // OPT-5.39

// The coordinates of a MOVE, when they are literals or constants.
std::optional<motion::ProgramPoint> LiteralTarget(const Module& module, const Instruction& move);
std::optional<float> LiteralValueOf(Expression value);

double Distance_mm(const motion::ProgramPoint& a, const motion::ProgramPoint& b);
inline constexpr double kShortFly_mm = 1.0;  // OPT-2.51
inline constexpr double kTinyFly_mm = 0.01;  // OPT-2.52

}  // namespace rmlcell::optimo
