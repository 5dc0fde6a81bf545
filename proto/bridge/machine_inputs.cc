#include "proto/bridge/machine_inputs.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "proto/bridge/inputs.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/job.pb.h"
#include "rmlcell/v1/worker.pb.h"

namespace rmlcell::bridge {
namespace {

using machine::MachineInput;

v1::JogReference ReferenceOf(machine::JogReference reference) {
  switch (reference) {
    case machine::JogReference::kRobot:
      return v1::JOG_REFERENCE_ROB;
    case machine::JogReference::kAbsolute:
      return v1::JOG_REFERENCE_ABS;
    case machine::JogReference::kTool:
      break;
  }
  return v1::JOG_REFERENCE_TCP;
}

// Before the name of a key of the handbox: "ERR" and "X+" alone are what they do to the machine.
constexpr std::string_view kHandboxKey = "HANDBOX ";
constexpr std::string_view kRefusedEdit = "REFUSED ";

v1::KeyAction ToldAction(machine::KeyAction action) {
  switch (action) {
    case machine::KeyAction::kPress:
      return v1::KEY_ACTION_PRESS;
    case machine::KeyAction::kRelease:
      return v1::KEY_ACTION_RELEASE;
    case machine::KeyAction::kTap:
      break;
  }
  return v1::KEY_ACTION_TAP;
}

struct Applied {
  v1::AppliedInput& made;

