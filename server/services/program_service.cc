#include "server/services/program_service.h"

#include <chrono>

#include "proto/bridge/findings.h"
#include "proto/bridge/header_date.h"
#include "proto/bridge/sha256.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/programs/text_tools.h"
#include "server/services/job_streams.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kChunkBytes = 256 << 10;
constexpr std::size_t kUnaryBytes = 3 << 20;

v1::Findings FindingsOf(const machine::Translation& translation) {
  return bridge::FindingsOf(translation.ok, translation.diagnostics,
                            translation.diagnostics_dropped, translation.figures);
}

// Takes a program in chunks. Bytes are kept in memory up to the announced size, which is checked
// against the limit before the first chunk; they are stored when all are there and the digest is
// right.
class Upload final : public grpc::ServerReadReactor<v1::UploadProgramRequest> {
 public:
  Upload(const CallNeeds& needs, ProgramBook& programs, Caller caller, v1::Program* response)
      : needs_(needs), programs_(programs), caller_(std::move(caller)), response_(response) {
    StartRead(&message_);
  }

 private:
  void OnReadDone(bool ok) override {
    if (finished_) return;
    if (!ok) return Store();
    if (message_.has_header()) {
      if (begun_) return End(Error{ErrorCode::kCellInvalidArgument, "a second header", {}});
      begun_ = true;
      header_ = message_.header();
      if (const Status good = CheckHeader(); !good) return End(good.error());
    } else {
      if (!begun_)
        return End(
            Error{ErrorCode::kCellInvalidArgument, "the first message must be the header", {}});
      if (header_.size() == 0 && !message_.chunk().empty()) {
        return End(InvalidArgument("header.size is missing: give the number of bytes that follow"));
      }
      if (bytes_.size() + message_.chunk().size() > static_cast<std::size_t>(header_.size())) {
        return End(Error{ErrorCode::kCellChecksum, "more bytes than the header says", {}});
      }
      digest_.Add(message_.chunk());
      bytes_ += message_.chunk();
    }
    StartRead(&message_);
  }

  // What is wrong with it is told before the first byte of the program.
  Status CheckHeader() {
    if (header_.size() < 0)
      return InvalidArgument("header.size is " + std::to_string(header_.size()));
    if (header_.sha256().empty()) return InvalidArgument("header.sha256 is missing");
    const std::optional<std::string> digest = bridge::ReadSha256(header_.sha256());
    if (!digest) return InvalidArgument("header.sha256 is not 64 hexadecimal digits");
    header_.set_sha256(*digest);
    return programs_.CheckSize(header_.size());
  }

  void Store() {
    if (!begun_) return End(Error{ErrorCode::kCellInvalidArgument, "no header", {}});
    if (header_.size() == 0)
      return End(Error{ErrorCode::kCellEmptyProgram, header_.file_name(), {}});
    if (bytes_.size() != static_cast<std::size_t>(header_.size())) {
      return End(Error{ErrorCode::kCellChecksum,
                       std::to_string(bytes_.size()) + " bytes came, " +
                           std::to_string(header_.size()) + " were announced",
                       {}});
    }
    if (digest_.Hex() != header_.sha256())
      return End(Error{ErrorCode::kCellChecksum, "SHA-256 differs", {}});
    finished_ = true;
    needs_.executor.Post([this] {
      const ProgramResult<v1::Program> stored =
          programs_.Store({.name = header_.name(),
                           .file_name = header_.file_name(),
                           .form = header_.form(),
                           .title = header_.title(),
                           .etag = header_.etag(),
                           .bytes = std::move(bytes_),
                           .validate_only = header_.validate_only(),
                           .force = header_.force()});
      if (stored) *response_ = *stored.value;
      const grpc::Status status = stored ? grpc::Status::OK : ToGrpcStatus(stored.error);
      LogCall("ProgramService/UploadProgram", caller_, status,
              std::chrono::steady_clock::now() - begin_);
      Finish(status);
    });
  }

  void End(const Error& error) {
    finished_ = true;
    const grpc::Status status = ToGrpcStatus(error);
    LogCall("ProgramService/UploadProgram", caller_, status,
            std::chrono::steady_clock::now() - begin_);
    Finish(status);
  }

  void OnDone() override { delete this; }

  CallNeeds needs_;
  ProgramBook& programs_;
  Caller caller_;
  v1::Program* response_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  v1::UploadProgramRequest message_;
  v1::UploadProgramRequest::Header header_;
  bridge::Sha256 digest_;
  std::string bytes_;
  bool begun_ = false;
  bool finished_ = false;
};

class RefusedUpload final : public grpc::ServerReadReactor<v1::UploadProgramRequest> {
 public:
  explicit RefusedUpload(const grpc::Status& status) { Finish(status); }
  void OnDone() override { delete this; }
};

class Download final : public PullStream<v1::DownloadProgramResponse> {
 public:
  Download(Executor& executor, OpenStreams& open, ProgramBook& programs,
           const v1::DownloadProgramRequest& request)
      : PullStream(executor, open), programs_(programs), request_(request) {}

