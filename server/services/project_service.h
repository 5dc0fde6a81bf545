#pragma once

#include <string>

#include "rmlcell/v1/project.grpc.pb.h"
#include "server/services/call.h"

namespace rmlcell::server {

class OpenStreams;
class ProjectBook;
class ProjectTransfer;

class ProjectService final : public v1::ProjectService::CallbackService {
 public:
  ProjectService(CallNeeds needs, ProjectBook& book, ProjectTransfer& transfer, OpenStreams& open)
      : needs_(needs), book_(book), transfer_(transfer), open_(open) {}

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
  grpc::ServerReadReactor<v1::ImportProjectRequest>* ImportProject(
      grpc::CallbackServerContext* context, v1::Project* response) override;

 private:
  CallNeeds needs_;
  ProjectBook& book_;
  ProjectTransfer& transfer_;
  OpenStreams& open_;
};

}  // namespace rmlcell::server
