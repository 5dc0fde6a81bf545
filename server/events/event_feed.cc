#include "server/events/event_feed.h"

#include <algorithm>
#include <set>
#include <utility>

namespace rmlcell::server {
namespace {

constexpr int kReadBatch = 1000;

// Many watchers of one job read the same events at about the same time: once from the store is
// enough.
constexpr std::size_t kTailEvents = 1024;

std::string ResourceOf(const storage::EventRecord& event) {
  return event.job > 0 ? storage::JobName(event.job) : event.resource;
}

}  // namespace

struct EventFeed::Watcher {
  std::function<void()> wake;
  std::mutex calling;  // held during a call, so that the handle's destructor can wait for it
  bool gone = false;
};

class EventFeed::Handle : public EventFeed::Subscription {
 public:
  Handle(EventFeed& feed, std::string key, std::shared_ptr<Watcher> watcher)
      : feed_(feed), key_(std::move(key)), watcher_(std::move(watcher)) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() override {
    {
      const std::lock_guard lock(feed_.mutex_);
      const auto [first, last] = feed_.watchers_.equal_range(key_);
      const auto found =
          std::find_if(first, last, [&](const auto& row) { return row.second == watcher_; });
      if (found != last) feed_.watchers_.erase(found);
      if (!feed_.watchers_.contains(key_)) feed_.tails_.erase(key_);
    }
    const std::lock_guard calling(watcher_->calling);
    watcher_->gone = true;
  }

 private:
  EventFeed& feed_;
  std::string key_;
  std::shared_ptr<Watcher> watcher_;
};

EventFeed::EventFeed(storage::Store& store, Timing timing)
    : store_(store), timing_(std::move(timing)) {
  const Result<std::int64_t> last = store_.LastPosition();
  if (last) position_ = complete_after_ = *last;
  store_watch_ = store_.Watch([this] {
    const std::lock_guard lock(mutex_);
    hinted_ = true;
    // With nobody to tell, waking up for each commit would only take time from the next one.
    if (!watchers_.empty()) wake_.notify_one();
  });
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

EventFeed::~EventFeed() {
  store_watch_.reset();
  thread_.request_stop();
  wake_.notify_all();
}

std::unique_ptr<EventFeed::Subscription> EventFeed::Subscribe(std::string resource,
                                                              std::function<void()> wake) {
  auto watcher = std::make_shared<Watcher>();
  watcher->wake = std::move(wake);
  {
    const std::lock_guard lock(mutex_);
    watchers_.emplace(resource, watcher);
    if (hinted_) wake_.notify_one();
  }
  return std::make_unique<Handle>(*this, std::move(resource), std::move(watcher));
}

Result<std::vector<storage::EventRecord>> EventFeed::EventsAfter(std::int64_t position, int limit) {
  if (auto recent = RecentAfter(position, limit)) return *std::move(recent);
  return store_.AllEvents(position, limit);
}

std::optional<std::vector<storage::EventRecord>> EventFeed::RecentAfter(std::int64_t position,
                                                                        int limit) {
  const std::lock_guard lock(mutex_);
  if (position >= position_) return std::vector<storage::EventRecord>();
  if (position < complete_after_) return std::nullopt;
  const auto first =
      std::ranges::upper_bound(recent_, position, {}, &storage::EventRecord::position);
  const auto count = std::min<std::ptrdiff_t>(limit, recent_.end() - first);
  return std::vector<storage::EventRecord>(first, first + count);
}

std::optional<std::vector<storage::EventRecord>> EventFeed::FromTail(std::int64_t job,
                                                                     std::int64_t after_sequence,
                                                                     int limit) {
  const std::lock_guard lock(mutex_);
  const auto found = tails_.find(storage::JobName(job));
  if (found == tails_.end() || found->second.empty()) return std::nullopt;
  const std::deque<storage::EventRecord>& tail = found->second;
  if (tail.front().sequence > after_sequence + 1) return std::nullopt;
  // What is newer than the tail wakes its watchers when it has been read.
  const auto first =
      std::ranges::upper_bound(tail, after_sequence, {}, &storage::EventRecord::sequence);
  return std::vector<storage::EventRecord>(
      first, first + std::min<std::ptrdiff_t>(limit, tail.end() - first));
}

void EventFeed::Publish(const std::string& resource, std::string bytes) {
  auto shared = std::make_shared<const std::string>(std::move(bytes));
  const std::lock_guard lock(mutex_);
  const bool first = arriving_.insert_or_assign(resource, std::move(shared)).second;
  if (!first) return;
  ++arrivals_;
  wake_.notify_one();  // the thread may have gone to sleep until the next poll
}

void EventFeed::Forget(const std::string& resource) {
  const std::lock_guard lock(mutex_);
  arriving_.erase(resource);
  latest_.erase(resource);
  told_at_.erase(resource);
}

std::optional<Latest> EventFeed::LatestAfter(const std::string& resource, std::uint64_t seen) {
  const std::lock_guard lock(mutex_);
  const auto found = latest_.find(resource);
  if (found == latest_.end() || found->second.version <= seen) return std::nullopt;
  return found->second;
}

std::vector<Latest> EventFeed::AllLatestAfter(std::uint64_t seen) {
  std::vector<Latest> newer;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [resource, latest] : latest_) {
      if (latest.version > seen) newer.push_back(latest);
    }
  }
  std::ranges::sort(newer, {}, &Latest::version);
  return newer;
}

std::uint64_t EventFeed::version() {
  const std::lock_guard lock(mutex_);
  return version_;
}

std::int64_t EventFeed::position() {
  const std::lock_guard lock(mutex_);
  return position_;
}

