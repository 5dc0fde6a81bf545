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

// Where a stream of events goes on, as a browser keeps it: "41", or with the log that the number is
// of "41.0198c5b2-...".
struct EventId {
  std::int64_t sequence = 0;
  std::string log_id{};

  std::string Text() const;
  static std::optional<EventId> Parse(std::string_view text);
};

// The serialised message. An empty text counts as "{}". Unknown fields are refused: that catches
// typing errors. `after`, when given, replaces the fields after_sequence and log_id, where the type
// has them. Errors: CellInvalidArgument with what the JSON reader says.
Result<std::string> JsonToBytes(const google::protobuf::Descriptor& type, std::string_view json,
                                const std::optional<EventId>& after = std::nullopt);

// Whether bytes are a message of this type. Error: CellInvalidArgument.
Status CheckBytes(const google::protobuf::Descriptor& type, std::string_view bytes);

struct JsonMessage {
  std::string json;  // on one line; fields with default values are printed, for people
  // Of the fields "sequence" and "log_id"; nothing where there is neither, or 0 without a log.
  std::optional<EventId> id{};
};

// Errors: CellInternal when the bytes are not a message of this type.
Result<JsonMessage> BytesToJson(const google::protobuf::Descriptor& type, std::string_view bytes);

}  // namespace rmlcell::web
