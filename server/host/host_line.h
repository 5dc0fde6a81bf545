#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "engine/core/result.h"
#include "rmlcell/v1/host.pb.h"

namespace rmlcell::server {

// When a line says something though nothing happens, and how long it waits for its server at the
// end. An empty message from time to time, which the server answers: each side knows that the other
// one is there. Of a machine that stands and has no run open it is the status, which is told every
// second: nothing is to be held there when a server is lost, and waking four times a second is most
// of what its host costs. LIVE-3.06, LIVE-3.12
struct LineTimes {
  std::chrono::nanoseconds heartbeat{std::chrono::milliseconds(250)};
  std::chrono::nanoseconds heartbeat_at_rest{std::chrono::milliseconds(1'200)};
  std::chrono::nanoseconds last_words{std::chrono::seconds(2)};
};

// The line of a host to its server. What is sent waits here until the line takes it, in order; of
// statuses that follow each other the newest alone. Thread-safe.
class HostLine {
 public:
  struct Welcome {
    v1::HostWelcome message{};
    std::unique_ptr<HostLine> line;
  };
  // `heard` is called for each message, on a thread of this; `gone` once, when the line is. Errors:
  // CellUnavailable, CellJoinRefused, CellMachineTaken, CellUnknownMachine.
  static Result<Welcome> Join(const std::string& server, const v1::HostHello& hello,
                              std::function<void(v1::HostResponse)> heard,
                              std::function<void()> gone, const LineTimes& times = {});
  ~HostLine();
  HostLine(const HostLine&) = delete;
  HostLine& operator=(const HostLine&) = delete;

  void Send(v1::HostRequest message);
  void SendStatus(v1::MachineStatus status);
  // A server that is not heard any more: what was not sent is dropped, and the end waits for
  // nothing.
  void Cut();

 private:
  struct Stream;

  explicit HostLine(const LineTimes& times);
  void Read();
  void Write();

  const LineTimes times_;
  std::unique_ptr<Stream> stream_;
  std::function<void(v1::HostResponse)> heard_;
  std::function<void()> gone_;
  std::mutex mutex_;
  std::condition_variable to_send_;
  std::deque<v1::HostRequest> queue_;  // guarded by mutex_
  bool read_all_ = false;              // guarded by mutex_
  bool ending_ = false;                // guarded by mutex_
  bool written_all_ = false;           // guarded by mutex_; nothing more is sent
  bool cut_ = false;                   // guarded by mutex_
  std::atomic<bool> answers_ = false;  // the newest status at rest was answered
  std::thread reader_;
  std::thread writer_;
};

}  // namespace rmlcell::server
