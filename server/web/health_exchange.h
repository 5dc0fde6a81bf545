#pragma once

#include <memory>

#include "server/web/gateway.h"

namespace rmlcell::web {

// GET /healthz: 200 while grpc.health.v1.Health/Check says SERVING, otherwise 503, also when it
// says nothing within two seconds.
std::shared_ptr<Exchange> MakeHealthExchange(const Gateway& gateway, const HttpRequest& request,
                                             std::shared_ptr<Connection> connection);

}  // namespace rmlcell::web
