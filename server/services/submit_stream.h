#pragma once

#include <grpcpp/grpcpp.h>

#include "rmlcell/v1/job.grpc.pb.h"
#include "server/services/call.h"

namespace rmlcell::server {

class JobBook;
class OpenStreams;

// SubmitJobs: many submissions in one stream. The next ones are read while earlier ones are on
// their way to the disk, so that one commit takes many; each is answered when it is durable, or
// refused. At most kSubmittedAtOnce are under way: a client that sends faster waits.
inline constexpr int kSubmittedAtOnce = 256;

grpc::ServerBidiReactor<v1::SubmitJobsRequest, v1::SubmitJobsResponse>* MakeSubmitStream(
    const CallNeeds& needs, grpc::CallbackServerContext& context, JobBook& book, OpenStreams& open);

}  // namespace rmlcell::server
