#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "storage/store.h"

namespace rmlcell::server {

class Hosts;

// What is left of a RUN besides its outcome: the recording, which its host has, and the products
// that a process makes of it by playing it again, beside everything else. Found by what a job has:
// a server that was away makes them later. LIVE-3.41. Thread-safe.
class RunProducts {
 public:
  struct Needs {
    storage::Store& store;
    Hosts& hosts;
    std::string program{};  // rmlcell-worker
    std::string folder{};  // where recordings lie while they are played; made where it is not there
    std::string log_level{};
    std::string log_format{};
    std::chrono::seconds patience{600};  // with one of them
    // A machine of whose runs not all was made.
    std::chrono::milliseconds looked_at_again_after = std::chrono::seconds(5);
  };
  explicit RunProducts(Needs needs);
  ~RunProducts();  // what is under way is made later
  RunProducts(const RunProducts&) = delete;
  RunProducts& operator=(const RunProducts&) = delete;

  // A run of this machine may be over, or its host be heard again. Returns at once.
  void Look(const std::string& machine);

 private:
  void Work(const std::stop_token& stop);
  std::string Next(const std::stop_token& stop);
  // False: not now; once more in a while.
  bool LookAt(const std::string& machine, const std::stop_token& stop);
  Status Make(const storage::JobRecord& job, const std::stop_token& stop);
  Result<std::string> RecordingOf(const storage::JobRecord& job);
  Status Play(const std::string& recording, const std::string& folder, const std::stop_token& stop);
  Status Store(const storage::JobRecord& job, const std::string& folder);

  const Needs needs_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  // Guarded by mutex_: machines that are to be looked at, and when.
  std::map<std::string, std::chrono::steady_clock::time_point> due_;
  std::set<std::int64_t>
      given_up_;  // of the thread alone: jobs that have no recording, or a bad one
  std::jthread thread_;
};

}  // namespace rmlcell::server
