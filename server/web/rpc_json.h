#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace google::protobuf {
class Descriptor;
}

// Messages between their wire form and proto3 JSON, for any type of the generated pool.
// Thread-safe.
namespace rmlcell::web {

// The serialised message. An empty text counts as "{}". Unknown fields are refused: that catches
// typing errors. `after_sequence`, when given, replaces the field of that name, if the type has it.
// Errors: CellInvalidArgument with what the JSON reader says.
Result<std::string> JsonToBytes(const google::protobuf::Descriptor& type, std::string_view json,
                                std::optional<std::int64_t> after_sequence = std::nullopt);

// Whether bytes are a message of this type. Error: CellInvalidArgument.
Status CheckBytes(const google::protobuf::Descriptor& type, std::string_view bytes);

struct JsonMessage {
  std::string json;           // on one line; fields with default values are printed, for people
  std::int64_t sequence = 0;  // of the field "sequence"; 0 when there is none
};

// Errors: CellInternal when the bytes are not a message of this type.
Result<JsonMessage> BytesToJson(const google::protobuf::Descriptor& type, std::string_view bytes);

}  // namespace rmlcell::web
