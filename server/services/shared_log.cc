#include "server/services/shared_log.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/wire_format_lite.h>

#include <algorithm>
#include <utility>

#include "server/events/event_feed.h"

namespace rmlcell::server {
namespace {

using google::protobuf::internal::WireFormatLite;

// A field of bytes, or of a message that is serialised already.
void AddField(int field, std::string_view bytes, std::string& message) {
  google::protobuf::io::StringOutputStream stream(&message);
  google::protobuf::io::CodedOutputStream out(&stream);
  out.WriteTag(WireFormatLite::MakeTag(field, WireFormatLite::WIRETYPE_LENGTH_DELIMITED));
  out.WriteVarint64(bytes.size());
  out.WriteRaw(bytes.data(), static_cast<int>(bytes.size()));
}

bool IsDeletion(const storage::EventRecord& event) {
  return event.job == 0 && event.kind == storage::kDeleted && event.resource.starts_with("jobs/");
}

std::size_t SizeOf(const LogPiece& piece) {
  return sizeof(LogPiece) + (piece.message ? piece.message->size() : 0);
}

}  // namespace

ToldEvents::Told ToldEvents::Of(const storage::EventRecord& event) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = told_.find(event.position); found != told_.end())
      return {.bytes = found->second};
  }
  const ReadEvent read = EventOf(records_, event);
  auto made = std::make_shared<const std::string>(read.event.SerializeAsString());
  if (!read.whole) return {.bytes = std::move(made), .whole = false};
  const std::lock_guard lock(mutex_);
  const auto [row, added] = told_.emplace(event.position, made);
  if (!added) return {.bytes = row->second};
  bytes_ += made->size();
  while (bytes_ > kKeptBytes && told_.size() > 1) {
    bytes_ -= told_.begin()->second->size();
    told_.erase(told_.begin());
  }
  return {.bytes = std::move(made)};
}

std::optional<LogPiece> SharedLog::Known(std::int64_t position, bool batched) {
  const std::lock_guard lock(mutex_);
  const auto& pieces = kept_[batched ? 1 : 0].pieces;
  const auto found = pieces.find(position);
  if (found == pieces.end()) return std::nullopt;
  return found->second;
}

std::optional<LogPiece> SharedLog::AtOnce(std::int64_t position, bool batched) {
  if (auto known = Known(position, batched)) return known;
  // Whether a job passes a filter is perhaps asked of the store, and so is what a record is by now.
  if (std::ranges::any_of(subscriptions_, &CellSubscription::filtered)) return std::nullopt;
  const auto read = needs_.feed.RecentAfter(position, kEventsAtOnce);
  if (!read || std::ranges::any_of(*read, [](const storage::EventRecord& event) {
        return event.job == 0 && !IsDeletion(event);
      }))
    return std::nullopt;
  return MakeAll(*read, position, batched);
}

Result<std::optional<LogPiece>> SharedLog::After(std::int64_t position, bool batched) {
  if (auto known = Known(position, batched)) return known;
  const auto read = needs_.feed.EventsAfter(position, kEventsAtOnce);
  if (!read) return read.error();
  return MakeAll(*read, position, batched);
}

// All pieces that what was read makes; the first of them is given. A batch that more of the log may
// belong to is left for the next time.
std::optional<LogPiece> SharedLog::MakeAll(const std::vector<storage::EventRecord>& read,
                                           std::int64_t position, bool batched) {
  std::optional<LogPiece> first;
  Draft draft{.begin = position, .end = position};
  const auto close = [&] {
    LogPiece piece = Close(draft, batched);
    draft = {.begin = piece.end, .end = piece.end};
    if (!first) first = std::move(piece);
  };
  for (const storage::EventRecord& event : read) {
    Ids ids = WantedBy(event);
    if (!ids.empty() && IsFull(draft, ids, event.position, batched)) close();
    // What was made of the events of a job goes with it.
    if (IsDeletion(event)) ForgetBefore(event.position);
    draft.end = event.position;
    if (ids.empty()) continue;
    ToldEvents::Told told = events_->Of(event);
    draft.last_wanted = event.position;
    draft.ids = std::move(ids);
    draft.bytes += told.bytes->size();
    draft.whole = draft.whole && told.whole;
    draft.events.push_back(std::move(told.bytes));
  }
  const bool more = batched && first && std::ssize(read) == kEventsAtOnce;
  if (draft.end > draft.begin && !more) close();
  return first;
}

