#pragma once

#include <string>

#include "rmlcell/v1/program.grpc.pb.h"
#include "server/services/call.h"
#include "server/services/pull_stream.h"

namespace rmlcell::storage {
class Store;
}
namespace rmlcell::server {

class LanguageTools;
class MemoryTools;
class ProgramBook;

// Converts, calls, converts: the rules live in ProgramBook, the tools of server/programs and the
// engine.
class ProgramService final : public v1::ProgramService::CallbackService {
 public:
  ProgramService(CallNeeds needs, storage::Store& store, ProgramBook& programs, MemoryTools& tools,
                 LanguageTools& language, OpenStreams& open)
      : needs_(needs),
        store_(store),
        programs_(programs),
        tools_(tools),
        language_(language),
        open_(open) {}

  grpc::ServerUnaryReactor* PutProgram(grpc::CallbackServerContext* context,
                                       const v1::PutProgramRequest* request,
                                       v1::Program* response) override;
  grpc::ServerUnaryReactor* StoreSpecialPrograms(
      grpc::CallbackServerContext* context, const v1::StoreSpecialProgramsRequest* request,
      v1::StoreSpecialProgramsResponse* response) override;
  grpc::ServerReadReactor<v1::UploadProgramRequest>* UploadProgram(
      grpc::CallbackServerContext* context, v1::Program* response) override;
  grpc::ServerReadReactor<v1::UploadContentRequest>* UploadContent(
      grpc::CallbackServerContext* context, v1::UploadContentResponse* response) override;
  grpc::ServerUnaryReactor* GetProgramPicture(grpc::CallbackServerContext* context,
                                              const v1::GetProgramPictureRequest* request,
                                              v1::GetProgramPictureResponse* response) override;
  grpc::ServerWriteReactor<v1::StreamProgramToolpathResponse>* StreamProgramToolpath(
      grpc::CallbackServerContext* context,
      const v1::StreamProgramToolpathRequest* request) override;
  grpc::ServerUnaryReactor* GetProgram(grpc::CallbackServerContext* context,
                                       const v1::GetProgramRequest* request,
                                       v1::Program* response) override;
  grpc::ServerUnaryReactor* GetProgramContent(grpc::CallbackServerContext* context,
                                              const v1::GetProgramContentRequest* request,
                                              v1::GetProgramContentResponse* response) override;
  grpc::ServerWriteReactor<v1::DownloadProgramResponse>* DownloadProgram(
      grpc::CallbackServerContext* context, const v1::DownloadProgramRequest* request) override;
  grpc::ServerUnaryReactor* ListPrograms(grpc::CallbackServerContext* context,
                                         const v1::ListProgramsRequest* request,
                                         v1::ListProgramsResponse* response) override;
  grpc::ServerUnaryReactor* DeleteProgram(grpc::CallbackServerContext* context,
                                          const v1::DeleteProgramRequest* request,
                                          google::protobuf::Empty* response) override;
  grpc::ServerUnaryReactor* CheckProgram(grpc::CallbackServerContext* context,
                                         const v1::CheckProgramRequest* request,
                                         v1::CheckProgramResponse* response) override;
  grpc::ServerUnaryReactor* CompileProgram(grpc::CallbackServerContext* context,
                                           const v1::CompileProgramRequest* request,
                                           v1::CompileProgramResponse* response) override;
  grpc::ServerUnaryReactor* FormatProgram(grpc::CallbackServerContext* context,
                                          const v1::FormatProgramRequest* request,
                                          v1::FormatProgramResponse* response) override;
  grpc::ServerUnaryReactor* DecompileProgram(grpc::CallbackServerContext* context,
                                             const v1::DecompileProgramRequest* request,
                                             v1::DecompileProgramResponse* response) override;
  grpc::ServerUnaryReactor* FixProgram(grpc::CallbackServerContext* context,
                                       const v1::FixProgramRequest* request,
                                       v1::FixProgramResponse* response) override;
  grpc::ServerUnaryReactor* LinkProgram(grpc::CallbackServerContext* context,
                                        const v1::LinkProgramRequest* request,
                                        v1::LinkProgramResponse* response) override;
  grpc::ServerUnaryReactor* ListStaleExecutables(
      grpc::CallbackServerContext* context, const v1::ListStaleExecutablesRequest* request,
      v1::ListStaleExecutablesResponse* response) override;
  grpc::ServerUnaryReactor* ShiftProgram(grpc::CallbackServerContext* context,
                                         const v1::ShiftProgramRequest* request,
                                         v1::ShiftProgramResponse* response) override;
  grpc::ServerUnaryReactor* MakeListing(grpc::CallbackServerContext* context,
                                        const v1::MakeListingRequest* request,
                                        v1::MakeListingResponse* response) override;
  grpc::ServerUnaryReactor* DiffPrograms(grpc::CallbackServerContext* context,
                                         const v1::DiffProgramsRequest* request,
                                         v1::DiffProgramsResponse* response) override;
  grpc::ServerUnaryReactor* ConvertProgram(grpc::CallbackServerContext* context,
                                           const v1::ConvertProgramRequest* request,
                                           v1::ConvertProgramResponse* response) override;
  grpc::ServerUnaryReactor* CompensateProgram(grpc::CallbackServerContext* context,
                                              const v1::CompensateProgramRequest* request,
                                              v1::CompensateProgramResponse* response) override;
  grpc::ServerUnaryReactor* TransformProgram(grpc::CallbackServerContext* context,
                                             const v1::TransformProgramRequest* request,
                                             v1::TransformProgramResponse* response) override;
  grpc::ServerUnaryReactor* ExplainError(grpc::CallbackServerContext* context,
                                         const v1::ExplainErrorRequest* request,
                                         v1::ExplainErrorResponse* response) override;
  grpc::ServerUnaryReactor* GetLanguage(grpc::CallbackServerContext* context,
                                        const v1::GetLanguageRequest* request,
                                        v1::GetLanguageResponse* response) override;
  grpc::ServerUnaryReactor* Hover(grpc::CallbackServerContext* context,
                                  const v1::HoverRequest* request,
                                  v1::HoverResponse* response) override;
  grpc::ServerUnaryReactor* Complete(grpc::CallbackServerContext* context,
                                     const v1::CompleteRequest* request,
                                     v1::CompleteResponse* response) override;
  grpc::ServerUnaryReactor* FindDefinition(grpc::CallbackServerContext* context,
                                           const v1::FindDefinitionRequest* request,
                                           v1::FindDefinitionResponse* response) override;
  grpc::ServerUnaryReactor* FindReferences(grpc::CallbackServerContext* context,
                                           const v1::FindReferencesRequest* request,
                                           v1::FindReferencesResponse* response) override;
  grpc::ServerUnaryReactor* Rename(grpc::CallbackServerContext* context,
                                   const v1::RenameRequest* request,
                                   v1::RenameResponse* response) override;
  grpc::ServerUnaryReactor* Outline(grpc::CallbackServerContext* context,
                                    const v1::OutlineRequest* request,
                                    v1::OutlineResponse* response) override;

 private:
  // Answers by one of the language tools.
  template <class Request, class Response>
  grpc::ServerUnaryReactor* AnswerBy(Result<Response> (LanguageTools::*tool)(const Request&),
                                     std::string_view method, grpc::CallbackServerContext* context,
                                     const Request* request, Response* response);

  CallNeeds needs_;
  storage::Store& store_;
  ProgramBook& programs_;
  MemoryTools& tools_;
  LanguageTools& language_;
  OpenStreams& open_;
};

}  // namespace rmlcell::server
