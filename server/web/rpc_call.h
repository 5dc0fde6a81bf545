#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/web/http_message.h"
#include "server/web/rpc_status.h"

namespace grpc {
class Channel;
}

namespace rmlcell::web {

struct RpcCallSpec {
  std::string method;  // "/rmlcell.v1.JobService/GetJob"
  std::string message;
  HeaderList metadata;  // names and values that IsMetadata accepts
  std::optional<std::chrono::nanoseconds> timeout;
};

// How a call ended. Names that gRPC itself uses are left out of both lists; binary values are
// base64.
struct RpcCallEnd {
  RpcStatus status;
  HeaderList headers;
  HeaderList trailers;
};

// What a call tells. Both run on gRPC's threads, or inside of Start or ReadNext, one at a time.
struct RpcCallEvents {
  std::function<void(std::string bytes)>
      on_message;                              // once after each ReadNext, unless the call ends
  std::function<void(RpcCallEnd end)> on_end;  // exactly once, the last
};

// One unary or server-streaming call of any method. Pulls: the next message is taken from the
// server only after ReadNext, so a slow reader slows its own producer and nobody else. Thread-safe.
// The call lives until it has ended, whether or not anybody still holds this object.
class RpcCall {
 public:
  virtual ~RpcCall() = default;

  // Precondition: no message is being waited for.
  virtual void ReadNext() = 0;

  // The call ends soon, as cancelled unless it ended before. May be called at any time, also twice.
  virtual void Cancel() = 0;

  static std::shared_ptr<RpcCall> Start(const std::shared_ptr<grpc::Channel>& channel,
                                        RpcCallSpec spec, RpcCallEvents events);
};

// gRPC ends the process on a metadata entry that it cannot send, so foreign ones are asked about
// first: lower-case names, values of visible ASCII and inner blanks.
bool IsMetadata(std::string_view name, std::string_view value);

}  // namespace rmlcell::web
