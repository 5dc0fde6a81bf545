#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "rmlcell/v1/worker.pb.h"
#include "server/worker/server_line.h"

namespace rmlcell::server {

// Keeps the lease of the job under way alive, three times in a lease: translating a large program,
// a picture of a long path or a slow store may take longer than one. One thread for all jobs, which
// looks at the clock on its own, so that a job of a millisecond wakes nobody.
class Heart {
 public:
  explicit Heart(ServerLine& line);
  ~Heart();
  Heart(const Heart&) = delete;
  Heart& operator=(const Heart&) = delete;

  void BeatFor(const v1::WorkerLease& lease);
  void Rest();  // nothing more is sent when this returns

 private:
  void Run();

  ServerLine& line_;
  std::mutex mutex_;
  std::condition_variable stop_;
  std::optional<v1::WorkRequest> beat_;  // guarded by mutex_
  bool stopping_ = false;                // guarded by mutex_
  std::thread thread_;
};

}  // namespace rmlcell::server
