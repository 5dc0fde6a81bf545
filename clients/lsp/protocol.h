#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "clients/lsp/text_position.h"

// JSON-RPC and the shapes of the language server protocol 3.17 that several features share. What a
// client sends is foreign: reading never throws.
namespace rmlcell::lsp {

using Json = nlohmann::json;

// Codes of JSON-RPC and of the protocol.
enum class ErrorNumber : int {
  kParseError = -32700,
  kInvalidRequest = -32600,
  kMethodNotFound = -32601,
  kInvalidParams = -32602,
  kInternalError = -32603,
  kServerNotInitialized = -32002,
  kRequestCancelled = -32800,
  kRequestFailed = -32803,
};

// What a request cannot do, with what is shown to the programmer.
struct RequestError {
  ErrorNumber number = ErrorNumber::kRequestFailed;
  std::string message;
};

// Arrays and objects inside each other; deeper is refused before it is read.
inline constexpr int kJsonDepthMax = 64;

// Nothing when it is no JSON, or nested too deep. Half a surrogate pair counts as U+FFFD.
std::optional<Json> ReadJson(std::string_view text);
// One line; bytes that are no UTF-8 become U+FFFD.
std::string WriteJson(const Json& json);

// The member at the end of a path of names, or null when there is none on the way.
const Json* Member(const Json& json, std::initializer_list<std::string_view> path);
std::optional<std::string> TextMember(const Json& json,
                                      std::initializer_list<std::string_view> path);
bool FlagMember(const Json& json, std::initializer_list<std::string_view> path);
std::optional<std::int64_t> NumberMember(const Json& json,
                                         std::initializer_list<std::string_view> path);
// Whether the member is an array that has this text.
bool Lists(const Json& json, std::initializer_list<std::string_view> path, std::string_view text);

std::optional<Position> ReadPosition(const Json& json);
std::optional<Range> ReadRange(const Json& json);

Json ToJson(Position position);
Json ToJson(const Range& range);
Json Location(std::string_view uri, const Range& range);
Json TextEdit(const Range& range, std::string_view text);
Json Markdown(std::string_view text);

}  // namespace rmlcell::lsp
