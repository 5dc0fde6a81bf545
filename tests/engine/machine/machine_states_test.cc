// How a machine goes from state to state: the table against the same rules said a second time,
// state by state and without a table.
#include "engine/machine/machine_states.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>

namespace rmlcell::machine::states {
namespace {

using enum MachineEvent;
using enum MachineState;
using enum StateAct;
using Kind = Transition::Kind;

constexpr ErrorCode kAlarmCode = ErrorCode::kShutterInterlock;

std::uint16_t Acts(std::initializer_list<StateAct> acts) {
  unsigned bits = 0;
  for (const StateAct act : acts) bits |= 1U << static_cast<unsigned>(act);
  return static_cast<std::uint16_t>(bits);
}
Transition Stay(std::initializer_list<StateAct> acts = {}) {
  return {.kind = Kind::kStays, .acts = Acts(acts)};
}
Transition Go(MachineState to, std::initializer_list<StateAct> acts = {}) {
  return {.kind = Kind::kGoes, .to = to, .acts = Acts(acts)};
}
Transition No(ErrorCode code) { return {.kind = Kind::kRefused, .code = code}; }
Transition State() { return No(ErrorCode::kCellMachineState); }
Transition Away() { return No(ErrorCode::kCellNotLive); }
Transition KeyOnly() { return {.kind = Kind::kKeyOnly}; }
Transition Cannot() { return {}; }
Transition Kept() { return {.kind = Kind::kKept, .code = ErrorCode::kCellNotLive}; }

MachineState At(const StateGuards& guards) {
  if (guards.inspect_due) return kInspect;
  return guards.zeroed ? kIdle : kNotZeroed;
}
bool Internal(MachineEvent event) {
  return event == kAtRest || event == kProgramEnded || event == kProgramHalts ||
         event == kProgramFails;
}

Transition ByHand(const StateGuards& guards) {
  if (guards.manual) return Go(kJogging);
  return guards.from_panel ? KeyOnly() : No(ErrorCode::kCellMode);
}

Transition OfOff(MachineEvent event, const StateGuards& guards) {
  switch (event) {
    case kPowerOn:
      return Go(kStarting);
    case kStartKey:
      return KeyOnly();
    case kMoveByHand:
      return guards.from_panel ? KeyOnly() : Away();
    case kStart:
    case kResume:
    case kModeChange:
    case kStartAtStep:
      return Away();
    case kConfirm:
      return State();
    case kAlarmComes:
    case kMachineLeaseLost:
    case kHostSilent:
    case kHostBack:
    case kHostReady:
      return Cannot();
    default:
      return Internal(event) ? Cannot() : Stay();
  }
}

// On and standing, without a run.
Transition OfStanding(bool zeroed, MachineEvent event, const StateGuards& guards) {
  switch (event) {
    case kPowerOff:
      return Go(kOff);
    case kStart:
    case kStartKey:
    case kStartAtStep:
      return zeroed || guards.zeroed || guards.unzeroed_start ? Go(kRunning)
                                                              : No(guards.not_zeroed);
    case kResume:
    case kConfirm:
      return State();
    case kAlarmComes:
    case kEmergencyStop:
      return Go(kAlarm);
    case kMoveByHand:
      return ByHand(guards);
    case kMachineLeaseLost:
    case kHostSilent:
      return Go(kLost);
    case kHostBack:
    case kHostReady:
      return Cannot();
    default:
      return Internal(event) ? Cannot() : Stay();
  }
}

Transition Rest(const StateGuards& guards) {
  if (guards.run_open && guards.aborts) return Go(At(guards), {kEndCancelled, kSafe});
  if (guards.lease_gone) return guards.run_open ? Go(kLost, {kEndInterrupted}) : Go(kLost);
  return Go(guards.run_open ? kHeld : At(guards));
}

Transition OfJogging(MachineEvent event, const StateGuards& guards) {
  switch (event) {
    case kPowerOff:
      return Go(kOff);
    case kHold:
    case kStop:
    case kAbort:
    case kRelease:
    case kDoorOpens:
    case kControlLost:
    case kMachineLeaseLost:
      return Go(kStopping);
    case kAtRest:
      return Rest(guards);
    case kAlarmComes:
    case kEmergencyStop:
      return Go(kAlarm);
    case kStartKey:
      return KeyOnly();
    case kStart:
    case kResume:
    case kModeChange:
    case kStartAtStep:
    case kConfirm:
      return State();
    case kHostSilent:
      return Go(kLost);
    case kPowerOn:
    case kAcknowledge:
    case kMoveByHand:
      return Stay();
    default:
      return Cannot();
  }
}

Transition OfRunning(MachineEvent event, const StateGuards& guards) {
  switch (event) {
    case kPowerOff:
      return Go(kOff, {kEndInterrupted});
    case kHold:
    case kStop:
    case kAbort:
    case kMachineLeaseLost:
      return Go(kStopping);
    case kDoorOpens:
      return Go(kStopping, {kShutter});
    case kControlLost:
      return guards.holds_on_loss ? Go(kStopping) : Stay();
    case kProgramEnded:
    case kProgramFails:
      return Go(At(guards));
    case kProgramHalts:
      return Go(kHeld);
    case kAlarmComes:
    case kEmergencyStop:
      return Go(kAlarm, {kEndFailed, kSafe});
    case kModeChange:
      return Stay({kHoldFirst});
    case kMoveByHand:
      if (!guards.manual) return guards.from_panel ? KeyOnly() : No(ErrorCode::kCellMode);
      return State();
    case kStartKey:
      return guards.single ? Stay() : State();
    case kStart:
    case kStartAtStep:
    case kConfirm:
      return State();
    case kHostSilent:
      return Go(kLost);
    case kPowerOn:
    case kResume:
    case kAcknowledge:
    case kRelease:
      return Stay();
    default:
      return Cannot();
  }
}

Transition OfStopping(MachineEvent event, const StateGuards& guards) {
  switch (event) {
    case kPowerOff:
      return Go(kOff, {kEndInterrupted});
    case kResume:
    case kStartKey:
      return Stay({kTakeBack});
    case kStop:
      return Stay({kOvertake});
    case kAtRest:
      return Rest(guards);
    case kProgramEnded:
    case kProgramFails:
      return Go(At(guards));
    case kProgramHalts:
      return Go(kHeld);
    case kAlarmComes:
    case kEmergencyStop:
      return Go(kAlarm, {kEndFailed, kSafe});
    case kAbort:
      return Stay({kEndCancelled, kSafe});
    case kDoorOpens:
      return Stay({kShutter});
    case kModeChange:
      return Stay({kHoldFirst});
    case kMachineLeaseLost:
      return Stay({kCall});
    case kStart:
    case kMoveByHand:
    case kStartAtStep:
    case kConfirm:
      return State();
    case kHostSilent:
      return Go(kLost);
    case kPowerOn:
    case kHold:
    case kAcknowledge:
    case kRelease:
    case kControlLost:
      return Stay();
    default:
      return Cannot();
  }
}

Transition OfHeld(MachineEvent event, const StateGuards& guards) {
  switch (event) {
    case kPowerOff:
      return Go(kOff, {kEndInterrupted});
    case kResume:
    case kStartKey:
      return Go(kRunning);
    case kAbort:
    case kConfirm:
      return Go(At(guards), {kEndCancelled, kSafe});
    case kAlarmComes:
    case kEmergencyStop:
      return Go(kAlarm, {kEndFailed, kSafe});
    case kMoveByHand:
      return ByHand(guards);
    case kModeChange:
      return Stay({kHoldFirst});
    case kMachineLeaseLost:
      return Go(kLost, {kEndInterrupted});
    case kHostSilent:
      return Go(kLost);
    case kStart:
    case kStartAtStep:
      return State();
    case kHostBack:
    case kHostReady:
      return Cannot();
    default:
      return Internal(event) ? Cannot() : Stay();
  }
}

Transition OfAlarm(MachineEvent event, const StateGuards& guards) {
  switch (event) {
    case kPowerOff:
      return Go(kOff);
    case kStart:
    case kResume:
    case kStartKey:
    case kMoveByHand:
    case kStartAtStep:
      return No(guards.alarm);
    case kAcknowledge:
      return guards.alarm_left ? Stay() : Go(At(guards));
    case kConfirm:
      return State();
    case kMachineLeaseLost:
    case kHostSilent:
      return Go(kLost);
    case kHostBack:
    case kHostReady:
      return Cannot();
    default:
      return Internal(event) ? Cannot() : Stay();
  }
}

Transition OfInspect(MachineEvent event, const StateGuards& guards) {
  switch (event) {
    case kPowerOff:
      return Go(kOff);
    case kStart:
    case kResume:
    case kStartKey:
    case kAbort:
    case kMoveByHand:
      return No(ErrorCode::kCellInspect);
    case kStartAtStep:
      return Go(kRunning);
    case kConfirm:
      return Go(At(guards));
    case kEmergencyStop:
      return Go(kAlarm);
    case kMachineLeaseLost:
    case kHostSilent:
      return Go(kLost);
    case kHostBack:
    case kHostReady:
      return Cannot();
    default:
      return Internal(event) ? Cannot() : Stay();
  }
}

Transition OfLost(MachineEvent event, const StateGuards& guards) {
  switch (event) {
    case kHold:
    case kStop:
    case kAbort:
    case kEmergencyStop:
      return Kept();
    case kStartKey:
      return KeyOnly();
    case kPowerOn:
    case kRelease:
    case kDoorOpens:
    case kControlLost:
      return Stay();
    case kConfirm:
      return State();
    case kHostBack:
      return Go(guards.own);
    case kHostReady:
      if (guards.run_open) return Go(kInspect);
      return Go(guards.alarm_left ? kAlarm : At(guards));
    case kAlarmComes:
    case kMachineLeaseLost:
    case kHostSilent:
      return Cannot();
    default:
      return Internal(event) ? Cannot() : Away();
  }
}

Transition Plainly(MachineState state, MachineEvent event, const StateGuards& guards) {
  switch (state) {
    case kOff:
      return OfOff(event, guards);
    case kNotZeroed:
      return OfStanding(false, event, guards);
    case kIdle:
      return OfStanding(true, event, guards);
    case kJogging:
      return OfJogging(event, guards);
    case kRunning:
      return OfRunning(event, guards);
    case kStopping:
      return OfStopping(event, guards);
    case kHeld:
      return OfHeld(event, guards);
    case kAlarm:
      return OfAlarm(event, guards);
    case kInspect:
      return OfInspect(event, guards);
    case kStarting:
    case kRecovering:
    case kLost:
      break;
  }
  return OfLost(event, guards);
}

StateGuards RandomGuards(std::mt19937& random) {
  const auto maybe = [&random] { return random() % 2 == 0; };
  return {.zeroed = maybe(),
          .run_open = maybe(),
          .aborts = maybe(),
          .lease_gone = maybe(),
          .unzeroed_start = maybe(),
          .alarm_left = maybe(),
          .inspect_due = maybe(),
          .holds_on_loss = maybe(),
          .alarm = kAlarmCode,
          .not_zeroed = ErrorCode::kNotZeroed,
          .manual = maybe(),
          .single = maybe(),
          .from_panel = maybe(),
          .own = static_cast<MachineState>(random() % kMachineStates)};
}

std::string Text(const Transition& one) {
  return std::to_string(static_cast<int>(one.kind)) + " to " + std::string(Name(one.to)) + " " +
         (one.code ? CodeText(*one.code) : std::string()) + " acts " + std::to_string(one.acts);
}

// LIVE-2.02, LIVE-10.01, LIVE-10.02: every pair of state and event, with every guard in
// both senses.
TEST(MachineStatesTest, EachCellIsAsTheRulesSayIt) {
  std::mt19937 random(1);
  for (int state = 0; state < kMachineStates; ++state) {
    for (int event = 0; event < kMachineEvents; ++event) {
      for (int i = 0; i < 200; ++i) {
        const StateGuards guards = RandomGuards(random);
        const auto from = static_cast<MachineState>(state);
        const auto what = static_cast<MachineEvent>(event);
        const Transition expected = Plainly(from, what, guards);
        const Transition given = Next(from, what, guards);
        ASSERT_EQ(given, expected) << Name(from) << ", " << Name(what) << ": " << Text(given)
                                   << " in place of " << Text(expected);
      }
    }
  }
}

// What happens to a machine of a family, one after the other, as far as its states know.
class Sequence {
 public:
  Sequence(bool mill, std::mt19937& random) : mill_(mill), random_(random) {
    guards_.zeroed = mill_ || Maybe();  // a mill has its reference always
  }

