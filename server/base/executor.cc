#include "server/base/executor.h"

#include <spdlog/spdlog.h>

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>

namespace rmlcell::server {

struct Executor::Pool {
  explicit Pool(int threads) : threads_of_pool(static_cast<std::size_t>(threads)) {}
  boost::asio::thread_pool threads_of_pool;
};

Executor::Executor(int threads) : pool_(std::make_unique<Pool>(threads)) {}

Executor::~Executor() { pool_->threads_of_pool.join(); }

void Executor::Post(std::function<void()> work) {
  boost::asio::post(pool_->threads_of_pool, [work = std::move(work)] {
    try {
      work();
    } catch (const std::exception& error) {
      spdlog::error("an exception left its folder: {}", error.what());
    }
  });
}

}  // namespace rmlcell::server
