#pragma once

#include <algorithm>
#include <chrono>

namespace rmlcell::server {

// When a host tells where its machine is. One that is told out of its turn, because something
// changed, puts off none of those that follow: a server tells watchers one in 50 ms, and all that
// came less than that behind another would be late. LIVE-3.16
class StatusRhythm {
 public:
  bool IsDue(std::chrono::nanoseconds now) const { return now >= due_; }
  std::chrono::nanoseconds due() const { return due_; }
  void TellAt(std::chrono::nanoseconds time) { due_ = time; }
  // Told now; the next ones so far apart.
  void Told(std::chrono::nanoseconds now, std::chrono::nanoseconds apart) {
    if (now - due_ >= apart) due_ = now;
    if (now >= due_) due_ += apart;
    due_ = std::min(due_, now + apart);
  }

 private:
  std::chrono::nanoseconds due_{0};
};

}  // namespace rmlcell::server