  MachineState state() const { return state_; }
  MachineEvent DrawEvent() { return static_cast<MachineEvent>(random_() % kMachineEvents); }
  // Facts change in between: some of those that hang on the machine, all that come with the event.
  const StateGuards& DrawGuards() {
    const StateGuards any = RandomGuards(random_);
    guards_.unzeroed_start = any.unzeroed_start;
    guards_.manual = any.manual;
    guards_.single = any.single;
    guards_.from_panel = any.from_panel;
    guards_.own = any.own;
    guards_.holds_on_loss = any.holds_on_loss;
    guards_.alarm_left = any.alarm_left;
    guards_.alarm = Maybe() ? kAlarmCode : ErrorCode::kCellEmergencyStop;
    guards_.not_zeroed = mill_ ? ErrorCode::kCellMachineState : ErrorCode::kNotZeroed;
    return guards_;
  }
  // What an event leaves behind where it acted.
  void Go(MachineEvent event, const Transition& next) {
    const bool acts = next.kind == Kind::kGoes || next.kind == Kind::kStays;
    const MachineState from = state_;
    if (next.kind == Kind::kGoes) state_ = next.to;
    // A host that is ready says what it found: STARTING and RECOVERING answer as LOST.
    if (!acts) return;
    if (state_ == kRunning) guards_.run_open = true;
    for (const StateAct end : {kEndInterrupted, kEndFailed, kEndCancelled}) {
      if (next.Does(end) && state_ != kStopping) guards_.run_open = false;
    }
    if (event == kProgramEnded || event == kProgramFails || event == kConfirm)
      guards_.run_open = false;
    if (event == kAbort && from != state_) guards_.aborts = true;
    if (event == kMachineLeaseLost) guards_.lease_gone = true;
    if (!MovesAxes(state_)) guards_.aborts = guards_.lease_gone = false;
    if (event == kHostReady) guards_.inspect_due = state_ == kInspect;
    if (event == kConfirm || event == kStartAtStep) guards_.inspect_due = false;
    if (!mill_ && event == kPowerOff && Maybe()) guards_.zeroed = false;
    if (event == kAtRest && Maybe()) guards_.zeroed = true;
  }

