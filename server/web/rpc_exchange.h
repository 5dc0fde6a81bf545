#pragma once

#include <memory>

#include "server/web/gateway.h"
#include "server/web/rpc_request.h"

namespace rmlcell::web {

// Answers one call: reads the request, makes the call over the channel to the server, writes what
// comes. The next message is asked for only when the socket took the last; a client that leaves
// cancels it.
std::shared_ptr<Exchange> MakeRpcExchange(const Gateway& gateway, const RpcRoute& route,
                                          const HttpRequest& request, HeaderList metadata,
                                          std::shared_ptr<Connection> connection);

}  // namespace rmlcell::web
