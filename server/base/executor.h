#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>

namespace rmlcell::server {

// One lane of threads for work that may block, the store on one, compilation on another. The
// threads of gRPC never block.
class Executor {
 public:
  explicit Executor(int threads, std::size_t waiting_max = std::numeric_limits<std::size_t>::max());
  ~Executor();  // runs what was posted, then ends
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  // An exception that leaves `work` is a mistake of ours: it is logged and dropped with that work.
  void Post(std::function<void()> work);
  // The same; false, and nothing is done, while `waiting_max` of what was posted have not begun.
  [[nodiscard]] bool TryPost(std::function<void()> work);

 private:
  struct Pool;
  std::unique_ptr<Pool> pool_;
};

}  // namespace rmlcell::server
