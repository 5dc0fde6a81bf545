#pragma once

#include <chrono>
#include <utility>

#include "rmlcell/v1/machine.grpc.pb.h"
#include "server/records/known_machines.h"
#include "server/services/host_order.h"
#include "server/services/later.h"
#include "server/services/machine_watch.h"
#include "server/services/repeated_requests.h"
#include "storage/store.h"

namespace rmlcell::server {

class HostProcesses;
class Hosts;
class RunQueue;

class MachineService final : public v1::MachineService::CallbackService {
 public:
  // Null: no machine lives.
  struct Live {
    Hosts* hosts = nullptr;
    HostProcesses* processes = nullptr;
    RunQueue* runs = nullptr;
    bool by_default = false;  // where the record of a machine does not say so
    // An enabled machine is heard of by then, and one whose host was told to end is gone.
    std::chrono::milliseconds patience = std::chrono::seconds(10);
  };
  MachineService(CallNeeds needs, MachineWatchNeeds watch, Live live)
      : needs_(needs),
        watch_needs_(std::move(watch)),
        live_(live),
        store_(watch_needs_.store),
        machines_(store_) {}

  grpc::ServerUnaryReactor* ListFamilies(grpc::CallbackServerContext* context,
                                         const v1::ListFamiliesRequest* request,
                                         v1::ListFamiliesResponse* response) override;
  grpc::ServerUnaryReactor* CreateMachine(grpc::CallbackServerContext* context,
                                          const v1::CreateMachineRequest* request,
                                          v1::Machine* response) override;
  grpc::ServerUnaryReactor* GetMachine(grpc::CallbackServerContext* context,
                                       const v1::GetMachineRequest* request,
                                       v1::Machine* response) override;
  grpc::ServerUnaryReactor* ListMachines(grpc::CallbackServerContext* context,
                                         const v1::ListMachinesRequest* request,
                                         v1::ListMachinesResponse* response) override;
  grpc::ServerUnaryReactor* UpdateMachine(grpc::CallbackServerContext* context,
                                          const v1::UpdateMachineRequest* request,
                                          v1::Machine* response) override;
  grpc::ServerUnaryReactor* DeleteMachine(grpc::CallbackServerContext* context,
                                          const v1::DeleteMachineRequest* request,
                                          google::protobuf::Empty* response) override;
  grpc::ServerUnaryReactor* GetLaserSchedule(grpc::CallbackServerContext* context,
                                             const v1::GetLaserScheduleRequest* request,
                                             v1::LaserSchedule* response) override;
  grpc::ServerUnaryReactor* ListLaserSchedules(grpc::CallbackServerContext* context,
                                               const v1::ListLaserSchedulesRequest* request,
                                               v1::ListLaserSchedulesResponse* response) override;
  grpc::ServerUnaryReactor* PutLaserSchedule(grpc::CallbackServerContext* context,
                                             const v1::PutLaserScheduleRequest* request,
                                             v1::LaserSchedule* response) override;
  grpc::ServerUnaryReactor* DeleteLaserSchedule(grpc::CallbackServerContext* context,
                                                const v1::DeleteLaserScheduleRequest* request,
                                                google::protobuf::Empty* response) override;
  grpc::ServerWriteReactor<v1::WatchMachineResponse>* WatchMachine(
      grpc::CallbackServerContext* context, const v1::WatchMachineRequest* request) override;

  grpc::ServerWriteReactor<v1::ExportJournalResponse>* ExportJournal(
      grpc::CallbackServerContext* context, const v1::ExportJournalRequest* request) override;

