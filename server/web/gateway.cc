#include "server/web/gateway.h"

#include "server/web/health_exchange.h"
#include "server/web/resource_exchange.h"
#include "server/web/resource_routes.h"
#include "server/web/rpc_codec.h"
#include "server/web/rpc_exchange.h"

namespace rmlcell::web {
namespace {

Plan Answer(HttpResponse response) {
  Plan plan;
  plan.answer = std::move(response);
  return plan;
}

Plan RefusePlan(int http_status, ErrorCode code, std::string detail, std::string allow = {}) {
  RpcRefusal refusal{.status = FromError({code, std::move(detail), {}}),
                     .http_status = http_status,
                     .headers = {}};
  if (!allow.empty()) refusal.headers.emplace_back("Allow", std::move(allow));
  return Answer(JsonRefusal(refusal, false));
}

bool IsRead(const HttpRequest& request) {
  return request.method == "GET" || request.method == "HEAD";
}

Plan PlanMethod(const Gateway& gateway, const HttpRequest& request, HeaderList metadata) {
  RpcRouting routing = RouteRpc(request);
  if (routing.refusal) return Answer(RefusalOf(routing));
  Plan plan;
  plan.body_bytes_max = request.method == "POST" ? gateway.options.call_bytes_max : 0;
  plan.exchange = [&gateway, route = routing.route, metadata = std::move(metadata)](
                      std::shared_ptr<Connection> connection, const HttpRequest& full) {
    return MakeRpcExchange(gateway, route, full, metadata, std::move(connection));
  };
  return plan;
}

Plan PlanResource(const Gateway& gateway, const HttpRequest& request, const ResourceRoute& route,
                  HeaderList metadata) {
  if (!route.path) return RefusePlan(400, ErrorCode::kCellInvalidArgument, route.problem);
  Plan plan;
  const bool uploads = std::holds_alternative<UploadsPath>(*route.path);
  if (IsRead(request) && !uploads) {
    plan.exchange = [&gateway, path = *route.path, metadata = std::move(metadata)](
                        std::shared_ptr<Connection> connection, const HttpRequest& full) {
      return MakeDownload(gateway, path, full, metadata, std::move(connection));
    };
    return plan;
  }
  const auto* program = std::get_if<ProgramContentPath>(&*route.path);
  if (request.method != "POST" || (program == nullptr && !uploads)) {
    return RefusePlan(405, ErrorCode::kCellUnimplemented, request.method + " is not offered here",
                      uploads              ? "POST"
                      : program != nullptr ? "GET, HEAD, POST"
                                           : "GET, HEAD");
  }
  UploadRoute upload =
      uploads ? RouteUpload(request, UploadsPath()) : RouteUpload(request, *program);
  if (upload.refusal) return Answer(JsonRefusal(*upload.refusal, false));
  plan.stream_body = true;
  plan.body_bytes_max = gateway.options.upload_bytes_max;
  plan.exchange = [&gateway, header = std::move(upload.header), metadata = std::move(metadata)](
                      std::shared_ptr<Connection> connection, const HttpRequest&) {
    return MakeUpload(gateway, header, metadata, std::move(connection));
  };
  return plan;
}

Plan PlanPage(const Gateway& gateway, const HttpRequest& request) {
  std::optional<HttpResponse> file = gateway.page.Find(request);
  if (!file)
    return RefusePlan(404, ErrorCode::kCellNotFound, "nothing at " + request.path.substr(0, 200));
  if (!IsRead(request)) {
    return RefusePlan(405, ErrorCode::kCellUnimplemented, request.method + " is not offered here",
                      "GET, HEAD");
  }
  return Answer(*std::move(file));
}

}  // namespace

Plan MakePlan(const Gateway& gateway, const HttpRequest& request) {
  if (std::optional<HttpResponse> refusal = RefuseRequest(gateway.rules, request)) {
    return Answer(*std::move(refusal));
  }
  if (request.method == "OPTIONS") return Answer(AnswerOptions(gateway.rules, request));
  if (request.path == "/healthz") {
    if (!IsRead(request))
      return RefusePlan(405, ErrorCode::kCellUnimplemented, "use GET", "GET, HEAD");
    Plan plan;
    plan.exchange = [&gateway](std::shared_ptr<Connection> connection, const HttpRequest& full) {
      return MakeHealthExchange(gateway, full, std::move(connection));
    };
    return plan;
  }
  const bool method = LooksLikeMethod(request.path);
  const ResourceRoute resource = RouteResource(request);
  if (!method && !resource.is_resource) return PlanPage(gateway, request);
  std::optional<HeaderList> metadata = CallerMetadata(gateway.rules, request);
  if (!metadata) {
    return RefusePlan(400, ErrorCode::kCellInvalidArgument,
                      "a header has characters that cannot be sent on");
  }
  if (method) return PlanMethod(gateway, request, *std::move(metadata));
  return PlanResource(gateway, request, resource, *std::move(metadata));
}

}  // namespace rmlcell::web
