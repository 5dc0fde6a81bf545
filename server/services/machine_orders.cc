// What clients ask of machines that live: it goes to the host of the machine, and its answer comes
// back. Nothing of it waits for the store, but what begins with something that the store has.
#include <spdlog/spdlog.h>

#include <chrono>
#include <thread>
#include <utility>

#include "proto/bridge/findings.h"
#include "server/base/names.h"
#include "server/machines/host_processes.h"
#include "server/machines/hosts.h"
#include "server/records/machine_options.h"
#include "server/runs/run_queue.h"
#include "server/services/call.h"
#include "server/services/host_order.h"
#include "server/services/machine_service.h"

namespace rmlcell::server {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks{10};
constexpr std::size_t kComputerMax = 253;  // of the name of a host, RFC 1035

}  // namespace

template <class Request, class Response, class Fill, class Take>
grpc::ServerUnaryReactor* MachineService::Order(grpc::CallbackServerContext* context,
                                                const Request* request, Response* response,
                                                std::string_view method, Fill fill, Take take,
                                                HostOrderPrepare prepare) {
  return OrderOfHost({needs_, store_, live_.hosts, std::move(prepare)}, context, request,
                     request->machine(), response, method, fill, take);
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
  if (request->has_job()) return StartJob(context, *request, *response);
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

grpc::ServerUnaryReactor* MachineService::SetGates(grpc::CallbackServerContext* context,
                                                   const v1::SetGatesRequest* request,
                                                   v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/SetGates",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_gates() = asked; });
}

grpc::ServerUnaryReactor* MachineService::ArmMachine(grpc::CallbackServerContext* context,
                                                     const v1::ArmMachineRequest* request,
                                                     v1::ArmMachineResponse* response) {
  return Order(
      context, request, response, "MachineService/ArmMachine",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_arm() = asked; },
      [](v1::HostOrderAnswer& answer, v1::ArmMachineResponse& armed) {
        armed = std::move(*answer.mutable_armed());
      });
}

grpc::ServerUnaryReactor* MachineService::DisarmMachine(grpc::CallbackServerContext* context,
                                                        const v1::DisarmMachineRequest* request,
                                                        v1::MachineStatus* response) {
  return OrderStatus(
      context, request, response, "MachineService/DisarmMachine",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_disarm() = asked; });
}

// A RUN job that waits for a person. LIVE-5.04
grpc::ServerUnaryReactor* MachineService::StartJob(grpc::CallbackServerContext* context,
                                                   const v1::StartMachineRequest& request,
                                                   v1::MachineStatus& response) {
  constexpr std::string_view kMethod = "MachineService/StartMachine";
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const auto refuse = [reactor](const Error& error) {
    reactor->Finish(ToGrpcStatus(error));
    return reactor;
  };
  const Result<Caller> caller = Admit(needs_.gate, *context, kMethod, &request);
  if (!caller) return refuse(caller.error());
  if (const Status good = CheckRequest(needs_, request); !good) return refuse(good.error());
  const Result<std::int64_t> id = ParseJobName(request.job());
  if (!id) return refuse(id.error());
  if (live_.runs == nullptr) return refuse({ErrorCode::kCellNotLive, "no machine lives here", {}});
  const auto answered = [reactor, &response, kMethod, begin = std::chrono::steady_clock::now(),
                         who = *caller](const Result<v1::HostOrderAnswer>& answer) {
    grpc::Status status;
    if (!answer) {
      status = ToGrpcStatus(answer.error());
    } else if (answer->has_refusal()) {
      status = RefusalOf(*answer);
    } else {
      response = answer->status();
    }
    LogCall(kMethod, who, status, std::chrono::steady_clock::now() - begin);
    reactor->Finish(status);
  };
  const bool taken =
      needs_.executor.TryPost([this, &request, id = *id, answered, who = caller->identity] {
        const auto job = store_.GetJob(id);
        if (!job) return answered(job.error());
        if (MachineName(job->machine) != request.machine())
          return answered(Error{ErrorCode::kCellInvalidArgument,
                                "job: " + request.job() + " is for " + MachineName(job->machine),
                                {}});
        v1::HostOrder order;
        order.set_caller(who);
        *order.mutable_by_person() = request;
        order.mutable_run_job();
        live_.runs->BeginByPerson(id, std::move(order), answered);
      });
  return taken ? reactor : refuse(LaneFull());
}

