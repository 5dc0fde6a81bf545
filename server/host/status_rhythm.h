#pragma once

#include <algorithm>
#include <chrono>

namespace rmlcell::server {

// When a host tells where its machine is. A server tells watchers one in 50 ms: what comes sooner
// behind another waits there, and each one behind it would be as late. So the turns begin anew
// behind the moment at which one that was told out of its turn is shown. LIVE-3.16, LIVE-10.21
class StatusRhythm {
 public:
  static constexpr std::chrono::milliseconds kBetweenShown{50};

  bool IsDue(std::chrono::nanoseconds now) const { return now >= due_; }
  std::chrono::nanoseconds due() const { return due_; }
  void TellAt(std::chrono::nanoseconds time) { due_ = time; }
  // Told now; the next ones so far apart.
  void Told(std::chrono::nanoseconds now, std::chrono::nanoseconds apart) {
    const bool in_turn = now >= due_ && now - due_ < apart;
    // One that waits there gives way to a newer one.
    if (shown_ <= now) shown_ = std::max(now, shown_ + kBetweenShown);
    due_ = in_turn ? std::max(due_ + apart, shown_ + kBetweenShown) : shown_ + apart;
  }

 private:
  std::chrono::nanoseconds due_{0};
  std::chrono::nanoseconds shown_{0};  // by a server, the newest
};

}  // namespace rmlcell::server
