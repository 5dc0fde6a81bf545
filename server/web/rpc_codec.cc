#include "server/web/rpc_codec.h"

namespace rmlcell::web {

std::unique_ptr<RpcCodec> MakeCodec(const RpcRoute& route, EventTexts& texts) {
  switch (route.wire) {
    case Wire::kConnectJson:
    case Wire::kConnectProto:
      return MakeConnectUnary(route);
    case Wire::kConnectStreamJson:
    case Wire::kConnectStreamProto:
      return MakeConnectStream(route);
    case Wire::kGrpcWeb:
    case Wire::kGrpcWebText:
      return MakeGrpcWeb(route);
    case Wire::kEvents:
      return MakeEvents(route, texts);
  }
  return MakeConnectUnary(route);
}

HttpResponse JsonRefusal(const RpcRefusal& refusal, bool connect_client) {
  HttpResponse response;
  response.status =
      refusal.http_status != 0 ? refusal.http_status : HttpStatusOf(refusal.status.code);
  AddNoCache(response);
  response.headers.emplace_back("Content-Type", "application/json");
  response.headers.insert(response.headers.end(), refusal.headers.begin(), refusal.headers.end());
  response.body =
      connect_client ? ConnectErrorJson(refusal.status) : PlainErrorJson(refusal.status);
  return response;
}

void AddNoCache(HttpResponse& response) {
  response.headers.emplace_back("Cache-Control", "no-cache, no-store");
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
}

HttpResponse RefusalOf(const RpcRouting& routing) {
  const RpcRoute& route = routing.route;
  if (route.wire == Wire::kGrpcWeb || route.wire == Wire::kGrpcWebText) {
    return MakeGrpcWeb(route)->Refusal(*routing.refusal);
  }
  return JsonRefusal(*routing.refusal, route.connect_client);
}

}  // namespace rmlcell::web
