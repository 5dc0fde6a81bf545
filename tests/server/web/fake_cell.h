#pragma once

#include <grpcpp/server.h>

#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/web/web_server.h"

// A small gRPC server with made-up jobs behind a real web port. What a call does follows from the
// name of the job that it asks for, so tests in any language can drive it:
//
//   GetJob "jobs/1" a job; "jobs/meta" the caller's metadata in `title`; "jobs/slow" waits until it
//   is cancelled; "jobs/big" a megabyte of title; "jobs/huge" six megabytes; others NOT_FOUND with
//   details. WatchJob "jobs/1" events after `after_sequence` to 5, then the end; "jobs/fail" two
//   events, then an error with details; "jobs/idle" a snapshot, then nothing; "jobs/flood" long
//   events without an end; "jobs/stop" a snapshot, then waits for StopStreams, which ends it with
//   UNAVAILABLE.
namespace rmlcell::web::testing {

inline constexpr std::string_view kGetJob = "/rmlcell.v1.JobService/GetJob";
inline constexpr std::string_view kWatchJob = "/rmlcell.v1.JobService/WatchJob";
inline constexpr std::string_view kSecret = "only-the-gateway-knows";

// The text of one message of jobs/flood. More than a window of gRPC, so that the producer waits
// with each message until the gateway asks for it.
inline constexpr int kFloodBytes = 100'000;
inline constexpr int kGrpcWindowBytes = 65'535;
static_assert(kFloodBytes > kGrpcWindowBytes);

// What the fakes count.
struct Counters {
  std::atomic<int> calls{0};
  std::atomic<int> submitted{0};
  std::atomic<int> open{0};       // calls and streams under way
  std::atomic<int> cancelled{0};  // of these, ended by their client
  std::atomic<int> produced{0};   // messages of jobs/flood
};

// Programs and artifacts in memory.
class FakeResources : public ResourceSource {
 public:
  Result<Resource> Find(const ResourcePath& path, const WebCallerMetadata& caller) override;
  Result<std::unique_ptr<UploadSink>> BeginUpload(const UploadHeader& header,
                                                  const WebCallerMetadata& caller) override;

  std::mutex mutex;
  std::map<std::string, std::string> uploads;  // finished ones, by "machine/slot"
  std::vector<UploadHeader> headers;
  WebCallerMetadata last_caller;
  std::atomic<int> open_sinks{0};
  std::atomic<int> appended{0};
  std::atomic<std::size_t> largest_piece{0};  // bytes that were asked for at once
};

// Tests of a time limit set that one; the others do not come into their way on a slow machine.
inline WebOptions AnyPort() {
  WebOptions options;
  options.port = 0;
  options.linger_timeout = std::chrono::minutes(1);
  options.health_timeout = std::chrono::minutes(1);
  return options;
}

class FakeCell {
 public:
  // Port 0 of `options` finds a free one.
  explicit FakeCell(WebOptions options = AnyPort());
  ~FakeCell();

  int port() const { return web_->port(); }
  WebServer& web() { return *web_; }
  Counters& counters() { return counters_; }
  FakeResources& resources() { return resources_; }

  // Ends every "jobs/stop" and every WatchCell stream as a stopping server does.
  void StopStreams();
  void SetServing(bool serving);
  std::vector<WebLogEntry> log() const;

  // True when the condition holds within a minute; only a failing test waits that long.
  template <class Condition>
  static bool Eventually(Condition condition) {
    for (int i = 0; i < 6000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return condition();
  }

 private:
  struct Services;
  Counters counters_;
  FakeResources resources_;
  mutable std::mutex mutex_;
  std::vector<WebLogEntry> log_;  // guarded by mutex_
  std::unique_ptr<Services> services_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<WebServer> web_;
};

}  // namespace rmlcell::web::testing
