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

// The newest position of a running job, as serialised rmlcell.v1.JobProgress.
struct ProgressText {
  std::int64_t job = 0;
  std::uint64_t version = 0;  // grows with every update of any job that is told
  std::shared_ptr<const std::string> bytes;
};

// Wakes watchers when there is something for them. Durable events are never handed over here: a
// watcher keeps a cursor and reads the log when its writer is free, so one that does not read costs
// a cursor. Positions are latest-wins and change, as watchers see them, at most every
// FeedRhythm::kProgressInterval.
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
  std::unique_ptr<Subscription> Subscribe(std::optional<std::int64_t> job,
                                          std::function<void()> wake);

  // Events of the whole cell after a position; from memory when it reaches back that far. Not
  // beyond position(). Errors: those of the store, CellEventsGone among them.
  Result<std::vector<storage::EventRecord>> EventsAfter(std::int64_t position, int limit);

  // Events of one job after a sequence number; from memory when it reaches back that far.
  Result<std::vector<storage::EventRecord>> JobEvents(std::int64_t job, std::int64_t after_sequence,
                                                      int limit) {
    if (auto events = FromTail(job, after_sequence, limit)) return *std::move(events);
    return store_.JobEvents(job, after_sequence, limit);
  }

  // Seen by watchers at the next interval; at once when there was none for a while.
  void PublishProgress(std::int64_t job, std::string bytes);
  void ForgetProgress(std::int64_t job);
  // The newest position of the job when it is newer than `seen`.
  std::optional<ProgressText> ProgressAfter(std::int64_t job, std::uint64_t seen);
  // The same for all jobs, in order of version.
  std::vector<ProgressText> AllProgressAfter(std::uint64_t seen);

  // Events are told to watchers up to here.
  std::int64_t position();

 private:
  struct Watcher;
  class Handle;

  void Run(const std::stop_token& stop);
  void ReadNewEvents(const std::stop_token& stop);
  bool SkipGoneEvents();
  void Wake(const std::vector<std::int64_t>& jobs);  // and those of everything
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
  std::map<std::int64_t, std::deque<storage::EventRecord>> tails_;       // of jobs that are watched
  std::map<std::int64_t, std::shared_ptr<const std::string>> arriving_;  // not told yet, by job
  std::map<std::int64_t, ProgressText> progress_;
  std::multimap<std::int64_t, std::shared_ptr<Watcher>> watchers_;  // by job; 0: of everything
  std::unique_ptr<storage::Store::Subscription> store_watch_;
  std::jthread thread_;
};

}  // namespace rmlcell::server
