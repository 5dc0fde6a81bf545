#pragma once

#include <cstddef>
#include <functional>

namespace rmlcell::simulation {

// Does pieces of work, perhaps several at the same time. The engine starts no thread: whoever calls
// it may lend it some by this. Pieces need nothing of each other, and what comes of them depends
// neither on their order nor on how many are under way.
class ParallelFor {
 public:
  virtual ~ParallelFor() = default;

  // How many pieces are under way at the same time, at most; at least 1.
  virtual std::size_t width() const = 0;

  // Calls `piece` with each number below `count` and returns when all have returned. What one of
  // them throws is thrown here when those under way have returned; the others may be left out. From
  // one thread at a time, and not from a piece.
  virtual void Run(std::size_t count, const std::function<void(std::size_t)>& piece) = 0;
};

// One after the other, by whoever calls.
class SerialFor final : public ParallelFor {
 public:
  std::size_t width() const override { return 1; }
  void Run(std::size_t count, const std::function<void(std::size_t)>& piece) override {
    for (std::size_t k = 0; k < count; ++k) piece(k);
  }
};

}  // namespace rmlcell::simulation
