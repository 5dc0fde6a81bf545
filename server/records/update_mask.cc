#include "server/records/update_mask.h"

#include <algorithm>

#include "server/base/readable.h"

namespace rmlcell::server {
namespace {

bool HasValue(const google::protobuf::Message& message, std::string_view name) {
  const google::protobuf::FieldDescriptor* field =
      message.GetDescriptor()->FindFieldByName(std::string(name));
  RMLCELL_CHECK(field != nullptr);
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  return field->is_repeated() ? reflection.FieldSize(message, field) > 0
                              : reflection.HasField(message, field);
}

}  // namespace

Result<std::set<std::string, std::less<>>> FieldsToUpdate(
    const google::protobuf::FieldMask& mask, const google::protobuf::Message& wanted,
    std::span<const std::string_view> fields) {
  std::set<std::string, std::less<>> named;
  for (const std::string& path : mask.paths()) {
    if (path == "*") {
      named.insert(fields.begin(), fields.end());
      continue;
    }
    if (std::ranges::find(fields, path) == fields.end()) {
      std::string known;
      for (const std::string_view field : fields) known += std::string(field) + ", ";
      return InvalidArgument("update_mask: '" + Readable(path) + "' is none of " + known + "*");
    }
    named.insert(path);
  }
  if (mask.paths().empty()) {
    for (const std::string_view field : fields) {
      if (HasValue(wanted, field)) named.emplace(field);
    }
  }
  return named;
}

}  // namespace rmlcell::server
