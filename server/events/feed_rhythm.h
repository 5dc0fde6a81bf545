#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace rmlcell::server {

// When the feed looks at the log, and when it tells the next positions. What wakes watchers costs
// as many messages: under load the next time waits a little, so that more goes in each.
class FeedRhythm {
 public:
  using Instant = std::chrono::steady_clock::time_point;

  // Watchers are told of one position no more often than this, and of all of them no more often
  // than kLatestWaitMin, or what the messages of the last time cost.
  static constexpr std::chrono::milliseconds kLatestInterval{50};
  static constexpr std::chrono::milliseconds kLatestWaitMin{5};
  // What a message to a watcher costs, about; how many events a look should bring for each that it
  // waits again; and how old an event may get by that.
  static constexpr std::chrono::microseconds kMessageTime{50};
  static constexpr std::int64_t kEventsOfALook = 8;
  static constexpr std::chrono::milliseconds kWaitMax{20};

  // At `begin` both are due.
  FeedRhythm(Instant begin, std::chrono::milliseconds poll_interval,
             std::chrono::microseconds message_time = kMessageTime)
      : poll_interval_(poll_interval),
        message_time_(message_time),
        next_poll_(begin),
        next_hinted_(begin),
        next_latest_(begin) {}

  // The next moment at which the log is to be looked at.
  Instant NextLook(bool hinted) const {
    return hinted ? std::min(next_hinted_, next_poll_) : next_poll_;
  }

  // Whether to look at the log now; a look puts off the next one.
  bool TakeLook(Instant now, bool hinted) {
    if (now < next_poll_ && !(hinted && now >= next_hinted_)) return false;
    next_poll_ = now + poll_interval_;
    return true;
  }

  // A look brought so many events for so many watchers.
  void Told(Instant now, std::size_t events, std::size_t watchers) {
    const auto looks = 1 + static_cast<std::int64_t>(events) / kEventsOfALook;
    const auto wait = message_time_ * static_cast<std::int64_t>(watchers) * looks;
    next_hinted_ = now + std::min<std::chrono::microseconds>(wait, kWaitMax);
  }

  // When a position that was told then is told again, if it waits.
  Instant LatestDue(Instant told) const { return std::max(next_latest_, told + kLatestInterval); }

  // Positions were told to so many watchers.
  void ToldLatest(Instant now, std::size_t watchers) {
    const std::chrono::microseconds cost = message_time_ * static_cast<std::int64_t>(watchers);
    next_latest_ =
        now + std::clamp<std::chrono::microseconds>(cost, kLatestWaitMin, kLatestInterval);
  }

 private:
  std::chrono::milliseconds poll_interval_;
  std::chrono::microseconds message_time_;
  Instant next_poll_;
  Instant next_hinted_;
  Instant next_latest_;
};

}  // namespace rmlcell::server
