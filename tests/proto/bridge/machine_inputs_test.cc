// What acts on a machine, as it stands in a journal, and back.
#include "proto/bridge/machine_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/worker.pb.h"
#include "tests/proto/bridge/message_text.h"

namespace rmlcell::bridge {
namespace {

using machine::JogAxis;
using machine::MachineInput;

v1::AppliedInput Applied(const std::string& text) {
  v1::AppliedInput applied;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &applied)) << text;
  return applied;
}

// What a journal says of an input, and that a machine is given the same when it is played.
void ExpectThereAndBack(const MachineInput& input, const std::string& text) {
  ExpectMessage(AppliedOf(input), text);
  const auto back = InputOf(Applied(text));
  ASSERT_TRUE(back) << text << ": " << back.error().detail;
  ASSERT_TRUE(*back) << text;
  EXPECT_EQ((*back)->index(), input.index()) << text;
  ExpectMessage(AppliedOf(**back), text);
}

TEST(MachineInputMessage, OfRuns) {
  ExpectThereAndBack(
      machine::StartRun{.program = 12, .source = machine::StartSource::kQueue, .unzeroed = true},
      "start { program: 12 source: START_SOURCE_QUEUE unzeroed: true }");
  ExpectThereAndBack(machine::StartRun{.program = 12},
                     "start { program: 12 source: START_SOURCE_CONSOLE }");
  ExpectThereAndBack(
      machine::ResumeRun{.source = machine::StartSource::kPanel, .accept_displaced = true},
      "resume { source: START_SOURCE_PANEL accept_displaced: true }");
  ExpectThereAndBack(
      machine::ResumeRun{.source = machine::StartSource::kConsole, .restore_process = true},
      "resume { source: START_SOURCE_CONSOLE restore_process: true }");
  ExpectThereAndBack(machine::HoldRun{}, "hold: HOLD_REASON_HOLD");
  ExpectThereAndBack(machine::StopRun{}, "stop: HOLD_REASON_STOP");
  ExpectThereAndBack(machine::AbortRun{}, "abort: HOLD_REASON_ABORT");
  ExpectThereAndBack(machine::ChangeOverride{.percent = 45.5}, "override_percent: 45.5");
  ExpectThereAndBack(machine::ChangeMode{.mode = machine::Mode::kCycle},
                     "mode: OPERATING_MODE_CYCLE");
  ExpectThereAndBack(machine::Acknowledge{.alarm = 7}, "acknowledged_alarm: 7");
  // Older journals say nothing of who resumed: a person.
  const auto resumed = InputOf(Applied("resume {}"));
  EXPECT_EQ(std::get<machine::ResumeRun>(**resumed).source, machine::StartSource::kConsole);
}

TEST(MachineInputMessage, OfAStartAtAStep) {
  machine::StartAtStep start{
      .program = 12,
      .source = machine::StartSource::kGate1,
      .target = {.at = {.program = 13, .step = 7}, .occurrence = 3},
      .way = machine::ApproachWay::kDirect,
      .off_until_work_on = true,
      .base = machine::StartBase{
          .machine_state = "state",
          .inputs = {{.at = SimTime(5), .kind = machine::InputKind::kOverride, .value = 145.0},
                     {.at = SimTime(6),
                      .kind = machine::InputKind::kVariable,
                      .value = 2.5,
                      .name = "VR[1]"}},
          .mode = machine::Mode::kSingle,
          .override_percent = 55.0}};
  const std::string base =
      " base { program: 12 machine_state: 'state' mode: OPERATING_MODE_SINGLE override_percent: 55 "
      "inputs { run_time_ns: 5 input { override_percent: 145 } } inputs { run_time_ns: 6 input { "
      "variable { name: 'VR[1]' value { real: 2.5 } } } } } }";
  ExpectThereAndBack(start,
                     "start { program: 12 source: START_SOURCE_GATE_1 step { program: 13 step: 7 } "
                     "occurrence: 3 approach: APPROACH_DIRECT off_until_work_on: true" +
                         base);
  start = {.program = 12,
           .source = machine::StartSource::kGate2,
           .target = {.at = {.program = 12, .step = 1}},
           .way = machine::ApproachWay::kSafe,
           .halt_at_entry = true};
  const std::string plain =
      "start { program: 12 source: START_SOURCE_GATE_2 step { program: 12 step: 1 } ";
  ExpectThereAndBack(start, plain + "occurrence: 1 approach: APPROACH_SAFE halt_at_entry: true }");
  // It has acted: what a person has to see to was seen to. None said: the first time it comes.
  const auto back = std::get<machine::StartAtStep>(**InputOf(Applied(plain + "}")));
  EXPECT_EQ(back.target.occurrence, 1U);
  EXPECT_EQ(back.way, machine::ApproachWay::kSafe);
  EXPECT_FALSE(back.base);
  EXPECT_THAT(back.acknowledged, testing::ElementsAre("Z0", "clamps", "origin", "table", "tool"));
}

