#include "server/services/program_service.h"

#include "proto/bridge/findings.h"
#include "proto/bridge/header_date.h"
#include "server/programs/language_tools.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/programs/program_views.h"
#include "server/programs/special_programs.h"
#include "server/programs/text_tools.h"
#include "server/services/open_stream.h"
#include "server/services/program_streams.h"

namespace rmlcell::server {
namespace {

v1::Findings FindingsOf(const machine::Translation& translation) {
  return bridge::FindingsOf(translation.ok, translation.diagnostics,
                            translation.diagnostics_dropped, translation.figures);
}

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

grpc::ServerUnaryReactor* ProgramService::StoreSpecialPrograms(
    grpc::CallbackServerContext* context, const v1::StoreSpecialProgramsRequest* request,
    v1::StoreSpecialProgramsResponse* response) {
  return Answer(needs_.Computing(), context, *request, "ProgramService/StoreSpecialPrograms",
                [this, request, response](const Caller& caller) {
                  Result<v1::StoreSpecialProgramsResponse> stored =
                      server::StoreSpecialPrograms(store_, *request, caller.identity);
                  if (!stored) return ToGrpcStatus(stored.error());
                  programs_.TellStored();
                  *response = *std::move(stored);
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
  return ReceiveProgram(needs_, programs_, *std::move(caller), response);
}

grpc::ServerReadReactor<v1::UploadContentRequest>* ProgramService::UploadContent(
    grpc::CallbackServerContext* context, v1::UploadContentResponse* response) {
  Result<Caller> caller = Admit(needs_.gate, *context, "ProgramService/UploadContent");
  if (!caller) {
    return new EndedStream<grpc::ServerReadReactor<v1::UploadContentRequest>>(
        ToGrpcStatus(caller.error()));
  }
  return ReceiveContent(needs_, store_, programs_, *std::move(caller), response);
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
      needs_, *context, *request, "ProgramService/StreamProgramToolpath",
      [&](const Caller&) { return MakeProgramToolpath(needs_, open_, programs_, *request); });
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
  return OpenStream<v1::DownloadProgramResponse>(
      needs_, *context, *request, "ProgramService/DownloadProgram",
      [this, request](const Caller&) { return MakeDownload(needs_, open_, programs_, *request); });
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
