#pragma once

#include <grpcpp/grpcpp.h>

#include "rmlcell/v1/handbox.grpc.pb.h"
#include "server/services/call.h"

namespace rmlcell::server {

class Hosts;
class OpenStreams;

// "machines/optimo-1" of "machines/optimo-1/handboxSessions/3".
std::string MachineOfSession(const std::string& session);

// Keys and heartbeats of a session in one stream: each is handed on when it comes, so a key does
// not wait for the answer to the one before, and is answered when it has acted. A refusal ends
// nothing. LIVE-9.15
grpc::ServerBidiReactor<v1::HandboxStreamRequest, v1::HandboxStreamResponse>* MakeHandboxStream(
    const CallNeeds& needs, grpc::CallbackServerContext& context, Hosts* hosts, OpenStreams& open);

}  // namespace rmlcell::server