  // Of machines that live: machine_orders.cc.
  grpc::ServerUnaryReactor* AcquireControl(grpc::CallbackServerContext* context,
                                           const v1::AcquireControlRequest* request,
                                           v1::AcquireControlResponse* response) override;
  grpc::ServerUnaryReactor* RenewControl(grpc::CallbackServerContext* context,
                                         const v1::RenewControlRequest* request,
                                         v1::RenewControlResponse* response) override;
  grpc::ServerUnaryReactor* ReleaseControl(grpc::CallbackServerContext* context,
                                           const v1::ReleaseControlRequest* request,
                                           google::protobuf::Empty* response) override;
  grpc::ServerUnaryReactor* StartMachine(grpc::CallbackServerContext* context,
                                         const v1::StartMachineRequest* request,
                                         v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* ZeroMachine(grpc::CallbackServerContext* context,
                                        const v1::ZeroMachineRequest* request,
                                        v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* ResumeMachine(grpc::CallbackServerContext* context,
                                          const v1::ResumeMachineRequest* request,
                                          v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* StopMachine(grpc::CallbackServerContext* context,
                                        const v1::StopMachineRequest* request,
                                        v1::HaltResponse* response) override;
  grpc::ServerUnaryReactor* HoldMachine(grpc::CallbackServerContext* context,
                                        const v1::HoldMachineRequest* request,
                                        v1::HaltResponse* response) override;
  grpc::ServerUnaryReactor* EmergencyStopMachine(grpc::CallbackServerContext* context,
                                                 const v1::EmergencyStopMachineRequest* request,
                                                 v1::HaltResponse* response) override;
  grpc::ServerUnaryReactor* AbortRun(grpc::CallbackServerContext* context,
                                     const v1::AbortRunRequest* request,
                                     v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* SetMode(grpc::CallbackServerContext* context,
                                    const v1::SetModeRequest* request,
                                    v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* SetOverride(grpc::CallbackServerContext* context,
                                        const v1::SetOverrideRequest* request,
                                        v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* AcknowledgeAlarm(grpc::CallbackServerContext* context,
                                             const v1::AcknowledgeAlarmRequest* request,
                                             v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* SetFactor(grpc::CallbackServerContext* context,
                                      const v1::SetFactorRequest* request,
                                      v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* ReadVariables(grpc::CallbackServerContext* context,
                                          const v1::ReadVariablesRequest* request,
                                          v1::ReadVariablesResponse* response) override;
  grpc::ServerUnaryReactor* WriteVariables(grpc::CallbackServerContext* context,
                                           const v1::WriteVariablesRequest* request,
                                           v1::WriteVariablesResponse* response) override;
  grpc::ServerUnaryReactor* SetInputs(grpc::CallbackServerContext* context,
                                      const v1::SetInputsRequest* request,
                                      v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* SetGates(grpc::CallbackServerContext* context,
                                     const v1::SetGatesRequest* request,
                                     v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* SetBreakpoints(grpc::CallbackServerContext* context,
                                           const v1::SetBreakpointsRequest* request,
                                           v1::RunState* response) override;
  grpc::ServerUnaryReactor* SetSimulation(grpc::CallbackServerContext* context,
                                          const v1::SetSimulationRequest* request,
                                          v1::RunState* response) override;
  grpc::ServerUnaryReactor* GetRunState(grpc::CallbackServerContext* context,
                                        const v1::GetRunStateRequest* request,
                                        v1::RunState* response) override;
  grpc::ServerUnaryReactor* ConfirmMachine(grpc::CallbackServerContext* context,
                                           const v1::ConfirmMachineRequest* request,
                                           v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* ArmMachine(grpc::CallbackServerContext* context,
                                       const v1::ArmMachineRequest* request,
                                       v1::ArmMachineResponse* response) override;
  grpc::ServerUnaryReactor* DisarmMachine(grpc::CallbackServerContext* context,
                                          const v1::DisarmMachineRequest* request,
                                          v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* PreviewStart(grpc::CallbackServerContext* context,
                                         const v1::PreviewStartRequest* request,
                                         v1::PreviewStartResponse* response) override;
  grpc::ServerUnaryReactor* StartAtStep(grpc::CallbackServerContext* context,
                                        const v1::StartAtStepRequest* request,
                                        v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* PressPanelKey(grpc::CallbackServerContext* context,
                                          const v1::PressPanelKeyRequest* request,
                                          v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* HeartbeatPanel(grpc::CallbackServerContext* context,
                                           const v1::HeartbeatPanelRequest* request,
                                           v1::HeartbeatResponse* response) override;
  grpc::ServerUnaryReactor* EnableMachine(grpc::CallbackServerContext* context,
                                          const v1::EnableMachineRequest* request,
                                          v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* DisableMachine(grpc::CallbackServerContext* context,
                                           const v1::DisableMachineRequest* request,
                                           v1::MachineStatus* response) override;
  grpc::ServerUnaryReactor* TakeMachine(grpc::CallbackServerContext* context,
                                        const v1::TakeMachineRequest* request,
                                        v1::MachineStatus* response) override;

  RMLCELL_LATER("MachineService", ListDevices, v1::ListDevicesResponse)

 private:
  // One order to the host of a machine.
  template <class Request, class Response, class Fill, class Take>
  grpc::ServerUnaryReactor* Order(grpc::CallbackServerContext* context, const Request* request,
                                  Response* response, std::string_view method, Fill fill, Take take,
                                  HostOrderPrepare prepare = {});
  template <class Request, class Fill>
  grpc::ServerUnaryReactor* OrderStatus(grpc::CallbackServerContext* context,
                                        const Request* request, v1::MachineStatus* response,
                                        std::string_view method, Fill fill);
  grpc::ServerUnaryReactor* StartJob(grpc::CallbackServerContext* context,
                                     const v1::StartMachineRequest& request,
                                     v1::MachineStatus& response);
  // Carries a request out that is no repeat of one that was. LIVE-9.01
  template <class Request, class Act>
  grpc::Status Once(const Request& request, const std::string& caller, v1::MachineStatus& status,
                    Act act);
  grpc::Status Enable(const std::string& machine, const std::string& caller,
                      v1::MachineStatus& status);
  grpc::Status Disable(const std::string& machine, const std::string& caller,
                       v1::MachineStatus& status);
  grpc::Status GiveTo(const v1::TakeMachineRequest& request, const std::string& caller,
                      v1::MachineStatus& status);
  void AwaitLife(const std::string& machine);  // of one that begins
  Status KeepEnabled(const std::string& machine, bool enabled, const std::string& caller);
  // It comes to rest and has no host any more. Error: CellMachineState, a run is open.
  Status EndHost(const std::string& machine, const std::string& why);
  void FollowOptions(const storage::MachineRecord& machine);
  // The host of a machine that was changed begins anew; not while a run is open.
  void FollowChange(const storage::MachineRecord& before, const storage::MachineRecord& now);
  void Restore(const std::string& machine);  // it was not deleted after all
  grpc::Status TellStatus(const std::string& machine, v1::MachineStatus& status);

  CallNeeds needs_;
  MachineWatchNeeds watch_needs_;
  Live live_;
  storage::Store& store_;
  KnownMachines machines_;
  RepeatedRequests repeated_;
};

}  // namespace rmlcell::server
