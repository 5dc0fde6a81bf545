#pragma once

#include <algorithm>
#include <chrono>

namespace rmlcell::server {

// When a host tells where its machine is. Behind one that is told out of its turn, because
// something changed, the turns begin anew: a server tells watchers one in 50 ms, and what came less
// than that behind another would be as late when it is told, and all that follow it. LIVE-3.16,
// LIVE-10.21
class StatusRhythm {
 public:
  bool IsDue(std::chrono::nanoseconds now) const { return now >= due_; }
  std::chrono::nanoseconds due() const { return due_; }
  void TellAt(std::chrono::nanoseconds time) { due_ = time; }
  // Told now; the next ones so far apart.
  void Told(std::chrono::nanoseconds now, std::chrono::nanoseconds apart) {
    const bool in_turn = now >= due_ && now - due_ < apart;
    due_ = in_turn ? std::min(due_ + apart, now + apart) : now + apart;
  }

 private:
  std::chrono::nanoseconds due_{0};
};

}  // namespace rmlcell::server
