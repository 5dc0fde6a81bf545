#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "server/web/http_message.h"
#include "server/web/rpc_status.h"

namespace google::protobuf {
class MethodDescriptor;
}

// Which method a request means and in what form it speaks: platform.md section 3, the table. Pure
// functions of the request and of the generated descriptors; nothing here knows a single method.
namespace rmlcell::web {

enum class Wire {
  kConnectJson,         // unary; curl and people use the same
  kConnectProto,        // unary, binary
  kConnectStreamJson,   // envelopes of JSON
  kConnectStreamProto,  // envelopes
  kGrpcWeb,             // envelopes, trailers in the body
  kGrpcWebText,         // the same in base64
  kEvents,              // server-sent events
};

// What the headers say, before the body is read.
struct RpcRoute {
  const google::protobuf::MethodDescriptor* method = nullptr;
  Wire wire = Wire::kConnectJson;
  bool connect_client = false;  // sent Connect-Protocol-Version: gets details in Connect's form
};

// A refusal before any call is made. Some have an HTTP status of their own (404, 405, 415).
struct RpcRefusal {
  RpcStatus status;
  int http_status = 0;  // 0: that of the code
  HeaderList headers;   // Allow, Accept-Post
};

struct RpcRouting {
  RpcRoute route;  // whatever of it is known also beside a refusal
  std::optional<RpcRefusal> refusal;
};

// True when a path may be a method: "/package.Service/Method".
bool LooksLikeMethod(std::string_view path);

// True when a method of this name changes nothing: Get, List, Watch, Stream or Explain as a whole
// word, so GetJob and not Getaway.
bool OnlyReads(std::string_view method);

// Finds method and form. Refused: unknown methods and services that are not for browsers (404),
// methods with a client stream (501), other HTTP methods than GET, POST (405), a POST without one
// of our content types (415; that also keeps out the forms of foreign pages), and GET for a method
// that is neither a server stream nor named Get, List, Watch, Stream or Explain (405: a GET changes
// nothing).
RpcRouting RouteRpc(const HttpRequest& request);

// A call, ready to be made.
struct RpcRequest {
  std::string message;  // serialised
  std::optional<std::chrono::nanoseconds> timeout;
};

struct RpcDecoding {
  RpcRequest request;
  RpcStatus status;  // why it cannot be made
};

// Reads message and deadline out of a request whose body is complete.
RpcDecoding DecodeRpc(const RpcRoute& route, const HttpRequest& request);

// "10S", "250m": up to eight digits and a unit. Nothing when malformed.
std::optional<std::chrono::nanoseconds> ParseGrpcTimeout(std::string_view text);

// Milliseconds, up to ten digits. Nothing when malformed.
std::optional<std::chrono::nanoseconds> ParseConnectTimeout(std::string_view text);

}  // namespace rmlcell::web