  void operator()(const machine::StartRun& input) const {
    made.mutable_start()->set_program(input.program);
    made.mutable_start()->set_source(bridge::ToProto(input.source));
    made.mutable_start()->set_unzeroed(input.unzeroed);
  }
  void operator()(const machine::ZeroAxes&) const {
    made.mutable_key()->set_key("ZERO");
    made.mutable_key()->set_action(v1::KEY_ACTION_TAP);
  }
  void operator()(const machine::ResumeRun& input) const {
    made.mutable_resume()->set_source(bridge::ToProto(input.source));
    made.mutable_resume()->set_accept_displaced(input.accept_displaced);
    made.mutable_resume()->set_restore_process(input.restore_process);
  }
  void operator()(const machine::HoldRun&) const { made.set_hold(v1::HOLD_REASON_HOLD); }
  void operator()(const machine::StopRun&) const { made.set_stop(v1::HOLD_REASON_STOP); }
  void operator()(const machine::AbortRun&) const { made.set_abort(v1::HOLD_REASON_ABORT); }
  void operator()(const machine::EmergencyStop& input) const {
    made.set_emergency_stop(input.pressed);
  }
  void operator()(const machine::Acknowledge& input) const {
    made.set_acknowledged_alarm(input.alarm);
  }
  void operator()(const machine::ChangeMode& input) const {
    made.set_mode(bridge::ToProto(input.mode));
  }
  void operator()(const machine::ChangeOverride& input) const {
    made.set_override_percent(input.percent);
  }
  void operator()(const machine::ChangeInput& input) const {
    const bool logical = input.kind == machine::InputKind::kLogical;
    v1::Variable& variable = *made.mutable_from_outside()->mutable_input();
    variable.set_name((logical ? "IL[" : "IA[") + std::to_string(input.index) + "]");
    if (logical) {
      variable.mutable_value()->set_logical(input.value != 0.0);
    } else {
      variable.mutable_value()->set_real(input.value);
    }
  }
  void operator()(const machine::MoveDoor& input) const {
    made.mutable_from_outside()->set_door_open(input.open);
  }
  void operator()(const machine::SwitchPower& input) const { made.set_power(input.on); }
  void operator()(const machine::WriteVariable& input) const {
    made.mutable_variable()->set_name(input.name);
    made.mutable_variable()->mutable_value()->set_real(input.value);
  }
  void operator()(const machine::SetBreakpoints& input) const {
    v1::Breakpoints& all = *made.mutable_breakpoints();
    for (const machine::Breakpoint& one : input.breakpoints) {
      v1::Breakpoint& breakpoint = *all.add_breakpoints();
      breakpoint.mutable_step()->set_program(one.at.program);
      breakpoint.mutable_step()->set_step(one.at.step);
      breakpoint.set_condition(one.condition);
      breakpoint.set_passes(static_cast<std::int64_t>(one.from_pass));
    }
  }
  void operator()(const machine::SetSimulation& input) const {
    v1::StepPlace& until = *made.mutable_simulation_until();
    if (!input.until) return;
    until.set_program(input.until->program);
    until.set_step(input.until->step);
  }
  void operator()(const machine::StoreProgram& input) const {
    made.mutable_program_changed()->set_program(input.slot);
  }
  void operator()(const machine::DeleteProgram& input) const {
    made.mutable_program_changed()->set_program(input.slot);
  }
  void operator()(const machine::SetSchedules&) const {}
  void operator()(const machine::ClearMessage&) const {
    made.mutable_key()->set_key("ERR");
    made.mutable_key()->set_action(v1::KEY_ACTION_TAP);
  }
  void operator()(const machine::SetGates& input) const {
    for (const int program : input.programs) made.mutable_gates()->add_programs(program);
  }
  void operator()(const machine::PressPanel& input) const {
    made.mutable_key()->set_key(std::string(machine::Name(input.key)));
    made.mutable_key()->set_action(v1::KEY_ACTION_TAP);
  }
  void operator()(const machine::PressGate& input) const {
    made.mutable_from_outside()->set_gate(input.gate);
  }
  void operator()(const machine::StartAtStep& input) const {
    v1::StartInput& start = *made.mutable_start();
    start.set_program(input.program);
    start.set_source(bridge::ToProto(input.source));
    start.mutable_step()->set_program(input.target.at.program);
    start.mutable_step()->set_step(input.target.at.step);
    start.set_occurrence(static_cast<std::int64_t>(input.target.occurrence));
    start.set_approach(input.way == machine::ApproachWay::kSafe ? v1::APPROACH_SAFE
                                                                : v1::APPROACH_DIRECT);
    start.set_halt_at_entry(input.halt_at_entry);
    start.set_off_until_work_on(input.off_until_work_on);
    if (input.base) *start.mutable_base() = bridge::ToProto(*input.base, input.program);
  }
  void operator()(const machine::PressJog& input) const {
    made.mutable_key()->set_key(machine::Name(input.key));
    made.mutable_key()->set_action(v1::KEY_ACTION_PRESS);
    made.mutable_key()->set_fast(input.fast);
    made.mutable_key()->set_jog_reference(ReferenceOf(input.reference));
  }
  void operator()(const machine::ReleaseJog& input) const {
    made.mutable_key()->set_key(machine::Name(input.key));
    made.mutable_key()->set_action(v1::KEY_ACTION_RELEASE);
  }
  // Of no key by name: all of them.
  void operator()(const machine::ReleaseJogs&) const {
    made.mutable_key()->set_action(v1::KEY_ACTION_RELEASE);
  }
  void operator()(const machine::PressedKey& input) const {
    made.mutable_key()->set_key(std::string(kHandboxKey) + input.key);
    made.mutable_key()->set_action(ToldAction(input.action));
  }
  // The answer that a key of the handbox got, beside that key.
  void operator()(const machine::RefuseEdit& input) const {
    made.mutable_key()->set_key(std::string(kRefusedEdit) + CodeText(input.code));
    made.mutable_key()->set_action(v1::KEY_ACTION_TAP);
  }
};

Result<MachineInput> OfWrittenVariable(const v1::Variable& variable) {
  const Result<double> value = NumberOf(variable);
  if (!value) return value.error();
  return MachineInput(machine::WriteVariable{.name = variable.name(), .value = *value});
}

machine::JogReference JogReferenceOf(v1::JogReference reference) {
  switch (reference) {
    case v1::JOG_REFERENCE_ABS:
      return machine::JogReference::kAbsolute;
    case v1::JOG_REFERENCE_TCP:
      return machine::JogReference::kTool;
    default:
      return machine::JogReference::kRobot;
  }
}

Result<MachineInput> OfKey(const v1::PressedKey& key) {
  if (key.key().empty() && key.action() == v1::KEY_ACTION_RELEASE)
    return MachineInput(machine::ReleaseJogs{});
  if (const auto jog = JogKeyOf(key.key())) {
    if (key.action() == v1::KEY_ACTION_RELEASE) return MachineInput(machine::ReleaseJog{*jog});
    return MachineInput(machine::PressJog{
        .key = *jog, .reference = JogReferenceOf(key.jog_reference()), .fast = key.fast()});
  }
  const std::string_view name = key.key();
  if (name.starts_with(kHandboxKey)) {
    const auto action = bridge::ActionOf(key.action());
    if (!action) return Error{ErrorCode::kCellInvalidArgument, "a key without action", {}};
    return MachineInput(machine::PressedKey{.key = std::string(name.substr(kHandboxKey.size())),
                                            .action = *action});
  }
  if (name.starts_with(kRefusedEdit)) {
    const auto rows = FindByText(name.substr(kRefusedEdit.size()));
    if (rows.size() == 1) return MachineInput(machine::RefuseEdit{.code = rows.front()->code});
  }
  if (const auto panel = PanelKeyOf(name)) return MachineInput(machine::PressPanel{*panel});
  if (key.key() == "ZERO") return MachineInput(machine::ZeroAxes{});
  if (key.key() == "ERR") return MachineInput(machine::ClearMessage{});
  return Error{ErrorCode::kCellInvalidArgument, "a key '" + key.key() + "'", {}};
}

Result<MachineInput> OfStart(const v1::StartInput& start) {
  const auto source = StartSourceOf(start.source());
  if (!source) return Error{ErrorCode::kCellInvalidArgument, "a start without a source", {}};
  if (start.has_step()) {
    std::optional<machine::StartBase> base;
    if (start.has_base()) {
      auto known = FromProto(start.base());
      if (!known) return known.error();
      base = *std::move(known);
    }
    // It has acted: whatever a person had to see to was seen to.
    return MachineInput(machine::StartAtStep{
        .program = start.program(),
        .source = *source,
        .target = {.at = {.program = start.step().program(), .step = start.step().step()},
                   .occurrence =
                       static_cast<std::uint64_t>(std::max<std::int64_t>(1, start.occurrence()))},
        .way = start.approach() == v1::APPROACH_DIRECT ? machine::ApproachWay::kDirect
                                                       : machine::ApproachWay::kSafe,
        .off_until_work_on = start.off_until_work_on(),
        .halt_at_entry = start.halt_at_entry(),
        .base = std::move(base),
        .acknowledged = {"clamps", "tool", "origin", "Z0", "table"}});
  }
  return MachineInput(machine::StartRun{
      .program = start.program(), .source = *source, .unzeroed = start.unzeroed()});
}

Result<MachineInput> OfMode(v1::OperatingMode mode) {
  const auto known = ModeOf(mode);
  if (!known) return Error{ErrorCode::kCellInvalidArgument, "mode is none that there is", {}};
  return MachineInput(machine::ChangeMode{.mode = *known});
}

MachineInput OfBreakpoints(const v1::Breakpoints& breakpoints) {
  machine::SetBreakpoints set;
  for (const v1::Breakpoint& one : breakpoints.breakpoints())
    set.breakpoints.push_back(FromProto(one, 0));
  return set;
}

MachineInput OfSimulation(const v1::StepPlace& until) {
  machine::SetSimulation set;
  if (until.step() != 0) set.until = {.program = until.program(), .step = until.step()};
  return set;
}

}  // namespace

v1::MachineState ToProto(machine::MachineState state) {
  switch (state) {
    case machine::MachineState::kOff:
      return v1::MACHINE_STATE_OFF;
    case machine::MachineState::kStarting:
      return v1::MACHINE_STATE_STARTING;
    case machine::MachineState::kRecovering:
      return v1::MACHINE_STATE_RECOVERING;
    case machine::MachineState::kNotZeroed:
      return v1::MACHINE_STATE_NOT_ZEROED;
    case machine::MachineState::kIdle:
      return v1::MACHINE_STATE_IDLE;
    case machine::MachineState::kJogging:
      return v1::MACHINE_STATE_JOGGING;
    case machine::MachineState::kRunning:
      return v1::MACHINE_STATE_RUNNING;
    case machine::MachineState::kStopping:
      return v1::MACHINE_STATE_STOPPING;
    case machine::MachineState::kHeld:
      return v1::MACHINE_STATE_HELD;
    case machine::MachineState::kAlarm:
      return v1::MACHINE_STATE_ALARM;
    case machine::MachineState::kInspect:
      return v1::MACHINE_STATE_INSPECT;
    case machine::MachineState::kLost:
      break;
  }
  return v1::MACHINE_STATE_LOST;
}

v1::OperatingMode ToProto(machine::Mode mode) {
  switch (mode) {
    case machine::Mode::kManual:
      return v1::OPERATING_MODE_MANUAL;
    case machine::Mode::kRepeat:
      return v1::OPERATING_MODE_REPEAT;
    case machine::Mode::kCycle:
      return v1::OPERATING_MODE_CYCLE;
    case machine::Mode::kSingle:
      return v1::OPERATING_MODE_SINGLE;
    case machine::Mode::kRemote:
      break;
  }
  return v1::OPERATING_MODE_REMOTE;
}

v1::StartSource ToProto(machine::StartSource source) {
  switch (source) {
    case machine::StartSource::kConsole:
      return v1::START_SOURCE_CONSOLE;
    case machine::StartSource::kQueue:
      return v1::START_SOURCE_QUEUE;
    case machine::StartSource::kPanel:
      return v1::START_SOURCE_PANEL;
    case machine::StartSource::kGate1:
      return v1::START_SOURCE_GATE_1;
    case machine::StartSource::kGate2:
      break;
  }
  return v1::START_SOURCE_GATE_2;
}

v1::HoldReason ToProto(machine::HaltReason reason) {
  switch (reason) {
    case machine::HaltReason::kHold:
      return v1::HOLD_REASON_HOLD;
    case machine::HaltReason::kStop:
      return v1::HOLD_REASON_STOP;
    case machine::HaltReason::kProgram:
      return v1::HOLD_REASON_PROGRAM;
    case machine::HaltReason::kBreakpoint:
      return v1::HOLD_REASON_BREAKPOINT;
    case machine::HaltReason::kSingle:
      return v1::HOLD_REASON_SINGLE;
  }
  return v1::HOLD_REASON_UNSPECIFIED;
}

std::optional<machine::StartSource> StartSourceOf(v1::StartSource source) {
  switch (source) {
    case v1::START_SOURCE_CONSOLE:
      return machine::StartSource::kConsole;
    case v1::START_SOURCE_QUEUE:
      return machine::StartSource::kQueue;
    case v1::START_SOURCE_PANEL:
      return machine::StartSource::kPanel;
    case v1::START_SOURCE_GATE_1:
      return machine::StartSource::kGate1;
    case v1::START_SOURCE_GATE_2:
      return machine::StartSource::kGate2;
    default:
      return std::nullopt;
  }
}

std::optional<machine::Mode> ModeOf(v1::OperatingMode mode) {
  switch (mode) {
    case v1::OPERATING_MODE_MANUAL:
      return machine::Mode::kManual;
    case v1::OPERATING_MODE_REPEAT:
      return machine::Mode::kRepeat;
    case v1::OPERATING_MODE_CYCLE:
      return machine::Mode::kCycle;
    case v1::OPERATING_MODE_SINGLE:
      return machine::Mode::kSingle;
    case v1::OPERATING_MODE_REMOTE:
      return machine::Mode::kRemote;
    default:
      return std::nullopt;
  }
}

v1::AppliedInput AppliedOf(const MachineInput& input) {
  v1::AppliedInput made;
  std::visit(Applied{made}, input);
  return made;
}

Result<MachineInput> FromProto(const v1::MachineInput& input) {
  switch (input.what_case()) {
    case v1::MachineInput::kInput: {
      v1::ScriptedInput scripted;
      *scripted.mutable_input()->mutable_from_outside() = input;
      const Result<machine::InputChange> change = FromProto(scripted, 100.0);
      if (!change) return change.error();
      return MachineInput(machine::ChangeInput{
          .kind = change->kind, .index = change->index, .value = change->value});
    }
    case v1::MachineInput::kDoorOpen:
      return MachineInput(machine::MoveDoor{.open = input.door_open()});
    case v1::MachineInput::kPower:
      return MachineInput(machine::SwitchPower{.on = input.power()});
    case v1::MachineInput::kEmergencyStopReleased:
      if (!input.emergency_stop_released()) break;
      return MachineInput(machine::EmergencyStop{.pressed = false});
    case v1::MachineInput::kGate:
      return MachineInput(machine::PressGate{.gate = input.gate()});
    case v1::MachineInput::WHAT_NOT_SET:
      break;
  }
  return Error{ErrorCode::kCellInvalidArgument, "inputs: one of them says nothing", {}};
}

v1::RunBase ToProto(const machine::StartBase& base, int program) {
  v1::RunBase made;
  made.set_program(program);
  made.set_machine_state(base.machine_state);
  made.set_mode(ToProto(base.mode));
  made.set_override_percent(base.override_percent);
  for (const machine::InputChange& change : base.inputs) {
    v1::RunBaseInput& input = *made.add_inputs();
    input.set_run_time_ns(change.at.count());
    *input.mutable_input() = ToProto(change);
  }
  return made;
}

namespace {

Result<machine::InputChange> BaseInputOf(const v1::AppliedInput& input) {
  if (!input.has_variable()) return ChangeOf(input, std::numeric_limits<double>::infinity());
  const Result<double> value = NumberOf(input.variable());
  if (!value) return value.error();
  return machine::InputChange{
      .kind = machine::InputKind::kVariable, .value = *value, .name = input.variable().name()};
}

}  // namespace

Result<machine::StartBase> FromProto(const v1::RunBase& base) {
  const auto mode = ModeOf(base.mode());
  if (!mode) return Error{ErrorCode::kCellInvalidArgument, "mode is none that there is", {}};
  machine::StartBase made{.machine_state = base.machine_state(),
                          .inputs = {},
                          .mode = *mode,
                          .override_percent = base.override_percent()};
  for (const v1::RunBaseInput& input : base.inputs()) {
    auto change = BaseInputOf(input.input());
    if (!change) return change.error();
    change->at = SimTime(input.run_time_ns());
    made.inputs.push_back(*change);
  }
  return made;
}

Result<machine::SetGates> FromProto(const v1::GatePrograms& gates) {
  machine::SetGates set;
  if (gates.programs_size() != machine::kGates)
    return Error{ErrorCode::kCellInvalidArgument,
                 "gate_programs: one for gate 1 and one for gate 2; 0 is none",
                 {}};
  std::ranges::copy(gates.programs(), set.programs.begin());
  return set;
}

Result<double> NumberOf(const v1::Variable& variable) {
  switch (variable.value().value_case()) {
    case v1::VariableValue::kReal:
      return variable.value().real();
    case v1::VariableValue::kInteger:
      return static_cast<double>(variable.value().integer());
    case v1::VariableValue::kLogical:
      return variable.value().logical() ? 1.0 : 0.0;
    default:
      return Error{ErrorCode::kCellInvalidArgument,
                   "variables: " + variable.name() + " needs a number or a logical value",
                   {}};
  }
}

std::vector<v1::AxisValue> AxesOf(std::string_view names, const motion::AxisPose& axes) {
  const std::array<std::pair<std::string_view, double>, 5> known = {{{"X", axes.column.x()},
                                                                     {"Y", axes.column.y()},
                                                                     {"Z", axes.column.z()},
                                                                     {"A", axes.a_rad},
                                                                     {"B", axes.b_rad}}};
  std::vector<v1::AxisValue> values;
  std::istringstream words{std::string(names)};
  for (std::string word; words >> word;) {
    for (const auto& [name, value] : known) {
      if (name != word) continue;
      v1::AxisValue& axis = values.emplace_back();
      axis.set_axis(word);
      axis.set_value(value);
      axis.set_unit(name < "X" ? v1::UNIT_RADIAN : v1::UNIT_MILLIMETRE);
    }
  }
  return values;
}

std::optional<machine::JogKey> JogKeyOf(std::string_view name) {
  using Axis = machine::JogAxis;
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ, Axis::kA, Axis::kB, Axis::kC}) {
    for (const bool plus : {false, true}) {
      const machine::JogKey key{.axis = axis, .plus = plus};
      if (machine::Name(key) == name) return key;
    }
  }
  return std::nullopt;
}

