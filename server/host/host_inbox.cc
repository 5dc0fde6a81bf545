#include "server/host/host_inbox.h"

#include <algorithm>
#include <utility>

namespace rmlcell::server {

using std::chrono::nanoseconds;

void HostInbox::Hear(v1::HostResponse message, nanoseconds now) {
  const std::lock_guard lock(mutex_);
  heard_at_ = now;
  if (message.has_heartbeat()) return;
  messages_.Add(std::move(message));
  wake_.notify_one();
}

void HostInbox::LineIsGone() {
  const std::lock_guard lock(mutex_);
  line_gone_ = true;
  wake_.notify_one();
}

void HostInbox::LineBegins() {
  const std::lock_guard lock(mutex_);
  line_gone_ = false;
}

void HostInbox::HaveJoined(Joined joined) {
  const std::lock_guard lock(mutex_);
  joined_.emplace(std::move(joined));
  wake_.notify_one();
}

void HostInbox::Later(std::function<void()> work) {
  const std::lock_guard lock(mutex_);
  work_.push_back(std::move(work));
  wake_.notify_one();
}

WaitingMessages::Taken HostInbox::TakeMessages() {
  const std::lock_guard lock(mutex_);
  return messages_.Take();
}

std::vector<std::function<void()>> HostInbox::TakeWork() {
  const std::lock_guard lock(mutex_);
  return std::exchange(work_, {});
}

std::optional<HostInbox::Joined> HostInbox::TakeJoined() {
  const std::lock_guard lock(mutex_);
  std::optional<Joined> joined;
  joined.swap(joined_);
  return joined;
}

bool HostInbox::line_gone() const {
  const std::lock_guard lock(mutex_);
  return line_gone_;
}

nanoseconds HostInbox::heard_at() const {
  const std::lock_guard lock(mutex_);
  return heard_at_;
}

void HostInbox::SetHeardAt(nanoseconds now) {
  const std::lock_guard lock(mutex_);
  heard_at_ = now;
}

void HostInbox::Wait(nanoseconds longest, bool hears) {
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, std::max<nanoseconds>(longest, nanoseconds(0)), [&] {
    return (hears && !messages_.empty()) || !work_.empty() || joined_ ||
           line_gone_ != line_gone_seen_;
  });
  line_gone_seen_ = line_gone_;
}

}  // namespace rmlcell::server
