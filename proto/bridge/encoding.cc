#include "proto/bridge/encoding.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/field_mask_util.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/type_resolver.h>
#include <google/protobuf/util/type_resolver_util.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string_view>
#include <vector>

namespace rmlcell::bridge {
namespace {

namespace pb = google::protobuf;

constexpr const char* kUrlPrefix = "type.googleapis.com";
// The printer of protobuf holds a tree of all that it prints, 100 times the text of a small
// message. A list that is longer is printed entry by entry.
constexpr int kWholeListMax = 100;

std::optional<std::string> Printed(const pb::Message& message, bool whitespace) {
  // The printer follows the bytes, so their order is its order.
  static const std::unique_ptr<pb::util::TypeResolver> resolver(
      pb::util::NewTypeResolverForDescriptorPool(kUrlPrefix, pb::DescriptorPool::generated_pool()));
  pb::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  options.add_whitespace = whitespace;
  std::string json;
  const auto status = pb::util::BinaryToJsonString(
      resolver.get(), std::string(kUrlPrefix) + "/" + message.GetDescriptor()->full_name(),
      StableBytes(message), &json, options);
  if (!status.ok()) return std::nullopt;
  return json;
}

// The place behind `"name":` among the fields of the outermost object.
std::size_t ValueOf(std::string_view json, std::string_view name) {
  const std::string key = '"' + std::string(name) + "\":";
  int depth = 0;
  bool in_text = false;
  for (std::size_t at = 0; at < json.size(); ++at) {
    const char c = json[at];
    if (in_text) {
      if (c == '\\') ++at;
      in_text = c != '"';
    } else if (c == '"') {
      if (depth == 1 && json.substr(at, key.size()) == key) return at + key.size();
      in_text = true;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return std::string_view::npos;
}

// Fields of `message` with so many entries that they are printed by themselves.
std::vector<const pb::FieldDescriptor*> LongLists(const pb::Message& message) {
  std::vector<const pb::FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  std::erase_if(fields, [&](const pb::FieldDescriptor* field) {
    return !field->is_repeated() || field->is_map() ||
           field->cpp_type() != pb::FieldDescriptor::CPPTYPE_MESSAGE ||
           message.GetReflection()->FieldSize(message, field) <= kWholeListMax;
  });
  return fields;
}

// The entries of a list, as they stand between its brackets. False: one cannot be printed.
bool WriteEntries(const pb::Message& message, const pb::FieldDescriptor* field, bool whitespace,
                  const JsonSink& write) {
  const int count = message.GetReflection()->FieldSize(message, field);
  for (int entry = 0; entry < count; ++entry) {
    const std::optional<std::string> one =
        Printed(message.GetReflection()->GetRepeatedMessage(message, field, entry), whitespace);
    if (!one) return false;
    if (entry > 0) write(",");
    if (!whitespace) {
      write(*one);
      continue;
    }
    for (std::string_view rest = *one; !rest.empty();) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      write("\n  ");
      write(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  if (whitespace) write("\n ");
  return true;
}

}  // namespace

std::string StableBytes(const google::protobuf::Message& message) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    message.SerializeToCodedStream(&coded);
  }
  return bytes;
}

bool WriteStableJson(const pb::Message& message, bool whitespace, const JsonSink& write) {
  const std::vector<const pb::FieldDescriptor*> lists = LongLists(message);
  // All but the long lists, which stand there empty.
  std::vector<const pb::FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  pb::FieldMask rest;
  for (const pb::FieldDescriptor* field : fields) {
    if (std::ranges::find(lists, field) == lists.end()) rest.add_paths(field->name());
  }
  const std::unique_ptr<pb::Message> shell(lists.empty() ? nullptr : message.New());
  if (shell) pb::util::FieldMaskUtil::MergeMessageTo(message, rest, {}, shell.get());
  const std::optional<std::string> json = Printed(shell ? *shell : message, whitespace);
  if (!json) return false;
  std::map<std::size_t, const pb::FieldDescriptor*> places;  // behind the bracket of each
  for (const pb::FieldDescriptor* list : lists) {
    const std::size_t value = ValueOf(*json, list->json_name());
    const std::size_t open = value == std::string::npos ? value : json->find('[', value);
    if (open == std::string::npos) return false;
    places.emplace(open + 1, list);
  }
  std::size_t written = 0;
  for (const auto& [place, list] : places) {
    write(std::string_view(*json).substr(written, place - written));
    if (!WriteEntries(message, list, whitespace, write)) return false;
    written = place;
  }
  write(std::string_view(*json).substr(written));
  return true;
}

std::optional<std::string> StableJson(const pb::Message& message, bool whitespace) {
  std::string json;
  const bool whole =
      WriteStableJson(message, whitespace, [&](std::string_view piece) { json += piece; });
  if (!whole) return std::nullopt;
  return json;
}

}  // namespace rmlcell::bridge