 private:
  Next Make(v1::DownloadProgramResponse& message, grpc::Status& status) override {
    if (!begun_) {
      begun_ = true;
      Result<ProgramBook::Content> content = programs_.Read(request_.name(), request_.form());
      if (!content) {
        status = ToGrpcStatus(content.error());
        return Next::kEnd;
      }
      content_ = std::move(*content);
      message.mutable_header()->set_size(static_cast<std::int64_t>(content_.bytes.size()));
      message.mutable_header()->set_sha256(content_.sha256);
      message.mutable_header()->set_form(content_.form);
      message.mutable_header()->set_file_name(content_.file_name);
      return Next::kMessage;
    }
    if (sent_ >= content_.bytes.size()) return Next::kEnd;
    message.set_chunk(content_.bytes.substr(sent_, kChunkBytes));
    sent_ += message.chunk().size();
    return Next::kMessage;
  }

  ProgramBook& programs_;
  v1::DownloadProgramRequest request_;
  ProgramBook::Content content_;
  bool begun_ = false;
  std::size_t sent_ = 0;
};

}  // namespace

grpc::ServerUnaryReactor* ProgramService::PutProgram(grpc::CallbackServerContext* context,
                                                     const v1::PutProgramRequest* request,
                                                     v1::Program* response) {
  return Answer(needs_, context, *request, "ProgramService/PutProgram",
                [this, request, response](const Caller&) {
                  const ProgramResult<v1::Program> stored =
                      programs_.Store({.name = request->name(),
                                       .file_name = request->program().file_name(),
                                       .form = request->program().form(),
                                       .title = request->title(),
                                       .etag = request->etag(),
                                       .bytes = request->program().content(),
                                       .validate_only = request->validate_only(),
                                       .force = request->force()});
                  if (!stored) return ToGrpcStatus(stored.error);
                  *response = *stored.value;
                  return grpc::Status::OK;
                });
}

grpc::ServerReadReactor<v1::UploadProgramRequest>* ProgramService::UploadProgram(
    grpc::CallbackServerContext* context, v1::Program* response) {
  Result<Caller> caller = Admit(needs_.gate, *context, "ProgramService/UploadProgram");
  if (!caller) return new RefusedUpload(ToGrpcStatus(caller.error()));
  return new Upload(needs_, programs_, std::move(*caller), response);
}

