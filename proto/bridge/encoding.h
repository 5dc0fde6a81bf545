#pragma once

#include <optional>
#include <string>

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

}  // namespace rmlcell::bridge
