// What single keys ask of a machine in whatever state it is: what stops, starts and goes on, what a
// release asks for, and what the panel shows meanwhile.
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "engine/optimo/control/optimo_family.h"
#include "engine/optimo/handbox/optimo_handbox.h"
#include "engine/optimo/handbox/steps.h"
#include "tests/engine/optimo/handbox/handbox_bed.h"

namespace rmlcell::optimo {
namespace {

using machine::HandRun;
using machine::RunPhase;
using machine::StartSource;

// "StopRun", as it is asked for.
std::string NameOfAsked(const machine::MachineInput& input) {
  if (std::holds_alternative<machine::StopRun>(input)) return "StopRun";
  if (std::holds_alternative<machine::HoldRun>(input)) return "HoldRun";
  if (std::holds_alternative<machine::AbortRun>(input)) return "AbortRun";
  if (std::holds_alternative<machine::ClearMessage>(input)) return "ClearMessage";
  if (const auto* start = std::get_if<machine::StartRun>(&input))
    return "StartRun " + std::to_string(start->program);
  if (const auto* resume = std::get_if<machine::ResumeRun>(&input))
    return resume->source == StartSource::kPanel ? "ResumeRun" : "ResumeRun of others";
  if (const auto* mode = std::get_if<machine::ChangeMode>(&input))
    return "ChangeMode " + std::string(machine::Name(mode->mode));
  if (const auto* to = std::get_if<machine::ChangeOverride>(&input))
    return "ChangeOverride " + std::to_string(static_cast<int>(to->percent));
  if (const auto* stop = std::get_if<machine::EmergencyStop>(&input))
    return stop->pressed ? "EmergencyStop" : "EmergencyStop released";
  if (const auto* jog = std::get_if<machine::PressJog>(&input))
    return "PressJog " + machine::Name(jog->key);
  if (const auto* jog = std::get_if<machine::ReleaseJog>(&input))
    return "ReleaseJog " + machine::Name(jog->key);
  return "other";
}

class AskedOfTheMachine : public HandboxTest {
 protected:
  // All that is asked for, and the number of what is said; "" for nothing.
  std::string Asked(const std::string& key, KeyAction action = KeyAction::kPress) {
    const machine::MachineView view{.status = status, .programs = programs};
    const Result<machine::HandboxAnswer> answer = alone.Press(key, action, view);
    EXPECT_TRUE(answer) << key;
    std::string all;
    const auto add = [&all](const std::string& one) { all += (all.empty() ? "" : ", ") + one; };
    for (const machine::MachineInput& input : answer->requests) add(NameOfAsked(input));
    if (answer->message) add(std::to_string(Lookup(*answer->message).number));
    return all;
  }
  machine::Panel PanelAlone() const {
    return alone.panel({.status = status, .programs = programs});
  }
  std::string ShownAlone() const {
    const std::string display = PanelAlone().display;
    return display.substr(0, display.find_last_not_of(' ') + 1);
  }
  void Stands(Mode mode) {
    status = {.mode = mode};
    status.run.zeroed = true;
    status.shown.program = 5;
  }
  // A run that was started by whomever, in this phase.
  void Runs(Mode mode, StartSource source, RunPhase phase, MachineState state) {
    Stands(mode);
    status.open = machine::RunNote{.program = 5, .source = source};
    status.run.phase = phase;
    status.state = state;
  }

