#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "storage/store.h"

namespace rmlcell::storage::sqlite {

// Tells those who watch that something was committed, from a thread of its own and under no lock.
// Hints that come while one is being told are told together. The contract is that of Store::Watch.
class Watchers {
 public:
  Watchers();
  ~Watchers();  // waits for a call that is under way; subscriptions may live on

  std::unique_ptr<Store::Subscription> Add(std::function<void()> changed);
  void Notify();  // quick, never waits for a watcher

 private:
  struct Watcher {
    std::function<void()> changed;
    bool ended = false;
    bool being_called = false;
  };
  // What subscriptions need of it, so that they may outlive it.
  struct Shared {
    std::mutex mutex;
    std::condition_variable returned;  // from a watcher
    std::vector<std::shared_ptr<Watcher>> watchers;
    std::thread::id caller;
  };
  class Handle;

  void Loop();
  static void Call(Shared& shared, Watcher& watcher);

  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  std::condition_variable wake_;
  bool due_ = false;       // guarded by shared_->mutex
  bool stopping_ = false;  // guarded by shared_->mutex
  std::thread thread_;     // last: it uses all of the above
};

}  // namespace rmlcell::storage::sqlite
