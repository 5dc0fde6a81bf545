#pragma once

#include <string>

#include "rmlcell/v1/project.grpc.pb.h"
#include "server/services/call.h"

namespace rmlcell::server {

class ProjectBook;

class ProjectService final : public v1::ProjectService::CallbackService {
 public:
  ProjectService(CallNeeds needs, ProjectBook& book) : needs_(needs), book_(book) {}

  grpc::ServerUnaryReactor* CreateProject(grpc::CallbackServerContext* context,
                                          const v1::CreateProjectRequest* request,
                                          v1::Project* response) override;
  grpc::ServerUnaryReactor* GetProject(grpc::CallbackServerContext* context,
                                       const v1::GetProjectRequest* request,
                                       v1::Project* response) override;
  grpc::ServerUnaryReactor* ListProjects(grpc::CallbackServerContext* context,
                                         const v1::ListProjectsRequest* request,
                                         v1::ListProjectsResponse* response) override;
  grpc::ServerUnaryReactor* UpdateProject(grpc::CallbackServerContext* context,
                                          const v1::UpdateProjectRequest* request,
                                          v1::Project* response) override;
  grpc::ServerUnaryReactor* DeleteProject(grpc::CallbackServerContext* context,
                                          const v1::DeleteProjectRequest* request,
                                          google::protobuf::Empty* response) override;
  grpc::ServerUnaryReactor* TransferProject(grpc::CallbackServerContext* context,
                                            const v1::TransferProjectRequest* request,
                                            v1::TransferProjectResponse* response) override;
  grpc::ServerUnaryReactor* TransferProjectFromMachine(
      grpc::CallbackServerContext* context, const v1::TransferProjectFromMachineRequest* request,
      v1::Project* response) override;
  grpc::ServerWriteReactor<v1::ExportProjectResponse>* ExportProject(
      grpc::CallbackServerContext* context, const v1::ExportProjectRequest* request) override;
  grpc::ServerUnaryReactor* ImportProject(grpc::CallbackServerContext* context,
                                          const v1::ImportProjectRequest* request,
                                          v1::Project* response) override;

 private:
  CallNeeds needs_;
  ProjectBook& book_;
};

}  // namespace rmlcell::server
