#pragma once

#include <utility>

#include "rmlcell/v1/machine.grpc.pb.h"
#include "server/services/later.h"
#include "server/services/machine_watch.h"
#include "storage/store.h"

namespace rmlcell::server {

class MachineService final : public v1::MachineService::CallbackService {
 public:
  MachineService(CallNeeds needs, MachineWatchNeeds watch)
      : needs_(needs),
        watch_needs_(std::move(watch)),
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

  // Of machines that live.
  RMLCELL_LATER("MachineService", AcquireControl, v1::AcquireControlResponse)
  RMLCELL_LATER("MachineService", RenewControl, v1::RenewControlResponse)
  RMLCELL_LATER("MachineService", ReleaseControl, google::protobuf::Empty)
  RMLCELL_LATER("MachineService", EnableMachine, v1::MachineStatus)
  RMLCELL_LATER("MachineService", DisableMachine, v1::MachineStatus)
  RMLCELL_LATER("MachineService", TakeMachine, v1::MachineStatus)
  RMLCELL_LATER("MachineService", StartMachine, v1::MachineStatus)
  RMLCELL_LATER("MachineService", ZeroMachine, v1::MachineStatus)
  RMLCELL_LATER("MachineService", ResumeMachine, v1::MachineStatus)
  RMLCELL_LATER("MachineService", StopMachine, v1::HaltResponse)
  RMLCELL_LATER("MachineService", HoldMachine, v1::HaltResponse)
  RMLCELL_LATER("MachineService", EmergencyStopMachine, v1::HaltResponse)
  RMLCELL_LATER("MachineService", AbortRun, v1::MachineStatus)
  RMLCELL_LATER("MachineService", SetMode, v1::MachineStatus)
  RMLCELL_LATER("MachineService", SetOverride, v1::MachineStatus)
  RMLCELL_LATER("MachineService", AcknowledgeAlarm, v1::MachineStatus)
  RMLCELL_LATER("MachineService", SetFactor, v1::MachineStatus)
  RMLCELL_LATER("MachineService", ReadVariables, v1::ReadVariablesResponse)
  RMLCELL_LATER("MachineService", WriteVariables, v1::WriteVariablesResponse)
  RMLCELL_LATER("MachineService", SetInputs, v1::MachineStatus)
  RMLCELL_LATER("MachineService", SetGates, v1::MachineStatus)
  RMLCELL_LATER("MachineService", SetBreakpoints, v1::RunState)
  RMLCELL_LATER("MachineService", SetSimulation, v1::RunState)
  RMLCELL_LATER("MachineService", GetRunState, v1::RunState)
  RMLCELL_LATER("MachineService", PressPanelKey, v1::MachineStatus)
  RMLCELL_LATER("MachineService", HeartbeatPanel, v1::HeartbeatResponse)
  RMLCELL_LATER("MachineService", PreviewStart, v1::PreviewStartResponse)
  RMLCELL_LATER("MachineService", StartAtStep, v1::MachineStatus)
  RMLCELL_LATER("MachineService", ConfirmMachine, v1::MachineStatus)
  RMLCELL_LATER("MachineService", ArmMachine, v1::ArmMachineResponse)
  RMLCELL_LATER("MachineService", DisarmMachine, v1::MachineStatus)
  RMLCELL_LATER("MachineService", ListDevices, v1::ListDevicesResponse)
  RMLCELL_LATER_READ("MachineService", ExportJournal)

 private:
  CallNeeds needs_;
  MachineWatchNeeds watch_needs_;
  storage::Store& store_;
  KnownMachines machines_;
};

}  // namespace rmlcell::server
