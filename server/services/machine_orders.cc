// What clients ask of machines that live: it goes to the host of the machine, and its answer comes
// back. Nothing of it waits for the store.
#include <chrono>
#include <thread>
#include <utility>

#include "server/base/names.h"
#include "server/machines/host_processes.h"
#include "server/machines/hosts.h"
#include "server/services/call.h"
#include "server/services/host_order.h"
#include "server/services/machine_service.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::seconds kBegins{10};  // an enabled machine is heard of by then
constexpr std::chrono::milliseconds kBetweenLooks{10};

}  // namespace

template <class Request, class Response, class Fill, class Take>
grpc::ServerUnaryReactor* MachineService::Order(grpc::CallbackServerContext* context,
                                                const Request* request, Response* response,
                                                std::string_view method, Fill fill, Take take) {
  return OrderOfHost({needs_, store_, live_.hosts}, context, request, request->machine(), response,
                     method, fill, take);
}

template <class Request, class Fill>
grpc::ServerUnaryReactor* MachineService::OrderStatus(grpc::CallbackServerContext* context,
                                                      const Request* request,
                                                      v1::MachineStatus* response,
                                                      std::string_view method, Fill fill) {
  return Order(context, request, response, method, fill,
               [](v1::HostOrderAnswer& answer, v1::MachineStatus& status) {
                 status = std::move(*answer.mutable_status());
               });
}

grpc::ServerUnaryReactor* MachineService::StartMachine(grpc::CallbackServerContext* context,
                                                       const v1::StartMachineRequest* request,
                                                       v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/StartMachine",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_start() = asked; });
}

grpc::ServerUnaryReactor* MachineService::ZeroMachine(grpc::CallbackServerContext* context,
                                                      const v1::ZeroMachineRequest* request,
                                                      v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/ZeroMachine",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_zero() = asked; });
}

grpc::ServerUnaryReactor* MachineService::ResumeMachine(grpc::CallbackServerContext* context,
                                                        const v1::ResumeMachineRequest* request,
                                                        v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/ResumeMachine",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_resume() = asked; });
}

grpc::ServerUnaryReactor* MachineService::AbortRun(grpc::CallbackServerContext* context,
                                                   const v1::AbortRunRequest* request,
                                                   v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/AbortRun",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_abort() = asked; });
}

grpc::ServerUnaryReactor* MachineService::SetMode(grpc::CallbackServerContext* context,
                                                  const v1::SetModeRequest* request,
                                                  v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/SetMode",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_mode() = asked; });
}

grpc::ServerUnaryReactor* MachineService::SetOverride(grpc::CallbackServerContext* context,
                                                      const v1::SetOverrideRequest* request,
                                                      v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/SetOverride",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_override() = asked; });
}

grpc::ServerUnaryReactor* MachineService::AcknowledgeAlarm(
    grpc::CallbackServerContext* context, const v1::AcknowledgeAlarmRequest* request,
    v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/AcknowledgeAlarm",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_acknowledge_alarm() = asked; });
}

grpc::ServerUnaryReactor* MachineService::SetFactor(grpc::CallbackServerContext* context,
                                                    const v1::SetFactorRequest* request,
                                                    v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/SetFactor",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_factor() = asked; });
}

grpc::ServerUnaryReactor* MachineService::SetInputs(grpc::CallbackServerContext* context,
                                                    const v1::SetInputsRequest* request,
                                                    v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/SetInputs",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_inputs() = asked; });
}

grpc::ServerUnaryReactor* MachineService::PreviewStart(grpc::CallbackServerContext* context,
                                                       const v1::PreviewStartRequest* request,
                                                       v1::PreviewStartResponse* response) {
  return Order(
      context, request, response, "MachineService/PreviewStart",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_preview_start() = asked; },
      [](v1::HostOrderAnswer& answer, v1::PreviewStartResponse& preview) {
        preview = std::move(*answer.mutable_preview());
      });
}

grpc::ServerUnaryReactor* MachineService::StartAtStep(grpc::CallbackServerContext* context,
                                                      const v1::StartAtStepRequest* request,
                                                      v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/StartAtStep",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_start_at_step() = asked; });
}

