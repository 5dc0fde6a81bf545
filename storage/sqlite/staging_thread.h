#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

namespace rmlcell::storage::sqlite {

// Where contents are staged that are too large for it to be done while a caller waits who must not.
// One at a time, in order. What waits at the end is still done.
class StagingThread {
 public:
  StagingThread() : thread_([this](const std::stop_token& stop) { Run(stop); }) {}

  // What `work` throws is dropped.
  void Post(std::function<void()> work) {
    {
      const std::lock_guard lock(mutex_);
      waiting_.push_back(std::move(work));
    }
    changed_.notify_one();
  }

 private:
  void Run(const std::stop_token& stop) {
    for (;;) {
      std::function<void()> work;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, stop, [this] { return !waiting_.empty(); });
        if (waiting_.empty()) return;
        work = std::move(waiting_.front());
        waiting_.pop_front();
      }
      try {
        work();
      } catch (...) {
        // What it was for goes unanswered, and is lost with its lease; the store goes on.
      }
    }
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::function<void()>> waiting_;  // guarded by mutex_
  std::jthread thread_;
};

}  // namespace rmlcell::storage::sqlite