std::optional<machine::KeyAction> ActionOf(v1::KeyAction action) {
  switch (action) {
    case v1::KEY_ACTION_TAP:
      return machine::KeyAction::kTap;
    case v1::KEY_ACTION_PRESS:
      return machine::KeyAction::kPress;
    case v1::KEY_ACTION_RELEASE:
      return machine::KeyAction::kRelease;
    default:
      return std::nullopt;
  }
}

std::optional<machine::PanelKey> PanelKeyOf(std::string_view name) {
  using machine::PanelKey;
  for (const PanelKey key :
       {PanelKey::kView, PanelKey::kSpindle, PanelKey::kZ0, PanelKey::kOrigin, PanelKey::kHome}) {
    if (machine::Name(key) == name) return key;
  }
  return std::nullopt;
}

machine::LaserSchedule FromProto(const v1::AssignedSchedule& schedule) {
  return {.number = schedule.number(),
          .name = schedule.title(),
          .mode = schedule.mode(),
          .power_percent = schedule.power_percent()};
}

Result<std::optional<MachineInput>> InputOf(const v1::AppliedInput& applied) {
  using Known = std::optional<MachineInput>;
  const auto of = [](Result<MachineInput> input) -> Result<Known> {
    if (!input) return input.error();
    return Known(*std::move(input));
  };
  switch (applied.input_case()) {
    case v1::AppliedInput::kKey:
      return of(OfKey(applied.key()));
    case v1::AppliedInput::kStart:
      return of(OfStart(applied.start()));
    case v1::AppliedInput::kResume:
      return Known(machine::ResumeRun{
          .source =
              StartSourceOf(applied.resume().source()).value_or(machine::StartSource::kConsole),
          .accept_displaced = applied.resume().accept_displaced(),
          .restore_process = applied.resume().restore_process()});
    case v1::AppliedInput::kHold:
      return Known(machine::HoldRun{});
    case v1::AppliedInput::kStop:
      return Known(machine::StopRun{});
    case v1::AppliedInput::kAbort:
      return Known(machine::AbortRun{});
    case v1::AppliedInput::kOverridePercent:
      return Known(machine::ChangeOverride{.percent = applied.override_percent()});
    case v1::AppliedInput::kFromOutside:
      return of(FromProto(applied.from_outside()));
    case v1::AppliedInput::kVariable:
      return of(OfWrittenVariable(applied.variable()));
    case v1::AppliedInput::kMode:
      return of(OfMode(applied.mode()));
    case v1::AppliedInput::kAcknowledgedAlarm:
      return Known(machine::Acknowledge{.alarm = applied.acknowledged_alarm()});
    case v1::AppliedInput::kBreakpoints:
      return of(OfBreakpoints(applied.breakpoints()));
    case v1::AppliedInput::kSimulationUntil:
      return of(OfSimulation(applied.simulation_until()));
    case v1::AppliedInput::kEmergencyStop:
      return Known(machine::EmergencyStop{.pressed = applied.emergency_stop()});
    case v1::AppliedInput::kGates: {
      const auto gates = FromProto(applied.gates());
      return of(gates ? Result<MachineInput>(*gates) : gates.error());
    }
    case v1::AppliedInput::kPower:
      return Known(machine::SwitchPower{.on = applied.power()});
    case v1::AppliedInput::kFactor:
    case v1::AppliedInput::kControl:
    case v1::AppliedInput::kProgramChanged:
    case v1::AppliedInput::INPUT_NOT_SET:
      break;
  }
  return Known();
}

}  // namespace rmlcell::bridge
