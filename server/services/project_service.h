#pragma once

#include <string>

#include "rmlcell/v1/project.grpc.pb.h"
#include "server/services/later.h"

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
  RMLCELL_LATER("ProjectService", TransferProjectFromMachine, v1::Project)
  RMLCELL_LATER_READ("ProjectService", ExportProject)
  RMLCELL_LATER_WRITE("ProjectService", ImportProject, v1::Project)

 private:
  CallNeeds needs_;
  ProjectBook& book_;
};

}  // namespace rmlcell::server
