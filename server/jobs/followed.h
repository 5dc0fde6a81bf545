#pragma once

#include <functional>
#include <list>
#include <memory>
#include <mutex>

namespace rmlcell::server {

// What the worker of a job makes while the job runs, for all who follow it. Thread-safe.
class Followed : public std::enable_shared_from_this<Followed> {
 public:
  virtual ~Followed() = default;

  class Follower {
   public:
    ~Follower();
    Follower(const Follower&) = delete;
    Follower& operator=(const Follower&) = delete;

   private:
    friend Followed;
    Follower(std::shared_ptr<Followed> followed, std::list<std::function<void()>>::iterator at)
        : followed_(std::move(followed)), at_(at) {}
    std::shared_ptr<Followed> followed_;
    std::list<std::function<void()>>::iterator at_;
  };

  // `wake` is called when there is more, or it is over; it must not block, and not call this.
  std::unique_ptr<Follower> Follow(std::function<void()> wake);

  // By the dispatcher: no more comes; `stored`: and what the job made is in the store.
  void End(bool stored);

 protected:
  // Precondition of these: mutex_ is held.
  void WakeAll() const;
  bool ended() const { return ended_; }
  bool stored() const { return stored_; }

  mutable std::mutex mutex_;

 private:
  bool ended_ = false;
  bool stored_ = false;
  std::list<std::function<void()>> followers_;
};

}  // namespace rmlcell::server
