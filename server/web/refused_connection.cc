#include "server/web/refused_connection.h"

#include "server/web/rpc_codec.h"

namespace rmlcell::web {

HttpResponse TooManyConnections() {
  HttpResponse response = JsonRefusal(
      {.status = FromError(
           {ErrorCode::kCellResourceExhausted, "too many connections to the web port", {}}),
       .http_status = 503,
       .headers = {}},
      false);
  response.headers.emplace_back("Retry-After", "2");
  return response;
}

std::string TooManyConnectionsText() {
  const HttpResponse response = TooManyConnections();
  return SerializeHead(response, Framing::kLength, response.body.size(), false) + response.body;
}

}  // namespace rmlcell::web
