#pragma once

#include <string>
#include <string_view>

#include "engine/core/result.h"

// How calls end, and how each protocol of the web port says so.
namespace rmlcell::web {

struct RpcStatus {
  int code = 0;         // google.rpc.Code; 0 is good
  std::string message;  // for developers; any bytes, since it comes from foreign handlers too
  std::string details;  // a serialised google.rpc.Status, or empty

  bool ok() const { return code == 0; }
};

inline constexpr int kCodeCancelled = 1;
inline constexpr int kCodeUnknown = 2;
inline constexpr int kCodeInvalidArgument = 3;
inline constexpr int kCodeUnimplemented = 12;
inline constexpr int kCodeInternal = 13;
inline constexpr int kCodeUnavailable = 14;

// With ErrorInfo and our ErrorDetail, as gRPC clients get it.
RpcStatus FromError(const Error& error);

// As FromError, for a refusal whose gRPC code the catalogue row does not give.
RpcStatus FromError(const Error& error, int code);

// "not_found", as Connect names the codes; "unknown" for numbers that are none.
std::string_view CodeName(int code);

// The HTTP status of a code (conventions.md section 1); 200 for 0.
int HttpStatusOf(int code);

// Percent-encoding of the grpc-message header: visible ASCII but '%' stays.
std::string EncodeGrpcMessage(std::string_view message);

// {"code":"not_found","message":"...","details":[{"@type":"...", ...}]}. Details of types that the
// process does not know are {"@type":"...","value":"<base64>"}.
std::string PlainErrorJson(const RpcStatus& status);

// The same in Connect's form: details are {"type":"...","value":"<base64 without
// padding>","debug":{...}}.
std::string ConnectErrorJson(const RpcStatus& status);

// A JSON string with its quotes; bytes that are not UTF-8 become U+FFFD.
std::string JsonString(std::string_view text);

}  // namespace rmlcell::web
