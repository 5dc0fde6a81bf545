#include "server/web/request_guard.h"

#include <algorithm>
#include <array>

#include "engine/core/letters.h"
#include "server/web/base64.h"
#include "server/web/rpc_call.h"
#include "server/web/rpc_codec.h"

namespace rmlcell::web {
namespace {

// Headers that decide something here: twice, two readers could decide differently.
constexpr std::array<std::string_view, 9> kSingleHeaders = {"host",
                                                            "content-type",
                                                            "content-length",
                                                            "origin",
                                                            "authorization",
                                                            "last-event-id",
                                                            "grpc-timeout",
                                                            "connect-protocol-version",
                                                            "connect-timeout-ms"};

constexpr std::string_view kAllowedHeaders =
    "accept, authorization, connect-protocol-version, connect-timeout-ms, content-type, "
    "grpc-timeout, "
    "if-none-match, last-event-id, x-grpc-web, x-request-id, x-user-agent";
constexpr std::string_view kExposedHeaders =
    "grpc-status, grpc-message, grpc-status-details-bin, etag, content-disposition, x-request-id";
constexpr std::string_view kPreflightAge = "7200";  // s; the most that Chromium takes

HttpResponse Refuse(int http_status, ErrorCode code, std::string detail) {
  return JsonRefusal({.status = FromError({code, std::move(detail), {}}),
                      .http_status = http_status,
                      .headers = {}},
                     false);
}

bool AllDigits(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

// The name of "name:port", "[::1]:port" or either alone; empty when malformed.
std::string HostName(std::string_view host) {
  if (!host.empty() && host.front() == '[') {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return {};
    const std::string_view rest = host.substr(end + 1);
    if (!rest.empty() && (rest.front() != ':' || !AllDigits(rest.substr(1)))) return {};
    return LowerCase(host.substr(1, end - 1));
  }
  const std::size_t colon = host.find(':');
  if (colon != std::string_view::npos && !AllDigits(host.substr(colon + 1))) return {};
  return LowerCase(host.substr(0, colon));
}

bool IsIpv4(std::string_view name) {
  int parts = 0;
  while (true) {
    const std::size_t dot = name.find('.');
    const std::string_view part = name.substr(0, dot);
    if (part.empty() || part.size() > 3 || !AllDigits(part) || std::stoi(std::string(part)) > 255)
      return false;
    ++parts;
    if (dot == std::string_view::npos) break;
    name.remove_prefix(dot + 1);
  }
  return parts == 4;
}

bool IsIpv6(std::string_view name) {
  return name.find(':') != std::string_view::npos && std::ranges::all_of(name, [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || c == ':' || c == '.';
         });
}

bool IsLoopback(std::string_view name) {
  return name == "localhost" || name.ends_with(".localhost") || name == "::1" ||
         (name.starts_with("127.") && IsIpv4(name));
}

bool IsAllowedOrigin(const GuardRules& rules, std::string_view origin) {
  return std::ranges::any_of(rules.origins, [&](const std::string& allowed) {
    return EqualIgnoringCase(allowed, origin);
  });
}

// The page came from this very server. TLS in front of the cell makes it https.
bool IsOwnOrigin(std::string_view origin, std::string_view host) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme) && EqualIgnoringCase(origin.substr(scheme.size()), host))
      return true;
  }
  return false;
}

}  // namespace

