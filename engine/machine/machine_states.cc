#include "engine/machine/machine_states.h"

#include <array>
#include <initializer_list>

namespace rmlcell::machine {
namespace {

using Kind = Transition::Kind;

// Where a transition goes, when it is not known before the guards are.
enum class Goal {
  kNone,
  kOff,
  kStarting,
  kJogging,
  kRunning,
  kStopping,
  kHeld,
  kAlarm,
  kLost,
  kStanding,  // INSPECT where that is due, else IDLE or NOT_ZEROED
  kRested,    // what a machine is that has come to rest
  kOwn,       // as its host says
  kFound,     // as the last mark says
};

// What it is refused with, likewise.
enum class Why { kNone, kState, kNotLive, kInspect, kFirstAlarm };

// A rule of its own beside the cell.
enum class Rule {
  kNone,
  kZeroed,
  kManual,
  kNotByHand,
  kHoldsOnLoss,
  kAlarmsGone,
  kKeyOrAway,
  kNotSingle
};

struct Cell {
  Kind kind = Kind::kCannot;
  Goal goal = Goal::kNone;
  Why why = Why::kNone;
  Rule rule = Rule::kNone;
  std::uint16_t acts = 0;
};

constexpr std::uint16_t Bits(std::initializer_list<StateAct> acts) {
  std::uint16_t bits = 0;
  for (const StateAct act : acts)
    bits = static_cast<std::uint16_t>(bits | 1U << static_cast<unsigned>(act));
  return bits;
}

constexpr Cell kNever{};
constexpr Cell Stays(std::initializer_list<StateAct> acts = {}) {
  return {.kind = Kind::kStays, .acts = Bits(acts)};
}
constexpr Cell Goes(Goal goal, std::initializer_list<StateAct> acts = {}) {
  return {.kind = Kind::kGoes, .goal = goal, .acts = Bits(acts)};
}
constexpr Cell Only(Rule rule, Goal goal, std::initializer_list<StateAct> acts = {}) {
  return {.kind = Kind::kGoes, .goal = goal, .rule = rule, .acts = Bits(acts)};
}
constexpr Cell No(Why why) { return {.kind = Kind::kRefused, .why = why}; }

using enum StateAct;
constexpr Cell kSame = Stays();
constexpr Cell kRefuse = No(Why::kState);
constexpr Cell kKey{.kind = Kind::kKeyOnly};
constexpr Cell kAway = No(Why::kNotLive);                           // x4
constexpr Cell kAlarmed = No(Why::kFirstAlarm);                     // x5
constexpr Cell kLook = No(Why::kInspect);                           // x6
constexpr Cell kLater{.kind = Kind::kKept, .why = Why::kNotLive};   // a3
constexpr Cell kSwitchedOff = Goes(Goal::kOff, {kEndInterrupted});  // a1
constexpr Cell kBegins = Goes(Goal::kRunning);
constexpr Cell kZeroedOnly = Only(Rule::kZeroed, Goal::kRunning);  // x1
constexpr Cell kRest = Goes(Goal::kStopping);
constexpr Cell kByHand = Only(Rule::kManual, Goal::kJogging);  // x7
constexpr Cell kNotByHand{.kind = Kind::kRefused, .why = Why::kState, .rule = Rule::kNotByHand};
constexpr Cell kKeyOrAway{.kind = Kind::kRefused, .why = Why::kNotLive, .rule = Rule::kKeyOrAway};
constexpr Cell kNotSingle{
    .kind = Kind::kRefused, .why = Why::kState, .rule = Rule::kNotSingle};  // x2
constexpr Cell kFails = Goes(Goal::kAlarm, {kEndFailed, kSafe});            // a7
constexpr Cell kEnds = Goes(Goal::kStanding, {kEndCancelled, kSafe});       // a8
constexpr Cell kOver = Goes(Goal::kStanding);
constexpr Cell kGone = Goes(Goal::kLost);

// Columns: OFF, NOT_ZEROED, IDLE, JOGGING, RUNNING, STOPPING, HELD, ALARM, INSPECT, LOST.
constexpr int kColumns = 10;
using Row = std::array<Cell, kColumns>;

// clang-format off
constexpr std::array<Row, kMachineEvents> kTable = {{
    // power on
    {Goes(Goal::kStarting), kSame, kSame, kSame, kSame, kSame, kSame, kSame, kSame, kSame},
    // power off
    {kSame, Goes(Goal::kOff), Goes(Goal::kOff), Goes(Goal::kOff), kSwitchedOff, kSwitchedOff, kSwitchedOff,
     Goes(Goal::kOff), Goes(Goal::kOff), kAway},
    // START
    {kAway, kZeroedOnly, kBegins, kRefuse, kRefuse, kRefuse, kRefuse, kAlarmed, kLook, kAway},
    // RESUME
    {kAway, kRefuse, kRefuse, kRefuse, kSame, Stays({kTakeBack}), kBegins, kAlarmed, kLook, kAway},
    // START key
    {kKey, kZeroedOnly, kBegins, kKey, kNotSingle, Stays({kTakeBack}), kBegins, kAlarmed, kLook, kKey},
    // HOLD
    {kSame, kSame, kSame, kRest, kRest, kSame, kSame, kSame, kSame, kLater},
    // STOP
    {kSame, kSame, kSame, kRest, kRest, Stays({kOvertake}), kSame, kSame, kSame, kLater},
    // at rest
    {kNever, kNever, kNever, Goes(Goal::kRested), kNever, Goes(Goal::kRested), kNever, kNever, kNever, kNever},
    // program ended
    {kNever, kNever, kNever, kNever, kOver, kOver, kNever, kNever, kNever, kNever},
    // halt by the program
    {kNever, kNever, kNever, kNever, Goes(Goal::kHeld), Goes(Goal::kHeld), kNever, kNever, kNever, kNever},
    // program error
    {kNever, kNever, kNever, kNever, kOver, kOver, kNever, kNever, kNever, kNever},
    // alarm
    {kNever, Goes(Goal::kAlarm), Goes(Goal::kAlarm), Goes(Goal::kAlarm), kFails, kFails, kFails, kSame, kSame, kNever},
    // acknowledge
    {kSame, kSame, kSame, kSame, kSame, kSame, kSame, Only(Rule::kAlarmsGone, Goal::kStanding), kSame, kAway},
    // ABORT
    {kSame, kSame, kSame, kRest, kRest, Stays({kEndCancelled, kSafe}), kEnds, kSame, kLook, kLater},
    // jog, HOME, ZERO
    {kKeyOrAway, kByHand, kByHand, kSame, kNotByHand, kRefuse, kByHand, kAlarmed, kLook, kAway},
    // RELEASE
    {kSame, kSame, kSame, kRest, kSame, kSame, kSame, kSame, kSame, kSame},
    // door or cover opens
    {kSame, kSame, kSame, kRest, Goes(Goal::kStopping, {kShutter}), Stays({kShutter}), kSame, kSame, kSame, kSame},
    // emergency stop
    {kSame, Goes(Goal::kAlarm), Goes(Goal::kAlarm), Goes(Goal::kAlarm), kFails, kFails, kFails, kSame,
     Goes(Goal::kAlarm), kLater},
    // mode change
    {kAway, kSame, kSame, kRefuse, Stays({kHoldFirst}), Stays({kHoldFirst}), Stays({kHoldFirst}), kSame, kSame, kAway},
    // start at a step
    {kAway, kZeroedOnly, kBegins, kRefuse, kRefuse, kRefuse, kRefuse, kAlarmed, kBegins, kAway},
    // confirm, abandon
    {kRefuse, kRefuse, kRefuse, kRefuse, kRefuse, kRefuse, kEnds, kRefuse, kOver, kRefuse},
    // control lost
    {kSame, kSame, kSame, kRest, Only(Rule::kHoldsOnLoss, Goal::kStopping), kSame, kSame, kSame, kSame, kSame},
    // machine lease lost
    {kNever, kGone, kGone, kRest, kRest, Stays({kCall}), Goes(Goal::kLost, {kEndInterrupted}), kGone, kGone, kNever},
    // host silent
    {kNever, kGone, kGone, kGone, kGone, kGone, kGone, kGone, kGone, kNever},
    // host back
    {kNever, kNever, kNever, kNever, kNever, kNever, kNever, kNever, kNever, Goes(Goal::kOwn)},
    // host ready
    {kNever, kNever, kNever, kNever, kNever, kNever, kNever, kNever, kNever, Goes(Goal::kFound)},
}};
// clang-format on

int ColumnOf(MachineState state) {
  switch (state) {
    case MachineState::kOff:
      return 0;
    case MachineState::kNotZeroed:
      return 1;
    case MachineState::kIdle:
      return 2;
    case MachineState::kJogging:
      return 3;
    case MachineState::kRunning:
      return 4;
    case MachineState::kStopping:
      return 5;
    case MachineState::kHeld:
      return 6;
    case MachineState::kAlarm:
      return 7;
    case MachineState::kInspect:
      return 8;
    case MachineState::kStarting:
    case MachineState::kRecovering:
    case MachineState::kLost:
      break;
  }
  return 9;
}

MachineState StandingOf(const StateGuards& guards) {
  if (guards.inspect_due) return MachineState::kInspect;
  return guards.zeroed ? MachineState::kIdle : MachineState::kNotZeroed;
}

ErrorCode CodeOf(Why why, const StateGuards& guards) {
  switch (why) {
    case Why::kNotLive:
      return ErrorCode::kCellNotLive;
    case Why::kInspect:
      return ErrorCode::kCellInspect;
    case Why::kFirstAlarm:
      return guards.alarm;
    case Why::kState:
    case Why::kNone:
      break;
  }
  return ErrorCode::kCellMachineState;
}

constexpr Transition Refused(ErrorCode code) { return {.kind = Kind::kRefused, .code = code}; }

// A machine that has come to rest.
Transition Rested(const StateGuards& guards) {
  Transition rested{.kind = Kind::kGoes, .to = StandingOf(guards)};
  if (!guards.run_open) {
    if (guards.lease_gone) rested.to = MachineState::kLost;
  } else if (guards.aborts) {
    rested.acts = Bits({kEndCancelled, kSafe});
  } else if (guards.lease_gone) {
    rested.to = MachineState::kLost;
    rested.acts = Bits({kEndInterrupted});
  } else {
    rested.to = MachineState::kHeld;
  }
  return rested;
}

Transition Towards(Goal goal, std::uint16_t acts, const StateGuards& guards) {
  const auto to = [acts](MachineState state) {
    return Transition{.kind = Kind::kGoes, .to = state, .acts = acts};
  };
  switch (goal) {
    case Goal::kOff:
      return to(MachineState::kOff);
    case Goal::kStarting:
      return to(MachineState::kStarting);
    case Goal::kJogging:
      return to(MachineState::kJogging);
    case Goal::kRunning:
      return to(MachineState::kRunning);
    case Goal::kStopping:
      return to(MachineState::kStopping);
    case Goal::kHeld:
      return to(MachineState::kHeld);
    case Goal::kAlarm:
      return to(MachineState::kAlarm);
    case Goal::kLost:
      return to(MachineState::kLost);
    case Goal::kStanding:
      return to(StandingOf(guards));
    case Goal::kRested:
      return Rested(guards);
    case Goal::kOwn:
      return to(guards.own);
    case Goal::kFound:
      if (guards.run_open) return to(MachineState::kInspect);
      return to(guards.alarm_left ? MachineState::kAlarm : StandingOf(guards));
    case Goal::kNone:
      break;
  }
  return {};
}

// What a rule makes of a cell; nothing: the cell holds.
std::optional<Transition> Ruled(Rule rule, const StateGuards& guards) {
  const bool key = guards.from_panel;
  switch (rule) {
    case Rule::kNone:
      break;
    case Rule::kZeroed:
      if (!guards.zeroed && !guards.unzeroed_start) return Refused(guards.not_zeroed);
      break;
    case Rule::kManual:
    case Rule::kNotByHand:
      if (!guards.manual)
        return key ? Transition{.kind = Kind::kKeyOnly} : Refused(ErrorCode::kCellMode);
      break;
    case Rule::kHoldsOnLoss:
      if (!guards.holds_on_loss) return Transition{.kind = Kind::kStays};
      break;
    case Rule::kAlarmsGone:
      if (guards.alarm_left) return Transition{.kind = Kind::kStays};
      break;
    case Rule::kKeyOrAway:
      if (key) return Transition{.kind = Kind::kKeyOnly};
      break;
    case Rule::kNotSingle:
      if (guards.single) return Transition{.kind = Kind::kStays};
      break;
  }
  return std::nullopt;
}

}  // namespace

std::string_view Name(MachineState state) {
  static constexpr std::array<std::string_view, kMachineStates> kNames = {
      "OFF",     "STARTING", "RECOVERING", "NOT_ZEROED", "IDLE",    "JOGGING",
      "RUNNING", "STOPPING", "HELD",       "ALARM",      "INSPECT", "LOST"};
  return kNames[static_cast<std::size_t>(state)];
}

std::string_view Name(MachineEvent event) {
  static constexpr std::array<std::string_view, kMachineEvents> kNames = {"power on",
                                                                          "power off",
                                                                          "START",
                                                                          "RESUME",
                                                                          "START key",
                                                                          "HOLD",
                                                                          "STOP",
                                                                          "at rest",
                                                                          "program ended",
                                                                          "program halts",
                                                                          "program fails",
                                                                          "alarm",
                                                                          "acknowledge",
                                                                          "ABORT",
                                                                          "move by hand",
                                                                          "RELEASE",
                                                                          "door opens",
                                                                          "emergency stop",
                                                                          "mode change",
                                                                          "start at a step",
                                                                          "confirm",
                                                                          "control lost",
                                                                          "machine lease lost",
                                                                          "host silent",
                                                                          "host back",
                                                                          "host ready"};
  return kNames[static_cast<std::size_t>(event)];
}

Transition Next(MachineState state, MachineEvent event, const StateGuards& guards) {
  const Cell& cell =
      kTable[static_cast<std::size_t>(event)][static_cast<std::size_t>(ColumnOf(state))];
  if (const std::optional<Transition> ruled = Ruled(cell.rule, guards)) return *ruled;
  switch (cell.kind) {
    case Kind::kGoes:
      return Towards(cell.goal, cell.acts, guards);
    case Kind::kRefused:
    case Kind::kKept:
      return {.kind = cell.kind, .code = CodeOf(cell.why, guards)};
    case Kind::kStays:
    case Kind::kKeyOnly:
    case Kind::kCannot:
      break;
  }
  return {.kind = cell.kind, .acts = cell.acts};
}

}  // namespace rmlcell::machine
