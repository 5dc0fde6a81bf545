#pragma once

#include <string>

#include "rmlcell/v1/machine.grpc.pb.h"
#include "server/services/call.h"
#include "storage/store.h"

namespace rmlcell::server {

class Dispatcher;
struct Config;

class MachineService final : public v1::MachineService::CallbackService {
 public:
  MachineService(CallNeeds needs, storage::Store& store, const Dispatcher& dispatcher,
                 const Config& config, std::string instance_id);

  grpc::ServerUnaryReactor* GetCell(grpc::CallbackServerContext* context,
                                    const v1::GetCellRequest* request, v1::Cell* response) override;
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
  grpc::ServerUnaryReactor* SetMode(grpc::CallbackServerContext* context,
                                    const v1::SetModeRequest* request,
                                    v1::MachineState* response) override;
  grpc::ServerUnaryReactor* StartMachine(grpc::CallbackServerContext* context,
                                         const v1::StartMachineRequest* request,
                                         v1::MachineState* response) override;
  grpc::ServerUnaryReactor* HaltMachine(grpc::CallbackServerContext* context,
                                        const v1::HaltMachineRequest* request,
                                        v1::MachineState* response) override;
  grpc::ServerUnaryReactor* SetOverride(grpc::CallbackServerContext* context,
                                        const v1::SetOverrideRequest* request,
                                        v1::MachineState* response) override;
  grpc::ServerUnaryReactor* AcknowledgeAlarm(grpc::CallbackServerContext* context,
                                             const v1::AcknowledgeAlarmRequest* request,
                                             v1::MachineState* response) override;
  grpc::ServerUnaryReactor* ReadVariables(grpc::CallbackServerContext* context,
                                          const v1::ReadVariablesRequest* request,
                                          v1::ReadVariablesResponse* response) override;
  grpc::ServerUnaryReactor* WriteVariables(grpc::CallbackServerContext* context,
                                           const v1::WriteVariablesRequest* request,
                                           v1::WriteVariablesResponse* response) override;

 private:
  CallNeeds needs_;
  storage::Store& store_;
  const Dispatcher& dispatcher_;
  const Config& config_;
  std::string instance_id_;
  storage::WallTime started_at_;
};

}  // namespace rmlcell::server
