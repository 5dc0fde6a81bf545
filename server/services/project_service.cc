#include "server/services/project_service.h"

#include "proto/bridge/header_date.h"
#include "server/projects/project_archive.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "server/services/open_stream.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kArchiveChunkBytes = 1 << 20;

class Export final : public PullStream<v1::ExportProjectResponse> {
 public:
  Export(Executor& executor, OpenStreams& open, ProjectBook& book, std::string name)
      : PullStream(executor, open), book_(book), name_(std::move(name)) {}

 private:
  Next Make(v1::ExportProjectResponse& message, grpc::Status& status) override {
    if (!begun_) {
      begun_ = true;
      const Result<v1::Project> project = book_.Get(name_);
      Result<std::string> archive =
          project ? WriteProjectArchive(*project) : Result<std::string>(project.error());
      if (!archive) {
        status = ToGrpcStatus(archive.error());
        return Next::kEnd;
      }
      archive_ = *std::move(archive);
    }
    if (sent_ == archive_.size()) return Next::kEnd;
    message.set_chunk(archive_.substr(sent_, kArchiveChunkBytes));
    sent_ += message.chunk().size();
    return Next::kMessage;
  }

  ProjectBook& book_;
  std::string name_;
  bool begun_ = false;
  std::string archive_;
  std::size_t sent_ = 0;
};

// An archive that comes in chunks: a project when all are there.
class Import final : public grpc::ServerReadReactor<v1::ImportProjectRequest> {
 public:
  Import(const CallNeeds& needs, ProjectBook& book, Caller caller, v1::Project* response)
      : needs_(needs), book_(book), caller_(std::move(caller)), response_(response) {
    StartRead(&message_);
  }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) {
      const auto store = [this] {
        EndWhereThrown(
            kMethod, [this] { Store(); }, [this](const auto& status) { End(status); });
      };
      if (!needs_.compute.TryPost(store)) End(ToGrpcStatus(LaneFull()));
      return;
    }
    if (const Status good = Add(); !good) return End(ToGrpcStatus(good.error()));
    StartRead(&message_);
  }

  Status Add() {
    if (message_.has_chunk()) {
      if (project_id_.empty()) return InvalidArgument("the first message must be the project_id");
      if (message_.chunk().size() > kProjectBytesMax - archive_.size())
        return Error{ErrorCode::kCellTooLarge,
                     "an archive has at most " + std::to_string(kProjectBytesMax) + " bytes",
                     {}};
      archive_ += message_.chunk();
      return {};
    }
    if (!project_id_.empty()) return InvalidArgument("a second project_id");
    if (message_.project_id().empty()) return InvalidArgument("project_id is missing");
    project_id_ = message_.project_id();
    return {};
  }

  void Store() {
    if (project_id_.empty()) return End(ToGrpcStatus(InvalidArgument("project_id is missing")));
    Result<v1::Project> project = ReadProjectArchive(archive_);
    if (!project) return End(ToGrpcStatus(project.error()));
    v1::CreateProjectRequest request;
    request.set_project_id(project_id_);
    *request.mutable_project() = *std::move(project);
    ProgramResult<v1::Project> made = book_.Create(request, caller_.identity);
    if (!made) return End(ToGrpcStatus(made.error));
    *response_ = WithoutContent(*std::move(made.value));
    End(grpc::Status::OK);
  }

  void End(const grpc::Status& status) {
    LogCall(kMethod, caller_, status, std::chrono::steady_clock::now() - begin_);
    Finish(status);
  }

  void OnDone() override { delete this; }

  static constexpr std::string_view kMethod = "ProjectService/ImportProject";
  CallNeeds needs_;
  ProjectBook& book_;
  Caller caller_;
  v1::Project* response_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  v1::ImportProjectRequest message_;
  std::string project_id_;
  std::string archive_;
};

}  // namespace

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
  return Answer(needs_.Computing(), context, *request, "ProjectService/TransferProject",
                [this, request, response](const Caller& caller) {
                  ProgramResult<v1::TransferProjectResponse> transferred =
                      transfer_.ToMachine(*request, caller.identity);
                  if (!transferred) return ToGrpcStatus(transferred.error);
                  *response = std::move(*transferred.value);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProjectService::TransferProjectFromMachine(
    grpc::CallbackServerContext* context, const v1::TransferProjectFromMachineRequest* request,
    v1::Project* response) {
  return Answer(needs_.Computing(), context, *request, "ProjectService/TransferProjectFromMachine",
                [this, request, response](const Caller& caller) {
                  ProgramResult<v1::Project> made =
                      transfer_.FromMachine(*request, bridge::HeaderDate(), caller.identity);
                  if (!made) return ToGrpcStatus(made.error);
                  *response = WithoutContent(*std::move(made.value));
                  return grpc::Status::OK;
                });
}

grpc::ServerWriteReactor<v1::ExportProjectResponse>* ProjectService::ExportProject(
    grpc::CallbackServerContext* context, const v1::ExportProjectRequest* request) {
  return OpenStream<v1::ExportProjectResponse>(
      needs_, *context, *request, "ProjectService/ExportProject", [&](const Caller&) {
        return std::make_shared<Export>(needs_.compute, open_, book_, request->name());
      });
}

grpc::ServerReadReactor<v1::ImportProjectRequest>* ProjectService::ImportProject(
    grpc::CallbackServerContext* context, v1::Project* response) {
  Result<Caller> caller = Admit(needs_.gate, *context, "ProjectService/ImportProject");
  if (!caller) {
    return new EndedStream<grpc::ServerReadReactor<v1::ImportProjectRequest>>(
        ToGrpcStatus(caller.error()));
  }
  return new Import(needs_, book_, *std::move(caller), response);
}

}  // namespace rmlcell::server
