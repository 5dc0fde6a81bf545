#include "server/web/rpc_json.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "engine/core/number_text.h"
#include "proto/bridge/encoding.h"

namespace rmlcell::web {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

// Messages of more than 2 GiB cannot be parsed; the limits of the gateway are far below.
constexpr std::size_t kMessageBytesMax = std::numeric_limits<int>::max();
// What is told of JSON that is none: it names what the client sent, however long that is.
constexpr std::size_t kShownMax = 400;

std::unique_ptr<Message> NewMessage(const Descriptor& type) {
  const Message* prototype =
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(&type);
  RMLCELL_CHECK(prototype != nullptr);  // the type is of the generated pool
  return std::unique_ptr<Message>(prototype->New());
}

// The field when it is a single one of this type.
const FieldDescriptor* FindField(const Descriptor& type, const char* name,
                                 FieldDescriptor::CppType wanted) {
  const FieldDescriptor* field = type.FindFieldByName(name);
  if (field == nullptr || field->is_repeated()) return nullptr;
  return field->cpp_type() == wanted ? field : nullptr;
}
const FieldDescriptor* Int64Field(const Descriptor& type, const char* name) {
  return FindField(type, name, FieldDescriptor::CPPTYPE_INT64);
}
const FieldDescriptor* LogField(const Descriptor& type) {
  return FindField(type, "log_id", FieldDescriptor::CPPTYPE_STRING);
}

constexpr std::size_t kLogIdMax = 64;
constexpr std::size_t kDigitsMax = 19;  // of 64 bits

// Digits alone: as this server writes it.
std::optional<std::int64_t> Sequence(std::string_view text) {
  const bool digits = !text.empty() && text.size() <= kDigitsMax &&
                      std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  const auto number = digits ? ParseInteger(text) : std::nullopt;
  return number ? std::optional<std::int64_t>(*number) : std::nullopt;
}

}  // namespace

std::string EventId::Text() const {
  return std::to_string(sequence) + (log_id.empty() ? "" : "." + log_id);
}

std::optional<EventId> EventId::Parse(std::string_view text) {
  const std::size_t dot = text.find('.');
  const std::optional<std::int64_t> sequence = Sequence(text.substr(0, dot));
  if (!sequence) return std::nullopt;
  if (dot == std::string_view::npos) return EventId{.sequence = *sequence};
  const std::string_view log_id = text.substr(dot + 1);
  const bool good =
      !log_id.empty() && log_id.size() <= kLogIdMax && std::ranges::all_of(log_id, [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || c == '-';
      });
  if (!good) return std::nullopt;
  return EventId{.sequence = *sequence, .log_id = std::string(log_id)};
}

Result<std::string> JsonToBytes(const Descriptor& type, std::string_view json,
                                const std::optional<EventId>& after) {
  const std::unique_ptr<Message> message = NewMessage(type);
  if (!json.empty()) {
    const auto status = google::protobuf::util::JsonStringToMessage(
        google::protobuf::StringPiece(json.data(), json.size()), message.get());
    if (!status.ok()) {
      const auto text = status.message();
      return Error{ErrorCode::kCellInvalidArgument,
                   "the JSON is no " + type.full_name() + ": " +
                       std::string(text.data(), std::min<std::size_t>(text.size(), kShownMax)),
                   {}};
    }
  }
  const FieldDescriptor* field = Int64Field(type, "after_sequence");
  if (after && field != nullptr) {
    message->GetReflection()->SetInt64(message.get(), field, after->sequence);
    if (const FieldDescriptor* log = LogField(type); log != nullptr)
      message->GetReflection()->SetString(message.get(), log, after->log_id);
  }
  return message->SerializeAsString();
}

Status CheckBytes(const Descriptor& type, std::string_view bytes) {
  if (bytes.size() <= kMessageBytesMax &&
      NewMessage(type)->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return {};
  }
  return Error{ErrorCode::kCellInvalidArgument, "the bytes are no " + type.full_name(), {}};
}

Result<JsonMessage> BytesToJson(const Descriptor& type, std::string_view bytes) {
  const std::unique_ptr<Message> message = NewMessage(type);
  if (bytes.size() > kMessageBytesMax ||
      !message->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return Error{ErrorCode::kCellInternal, "an answer is no " + type.full_name(), {}};
  }
  std::optional<std::string> json = bridge::StableJson(*message);
  if (!json) return Error{ErrorCode::kCellInternal, "an answer cannot be written as JSON", {}};
  JsonMessage out;
  out.json = *std::move(json);
  const FieldDescriptor* field = Int64Field(type, "sequence");
  if (field == nullptr) return out;
  EventId id{.sequence = message->GetReflection()->GetInt64(*message, field)};
  if (const FieldDescriptor* log = LogField(type); log != nullptr)
    id.log_id = message->GetReflection()->GetString(*message, log);
  if (id.sequence != 0 || !id.log_id.empty()) out.id = std::move(id);
  return out;
}

}  // namespace rmlcell::web
