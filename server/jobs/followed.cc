#include "server/jobs/followed.h"

#include <utility>

namespace rmlcell::server {

Followed::Follower::~Follower() {
  const std::lock_guard lock(followed_->mutex_);
  followed_->followers_.erase(at_);
}

std::unique_ptr<Followed::Follower> Followed::Follow(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  return std::unique_ptr<Follower>(
      new Follower(shared_from_this(), followers_.insert(followers_.end(), std::move(wake))));
}

void Followed::End(bool stored) {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  stored_ = stored;
  WakeAll();
}

void Followed::WakeAll() const {
  for (const auto& wake : followers_) wake();
}

}  // namespace rmlcell::server