std::optional<HttpResponse> RefuseRequest(const GuardRules& rules, const HttpRequest& request) {
  for (const std::string_view name : kSingleHeaders) {
    if (request.CountOf(name) > 1) {
      return Refuse(400, ErrorCode::kCellInvalidArgument,
                    "header " + std::string(name) + " stands twice");
    }
  }
  if (request.CountOf("transfer-encoding") > 0 && request.version == 10) {
    return Refuse(400, ErrorCode::kCellInvalidArgument, "HTTP/1.0 has no transfer encodings");
  }
  if (request.host.empty() && request.version >= 11) {
    return Refuse(400, ErrorCode::kCellInvalidArgument, "the request has no Host");
  }
  if (!request.host.empty() && !IsOwnHost(rules, request.host)) {
    return Refuse(403, ErrorCode::kCellPermission, "this server is not " + request.host);
  }
  const std::string_view origin = request.Header("origin");
  if (!origin.empty()) {
    if (IsOwnOrigin(origin, request.host) || IsAllowedOrigin(rules, origin)) return std::nullopt;
    return Refuse(403, ErrorCode::kCellPermission,
                  "pages of " + std::string(origin) + " may not call");
  }
  // A browser that sends no Origin (an image, a script, a link) still says where the page came
  // from. Following a link to the page itself or to a picture is what links are for; calls are not.
  const std::string_view site = request.Header("sec-fetch-site");
  const bool foreign = site == "cross-site" || site == "same-site";
  if (foreign && LooksLikeMethod(request.path)) {
    return Refuse(403, ErrorCode::kCellPermission, "pages of other sites may not call");
  }
  return std::nullopt;
}

HttpResponse AnswerOptions(const GuardRules& rules, const HttpRequest& request) {
  HttpResponse response{.status = 204, .headers = {}, .body = {}, .length = {}};
  response.headers.emplace_back("Allow", "GET, HEAD, POST, OPTIONS");
  const std::string_view origin = request.Header("origin");
  const bool preflight = !request.Header("access-control-request-method").empty();
  if (preflight && IsAllowedOrigin(rules, origin)) {
    response.headers.emplace_back("Access-Control-Allow-Methods", "GET, HEAD, POST");
    response.headers.emplace_back("Access-Control-Allow-Headers", kAllowedHeaders);
    response.headers.emplace_back("Access-Control-Max-Age", kPreflightAge);
    // A page on another network may reach a server on loopback only when the server says so.
    if (request.Header("access-control-request-private-network") == "true") {
      response.headers.emplace_back("Access-Control-Allow-Private-Network", "true");
    }
  }
  return response;
}

void AddCorsHeaders(const GuardRules& rules, const HttpRequest& request, HttpResponse& response) {
  if (rules.origins.empty()) return;
  response.headers.emplace_back("Vary", "Origin");
  const std::string_view origin = request.Header("origin");
  if (origin.empty() || !IsAllowedOrigin(rules, origin)) return;
  response.headers.emplace_back("Access-Control-Allow-Origin", origin);
  response.headers.emplace_back("Access-Control-Expose-Headers", kExposedHeaders);
}

bool IsOwnHost(const GuardRules& rules, std::string_view host) {
  const std::string name = HostName(host);
  if (name.empty()) return false;
  if (IsLoopback(name) || EqualIgnoringCase(name, rules.address)) return true;
  const bool everywhere = rules.address == "0.0.0.0" || rules.address == "::";
  if (everywhere && (IsIpv4(name) || IsIpv6(name))) return true;
  return std::ranges::any_of(rules.host_names,
                             [&](const std::string& own) { return EqualIgnoringCase(own, name); });
}

std::optional<HeaderList> CallerMetadata(const GuardRules& rules, const HttpRequest& request) {
  HeaderList metadata = {{"rmlcell-web-secret", rules.secret}, {"rmlcell-web-peer", request.peer}};
  for (const std::string& name : rules.forwarded) {
    if (name.starts_with("rmlcell-") || name.starts_with("grpc-")) continue;
    const std::string_view value = request.Header(name);
    if (value.empty()) continue;
    std::string sent(value);
    if (name.ends_with("-bin")) {
      std::optional<std::string> bytes = Base64Decode(value);
      if (!bytes) return std::nullopt;
      sent = *std::move(bytes);
    }
    if (!IsMetadata(name, sent)) return std::nullopt;
    metadata.emplace_back(name, std::move(sent));
  }
  return metadata;
}

}  // namespace rmlcell::web