TEST(MachineInputMessage, OfTheWorldOutside) {
  using machine::InputKind;
  const std::string outside = "from_outside { ";
  ExpectThereAndBack(machine::ChangeInput{.kind = InputKind::kLogical, .index = 99, .value = 1.0},
                     outside + "input { name: 'IL[99]' value { logical: true } } }");
  ExpectThereAndBack(machine::ChangeInput{.kind = InputKind::kLogical, .index = 0, .value = 0.0},
                     outside + "input { name: 'IL[0]' value { logical: false } } }");
  ExpectThereAndBack(machine::ChangeInput{.kind = InputKind::kAnalogue, .index = 7, .value = -2.5},
                     outside + "input { name: 'IA[7]' value { real: -2.5 } } }");
  for (const bool open : {false, true}) {
    const std::string word = open ? "true" : "false";
    ExpectThereAndBack(machine::MoveDoor{.open = open}, outside + "door_open: " + word + " }");
    ExpectThereAndBack(machine::SwitchPower{.on = open}, "power: " + word);
    ExpectThereAndBack(machine::EmergencyStop{.pressed = open}, "emergency_stop: " + word);
  }
  ExpectThereAndBack(machine::PressGate{.gate = 2}, outside + "gate: 2 }");
  ExpectThereAndBack(machine::SetGates{.programs = {12, 0}}, "gates { programs: 12 programs: 0 }");
  // As a client says it.
  v1::MachineInput power;
  power.set_power(true);
  EXPECT_TRUE(std::get<machine::SwitchPower>(*FromProto(power)).on);
  v1::MachineInput released;
  released.set_emergency_stop_released(true);
  EXPECT_FALSE(std::get<machine::EmergencyStop>(*FromProto(released)).pressed);
}

TEST(MachineInputMessage, OfAProgrammer) {
  ExpectThereAndBack(machine::WriteVariable{.name = "VR[3]", .value = 2.5},
                     "variable { name: 'VR[3]' value { real: 2.5 } }");
  ExpectThereAndBack(
      machine::SetBreakpoints{
          {{.at = {.program = 12, .step = 7}},
           {.at = {.program = 13, .step = 8}, .condition = "VI[1] > 2", .from_pass = 3}}},
      "breakpoints { breakpoints { step { program: 12 step: 7 } passes: 1 } breakpoints { step { "
      "program: 13 step: 8 } condition: 'VI[1] > 2' passes: 3 } }");
  ExpectThereAndBack(machine::SetBreakpoints{}, "breakpoints {}");
  ExpectThereAndBack(
      machine::SetSimulation{.until = machine::ProgramStep{.program = 12, .step = 9}},
      "simulation_until { program: 12 step: 9 }");
  ExpectThereAndBack(machine::SetSimulation{}, "simulation_until {}");
}

