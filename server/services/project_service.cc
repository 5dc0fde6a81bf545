#include "server/services/project_service.h"

#include "server/programs/program_book.h"
#include "server/projects/project_book.h"

namespace rmlcell::server {

grpc::ServerUnaryReactor* ProjectService::CreateProject(grpc::CallbackServerContext* context,
                                                        const v1::CreateProjectRequest* request,
                                                        v1::Project* response) {
  return Answer(needs_, context, *request, "ProjectService/CreateProject",
                [this, request, response](const Caller& caller) {
                  ProgramResult<v1::Project> project = book_.Create(*request, caller.identity);
                  if (!project) return ToGrpcStatus(project.error);
                  *response = std::move(*project.value);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProjectService::GetProject(grpc::CallbackServerContext* context,
                                                     const v1::GetProjectRequest* request,
                                                     v1::Project* response) {
  return Answer(needs_, context, *request, "ProjectService/GetProject",
                [this, request, response](const Caller&) {
                  Result<v1::Project> project = book_.Get(request->name());
                  if (!project) return ToGrpcStatus(project.error());
                  *response = std::move(*project);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProjectService::ListProjects(grpc::CallbackServerContext* context,
                                                       const v1::ListProjectsRequest* request,
                                                       v1::ListProjectsResponse* response) {
  return Answer(needs_, context, *request, "ProjectService/ListProjects",
                [this, request, response](const Caller&) {
                  Result<v1::ListProjectsResponse> projects = book_.List(*request);
                  if (!projects) return ToGrpcStatus(projects.error());
                  *response = std::move(*projects);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProjectService::UpdateProject(grpc::CallbackServerContext* context,
                                                        const v1::UpdateProjectRequest* request,
                                                        v1::Project* response) {
  return Answer(needs_, context, *request, "ProjectService/UpdateProject",
                [this, request, response](const Caller& caller) {
                  ProgramResult<v1::Project> project = book_.Update(*request, caller.identity);
                  if (!project) return ToGrpcStatus(project.error);
                  *response = std::move(*project.value);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProjectService::DeleteProject(grpc::CallbackServerContext* context,
                                                        const v1::DeleteProjectRequest* request,
                                                        google::protobuf::Empty*) {
  return Answer(needs_, context, *request, "ProjectService/DeleteProject",
                [this, request](const Caller& caller) {
                  const Status deleted = book_.Delete(*request, caller.identity);
                  return deleted ? grpc::Status::OK : ToGrpcStatus(deleted.error());
                });
}

grpc::ServerUnaryReactor* ProjectService::TransferProject(grpc::CallbackServerContext* context,
                                                          const v1::TransferProjectRequest* request,
                                                          v1::TransferProjectResponse* response) {
  return Answer(needs_, context, *request, "ProjectService/TransferProject",
                [this, request, response](const Caller& caller) {
                  ProgramResult<v1::TransferProjectResponse> transferred =
                      book_.Transfer(*request, caller.identity);
                  if (!transferred) return ToGrpcStatus(transferred.error);
                  *response = std::move(*transferred.value);
                  return grpc::Status::OK;
                });
}

}  // namespace rmlcell::server
