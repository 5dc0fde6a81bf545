#include "server/web/rpc_request.h"

#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <array>

#include "engine/core/letters.h"
#include "engine/core/number_text.h"
#include "server/web/base64.h"
#include "server/web/envelope.h"
#include "server/web/rpc_json.h"

namespace rmlcell::web {
namespace {

using google::protobuf::MethodDescriptor;

// Not for browsers: the lines to workers and hosts, and what lists or looks into the process.
constexpr std::array<std::string_view, 4> kHiddenServices = {
    "rmlcell.v1.WorkerService", "rmlcell.v1.HostService", "grpc.reflection.", "grpc.channelz."};

// Methods of these names change nothing, so a GET may call them.
constexpr std::array<std::string_view, 5> kReadingPrefixes = {"Get", "List", "Watch", "Stream",
                                                              "Explain"};

constexpr std::string_view kAcceptPost =
    "application/json, application/proto, application/connect+json, application/connect+proto, "
    "application/grpc-web+proto, application/grpc-web-text+proto";

bool IsHidden(const std::string& service) {
  return std::ranges::any_of(kHiddenServices, [&](std::string_view hidden) {
    return service == hidden || (hidden.back() == '.' && service.starts_with(hidden));
  });
}

bool MayBeRead(const MethodDescriptor& method) {
  return method.server_streaming() || OnlyReads(method.name());
}

const MethodDescriptor* FindMethod(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  const std::string service(path.substr(1, slash - 1));
  if (IsHidden(service)) return nullptr;
  const auto* descriptor =
      google::protobuf::DescriptorPool::generated_pool()->FindServiceByName(service);
  if (descriptor == nullptr) return nullptr;
  return descriptor->FindMethodByName(std::string(path.substr(slash + 1)));
}

RpcRefusal Unimplemented(std::string detail, int http_status) {
  return {.status = FromError({ErrorCode::kCellUnimplemented, std::move(detail), {}}),
          .http_status = http_status,
          .headers = {}};
}

RpcRefusal WrongMethod(std::string detail, std::string allow) {
  RpcRefusal refusal = Unimplemented(std::move(detail), 405);
  refusal.headers.emplace_back("Allow", std::move(allow));
  return refusal;
}

RpcRefusal WrongType(std::string detail) {
  RpcRefusal refusal{.status = FromError({ErrorCode::kCellInvalidArgument, std::move(detail), {}}),
                     .http_status = 415,
                     .headers = {}};
  refusal.headers.emplace_back("Accept-Post", kAcceptPost);
  return refusal;
}

// JSON is UTF-8; another charset would be read wrongly without a word.
bool CharsetIsUtf8(std::string_view content_type) {
  const std::string lower = LowerCase(content_type);
  const std::size_t at = lower.find("charset=");
  if (at == std::string::npos) return true;
  std::string_view charset = Trimmed(std::string_view(lower).substr(at + 8), kBlanks);
  charset = Trimmed(charset.substr(0, charset.find(';')), kBlanks);
  return charset == "utf-8" || charset == "\"utf-8\"" || charset == "utf8";
}

std::optional<Wire> WireOf(const std::string& type, bool streams, bool wants_events) {
  if (type == "application/json") {
    return streams || wants_events ? Wire::kEvents : Wire::kConnectJson;
  }
  if (type == "application/grpc-web" || type == "application/grpc-web+proto") return Wire::kGrpcWeb;
  if (type == "application/grpc-web-text" || type == "application/grpc-web-text+proto") {
    return Wire::kGrpcWebText;
  }
  if (type == "application/proto" && !streams) return Wire::kConnectProto;
  if (type == "application/connect+json" && streams) return Wire::kConnectStreamJson;
  if (type == "application/connect+proto" && streams) return Wire::kConnectStreamProto;
  return std::nullopt;
}

std::string TypeRefused(const std::string& type, const MethodDescriptor& method) {
  if (type.empty()) return "a POST needs a Content-Type, for example application/json";
  if (type == "application/grpc" || type.starts_with("application/grpc+")) {
    return "this is the web port; plain gRPC has a port of its own";
  }
  if (type == "application/proto")
    return method.name() + " is a stream: use application/connect+proto";
  if (type.starts_with("application/connect+")) {
    return method.name() + " is no stream: use application/json or application/proto";
  }
  return "content type " + type + " is not taken";
}

std::optional<RpcRefusal> RouteGet(const HttpRequest& request, RpcRoute& route) {
  if (!MayBeRead(*route.method)) {
    return WrongMethod(route.method->name() + " may change something: use POST", "POST");
  }
  const bool wants_events = Accepts(request.Header("accept"), "text/event-stream");
  route.wire =
      route.method->server_streaming() || wants_events ? Wire::kEvents : Wire::kConnectJson;
  const QueryValue encoding = QueryParameter(request.query, "encoding");
  if (encoding.value && *encoding.value == "proto" && route.wire == Wire::kConnectJson) {
    route.wire = Wire::kConnectProto;
  }
  route.connect_client = QueryParameter(request.query, "connect").value.has_value();
  return std::nullopt;
}

std::optional<RpcRefusal> RoutePost(const HttpRequest& request, RpcRoute& route) {
  const std::string_view content_type = request.Header("content-type");
  const std::string type = MediaType(content_type);
  const bool wants_events = Accepts(request.Header("accept"), "text/event-stream");
  const std::optional<Wire> wire = WireOf(type, route.method->server_streaming(), wants_events);
  if (!wire) return WrongType(TypeRefused(type, *route.method));
  if (!CharsetIsUtf8(content_type)) return WrongType("JSON is taken as UTF-8 only");
  route.wire = *wire;
  return std::nullopt;
}

RpcStatus Invalid(std::string detail) {
  return FromError({ErrorCode::kCellInvalidArgument, std::move(detail), {}});
}

std::optional<std::int64_t> WholeNumber(std::string_view text, std::size_t digits_max) {
  if (text.size() > digits_max || text.starts_with('-')) return std::nullopt;
  return ParseInteger(text);
}

RpcStatus DecodeTimeout(const RpcRoute& route, const HttpRequest& request, RpcRequest& out) {
  const bool grpc_web = route.wire == Wire::kGrpcWeb || route.wire == Wire::kGrpcWebText;
  const std::string_view grpc = request.Header("grpc-timeout");
  const std::string_view connect = request.Header("connect-timeout-ms");
  if (!grpc.empty() && (grpc_web || connect.empty())) {
    out.timeout = ParseGrpcTimeout(grpc);
    if (!out.timeout) return Invalid("grpc-timeout is malformed");
  } else if (!connect.empty()) {
    out.timeout = ParseConnectTimeout(connect);
    if (!out.timeout) return Invalid("connect-timeout-ms is malformed");
  }
  return {};
}

// The text or bytes of the message of a GET.
RpcStatus QueryMessage(const HttpRequest& request, std::string& out) {
  const QueryValue message = QueryParameter(request.query, "message");
  const QueryValue base64 = QueryParameter(request.query, "base64");
  const QueryValue encoding = QueryParameter(request.query, "encoding");
  const QueryValue compression = QueryParameter(request.query, "compression");
  if (!message.ok || !base64.ok || !encoding.ok || !compression.ok) {
    return Invalid("the query has a malformed percent escape");
  }
  if (encoding.value && *encoding.value != "json" && *encoding.value != "proto") {
    return Invalid("encoding is neither json nor proto");
  }
  if (compression.value && !compression.value->empty() && *compression.value != "identity") {
    return FromError({ErrorCode::kCellUnimplemented, "compressed messages are not offered", {}});
  }
  out = message.value.value_or(std::string());
  if (base64.value && *base64.value == "1") {
    std::optional<std::string> decoded = Base64Decode(out);
    if (!decoded) return Invalid("message is not base64");
    out = *std::move(decoded);
  }
  return {};
}

// Removes the protocol's wrapping from the body.
RpcStatus Unwrap(const RpcRoute& route, const HttpRequest& request, std::string& out) {
  if (request.method == "GET") return QueryMessage(request, out);
  for (const std::string_view name :
       {"content-encoding", "connect-content-encoding", "grpc-encoding"}) {
    const std::string_view encoding = request.Header(name);
    if (!encoding.empty() && encoding != "identity") {
      return FromError({ErrorCode::kCellUnimplemented,
                        std::string(name) + " " + std::string(encoding) + " is not offered",
                        {}});
    }
  }
  std::string_view body = request.body;
  std::string decoded;
  switch (route.wire) {
    case Wire::kConnectJson:
    case Wire::kConnectProto:
    case Wire::kEvents:
      out = request.body;
      return {};
    case Wire::kGrpcWebText: {
      std::optional<std::string> bytes = Base64Decode(body);
      if (!bytes) return Invalid("the body is not base64");
      decoded = *std::move(bytes);
      body = decoded;
      break;
    }
    case Wire::kConnectStreamJson:
    case Wire::kConnectStreamProto:
    case Wire::kGrpcWeb:
      break;
  }
  const EnvelopeRead read = ReadSingleEnvelope(body);
  if (!read.message) {
    const ErrorCode code =
        read.compressed ? ErrorCode::kCellUnimplemented : ErrorCode::kCellInvalidArgument;
    return FromError({code, std::string(read.problem), {}});
  }
  out = std::string(*read.message);
  return {};
}

}  // namespace

bool LooksLikeMethod(std::string_view path) {
  if (!path.starts_with('/')) return false;
  const std::size_t slash = path.find('/', 1);
  if (slash == std::string_view::npos || slash + 1 == path.size()) return false;
  const auto is_name = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  const std::string_view service = path.substr(1, slash - 1);
  return service.find('.') != std::string_view::npos &&
         std::ranges::all_of(service, [&](char c) { return is_name(c) || c == '.'; }) &&
         std::ranges::all_of(path.substr(slash + 1), is_name);
}

bool OnlyReads(std::string_view method) {
  return std::ranges::any_of(kReadingPrefixes, [method](std::string_view prefix) {
    if (!method.starts_with(prefix)) return false;
    return method.size() == prefix.size() ||
           (method[prefix.size()] >= 'A' && method[prefix.size()] <= 'Z');
  });
}

RpcRouting RouteRpc(const HttpRequest& request) {
  RpcRouting routing;
  RpcRoute& route = routing.route;
  route.connect_client = !request.Header("connect-protocol-version").empty();
  // Known first, since refusals have this form too.
  const std::string type = MediaType(request.Header("content-type"));
  const bool grpc_web = request.method == "POST" && type.starts_with("application/grpc-web");
  if (grpc_web) route.wire = WireOf(type, false, false).value_or(Wire::kConnectJson);
  const MethodDescriptor* method = FindMethod(request.path);
  if (method == nullptr) {
    routing.refusal =
        Unimplemented("no method " + request.path.substr(1, 200) + " on the web port", 404);
    return routing;
  }
  route.method = method;
  if (method->client_streaming()) {
    routing.refusal = Unimplemented(
        method->name() + " takes a stream from the client, which a browser cannot send", 501);
  } else if (request.method == "GET") {
    routing.refusal = RouteGet(request, route);
  } else if (request.method == "POST") {
    routing.refusal = RoutePost(request, route);
  } else {
    routing.refusal = WrongMethod("use POST", MayBeRead(*method) ? "GET, POST" : "POST");
  }
  return routing;
}

RpcDecoding DecodeRpc(const RpcRoute& route, const HttpRequest& request) {
  RpcDecoding out;
  const std::string_view version = request.Header("connect-protocol-version");
  if (!version.empty() && version != "1") {
    out.status = Invalid("connect-protocol-version is not 1");
    return out;
  }
  out.status = DecodeTimeout(route, request, out.request);
  if (!out.status.ok()) return out;
  std::string content;
  out.status = Unwrap(route, request, content);
  if (!out.status.ok()) return out;

  std::optional<EventId> after;
  const std::string_view last_event = request.Header("last-event-id");
  if (!last_event.empty() && route.wire == Wire::kEvents) {
    after = EventId::Parse(last_event);
    if (!after) {
      out.status = Invalid("Last-Event-ID is not the id of an event of this server");
      return out;
    }
  }
  const QueryValue encoding =
      request.method == "GET" ? QueryParameter(request.query, "encoding") : QueryValue();
  const bool is_json = encoding.value
                           ? *encoding.value == "json"
                           : route.wire == Wire::kConnectJson || route.wire == Wire::kEvents ||
                                 route.wire == Wire::kConnectStreamJson;
  if (!is_json) {
    // gRPC answers bytes that are no message with a status that says nothing.
    if (const Status good = CheckBytes(*route.method->input_type(), content); !good) {
      out.status = FromError(good.error());
      return out;
    }
    out.request.message = std::move(content);
    return out;
  }
  Result<std::string> bytes = JsonToBytes(*route.method->input_type(), content, after);
  if (!bytes) {
    out.status = FromError(bytes.error());
    return out;
  }
  out.request.message = *std::move(bytes);
  return out;
}

std::optional<std::chrono::nanoseconds> ParseGrpcTimeout(std::string_view text) {
  if (text.size() < 2) return std::nullopt;
  const auto number = WholeNumber(text.substr(0, text.size() - 1), 8);
  if (!number) return std::nullopt;
  // Eight digits of hours are 3.6e20 ns, more than 64 bits hold; ten years stand for all beyond.
  constexpr std::chrono::hours kLongest{24 * 365 * 10};
  switch (text.back()) {
    case 'H':
      return std::min(std::chrono::hours(*number), kLongest);
    case 'M':
      return std::min<std::chrono::minutes>(std::chrono::minutes(*number), kLongest);
    case 'S':
      return std::chrono::seconds(*number);
    case 'm':
      return std::chrono::milliseconds(*number);
    case 'u':
      return std::chrono::microseconds(*number);
    case 'n':
      return std::chrono::nanoseconds(*number);
    default:
      return std::nullopt;
  }
}

std::optional<std::chrono::nanoseconds> ParseConnectTimeout(std::string_view text) {
  const auto number = WholeNumber(text, 10);
  if (!number) return std::nullopt;
  return std::chrono::milliseconds(*number);
}

}  // namespace rmlcell::web
