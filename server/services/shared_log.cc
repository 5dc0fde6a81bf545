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

// Events read at once where one goes into a message: those that are not wanted are passed over.
constexpr int kReadAhead = 64;

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

}  // namespace

std::shared_ptr<const std::string> ToldEvents::Of(const storage::EventRecord& event) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = told_.find(event.position); found != told_.end()) return found->second;
  }
  auto made = std::make_shared<const std::string>(EventOf(records_, event).SerializeAsString());
  const std::lock_guard lock(mutex_);
  const auto [row, added] = told_.emplace(event.position, made);
  if (!added) return row->second;
  bytes_ += made->size();
  while (bytes_ > kBytesMax && told_.size() > 1) {
    bytes_ -= told_.begin()->second->size();
    told_.erase(told_.begin());
  }
  return made;
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
  auto read = needs_.feed.RecentAfter(position, kReadAhead);
  if (!read || std::ranges::any_of(*read, [](const storage::EventRecord& event) {
        return event.job == 0 && !IsDeletion(event);
      }))
    return std::nullopt;
  return Make(*std::move(read), position, batched);
}

Result<std::optional<LogPiece>> SharedLog::After(std::int64_t position, bool batched) {
  if (auto known = Known(position, batched)) return known;
  auto read = needs_.feed.EventsAfter(position, kReadAhead);
  if (!read) return read.error();
  return Make(*std::move(read), position, batched);
}

// Watches that are apart end their batches at the same places, and go on together.
std::optional<LogPiece> SharedLog::Make(std::vector<storage::EventRecord> read,
                                        std::int64_t position, bool batched) {
  if (read.empty()) return std::nullopt;
  const std::int64_t border = (position / kEventsMax + 1) * kEventsMax;
  LogPiece piece{.end = position};
  Ids ids;
  std::vector<storage::EventRecord> wanted;
  bool deletion = false;
  for (storage::EventRecord& event : read) {
    if (batched && !wanted.empty() && event.position > border) break;
    Ids of_event = WantedBy(event);
    if (!wanted.empty() && !of_event.empty() && of_event != ids) break;
    piece.end = event.position;
    deletion = deletion || IsDeletion(event);
    if (of_event.empty()) continue;
    ids = std::move(of_event);
    wanted.push_back(std::move(event));
    if (!batched) break;
  }
  // What was made of the events of a job goes with it.
  if (deletion) Forget();
  if (!wanted.empty()) piece.message = MessageOf(ids, wanted, piece.end, batched);
  Keep(position, batched, piece);
  return piece;
}

SharedLog::Ids SharedLog::WantedBy(const storage::EventRecord& event) const {
  Ids ids;
  for (const CellSubscription& subscription : subscriptions_) {
    if (subscription.WantsEvent(event, needs_.facts)) ids.push_back(subscription.id());
  }
  return ids;
}

// The fields of a message may stand in any order: what is serialised already is put behind.
grpc::Slice SharedLog::MessageOf(const Ids& ids, const std::vector<storage::EventRecord>& events,
                                 std::int64_t position, bool batched) {
  v1::WatchCellResponse head;
  head.set_sequence(position);
  head.set_instance_id(needs_.instance_id);
  head.set_log_id(needs_.records.store.LogId());
  head.mutable_subscriptions()->Add(ids.begin(), ids.end());
  std::string message = head.SerializeAsString();
  if (!batched || events.size() == 1) {
    AddField(v1::WatchCellResponse::kEventFieldNumber, *events_->Of(events.front()), message);
  } else {
    std::string all;
    for (const storage::EventRecord& event : events)
      AddField(v1::CellEvents::kEventsFieldNumber, *events_->Of(event), all);
    AddField(v1::WatchCellResponse::kEventsFieldNumber, all, message);
  }
  return grpc::Slice(message);
}

void SharedLog::Keep(std::int64_t position, bool batched, const LogPiece& piece) {
  const std::lock_guard lock(mutex_);
  Kept& kept = kept_[batched ? 1 : 0];
  if (!kept.pieces.emplace(position, piece).second) return;
  const auto size = [](const LogPiece& one) {
    return sizeof(LogPiece) + (one.message ? one.message->size() : 0);
  };
  kept.order.push_back(position);
  kept.bytes += size(piece);
  while (kept.bytes > kBytesMax && kept.order.size() > 1) {
    const auto oldest = kept.pieces.find(kept.order.front());
    kept.bytes -= size(oldest->second);
    kept.pieces.erase(oldest);
    kept.order.pop_front();
  }
}

void SharedLog::Forget() {
  const std::lock_guard lock(mutex_);
  for (Kept& kept : kept_) kept = {};
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