grpc::ServerUnaryReactor* MachineService::PressPanelKey(grpc::CallbackServerContext* context,
                                                        const v1::PressPanelKeyRequest* request,
                                                        v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/PressPanelKey",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_panel_key() = asked; });
}

grpc::ServerUnaryReactor* MachineService::HeartbeatPanel(grpc::CallbackServerContext* context,
                                                         const v1::HeartbeatPanelRequest* request,
                                                         v1::HeartbeatResponse* response) {
  return Order(
      context, request, response, "MachineService/HeartbeatPanel",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_panel_heartbeat() = asked; },
      [](v1::HostOrderAnswer& answer, v1::HeartbeatResponse& heard) {
        heard = std::move(*answer.mutable_heartbeat());
      });
}

grpc::ServerUnaryReactor* MachineService::ConfirmMachine(grpc::CallbackServerContext* context,
                                                         const v1::ConfirmMachineRequest* request,
                                                         v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/ConfirmMachine",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_confirm() = asked; });
}

grpc::ServerUnaryReactor* MachineService::StopMachine(grpc::CallbackServerContext* context,
                                                      const v1::StopMachineRequest* request,
                                                      v1::HaltResponse* response) {
  return Order(
      context, request, response, "MachineService/StopMachine",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_stop() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) { given = std::move(*answer.mutable_halt()); });
}

grpc::ServerUnaryReactor* MachineService::HoldMachine(grpc::CallbackServerContext* context,
                                                      const v1::HoldMachineRequest* request,
                                                      v1::HaltResponse* response) {
  return Order(
      context, request, response, "MachineService/HoldMachine",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_hold() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) { given = std::move(*answer.mutable_halt()); });
}

grpc::ServerUnaryReactor* MachineService::EmergencyStopMachine(
    grpc::CallbackServerContext* context, const v1::EmergencyStopMachineRequest* request,
    v1::HaltResponse* response) {
  return Order(
      context, request, response, "MachineService/EmergencyStopMachine",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_emergency_stop() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) { given = std::move(*answer.mutable_halt()); });
}

grpc::ServerUnaryReactor* MachineService::AcquireControl(grpc::CallbackServerContext* context,
                                                         const v1::AcquireControlRequest* request,
                                                         v1::AcquireControlResponse* response) {
  return Order(
      context, request, response, "MachineService/AcquireControl",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_acquire_control() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) {
        given = std::move(*answer.mutable_control());
      });
}

grpc::ServerUnaryReactor* MachineService::RenewControl(grpc::CallbackServerContext* context,
                                                       const v1::RenewControlRequest* request,
                                                       v1::RenewControlResponse* response) {
  return Order(
      context, request, response, "MachineService/RenewControl",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_renew_control() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) {
        given = std::move(*answer.mutable_control_kept());
      });
}

grpc::ServerUnaryReactor* MachineService::ReleaseControl(grpc::CallbackServerContext* context,
                                                         const v1::ReleaseControlRequest* request,
                                                         google::protobuf::Empty* response) {
  return Order(
      context, request, response, "MachineService/ReleaseControl",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_release_control() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) {
        static_cast<void>(answer), static_cast<void>(given);
      });
}

grpc::ServerUnaryReactor* MachineService::ReadVariables(grpc::CallbackServerContext* context,
                                                        const v1::ReadVariablesRequest* request,
                                                        v1::ReadVariablesResponse* response) {
  return Order(
      context, request, response, "MachineService/ReadVariables",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_read_variables() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) {
        given = std::move(*answer.mutable_variables());
      });
}

grpc::ServerUnaryReactor* MachineService::WriteVariables(grpc::CallbackServerContext* context,
                                                         const v1::WriteVariablesRequest* request,
                                                         v1::WriteVariablesResponse* response) {
  return Order(
      context, request, response, "MachineService/WriteVariables",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_write_variables() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) {
        given = std::move(*answer.mutable_written());
      });
}

grpc::ServerUnaryReactor* MachineService::SetBreakpoints(grpc::CallbackServerContext* context,
                                                         const v1::SetBreakpointsRequest* request,
                                                         v1::RunState* response) {
  return Order(
      context, request, response, "MachineService/SetBreakpoints",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_breakpoints() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) {
        given = std::move(*answer.mutable_run_state());
      });
}

