#include "proto/bridge/thread_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <latch>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace rmlcell::bridge {
namespace {

TEST(ThreadPool, DoesEachPieceOnce) {
  for (const std::size_t width : {1u, 2u, 5u}) {
    ThreadPool pool(width);
    EXPECT_EQ(pool.width(), width);
    for (const std::size_t count : {0u, 1u, 2u, 3u, 100u}) {
      std::vector<int> done(count);  // each piece has its own
      pool.Run(count, [&](std::size_t k) { ++done.at(k); });
      EXPECT_EQ(done, std::vector<int>(count, 1)) << width << " threads";
    }
  }
}

// Two pieces that wait for each other end only when both are under way.
TEST(ThreadPool, HasPiecesUnderWayTogether) {
  ThreadPool pool(2);
  for (int round = 0; round < 100; ++round) {
    std::latch both(2);
    pool.Run(2, [&](std::size_t) { both.arrive_and_wait(); });
  }
}

// Whoever called may take away what the pieces work on.
TEST(ThreadPool, ReturnsWhenTheLastPieceHasEnded) {
  ThreadPool pool(2);
  std::latch both(2);
  std::atomic<bool> ended = false;
  const std::thread::id caller = std::this_thread::get_id();
  pool.Run(2, [&](std::size_t) {
    both.arrive_and_wait();
    if (std::this_thread::get_id() == caller) return;
    for (int i = 0; i < 10'000; ++i) std::this_thread::yield();
    ended = true;
  });
  EXPECT_TRUE(ended);
}

TEST(ThreadPool, OfOneWorksInTheThreadThatCalls) {
  ThreadPool pool(1);
  std::set<std::thread::id> threads;
  pool.Run(10, [&](std::size_t) { threads.insert(std::this_thread::get_id()); });
  EXPECT_EQ(threads, std::set<std::thread::id>{std::this_thread::get_id()});
}

// No more than it has, and no more than there are pieces.
TEST(ThreadPool, HasNoMoreThreadsThanItsWidth) {
  for (const auto& [width, count] : {std::pair(2U, 300U), {5U, 3U}}) {
    ThreadPool pool(width);
    std::mutex mutex;
    std::set<std::thread::id> threads;
    for (int round = 0; round < 50; ++round) {
      pool.Run(count, [&](std::size_t) {
        const std::lock_guard lock(mutex);
        threads.insert(std::this_thread::get_id());
        std::this_thread::yield();
      });
    }
    EXPECT_LE(threads.size(), std::min(width, count));
  }
}

// After all others have ended, and the pool goes on.
TEST(ThreadPool, TellsWhatAPieceThrew) {
  ThreadPool pool(2);
  std::atomic<int> done = 0;
  const auto third_throws = [&](std::size_t k) {
    if (k == 2) throw std::runtime_error("the third");
    ++done;
  };
  EXPECT_THROW(pool.Run(8, third_throws), std::runtime_error);
  EXPECT_EQ(done, 7);
  pool.Run(8, [&](std::size_t) { ++done; });
  EXPECT_EQ(done, 15);
}

// The third piece begins when the first has thrown: the second waits for it.
TEST(ThreadPool, TellsTheFirstOfTwoThatThrew) {
  ThreadPool pool(2);
  std::latch third_has_begun(1);
  std::string told;
  try {
    pool.Run(3, [&](std::size_t k) {
      if (k == 0) throw std::runtime_error("the first");
      if (k == 1) return third_has_begun.wait();
      third_has_begun.count_down();
      throw std::runtime_error("the third");
    });
  } catch (const std::runtime_error& error) {
    told = error.what();
  }
  EXPECT_EQ(told, "the first");
}

TEST(ThreadPool, OfMaterialHasTwoThreadsAtMost) {
  EXPECT_GE(ThreadsForMaterial(), 1u);
  EXPECT_LE(ThreadsForMaterial(), 2u);
}

}  // namespace
}  // namespace rmlcell::bridge
