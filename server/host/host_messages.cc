#include "server/host/host_messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/number_text.h"
#include "proto/bridge/findings.h"
#include "proto/bridge/inputs.h"
#include "proto/bridge/machine_inputs.h"
#include "proto/bridge/report.h"
#include "proto/bridge/setup.h"
#include "rmlcell/v1/job.pb.h"

namespace rmlcell::server {
namespace {

using machine::MachineInput;

void SetOutputs(const machine::MachineOutputs& outputs, v1::MachineStatus& message) {
  for (const machine::OutputNow& one : outputs.on) {
    v1::OutputValue& made = *message.add_outputs();
    made.set_name(one.name);
    made.set_value(one.value);
  }
  message.mutable_tool()->set_power_percent(outputs.power_percent);
  message.mutable_tool()->set_laser_schedule(outputs.laser_schedule);
}

Error Invalid(std::string detail) {
  return {ErrorCode::kCellInvalidArgument, std::move(detail), {}};
}

void SetRun(const machine::Machine& machine, const machine::MachineStatus& status,
            const v1::JobProgress& progress, v1::MachineStatus& message) {
  if (!status.open) return;
  const auto waiting = machine.family().info().waiting;
  v1::MachineRun& run = *message.mutable_run();
  run.set_run(status.open->number);
  run.set_program(status.open->program);
  *run.mutable_place() = progress.place();
  run.set_phase(status.run.approaching ? v1::RUN_PHASE_APPROACH : v1::RUN_PHASE_PROGRAM);
  run.set_run_time_ns(status.run.time.count());
  run.set_source(bridge::ToProto(status.open->source));
  run.set_instruction(progress.instruction());
  run.set_waits(status.state == machine::MachineState::kHeld ||
                std::ranges::find(waiting, progress.instruction()) != waiting.end());
  run.set_dry(status.run.dry);
  run.set_executions(status.run.executions);
  for (const int program : machine.loaded_programs()) run.add_loaded_programs(program);
}

Result<int> ProgramOf(const v1::StartMachineRequest& start, const machine::Machine& machine) {
  switch (start.what_case()) {
    case v1::StartMachineRequest::kProgram:
      return start.program();
    case v1::StartMachineRequest::kSelected: {
      const int selected = machine.selected_program();
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

}  // namespace

v1::LastRun LastRunOf(const v1::RunOver& over) {
  v1::LastRun last;
  last.set_run(over.run());
  last.set_program(over.program());
  last.set_job(over.job());
  *last.mutable_outcome() = over.outcome();
  return last;
}

const google::protobuf::Message* RequestOf(const v1::HostOrder& order) {
  if (order.has_by_person()) return &order.by_person();
  if (order.has_continue_job()) {  // a person decided that, or it is the queue's, as run_job
    const v1::ContinueJob& job = order.continue_job();
    if (job.assignment().job().continues().empty()) return &job.assignment();
    return &job.start();
  }
  const auto* set = order.GetReflection()->GetOneofFieldDescriptor(
      order, order.GetDescriptor()->FindOneofByName("request"));
  return set == nullptr ? nullptr : &order.GetReflection()->GetMessage(order, set);
}

std::optional<std::string> FieldOf(const v1::HostOrder& order, const std::string& name) {
  const google::protobuf::Message* request = RequestOf(order);
  if (request == nullptr) return std::nullopt;
  const auto* field = request->GetDescriptor()->FindFieldByName(name);
  if (field == nullptr) return std::nullopt;
  return request->GetReflection()->GetString(*request, field);
}

v1::MachineStatus ToProto(const machine::Machine& machine) {
  const machine::MachineStatus status = machine.status();
  const machine::FamilyInfo& family = machine.family().info();
  const v1::JobProgress progress = bridge::ToProto(family, status.run, 0);
  v1::MachineStatus message;
  message.set_virtual_time_ns(status.time.count());
  message.set_state(bridge::ToProto(status.state));
  message.set_mode(bridge::ToProto(status.mode));
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
    message.set_hold_reason(bridge::ToProto(*status.run.halted_by));
  if (status.mode == machine::Mode::kRemote) {
    message.add_start_sources(v1::START_SOURCE_CONSOLE);
    message.add_start_sources(v1::START_SOURCE_QUEUE);
  } else if (status.mode != machine::Mode::kManual) {
    message.add_start_sources(v1::START_SOURCE_PANEL);
  }
  for (v1::AxisValue& axis : bridge::AxesOf(family.axes, status.run.axes))
    *message.add_axes() = std::move(axis);
  *message.mutable_tip() = progress.position().tip();
  if (progress.has_work_tip()) *message.mutable_work_tip() = progress.work_tip();
  message.set_speed_mm_s(status.run.tip_speed_mm_s);
  message.set_position_source(v1::POSITION_SOURCE_PLANNED);
  message.set_override_percent(status.override_percent);
  SetOutputs(machine.outputs(), message);
  message.mutable_tool()->set_on(status.run.beam_on || status.run.spindle_on);
  if (status.run.spindle_on && !family.spindle_speed.empty()) {
    if (const auto rpm = machine.ReadVariable(family.spindle_speed))
      message.mutable_tool()->set_speed_rpm(ParseDouble(rpm->text).value_or(0.0));
  }
  for (const std::string_view lamp : machine.panel().lamps) message.add_lamps(std::string(lamp));
  message.set_selected_program(machine.selected_program());
  if (machine.has_gates()) {
    for (const int program : machine.gates()) message.add_gate_programs(program);
  }
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
  v1::AppliedInput breakpoints =
      bridge::AppliedOf(machine::SetBreakpoints{.breakpoints = machine.breakpoints()});
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
      return Input(machine::ResumeRun{.accept_displaced = order.resume().accept_displaced(),
                                      .restore_process = order.resume().restore_process()});
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

// Of a key of a mill's panel: what it does when it is pressed, and when it is let go. LIVE-2.13
Result<std::vector<MachineInput>> OfPanelKey(const v1::PressPanelKeyRequest& request,
                                             const machine::Machine& machine) {
  using Inputs = std::vector<MachineInput>;
  if (machine.family().info().jogs_in_manual)
    return Error{ErrorCode::kCellNotLive, "the machine has a handbox and no panel", {}};
  if (request.action() == v1::KEY_ACTION_UNSPECIFIED) return Invalid("action: say which");
  const std::string& key = request.key();
  const bool pressed = request.action() != v1::KEY_ACTION_RELEASE;
  if (const auto jog = bridge::JogKeyOf(key)) {
    Inputs inputs;
    if (pressed) inputs.emplace_back(machine::PressJog{.key = *jog, .fast = request.fast()});
    if (request.action() != v1::KEY_ACTION_PRESS) inputs.emplace_back(machine::ReleaseJog{*jog});
    return inputs;
  }
  if (const auto panel = bridge::PanelKeyOf(key))
    return pressed ? Inputs{machine::PressPanel{*panel}} : Inputs{};
  if (key == "EMERGENCY_STOP") return Inputs{machine::EmergencyStop{.pressed = pressed}};
  const machine::MachineStatus status = machine.status();
  const std::array<std::pair<std::string_view, MachineInput>, 6> acts = {
      {{"PAUSE", machine::HoldRun{}},
       {"CONTINUE", machine::ResumeRun{}},
       {"STOP", machine::AbortRun{}},
       {"BUFFER_CLEAR", machine::AbortRun{}},
       {"COVER", machine::MoveDoor{.open = !status.run.door_open}},
       {"POWER", machine::SwitchPower{.on = status.state == machine::MachineState::kOff}}}};
  for (const auto& [name, input] : acts) {
    if (name == key) return pressed ? Inputs{input} : Inputs{};
  }
  return Invalid("the panel has no key " + key);
}

// OPT-4.34. What is out of its range the machine refuses.
Status CheckOverrideStep(double percent, const machine::FamilyInfo& info) {
  const double apart = info.override_step_percent;
  if (apart <= 0.0 || percent < info.override_min_percent || percent > info.override_max_percent ||
      std::remainder(percent - info.override_min_percent, apart) == 0.0)
    return {};
  std::string steps;
  for (double step = info.override_min_percent; step <= info.override_max_percent; step += apart)
    steps += (steps.empty() ? "" : ", ") + ShortestText(step);
  return Invalid("an override of " + ShortestText(percent) + " %: the steps are " + steps);
}

// Of how it is set: mode, override, alarms, breakpoints, dry run.
Result<std::optional<MachineInput>> OfSetting(const v1::HostOrder& order,
                                              const machine::Machine& machine) {
  using Input = std::optional<MachineInput>;
  const int selected = machine.selected_program();
  switch (order.request_case()) {
    case v1::HostOrder::kGates: {
      v1::GatePrograms gates;
      *gates.mutable_programs() = order.gates().gate_programs();
      const auto set = bridge::FromProto(gates);
      if (!set) return set.error();
      return Input(*set);
    }
    case v1::HostOrder::kMode: {
      const auto mode = bridge::ModeOf(order.mode().mode());
      if (!mode) return Invalid("mode is none that there is");
      return Input(machine::ChangeMode{.mode = *mode});
    }
    case v1::HostOrder::kOverride: {
      const double percent = order.override().override_percent();
      if (auto step = CheckOverrideStep(percent, machine.family().info()); !step)
        return step.error();
      return Input(machine::ChangeOverride{.percent = percent});
    }
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
  if (order.has_key()) {
    const auto action = bridge::ActionOf(order.key().action());
    if (!action) return Invalid("action: say which");
    return std::vector<MachineInput>{
        machine::PressedKey{.key = order.key().key(), .action = *action}};
  }
  if (order.has_panel_key()) return OfPanelKey(order.panel_key(), machine);
  std::vector<MachineInput> inputs;
  for (const auto of : {OfRun, OfSetting}) {
    Result<std::optional<MachineInput>> input = of(order, machine);
    if (!input) return input.error();
    if (*input) inputs.push_back(*std::move(*input));
  }
  for (const v1::Variable& variable : order.write_variables().variables()) {
    const Result<double> value = bridge::NumberOf(variable);
    if (!value) return value.error();
    inputs.emplace_back(machine::WriteVariable{.name = variable.name(), .value = *value});
  }
  for (const v1::MachineInput& one : order.inputs().inputs()) {
    Result<MachineInput> input = bridge::FromProto(one);
    if (!input) return input.error();
    inputs.push_back(*std::move(input));
  }
  if (order.has_inputs() && inputs.empty()) return Invalid("inputs: none is given");
  const auto gates = std::ranges::count_if(inputs, [](const MachineInput& one) {
    return std::holds_alternative<machine::PressGate>(one);
  });
  if (gates > 1) return Invalid("inputs: one gate at a time, for each of them starts a program");
  return inputs;
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
