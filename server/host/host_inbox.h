#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "server/host/host_line.h"
#include "server/host/waiting_messages.h"

namespace rmlcell::server {

// What comes to the thread of a machine from others: messages of its server, what became of a line,
// work that is to be done there. Thread-safe.
class HostInbox {
 public:
  using Joined = Result<HostLine::Welcome>;

  // For a line: what it hears, and that it is gone. `now`: by a steady clock.
  void Hear(v1::HostResponse message, std::chrono::nanoseconds now);
  void LineIsGone();
  void LineBegins();  // a new one is looked for
  void HaveJoined(Joined joined);
  void Later(std::function<void()> work);

  // All that came since the last call.
  WaitingMessages::Taken TakeMessages();
  std::vector<std::function<void()>> TakeWork();
  std::optional<Joined> TakeJoined();
  bool line_gone() const;
  std::chrono::nanoseconds heard_at() const;
  void SetHeardAt(std::chrono::nanoseconds now);

  // Until something comes, at most so long. `hears`: messages count.
  void Wait(std::chrono::nanoseconds longest, bool hears);

 private:
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  WaitingMessages messages_;
  std::vector<std::function<void()>> work_;
  std::optional<Joined> joined_;
  bool line_gone_ = false;
  bool line_gone_seen_ = false;
  std::chrono::nanoseconds heard_at_{0};
};

}  // namespace rmlcell::server