 private:
  bool Maybe() { return random_() % 2 == 0; }

  const bool mill_;
  std::mt19937& random_;
  MachineState state_ = kStarting;
  StateGuards guards_{};
};

// The events of class B: a person or a program asks for a motion. LIVE-2.05, 3.20
bool AsksForMotion(MachineEvent event) {
  return event == kStart || event == kResume || event == kStartKey || event == kStartAtStep ||
         event == kMoveByHand;
}

// LIVE-10.01, LIVE-2.04, LIVE-2.05: whatever happens in whatever order to a machine of either
// family: table and rules give the same state, code and acts; axes move in three states alone; and
// what brings a machine that stands into one of those is asked for, or is a host that is back and
// moved all the while.
TEST(MachineStatesTest, AnySequenceOfEventsIsAsTheRulesSayIt) {
  constexpr int kSequences = 100'000;
  constexpr int kEvents = 12;
  std::mt19937 random(4);
  std::array<int, kMachineStates> seen{};
  int moved = 0;
  for (int i = 0; i < kSequences; ++i) {
    Sequence machine(i % 2 == 0, random);
    std::string told;
    for (int event = 0; event < kEvents; ++event) {
      const MachineState from = machine.state();
      // A new host begins each sequence, and often those that are lost.
      const bool begins = event == 0 || (from == kStarting && random() % 2 == 0);
      const MachineEvent what = begins ? kHostReady : machine.DrawEvent();
      const StateGuards& guards = machine.DrawGuards();
      const Transition expected = Plainly(from, what, guards);
      const Transition given = Next(from, what, guards);
      ASSERT_EQ(given, expected) << "sequence " << i << ":" << told << " " << Name(from) << ", "
                                 << Name(what) << ": " << Text(given) << " in place of "
                                 << Text(expected);
      const bool goes = given.kind == Kind::kGoes;
      if (goes && !MovesAxes(from) && MovesAxes(given.to)) {
        ++moved;
        ASSERT_TRUE(AsksForMotion(what) || (what == kHostBack && given.to == guards.own))
            << "sequence " << i << ":" << told << " " << Name(from) << ", " << Name(what);
      }
      if (!goes) {
        ASSERT_EQ(given.to, Transition{}.to);
      }
      ASSERT_EQ(given.code.has_value(), given.kind == Kind::kRefused || given.kind == Kind::kKept);
      ++seen[static_cast<std::size_t>(machine.state())];
      machine.Go(what, given);
      told += " ";
      told += Name(what);
    }
  }
  for (int state = 0; state < kMachineStates; ++state) {
    if (static_cast<MachineState>(state) == kRecovering) continue;  // answers as STARTING does
    EXPECT_GT(seen[static_cast<std::size_t>(state)], 1'000)
        << Name(static_cast<MachineState>(state));
  }
  EXPECT_GT(moved, 10'000);
}

// LIVE-2.05: into a state that moves axes comes nobody by time, a line that is back, the end of a
// lease, an acknowledgement or a door that closes.
TEST(MachineStatesTest, NothingMovesByItself) {
  std::mt19937 random(2);
  for (int state = 0; state < kMachineStates; ++state) {
    const auto from = static_cast<MachineState>(state);
    if (MovesAxes(from)) continue;
    for (const MachineEvent event :
         {kPowerOn,      kPowerOff,      kHold,       kStop,        kAtRest,      kProgramEnded,
          kProgramHalts, kProgramFails,  kAlarmComes, kAcknowledge, kAbort,       kRelease,
          kDoorOpens,    kEmergencyStop, kModeChange, kConfirm,     kControlLost, kMachineLeaseLost,
          kHostSilent,   kHostReady}) {
      for (int i = 0; i < 100; ++i) {
        const Transition next = Next(from, event, RandomGuards(random));
        EXPECT_FALSE(next.kind == Kind::kGoes && MovesAxes(next.to))
            << Name(from) << ", " << Name(event);
      }
    }
  }
}

// LIVE-2.04: which states move axes.
TEST(MachineStatesTest, ThreeStatesMoveAxes) {
  int moving = 0;
  for (int state = 0; state < kMachineStates; ++state)
    moving += MovesAxes(static_cast<MachineState>(state)) ? 1 : 0;
  EXPECT_EQ(moving, 3);
  EXPECT_TRUE(MovesAxes(kJogging) && MovesAxes(kRunning) && MovesAxes(kStopping));
}

// LIVE-2.03: HOLD, STOP and the emergency stop are refused by no state of a machine that is heard.
TEST(MachineStatesTest, WhatStopsIsNeverRefused) {
  std::mt19937 random(3);
  for (const MachineState state :
       {kOff, kNotZeroed, kIdle, kJogging, kRunning, kStopping, kHeld, kAlarm, kInspect}) {
    for (const MachineEvent event : {kHold, kStop, kEmergencyStop, kDoorOpens, kRelease}) {
      for (int i = 0; i < 20; ++i) {
        const Transition next = Next(state, event, RandomGuards(random));
        EXPECT_TRUE(next.kind == Kind::kStays || next.kind == Kind::kGoes)
            << Name(state) << ", " << Name(event);
      }
    }
  }
}

}  // namespace
}  // namespace rmlcell::machine::states
