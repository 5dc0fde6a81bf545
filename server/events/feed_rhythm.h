#pragma once

#include <algorithm>
#include <chrono>

namespace rmlcell::server {

// When the feed looks at the log without a hint, and when it tells the next positions.
class FeedRhythm {
 public:
  using Instant = std::chrono::steady_clock::time_point;

  // Watchers are told of positions no more often than this.
  static constexpr std::chrono::milliseconds kLatestInterval{50};

  // At `begin` both are due.
  FeedRhythm(Instant begin, std::chrono::milliseconds poll_interval)
      : poll_interval_(poll_interval), next_poll_(begin), next_latest_(begin) {}

  // The next moment at which something is due.
  Instant Next(bool positions_wait) const {
    return positions_wait ? std::min(next_poll_, next_latest_) : next_poll_;
  }

  // Whether to look at the log now; a look puts off the next one.
  bool TakeLook(Instant now, bool hinted) {
    if (!hinted && now < next_poll_) return false;
    next_poll_ = now + poll_interval_;
    return true;
  }

  // Whether positions that wait are told now; that puts off the next ones.
  bool TakeLatest(Instant now) {
    if (now < next_latest_) return false;
    next_latest_ = now + kLatestInterval;
    return true;
  }

 private:
  std::chrono::milliseconds poll_interval_;
  Instant next_poll_;
  Instant next_latest_;
};

}  // namespace rmlcell::server
