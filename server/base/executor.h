#pragma once

#include <functional>
#include <memory>

namespace rmlcell::server {

// Threads for work that may block: the store, compilation. The threads of gRPC never block.
class Executor {
 public:
  explicit Executor(int threads);
  ~Executor();  // runs what was posted, then ends
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  // An exception that leaves `work` is a mistake of ours: it is logged and dropped with that work.
  void Post(std::function<void()> work);

 private:
  struct Pool;
  std::unique_ptr<Pool> pool_;
};

}  // namespace rmlcell::server
