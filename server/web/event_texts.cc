#include "server/web/event_texts.h"

#include <google/protobuf/descriptor.h>

#include <utility>

#include "rmlcell/v1/cell.pb.h"
#include "server/web/rpc_json.h"

namespace rmlcell::web {
namespace {

// JSON has no line ends in it, so one data line holds a message.
Status AddEvent(const google::protobuf::Descriptor& type, std::string_view bytes,
                std::string& text) {
  const Result<JsonMessage> message = BytesToJson(type, bytes);
  if (!message) return message.error();
  if (message->id) text += "id: " + message->id->Text() + "\n";
  text += "data: ";
  text += message->json;
  text += "\n\n";
  return {};
}

Result<std::string> TextOf(const google::protobuf::Descriptor& type, std::string_view bytes) {
  std::string text;
  v1::WatchCellResponse message;
  const bool several = &type == v1::WatchCellResponse::descriptor() &&
                       message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) &&
                       message.has_events();
  if (!several) {
    if (const Status added = AddEvent(type, bytes, text); !added) return added.error();
    return text;
  }
  v1::CellEvents events = std::move(*message.mutable_events());
  for (v1::CellEvent& event : *events.mutable_events()) {
    message.set_sequence(event.sequence());
    *message.mutable_event() = std::move(event);
    if (const Status added = AddEvent(type, message.SerializeAsString(), text); !added)
      return added.error();
  }
  return text;
}

}  // namespace

Result<EventTexts::Text> EventTexts::Of(const google::protobuf::Descriptor& type,
                                        std::string_view bytes) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = texts_.find(bytes); found != texts_.end()) return found->second;
  }
  Result<std::string> made = TextOf(type, bytes);
  if (!made) return made.error();
  auto text = std::make_shared<const std::string>(*std::move(made));
  const std::lock_guard lock(mutex_);
  ++made_;
  if (bytes.size() + text->size() > kKeptMax) return text;
  const auto [row, added] = texts_.emplace(std::string(bytes), text);
  if (!added) return row->second;
  order_.push_back(row);
  bytes_ += bytes.size() + text->size();
  while (bytes_ > kBytesMax) {
    const Texts::iterator oldest = order_.front();
    order_.pop_front();
    bytes_ -= oldest->first.size() + oldest->second->size();
    texts_.erase(oldest);
  }
  return text;
}

std::size_t EventTexts::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

}  // namespace rmlcell::web
