// Machines that live: how they stand, and what is done with them.
#include "clients/cli/remote_machines.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

#include "clients/cli/machine_call.h"
#include "clients/cli/messages.h"
#include "clients/cli/remote_call.h"
#include "clients/cli/request_id.h"
#include "clients/cli/start_words.h"
#include "clients/cli/terminal.h"
#include "engine/core/catalogue.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "rmlcell/v1/machine.grpc.pb.h"

namespace rmlcell::cli {
namespace {

std::string PlaceOf(const v1::MachineRun& run) {
  const v1::SourcePlace& place = run.place();
  const int program = place.program() > 0 ? place.program() : run.program();
  std::string text = program > 0 ? "program " + std::to_string(program) : "by hand";
  if (place.has_byte_offset()) text += ", byte " + std::to_string(place.byte_offset());
  if (place.step() > 0) text += ", step " + std::to_string(place.step());
  if (!run.instruction().empty()) text += " " + Visible(run.instruction());
  return text;
}

std::string PositionOf(const v1::MachineStatus& status) {
  std::string text;
  for (const v1::AxisValue& axis : status.axes()) {
    const bool turns = axis.unit() == v1::UNIT_RADIAN;
    text += (text.empty() ? "" : "  ") + axis.axis() + " " + Fixed(axis.value(), turns ? 4 : 3) +
            (turns ? " rad" : "");
  }
  return text;
}

std::string StatusText(const v1::MachineStatus& status) {
  std::string text =
      status.machine() + "  " + Short(v1::MachineState_Name(status.state()), "MACHINE_STATE_");
  if (status.has_off_reason()) return text + ": " + Visible(status.off_reason().message());
  const bool comes = status.state() == v1::MACHINE_STATE_STARTING ||
                     status.state() == v1::MACHINE_STATE_RECOVERING;
  if (status.host().empty())
    return comes ? text : text + "; it does not live: rmlcell machine enable";
  text += " in " + Short(v1::OperatingMode_Name(status.mode()), "OPERATING_MODE_");
  if (!status.cut_off_job().empty()) text += ", " + status.cut_off_job() + " was cut off";
  if (status.cut_off_at().step() > 0)
    text += " at " + std::to_string(status.cut_off_at().program()) + "/" +
            std::to_string(status.cut_off_at().step());
  if (status.hold_reason() != v1::HOLD_REASON_UNSPECIFIED)
    text += ", held by " + Short(v1::HoldReason_Name(status.hold_reason()), "HOLD_REASON_");
  text += status.zeroed() ? "" : ", axes without reference";
  text += status.door_open() ? ", door open" : "";
  const auto row = [&text](const std::string& head, const std::string& what) {
    text += "\n" + head + std::string(10 - std::min<std::size_t>(9, head.size()), ' ') + what;
  };
  row("position", PositionOf(status));
  if (status.has_run()) {
    const v1::MachineRun& run = status.run();
    row("run", std::to_string(run.run()) + (run.job().empty() ? "" : " of " + run.job()) + ", " +
                   PlaceOf(run) + ", " + Duration(static_cast<double>(run.run_time_ns()) * 1e-9));
  }
  if (status.has_last_run() && !status.has_run()) {
    const v1::LastRun& last = status.last_run();
    row("last run", std::to_string(last.run()) +
                        (last.job().empty() ? ", program " + std::to_string(last.program())
                                            : " of " + last.job()) +
                        ": " + OutcomeLine(last.outcome()));
  }
  row("override", Fixed(status.override_percent(), 0) + " %");
  if (status.factor() != 0.0 && status.factor() != 1.0)
    row("time", Fixed(status.factor(), 1) + " times as fast");
  if (status.has_control()) {
    const std::string& client = status.control().client();
    row("control",
        Visible(status.control().holder()) + (client.empty() ? "" : " (" + Visible(client) + ")"));
  }
  for (const v1::Alarm& alarm : status.alarms())
    row("alarm " + std::to_string(alarm.id()),
        alarm.diagnostic().code() + ": " + Visible(alarm.diagnostic().message()));
  if (status.has_run()) return text;  // which keeps them, too
  for (const v1::StartBlocker& blocker : status.start_blockers())
    row("jobs wait", blocker.code() + ": " + Visible(blocker.message()) + "; " + blocker.advice());
  return text;
}

template <class Request>
int ShowAfter(const Remote& remote, const MachineAct& act,
              grpc::Status (Service::Stub::*method)(grpc::ClientContext*, const Request&,
                                                    v1::MachineStatus*)) {
  v1::MachineStatus response;
  const grpc::Status status = Call(remote, method, For<Request>(act), response);
  return status.ok() ? Show(remote, response) : Refused(status, remote);
}

template <class Request>
int Halt(const Remote& remote, const MachineAct& act,
         grpc::Status (Service::Stub::*method)(grpc::ClientContext*, const Request&,
                                               v1::HaltResponse*)) {
  v1::HaltResponse response;
  const grpc::Status status = Call(remote, method, For<Request>(act), response);
  return status.ok() ? Show(remote, response.status()) : Refused(status, remote);
}

// Each with its value or what is wrong with it; bad when one of them is.
int ShowVariables(const Remote& remote,
                  const google::protobuf::RepeatedPtrField<v1::Variable>& variables) {
  int code = kGood;
  for (const v1::Variable& variable : variables) {
    if (variable.has_error()) code = kProgramErrors;
    if (remote.json) {
      Print(Json(variable));
    } else if (variable.has_error()) {
      Complain(Visible(variable.name()) + ": " + variable.error().code() + ": " +
               Visible(variable.error().message()));
    } else {
      Print(Visible(variable.name()) + " = " + ValueText(variable.value()));
    }
  }
  return code;
}

// "VR[5]=2.5", "IL[20]=on"; nothing: that is no number and no switch.
std::optional<v1::Variable> Assigned(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return std::nullopt;
  v1::Variable variable;
  variable.set_name(text.substr(0, equals));
  const std::string value = text.substr(equals + 1);
  const bool on = EqualIgnoringCase(value, "on");
  if (on || EqualIgnoringCase(value, "off")) {
    variable.mutable_value()->set_logical(on);
  } else if (const auto number = ParseDouble(value)) {
    variable.mutable_value()->set_real(*number);
  } else {
    return std::nullopt;
  }
  return variable;
}

int NoAssignment(const std::string& text) {
  Complain("'" + Visible(text) + "' is none: NAME=VALUE, such as VR[5]=2.5 or IL[20]=on");
  return kUsage;
}

}  // namespace

std::string ValueText(const v1::VariableValue& value) {
  switch (value.value_case()) {
    case v1::VariableValue::kReal:
      return ShortestText(value.real());
    case v1::VariableValue::kInteger:
      return std::to_string(value.integer());
    case v1::VariableValue::kLogical:
      return value.logical() ? "on" : "off";
    case v1::VariableValue::kWord:
      return Visible(value.word());
    case v1::VariableValue::VALUE_NOT_SET:
      break;
  }
  return "-";
}

std::string Short(std::string_view name, std::string_view prefix) {
  return std::string(name.starts_with(prefix) ? name.substr(prefix.size()) : name);
}

int Show(const Remote& remote, const v1::MachineStatus& status) {
  Print(remote.json ? Json(status) : StatusText(status));
  return kGood;
}

// When the control that was taken for it has been given back.
int ShowOwn(const Remote& remote, v1::MachineStatus status) {
  status.clear_control();
  auto& blockers = *status.mutable_start_blockers();
  const std::string held = ConstantName(ErrorCode::kCellLeaseHeld);
  blockers.erase(
      std::remove_if(blockers.begin(), blockers.end(),
                     [&held](const v1::StartBlocker& blocker) { return blocker.symbol() == held; }),
      blockers.end());
  return Show(remote, status);
}

std::optional<v1::MachineStatus> StatusNow(const Remote& remote, const std::string& machine) {
  v1::GetMachineRequest request;
  request.set_name(FullName("machines", machine));
  v1::Machine now;
  if (!Call(remote, &Service::Stub::GetMachine, request, now, remote.short_patience).ok())
    return {};
  return now.status();
}

void AwaitRest(const Remote& remote, const std::string& machine) {
  constexpr int kLooksMax = 100;
  constexpr std::chrono::milliseconds kBetweenLooks{30};
  for (int look = 0; look < kLooksMax; ++look) {
    const auto now = StatusNow(remote, machine);
    if (!now) return;
    const v1::MachineState state = now->state();
    if (state != v1::MACHINE_STATE_JOGGING && state != v1::MACHINE_STATE_STOPPING) return;
    std::this_thread::sleep_for(kBetweenLooks);
  }
}

int ShowMachine(const Remote& remote, const MachineAct& act) {
  v1::GetMachineRequest request;
  request.set_name(FullName("machines", act.machine));
  v1::Machine machine;
  const grpc::Status status = Call(remote, &Service::Stub::GetMachine, request, machine);
  return status.ok() ? Show(remote, machine.status()) : Refused(status, remote);
}

// A line for each status on a terminal's last line; elsewhere a line each.
int WatchMachine(const Remote& remote, const MachineAct& act) {
  const auto stub = Service::NewStub(Connect(remote));
  grpc::ClientContext context;
  v1::WatchMachineRequest request;
  request.set_name(FullName("machines", act.machine));
  const auto stream = stub->WatchMachine(&context, request);
  ProgressLine line;
  std::string shown;
  for (v1::WatchMachineResponse message; stream->Read(&message);) {
    if (!message.has_status()) continue;
    const v1::MachineStatus& status = message.status();
    if (remote.json) {
      Print(Json(status));
      std::fflush(stdout);  // whoever reads it from a pipe wants it now
      continue;
    }
    const std::string state = Short(v1::MachineState_Name(status.state()), "MACHINE_STATE_");
    const std::string of = status.run().job();
    if (std::exchange(shown, state + of) != state + of) {
      line.Clear();
      Print(state + (of.empty() ? "" : " " + of));
      std::fflush(stdout);
    }
    line.Show(-1.0, PositionOf(status) + (status.has_run() ? "  " + PlaceOf(status.run()) : ""));
  }
  line.Clear();
  const grpc::Status end = stream->Finish();
  return end.ok() ? kGood : Refused(end, remote);
}

int EnableMachine(const Remote& remote, const MachineAct& act) {
  return ShowAfter(remote, act, &Service::Stub::EnableMachine);
}

int DisableMachine(const Remote& remote, const MachineAct& act) {
  return ShowAfter(remote, act, &Service::Stub::DisableMachine);
}

int HoldMachine(const Remote& remote, const MachineAct& act) {
  return Halt(remote, act, &Service::Stub::HoldMachine);
}

int StopMachine(const Remote& remote, const MachineAct& act) {
  return Halt(remote, act, &Service::Stub::StopMachine);
}

int EmergencyStopMachine(const Remote& remote, const MachineAct& act) {
  return Halt(remote, act, &Service::Stub::EmergencyStopMachine);
}

int AbortRun(const Remote& remote, const MachineAct& act) {
  return ShowAfter(remote, act, &Service::Stub::AbortRun);
}

namespace {

// What fails at once does so behind the answer.
int ShowBegun(const Remote& remote, const MachineAct& act, const v1::MachineStatus& begun) {
  constexpr std::chrono::milliseconds kBetweenLooks{20};
  v1::MachineStatus status = begun;
  const std::string job = act.job.empty() ? std::string() : FullName("jobs", act.job);
  const auto looks = [&] {  // of a job that the queue was quicker to begin, until it has
    if (status.has_run() && status.run().job() == job) return status.run().run_time_ns() == 0;
    return !job.empty() && status.last_run().job() != job;
  };
  const int looks_max = job.empty() ? 10 : 50;
  for (int look = 0; look < looks_max && looks(); ++look) {
    std::this_thread::sleep_for(kBetweenLooks);
    if (auto now = StatusNow(remote, act.machine)) status = *std::move(now);
  }
  const int shown = ShowOwn(remote, status);
  const std::int64_t run = begun.has_run() ? begun.run().run() : begun.last_run().run();
  const bool failed = !status.has_run() && status.last_run().run() == run &&
                      status.last_run().outcome().kind() == v1::Outcome::KIND_FAILED;
  return shown == kGood && failed ? kProgramErrors : shown;
}

// Armed and started are one here: whoever gives control back has it armed no more. DEV-1.41
int ArmAndStart(const Remote& remote, const MachineAct& act, v1::StartMachineRequest start) {
  auto arm = For<v1::ArmMachineRequest>(act);
  arm.set_job(start.job());
  arm.set_on_loss(v1::ControlLease::ON_LOSS_GO_ON);  // as every run that is started here
  for (const std::string& seen : act.seen) {
    const auto confirmation = ConfirmationOf(seen);
    if (!confirmation) {
      Complain("--seen '" + Visible(seen) + "': nothing is called so; see --help");
      return kUsage;
    }
    arm.add_confirmations(*confirmation);
  }
  const Control control(remote, act);
  if (!control.status().ok()) return Refused(control.status(), remote);
  arm.set_control_token(control.token());
  const auto before = StatusNow(remote, act.machine);
  v1::ArmMachineResponse armed;
  grpc::Status status = Call(remote, &Service::Stub::ArmMachine, arm, armed);
  if (!status.ok()) return Refused(status, remote);
  start.set_control_token(control.token());
  start.set_arm_token(armed.arm_token());
  v1::MachineStatus begun;
  status = Call(remote, &Service::Stub::StartMachine, start, begun);
  if (status.ok()) return ShowBegun(remote, act, begun);
  // The queue begins what a machine is armed for: it may have been so quick that the run is over.
  const auto now = StatusNow(remote, act.machine);
  const bool ran = before && now && now->last_run().job() == start.job() &&
                   now->last_run().run() != before->last_run().run();
  return ran ? ShowBegun(remote, act, *now) : Refused(status, remote);
}

}  // namespace

int StartMachine(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::StartMachineRequest>(act);
  if (!act.job.empty()) {
    request.set_job(FullName("jobs", act.job));
  } else if (act.program > 0) {
    request.set_program(act.program);
  } else {
    request.set_selected(true);
  }
  if (!act.seen.empty()) return ArmAndStart(remote, act, std::move(request));
  return WithControl<v1::StartMachineRequest, v1::MachineStatus>(
      remote, act, &Service::Stub::StartMachine, std::move(request),
      [&](const v1::MachineStatus& begun, const std::string&) {
        return ShowBegun(remote, act, begun);
      });
}

// It stops where control is given back: control is kept until it is over.
int ZeroMachine(const Remote& remote, const MachineAct& act) {
  return WithControl<v1::ZeroMachineRequest, v1::MachineStatus>(
      remote, act, &Service::Stub::ZeroMachine, For<v1::ZeroMachineRequest>(act),
      [&](const v1::MachineStatus& begun, const std::string& token) {
        v1::GetMachineRequest asked;
        asked.set_name(FullName("machines", act.machine));
        v1::RenewControlRequest renew;
        renew.set_machine(asked.name());
        renew.set_control_token(token);
        v1::MachineStatus status = begun;
        while (status.state() == v1::MACHINE_STATE_JOGGING) {
          std::this_thread::sleep_for(std::chrono::milliseconds(500));
          v1::Machine machine;
          v1::RenewControlResponse kept;
          grpc::Status seen = Call(remote, &Service::Stub::RenewControl, renew, kept);
          if (seen.ok()) seen = Call(remote, &Service::Stub::GetMachine, asked, machine);
          if (!seen.ok()) return Refused(seen, remote);
          status = machine.status();
        }
        return ShowOwn(remote, status);
      });
}

int ResumeMachine(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::ResumeMachineRequest>(act);
  request.set_accept_displaced(act.accept_displaced);
  request.set_restore_process(act.restore_process);
  return ShowWithControl(remote, act, &Service::Stub::ResumeMachine, std::move(request));
}

int SetMode(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::SetModeRequest>(act);
  v1::OperatingMode mode = v1::OPERATING_MODE_UNSPECIFIED;
  v1::OperatingMode_Parse("OPERATING_MODE_" + UpperCase(act.word), &mode);
  request.set_mode(mode);
  return ShowWithControl(remote, act, &Service::Stub::SetMode, std::move(request));
}

int SetOverride(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::SetOverrideRequest>(act);
  request.set_override_percent(act.number);
  return ShowWithControl(remote, act, &Service::Stub::SetOverride, std::move(request));
}

int SetFactor(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::SetFactorRequest>(act);
  request.set_factor(act.number);
  return ShowWithControl(remote, act, &Service::Stub::SetFactor, std::move(request));
}

int AcknowledgeAlarms(const Remote& remote, const MachineAct& act) {
  std::vector<std::int64_t> alarms = {act.alarm};
  if (act.alarm == 0) {
    v1::GetMachineRequest asked;
    asked.set_name(FullName("machines", act.machine));
    v1::Machine machine;
    const grpc::Status status = Call(remote, &Service::Stub::GetMachine, asked, machine);
    if (!status.ok()) return Refused(status, remote);
    alarms.clear();
    for (const v1::Alarm& alarm : machine.status().alarms()) alarms.push_back(alarm.id());
    if (alarms.empty()) return Show(remote, machine.status());
  }
  int code = kGood;
  for (const std::int64_t alarm : alarms) {
    auto request = For<v1::AcknowledgeAlarmRequest>(act);
    request.set_alarm_id(alarm);
    code = ShowWithControl(remote, act, &Service::Stub::AcknowledgeAlarm, std::move(request));
    if (code != kGood) break;
  }
  return code;
}

int ConfirmMachine(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::ConfirmMachineRequest>(act);
  request.add_confirmations(v1::CONFIRMATION_INSPECTED);
  return ShowWithControl(remote, act, &Service::Stub::ConfirmMachine, std::move(request));
}

int ReadVariables(const Remote& remote, const MachineAct& act) {
  v1::ReadVariablesRequest request;
  request.set_machine(FullName("machines", act.machine));
  *request.mutable_variables() = {act.values.begin(), act.values.end()};
  v1::ReadVariablesResponse response;
  const grpc::Status status = Call(remote, &Service::Stub::ReadVariables, request, response);
  return status.ok() ? ShowVariables(remote, response.variables()) : Refused(status, remote);
}

int WriteVariables(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::WriteVariablesRequest>(act);
  for (const std::string& text : act.values) {
    auto variable = Assigned(text);
    if (!variable) return NoAssignment(text);
    *request.add_variables() = *std::move(variable);
  }
  return WithControl<v1::WriteVariablesRequest, v1::WriteVariablesResponse>(
      remote, act, &Service::Stub::WriteVariables, std::move(request),
      [&remote](const v1::WriteVariablesResponse& written, const std::string&) {
        return ShowVariables(remote, written.variables());
      });
}

int SetInputs(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::SetInputsRequest>(act);
  for (const std::string& text : act.values) {
    v1::MachineInput& input = *request.add_inputs();
    if (text == "door=open" || text == "door=closed") {
      input.set_door_open(text == "door=open");
    } else if (text == "power=on" || text == "power=off") {
      input.set_power(text == "power=on");
    } else if (text == "gate=1" || text == "gate=2") {
      input.set_gate(text == "gate=1" ? 1 : 2);
    } else if (text == "emergency-stop=released") {
      input.set_emergency_stop_released(true);
    } else if (auto variable = Assigned(text)) {
      *input.mutable_input() = *std::move(variable);
    } else {
      return NoAssignment(text);
    }
  }
  return ShowWithControl(remote, act, &Service::Stub::SetInputs, std::move(request));
}

int SetGates(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::SetGatesRequest>(act);
  *request.mutable_gate_programs() = {act.gates.begin(), act.gates.end()};
  return ShowWithControl(remote, act, &Service::Stub::SetGates, std::move(request));
}

}  // namespace rmlcell::cli
