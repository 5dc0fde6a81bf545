#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <latch>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "rmlcell/v1/cell.grpc.pb.h"
#include "rmlcell/v1/job.grpc.pb.h"
#include "tests/bench/cell_server.h"

// Those who watch a cell, for the benches that ask what they cost.
namespace rmlcell::bench {

inline v1::SubmitJobsRequest Held(std::int64_t number) {
  v1::SubmitJobsRequest request;
  request.set_number(number);
  v1::Job& job = *request.mutable_submission()->mutable_job();
  job.set_kind(v1::JOB_KIND_CHECK);
  job.set_machine("machines/mill-1");
  job.set_held(true);
  job.mutable_inline_program()->set_content("IN;");
  return request;
}

inline v1::WatchCellRequest AllJobs(std::optional<std::int64_t> after, bool batched) {
  v1::WatchCellRequest request;
  v1::Subscription& jobs = *request.add_subscriptions();
  jobs.set_id("jobs");
  jobs.mutable_jobs()->set_events_only(true);
  if (after) request.set_after_sequence(*after);
  request.set_batched(batched);
  return request;
}

inline int EventsIn(const v1::WatchCellResponse& response) {
  if (response.has_event()) return 1;
  return response.events().events_size();
}

// Watchers that go on until they are destroyed; of each event how old it was when it came.
class Watchers {
 public:
  Watchers(const CellServer& server, int count, bool batched, bool ages) {
    std::latch ready(count + 1);
    for (int i = 0; i < count; ++i) {
      contexts_.push_back(std::make_unique<grpc::ClientContext>());
      threads_.emplace_back(
          [this, &server, &ready, batched, ages, context = contexts_.back().get()] {
            const auto stub = v1::CellService::NewStub(server.Connect());
            const auto stream = stub->WatchCell(context, AllJobs(std::nullopt, batched));
            v1::WatchCellResponse response;
            stream->Read(&response);
            ready.count_down();
            std::vector<double> mine;
            while (stream->Read(&response)) {
              told_ += EventsIn(response);
              if (!ages) continue;
              const double now =
                  std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
                      .count();
              const auto add = [&](const v1::CellEvent& event) {
                mine.push_back(now - static_cast<double>(event.time().seconds()) -
                               1e-9 * event.time().nanos());
              };
              if (response.has_event()) add(response.event());
              for (const v1::CellEvent& event : response.events().events()) add(event);
            }
            const std::lock_guard lock(mutex_);
            ages_.insert(ages_.end(), mine.begin(), mine.end());
          });
    }
    ready.arrive_and_wait();
  }
  Watchers(const Watchers&) = delete;
  Watchers& operator=(const Watchers&) = delete;
  ~Watchers() { Stop(); }
  std::int64_t told() const { return told_; }
  std::vector<double> Stop() {
    for (const auto& context : contexts_) context->TryCancel();
    threads_.clear();
    contexts_.clear();
    return std::move(ages_);
  }

 private:
  std::atomic<std::int64_t> told_ = 0;
  std::mutex mutex_;
  std::vector<double> ages_;
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts_;
  std::vector<std::jthread> threads_;
};

// Browsers: server-sent events, read and thrown away.
class Browsers {
 public:
  Browsers(const CellServer& server, int count) {
    for (int i = 0; i < count; ++i) {
      const int socket_of = socket(AF_INET, SOCK_STREAM, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      address.sin_port = htons(static_cast<std::uint16_t>(server.web_port()));
      if (connect(socket_of, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
        throw std::runtime_error("the web port takes no connection");
      const std::string request =
          "GET /rmlcell.v1.CellService/WatchCell?message=%7B%22subscriptions%22%3A%5B%7B%22id%22%3A%22j%22%2C%22jobs%22"
          "%3A%7B%22eventsOnly%22%3Atrue%7D%7D%5D%7D HTTP/1.1\r\nHost: localhost\r\nAccept: text/event-stream\r\n\r\n";
      if (send(socket_of, request.data(), request.size(), 0) < 0)
        throw std::runtime_error("the web port takes no request");
      sockets_.push_back(socket_of);
      std::vector<char> bytes(1 << 16);
      const ssize_t head = recv(socket_of, bytes.data(), bytes.size(), 0);
      if (head < 12 || std::strncmp(bytes.data(), "HTTP/1.1 200", 12) != 0)
        throw std::runtime_error("the web port refuses the stream");
      threads_.emplace_back([this, socket_of] {
        std::vector<char> read(1 << 16);
        for (ssize_t got = 0; (got = recv(socket_of, read.data(), read.size(), 0)) > 0;)
          bytes_ += got;
      });
    }
  }
  Browsers(const Browsers&) = delete;
  Browsers& operator=(const Browsers&) = delete;
  ~Browsers() {
    for (const int one : sockets_) shutdown(one, SHUT_RDWR);
    threads_.clear();
    for (const int one : sockets_) close(one);
  }
  std::int64_t bytes() const { return bytes_; }

 private:
  std::atomic<std::int64_t> bytes_ = 0;
  std::vector<int> sockets_;
  std::vector<std::jthread> threads_;
};

// A watcher that never reads.
struct Stalled {
  explicit Stalled(const CellServer& server, std::int64_t after)
      : stub(v1::CellService::NewStub(server.Connect())),
        stream(stub->WatchCell(&context, AllJobs(after, false))) {}
  ~Stalled() { context.TryCancel(); }
  std::unique_ptr<v1::CellService::Stub> stub;
  grpc::ClientContext context;
  std::unique_ptr<grpc::ClientReader<v1::WatchCellResponse>> stream;
};

}  // namespace rmlcell::bench
