#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace google::protobuf {
class Message;
}

namespace rmlcell::bridge {

// Equal messages give equal bytes, in every process: protobuf by itself writes maps in the order of
// a hash with a random seed.
std::string StableBytes(const google::protobuf::Message& message);

// The JSON form of protobuf with every field present and maps in the order of their keys. Nothing
// when a google.protobuf.Any in it holds a type that is not known, or no message of its type.
std::optional<std::string> StableJson(const google::protobuf::Message& message,
                                      bool whitespace = false);

// The same, a piece at a time: who writes it out holds no more than a piece. False where that gives
// nothing; what was written then is no whole message.
using JsonSink = std::function<void(std::string_view piece)>;
bool WriteStableJson(const google::protobuf::Message& message, bool whitespace,
                     const JsonSink& write);

}  // namespace rmlcell::bridge
