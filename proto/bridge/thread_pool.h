#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "engine/simulation/material/parallel_for.h"

namespace rmlcell::bridge {

// Lends the engine threads. Whoever calls works with them; they are started when there is something
// to do for them, and wait then.
class ThreadPool final : public simulation::ParallelFor {
 public:
  // `width`: threads that work at the same time, the caller's included; at least 1.
  explicit ThreadPool(std::size_t width) : width_(width) {}
  ~ThreadPool() override;
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  std::size_t width() const override { return width_; }
  void Run(std::size_t count, const std::function<void(std::size_t)>& piece) override;

 private:
  void Work(std::stop_token stop);
  void TakePieces(std::unique_lock<std::mutex>& lock);

  std::size_t width_;
  std::mutex mutex_;
  std::condition_variable_any begun_;
  std::condition_variable ended_;
  // What is under way; guarded by mutex_.
  const std::function<void(std::size_t)>* piece_ = nullptr;
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  std::size_t not_ended_ = 0;
  std::exception_ptr failure_;
  std::vector<std::jthread> threads_;
};

// As many as the process may use processors, and no more than gain something: 2.
std::size_t ThreadsForMaterial();

}  // namespace rmlcell::bridge
