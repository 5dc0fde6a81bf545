#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/base/steady_clock.h"
#include "server/events/feed_rhythm.h"
#include "storage/store.h"

namespace rmlcell::server {

// What stands for now of a resource, later ones replacing earlier ones: of a running job
// (rmlcell.v1.JobProgress) or of a machine (rmlcell.v1.MachineStatus), serialised.
struct Latest {
  std::string resource{};     // "jobs/17"
  std::uint64_t version = 0;  // grows with every one that is told, of whatever resource
  std::shared_ptr<const std::string> bytes;
};

// Wakes watchers when there is something for them. Durable events are never handed over here: a
// watcher keeps a cursor and reads the log when its writer is free, so one that does not read costs
// a cursor. What stands for now is latest-wins, and what stands of one resource changes, as
// watchers see it, at most every FeedRhythm::kLatestInterval.
//
// Knows no gRPC: the race detector sees all of it. Thread-safe. Lock order: mutex_ is a leaf;
// neither the store nor a watcher is called under it.
class EventFeed {
 public:
  // Events kept in memory, so that a hundred watchers of everything read the log once.
  static constexpr std::size_t kRecentEvents = 4096;

  struct Timing {
    SteadyClock clock = SteadyTime;
    // Another server may write to the same store: look without a hint that often.
    std::chrono::milliseconds poll_interval{1000};
    std::chrono::microseconds message_time = FeedRhythm::kMessageTime;
  };

  explicit EventFeed(storage::Store& store) : EventFeed(store, Timing()) {}
  EventFeed(storage::Store& store, Timing timing);
  ~EventFeed();
  EventFeed(const EventFeed&) = delete;
  EventFeed& operator=(const EventFeed&) = delete;

  // What a watcher is woken for; may be called from any thread, late, or for nothing. Must be quick
  // and must not block. Ends when the handle is destroyed; then no call is under way or comes.
  class Subscription {
   public:
    virtual ~Subscription() = default;
  };
  std::unique_ptr<Subscription> Subscribe(std::string resource, std::function<void()> wake);
  static constexpr std::string_view kEverything{};  // in place of a resource

  // Events of the whole cell after a position; from memory when it reaches back that far. Not
  // beyond position(). Errors: those of the store, CellEventsGone among them.
  Result<std::vector<storage::EventRecord>> EventsAfter(std::int64_t position, int limit);
  // The same at once; nothing: memory does not reach back that far.
  std::optional<std::vector<storage::EventRecord>> RecentAfter(std::int64_t position, int limit);

  // Events of one job after a sequence number; from memory when it reaches back that far.
  Result<std::vector<storage::EventRecord>> JobEvents(std::int64_t job, std::int64_t after_sequence,
                                                      int limit) {
    if (auto events = FromTail(job, after_sequence, limit)) return *std::move(events);
    return store_.JobEvents(job, after_sequence, limit);
  }

  // Seen by watchers at once when this one was not told for an interval, else when that is over.
  void Publish(const std::string& resource, std::string bytes);
  void Forget(const std::string& resource);
  // What stands for now of this resource when it is newer than `seen`.
  std::optional<Latest> LatestAfter(const std::string& resource, std::uint64_t seen);
  // The same of all resources, in order of version.
  std::vector<Latest> AllLatestAfter(std::uint64_t seen);

  // Of the newest of what stands for now, of all resources.
  std::uint64_t version();

  // Events are told to watchers up to here.
  std::int64_t position();

 private:
  struct Watcher;
  class Handle;

  void Run(const std::stop_token& stop);
  // How many events were read, and how many watchers woken for them.
  struct Look {
    std::size_t events = 0;
    std::size_t watchers = 0;
  };
  Look ReadNewEvents(const std::stop_token& stop);
  // Of what arrived. Precondition: mutex_ is held.
  FeedRhythm::Instant NextLatest(const FeedRhythm& rhythm) const;
  FeedRhythm::Instant ToldAt(const std::string& resource) const;
  std::vector<std::string> TakeLatest(const FeedRhythm& rhythm, FeedRhythm::Instant now);
  bool SkipGoneEvents();
  void DropEventsOf(std::string_view job);                      // precondition: mutex_ is held
  std::size_t Wake(const std::vector<std::string>& resources);  // and those of everything
  // Nothing when memory does not reach back that far.
  std::optional<std::vector<storage::EventRecord>> FromTail(std::int64_t job,
                                                            std::int64_t after_sequence, int limit);
  static void Call(const std::vector<std::shared_ptr<Watcher>>& woken);

  storage::Store& store_;
  const Timing timing_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  bool hinted_ = true;
  std::uint64_t version_ = 0;
  std::int64_t position_ = 0;
  std::deque<storage::EventRecord> recent_;
  std::int64_t complete_after_ = 0;  // every event behind this position is in recent_
  // By resource.
  std::map<std::string, std::deque<storage::EventRecord>> tails_;       // of jobs that are watched
  std::map<std::string, std::shared_ptr<const std::string>> arriving_;  // not told yet
  std::uint64_t arrivals_ = 0;  // counts those that did not wait already
  std::map<std::string, Latest> latest_;
  std::map<std::string, FeedRhythm::Instant> told_at_;  // of latest_, by the clock of the feed
  std::multimap<std::string, std::shared_ptr<Watcher>> watchers_;
  std::unique_ptr<storage::Store::Subscription> store_watch_;
  std::jthread thread_;
};

}  // namespace rmlcell::server