TEST(MachineInputMessage, OfKeys) {
  ExpectThereAndBack(machine::ZeroAxes{}, "key { key: 'ZERO' action: KEY_ACTION_TAP }");
  ExpectThereAndBack(machine::ClearMessage{}, "key { key: 'ERR' action: KEY_ACTION_TAP }");
  ExpectThereAndBack(machine::PressPanel{machine::PanelKey::kSpindle},
                     "key { key: 'SPINDLE' action: KEY_ACTION_TAP }");
  ExpectThereAndBack(
      machine::PressJog{.key = {.axis = JogAxis::kX, .plus = true},
                        .reference = machine::JogReference::kAbsolute,
                        .fast = true},
      "key { key: 'X+' action: KEY_ACTION_PRESS fast: true jog_reference: JOG_REFERENCE_ABS }");
  ExpectThereAndBack(machine::PressJog{.key = {.axis = JogAxis::kC, .plus = false},
                                       .reference = machine::JogReference::kTool},
                     "key { key: 'C-' action: KEY_ACTION_PRESS jog_reference: JOG_REFERENCE_TCP }");
  ExpectThereAndBack(machine::PressJog{.key = {.axis = JogAxis::kB, .plus = true},
                                       .reference = machine::JogReference::kRobot},
                     "key { key: 'B+' action: KEY_ACTION_PRESS jog_reference: JOG_REFERENCE_ROB }");
  ExpectThereAndBack(machine::ReleaseJog{{.axis = JogAxis::kZ, .plus = false}},
                     "key { key: 'Z-' action: KEY_ACTION_RELEASE }");
  ExpectThereAndBack(machine::ReleaseJogs{}, "key { action: KEY_ACTION_RELEASE }");
  // A key of the handbox, and the answer that it got.
  for (const auto& [action, word] :
       {std::pair(machine::KeyAction::kTap, "TAP"), std::pair(machine::KeyAction::kPress, "PRESS"),
        std::pair(machine::KeyAction::kRelease, "RELEASE")}) {
    ExpectThereAndBack(machine::PressedKey{.key = "X+", .action = action},
                       std::string("key { key: 'HANDBOX X+' action: KEY_ACTION_") + word + " }");
  }
  ExpectThereAndBack(
      machine::RefuseEdit{.code = ErrorCode::kCmosFull},
      "key { key: 'REFUSED " + CodeText(ErrorCode::kCmosFull) + "' action: KEY_ACTION_TAP }");
}

// Of programs and schedules a journal says only that they changed.
TEST(MachineInputMessage, OfTheMemory) {
  ExpectMessage(AppliedOf(machine::StoreProgram{.slot = 12}), "program_changed { program: 12 }");
  ExpectMessage(AppliedOf(machine::DeleteProgram{.slot = 13}), "program_changed { program: 13 }");
  ExpectMessage(AppliedOf(machine::SetSchedules{}), "");
  for (const char* none : {"program_changed { program: 12 }", "", "factor: 2", "control {}"})
    EXPECT_FALSE(*InputOf(Applied(none))) << none;
}

