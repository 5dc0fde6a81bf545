#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <string>

#include "server/base/steady_clock.h"
#include "storage/store.h"
#include "tests/storage/sqlite_bed.h"

// What the tests of several rooms of the server need.
namespace rmlcell::server {

using storage::CodeOf;
using storage::Eventually;
using storage::kPatience;
using storage::Must;

// A clock for intervals that stands still until it is moved, and counts who looks at it.
// Thread-safe.
class TestSteadyClock {
 public:
  SteadyClock clock() {
    return [this] {
      ++looks_;
      return std::chrono::steady_clock::time_point(std::chrono::hours(1) +
                                                   std::chrono::milliseconds(passed_ms_));
    };
  }
  void Advance(std::chrono::milliseconds by) { passed_ms_ += by.count(); }

  // Waits until the clock was looked at and the work that followed is done, by a thread that looks
  // at it again and again.
  bool GoneRound() {
    const int before = looks_;
    return Eventually([&] { return looks_ > before + 2; });
  }

 private:
  std::atomic<std::int64_t> passed_ms_ = 0;
  std::atomic<int> looks_ = 0;
};

// An embedded store with the machines optimo-1 and mill-1. Its clock stands still until it is
// moved.
class ServerBed {
 public:
  explicit ServerBed(storage::SqliteOptions options = {});
  storage::Store& store() { return bed_.store(); }
  storage::TestClock& clock() { return bed_.clock(); }

  // A queued job with a program of its own, as JobBook makes it: number of the job.
  std::int64_t SubmitCheck(const std::string& source = "STOP\n", int attempts_max = 2);

  // Takes the oldest queued job of kind `kind`. There must be one.
  storage::Lease Lease(const std::string& kind = "CHECK");

  // `count` events for the holder of a lease, in one transaction.
  void Append(const storage::Lease& lease, int count, const std::string& payload = "p");

 private:
  storage::SqliteBed bed_;
};

}  // namespace rmlcell::server