grpc::ServerUnaryReactor* MachineService::SetSimulation(grpc::CallbackServerContext* context,
                                                        const v1::SetSimulationRequest* request,
                                                        v1::RunState* response) {
  return Order(
      context, request, response, "MachineService/SetSimulation",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_simulation() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) {
        given = std::move(*answer.mutable_run_state());
      });
}

grpc::ServerUnaryReactor* MachineService::GetRunState(grpc::CallbackServerContext* context,
                                                      const v1::GetRunStateRequest* request,
                                                      v1::RunState* response) {
  return Order(
      context, request, response, "MachineService/GetRunState",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_run_state() = asked; },
      [](v1::HostOrderAnswer& answer, auto& given) {
        given = std::move(*answer.mutable_run_state());
      });
}

grpc::Status MachineService::TellStatus(const std::string& machine, v1::MachineStatus& status) {
  const auto record = store_.GetMachine(machine);
  if (!record) return ToGrpcStatus(record.error());
  const auto unfinished = store_.UnfinishedJobs();
  if (!unfinished) return ToGrpcStatus(unfinished.error());
  status = StatusOf(live_.hosts, *record, *unfinished);
  return grpc::Status::OK;
}

// Until its host is heard of.
grpc::Status MachineService::Enable(const std::string& machine, v1::MachineStatus& status) {
  const auto record = store_.GetMachine(machine);
  if (!record) return ToGrpcStatus(record.error());
  if (live_.processes == nullptr)
    return ToGrpcStatus(Error{ErrorCode::kCellNotLive, "this server starts no hosts", {}});
  if (const Status enabled = live_.processes->Enable(machine); !enabled)
    return ToGrpcStatus(enabled.error());
  const auto until = std::chrono::steady_clock::now() + kBegins;
  for (;;) {
    const auto now = live_.hosts->StatusOf(machine);
    const bool begins = !now || now->state() == v1::MACHINE_STATE_STARTING ||
                        now->state() == v1::MACHINE_STATE_RECOVERING ||
                        now->state() == v1::MACHINE_STATE_LOST;
    if (!begins || std::chrono::steady_clock::now() >= until) break;
    std::this_thread::sleep_for(kBetweenLooks);
  }
  return TellStatus(machine, status);
}

grpc::Status MachineService::Disable(const std::string& machine, v1::MachineStatus& status) {
  const auto record = store_.GetMachine(machine);
  if (!record) return ToGrpcStatus(record.error());
  if (live_.processes == nullptr) return TellStatus(machine, status);
  const auto now = live_.hosts->StatusOf(machine);
  if (now && now->has_run())
    return ToGrpcStatus(Error{ErrorCode::kCellMachineState, "a run is open; abort it first", {}});
  live_.processes->Disable(machine);
  live_.hosts->End(machine, "it was disabled");
  const auto until = std::chrono::steady_clock::now() + kBegins;
  while (live_.hosts->IsHosted(machine) && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(kBetweenLooks);
  if (live_.hosts->IsHosted(machine)) live_.hosts->Forget(machine);
  if (const grpc::Status told = TellStatus(machine, status); !told.ok()) return told;
  status.set_state(v1::MACHINE_STATE_OFF);
  return grpc::Status::OK;
}

grpc::ServerUnaryReactor* MachineService::EnableMachine(grpc::CallbackServerContext* context,
                                                        const v1::EnableMachineRequest* request,
                                                        v1::MachineStatus* response) {
  return Answer(needs_.Computing(), context, *request, "MachineService/EnableMachine",
                [this, request, response](const Caller&) {
                  const auto machine = ParseMachineName(request->machine());
                  return machine ? Enable(*machine, *response) : ToGrpcStatus(machine.error());
                });
}

grpc::ServerUnaryReactor* MachineService::DisableMachine(grpc::CallbackServerContext* context,
                                                         const v1::DisableMachineRequest* request,
                                                         v1::MachineStatus* response) {
  return Answer(needs_.Computing(), context, *request, "MachineService/DisableMachine",
                [this, request, response](const Caller&) {
                  const auto machine = ParseMachineName(request->machine());
                  return machine ? Disable(*machine, *response) : ToGrpcStatus(machine.error());
                });
}

}  // namespace rmlcell::server