TEST(MachineInputMessage, WhatCannotBeIsRefused) {
  const auto said = [](const std::string& text) {
    const auto input = InputOf(Applied(text));
    if (input) return std::string("taken");
    EXPECT_EQ(input.error().code, ErrorCode::kCellInvalidArgument);
    return std::string(input.error().detail);
  };
  EXPECT_EQ(said("key { key: 'GO' action: KEY_ACTION_TAP }"), "a key 'GO'");
  EXPECT_EQ(said("key { key: 'HANDBOX REC' }"), "a key without action");
  EXPECT_EQ(said("key { key: 'REFUSED nothing' action: KEY_ACTION_TAP }"),
            "a key 'REFUSED nothing'");
  EXPECT_EQ(said("key { key: '' action: KEY_ACTION_TAP }"), "a key ''");
  EXPECT_EQ(said("start { program: 12 }"), "a start without a source");
  EXPECT_EQ(said("start { program: 12 source: START_SOURCE_QUEUE step { step: 1 } base {} }"),
            "mode is none that there is");
  EXPECT_EQ(said("start { program: 12 source: START_SOURCE_QUEUE step { step: 1 } base { mode: "
                 "OPERATING_MODE_CYCLE inputs { input { variable { name: 'V' } } } } }"),
            "variables: V needs a number or a logical value");
  EXPECT_EQ(said("mode: OPERATING_MODE_UNSPECIFIED"), "mode is none that there is");
  EXPECT_EQ(said("variable { name: 'VR[1]' value { word: 'x' } }"),
            "variables: VR[1] needs a number or a logical value");
  EXPECT_EQ(said("from_outside {}"), "inputs: one of them says nothing");
  EXPECT_EQ(said("from_outside { emergency_stop_released: false }"),
            "inputs: one of them says nothing");
  EXPECT_EQ(said("from_outside { input { name: 'IL[1]' value { real: 1 } } }"),
            "IL[1] needs a logical value");
  for (const char* gates :
       {"gates {}", "gates { programs: 1 }", "gates { programs: 1 programs: 2 programs: 3 }"}) {
    EXPECT_EQ(said(gates), "gate_programs: one for gate 1 and one for gate 2; 0 is none");
  }
}

TEST(MachineInputMessage, NumbersOfVariables) {
  const auto number = [](const std::string& value) {
    v1::Variable variable;
    EXPECT_TRUE(
        google::protobuf::TextFormat::ParseFromString("value { " + value + " }", &variable));
    return *NumberOf(variable);
  };
  EXPECT_EQ(number("real: 2.5"), 2.5);
  EXPECT_EQ(number("integer: -3"), -3.0);
  EXPECT_EQ(number("logical: true"), 1.0);
  EXPECT_EQ(number("logical: false"), 0.0);
}

// Each word of the engine has one of the contract.
template <class One, class Other>
using Words = std::vector<std::pair<One, Other>>;

TEST(MachineWords, OfStates) {
  using machine::MachineState;
  const Words<MachineState, v1::MachineState> states = {
      {MachineState::kOff, v1::MACHINE_STATE_OFF},
      {MachineState::kStarting, v1::MACHINE_STATE_STARTING},
      {MachineState::kRecovering, v1::MACHINE_STATE_RECOVERING},
      {MachineState::kNotZeroed, v1::MACHINE_STATE_NOT_ZEROED},
      {MachineState::kIdle, v1::MACHINE_STATE_IDLE},
      {MachineState::kJogging, v1::MACHINE_STATE_JOGGING},
      {MachineState::kRunning, v1::MACHINE_STATE_RUNNING},
      {MachineState::kStopping, v1::MACHINE_STATE_STOPPING},
      {MachineState::kHeld, v1::MACHINE_STATE_HELD},
      {MachineState::kAlarm, v1::MACHINE_STATE_ALARM},
      {MachineState::kInspect, v1::MACHINE_STATE_INSPECT},
      {MachineState::kLost, v1::MACHINE_STATE_LOST}};
  EXPECT_EQ(states.size(), static_cast<std::size_t>(machine::kMachineStates));
  for (const auto& [state, word] : states) EXPECT_EQ(ToProto(state), word);
}

