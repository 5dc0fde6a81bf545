#include "server/base/executor.h"

#include <spdlog/spdlog.h>

#include <atomic>
#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>

namespace rmlcell::server {

struct Executor::Pool {
  Pool(int threads, std::size_t max)
      : waiting_max(max), threads_of_pool(static_cast<std::size_t>(threads)) {}

  void Add(std::function<void()> work) {
    boost::asio::post(threads_of_pool, [this, work = std::move(work)] {
      --waiting;
      try {
        work();
      } catch (const std::exception& error) {
        spdlog::error("an exception left its folder: {}", error.what());
      }
    });
  }

  const std::size_t waiting_max;
  std::atomic<std::size_t> waiting = 0;
  boost::asio::thread_pool threads_of_pool;  // last: it ends first
};

Executor::Executor(int threads, std::size_t waiting_max)
    : pool_(std::make_unique<Pool>(threads, waiting_max)) {}

Executor::~Executor() { pool_->threads_of_pool.join(); }

void Executor::Post(std::function<void()> work) {
  ++pool_->waiting;
  pool_->Add(std::move(work));
}

bool Executor::TryPost(std::function<void()> work) {
  if (++pool_->waiting > pool_->waiting_max) {
    --pool_->waiting;
    return false;
  }
  pool_->Add(std::move(work));
  return true;
}

}  // namespace rmlcell::server
