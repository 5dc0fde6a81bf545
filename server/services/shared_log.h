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
  static constexpr std::size_t kKeptBytes = std::size_t{4} << 20;

  explicit ToldEvents(const CellRecords& records) : records_(records) {}

  struct Told {
    std::shared_ptr<const std::string> bytes;
    bool whole = true;  // false: the store was in trouble, and the name alone is told; not kept
  };
  // An event of a record is told as that is when the first asks.
  Told Of(const storage::EventRecord& event);

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
class SharedLog : public std::enable_shared_from_this<SharedLog> {
 public:
  // Events that are read at once, and the most of a message for who takes several in one; such a
  // message ends, too, where it has kMessageBytes.
  static constexpr std::int64_t kEventsAtOnce = 64;
  static constexpr std::size_t kMessageBytes = std::size_t{512} << 10;
  // Messages that are kept, of each form: for watches that share them, and for one alone.
  static constexpr std::size_t kSharedBytes = std::size_t{1} << 20;
  static constexpr std::size_t kBytesOfOne = std::size_t{32} << 10;

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
  // A piece that is being made.
  struct Draft {
    std::int64_t begin = 0;
    std::int64_t end = 0;
    std::int64_t last_wanted = 0;
    Ids ids{};
    std::vector<std::shared_ptr<const std::string>> events{};
    std::size_t bytes = 0;
    bool whole = true;
  };

  std::optional<LogPiece> Known(std::int64_t position, bool batched);
  std::optional<LogPiece> MakeAll(const std::vector<storage::EventRecord>& read,
                                  std::int64_t position, bool batched);
  bool IsFull(const Draft& draft, const Ids& ids, std::int64_t position, bool batched) const;
  Ids WantedBy(const storage::EventRecord& event) const;
  LogPiece Close(const Draft& draft, bool batched);
  grpc::Slice MessageOf(const Draft& draft) const;
  void Keep(std::int64_t position, bool batched, const LogPiece& piece);
  void ForgetBefore(std::int64_t position);

  const SharedLogNeeds needs_;
  const std::shared_ptr<ToldEvents> events_;
  const std::vector<CellSubscription> subscriptions_;
  std::mutex mutex_;
  struct Kept {
    std::map<std::int64_t, LogPiece> pieces;  // by where they begin
    std::deque<std::int64_t> order;           // the oldest first; some may be forgotten
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