TEST(MachineWords, OfModesSourcesAndHalts) {
  using machine::HaltReason;
  using machine::Mode;
  using machine::StartSource;
  const Words<Mode, v1::OperatingMode> modes = {{Mode::kManual, v1::OPERATING_MODE_MANUAL},
                                                {Mode::kRepeat, v1::OPERATING_MODE_REPEAT},
                                                {Mode::kCycle, v1::OPERATING_MODE_CYCLE},
                                                {Mode::kSingle, v1::OPERATING_MODE_SINGLE},
                                                {Mode::kRemote, v1::OPERATING_MODE_REMOTE}};
  for (const auto& [mode, word] : modes) {
    EXPECT_EQ(ToProto(mode), word);
    EXPECT_EQ(ModeOf(word), mode);
  }
  EXPECT_FALSE(ModeOf(v1::OPERATING_MODE_UNSPECIFIED));
  const Words<StartSource, v1::StartSource> sources = {
      {StartSource::kConsole, v1::START_SOURCE_CONSOLE},
      {StartSource::kQueue, v1::START_SOURCE_QUEUE},
      {StartSource::kPanel, v1::START_SOURCE_PANEL},
      {StartSource::kGate1, v1::START_SOURCE_GATE_1},
      {StartSource::kGate2, v1::START_SOURCE_GATE_2}};
  for (const auto& [source, word] : sources) {
    EXPECT_EQ(ToProto(source), word);
    EXPECT_EQ(StartSourceOf(word), source);
  }
  EXPECT_FALSE(StartSourceOf(v1::START_SOURCE_UNSPECIFIED));
  const Words<HaltReason, v1::HoldReason> reasons = {
      {HaltReason::kHold, v1::HOLD_REASON_HOLD},
      {HaltReason::kStop, v1::HOLD_REASON_STOP},
      {HaltReason::kProgram, v1::HOLD_REASON_PROGRAM},
      {HaltReason::kBreakpoint, v1::HOLD_REASON_BREAKPOINT},
      {HaltReason::kSingle, v1::HOLD_REASON_SINGLE}};
  for (const auto& [reason, word] : reasons) EXPECT_EQ(ToProto(reason), word);
}

TEST(MachineWords, OfKeys) {
  for (const char* name :
       {"X+", "X-", "Y+", "Y-", "Z+", "Z-", "A+", "A-", "B+", "B-", "C+", "C-"}) {
    const auto key = JogKeyOf(name);
    ASSERT_TRUE(key) << name;
    EXPECT_EQ(machine::Name(*key), name);
  }
  for (const char* none : {"", "X", "D+", "x+"}) EXPECT_FALSE(JogKeyOf(none)) << none;
  for (const auto key :
       {machine::PanelKey::kView, machine::PanelKey::kSpindle, machine::PanelKey::kZ0,
        machine::PanelKey::kOrigin, machine::PanelKey::kHome})
    EXPECT_EQ(PanelKeyOf(machine::Name(key)), key);
  EXPECT_FALSE(PanelKeyOf("NONE"));
  EXPECT_FALSE(ActionOf(v1::KEY_ACTION_UNSPECIFIED));
}

// Those of the family, in its order: what slides in millimetres, what turns in radians.
TEST(MachineWords, OfAxes) {
  const motion::AxisPose axes{{1.0, 2.0, 3.0}, 0.5, 0.25};
  const auto told = [&](std::string_view names) {
    std::string text;
    for (const v1::AxisValue& value : AxesOf(names, axes)) text += value.ShortDebugString() + "; ";
    return text;
  };
  EXPECT_EQ(told("X Y Z A B"),
            "axis: \"X\" value: 1 unit: UNIT_MILLIMETRE; axis: \"Y\" value: 2 unit: "
            "UNIT_MILLIMETRE; axis: \"Z\" value: 3 unit: UNIT_MILLIMETRE; axis: \"A\" value: 0.5 "
            "unit: UNIT_RADIAN; axis: \"B\" value: 0.25 unit: UNIT_RADIAN; ");
  EXPECT_EQ(told("A X"),
            "axis: \"A\" value: 0.5 unit: UNIT_RADIAN; axis: \"X\" value: 1 unit: "
            "UNIT_MILLIMETRE; ");
}

TEST(MachineWords, OfSchedules) {
  v1::AssignedSchedule schedule;
  schedule.set_number(3);
  schedule.set_title("steel");
  schedule.set_mode("PULSE");
  schedule.set_power_percent(12.5);
  const machine::LaserSchedule made = FromProto(schedule);
  EXPECT_EQ(made.number, 3);
  EXPECT_EQ(made.name, "steel");
  EXPECT_EQ(made.mode, "PULSE");
  EXPECT_EQ(made.power_percent, 12.5);
}

}  // namespace
}  // namespace rmlcell::bridge
