#include "tests/server/web/decode_target.h"

#include <google/protobuf/descriptor.h>

#include <array>

#include "rmlcell/v1/job.pb.h"
#include "server/web/base64.h"
#include "server/web/envelope.h"
#include "server/web/event_texts.h"
#include "server/web/request_guard.h"
#include "server/web/resource_routes.h"
#include "server/web/rpc_codec.h"
#include "server/web/rpc_request.h"

namespace rmlcell::web::testing {
namespace {

constexpr std::array<std::string_view, 9> kTypes = {"application/json",
                                                    "application/proto",
                                                    "application/connect+json",
                                                    "application/connect+proto",
                                                    "application/grpc-web",
                                                    "application/grpc-web-text",
                                                    "application/json; charset=utf-8",
                                                    "text/plain",
                                                    ""};
constexpr std::array<std::string_view, 4> kPaths = {
    "/rmlcell.v1.JobService/SubmitJob", "/rmlcell.v1.JobService/WatchJob",
    "/rmlcell.v1.JobService/GetJob", "/rmlcell.v1.ProgramService/ExplainError"};

// The first bytes choose, the lines up to an empty one are query and headers, the rest is the body.
HttpRequest RequestOf(std::string_view bytes) {
  HttpRequest request;
  request.host = "localhost";
  request.peer = "127.0.0.1:1";
  const auto next = [&] {
    const unsigned value = bytes.empty() ? 0U : static_cast<unsigned char>(bytes.front());
    if (!bytes.empty()) bytes.remove_prefix(1);
    return value;
  };
  request.method = next() % 3 == 0 ? "GET" : "POST";
  request.path = std::string(kPaths[next() % kPaths.size()]);
  request.headers.emplace_back("content-type", kTypes[next() % kTypes.size()]);
  constexpr std::array<std::string_view, 6> kNames = {"grpc-timeout",  "connect-timeout-ms",
                                                      "last-event-id", "authorization",
                                                      "accept",        "if-none-match"};
  for (unsigned line = 0; line < 8 && !bytes.empty(); ++line) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    const std::string text(bytes.substr(0, end));
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    if (text.empty()) break;
    if (line == 0) {
      request.query = text;
    } else {
      request.headers.emplace_back(kNames[line % kNames.size()], text);
    }
  }
  request.body = std::string(bytes);
  return request;
}

void CheckCall(const HttpRequest& request) {
  RpcRouting routing = RouteRpc(request);
  if (routing.refusal) {
    RMLCELL_CHECK(RefusalOf(routing).status >= 200);
    return;
  }
  const RpcDecoding decoding = DecodeRpc(routing.route, request);
  EventTexts texts;
  const auto codec = MakeCodec(routing.route, texts);
  if (!decoding.status.ok()) {
    RMLCELL_CHECK(!codec->Refusal({.status = decoding.status, .headers = {}}).body.empty());
    return;
  }
  // What was read as JSON is a message of the type, so it can be read again.
  v1::SubmitJobRequest submit;
  const bool json = routing.route.wire == Wire::kConnectJson && request.method == "POST";
  if (json && routing.route.method->name() == "SubmitJob") {
    RMLCELL_CHECK(submit.ParseFromString(decoding.request.message));
  }
}

}  // namespace

void DecodeAnything(std::string_view bytes) {
  RMLCELL_CHECK(Base64Decode(Base64(bytes, true)) == bytes);
  RMLCELL_CHECK(Base64Decode(Base64(bytes, false)) == bytes);
  if (const auto decoded = Base64Decode(bytes);
      decoded && bytes.find('=') == std::string_view::npos) {
    RMLCELL_CHECK(decoded->size() == bytes.size() * 3 / 4);
  }
  const std::string whole = MakeEnvelope(0, bytes);
  const EnvelopeRead envelope = ReadSingleEnvelope(whole);
  RMLCELL_CHECK(envelope.message && *envelope.message == bytes);
  (void)ReadSingleEnvelope(bytes);
  for (const char c : EncodeGrpcMessage(bytes)) RMLCELL_CHECK(c >= 0x20 && c < 0x7F);
  (void)PlainErrorJson({.code = 3, .message = std::string(bytes), .details = std::string(bytes)});
  (void)ConnectErrorJson({.code = 3, .message = std::string(bytes), .details = std::string(bytes)});

  HttpRequest request = RequestOf(bytes);
  const GuardRules rules{
      .address = "127.0.0.1", .host_names = {}, .origins = {"http://a"}, .secret = "s"};
  (void)IsOwnHost(rules, bytes);
  if (!RefuseRequest(rules, request) && CallerMetadata(rules, request)) CheckCall(request);
  request.path = std::string(bytes.substr(0, bytes.find_first_of(" ?\r\n")));
  if (LooksLikeMethod(request.path)) (void)RouteRpc(request);
  const ResourceRoute route = RouteResource(request);
  RMLCELL_CHECK(!route.path || route.is_resource);
  request.path = "/v1/jobs/1/artifacts/" + request.path;
  if (const ResourceRoute artifact = RouteResource(request); artifact.path) {
    const std::string& name = std::get<ArtifactPath>(*artifact.path).artifact;
    RMLCELL_CHECK(!name.empty() && name != ".." && name.find('/') == std::string::npos);
  }
  (void)RouteUpload(request, {});
}

}  // namespace rmlcell::web::testing
