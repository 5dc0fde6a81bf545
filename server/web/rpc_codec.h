#pragma once

#include <memory>
#include <string>

#include "engine/core/result.h"
#include "server/web/http_message.h"
#include "server/web/rpc_request.h"
#include "server/web/rpc_status.h"

namespace rmlcell::web {

class EventTexts;

// Turns the answers of a call into one protocol of the web port. One object per call. No two
// threads use it at once; which thread may change from message to message.
class RpcCodec {
 public:
  virtual ~RpcCodec() = default;

  // True: Head, then Message for each, then End. False: Whole.
  virtual bool streams() const = 0;

  // What is asked of the server, where it is more than the client said.
  virtual std::string Asked(std::string request) const { return request; }

  virtual HttpResponse Head() const = 0;

  // Errors: CellInternal when the bytes are not a message of the method's type.
  virtual Result<std::string> Message(std::string_view bytes) = 0;

  // The last piece of a stream; `trailers` have lower-case names.
  virtual std::string End(const RpcStatus& status, const HeaderList& trailers) = 0;

  // What keeps proxies from closing a quiet stream; empty: the protocol has nothing for it.
  virtual std::string_view Quiet() const { return {}; }

  // The answer of a unary call: `bytes` count when the status is good.
  virtual HttpResponse Whole(const RpcStatus& status, std::string_view bytes,
                             const HeaderList& headers, const HeaderList& trailers) = 0;

  // The answer when no call was made.
  virtual HttpResponse Refusal(const RpcRefusal& refusal) = 0;
};

// Preconditions: the route has a method, and its form fits it. `texts` outlives the codec.
std::unique_ptr<RpcCodec> MakeCodec(const RpcRoute& route, EventTexts& texts);

// For requests that name no method: JSON, in Connect's form for clients that speak it.
HttpResponse JsonRefusal(const RpcRefusal& refusal, bool connect_client);

// The answer to a refused routing: gRPC-Web clients get theirs in frames, the others JSON.
// Precondition: there is a refusal.
HttpResponse RefusalOf(const RpcRouting& routing);

// Headers of every answer that a cache must not keep.
void AddNoCache(HttpResponse& response);

// Implementation: one factory per protocol.
std::unique_ptr<RpcCodec> MakeConnectUnary(const RpcRoute& route);
std::unique_ptr<RpcCodec> MakeConnectStream(const RpcRoute& route);
std::unique_ptr<RpcCodec> MakeGrpcWeb(const RpcRoute& route);
std::unique_ptr<RpcCodec> MakeEvents(const RpcRoute& route, EventTexts& texts);

}  // namespace rmlcell::web
