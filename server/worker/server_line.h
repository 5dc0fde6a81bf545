#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "engine/core/result.h"
#include "rmlcell/v1/worker.pb.h"

namespace rmlcell::server {

// The worker's side of the line. One thread reads; the thread of the job writes.
class ServerLine {
 public:
  struct Options {
    std::string server;
    std::string join_token;
    std::string name;
    std::string pool{};
  };
  // Connects and joins. Errors: CellUnavailable, CellJoinRefused, CellVersionMismatch.
  static Result<std::unique_ptr<ServerLine>> Join(const Options& options);
  ~ServerLine();

  std::int64_t lease_ms() const { return lease_ms_; }
  std::int64_t events_window() const { return events_window_; }

  // The next message of the server, in order; nothing when the line is gone, or after `patience`.
  std::optional<v1::WorkResponse> Receive(std::chrono::milliseconds patience);
  // A message that is there already.
  std::optional<v1::WorkResponse> TryReceive() { return Receive(std::chrono::milliseconds(0)); }
  bool gone() const;

  // False: the line is gone.
  bool Send(const v1::WorkRequest& message);

  // No more to say; ends the line.
  void Close();

 private:
  struct Stream;
  ServerLine();
  std::unique_ptr<Stream> stream_;
  std::int64_t lease_ms_ = 0;
  std::int64_t events_window_ = 1;
  std::mutex sending_;  // a job and its heartbeat
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<v1::WorkResponse> inbox_;
  std::size_t inbox_bytes_ = 0;  // of the parts of programs in it
  bool gone_ = false;
  std::thread reader_;
};

}  // namespace rmlcell::server
