#include "server/web/rpc_status.h"

#include <google/protobuf/any.pb.h>

#include <array>

#include "engine/core/hex.h"
#include "google/rpc/status.pb.h"
#include "proto/bridge/encoding.h"
#include "proto/bridge/findings.h"
#include "server/web/base64.h"

namespace rmlcell::web {
namespace {

struct CodeRow {
  std::string_view name;
  int http;
};

// By number. conventions.md section 1, "Code to HTTP"; OUT_OF_RANGE, UNKNOWN, INTERNAL and
// DATA_LOSS as in googleapis google/rpc/code.proto.
constexpr std::array<CodeRow, 17> kCodes = {{
    {"ok", 200},
    {"canceled", 499},
    {"unknown", 500},
    {"invalid_argument", 400},
    {"deadline_exceeded", 504},
    {"not_found", 404},
    {"already_exists", 409},
    {"permission_denied", 403},
    {"resource_exhausted", 429},
    {"failed_precondition", 400},
    {"aborted", 409},
    {"out_of_range", 400},
    {"unimplemented", 501},
    {"internal", 500},
    {"unavailable", 503},
    {"data_loss", 500},
    {"unauthenticated", 401},
}};

const CodeRow& RowOf(int code) {
  const bool known = code >= 0 && static_cast<std::size_t>(code) < kCodes.size();
  return kCodes[known ? static_cast<std::size_t>(code) : std::size_t{kCodeUnknown}];
}

// The length of the UTF-8 character at the start, 0 when there is none.
std::size_t CharacterLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xC2 && lead < 0xE0   ? 2
                             : lead >= 0xE0 && lead < 0xF0 ? 3
                             : lead >= 0xF0 && lead < 0xF5 ? 4
                                                           : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
  }
  // Overlong forms, surrogates and what lies beyond U+10FFFF.
  if (lead == 0xE0 && byte(1) < 0xA0) return 0;
  if (lead == 0xED && byte(1) > 0x9F) return 0;
  if (lead == 0xF0 && byte(1) < 0x90) return 0;
  if (lead == 0xF4 && byte(1) > 0x8F) return 0;
  return length;
}

// "google.rpc.ErrorInfo" of "type.googleapis.com/google.rpc.ErrorInfo".
std::string TypeName(const std::string& type_url) {
  return type_url.substr(type_url.rfind('/') + 1);
}

// JSON of a detail with its "@type"; nothing when the type is not known or the bytes are not of it.
std::string DetailJson(const google::protobuf::Any& detail) {
  return bridge::StableJson(detail).value_or("");
}

std::string PlainDetail(const google::protobuf::Any& detail) {
  std::string json = DetailJson(detail);
  if (!json.empty()) return json;
  return "{\"@type\":" + JsonString(detail.type_url()) +
         ",\"value\":" + JsonString(Base64(detail.value(), true)) + "}";
}

std::string ConnectDetail(const google::protobuf::Any& detail) {
  std::string json = "{\"type\":" + JsonString(TypeName(detail.type_url())) +
                     ",\"value\":" + JsonString(Base64(detail.value(), false));
  const std::string debug = DetailJson(detail);
  if (!debug.empty()) json += ",\"debug\":" + debug;
  return json + "}";
}

template <class DetailText>
std::string ErrorJson(const RpcStatus& status, DetailText detail_text) {
  std::string json = "{\"code\":" + JsonString(CodeName(status.code)) +
                     ",\"message\":" + JsonString(status.message);
  google::rpc::Status rich;
  if (!status.details.empty() && rich.ParseFromString(status.details) && rich.details_size() > 0) {
    json += ",\"details\":[";
    for (int i = 0; i < rich.details_size(); ++i) {
      if (i > 0) json += ',';
      json += detail_text(rich.details(i));
    }
    json += ']';
  }
  return json + "}";
}

}  // namespace

RpcStatus FromError(const Error& error) {
  const google::rpc::Status rich = bridge::ToRpcStatus(error);
  return {.code = rich.code(), .message = rich.message(), .details = rich.SerializeAsString()};
}

RpcStatus FromError(const Error& error, int code) {
  google::rpc::Status rich = bridge::ToRpcStatus(error);
  rich.set_code(code);
  return {.code = code, .message = rich.message(), .details = rich.SerializeAsString()};
}

std::string_view CodeName(int code) { return RowOf(code).name; }

int HttpStatusOf(int code) { return RowOf(code).http; }

std::string EncodeGrpcMessage(std::string_view message) {
  std::string out;
  out.reserve(message.size());
  for (const char c : message) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7F && c != '%') {
      out += c;
    } else {
      out += '%' + HexByte(static_cast<char>(byte));
    }
  }
  return out;
}

std::string PlainErrorJson(const RpcStatus& status) { return ErrorJson(status, PlainDetail); }

std::string ConnectErrorJson(const RpcStatus& status) { return ErrorJson(status, ConnectDetail); }

std::string JsonString(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    const std::size_t length = CharacterLength(text);
    const auto byte = static_cast<unsigned char>(text.front());
    if (length == 0) {
      out += "\xEF\xBF\xBD";
    } else if (byte == '"' || byte == '\\') {
      out += '\\';
      out += text.front();
    } else if (byte < 0x20 || byte == 0x7F) {
      out += "\\u00";
      out += HexByte(static_cast<char>(byte));
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out + "\"";
}

}  // namespace rmlcell::web
