#include "storage/sqlite/watchers.h"

#include <algorithm>
#include <utility>

namespace rmlcell::storage::sqlite {

class Watchers::Handle final : public Store::Subscription {
 public:
  Handle(std::shared_ptr<Shared> shared, std::shared_ptr<Watcher> watcher)
      : shared_(std::move(shared)), watcher_(std::move(watcher)) {}

  ~Handle() override {
    std::unique_lock lock(shared_->mutex);
    watcher_->ended = true;
    std::erase(shared_->watchers, watcher_);
    // From inside the call itself there is nobody to wait for.
    if (std::this_thread::get_id() == shared_->caller) return;
    shared_->returned.wait(lock, [this] { return !watcher_->being_called; });
    // What the function holds goes now, not when the caller's thread comes by.
    const std::function<void()> gone = std::exchange(watcher_->changed, nullptr);
    lock.unlock();
  }

 private:
  std::shared_ptr<Shared> shared_;
  std::shared_ptr<Watcher> watcher_;
};

Watchers::Watchers() : thread_([this] { Loop(); }) {}

Watchers::~Watchers() {
  {
    const std::lock_guard lock(shared_->mutex);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

std::unique_ptr<Store::Subscription> Watchers::Add(std::function<void()> changed) {
  auto watcher = std::make_shared<Watcher>();
  watcher->changed = std::move(changed);
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->watchers.push_back(watcher);
  }
  return std::make_unique<Handle>(shared_, std::move(watcher));
}

void Watchers::Notify() {
  {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->watchers.empty() || std::exchange(due_, true)) return;
  }
  wake_.notify_one();
}

void Watchers::Loop() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->caller = std::this_thread::get_id();
  }
  for (;;) {
    std::vector<std::shared_ptr<Watcher>> watchers;
    {
      std::unique_lock lock(shared_->mutex);
      wake_.wait(lock, [this] { return due_ || stopping_; });
      if (stopping_) return;
      due_ = false;
      watchers = shared_->watchers;
    }
    for (const std::shared_ptr<Watcher>& watcher : watchers) Call(*shared_, *watcher);
  }
}

void Watchers::Call(Shared& shared, Watcher& watcher) {
  {
    const std::lock_guard lock(shared.mutex);
    if (watcher.ended) return;
    watcher.being_called = true;
  }
  watcher.changed();
  {
    const std::lock_guard lock(shared.mutex);
    watcher.being_called = false;
  }
  shared.returned.notify_all();
}

}  // namespace rmlcell::storage::sqlite