grpc::ServerUnaryReactor* MachineService::PreviewStart(grpc::CallbackServerContext* context,
                                                       const v1::PreviewStartRequest* request,
                                                       v1::PreviewStartResponse* response) {
  // The program that a job brought is with the job, its block with the simulation that proves it.
  const auto machine = ParseMachineName(request->machine());
  const auto status =
      machine && live_.hosts != nullptr ? live_.hosts->StatusOf(*machine) : std::nullopt;
  HostOrderPrepare prepare;
  if (status && live_.runs != nullptr && !status->cut_off_job().empty()) {
    prepare = [runs = live_.runs, job = status->cut_off_job()](v1::HostOrder& order) -> Status {
      const auto id = ParseJobName(job);
      if (!id) return id.error();
      auto brought = runs->ProgramOf(*id);
      if (!brought) return brought.error();
      *order.mutable_brought() = *std::move(brought);
      v1::PreviewStartRequest& asked = *order.mutable_preview_start();
      if (asked.has_milling()) return {};
      if (auto milling = runs->MillingOf(*id)) *asked.mutable_milling() = *std::move(milling);
      return {};
    };
  }
  return Order(
      context, request, response, "MachineService/PreviewStart",
      [](v1::HostOrder& order, const auto& asked) { *order.mutable_preview_start() = asked; },
      [](v1::HostOrderAnswer& answer, v1::PreviewStartResponse& preview) {
        preview = std::move(*answer.mutable_preview());
      },
      std::move(prepare));
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
grpc::Status MachineService::Enable(const std::string& machine, const std::string& caller,
                                    v1::MachineStatus& status) {
  if (live_.processes == nullptr)
    return ToGrpcStatus(Error{ErrorCode::kCellNotLive, "this server starts no hosts", {}});
  if (const Status kept = KeepEnabled(machine, true, caller); !kept)
    return ToGrpcStatus(kept.error());
  live_.hosts->ClearOff(machine);
  if (const Status enabled = live_.processes->Enable(machine); !enabled)
    return ToGrpcStatus(enabled.error());
  AwaitLife(machine);
  return TellStatus(machine, status);
}

void MachineService::AwaitLife(const std::string& machine) {
  const auto until = std::chrono::steady_clock::now() + live_.patience;
  for (;;) {
    const auto now = live_.hosts->StatusOf(machine);
    const bool begins = !now || now->state() == v1::MACHINE_STATE_STARTING ||
                        now->state() == v1::MACHINE_STATE_RECOVERING ||
                        now->state() == v1::MACHINE_STATE_LOST;
    if (!begins || std::chrono::steady_clock::now() >= until) return;
    std::this_thread::sleep_for(kBetweenLooks);
  }
}

// What a person says stands, also with the next server.
Status MachineService::KeepEnabled(const std::string& machine, bool enabled,
                                   const std::string& caller) {
  auto record = store_.GetMachine(machine);
  if (!record) return record.error();
  const bool stands = IsEnabled(*record, live_.by_default || live_.hosts->IsHosted(machine));
  if (stands == enabled) return {};
  v1::MachineOptions options = OptionsOf(*record).value_or(v1::MachineOptions());
  options.set_enabled(enabled);
  options.set_disabled(!enabled);
  record->options = BytesOf(options);
  const auto put = store_.PutMachine(*record, record->revision, caller);
  return put ? Status() : Status(put.error());
}

Status MachineService::EndHost(const std::string& machine, const std::string& why) {
  const auto now = live_.hosts->StatusOf(machine);
  if (now && now->has_run())
    return Error{ErrorCode::kCellMachineState, "a run is open; abort it first", {}};
  live_.processes->Disable(machine);
  live_.hosts->ClearOff(machine);
  const auto told = live_.hosts->End(machine, why);
  if (!told) return {};
  // Another one may join as soon as this one is gone.
  const auto until = std::chrono::steady_clock::now() + live_.patience;
  while (live_.hosts->FenceOf(machine) == told && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(kBetweenLooks);
  live_.hosts->Forget(machine, told);
  return {};
}

// What it was made or changed to: a machine that is enabled lives.
void MachineService::FollowOptions(const storage::MachineRecord& machine) {
  if (live_.processes == nullptr) return;
  Status done;
  if (IsEnabled(machine, live_.by_default)) {
    done = live_.processes->Enable(machine.id);
  } else if (live_.hosts->IsHosted(machine.id) && OptionsOf(machine)) {
    done = EndHost(machine.id, "it was disabled");
  }
  if (!done) spdlog::warn("{}: {}", machine.id, bridge::ErrorText(done.error()));
}

// Its host has it as it was when it began: another one follows.
void MachineService::FollowChange(const storage::MachineRecord& before,
                                  const storage::MachineRecord& now) {
  if (live_.processes == nullptr || !LivesOtherwise(before, now)) return;
  const bool lived = live_.hosts->IsHosted(now.id);
  if (lived) {
    const Status ended = EndHost(now.id, "the machine was changed");
    if (!ended) spdlog::warn("{}: {}", now.id, bridge::ErrorText(ended.error()));
  }
  FollowOptions(now);
  if (lived && IsEnabled(now, live_.by_default)) AwaitLife(now.id);
}

void MachineService::Restore(const std::string& machine) {
  if (const auto record = store_.GetMachine(machine)) FollowOptions(*record);
}

grpc::Status MachineService::Disable(const std::string& machine, const std::string& caller,
                                     v1::MachineStatus& status) {
  if (live_.processes == nullptr) return TellStatus(machine, status);
  const auto now = live_.hosts->StatusOf(machine);
  if (now && now->has_run())
    return ToGrpcStatus(Error{ErrorCode::kCellMachineState, "a run is open; abort it first", {}});
  if (const Status kept = KeepEnabled(machine, false, caller); !kept)
    return ToGrpcStatus(kept.error());
  if (const Status ended = EndHost(machine, "it was disabled"); !ended)
    return ToGrpcStatus(ended.error());
  if (const grpc::Status told = TellStatus(machine, status); !told.ok()) return told;
  status.set_state(v1::MACHINE_STATE_OFF);
  return grpc::Status::OK;
}

// Until a host of that computer has it.
grpc::Status MachineService::GiveTo(const v1::TakeMachineRequest& request,
                                    const std::string& caller, v1::MachineStatus& status) {
  const auto machine = ParseMachineName(request.machine());
  if (!machine) return ToGrpcStatus(machine.error());
  if (const Status good = CheckReason(request.reason()); !good) return ToGrpcStatus(good.error());
  if (request.computer().empty() || request.computer().size() > kComputerMax ||
      request.computer().find('/') != std::string::npos)
    return ToGrpcStatus(InvalidArgument("computer: its name, as `hostname` says it there"));
  if (const auto known = store_.GetMachine(*machine); !known) return ToGrpcStatus(known.error());
  if (live_.hosts == nullptr)
    return ToGrpcStatus(Error{ErrorCode::kCellNotLive, "no machine lives here", {}});
  const auto is_there = [&] {
    const auto now = live_.hosts->StatusOf(*machine);
    return now && now->state() != v1::MACHINE_STATE_LOST &&
           now->host().starts_with(request.computer() + "/");
  };
  if (is_there()) return TellStatus(*machine, status);
  live_.hosts->GiveTo(*machine, request.computer(), caller, request.reason());
  const auto until = std::chrono::steady_clock::now() + live_.patience;
  while (!is_there()) {
    if (std::chrono::steady_clock::now() >= until)
      return ToGrpcStatus(
          Error{ErrorCode::kCellNotLive,
                "no host of " + request.computer() +
                    " has come yet: the next one within ten minutes has the machine",
                {}});
    std::this_thread::sleep_for(kBetweenLooks);
  }
  return TellStatus(*machine, status);
}

template <class Request, class Act>
grpc::Status MachineService::Once(const Request& request, const std::string& caller,
                                  v1::MachineStatus& status, Act act) {
  const auto machine = ParseMachineName(request.machine());
  if (!machine) return ToGrpcStatus(machine.error());
  const std::string content =
      std::string(Request::descriptor()->name()) + '\n' + request.SerializeAsString();
  const auto again = repeated_.IsRepeat(caller, request.request_id(), content);
  if (!again) return ToGrpcStatus(again.error());
  if (*again) return TellStatus(*machine, status);
  const grpc::Status done = act(*machine);
  if (done.ok()) repeated_.Keep(caller, request.request_id(), content);
  return done;
}

grpc::ServerUnaryReactor* MachineService::TakeMachine(grpc::CallbackServerContext* context,
                                                      const v1::TakeMachineRequest* request,
                                                      v1::MachineStatus* response) {
  return Answer(needs_.Computing(), context, *request, "MachineService/TakeMachine",
                [this, request, response](const Caller& caller) {
                  return Once(*request, caller.identity, *response, [&](const std::string&) {
                    return GiveTo(*request, caller.identity, *response);
                  });
                });
}

grpc::ServerUnaryReactor* MachineService::EnableMachine(grpc::CallbackServerContext* context,
                                                        const v1::EnableMachineRequest* request,
                                                        v1::MachineStatus* response) {
  return Answer(needs_.Computing(), context, *request, "MachineService/EnableMachine",
                [this, request, response](const Caller& caller) {
                  return Once(*request, caller.identity, *response, [&](const std::string& id) {
                    return Enable(id, caller.identity, *response);
                  });
                });
}

grpc::ServerUnaryReactor* MachineService::DisableMachine(grpc::CallbackServerContext* context,
                                                         const v1::DisableMachineRequest* request,
                                                         v1::MachineStatus* response) {
  return Answer(needs_.Computing(), context, *request, "MachineService/DisableMachine",
                [this, request, response](const Caller& caller) {
                  return Once(*request, caller.identity, *response, [&](const std::string& id) {
                    return Disable(id, caller.identity, *response);
                  });
                });
}

}  // namespace rmlcell::server
