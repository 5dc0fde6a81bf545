// `rmlcell machine log`: what happened at a machine, from the log of the cell.
#include "clients/cli/machine_log.h"

#include <google/protobuf/util/time_util.h>

#include <cstdio>
#include <string_view>

#include "clients/cli/findings_text.h"
#include "clients/cli/machine_call.h"
#include "clients/cli/messages.h"
#include "clients/cli/terminal.h"
#include "engine/core/number_text.h"
#include "rmlcell/v1/cell.grpc.pb.h"

namespace rmlcell::cli {
namespace {

std::string Seconds(std::int64_t ns) { return Fixed(static_cast<double>(ns) * 1e-9, 3) + " s"; }

std::string At(const v1::SourcePlace& place) {
  if (place.step() == 0) return "";
  return " at " + std::to_string(place.program()) + "/" + std::to_string(place.step());
}

std::string StepText(const v1::StepPlace& place) {
  return std::to_string(place.program()) + "/" + std::to_string(place.step());
}

std::string ReasonText(std::string_view act, v1::HoldReason reason) {
  const std::string why = Short(v1::HoldReason_Name(reason), "HOLD_REASON_");
  return std::string(act) + (why == act || why == "UNSPECIFIED" ? "" : " (" + why + ")");
}

std::string ControlText(const v1::ControlChanged& change) {
  switch (change.kind()) {
    case v1::ControlChanged::KIND_ACQUIRED:
      return "takes control";
    case v1::ControlChanged::KIND_RELEASED:
      return "gives control back";
    case v1::ControlChanged::KIND_EXPIRED:
      return "control of " + Visible(change.from()) + " ran out";
    case v1::ControlChanged::KIND_TAKEN_OVER:
      return "takes control over from " + Visible(change.from()) + ": " + Visible(change.reason());
    default:
      return "control changes hands";
  }
}

std::string StartText(const v1::StartInput& start) {
  std::string text = start.has_step() ? "starts at step " + StepText(start.step()) : "starts";
  if (start.program() > 0) text += " program " + std::to_string(start.program());
  return text + (start.job().empty() ? "" : " of " + start.job());
}

std::string VariableText(const v1::Variable& variable) {
  return Visible(variable.name()) + " = " +
         (variable.has_value() ? ValueText(variable.value()) : Visible(variable.text()));
}

std::string OutsideText(const v1::MachineInput& input) {
  switch (input.what_case()) {
    case v1::MachineInput::kInput:
      return VariableText(input.input());
    case v1::MachineInput::kDoorOpen:
      return input.door_open() ? "opens the door" : "closes the door";
    case v1::MachineInput::kGate:
      return "presses gate " + std::to_string(input.gate());
    case v1::MachineInput::kPower:
      return input.power() ? "power on" : "power off";
    default:
      return "lets the emergency stop go";
  }
}

}  // namespace

std::string InputText(const v1::AppliedInput& input) {
  using Input = v1::AppliedInput;
  switch (input.input_case()) {
    case Input::kKey:
      return "key " + Visible(input.key().key()) + " " +
             Short(v1::KeyAction_Name(input.key().action()), "KEY_ACTION_");
    case Input::kStart:
      return StartText(input.start());
    case Input::kResume:
      return "RESUME";
    case Input::kHold:
      return ReasonText("HOLD", input.hold());
    case Input::kStop:
      return ReasonText("STOP", input.stop());
    case Input::kAbort:
      return ReasonText("ABORT", input.abort());
    case Input::kOverridePercent:
      return "override " + ShortestText(input.override_percent()) + " %";
    case Input::kFromOutside:
      return OutsideText(input.from_outside());
    case Input::kVariable:
      return VariableText(input.variable());
    case Input::kMode:
      return "mode " + Short(v1::OperatingMode_Name(input.mode()), "OPERATING_MODE_");
    case Input::kAcknowledgedAlarm:
      return "acknowledges alarm " + std::to_string(input.acknowledged_alarm());
    case Input::kFactor:
      return "time " + ShortestText(input.factor()) + " times as fast";
    case Input::kBreakpoints: {
      std::string text = "breakpoints";
      for (const v1::Breakpoint& one : input.breakpoints().breakpoints())
        text += " " + StepText(one.step());
      return text + (input.breakpoints().breakpoints().empty() ? " none" : "");
    }
    case Input::kSimulationUntil:
      return input.simulation_until().step() == 0
                 ? "no dry run"
                 : "dry run up to " + StepText(input.simulation_until());
    case Input::kEmergencyStop:
      return input.emergency_stop() ? "EMERGENCY STOP" : "lets the emergency stop go";
    case Input::kPower:
      return input.power() ? "power on" : "power off";
    case Input::kControl:
      return ControlText(input.control());
    case Input::kProgramChanged:
      return "program " + std::to_string(input.program_changed().program()) + " is another one";
    case Input::kGates: {
      std::string text = "gates start";
      for (const int program : input.gates().programs()) text += " " + std::to_string(program);
      return text;
    }
    case Input::INPUT_NOT_SET:
      break;
  }
  return "an input of a later version";
}

namespace {

std::string HaltText(const v1::Halted& halted) {
  const std::string message = Visible(halted.message());
  const std::string reason = Short(v1::HoldReason_Name(halted.reason()), "HOLD_REASON_");
  const bool told = reason == "UNSPECIFIED" || message.find(reason) != std::string::npos;
  return "halted" + At(halted.place()) + (message.empty() ? "" : ": " + message) +
         (told ? "" : " (" + reason + ")");
}

std::string RunText(const v1::RunEvent& event) {
  if (event.has_halted()) return HaltText(event.halted());
  if (event.has_resumed()) return "goes on" + At(event.resumed().place());
  if (event.has_message()) return Visible(event.message().text());
  if (event.has_diagnostic()) return FindingLine(event.diagnostic());
  return "";
}

std::string OfJob(const std::string& job) { return job.empty() ? "" : " of " + job; }

std::string MachineText(const v1::MachineEvent& event) {
  switch (event.what_case()) {
    case v1::MachineEvent::kRun:
      return RunText(event.run());
    case v1::MachineEvent::kRunBegun:
      return "run " + std::to_string(event.run_begun().run()) + OfJob(event.run_begun().job()) +
             " begins";
    case v1::MachineEvent::kRunOver:
      return "run " + std::to_string(event.run_over().run()) + OfJob(event.run_over().job()) +
             " is over: " + OutcomeLine(event.run_over().outcome());
    case v1::MachineEvent::kAlarm:
      return "alarm " + std::to_string(event.alarm().id()) + ": " +
             event.alarm().diagnostic().code() + ": " +
             Visible(event.alarm().diagnostic().message());
    case v1::MachineEvent::kInputApplied:
      return InputText(event.input_applied().input());
    case v1::MachineEvent::kHostLost:
      return "its host " + Visible(event.host_lost().host()) + " is gone";
    case v1::MachineEvent::kRecovered: {
      const v1::Recovered& found = event.recovered();
      std::string text =
          "found again at " + Seconds(found.mark_virtual_time_ns()) + At(found.place());
      if (Seconds(found.seen_until_ns()) != Seconds(found.mark_virtual_time_ns()) &&
          found.seen_until_ns() > found.mark_virtual_time_ns())
        text += "; what was shown up to " + Seconds(found.seen_until_ns()) + " is void";
      return text;
    }
    case v1::MachineEvent::kClockSlipped:
      return "its time slipped by " + Seconds(event.clock_slipped().lost_ns());
    default:
      return "";
  }
}

std::string ClockText(const google::protobuf::Timestamp& time) {
  char thousandths[8];
  std::snprintf(thousandths, sizeof thousandths, ".%03d", time.nanos() / 1'000'000);
  return When(time) + thousandths;
}

void Tell(const Remote& remote, const v1::CellEvent& event) {
  if (remote.json) {
    Print(Json(event));
  } else if (const std::string line = MachineLogLine(event); !line.empty()) {
    Print(ClockText(event.time()) + "  " + line);
  }
}

}  // namespace

std::string MachineLogLine(const v1::CellEvent& event) {
  std::string text = MachineText(event.machine());
  if (text.empty()) return text;
  const std::string client = Visible(event.machine().input_applied().client());
  if (!event.caller().empty())
    text = Visible(event.caller()) + (client.empty() ? "" : " (" + client + ")") + ": " + text;
  const std::int64_t virtual_ns = event.machine().virtual_time_ns();
  return virtual_ns > 0 ? text + "  [" + Seconds(virtual_ns) + "]" : text;
}

namespace {

// The newest event of the cell, as the status of this machine has it.
grpc::Status Newest(const Remote& remote, const std::string& machine, std::int64_t& sequence) {
  const auto stub = Service::NewStub(Connect(remote));
  grpc::ClientContext context;
  v1::WatchMachineRequest request;
  request.set_name(machine);
  const auto stream = stub->WatchMachine(&context, request);
  v1::WatchMachineResponse first;
  if (!stream->Read(&first)) {
    const grpc::Status end = stream->Finish();
    return end.ok() ? grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server tells nothing") : end;
  }
  sequence = first.sequence();
  context.TryCancel();
  static_cast<void>(stream->Finish());
  return grpc::Status::OK;
}

}  // namespace

// What the log of the cell still has, and with `follow` what comes.
int ShowMachineLog(const Remote& remote, const MachineAct& act) {
  const std::string name = FullName("machines", act.machine);
  std::int64_t newest = 0;
  if (const grpc::Status found = Newest(remote, name, newest); !found.ok())
    return Refused(found, remote);
  if (newest == 0 && !act.follow) return kGood;
  const auto stub = v1::CellService::NewStub(Connect(remote));
  grpc::ClientContext context;
  v1::WatchCellRequest request;
  request.set_after_sequence(0);
  v1::Subscription& machine = *request.add_subscriptions();
  machine.set_id("machine");
  machine.mutable_machines()->add_names(name);
  const auto stream = stub->WatchCell(&context, request);
  for (v1::WatchCellResponse message; stream->Read(&message);) {
    if (message.has_event()) {
      Tell(remote, message.event());
      std::fflush(stdout);  // whoever reads it from a pipe wants it now
    }
    if (message.has_gap()) Complain("events are missing here: the log was cut meanwhile");
    // A status follows what happened before it.
    if (message.sequence() >= newest && !act.follow) {
      context.TryCancel();
      return kGood;
    }
  }
  const grpc::Status end = stream->Finish();
  return end.ok() ? kGood : Refused(end, remote);
}

}  // namespace rmlcell::cli
