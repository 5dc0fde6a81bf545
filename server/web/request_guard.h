#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/web/http_message.h"

// What a request must be before anything else looks at it. Pure functions of the request and of the
// rules.
namespace rmlcell::web {

struct GuardRules {
  std::string address;                  // the configured one: "127.0.0.1"
  std::vector<std::string> host_names;  // further names under which the cell may be called
  std::vector<std::string> origins;     // foreign pages that may call: "http://localhost:5173"
  std::vector<std::string> forwarded = {"authorization", "x-request-id"};  // become metadata
  std::string secret;  // proves to the gate that the gateway is speaking
};

// The answer that refuses the request; nothing when it may pass.
//  400: HTTP/1.1 without Host or with several, a header twice that may stand once, both ways of
//  framing. 403: a Host that is not ours, which is how DNS rebinding looks; a page of a foreign
//  origin.
std::optional<HttpResponse> RefuseRequest(const GuardRules& rules, const HttpRequest& request);

// The answer to OPTIONS. A preflight passes for configured origins only.
HttpResponse AnswerOptions(const GuardRules& rules, const HttpRequest& request);

// Lets pages of configured origins read the answer; nothing for others.
void AddCorsHeaders(const GuardRules& rules, const HttpRequest& request, HttpResponse& response);

// True when this Host header (with or without a port) names this server: loopback names and
// addresses, the configured address, the further names; any literal address when all addresses are
// listened on, since a literal cannot be rebound.
bool IsOwnHost(const GuardRules& rules, std::string_view host);

// Who calls, as metadata of a call or for a resource: the forwarded headers, the browser's address
// and the secret. Nothing when a forwarded header cannot be sent on. Names that begin with
// "rmlcell-" or "grpc-" are never forwarded.
std::optional<HeaderList> CallerMetadata(const GuardRules& rules, const HttpRequest& request);

}  // namespace rmlcell::web