  OptimoHandbox alone{machine::Parameters(OptimoFamily().parameters()), HandboxModes()};
  machine::MachineStatus status;
  std::map<int, machine::StoredProgram> programs;
};

// OPT-4.18, OPT-4.09, LIVE-7.07: SHIFT STOP ends a run that was started here, and no other; SHIFT
// goes out with it.
TEST_F(AskedOfTheMachine, WhatStopAsksFor) {
  const auto shift_stop = [this] {
    Asked("SHIFT");
    const std::string asked = Asked("STOP");
    EXPECT_EQ(PanelAlone().lamps.size(), 2U);
    return asked;
  };
  for (const Mode mode : {Mode::kRepeat, Mode::kCycle, Mode::kSingle}) {
    Stands(mode);
    EXPECT_EQ(Asked("STOP"), "StopRun");
    EXPECT_EQ(Asked("HOLD"), "HoldRun");
    EXPECT_EQ(shift_stop(), "StopRun");
    Runs(mode, StartSource::kPanel, RunPhase::kRunning, MachineState::kRunning);
    EXPECT_EQ(Asked("STOP"), "StopRun");
    EXPECT_EQ(shift_stop(), "AbortRun");
    EXPECT_EQ(Asked("STOP"), "StopRun");
    for (const StartSource other : {StartSource::kQueue, StartSource::kConsole}) {
      Runs(mode, other, RunPhase::kHalted, MachineState::kHeld);
      EXPECT_EQ(shift_stop(), "StopRun");
    }
  }
  Stands(Mode::kManual);
  EXPECT_EQ(Asked("STOP"), "7601");
  EXPECT_EQ(Asked("HOLD"), "7601");
  Runs(Mode::kManual, StartSource::kPanel, RunPhase::kRunning, MachineState::kRunning);
  EXPECT_EQ(Asked("HOLD"), "HoldRun");
  EXPECT_EQ(Asked("STOP"), "StopRun");
  EXPECT_EQ(shift_stop(), "AbortRun");
}

// OPT-4.19, OPT-4.61, OPT-6.31, LIVE-2.11: START goes on with a run of its own that stands or comes
// to rest, and asks for nothing while one goes on.
TEST_F(AskedOfTheMachine, WhatStartAsksFor) {
  for (const Mode mode : {Mode::kRepeat, Mode::kCycle, Mode::kSingle}) {
    Stands(mode);
    EXPECT_EQ(Asked("START"), "StartRun 5");
    status.shown.program = 0;
    EXPECT_EQ(Asked("START"), "7602");
    Runs(mode, StartSource::kPanel, RunPhase::kHalted, MachineState::kHeld);
    EXPECT_EQ(Asked("START"), "ResumeRun");
    Runs(mode, StartSource::kPanel, RunPhase::kRunning, MachineState::kStopping);
    EXPECT_EQ(Asked("START"), "ResumeRun");
    Runs(mode, StartSource::kPanel, RunPhase::kRunning, MachineState::kRunning);
    EXPECT_EQ(Asked("START"), "");
    Runs(mode, StartSource::kQueue, RunPhase::kHalted, MachineState::kHeld);
    EXPECT_EQ(Asked("START"), "7601");
  }
  // In MANUAL it is for a FUNCTION that was held; else it opens a form. OPT-9.36
  Runs(Mode::kManual, StartSource::kPanel, RunPhase::kHalted, MachineState::kHeld);
  status.by_hand = HandRun::kFunction;
  EXPECT_EQ(Asked("START"), "ResumeRun");
  status.by_hand.reset();
  EXPECT_EQ(Asked("START"), "");
  EXPECT_EQ(ShownAlone(), "ISTR GO");
}

// OPT-4.15, OPT-4.20, OPT-4.14: what a key asks for when it comes up: a jog key, HOME while it
// moves, and the emergency stop; no other.
TEST_F(AskedOfTheMachine, WhatAReleaseAsksFor) {
  Stands(Mode::kManual);
  EXPECT_EQ(Asked("X+", KeyAction::kRelease), "ReleaseJog X+");
  EXPECT_EQ(Asked("B-", KeyAction::kRelease), "ReleaseJog B-");
  EXPECT_EQ(Asked("HOME", KeyAction::kRelease), "");
  EXPECT_EQ(Asked("EMERGENCY_STOP", KeyAction::kRelease), "EmergencyStop released");
  for (const HandRun run : {HandRun::kZero, HandRun::kHome, HandRun::kFunction}) {
    Runs(Mode::kManual, StartSource::kPanel, RunPhase::kRunning, MachineState::kJogging);
    status.by_hand = run;
    EXPECT_EQ(Asked("HOME", KeyAction::kRelease), run == HandRun::kHome ? "StopRun" : "");
    EXPECT_EQ(Asked("START", KeyAction::kRelease), "");
    EXPECT_EQ(Asked("STOP", KeyAction::kRelease), "");
    EXPECT_EQ(Asked("REC", KeyAction::kRelease), "");
  }
}

// OPT-4.22, LIVE-7.06: a mode key stops what moves by hand: a jog key goes with the old mode, HOME
// stops and the mode stays, ZERO and a FUNCTION go on.
TEST_F(AskedOfTheMachine, WhatAModeKeyAsksFor) {
  Stands(Mode::kManual);
  EXPECT_EQ(Asked("MODE_RIGHT"), "ChangeMode REPEAT");
  status.state = MachineState::kJogging;
  EXPECT_EQ(Asked("MODE_RIGHT"), "StopRun, ChangeMode REPEAT");
  EXPECT_EQ(Asked("MODE_LEFT"), "");
  status.by_hand = HandRun::kHome;
  EXPECT_EQ(Asked("MODE_RIGHT"), "StopRun, 7601");
  status.by_hand = HandRun::kZero;
  EXPECT_EQ(Asked("MODE_RIGHT"), "7601");
  status.by_hand = HandRun::kFunction;
  EXPECT_EQ(Asked("MODE_RIGHT"), "7601");
}

// OPT-4.37, OPT-4.40: the override is for all that moves but ZERO; at its ends nothing is asked.
TEST_F(AskedOfTheMachine, WhatAnOverrideKeyAsksFor) {
  Stands(Mode::kManual);
  EXPECT_EQ(Asked("OVERRIDE_PLUS"), "ChangeOverride 115");
  EXPECT_EQ(Asked("OVERRIDE_MINUS"), "ChangeOverride 85");
  for (const HandRun run : {HandRun::kHome, HandRun::kFunction}) {
    status.by_hand = run;
    EXPECT_EQ(Asked("OVERRIDE_PLUS"), "ChangeOverride 115");
  }
  status.by_hand = HandRun::kZero;
  EXPECT_EQ(Asked("OVERRIDE_PLUS"), "7601");
  status.by_hand.reset();
  status.override_percent = 145.0;
  EXPECT_EQ(Asked("OVERRIDE_PLUS"), "");
  status.override_percent = 10.0;
  EXPECT_EQ(Asked("OVERRIDE_MINUS"), "");
}

// LIVE-7.06: another reference stops keys that are down, the same one does not; where none is down
// nothing is stopped.
TEST_F(AskedOfTheMachine, WhatAReferenceAsksFor) {
  Stands(Mode::kManual);
  EXPECT_EQ(Asked("JOG_ABS"), "");
  EXPECT_EQ(alone.jog_reference(), machine::JogReference::kAbsolute);
  status.state = MachineState::kJogging;
  EXPECT_EQ(Asked("JOG_ABS"), "");
  EXPECT_EQ(Asked("JOG_TCP"), "StopRun");
  EXPECT_EQ(alone.jog_reference(), machine::JogReference::kTool);
}

// OPT-4.29: ERR clears a message of the machine, and asks for nothing where there is none.
TEST_F(AskedOfTheMachine, WhatErrAsksFor) {
  Stands(Mode::kCycle);
  EXPECT_EQ(Asked("ERR"), "");
  status.message = ErrorCode::kNotZeroed;
  EXPECT_EQ(Asked("JOB"), "");
  EXPECT_EQ(Asked("ERR"), "");  // the form first
  EXPECT_EQ(Asked("ERR"), "ClearMessage");
}

// OPT-4.42, OPT-4.12: while a run goes on, HOME and ZERO always, nothing can be selected or
// entered; where one is held it can.
TEST_F(AskedOfTheMachine, WhatIsRefusedWhileARunGoesOn) {
  const auto job = [this] {
    const std::string said = Asked("JOB");
    Asked("ERR");
    return said;
  };
  for (const Mode mode : {Mode::kManual, Mode::kCycle}) {
    Runs(mode, StartSource::kPanel, RunPhase::kRunning, MachineState::kRunning);
    EXPECT_EQ(job(), "7601");
    Runs(mode, StartSource::kPanel, RunPhase::kHalted, MachineState::kHeld);
    EXPECT_EQ(job(), "");
    status.by_hand = HandRun::kFunction;
    EXPECT_EQ(job(), "");
    for (const HandRun run : {HandRun::kHome, HandRun::kZero}) {
      status.by_hand = run;
      EXPECT_EQ(job(), "7601");
    }
    Stands(mode);
    EXPECT_EQ(job(), "");
  }
}

// OPT-4.49, OPT-4.06: ZERO flashes with its lamp; an error of the control is shown by its number,
// one of the cell is not; without power nothing is shown at all.
TEST_F(AskedOfTheMachine, WhatThePanelShows) {
  Stands(Mode::kManual);
  EXPECT_EQ(ShownAlone(), "P=05S=0000I=********");
  for (const HandRun run : {HandRun::kHome, HandRun::kZero, HandRun::kFunction}) {
    status.by_hand = run;
    const machine::Panel panel = PanelAlone();
    EXPECT_EQ(panel.flashing, run == HandRun::kZero);
    EXPECT_EQ(panel.lamps.size(), run == HandRun::kZero ? 3U : 2U);
    EXPECT_EQ(ShownAlone(), run == HandRun::kZero ? "ZERO AXES" : "P=05S=0000I=********");
  }
  status.by_hand.reset();
  status.message = ErrorCode::kNotZeroed;
  EXPECT_EQ(ShownAlone(), "ERROR 7310");
  status.message = ErrorCode::kCellStoreUnavailable;
  EXPECT_EQ(ShownAlone(), "P=05S=0000I=********");
  EXPECT_EQ(PanelAlone().message, ErrorCode::kCellStoreUnavailable);
  status.state = MachineState::kOff;
  EXPECT_EQ(ShownAlone(), "");
  EXPECT_THAT(PanelAlone().lamps, IsEmpty());
  EXPECT_FALSE(PanelAlone().message.has_value());
}

// OPT-5.36: WORK that runs is shown as what it is, where its program can still be read.
TEST_F(AskedOfTheMachine, TheNameOfAWorkThatRuns) {
  Runs(Mode::kCycle, StartSource::kPanel, RunPhase::kRunning, MachineState::kRunning);
  programs[5].object = Translated("DELAY 1\nWORK 0,0/ON\nWORK 0,0/OFF\n").object;
  for (const auto& [step, name] :
       {std::pair{2, "WORKON"}, std::pair{3, "WORKOFF"}, std::pair{4, "WORK"}}) {
    status.shown = {.program = 5, .step = step, .instruction = "WORK"};
    EXPECT_EQ(ShownAlone(), "P=05S=000" + std::to_string(step) + "I=" + name);
  }
  status.shown = {.program = 6, .step = 2, .instruction = "WORK"};
  EXPECT_EQ(ShownAlone(), "P=06S=0002I=WORK");
  programs[6].object = machine::Bytes::Of("no object");
  EXPECT_EQ(ShownAlone(), "P=06S=0002I=WORK");
}

// LIVE-7.02: of a program that is gone or cannot be read no step is shown.
TEST_F(AskedOfTheMachine, AProgramThatIsGoneHasNoStep) {
  Stands(Mode::kManual);
  programs[6].object = machine::Bytes::Of("no object");
  for (const int program : {5, 6}) {
    status.shown = {.program = program, .step = 2, .instruction = "DELAY"};
    const machine::ShownStep shown = alone.ShowAgain({.status = status, .programs = programs});
    EXPECT_EQ(shown.program, program);
    EXPECT_EQ(shown.step, 0);
    EXPECT_EQ(shown.instruction, "");
  }
}

// OPT-4.32: with none selected, and with none there at all.
TEST_F(AskedOfTheMachine, NeighboursOfNoProgram) {
  Stands(Mode::kCycle);
  status.shown.program = 0;
  for (const std::string key : {"PREV", "NEXT"}) {
    Asked("SHIFT");
    const machine::MachineView view{.status = status, .programs = programs};
    const Result<machine::HandboxAnswer> answer = alone.Press(key, KeyAction::kPress, view);
    ASSERT_TRUE(answer);
    EXPECT_FALSE(answer->shown.has_value()) << key;
    EXPECT_FALSE(answer->message.has_value()) << key;
  }
}

// OPT-5.26: START, TIME, END and NEXT go into the next MOVE, whatever is recorded before it.
TEST_F(AskedOfTheMachine, AttributesOutliveOtherSteps) {
  Have({});
  Keys("JOB 1 2 ENT REC MOV NEXT NEXT 1 ENT 1 6 ENT REC DLY ENT REC");
  Hold("X+", 0.3);
  Keys("REC");
  Hold("X+", 0.3);
  Keys("REC");
  const std::vector<std::string> steps = Program(12);
  ASSERT_EQ(steps.size(), 5U);
  EXPECT_TRUE(steps[2].ends_with(") /START (IL[16])")) << steps[2];
  EXPECT_EQ(steps[3].find('/'), std::string::npos) << steps[3];
}

// LIVE-7.01, OPT-5.14: what was to come behind a step that was never stored is not left at a
// power-up.
TEST_F(AskedOfTheMachine, APowerUpForgetsWhatComesBehindAStep) {
  Have({{12, "DELAY 1\n"}});
  stores = false;
  Keys("JOB 1 2 NEXT 1 ENT PATH PREV ENT DEL 5 ENT REC");
  ASSERT_EQ(edits.size(), 1U);
  Good(machine::SwitchPower{false});
  Good(machine::SwitchPower{true});
  stores = true;
  Keys("JOB 1 2 NEXT 1 ENT MOV ENT REC");
  EXPECT_EQ(edits.size(), 2U);
  EXPECT_EQ(Shows(), "P=12S=0002I=DELAY");
}

// LIVE-7.09: nothing lies behind the last instruction that could be taken out.
TEST_F(AskedOfTheMachine, NothingLiesBehindTheEnd) {
  const std::string object(*Translated("SPEED 5\nDELAY 1\n").object);
  for (const int place : {2, 3, 100}) {
    const Result<std::string> undone = UndoProgramEdit({.kind = machine::ProgramEdit::Kind::kInsert,
                                                        .program = 12,
                                                        .step = place + 1,
                                                        .place = place,
                                                        .text_after = "DELAY 1",
                                                        .object = object},
                                                       object);
    ASSERT_FALSE(undone) << place;
    EXPECT_EQ(undone.error().code, ErrorCode::kCellEtagMismatch) << place;
  }
}

// OPT-5.18, OPT-E.7102: the first point of a circle needs a program, too: it goes on flashing where
// there is none.
TEST_F(AskedOfTheMachine, AFirstPointNeedsAProgram) {
  Have({});
  Keys("JOB 9 9 ENT PATH NEXT NEXT ENT");
  Hold("X+", 0.3);
  Keys("REC");
  EXPECT_EQ(Said(), 7102);
  EXPECT_EQ(Shows(), "*MOVE");
  EXPECT_THAT(edits, IsEmpty());
}

}  // namespace
}  // namespace rmlcell::optimo