grpc::ServerUnaryReactor* ProgramService::GetProgram(grpc::CallbackServerContext* context,
                                                     const v1::GetProgramRequest* request,
                                                     v1::Program* response) {
  return Answer(needs_, context, *request, "ProgramService/GetProgram",
                [this, request, response](const Caller&) {
                  Result<v1::Program> program = programs_.Get(request->name());
                  if (!program) return ToGrpcStatus(program.error());
                  *response = std::move(*program);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::GetProgramContent(
    grpc::CallbackServerContext* context, const v1::GetProgramContentRequest* request,
    v1::GetProgramContentResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/GetProgramContent",
                [this, request, response](const Caller&) {
                  Result<ProgramBook::Content> content =
                      programs_.Read(request->name(), request->form());
                  if (!content) return ToGrpcStatus(content.error());
                  if (content->bytes.size() > kUnaryBytes) {
                    return ToGrpcStatus(
                        Error{ErrorCode::kCellTooLarge,
                              std::to_string(content->bytes.size()) + " bytes: use DownloadProgram",
                              {}});
                  }
                  response->set_content(std::move(content->bytes));
                  response->set_form(content->form);
                  response->set_file_name(content->file_name);
                  response->set_sha256(content->sha256);
                  return grpc::Status::OK;
                });
}

grpc::ServerWriteReactor<v1::DownloadProgramResponse>* ProgramService::DownloadProgram(
    grpc::CallbackServerContext* context, const v1::DownloadProgramRequest* request) {
  const Result<Caller> caller = Admit(needs_.gate, *context, "ProgramService/DownloadProgram");
  if (!caller) return new RefusedStream<v1::DownloadProgramResponse>(ToGrpcStatus(caller.error()));
  return std::make_shared<Download>(needs_.executor, open_, programs_, *request)->Begin();
}

grpc::ServerUnaryReactor* ProgramService::ListPrograms(grpc::CallbackServerContext* context,
                                                       const v1::ListProgramsRequest* request,
                                                       v1::ListProgramsResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/ListPrograms",
                [this, request, response](const Caller&) {
                  Result<v1::ListProgramsResponse> programs = programs_.List(*request);
                  if (!programs) return ToGrpcStatus(programs.error());
                  *response = std::move(*programs);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::DeleteProgram(grpc::CallbackServerContext* context,
                                                        const v1::DeleteProgramRequest* request,
                                                        google::protobuf::Empty*) {
  return Answer(needs_, context, *request, "ProgramService/DeleteProgram",
                [this, request](const Caller&) {
                  const Status deleted = programs_.Delete(*request);
                  return deleted ? grpc::Status::OK : ToGrpcStatus(deleted.error());
                });
}

grpc::ServerUnaryReactor* ProgramService::CheckProgram(grpc::CallbackServerContext* context,
                                                       const v1::CheckProgramRequest* request,
                                                       v1::CheckProgramResponse* response) {
  return Answer(
      needs_, context, *request, "ProgramService/CheckProgram",
      [this, request, response](const Caller&) {
        const auto checked = programs_.Check(request->family(), request->machine(),
                                             request->program(), !request->errors_only());
        if (!checked) return ToGrpcStatus(checked.error());
        *response->mutable_findings() =
            bridge::FindingsOf(*checked->family, checked->parameters, checked->translation,
                               checked->motion, checked->slot);
        response->mutable_findings()->set_file(bridge::Utf8(request->program().file_name()));
        return grpc::Status::OK;
      });
}

grpc::ServerUnaryReactor* ProgramService::CompileProgram(grpc::CallbackServerContext* context,
                                                         const v1::CompileProgramRequest* request,
                                                         v1::CompileProgramResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/CompileProgram",
                [this, request, response](const Caller&) {
                  auto translation =
                      programs_.Translate(request->family(), {}, request->program(), true);
                  if (!translation) return ToGrpcStatus(translation.error());
                  *response->mutable_findings() = FindingsOf(*translation);
                  if (translation->ok) {
                    response->set_object(
                        machine::ObjectOf(*std::move(translation), request->program().content()));
                  }
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::FormatProgram(grpc::CallbackServerContext* context,
                                                        const v1::FormatProgramRequest* request,
                                                        v1::FormatProgramResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/FormatProgram",
                [request, response](const Caller&) {
                  auto made = FormatText(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::DecompileProgram(
    grpc::CallbackServerContext* context, const v1::DecompileProgramRequest* request,
    v1::DecompileProgramResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/DecompileProgram",
                [this, request, response](const Caller&) {
                  auto made = tools_.Decompile(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::FixProgram(grpc::CallbackServerContext* context,
                                                     const v1::FixProgramRequest* request,
                                                     v1::FixProgramResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/FixProgram",
                [this, request, response](const Caller&) {
                  auto made = tools_.Fix(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::LinkProgram(grpc::CallbackServerContext* context,
                                                      const v1::LinkProgramRequest* request,
                                                      v1::LinkProgramResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/LinkProgram",
                [this, request, response](const Caller&) {
                  auto made = tools_.Link(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::ListStaleExecutables(
    grpc::CallbackServerContext* context, const v1::ListStaleExecutablesRequest* request,
    v1::ListStaleExecutablesResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/ListStaleExecutables",
                [this, request, response](const Caller&) {
                  auto made = tools_.ListStale(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::ShiftProgram(grpc::CallbackServerContext* context,
                                                       const v1::ShiftProgramRequest* request,
                                                       v1::ShiftProgramResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/ShiftProgram",
                [request, response](const Caller&) {
                  auto made = ShiftText(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::MakeListing(grpc::CallbackServerContext* context,
                                                      const v1::MakeListingRequest* request,
                                                      v1::MakeListingResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/MakeListing",
                [request, response](const Caller&) {
                  auto made = ListText(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::DiffPrograms(grpc::CallbackServerContext* context,
                                                       const v1::DiffProgramsRequest* request,
                                                       v1::DiffProgramsResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/DiffPrograms",
                [this, request, response](const Caller&) {
                  ProgramResult<v1::DiffProgramsResponse> made = tools_.Diff(*request);
                  if (!made) return ToGrpcStatus(made.error);
                  *response = *std::move(made.value);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::ConvertProgram(grpc::CallbackServerContext* context,
                                                         const v1::ConvertProgramRequest* request,
                                                         v1::ConvertProgramResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/ConvertProgram",
                [request, response](const Caller&) {
                  auto made = ConvertText(*request, bridge::HeaderDate());
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::CompensateProgram(
    grpc::CallbackServerContext* context, const v1::CompensateProgramRequest* request,
    v1::CompensateProgramResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/CompensateProgram",
                [request, response](const Caller&) {
                  auto made = CompensateText(*request, bridge::HeaderDate());
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::TransformProgram(
    grpc::CallbackServerContext* context, const v1::TransformProgramRequest* request,
    v1::TransformProgramResponse* response) {
  return Answer(needs_, context, *request, "ProgramService/TransformProgram",
                [request, response](const Caller&) {
                  auto made = TransformText(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::ExplainError(grpc::CallbackServerContext* context,
                                                       const v1::ExplainErrorRequest* request,
                                                       v1::ExplainErrorResponse* response) {
  return Answer(
      needs_, context, *request, "ProgramService/ExplainError", [request, response](const Caller&) {
        if (request->code().empty()) {
          for (const CatalogueEntry& entry : Catalogue())
            *response->add_errors() = bridge::Explain(entry);
          return grpc::Status::OK;
        }
        for (const CatalogueEntry* entry : FindByText(request->code())) {
          *response->add_errors() = bridge::Explain(*entry);
        }
        if (response->errors_size() > 0) return grpc::Status::OK;
        return ToGrpcStatus(Error{
            ErrorCode::kCellNotFound, "no error '" + request->code().substr(0, 80) + "'", {}});
      });
}

}  // namespace rmlcell::server
