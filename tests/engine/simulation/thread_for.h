#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "engine/simulation/material/parallel_for.h"

namespace rmlcell::simulation {

// New threads for each call, as many as are asked for.
class ThreadFor final : public ParallelFor {
 public:
  explicit ThreadFor(std::size_t width) : width_(width) {}
  std::size_t width() const override { return width_; }
  void Run(std::size_t count, const std::function<void(std::size_t)>& piece) override {
    most_ = std::max(most_, count);
    std::atomic<std::size_t> next = 0;
    std::vector<std::jthread> threads;
    for (std::size_t k = 0; k < width_; ++k) {
      threads.emplace_back([&] {
        for (std::size_t mine = next++; mine < count; mine = next++) piece(mine);
      });
    }
  }
  std::size_t most() const { return most_; }  // pieces of a call

 private:
  std::size_t width_;
  std::size_t most_ = 0;
};

}  // namespace rmlcell::simulation
