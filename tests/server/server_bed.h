#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "storage/store.h"
#include "tests/storage/sqlite_bed.h"

// What the tests of several rooms of the server need.
namespace rmlcell::server {

using storage::CodeOf;
using storage::Must;

// How long a test waits for something that must come; only a failing test waits that long.
inline constexpr std::chrono::seconds kPatience{20};

// True as soon as `holds` does, false when it does not within kPatience.
template <class Condition>
bool Eventually(Condition holds) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

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
