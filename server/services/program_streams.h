#pragma once

#include <memory>

#include "rmlcell/v1/program.grpc.pb.h"
#include "server/services/call.h"
#include "server/services/pull_stream.h"

namespace rmlcell::storage {
class Store;
}
namespace rmlcell::server {

class ProgramBook;

// The streams of ProgramService, once their callers are admitted. The reactors own themselves.

// A program in chunks: stored when all are there and the digest is right.
grpc::ServerReadReactor<v1::UploadProgramRequest>* ReceiveProgram(const CallNeeds& needs,
                                                                  ProgramBook& programs,
                                                                  Caller caller,
                                                                  v1::Program* response);
grpc::ServerReadReactor<v1::UploadContentRequest>* ReceiveContent(
    const CallNeeds& needs, storage::Store& store, ProgramBook& programs, Caller caller,
    v1::UploadContentResponse* response);
std::shared_ptr<PullStream<v1::DownloadProgramResponse>> MakeDownload(
    const CallNeeds& needs, OpenStreams& open, ProgramBook& programs,
    const v1::DownloadProgramRequest& request);
std::shared_ptr<PullStream<v1::StreamProgramToolpathResponse>> MakeProgramToolpath(
    const CallNeeds& needs, OpenStreams& open, ProgramBook& programs,
    const v1::StreamProgramToolpathRequest& request);

}  // namespace rmlcell::server
