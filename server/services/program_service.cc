#include "server/services/program_service.h"

#include <chrono>

#include "proto/bridge/findings.h"
#include "proto/bridge/header_date.h"
#include "server/programs/content_upload.h"
#include "server/programs/language_tools.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/programs/program_views.h"
#include "server/programs/text_tools.h"
#include "server/services/frames_stream.h"
#include "server/services/open_stream.h"
#include "server/services/program_upload.h"
#include "server/services/pull_stream.h"

namespace rmlcell::server {
namespace {

constexpr std::size_t kChunkBytes = 256 << 10;

v1::Findings FindingsOf(const machine::Translation& translation) {
  return bridge::FindingsOf(translation.ok, translation.diagnostics,
                            translation.diagnostics_dropped, translation.figures);
}

// A program that comes in chunks: stored when all are there and the digest is right.
class Upload final : public grpc::ServerReadReactor<v1::UploadProgramRequest> {
 public:
  Upload(const CallNeeds& needs, ProgramBook& programs, Caller caller, v1::Program* response)
      : needs_(needs),
        programs_(programs),
        caller_(std::move(caller)),
        response_(response),
        upload_([&programs](std::int64_t bytes) { return programs.CheckSize(bytes); }) {
    StartRead(&message_);
  }

 private:
  void OnReadDone(bool ok) override {
    if (finished_) return;
    if (const Status good = ok ? upload_.Add(message_) : upload_.End(); !good)
      return End(ToGrpcStatus(good.error()));
    if (ok) {
      StartRead(&message_);
    } else {
      needs_.compute.Post([this] { Store(); });
    }
  }

  void Store() {
    const v1::UploadProgramRequest::Header& header = upload_.header();
    const ProgramResult<v1::Program> stored =
        programs_.Store({.name = header.name(),
                         .file_name = header.file_name(),
                         .form = header.form(),
                         .title = header.title(),
                         .etag = header.etag(),
                         .bytes = upload_.TakeBytes(),
                         .validate_only = header.validate_only(),
                         .force = header.force(),
                         .caller = caller_.identity});
    if (stored) *response_ = *stored.value;
    End(stored ? grpc::Status::OK : ToGrpcStatus(stored.error));
  }

  void End(const grpc::Status& status) {
    finished_ = true;
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
  ProgramUpload upload_;
  bool finished_ = false;
};

// What is sent for SubmitJob: each chunk goes to the store before the next one is read.
class ContentReceiver final : public grpc::ServerReadReactor<v1::UploadContentRequest> {
 public:
  ContentReceiver(const CallNeeds& needs, storage::Store& store, ProgramBook& programs,
                  Caller caller, v1::UploadContentResponse* response)
      : needs_(needs), caller_(std::move(caller)), response_(response), upload_(store, programs) {
    StartRead(&message_);
  }

 private:
  void OnReadDone(bool ok) override {
    needs_.executor.Post([this, ok] { Take(ok); });
  }

  void Take(bool ok) {
    if (ok) {
      const Status good = message_.has_header()
                              ? upload_.Begin(message_.header().size(), message_.header().sha256())
                              : upload_.Add(message_.chunk());
      if (!good) return End(ToGrpcStatus(good.error()));
      return StartRead(&message_);
    }
    Result<v1::UploadContentResponse> made = upload_.End();
    if (!made) return End(ToGrpcStatus(made.error()));
    *response_ = *std::move(made);
    End(grpc::Status::OK);
  }

  void End(const grpc::Status& status) {
    LogCall("ProgramService/UploadContent", caller_, status,
            std::chrono::steady_clock::now() - begin_);
    Finish(status);
  }

  void OnDone() override { delete this; }

  CallNeeds needs_;
  Caller caller_;
  v1::UploadContentResponse* response_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  v1::UploadContentRequest message_;
  ContentUpload upload_;
};

class ProgramToolpath final : public FramesStream<v1::StreamProgramToolpathResponse> {
 public:
  ProgramToolpath(Executor& compute, OpenStreams& open, ProgramBook& programs,
                  const v1::StreamProgramToolpathRequest& request)
      : FramesStream(compute, open), views_(programs), request_(request) {}