// Watches that are apart end their batches at the same places, and go on together.
bool SharedLog::IsFull(const Draft& draft, const Ids& ids, std::int64_t position,
                       bool batched) const {
  if (draft.events.empty()) return false;
  if (!batched || draft.ids != ids || draft.bytes >= kMessageBytes) return true;
  return (position - 1) / kEventsAtOnce != (draft.last_wanted - 1) / kEventsAtOnce;
}

SharedLog::Ids SharedLog::WantedBy(const storage::EventRecord& event) const {
  Ids ids;
  for (const CellSubscription& subscription : subscriptions_) {
    if (subscription.WantsEvent(event, needs_.facts)) ids.push_back(subscription.id());
  }
  return ids;
}

LogPiece SharedLog::Close(const Draft& draft, bool batched) {
  LogPiece piece{.end = draft.end};
  if (!draft.events.empty()) piece.message = MessageOf(draft);
  if (draft.whole) Keep(draft.begin, batched, piece);
  return piece;
}

// The fields of a message may stand in any order: what is serialised already is put behind.
grpc::Slice SharedLog::MessageOf(const Draft& draft) const {
  v1::WatchCellResponse head;
  head.set_sequence(draft.last_wanted);
  head.set_instance_id(needs_.instance_id);
  head.set_log_id(needs_.records.store.LogId());
  head.mutable_subscriptions()->Add(draft.ids.begin(), draft.ids.end());
  std::string message = head.SerializeAsString();
  if (draft.events.size() == 1) {
    AddField(v1::WatchCellResponse::kEventFieldNumber, *draft.events.front(), message);
  } else {
    std::string all;
    for (const auto& event : draft.events)
      AddField(v1::CellEvents::kEventsFieldNumber, *event, all);
    AddField(v1::WatchCellResponse::kEventsFieldNumber, all, message);
  }
  return grpc::Slice(message);
}

void SharedLog::Keep(std::int64_t position, bool batched, const LogPiece& piece) {
  // One owner is the caller.
  const std::size_t most = weak_from_this().use_count() > 1 ? kSharedBytes : kBytesOfOne;
  const std::lock_guard lock(mutex_);
  Kept& kept = kept_[batched ? 1 : 0];
  if (!kept.pieces.emplace(position, piece).second) return;
  kept.order.push_back(position);
  kept.bytes += SizeOf(piece);
  while (kept.bytes > most && kept.order.size() > 1) {
    const auto oldest = kept.pieces.find(kept.order.front());
    kept.order.pop_front();
    if (oldest == kept.pieces.end()) continue;
    kept.bytes -= SizeOf(oldest->second);
    kept.pieces.erase(oldest);
  }
}

void SharedLog::ForgetBefore(std::int64_t position) {
  const std::lock_guard lock(mutex_);
  for (Kept& kept : kept_) {
    const auto end = kept.pieces.lower_bound(position);
    for (auto piece = kept.pieces.begin(); piece != end; piece = kept.pieces.erase(piece))
      kept.bytes -= SizeOf(piece->second);
  }
}

std::shared_ptr<SharedLog> SharedLogs::Of(
    const std::vector<const CellSubscription*>& subscriptions) {
  std::string key;
  std::vector<CellSubscription> copies;
  for (const CellSubscription* subscription : subscriptions) {
    AddField(1, subscription->wanted().SerializeAsString(), key);
    copies.push_back(*subscription);
  }
  const std::lock_guard lock(mutex_);
  std::erase_if(logs_, [](const auto& row) { return row.second.expired(); });
  std::weak_ptr<SharedLog>& known = logs_[key];
  std::shared_ptr<SharedLog> log = known.lock();
  if (log == nullptr) {
    log = std::make_shared<SharedLog>(needs_, events_, std::move(copies));
    known = log;
  }
  return log;
}

}  // namespace rmlcell::server
