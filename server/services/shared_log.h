#pragma once

#include <grpcpp/support/slice.h>

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/services/cell_snapshot.h"
#include "server/services/subscriptions.h"

// The log of the cell as it goes out to watches: each event is serialised once, and each message
// made once for all watches with equal subscriptions that come by the same place.
namespace rmlcell::server {

class EventFeed;

// What messages of the log are made of.
struct SharedLogNeeds {
  CellRecords records;
  EventFeed& feed;
  JobFactsBook& facts;
  std::string instance_id;
};

// The last events that were told, serialised (rmlcell.v1.CellEvent). Thread-safe.
class ToldEvents {
 public:
  static constexpr std::size_t kBytesMax = std::size_t{4} << 20;

  explicit ToldEvents(const CellRecords& records) : records_(records) {}
  // An event of a record is told as that is when the first asks.
  std::shared_ptr<const std::string> Of(const storage::EventRecord& event);

 private:
  CellRecords records_;
  std::mutex mutex_;
  std::map<std::int64_t, std::shared_ptr<const std::string>> told_;  // by position
  std::size_t bytes_ = 0;
};

// A part of the log: the message for it, and where the next one begins.
struct LogPiece {
  std::optional<grpc::Slice> message{};  // nothing: no event of it is wanted
  std::int64_t end = 0;                  // position of its last event
};

// Of one set of subscriptions. Thread-safe.
class SharedLog {
 public:
  // Events of a message at most, for who takes several in one.
  static constexpr std::int64_t kEventsMax = 64;
  static constexpr std::size_t kBytesMax = std::size_t{1} << 20;

  SharedLog(SharedLogNeeds needs, std::shared_ptr<ToldEvents> events,
            std::vector<CellSubscription> subscriptions)
      : needs_(std::move(needs)),
        events_(std::move(events)),
        subscriptions_(std::move(subscriptions)) {}

  // What comes behind this position; nothing: that was all. `batched`: of several events that are
  // there, for the same subscriptions, one message. May read the store. Errors: those of
  // EventFeed::EventsAfter.
  Result<std::optional<LogPiece>> After(std::int64_t position, bool batched);
  // The same where it was made already, or can be made of what is in memory: never reads the store.
  std::optional<LogPiece> AtOnce(std::int64_t position, bool batched);

 private:
  using Ids = std::vector<std::string>;
  std::optional<LogPiece> Known(std::int64_t position, bool batched);
  std::optional<LogPiece> Make(std::vector<storage::EventRecord> read, std::int64_t position,
                               bool batched);
  Ids WantedBy(const storage::EventRecord& event) const;
  grpc::Slice MessageOf(const Ids& ids, const std::vector<storage::EventRecord>& events,
                        std::int64_t position, bool batched);
  void Keep(std::int64_t position, bool batched, const LogPiece& piece);
  void Forget();

  const SharedLogNeeds needs_;
  const std::shared_ptr<ToldEvents> events_;
  const std::vector<CellSubscription> subscriptions_;
  std::mutex mutex_;
  struct Kept {
    std::map<std::int64_t, LogPiece> pieces;  // by where they begin
    std::deque<std::int64_t> order;           // the oldest first
    std::size_t bytes = 0;
  };
  Kept kept_[2];  // guarded by mutex_; one event a message, several
};

// Those of all sets that are watched. Thread-safe.
class SharedLogs {
 public:
  explicit SharedLogs(SharedLogNeeds needs)
      : needs_(std::move(needs)), events_(std::make_shared<ToldEvents>(needs_.records)) {}
  std::shared_ptr<SharedLog> Of(const std::vector<const CellSubscription*>& subscriptions);

 private:
  const SharedLogNeeds needs_;
  const std::shared_ptr<ToldEvents> events_;
  std::mutex mutex_;
  std::map<std::string, std::weak_ptr<SharedLog>> logs_;  // by the subscriptions, serialised
};

}  // namespace rmlcell::server