 private:
  Result<std::string> Read() override {
    Result<ProgramViews::Toolpath> path = views_.Path(request_);
    if (!path) return path.error();
    header_ = std::move(path->header);
    return std::move(path->frames);
  }

  bool AddHeader(std::string_view, v1::StreamProgramToolpathResponse& message) override {
    *message.mutable_header() = std::move(header_);
    return true;
  }

  bool Add(std::string_view frame, v1::StreamProgramToolpathResponse& message) override {
    message.set_block(std::string(frame));
    return false;
  }

  ProgramViews views_;
  const v1::StreamProgramToolpathRequest request_;
  v1::ToolpathHeader header_;
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/PutProgram",
                [this, request, response](const Caller& caller) {
                  const ProgramResult<v1::Program> stored =
                      programs_.Store({.name = request->name(),
                                       .file_name = request->program().file_name(),
                                       .form = request->program().form(),
                                       .title = request->title(),
                                       .etag = request->etag(),
                                       .bytes = request->program().content(),
                                       .validate_only = request->validate_only(),
                                       .force = request->force(),
                                       .caller = caller.identity});
                  if (!stored) return ToGrpcStatus(stored.error);
                  *response = *stored.value;
                  return grpc::Status::OK;
                });
}

grpc::ServerReadReactor<v1::UploadProgramRequest>* ProgramService::UploadProgram(
    grpc::CallbackServerContext* context, v1::Program* response) {
  Result<Caller> caller = Admit(needs_.gate, *context, "ProgramService/UploadProgram");
  if (!caller) {
    return new EndedStream<grpc::ServerReadReactor<v1::UploadProgramRequest>>(
        ToGrpcStatus(caller.error()));
  }
  return new Upload(needs_, programs_, std::move(*caller), response);
}

grpc::ServerReadReactor<v1::UploadContentRequest>* ProgramService::UploadContent(
    grpc::CallbackServerContext* context, v1::UploadContentResponse* response) {
  Result<Caller> caller = Admit(needs_.gate, *context, "ProgramService/UploadContent");
  if (!caller) {
    return new EndedStream<grpc::ServerReadReactor<v1::UploadContentRequest>>(
        ToGrpcStatus(caller.error()));
  }
  return new ContentReceiver(needs_, store_, programs_, std::move(*caller), response);
}

grpc::ServerUnaryReactor* ProgramService::GetProgramPicture(
    grpc::CallbackServerContext* context, const v1::GetProgramPictureRequest* request,
    v1::GetProgramPictureResponse* response) {
  return Answer(needs_.Computing(), context, *request, "ProgramService/GetProgramPicture",
                [this, request, response](const Caller&) {
                  Result<v1::GetProgramPictureResponse> made =
                      ProgramViews(programs_).Picture(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerWriteReactor<v1::StreamProgramToolpathResponse>* ProgramService::StreamProgramToolpath(
    grpc::CallbackServerContext* context, const v1::StreamProgramToolpathRequest* request) {
  return OpenStream<v1::StreamProgramToolpathResponse>(
      needs_, *context, *request, "ProgramService/StreamProgramToolpath", [&](const Caller&) {
        return std::make_shared<ProgramToolpath>(needs_.compute, open_, programs_, *request);
      });
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
                  if (static_cast<std::int64_t>(content->bytes.size()) > kUnaryBytes) {
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
  const Result<Caller> caller =
      Admit(needs_.gate, *context, "ProgramService/DownloadProgram", request);
  if (!caller) {
    return new EndedStream<grpc::ServerWriteReactor<v1::DownloadProgramResponse>>(
        ToGrpcStatus(caller.error()));
  }
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
                [this, request](const Caller& caller) {
                  const Status deleted = programs_.Delete(*request, caller.identity);
                  return deleted ? grpc::Status::OK : ToGrpcStatus(deleted.error());
                });
}

grpc::ServerUnaryReactor* ProgramService::CheckProgram(grpc::CallbackServerContext* context,
                                                       const v1::CheckProgramRequest* request,
                                                       v1::CheckProgramResponse* response) {
  return Answer(
      needs_.Computing(), context, *request, "ProgramService/CheckProgram",
      [this, request, response](const Caller&) {
        auto checked = programs_.Check(request->family(), request->machine(), request->program(),
                                       !request->errors_only());
        if (!checked) return ToGrpcStatus(checked.error());
        const machine::Judgement judgement = simulation::JudgeCheck(*checked);
        *response->mutable_findings() = bridge::FindingsOf(*checked, judgement);
        response->mutable_findings()->set_file(bridge::Utf8(request->program().file_name()));
        return grpc::Status::OK;
      });
}

grpc::ServerUnaryReactor* ProgramService::CompileProgram(grpc::CallbackServerContext* context,
                                                         const v1::CompileProgramRequest* request,
                                                         v1::CompileProgramResponse* response) {
  return Answer(needs_.Computing(), context, *request, "ProgramService/CompileProgram",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/FormatProgram",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/DecompileProgram",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/FixProgram",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/LinkProgram",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/ShiftProgram",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/MakeListing",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/DiffPrograms",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/ConvertProgram",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/CompensateProgram",
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
  return Answer(needs_.Computing(), context, *request, "ProgramService/TransformProgram",
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
        response->set_language(std::string(bridge::kLanguage));
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

template <class Request, class Response>
grpc::ServerUnaryReactor* ProgramService::AnswerBy(
    Result<Response> (LanguageTools::*tool)(const Request&), std::string_view method,
    grpc::CallbackServerContext* context, const Request* request, Response* response) {
  return Answer(needs_.Computing(), context, *request, method,
                [this, tool, request, response](const Caller&) {
                  Result<Response> made = (language_.*tool)(*request);
                  if (!made) return ToGrpcStatus(made.error());
                  *response = *std::move(made);
                  return grpc::Status::OK;
                });
}

grpc::ServerUnaryReactor* ProgramService::GetLanguage(grpc::CallbackServerContext* context,
                                                      const v1::GetLanguageRequest* request,
                                                      v1::GetLanguageResponse* response) {
  return AnswerBy(&LanguageTools::Words, "ProgramService/GetLanguage", context, request, response);
}

grpc::ServerUnaryReactor* ProgramService::Hover(grpc::CallbackServerContext* context,
                                                const v1::HoverRequest* request,
                                                v1::HoverResponse* response) {
  return AnswerBy(&LanguageTools::Hover, "ProgramService/Hover", context, request, response);
}

grpc::ServerUnaryReactor* ProgramService::Complete(grpc::CallbackServerContext* context,
                                                   const v1::CompleteRequest* request,
                                                   v1::CompleteResponse* response) {
  return AnswerBy(&LanguageTools::Complete, "ProgramService/Complete", context, request, response);
}

grpc::ServerUnaryReactor* ProgramService::FindDefinition(grpc::CallbackServerContext* context,
                                                         const v1::FindDefinitionRequest* request,
                                                         v1::FindDefinitionResponse* response) {
  return AnswerBy(&LanguageTools::FindDefinition, "ProgramService/FindDefinition", context, request,
                  response);
}

grpc::ServerUnaryReactor* ProgramService::FindReferences(grpc::CallbackServerContext* context,
                                                         const v1::FindReferencesRequest* request,
                                                         v1::FindReferencesResponse* response) {
  return AnswerBy(&LanguageTools::FindReferences, "ProgramService/FindReferences", context, request,
                  response);
}

grpc::ServerUnaryReactor* ProgramService::Rename(grpc::CallbackServerContext* context,
                                                 const v1::RenameRequest* request,
                                                 v1::RenameResponse* response) {
  return AnswerBy(&LanguageTools::Rename, "ProgramService/Rename", context, request, response);
}

grpc::ServerUnaryReactor* ProgramService::Outline(grpc::CallbackServerContext* context,
                                                  const v1::OutlineRequest* request,
                                                  v1::OutlineResponse* response) {
  return AnswerBy(&LanguageTools::Outline, "ProgramService/Outline", context, request, response);
}

}  // namespace rmlcell::server
