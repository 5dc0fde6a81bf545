#include "proto/bridge/thread_pool.h"

#include <algorithm>
#include <utility>

namespace rmlcell::bridge {

ThreadPool::~ThreadPool() {
  for (std::jthread& thread : threads_) thread.request_stop();
}

void ThreadPool::Run(std::size_t count, const std::function<void(std::size_t)>& piece) {
  if (width_ < 2 || count < 2) {
    for (std::size_t k = 0; k < count; ++k) piece(k);
    return;
  }
  while (threads_.size() + 1 < std::min(width_, count))
    threads_.emplace_back([this](std::stop_token stop) { Work(std::move(stop)); });
  std::unique_lock lock(mutex_);
  piece_ = &piece;
  next_ = 0;
  count_ = not_ended_ = count;
  begun_.notify_all();
  TakePieces(lock);
  ended_.wait(lock, [this] { return not_ended_ == 0; });
  piece_ = nullptr;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ThreadPool::Work(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  while (begun_.wait(lock, stop, [this] { return next_ < count_; })) TakePieces(lock);
}

void ThreadPool::TakePieces(std::unique_lock<std::mutex>& lock) {
  while (next_ < count_) {
    const std::size_t mine = next_++;
    const std::function<void(std::size_t)>& piece = *piece_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      piece(mine);
    } catch (...) {  // told to the caller of Run
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && !failure_) failure_ = failure;
    if (--not_ended_ == 0) ended_.notify_one();
  }
}

std::size_t ThreadsForMaterial() {
  return std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 2);
}

}  // namespace rmlcell::bridge
