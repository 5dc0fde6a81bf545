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
  if (const Status added = AddEvent(type, bytes, text); !added) return added.error();
  return text;
}

// Of each event a message of its own, as a browser is told of it.
Result<std::string> TextOf(v1::WatchCellResponse message) {
  const google::protobuf::Descriptor& type = *v1::WatchCellResponse::descriptor();
  if (!message.has_events()) return TextOf(type, message.SerializeAsString());
  std::string text;
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
  const auto told = [](Result<std::string> text) -> Result<Text> {
    if (!text) return text.error();
    return std::make_shared<const std::string>(*std::move(text));
  };
  // Only what happens is told to many in the same words.
  if (&type != v1::WatchCellResponse::descriptor()) return told(TextOf(type, bytes));
  if (Text known = Find(bytes)) return known;
  v1::WatchCellResponse message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    return told(TextOf(type, bytes));  // which says so
  const bool shared = message.has_event() || message.has_events();
  Result<Text> text = told(TextOf(std::move(message)));
  if (text && shared) Keep(bytes, *text);
  return text;
}

EventTexts::Text EventTexts::Find(std::string_view bytes) {
  const std::lock_guard lock(mutex_);
  const auto found = texts_.find(bytes);
  return found == texts_.end() ? nullptr : found->second;
}

void EventTexts::Keep(std::string_view bytes, const Text& text) {
  const std::lock_guard lock(mutex_);
  ++made_;
  if (bytes.size() + text->size() > kKeptMax) return;
  const auto [row, added] = texts_.emplace(std::string(bytes), text);
  if (!added) return;
  order_.push_back(row);
  bytes_ += bytes.size() + text->size();
  while (bytes_ > kBytesMax) {
    const Texts::iterator oldest = order_.front();
    order_.pop_front();
    bytes_ -= oldest->first.size() + oldest->second->size();
    texts_.erase(oldest);
  }
}

std::size_t EventTexts::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

}  // namespace rmlcell::web