void EventFeed::Run(const std::stop_token& stop) {
  FeedRhythm rhythm(timing_.clock(), timing_.poll_interval, timing_.message_time);
  while (!stop.stop_requested()) {
    bool read = false;
    std::vector<std::string> moved;
    {
      std::unique_lock lock(mutex_);
      const std::uint64_t arrivals = arrivals_;
      const bool hinted = hinted_;
      const FeedRhythm::Instant next = std::min(rhythm.NextLook(hinted), NextLatest(rhythm));
      wake_.wait_for(lock, stop, next - timing_.clock(),
                     [&] { return (!hinted && hinted_) || arrivals != arrivals_; });
      const auto now = timing_.clock();
      read = rhythm.TakeLook(now, hinted_);
      if (read) hinted_ = false;
      moved = TakeLatest(rhythm, now);
    }
    if (stop.stop_requested()) return;
    if (read) {
      const Look look = ReadNewEvents(stop);
      rhythm.Told(timing_.clock(), look.events, look.watchers);
    }
    if (!moved.empty()) rhythm.ToldLatest(timing_.clock(), Wake(moved));
  }
}

FeedRhythm::Instant EventFeed::NextLatest(const FeedRhythm& rhythm) const {
  FeedRhythm::Instant next = FeedRhythm::Instant::max();
  for (const auto& [resource, bytes] : arriving_)
    next = std::min(next, rhythm.LatestDue(ToldAt(resource)));
  return next;
}

FeedRhythm::Instant EventFeed::ToldAt(const std::string& resource) const {
  const auto found = told_at_.find(resource);
  return found != told_at_.end() ? found->second : FeedRhythm::Instant();
}

// Watchers see what arrived only from here on: one that is woken by many events gets no more of it.
std::vector<std::string> EventFeed::TakeLatest(const FeedRhythm& rhythm, FeedRhythm::Instant now) {
  std::vector<std::string> moved;
  std::erase_if(arriving_, [&](auto& row) {
    auto& [resource, bytes] = row;
    if (rhythm.LatestDue(ToldAt(resource)) > now) return false;
    latest_[resource] = {.resource = resource, .version = ++version_, .bytes = std::move(bytes)};
    told_at_[resource] = now;
    moved.push_back(resource);
    return true;
  });
  return moved;
}

EventFeed::Look EventFeed::ReadNewEvents(const std::stop_token& stop) {
  Look look;
  while (!stop.stop_requested()) {
    Result<std::vector<storage::EventRecord>> events = store_.AllEvents(position(), kReadBatch);
    if (!events) {
      if (events.error().code == ErrorCode::kCellEventsGone && SkipGoneEvents()) continue;
      return look;  // a failing store is tried again at the next poll
    }
    if (events->empty()) return look;
    std::set<std::string> touched;
    for (const storage::EventRecord& event : *events) touched.insert(ResourceOf(event));
    const std::size_t read = events->size();
    const bool more = read == kReadBatch;
    {
      const std::lock_guard lock(mutex_);
      position_ = events->back().position;
      for (const storage::EventRecord& event : *events) {
        const std::string resource = ResourceOf(event);
        if (event.job == 0 || !watchers_.contains(resource)) continue;
        std::deque<storage::EventRecord>& tail = tails_[resource];
        tail.push_back(event);
        if (tail.size() > kTailEvents) tail.pop_front();
      }
      for (storage::EventRecord& event : *events) {
        if (event.job == 0 && event.kind == storage::kDeleted) DropEventsOf(event.resource);
        recent_.push_back(std::move(event));
      }
      while (recent_.size() > kRecentEvents) {
        complete_after_ = recent_.front().position;
        recent_.pop_front();
      }
    }
    look.events += read;
    look.watchers = std::max(look.watchers, Wake({touched.begin(), touched.end()}));
    if (!more) return look;
  }
  return look;
}

// The events of a job that was deleted are gone from the store; here they are, too.
void EventFeed::DropEventsOf(std::string_view job) {
  if (!job.starts_with("jobs/")) return;
  std::erase_if(recent_, [&](const storage::EventRecord& event) {
    return event.job != 0 && storage::JobName(event.job) == job;
  });
  tails_.erase(std::string(job));
}

// The store removed events before they were read here (it keeps so many, and more were written at
// once). Whom they would have woken is not known: everybody looks, and a watcher that misses some
// is told so.
bool EventFeed::SkipGoneEvents() {
  const Result<std::int64_t> gone = store_.EventsGoneUntil();
  std::vector<std::shared_ptr<Watcher>> all;
  {
    const std::lock_guard lock(mutex_);
    if (!gone || *gone <= position_) return false;
    position_ = *gone;
    complete_after_ = position_;
    recent_.clear();
    tails_.clear();
    for (const auto& [resource, watcher] : watchers_) all.push_back(watcher);
  }
  Call(all);
  return true;
}

std::size_t EventFeed::Wake(const std::vector<std::string>& resources) {
  std::vector<std::shared_ptr<Watcher>> woken;
  {
    const std::lock_guard lock(mutex_);
    const auto add = [&](const std::string& key) {
      const auto [first, last] = watchers_.equal_range(key);
      for (auto row = first; row != last; ++row) woken.push_back(row->second);
    };
    for (const std::string& resource : resources) add(resource);
    add(std::string(kEverything));
  }
  Call(woken);
  return woken.size();
}

void EventFeed::Call(const std::vector<std::shared_ptr<Watcher>>& woken) {
  for (const std::shared_ptr<Watcher>& watcher : woken) {
    const std::lock_guard calling(watcher->calling);
    if (!watcher->gone) watcher->wake();
  }
}

}  // namespace rmlcell::server
