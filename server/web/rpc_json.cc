#include "server/web/rpc_json.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

#include <limits>
#include <memory>

#include "proto/bridge/encoding.h"

namespace rmlcell::web {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

// Messages of more than 2 GiB cannot be parsed; the limits of the gateway are far below.
constexpr std::size_t kMessageBytesMax = std::numeric_limits<int>::max();

std::unique_ptr<Message> NewMessage(const Descriptor& type) {
  const Message* prototype =
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(&type);
  RMLCELL_CHECK(prototype != nullptr);  // the type is of the generated pool
  return std::unique_ptr<Message>(prototype->New());
}

// The field when it is a single 64-bit integer.
const FieldDescriptor* Int64Field(const Descriptor& type, const char* name) {
  const FieldDescriptor* field = type.FindFieldByName(name);
  if (field == nullptr || field->is_repeated()) return nullptr;
  return field->cpp_type() == FieldDescriptor::CPPTYPE_INT64 ? field : nullptr;
}

}  // namespace

Result<std::string> JsonToBytes(const Descriptor& type, std::string_view json,
                                std::optional<std::int64_t> after_sequence) {
  const std::unique_ptr<Message> message = NewMessage(type);
  if (!json.empty()) {
    const auto status = google::protobuf::util::JsonStringToMessage(
        google::protobuf::StringPiece(json.data(), json.size()), message.get());
    if (!status.ok()) {
      const auto text = status.message();
      return Error{
          ErrorCode::kCellInvalidArgument,
          "the JSON is no " + type.full_name() + ": " + std::string(text.data(), text.size()),
          {}};
    }
  }
  const FieldDescriptor* field = Int64Field(type, "after_sequence");
  if (after_sequence && field != nullptr) {
    message->GetReflection()->SetInt64(message.get(), field, *after_sequence);
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
  if (field != nullptr) out.sequence = message->GetReflection()->GetInt64(*message, field);
  return out;
}

}  // namespace rmlcell::web
