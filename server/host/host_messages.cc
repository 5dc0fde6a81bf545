#include "server/host/host_messages.h"

#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "engine/core/number_text.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/report.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::server {
namespace {

using machine::MachineInput;

Error Invalid(std::string detail) {
  return {ErrorCode::kCellInvalidArgument, std::move(detail), {}};
}

// In the order of the family: of those that slide and of those that turn.
void AddAxes(std::string_view names, const motion::AxisPose& axes, v1::MachineStatus& status) {
  const std::array<std::pair<std::string_view, double>, 5> known = {{{"X", axes.column.x()},
                                                                     {"Y", axes.column.y()},
                                                                     {"Z", axes.column.z()},
                                                                     {"A", axes.a_rad},
                                                                     {"B", axes.b_rad}}};
  std::istringstream words{std::string(names)};
  for (std::string word; words >> word;) {
    for (const auto& [name, value] : known) {
      if (name != word) continue;
      v1::AxisValue& axis = *status.add_axes();
      axis.set_axis(word);
      axis.set_value(value);
      axis.set_unit(name < "X" ? v1::UNIT_RADIAN : v1::UNIT_MILLIMETRE);
    }
  }
}

void SetRun(const machine::Machine& machine, const machine::MachineStatus& status,
            const v1::JobProgress& progress, v1::MachineStatus& message) {
  if (!status.open) return;
  v1::MachineRun& run = *message.mutable_run();
  run.set_run(status.open->number);
  run.set_program(status.open->program);
  *run.mutable_place() = progress.place();
  run.set_phase(v1::RUN_PHASE_PROGRAM);
  run.set_run_time_ns(status.run.time.count());
  run.set_source(ToProto(status.open->source));
  run.set_instruction(progress.instruction());
  run.set_dry(machine.simulation_until().has_value());
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

Result<MachineInput> InputOf(const v1::MachineInput& input) {
  switch (input.what_case()) {
    case v1::MachineInput::kInput: {
      v1::ScriptedInput scripted;
      *scripted.mutable_input()->mutable_from_outside() = input;
      const Result<machine::InputChange> change = bridge::FromProto(scripted, 100.0);
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
      return Error{ErrorCode::kCellUnimplemented, "inputs: a gate", {}};
    case v1::MachineInput::WHAT_NOT_SET:
      break;
  }
  return Invalid("inputs: one of them says nothing");
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
      return Invalid("variables: " + variable.name() + " needs a number or a logical value");
  }
}

Result<int> ProgramOf(const v1::StartMachineRequest& start, const machine::Machine& machine) {
  switch (start.what_case()) {
    case v1::StartMachineRequest::kProgram:
      return start.program();
    case v1::StartMachineRequest::kSelected: {
      const int selected = machine.status().shown.program;
      if (selected > 0) return selected;
      return Invalid("selected: no program was started yet; name one");
    }
    case v1::StartMachineRequest::kJob:
      return Error{ErrorCode::kCellUnimplemented, "StartMachine: a job", {}};
    case v1::StartMachineRequest::WHAT_NOT_SET:
      break;
  }
  return Invalid("say what is started: program or selected");
}

struct Applied {
  v1::AppliedInput& made;

  void operator()(const machine::StartRun& input) const {
    made.mutable_start()->set_program(input.program);
    made.mutable_start()->set_source(ToProto(input.source));
    made.mutable_start()->set_unzeroed(input.unzeroed);
  }
  void operator()(const machine::ZeroAxes&) const {
    made.mutable_key()->set_key("ZERO");
    made.mutable_key()->set_action(v1::KEY_ACTION_TAP);
  }
  void operator()(const machine::ResumeRun& input) const {
    made.mutable_resume()->set_source(ToProto(input.source));
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
  void operator()(const machine::ChangeMode& input) const { made.set_mode(ToProto(input.mode)); }
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
  void operator()(const machine::StartAtStep& input) const {
    v1::StartInput& start = *made.mutable_start();
    start.set_program(input.program);
    start.set_source(ToProto(input.source));
    start.mutable_step()->set_program(input.target.at.program);
    start.mutable_step()->set_step(input.target.at.step);
    start.set_occurrence(static_cast<std::int64_t>(input.target.occurrence));
    start.set_approach(input.way == machine::ApproachWay::kSafe ? v1::APPROACH_SAFE
                                                                : v1::APPROACH_DIRECT);
    start.set_halt_at_entry(input.halt_at_entry);
  }
  void operator()(const machine::ClearMessage&) const {
    made.mutable_key()->set_key("ERR");
    made.mutable_key()->set_action(v1::KEY_ACTION_TAP);
  }
};

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

v1::MachineStatus ToProto(const machine::Machine& machine) {
  const machine::MachineStatus status = machine.status();
  const machine::FamilyInfo& family = machine.family().info();
  const v1::JobProgress progress = bridge::ToProto(family, status.run, 0);
  v1::MachineStatus message;
  message.set_virtual_time_ns(status.time.count());
  message.set_state(ToProto(status.state));
  message.set_mode(ToProto(status.mode));
  message.set_zeroed(status.run.zeroed);
  message.set_door_open(status.run.door_open);
  for (const machine::Alarm& alarm : status.alarms) {
    v1::Alarm& made = *message.add_alarms();
    made.set_id(alarm.id);
    *made.mutable_diagnostic() = bridge::ToProto(Diagnostic{.code = alarm.code,
                                                            .severity = Lookup(alarm.code).severity,
                                                            .detail = alarm.detail,
                                                            .program = alarm.place.program,
                                                            .step = alarm.place.step});
    made.set_virtual_time_ns(alarm.at.count());
    made.set_cause_gone(machine.MayAcknowledge(alarm));
  }
  SetRun(machine, status, progress, message);
  if (status.run.halted_by && status.state == machine::MachineState::kHeld)
    message.set_hold_reason(ToProto(*status.run.halted_by));
  if (status.mode == machine::Mode::kRemote) {
    message.add_start_sources(v1::START_SOURCE_CONSOLE);
    message.add_start_sources(v1::START_SOURCE_QUEUE);
  } else if (status.mode != machine::Mode::kManual) {
    message.add_start_sources(v1::START_SOURCE_PANEL);
  }
  AddAxes(family.axes, status.run.axes, message);
  *message.mutable_tip() = progress.position().tip();
  if (progress.has_work_tip()) *message.mutable_work_tip() = progress.work_tip();
  message.set_speed_mm_s(status.run.tip_speed_mm_s);
  message.set_position_source(v1::POSITION_SOURCE_PLANNED);
  message.set_override_percent(status.override_percent);
  message.mutable_tool()->set_on(status.run.beam_on || status.run.spindle_on);
  for (const std::string_view lamp : machine.panel().lamps) message.add_lamps(std::string(lamp));
  message.set_selected_program(status.shown.program);
  return message;
}

v1::RunState RunStateOf(const machine::Machine& machine) {
  v1::RunState state;
  for (const machine::Place& place : machine.stack()) *state.add_stack() = bridge::ToProto(place);
  for (const machine::ModalValue& value : machine.modal_values()) {
    v1::ModalValue& made = *state.add_values();
    made.set_name(value.name);
    made.set_value(value.value);
  }
  v1::AppliedInput breakpoints;
  Applied{breakpoints}(machine::SetBreakpoints{.breakpoints = machine.breakpoints()});
  state.mutable_breakpoints()->Swap(breakpoints.mutable_breakpoints()->mutable_breakpoints());
  if (const auto until = machine.simulation_until()) {
    state.mutable_simulation_until()->set_program(until->program);
    state.mutable_simulation_until()->set_step(until->step);
  }
  state.set_virtual_time_ns(machine.time().count());
  return state;
}

namespace {

// Of a run: begin, go on, come to rest, end.
Result<std::optional<MachineInput>> OfRun(const v1::HostOrder& order,
                                          const machine::Machine& machine) {
  using Input = std::optional<MachineInput>;
  switch (order.request_case()) {
    case v1::HostOrder::kStart: {
      const Result<int> program = ProgramOf(order.start(), machine);
      if (!program) return program.error();
      return Input(machine::StartRun{.program = *program});
    }
    case v1::HostOrder::kRunJob:
      return Input(machine::StartRun{.program = order.run_job().main_program(),
                                     .source = machine::StartSource::kQueue,
                                     .unzeroed = order.run_job().job().run().unzeroed()});
    case v1::HostOrder::kZero:
      return Input(machine::ZeroAxes{});
    case v1::HostOrder::kResume:
      return Input(machine::ResumeRun{});
    case v1::HostOrder::kStop:
      return Input(machine::StopRun{});
    case v1::HostOrder::kHold:
      return Input(machine::HoldRun{});
    case v1::HostOrder::kEmergencyStop:
      return Input(machine::EmergencyStop{});
    case v1::HostOrder::kAbort: {
      const auto open = machine.status().open;
      const std::int64_t meant = order.abort().run();
      if (meant == 0 || (open && open->number == meant)) return Input(machine::AbortRun{});
      return Error{
          ErrorCode::kCellMachineState, "run " + std::to_string(meant) + " is not open", {}};
    }
    default:
      return Input();
  }
}

// Of how it is set: mode, override, alarms, breakpoints, dry run.
Result<std::optional<MachineInput>> OfSetting(const v1::HostOrder& order,
                                              const machine::Machine& machine) {
  using Input = std::optional<MachineInput>;
  const int selected = machine.status().shown.program;
  switch (order.request_case()) {
    case v1::HostOrder::kMode: {
      const auto mode = ModeOf(order.mode().mode());
      if (!mode) return Invalid("mode is none that there is");
      return Input(machine::ChangeMode{.mode = *mode});
    }
    case v1::HostOrder::kOverride:
      return Input(machine::ChangeOverride{.percent = order.override().override_percent()});
    case v1::HostOrder::kAcknowledgeAlarm:
      return Input(machine::Acknowledge{.alarm = order.acknowledge_alarm().alarm_id()});
    case v1::HostOrder::kBreakpoints: {
      machine::SetBreakpoints set;
      for (const v1::Breakpoint& one : order.breakpoints().breakpoints())
        set.breakpoints.push_back(bridge::FromProto(one, selected));
      return Input(std::move(set));
    }
    case v1::HostOrder::kSimulation: {
      machine::SetSimulation set;
      const v1::StepPlace& until = order.simulation().until();
      if (order.simulation().has_until())
        set.until = {.program = until.program() != 0 ? until.program() : selected,
                     .step = until.step()};
      return Input(set);
    }
    default:
      return Input();
  }
}

}  // namespace

Result<std::vector<MachineInput>> InputsOf(const v1::HostOrder& order,
                                           const machine::Machine& machine) {
  std::vector<MachineInput> inputs;
  for (const auto of : {OfRun, OfSetting}) {
    Result<std::optional<MachineInput>> input = of(order, machine);
    if (!input) return input.error();
    if (*input) inputs.push_back(*std::move(*input));
  }
  for (const v1::Variable& variable : order.write_variables().variables()) {
    const Result<double> value = NumberOf(variable);
    if (!value) return value.error();
    inputs.emplace_back(machine::WriteVariable{.name = variable.name(), .value = *value});
  }
  for (const v1::MachineInput& one : order.inputs().inputs()) {
    Result<MachineInput> input = InputOf(one);
    if (!input) return input.error();
    inputs.push_back(*std::move(input));
  }
  if (order.has_inputs() && inputs.empty()) return Invalid("inputs: none is given");
  return inputs;
}

v1::AppliedInput AppliedOf(const MachineInput& input) {
  v1::AppliedInput made;
  std::visit(Applied{made}, input);
  return made;
}

Result<v1::ReadVariablesResponse> ReadVariables(const machine::Machine& machine,
                                                const v1::ReadVariablesRequest& request) {
  const auto names =
      bridge::ExpandVariables({request.variables().begin(), request.variables().end()});
  if (!names) return names.error();
  v1::ReadVariablesResponse response;
  for (const std::string& name : *names) {
    if (const auto value = machine.ReadVariable(name)) {
      *response.add_variables() = bridge::ToProto(machine::NamedVariable{name, *value});
      continue;
    }
    v1::Variable& none = *response.add_variables();
    none.set_name(name);
    *none.mutable_error() =
        bridge::ToProto(Diagnostic{.code = ErrorCode::kCellInvalidArgument,
                                   .severity = Severity::kRequest,
                                   .detail = "the machine has no such variable"});
  }
  response.set_virtual_time_ns(machine.time().count());
  return response;
}

}  // namespace rmlcell::server
